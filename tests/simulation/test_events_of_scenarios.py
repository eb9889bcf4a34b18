"""Events as tables of a scenario: what they do, and what is refused."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import Angle, Event, Rate, Set

STOP = "events.open={kind='angle', joint='elevation', value='1 deg', action='stop'}"


def antenna(*overrides):
    return load_scenario("bai2020", case="case1", overrides=overrides)


def test_tables_are_the_events_of_python():
    tables = (
        "events.slow={kind='rate', joint='elevation', value='0.02 rad/s', direction='rising', after=1,"
        " action='set', set='drives.elevation.amplitude', to='1 N*m'}",
        "events.off={kind='time', time='150 ms', action='set', set='drives.azimuth.on', to=false}",
        "events.angle={kind='angle', joint='azimuth', value=2e-4}",
    )
    asked = antenna(*tables)
    assert type(asked).model_validate_json(asked.model_dump_json()) == asked
    events = [
        Event(
            name="slow",
            when=Rate("elevation", 0.02),
            direction=1,
            action=Set("drives.elevation.amplitude", 1.0),
        ),
        Event(name="angle", when=Angle("azimuth", 2e-4)),
    ]
    run = simulate(asked, duration=0.2)
    other = simulate(antenna(tables[1]), duration=0.2, events=events)
    assert run.data["event"].values.tolist() == other.data["event"].values.tolist()
    assert set(run.data["event"].values) == {"slow", "off", "angle"}
    assert np.array_equal(run.data["event_time"].values, other.data["event_time"].values)
    assert run.end.y.tolist() == other.end.y.tolist()


def test_a_run_that_is_to_stop_has_done_its_work(cli, tmp_path):
    said = cli("run", "bai2020", "--case", "case1", "--set", STOP, "--no-progress", "--no-summary")
    assert (said.code, said.err) == (0, "")
    assert said.out.splitlines()[1] == (
        "at t = 0.144395706 s, event 'open': stopped by an event that was to end it"
    )


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("kind='time', time=[]", "events.e.time must be one or more times, got none"),
        ("kind='time', time=[1, '-1 s']", "events.e.time[1] must be positive, got '-1 s'"),
        ("kind='angle', joint='elevatio', value=1", "events.e.joint: moving joint 'elevatio' is unknown"),
        ("kind='angle', joint='elevation', value='1 m'", "events.e: units must be those of a rotation"),
        ("kind='gap', contact='elevation.radial+', value=0", "events.e.contact: contact 'elevation.radial+'"),
        ("kind='time', time=1, action='set', to=1", 'events.e.set is missing; give it where action is "set"'),
        (
            "kind='time', time=1, set='drives.azimuth.on'",
            'events.e.set must be left out where action is "mark"',
        ),
        ("kind='time', time=1, action='set', set='drives.x.on', to=true", "element 'drives.x' is"),
        (
            "kind='time', time=1, action='set', set='drives.azimuth.on', to=1",
            "events.e.to must be true or false",
        ),
        (
            "kind='time', time=1, action='set', set='drives.azimuth.amplitud', to=1",
            "events.e.set sets 'amplitud', which is unknown; did you mean amplitude?",
        ),
        (
            "kind='time', time=1, action='set', set='drives.azimuth.amplitude', to='1 m'",
            "events.e.to must be a torque [N*m] or a force [N], got '1 m'",
        ),
    ],
)
def test_refusals(table, said):
    with pytest.raises(AntennaPinError) as refused:
        simulate(antenna(f"events.e={{{table}}}"), duration=0.01)
    assert said in str(refused.value) and "\n" not in str(refused.value)
