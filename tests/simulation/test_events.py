"""Events of the user's against motions known in closed form; what they remember; what is refused."""

import dataclasses
import math
import pickle

import numpy as np
import pytest
from wheel import wheel_urdf

from antenna_pin import (
    Outcome,
    RunSettings,
    System,
    Trajectory,
    build_mechanism,
    load_scenario,
    simulate,
)
from antenna_pin.base.state import State
from antenna_pin.contact import Hertz
from antenna_pin.dynamics import CallableDrive, ConstantDrive, JointSpring, SineDrive, TableDrive
from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import Angle, Event, Force, Gap, Jump, Rate, Set, Stop, Time
from antenna_pin.scenario.assemble import build_system

FALL = (0.0, 0.0, -10.0)  # [m/s^2]
# Round-off of the angle over the rate, and that of some thousand steps summed up.
EXACT = 1e-12  # [s]


def rig(kind="continuous", gravity=(0.0, 0.0, 0.0), **elements):
    urdf = wheel_urdf(kind, inertia=2.0, joint="joint")
    return System(build_mechanism(urdf, base="fixed", gravity=gravity), **elements)


def wheel(torque=3.0):
    return rig(drives={"motor": ConstantDrive(joint="joint", value=torque)})


def oscillator(stiffness=8.0):
    """Its angle from 0.1 rad on is 0.1 cos(2 t)."""
    return rig("revolute", springs={"coil": JointSpring(joint="joint", stiffness=stiffness)})


def times(run, name):
    return run.data["event_time"].values[run.data["event"].values == name]


def happenings(run):
    return run.data["event"].values.tolist(), run.data["event_time"].values.tolist()


# --- where they are ---


def test_a_wheel_is_switched_off_after_three_turns():
    """From then on it turns evenly; the two events at that instant both count."""
    events = [
        Event(name="off", when=Angle("joint", 6.0 * math.pi), action=Set("drives.motor.on", False)),
        Event(name="three turns", when=Angle("joint", 6.0 * math.pi), direction=1),
        Event(name="back", when=Angle("joint", math.pi), direction=-1),
    ]
    run = simulate(wheel(), duration=10.0, events=events)
    expected = math.sqrt(12.0 * math.pi / 1.5)
    assert times(run, "off") == pytest.approx([expected], rel=0.0, abs=EXACT)
    assert times(run, "three turns").tolist() == times(run, "off").tolist()
    assert len(times(run, "back")) == 0
    # Angles of some 50 rad, errors of a rate times a time.
    angle = 6.0 * math.pi + 1.5 * expected * (10.0 - expected)
    assert run.data["motion_angle"].values[-1, 0] == pytest.approx(angle, rel=0.0, abs=1e-11)
    assert run.data["drive_torque"].sel(
        time=[expected - 0.1, expected + 0.1], method="nearest"
    ).values.tolist() == [
        [3.0],
        [0.0],
    ]
    assert abs(run.data["energy_error"]).max() < 1e-11


def test_a_pendulum_turns_back_where_its_rate_is_zero():
    events = [
        Event(name="any", when=Rate("joint")),
        Event(name="above", when=Rate("joint"), direction=-1),
        Event(name="below", when=Rate("joint"), direction=1, action=Stop(), after=3),
    ]
    run = simulate(oscillator(), duration=100.0, q=[0.1], events=events)
    turns = 0.5 * math.pi * np.arange(1, 6)
    assert np.abs(times(run, "any") - turns).max() < EXACT
    assert np.abs(times(run, "above") - turns[1::2]).max() < EXACT
    assert np.abs(times(run, "below") - turns[::2]).max() < EXACT
    assert run.outcome is Outcome.STOPPED and run.completed
    assert run.message == "at t = 7.85398163 s, event 'below': stopped by an event that was to end it"
    assert run.data["time"].values[-1] == times(run, "below")[-1]


def test_what_dips_between_two_looks_is_seen_by_the_sign_of_its_rate():
    """The top of an oscillation, for 3e-4 s above the value, a hundredth of a step."""
    value = 0.1 * math.cos(2.0 * 1.5e-4)
    settings = RunSettings(max_step=0.1, rtol=1e-6)
    q, v = [0.1 * math.cos(2.0)], [0.2 * math.sin(2.0)]  # 1 s before the top
    at = [1.0 - 1.5e-4, 1.0 + 1.5e-4]
    for when, seen in ((Angle("joint", value), 2), (lambda moment: moment.q[0] - value, 0)):
        events = [Event(name="top", when=when)]
        run = simulate(oscillator(), duration=1.5, q=q, v=v, events=events, settings=settings)
        assert len(times(run, "top")) == seen
        # Where the rate is 1e-4 rad/s an error of 1e-9 rad counts.
        assert times(run, "top") == pytest.approx(at[:seen], abs=1e-4)
    events = [Event(name="top", when=lambda moment: moment.q[0] - value, nodes=400)]
    run = simulate(oscillator(), duration=1.5, q=q, v=v, events=events, settings=settings)
    assert len(times(run, "top")) == 2


def test_a_ball_bounces_by_jumps_of_its_velocity():
    """Each fall half as fast as the one before; energy that the jumps take is booked."""
    events = [
        Event(
            name="floor",
            when=Angle("joint", 0.0),
            direction=-1,
            action=Jump(lambda moment: (moment.q, -0.5 * moment.v)),
        ),
        # Later by less than the round-off of time, when the ball goes up again: it has passed nonetheless.
        Event(name="seen", when=lambda moment: moment.q[0] + 1e-15, direction=-1),
        Event(name="apex", when=Rate("joint"), direction=-1),
    ]
    run = simulate(rig("prismatic", FALL), duration=0.89, q=[1.0], events=events)
    first = math.sqrt(2.0 / 10.0)
    flights = first * 0.5 ** np.arange(7)  # of twice 0.5, 0.25, ... of the first fall
    floors = first + np.concatenate([[0.0], np.cumsum(2.0 * flights[1:])])
    floors = floors[floors < 0.89]
    assert times(run, "floor") == pytest.approx(floors, rel=0.0, abs=EXACT)
    assert times(run, "seen").tolist() == times(run, "floor").tolist()
    apexes = floors + flights[1 : len(floors) + 1]
    assert times(run, "apex") == pytest.approx(apexes[apexes < 0.89], rel=0.0, abs=EXACT)
    energies = run.data["event_energy"].values[run.data["event"].values == "floor"]
    assert energies == pytest.approx(-7.5 * 0.25 ** np.arange(len(floors)), rel=1e-10)
    assert abs(run.data["energy_error"]).max() < 1e-11


def test_events_on_the_force_and_the_gap_of_a_contact(impact_rig):
    """A ball on a linear wall: depth v/w sin(w t), force k times that."""
    stiffness, mass, speed, play = 1e6, 2.0, 0.1, 1e-3
    system = impact_rig(Hertz(stiffness=stiffness, exponent=1.0), mass=mass, play=play)
    w = math.sqrt(stiffness / mass)
    deepest, contact = speed / w, system.contact_names[0]
    events = [
        Event(name="pressed", when=Force(contact, 0.6 * stiffness * deepest), direction=1),
        Event(name="relieved", when=Force(contact, 0.6 * stiffness * deepest), direction=-1),
        Event(name="deep", when=Gap(contact, -0.8 * deepest)),
        Event(name="near", when=Gap(contact, 0.2 * play), direction=-1),
        Event(name="touch", when=Gap(contact, 0.0), direction=-1),
    ]
    run = simulate(system, duration=0.014, v=[speed, 0.0, 0.0], events=events)
    onset = play / speed
    assert times(run, "near") == pytest.approx([0.8 * onset], rel=0.0, abs=EXACT)
    assert times(run, "touch") == pytest.approx([onset], rel=0.0, abs=EXACT)
    assert run.data["onset_time"].values[0] == pytest.approx(onset, rel=0.0, abs=EXACT)
    # The force's rate is 7e4 N/s: an error of the run, 1e-8 of the depth, is 1e-11 s.
    assert times(run, "pressed") == pytest.approx([onset + math.asin(0.6) / w], rel=0.0, abs=1e-10)
    assert times(run, "relieved") == pytest.approx(
        [onset + (math.pi - math.asin(0.6)) / w], rel=0.0, abs=1e-10
    )
    deep = [onset + math.asin(0.8) / w, onset + (math.pi - math.asin(0.8)) / w]
    assert times(run, "deep") == pytest.approx(deep, rel=0.0, abs=1e-10)
    assert run.data["peak_force"].values == pytest.approx([stiffness * deepest], rel=1e-7)


@pytest.mark.parametrize(
    ("method", "order", "first"),
    [
        ("bogacki-shampine-32", 3, 0.1),
        ("rk4", 4, 0.1),
        ("dormand-prince-54", 5, 0.1),
        ("dormand-prince-853", 8, 0.4),
    ],
)
def test_located_times_converge_with_the_order_of_the_method(method, order, first, fixed_steps):
    """Though dense output has a lower one: the step is made again to end there."""
    events = [Event(name="back", when=Angle("joint", 0.03), action=Stop())]
    expected = 0.5 * math.acos(0.3)

    def error(step):
        run = simulate(oscillator(), duration=3.0, q=[0.1], events=events, settings=fixed_steps(method, step))
        # Where a step of the dense output alone is off by 1e-7 and more.
        assert run.data["motion_angle"].values[-1, 0] == pytest.approx(0.03, rel=0.0, abs=1e-16)
        return abs(times(run, "back")[0] - expected)

    steps = [first, 0.5 * first, 0.25 * first]
    slope = np.polyfit(np.log(steps), np.log([error(step) for step in steps]), 1)[0]
    # Not quite: the last step is not halved with the others.
    assert slope > order - 0.5


def test_steps_end_on_instants_exactly():
    """A step of a fixed size too, and at the very end; a torque that changes there is in force from there."""
    events = [
        Event(name="clock", when=Time(0.25, 0.3, 1.0)),
        Event(name="half", when=Time(0.5), action=Set("drives.motor.value", -1.0)),
    ]
    for method in ("rk4", "dormand-prince-853"):
        settings = RunSettings(method=method, step=0.013)
        run = simulate(wheel(2.0), duration=1.0, events=events, settings=settings)
        assert times(run, "clock").tolist() == [0.25, 0.3, 1.0]
        assert times(run, "half").tolist() == [0.5]
        # Half a second at 1 rad/s^2, half a second at -1/2 rad/s^2.
        assert run.data["motion_angle"].values[-1, 0] == pytest.approx(0.125 + 0.25 - 0.0625, rel=1e-13)


# --- drives and springs that change ---


@pytest.mark.parametrize(
    "drive",
    [
        ConstantDrive(joint="joint", value=2.0),
        SineDrive(joint="joint", amplitude=2.0, frequency=3.0),
        TableDrive(joint="joint", time=(0.0, 0.5, 2.0), torque=(1.0, 2.0, -1.0)),
        CallableDrive(joint="joint", torque=lambda t, angle, rate: 2.0 - rate),
    ],
    ids=lambda drive: type(drive).__name__,
)
def test_a_drive_that_is_off_does_nothing_until_it_is_on_again(drive):
    events = [
        Event(name="off", when=Time(0.4), action=Set("drives.motor.on", False)),
        Event(name="on", when=Time(0.7), action=Set("drives.motor.on", True)),
    ]
    system = rig(drives={"motor": drive})
    program = system.program.copy()
    run = simulate(system, duration=1.0, events=events)
    off = (run.data["time"] >= 0.4) & (run.data["time"] < 0.7)
    assert (run.data["drive_torque"].values[off] == 0.0).all()
    assert (run.data["drive_torque"].values[~off] != 0.0).all() or isinstance(drive, SineDrive)
    rates = run.data["motion_rate"].values[off, 0]
    assert np.ptp(rates) == 0.0 and run.data["motion_rate"].values[-1, 0] != rates[-1]
    assert abs(run.data["energy_error"]).max() < 1e-9
    assert system.program.tobytes() == program.tobytes()


def test_a_spring_that_stiffens_takes_energy_from_the_event():
    """At full deflection; then it swings twice as fast, as far."""
    events = [
        Event(name="stiffer", when=Rate("joint"), direction=1, action=Set("springs.coil.stiffness", 32.0))
    ]
    run = simulate(oscillator(), duration=3.0, q=[0.1], events=events)
    t, angle = run.data["time"].values, run.data["motion_angle"].values[:, 0]
    half = 0.5 * math.pi
    expected = np.where(t < half, 0.1 * np.cos(2.0 * t), -0.1 * np.cos(4.0 * (t - half)))
    assert np.abs(angle - expected).max() < 1e-9
    assert run.data["event_energy"].values[0] == pytest.approx(0.5 * (32.0 - 8.0) * 0.01, rel=1e-9)
    assert abs(run.data["energy_error"]).max() < 1e-9


# --- going on ---


def with_events():
    """The antenna, its motor changed, its shaft struck and its contacts watched."""
    asked = load_scenario("bai2020", case="case3", overrides=["clearance.elevation.geometry=closed-form"])

    def strike(moment):
        v = moment.v
        v[-1] += 0.01
        return moment.q, v

    names = build_system(asked).contact_names
    drive = next(iter(asked.drives))
    return asked, [
        Event(name="force", when=Force(names[0], 50.0)),
        Event(name="rate", when=Rate("elevation", 0.006), action=Set(f"drives.{drive}.on", False)),
        Event(name="clock", when=Time(0.01, 0.025, 0.05), action=Jump(strike)),
        Event(name="gap", when=Gap(names[1], 1e-4), direction=-1),
    ]


def test_two_halves_are_the_whole_with_events_too():
    asked, events = with_events()
    whole = simulate(asked, duration=0.06, events=events)
    for part in (0.017, 0.025, 0.043):
        first = simulate(asked, duration=part, events=events)
        start = State.from_json(pickle.loads(pickle.dumps(first.end)).to_json())
        assert start == first.end
        later = simulate(asked, duration=0.06 - first.end.reached, start=start, events=events)
        assert later.end == whole.end
        # The last steps of the first are cut to end there, so it finds its last events up to their error.
        happened = [list(zip(*happenings(run), strict=True)) for run in (first, later, whole)]
        assert happened[1] == [one for one in happened[2] if one[1] > first.end.reached]
        names, at = happenings(first)
        assert names == [name for name, t in happened[2] if t <= first.end.reached]
        assert at == pytest.approx([t for _, t in happened[2]][: len(at)], rel=0.0, abs=1e-8)
    assert set(happenings(whole)[0]) == {"force", "rate", "clock", "gap"}


def test_a_run_goes_on_from_where_an_event_has_stopped_it():
    stop = [Event(name="turn", when=Angle("joint", 2.0), action=Stop())]
    mark = [dataclasses.replace(stop[0], action=dataclasses.replace(stop[0]).action, after=100)]
    first = simulate(wheel(), duration=3.0, events=stop)
    assert first.outcome is Outcome.STOPPED
    later = simulate(wheel(), duration=3.0 - first.end.reached, start=first.end, events=stop)
    whole = simulate(wheel(), duration=3.0, events=mark)
    assert later.outcome is Outcome.COMPLETED
    assert np.array_equal(later.end.y, whole.end.y)
    assert later.data.sizes["event"] == 0


def test_a_result_file_holds_its_events(tmp_path):
    events = [Event(name="turn", when=Angle("joint", 2.0)), Event(name="clock", when=Time(0.5))]
    run = simulate(wheel(), duration=2.0, events=events)
    loaded = Trajectory.load(run.save(tmp_path / "run.nc"))
    assert loaded.data["event"].values.tolist() == ["clock", "turn"]
    assert np.array_equal(loaded.data["event_time"].values, run.data["event_time"].values)
    assert loaded.end == run.end


# --- refusals ---


@pytest.mark.parametrize(
    ("event", "said"),
    [
        ({"when": Angle("knee", 0.0)}, "knee"),
        ({"when": Force("joint.radial+", 1.0)}, "event: contact 'joint.radial"),
        ({"when": lambda moment: None}, "event 'e': when must give a finite number, got None"),
        ({"when": 3.0}, "Event: when must be a function, got 3.0"),
        ({"direction": 2}, "event 'e': direction must be -1, 0 or 1, got 2"),
        ({"after": 0}, "event 'e': after must be a whole number of 1 or more, got 0"),
        (
            {"action": "stop"},
            "an Edge or a sequence of a Mark, a Stop or a Set, got 'stop'",
        ),
        ({"action": [Stop(), Jump(lambda moment: (moment.q, moment.v))]}, "a Mark, a Stop or a Set, got"),
        ({"action": Set("drives.moter.value", 1.0)}, "did you mean drives.motor"),
        ({"action": Set("drives.motor.valeu", 1.0)}, "did you mean value"),
        ({"action": Set("drives.motor.value", math.inf)}, "value must be finite"),
    ],
)
def test_refusals(event, said):
    with pytest.raises(AntennaPinError, match=said):
        simulate(wheel(), duration=1.0, events=[Event(**{"name": "e", "when": Angle("joint", 1.0), **event})])


def test_names_are_different_and_instants_not_negative():
    twice = [Event(name="e", when=Angle("joint", 1.0))] * 2
    with pytest.raises(AntennaPinError, match="events must be of different names"):
        simulate(wheel(), duration=1.0, events=twice)
    with pytest.raises(AntennaPinError, match="one or more times of zero or more"):
        Time(-1.0)
    with pytest.raises(AntennaPinError, match="value must be positive"):
        Force("joint.radial", 0.0)
