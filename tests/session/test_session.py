"""A session's numbers are those of one run in which events set what it commanded, to the last bit."""

import dataclasses
import json
import signal
import threading
import time

import numpy as np
import pytest
from sessions import antenna, differences

from antenna_pin import Outcome, RunSettings, load_scenario, simulate
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.run.session import EndedError, InUseError, start
from antenna_pin.run.simulation import Angle, Event, Force, Mark, Rate, Set, Stop, Time
from antenna_pin.scenario.assemble import scenario_facts


@pytest.fixture(scope="module")
def short():
    """The antenna on ideal joints, which needs few steps."""
    return antenna(case="case1")


def told(scenario, commands, end, pieces=7, seed=0, **given):
    """Return a session that was told to go on in random pieces, and commanded: (t, place, value)."""
    session = start(scenario, **given)
    random = np.random.default_rng(seed)
    begin = session.time
    for t, place, value in [*commands, (end, None, None)]:
        for between in np.sort(random.uniform(begin, t, pieces)):
            if session.time < between < t:
                session.run_until(float(between))
        if t > session.time:
            assert session.run_until(t)
        if place is not None:
            session.set(place, value)
        begin = t
    return session


def at_once(scenario, commands, end, **given):
    """Return the one run with events that set the same."""
    set_by = [
        Event(name=f"{k} {place}", when=Time(t), action=Set(place, value))
        for k, (t, place, value) in enumerate(commands)
    ]
    return simulate(scenario, duration=end, events=(*given.pop("events", ()), *set_by), **given)


def but_events(state):
    """Return a state without what the run's events remember: a session has none of its own."""
    return dataclasses.replace(state, events=())


MOTOR = "drives.elevation.value"
IRREGULAR = [
    (0.0031, MOTOR, 1.7),
    (0.010000000000000002, MOTOR, -2.3),
    (0.0171234567, "springs.hold.stiffness", 3.5),
    (0.0171234567, MOTOR, 0.4),
    (0.03, "drives.azimuth.on", False),
    (0.0333333333, "springs.hold.damping", 0.0),
]


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("case", ["case1", "case3"])
def test_a_session_is_the_run_with_its_commands_as_events(case, engine):
    scenario = antenna(f"integrator.engine={engine}", case=case)
    session = told(scenario, IRREGULAR, 0.05)
    whole = at_once(scenario, IRREGULAR, 0.05)
    run = session.trajectory()
    assert differences(run, whole) == []
    assert but_events(run.end) == but_events(whole.end) and run.message == whole.message
    # Its own account of what was commanded makes the same run.
    assert differences(run, simulate(scenario, duration=0.05, events=session.events)) == []


def test_without_commands_it_is_the_run_however_finely_it_is_told():
    scenario = antenna()
    whole = simulate(scenario, duration=0.03)
    for pieces, seed in ((1, 0), (40, 1)):
        session = told(scenario, [], 0.03, pieces=pieces, seed=seed)
        run = session.trajectory()
        assert differences(run, whole) == [] and run.end == whole.end
        # Nor is the work done twice counted: the run's own account is the same.
        assert run.counts.accepted == whole.counts.accepted
        assert run.counts.evaluations == whole.counts.evaluations


def solar(case, span):
    """Return an array with stops, latches and belts, commands, and how long it runs [s]."""
    commands = ((0.31, "first.stiffness", 0.02), (0.62, "second.on", False), (0.8, "second.on", True))
    made = load_scenario("solar_array", case=case)
    return made, [(part * span, f"springs.{place}", value) for part, place, value in commands], span


PUSHED = [(0.004, MOTOR, 2.0), (0.0077, MOTOR, -1.0)]
DRIVEN = "drives.crank={kind='constant', value=5.0, replace=true}"
TURNED = [(0.0003, "drives.crank.value", 9.0), (0.0011, "drives.crank.value", -5.0)]
OTHERS = {
    "rk4, coal": lambda: (
        antenna("integrator.method=rk4", "integrator.step=20 us", geometry="coal"), PUSHED, 0.012
    ),
    "radau5, coal": lambda: (antenna("integrator.method=radau5", geometry="coal"), PUSHED, 0.012),
    "loop": lambda: (load_scenario("slider_crank", case="planar", overrides=[DRIVEN]), TURNED, 0.002),
    "stops": lambda: solar("ideal", 1.0),
    "stops, play": lambda: solar("play", 0.02),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_every_method_backend_and_mechanism_likewise(name):
    scenario, commands, span = OTHERS[name]()
    run = told(scenario, commands, span).trajectory()
    assert differences(run, at_once(scenario, commands, span)) == []


def test_events_at_the_instant_of_a_command_and_inside_what_is_cut(short):
    events = (
        Event(name="mark", when=Time(0.01, 0.0199999), action=Mark()),
        Event(name="spring", when=Time(0.01, 0.0151), action=Set("springs.hold.stiffness", 4.0)),
        Event(name="turns", when=Rate("elevation", 0.02)),
    )
    commands = [(0.01, MOTOR, 3.0), (0.015, MOTOR, -3.0)]
    run = told(short, commands, 0.02, pieces=30, events=events).trajectory()
    whole = at_once(short, commands, 0.02, events=events)
    assert differences(run, whole) == []
    assert sorted(run.data["event_time"].values) == sorted(whole.data["event_time"].values)


def test_a_trajectory_does_not_disturb_and_reading_neither():
    scenario = antenna()
    session = start(scenario)
    for k in range(1, 6):
        session.run_until(0.005 * k)
        part = session.trajectory()
        assert part.end == simulate(scenario, duration=0.005 * k).end
        assert all(np.isfinite(session[name]) for name in ("elevation.rate", "elevation.radial+.force"))
        assert np.isfinite(session["|joint_force[elevation]|"])
    assert differences(session.trajectory(), simulate(scenario, duration=0.025)) == []


def test_numbers_are_those_of_the_result():
    scenario = antenna()
    session = start(scenario)
    session.run_until(0.006)
    before = [session[name] for name in ("elevation.angle", "kinetic_energy")]  # not kept beyond this state
    session.run_until(0.0123)
    assert session["elevation.angle"] != before[0] and session["kinetic_energy"] != before[1]
    last = session.trajectory().data.isel(time=-1)
    assert session["elevation.angle"] == last["motion_angle"].sel(joint="elevation").item()
    assert session["elevation.rate"] == last["motion_rate"].sel(joint="elevation").item()
    for contact in session.system.contact_names:
        assert session[f"{contact}.gap"] == last["gap"].sel(contact=contact).item()
        assert session[f"{contact}.depth_rate"] == last["depth_rate"].sel(contact=contact).item()
        assert session[f"{contact}.force"] == last["normal_force"].sel(contact=contact).item()
        assert session[f"{contact}.touching"] == last["touching"].sel(contact=contact).item()
    for name in ("kinetic_energy", "energy_error", "drive_work[elevation]", "q[azimuth]"):
        variable, _, label = name.removesuffix("]").partition("[")
        expected = last[variable].sel({last[variable].dims[0]: label}) if label else last[variable]
        assert session[name] == expected.item()
    assert session["drives.elevation.value"] == session.command["elevation"] == 0.5
    assert {"elevation.angle", "gap[elevation.radial+]"} <= set(session.names())
    assert session.names()["elevation.rate"] == "rad/s"


def test_commands_by_name_text_and_switch(short):
    session = start(short)
    assert list(session.command) == ["elevation"]
    session.step("5 ms")
    session.command["elevation"] = "300 N*mm"
    assert session.command["elevation"] == 0.3
    session.off("drives.elevation")
    assert session["drives.elevation.on"] == 0.0
    session.step(0.001)
    session.on("drives.elevation")
    assert session["drives.elevation.on"] == 1.0
    run = session.trajectory()
    assert json.loads(run.data.attrs["commands"])[0] == [0.005, MOTOR, 0.3]
    assert len(run.data["event"]) == 3


def test_energy_that_commands_bring_in_is_in_the_ledger(short):
    session = start(short)
    session.step(0.2)
    session.set("springs.hold.stiffness", 500.0)
    session.step(0.2)
    run = session.trajectory()
    brought = run.data["event_energy"].values
    angle = run.data["motion_angle"].sel(joint="azimuth", time=0.2).item()
    assert brought[0] == pytest.approx(0.5 * 498.0 * angle**2, rel=1e-9)  # as springs store: round-off only
    # At rtol 1e-8 the balance of smooth motion is kept to a part of that of what moves.
    assert abs(run.data["energy_error"].values[-1]) < 1e-6 * run.data["kinetic_energy"].values.max()


def test_commands_at_time_zero_hold_from_the_start(short):
    session = start(short)
    session.command["elevation"] = 2.0
    session.step(0.01)
    run = session.trajectory()
    same = simulate(short, duration=0.01, events=session.events)
    assert set(differences(run, same)) <= {"event_time", "event_energy"}  # of none at zero
    other = simulate(short.with_overrides({MOTOR: 2.0}), duration=0.01)
    for name in ("q", "v", "a", "drive_torque", "drive_work", "energy_error"):
        assert np.array_equal(run.data[name].values, other.data[name].values), name


def test_an_instant_is_met_exactly_where_the_way_to_it_is_rounded(short):
    """The sum of a time and a long way may be off by the last digit: no step is made of that."""
    first, instant = 1.1e-3, 0.0030873781904317047
    assert first + (instant - first) != instant
    scenario = short.with_overrides({"integrator.first_step": first})
    goes = [Event(name="x", when=Time(instant))]
    run = simulate(scenario, duration=0.02, events=goes)
    assert run.data["event_time"].values.tolist() == [instant]
    plain = simulate(scenario, duration=instant)
    assert run.counts.accepted == plain.counts.accepted + 2  # the way from there to the end, in two steps
    commands = [(instant, MOTOR, 1.0)]
    assert differences(told(scenario, commands, 0.02).trajectory(), at_once(scenario, commands, 0.02)) == []


# --- conditions ---------------------------------------------------------------------------------------------


def test_a_condition_leaves_no_trace_and_a_command_at_it_is_an_event_there():
    scenario = antenna()
    goal = Angle("elevation", 5e-6)
    session = start(scenario)
    assert session.run_until(goal, timeout="20 ms")
    at = session.time
    assert session["elevation.angle"] == pytest.approx(5e-6, abs=1e-15)  # located to round-off
    stopped = simulate(scenario, duration=0.02, events=[Event(name="x", when=goal, action=Stop())])
    assert at == stopped.data["event_time"].item() and stopped.end.time <= at
    other = session.copy()
    session.run_until(0.02)
    assert differences(session.trajectory(), simulate(scenario, duration=0.02)) == []
    again = start(scenario)
    again.run_until(Event(name="up", when=goal, direction=1), timeout=0.02)
    again.command["elevation"] = -1.0
    again.run_until(0.02)
    action = Event(name="up", when=goal, direction=1, action=Set(MOTOR, -1.0))
    whole = simulate(scenario, duration=0.02, events=[action])
    assert whole.data["event_time"].values.tolist() == [at]  # it does not pass again
    assert differences(again.trajectory(), whole) == []
    assert other.time == at


def test_a_condition_that_does_not_come_and_times_as_conditions(short):
    session = start(short)
    assert not session.run_until(Angle("elevation", 3.0), timeout=0.01)
    assert session.time == 0.01
    assert session.run_until(Time(0.013, 0.02), timeout=1.0) and session.time == 0.013
    assert not session.run_until(Time(0.013), timeout=0.007) and session.time == 0.02
    assert differences(session.trajectory(), simulate(short, duration=0.02)) == []


def test_a_contact_force_as_a_condition():
    scenario = antenna()
    session = start(scenario)
    contact = next(c for c in session.system.contact_names if "radial" in c)
    if session.run_until(Force(contact, 50.0), timeout=0.05):
        assert session[f"{contact}.force"] == pytest.approx(50.0, rel=1e-9)  # located to round-off
    session.run_until(0.06)
    assert differences(session.trajectory(), simulate(scenario, duration=0.06)) == []


# --- states -------------------------------------------------------------------------------------------------


def test_halves_checkpoints_and_branches():
    scenario = antenna()
    commands = [(0.004, MOTOR, 2.0), (0.011, MOTOR, -1.0)]
    whole = at_once(scenario, commands, 0.02)
    for cut in (0.0075, 0.011):  # in the middle of nothing, and right behind a command
        session = told(scenario, [one for one in commands if one[0] <= cut], cut)
        text = session.state.to_json()
        later = told(
            scenario,
            [one for one in commands if one[0] > cut],
            0.02,
            start=State.from_json(text),
        )
        assert later.trajectory().end.y.tolist() == whole.end.y.tolist()
        assert (
            simulate(scenario, duration=0.001, start=session.state).end
            == told(scenario, [], cut + 0.001, start=State.from_json(text)).trajectory().end
        )
    branch = session.copy()
    session.command["elevation"] = 5.0
    session.run_until(0.02)
    branch.run_until(0.02)
    assert branch.trajectory().end.y.tolist() == whole.end.y.tolist()
    assert session["elevation.rate"] != branch["elevation.rate"]


def test_restore_and_reset():
    scenario = antenna()
    session = start(scenario)
    session.run_until(0.006)
    saved = session.save()
    session.command["elevation"] = 3.0
    session.run_until(0.01)
    once = session["elevation.rate"]
    session.restore(saved)
    assert session.time == 0.006 and session.command["elevation"] == 0.5
    session.command["elevation"] = 3.0
    session.run_until(0.01)
    assert session["elevation.rate"] == once
    session.reset()
    assert session.time == 0.0
    session.run_until(0.01)
    assert differences(session.trajectory(), simulate(scenario, duration=0.01)) == []
    speeds = 0.01 * np.ones(session.system.model.nv)
    session.reset(v=speeds)
    session.run_until(0.002)
    assert session.trajectory().end == simulate(scenario, v=speeds, duration=0.002).end


def test_a_system_built_in_python(short):
    from antenna_pin import build_system
    from antenna_pin.scenario.assemble import initial_state

    system = build_system(short)
    q, v = initial_state(short, system)
    settings = RunSettings(rtol=1e-7)
    session = start(system, q=q, v=v, settings=settings)
    session.step(0.02)
    session.set(MOTOR, 1.0)
    session.step(0.02)
    whole = simulate(
        system,
        q=q,
        v=v,
        duration=0.04,
        settings=settings,
        events=[Event(name="x", when=Time(0.02), action=Set(MOTOR, 1.0))],
    )
    assert differences(session.trajectory(), whole) == []


def test_ctrl_c_leaves_it_between_two_steps_and_it_may_go_on():
    scenario = antenna()
    pressed = []

    def presses(moment):
        if moment.time > 0.012 and not pressed:
            pressed.append(moment.time)
            signal.raise_signal(signal.SIGINT)
        return 1.0

    watched = [Event(name="x", when=presses)]
    session = start(scenario, events=watched)
    with pytest.raises(KeyboardInterrupt):
        session.run_until(0.02)
    assert 0.0 < session.time < 0.02 and session.outcome is Outcome.COMPLETED
    assert session.run_until(0.02)
    assert differences(session.trajectory(), simulate(scenario, duration=0.02, events=watched)) == []


# --- the end, the past, what it costs -----------------------------------------------------------------------


def test_it_ends_where_an_event_stops_it_and_says_so(short):
    session = start(short, events=[Event(name="there", when=Time(0.0105), action=Stop())])
    assert session.step(0.01)
    assert not session.step(0.01)
    assert session.time == 0.0105 and session.outcome is Outcome.STOPPED and "there" in session.message
    assert session.trajectory().outcome is Outcome.STOPPED
    with pytest.raises(EndedError, match=r"session: has ended at t = 0.0105 s, event 'there'"):
        session.step(0.01)
    session.reset()
    assert session.outcome is Outcome.COMPLETED and session.step(0.001)


@pytest.mark.parametrize("record", [False, 0.01])
def test_a_past_that_is_not_kept_does_not_grow(record):
    scenario = antenna("output.rate=20 kHz")
    session, all_of_it = start(scenario, record=record), start(scenario)
    for _ in range(60):
        for one in (session, all_of_it):
            one.step(0.001)
        session.command["elevation"] = all_of_it.command["elevation"] = 0.5 + session.time
    run, whole = session.trajectory(), all_of_it.trajectory()
    assert run.end.y.tolist() == whole.end.y.tolist()
    assert len(run.data["time"]) < 1200 < len(whole.data["time"])
    begin = run.data["time"].values[0]
    assert begin <= 0.06 - record
    common = whole.data.sel(time=slice(begin, None))
    assert np.array_equal(common["q"].values, run.data["q"].values)
    assert np.isfinite(run.data["energy_error"].values).all()
    # The balance of its own window: no more than that of the whole.
    assert np.abs(run.data["energy_error"].values).max() < 1e-6


def test_context_and_screen(short):
    with start(short) as session:
        session.step(0.01)
        shown = repr(session)
        assert (
            "t = 10\N{NO-BREAK SPACE}ms" in shown
            and "elevation: " in shown
            and "command: elevation = 0.5" in shown
        )
        assert max(map(len, shown.splitlines())) < 110
    with pytest.raises(EndedError, match="must be open"):
        session.step(0.01)
    assert session.trajectory().outcome is Outcome.COMPLETED


def test_a_step_costs_little_beyond_its_integration(short):
    session = start(short, record=False)
    session.step(0.2)
    spent, went = [], time.process_time
    for _ in range(200):
        before = went()
        session.step(1e-4)
        spent.append(went() - before)
    # Far below a run of its own (10 ms), on any machine: two steps that are cut and a state that is kept.
    assert np.median(spent) < 2e-3


@pytest.mark.parametrize(
    ("does", "says"),
    [
        (lambda s: s.step(0.0), "step: duration must be a positive time"),
        (lambda s: s.step("3 m"), "step: duration must be a time"),
        (lambda s: s.step(float("nan")), "step: duration must be a positive time"),
        (lambda s: s.run_until(0.005), "run_until: goal must be a time later than the session's"),
        (
            lambda s: s.run_until(Angle("elevation", 1.0)),
            "run_until: timeout must be given beside a condition",
        ),
        (
            lambda s: s.run_until(Angle("elevation", 1.0), timeout="1 m"),
            r"^run_until: timeout must be a time \[s\]",
        ),
        (
            lambda s: s.run_until(Angle("elevation", 1.0), timeout=0.0),
            "^run_until: timeout must be a positive",
        ),
        (lambda s: s.run_until(Angle("elevaton", 1.0), timeout=1.0), "did you mean elevation"),
        (lambda s: s.command.__setitem__("elevaton", 1.0), "did you mean elevation"),
        (lambda s: s.command.__setitem__("elevation", float("nan")), "value"),
        (lambda s: s.command.__setitem__("elevation", "3 s"), r"set: drives.elevation.value must be"),
        (lambda s: s.set("springs.hold.stifness", 1.0), "did you mean stiffness"),
        (lambda s: s.set("springs.hold.stiffness", -1.0), "stiffness must be zero or more"),
        (lambda s: s["elevation.angel"], "did you mean elevation.angle"),
        (lambda s: s.step(10**5000), "step: duration must be a positive time"),
        (lambda s: s.run_until(10**5000), "run_until: goal must be a positive time"),
        (
            lambda s: s.set("drives.elevation.value", 10**5000),
            "drives.elevation.value must be a finite number",
        ),
        (lambda s: s.reset(angles=[1.0]), r"reset: angles must be a mapping .*, got \[1.0\]"),
        (lambda s: s.on("drives.elevator"), "did you mean drives.elevation"),
        (lambda s: s.restore(State.from_json(s.state.to_json().replace('"x": [', '"x": [1.0, '))), "start.x"),
    ],
)
def test_what_cannot_be_done_is_refused_in_one_line_and_changes_nothing(short, does, says):
    session = start(short)
    session.step(0.01)
    before = session.state
    with pytest.raises(AntennaPinError, match=says) as refused:
        does(session)
    assert "\n" not in str(refused.value)
    assert session.state == before and session.command["elevation"] == 0.5
    session.step(0.01)
    assert differences(session.trajectory(), simulate(short, duration=0.02)) == []


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"record": -1.0}, "start: record must be true, false or a time, zero or more"),
        ({"record": "3 m"}, "start: record must be"),
        ({"q": [0.0], "start": 1}, "start: start must be"),
        ({"model": 3}, "start: model must be"),
    ],
)
def test_what_cannot_be_begun_is_refused(short, given, says):
    with pytest.raises((InvalidParameterError, AntennaPinError), match=says):
        start(**{"model": short, **given})


@pytest.mark.parametrize(
    "call",
    [
        lambda session: session.step(1e-3),
        lambda session: session.run_until(1e-2),
        lambda session: session.set(MOTOR, 1.0),
        lambda session: session.command.update(elevation=1.0),
        lambda session: session["t"],
        lambda session: session.state,
        lambda session: session.trajectory(),
        lambda session: session.copy(),
        lambda session: session.reset(),
        lambda session: session.restore(None),
    ],
)
def test_a_second_thread_is_refused_while_a_session_goes_on(short, call):
    """Whatever it calls, in one line with both threads' names; afterwards it may."""
    session = start(short)
    inside, done = threading.Event(), threading.Event()

    def condition(now):
        inside.set()
        done.wait(60.0)
        return 1.0

    first = threading.Thread(target=lambda: session.run_until(condition, timeout=1e-6), name="first")
    first.start()
    try:
        assert inside.wait(60.0)
        assert session.time == 0.0  # what is only looked at stays free
        with pytest.raises(
            InUseError, match=r"^session: .* one thread .*'MainThread' during run_until .*'first'"
        ):
            call(session)
    finally:
        done.set()
        first.join()
    assert session.step(1e-6)


@pytest.mark.parametrize("model", ["prismatic", "constraint", "ideal"])
def test_a_joint_that_slides_has_units_of_length_and_force(model):
    """With play, held by constraint or ideal: in the start, its drive, its numbers, and in words."""
    overrides = {"clearance.slide.model": model, "initial.joints.slide.position": "0.1 m"}
    scenario = load_scenario("slider", case="driven", overrides=overrides)
    assert scenario_facts(scenario)["drives"] == {"push": "constant 4\N{NO-BREAK SPACE}N, at slide"}
    session = start(scenario)
    session.set("drives.push.value", "5 N")
    with pytest.raises(AntennaPinError, match=r"drives\.push\.value must be a force \[N\], got '5 N\*m'"):
        session.set("drives.push.value", "5 N*m")
    names = session.names()
    assert (names["slide.angle"], names["drives.push.value"]) == ("m", "N")
    assert session["slide.angle"] == pytest.approx(0.1, abs=1e-15)
