"""Functions of a user's that have no answer: told by name, with the question; what was run before is kept."""

import dataclasses
import math
import sys

import numba
import numpy as np
import pytest

from antenna_pin import Outcome, RunSettings, System, Trajectory, Urdf, build_mechanism, simulate
from antenna_pin.contact import CustomFriction, CustomNormal
from antenna_pin.elements import CallableDrive, CallableMotion
from antenna_pin.errors import FunctionError
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.run.simulation import Event, Jump, Stop
from antenna_pin.run.simulation.events import Moment
from antenna_pin.run.simulation.loop import Run

ARM = """<robot name="arm"><link name="base"/>
<joint name="j" type="continuous"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint>
<link name="tip"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
LATE = 0.3  # [s]


def arm(drive):
    mechanism = build_mechanism(Urdf.from_text(ARM, "arm.urdf"), base="fixed")
    return System(mechanism, drives={"m": drive})


def turned(drive, **more):
    return simulate(arm(drive), duration=0.5, v=[0.3], **more)


def started(system, v):
    return system, system.state(system.neutral(), v)


def raised(error):
    raise error


def deep(n=0):
    return deep(n + 1)


NO_ANSWERS = {
    "nan": (lambda: math.nan, "gave nan"),
    "infinity": (lambda: -math.inf, "gave -inf"),
    "complex": (lambda: (-1.0) ** 0.5, "(complex)"),
    "numpy complex": (lambda: np.complex128(1.0), "(complex128)"),
    "none": (lambda: None, "gave None"),
    "text": (lambda: "much", "gave 'much'"),
    "bool": (lambda: True, "gave true"),
    "array": (lambda: np.zeros(1), "(ndarray)"),
    "error": (lambda: 1.0 / 0.0, "gave the error ZeroDivisionError: "),
    "exit": (lambda: sys.exit(3), "gave the error SystemExit: 3"),
    "memory": (lambda: raised(MemoryError()), "gave the error MemoryError ("),
    "recursion": (deep, "gave the error RecursionError: "),
}


@pytest.mark.parametrize("kind", NO_ANSWERS)
def test_what_is_no_answer_ends_the_run_where_it_is_given(kind, tmp_path):
    answer, said = NO_ANSWERS[kind]
    drive = CallableDrive(joint="j", torque=lambda t, angle, rate: answer() if t > LATE else 0.1)
    run = turned(drive)
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert run.message.startswith("at t = 0.3 s, drive 'm': torque of t = 0.3")
    assert said in run.message and "angle = " in run.message and "\n" not in run.message
    # All up to there is as without the end of it, and the file is whole.
    whole = turned(CallableDrive(joint="j", torque=lambda t, angle, rate: 0.1))
    count = int(1000 * LATE)
    assert np.array_equal(run.data.motion_angle[:count, 0], whole.data.motion_angle[:count, 0])
    assert Trajectory.load(run.save(tmp_path / "run.nc")).outcome is Outcome.FUNCTION_FAILED
    # From the start on there is nothing to keep.
    with pytest.raises(FunctionError, match="drive 'm': torque must give a finite number, got"):
        turned(CallableDrive(joint="j", torque=lambda t, angle, rate: answer()))


def test_a_run_that_goes_on_into_no_answer_has_the_state_that_it_came_to():
    """A run begins with the step that the end of the one before has cut, and fails in it."""
    begun = simulate(
        arm(CallableDrive(joint="j", torque=lambda t, a, w: 0.1)), duration=LATE + 0.005, v=[0.3]
    )
    drive = CallableDrive(joint="j", torque=lambda t, a, w: math.nan if t > LATE else 0.1)
    run = simulate(arm(drive), duration=0.1, start=begun.end)
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert run.data.time.values == pytest.approx([LATE], abs=1e-6)


def test_ctrl_c_in_a_function_keeps_what_there_is():
    drive = CallableDrive(joint="j", torque=lambda t, a, w: raised(KeyboardInterrupt()) if t > LATE else 0.1)
    run = turned(drive)
    assert run.outcome is Outcome.INTERRUPTED and run.data.time[-1] == pytest.approx(LATE, abs=1e-2)


def test_a_shorter_step_may_not_come_to_where_there_is_no_answer():
    """The arm turns back at 2.1 ms: only trial steps ask beyond 2.5 ms."""
    beyond = []

    def torque(t, angle, rate):
        beyond.append(t > 2.5e-3)
        return math.nan if t > 2.5e-3 else -50.0

    drive = CallableDrive(joint="j", torque=torque)
    run = turned(drive, events=[Event(name="back", when=lambda m: m.rate("j"), action=Stop())])
    assert run.outcome is Outcome.STOPPED, run.message
    assert any(beyond)


@numba.njit
def late_nan(t, angle, rate):
    return math.nan if t > LATE else 0.1


@numba.njit
def late_error(t, angle, rate):
    if t > LATE:
        raise ValueError("beyond all bounds")
    return 0.1


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("method", ["dormand-prince-853", "radau5"])
def test_a_compiled_function_is_named_as_well(engine, method, capfd):
    """Of itself an error in one counts as zero, and is printed."""
    settings = RunSettings(engine=engine, method=method)
    for function, said in (
        (late_nan, "gave nan"),
        (late_error, "gave the error ValueError: beyond all bounds"),
    ):
        run = turned(CallableDrive(joint="j", torque=function), settings=settings)
        assert run.outcome is Outcome.FUNCTION_FAILED, run.message
        assert "drive 'm': torque of t = 0.3" in run.message and said in run.message
        assert run.data.time[-1] == pytest.approx(LATE, abs=1e-6)
    assert capfd.readouterr() == ("", "")


@numba.njit
def late_place(t):
    return math.nan if t > LATE else 0.5 * t


@numba.njit
def half(t):
    return 0.5


@numba.njit
def nothing(t):
    return 0.0


@pytest.mark.parametrize("engine", ["python", "pinocchio", "compiled"])
def test_a_motion_is_named(engine):
    motion = CallableMotion(joint="j", position=late_place, velocity=half, acceleration=nothing)
    if engine == "python":
        functions = {name: getattr(motion, name).py_func for name in ("position", "velocity", "acceleration")}
        motion = dataclasses.replace(motion, **functions)
    with pytest.raises(FunctionError, match=r"position must give a finite number, got nan of t = 0\.3"):
        simulate(arm(motion), duration=0.5, v=[0.5])  # motions are followed before the run
    settings = RunSettings(engine="pinocchio" if engine == "python" else engine)
    run = Run(*started(arm(motion), [0.5]), 0.5, settings)
    run.advance()
    assert run.outcome is Outcome.FUNCTION_FAILED, run.message
    assert "drive 'm': position of t = 0.3" in run.message and "gave nan" in run.message
    assert run.stepper.t == pytest.approx(LATE, abs=1e-6)


# --- contacts -------------------------------------------------------------------------------------

STIFFNESS, DEEP = 1e7, 2e-5


def whole(depth, rate, speed):
    return STIFFNESS * depth


def elastic(depth):
    return STIFFNESS * depth


def energy(depth):
    return 0.5 * STIFFNESS * depth**2


def no_force(depth, rate, speed):
    return math.nan if depth > DEEP else STIFFNESS * depth


def no_elastic(depth):
    return math.nan if depth > DEEP else STIFFNESS * depth


def no_energy(depth):
    return math.nan if depth > DEEP else 0.5 * STIFFNESS * depth**2


def no_grip(speed):
    return -1.0


LAW = {"force": whole, "elastic_force": elastic, "elastic_energy": energy}
SPOILED = {
    "force": no_force,
    "elastic_force": no_elastic,
    "elastic_energy": no_energy,
}


class Backend:
    """The closed form of a joint, spoiled."""

    def __init__(self, geometry, how):
        self.coal, self.how, self.asked = geometry.coal(np.eye(3)), how, 0

    def query(self, pose, table, row, wanted=None):
        self.coal.query(pose, table, row, wanted)
        self.asked += 1
        if self.asked < 200:
            return
        if self.how == "nan":
            table["gap"][row] = np.nan
        elif self.how == "normal":
            table["normal"][row] *= 2.0
        elif self.how == "pose":
            pose["centre"][0, 0] += 1e-6
        elif self.how == "nothing":
            table["gap"][row:] = table["gap"][row:] + "much"


def thrown(impact_rig, engine="pinocchio", **parts):
    system = impact_rig(**{"law": CustomNormal(**LAW), **parts})
    return simulate(system, duration=0.02, v=[0.2, 0.1, 3.0], settings=RunSettings(engine=engine))


def test_no_answer_of_a_law_is_no_force_of_zero(impact_rig):
    assert thrown(impact_rig).data.peak_depth.max() > DEEP
    for name, function in SPOILED.items():
        for compiled in (False, True):
            made = {**LAW, name: function}
            if compiled:
                made = {key: numba.njit(one) for key, one in made.items()}
            for engine in ("pinocchio", "compiled") if compiled else ("pinocchio",):
                run = thrown(impact_rig, engine, law=CustomNormal(**made))
                assert run.outcome is Outcome.FUNCTION_FAILED, (name, compiled, engine, run.message)
                assert f"joint 'hole': radial law: {name} of depth = " in run.message
    run = thrown(impact_rig, friction=CustomFriction(coefficient=no_grip))
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert "friction law: coefficient of slip speed" in run.message and "gave -1" in run.message


@pytest.mark.parametrize("how", ["nan", "normal", "pose", "nothing"])
def test_a_backend_is_held_to_its_rows(impact_rig, how):
    geometry = PlanarClearance(bearing_radius=0.01, journal_radius=0.009)
    run = thrown(impact_rig, backend=Backend(geometry, how))
    assert run.outcome is Outcome.FUNCTION_FAILED, run.message
    assert "joint 'hole': geometry: query of journal at x = " in run.message


# --- events ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_an_event_without_an_answer_does_not_pass_in_silence(engine):
    late = Event(name="late", when=lambda moment: math.nan if moment.time > LATE else -1.0)
    drive = CallableDrive(joint="j", torque=numba.njit(lambda t, angle, rate: 0.1))
    settings = RunSettings(engine=engine)
    run = turned(drive, events=[late], settings=settings)
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert "event 'late': when of the moment t = 0.3" in run.message and "gave nan" in run.message
    with pytest.raises(FunctionError, match="event 'yes': when must give a finite number, got true of the"):
        turned(drive, events=[Event(name="yes", when=lambda moment: moment.time < 1.0)], settings=settings)


JUMPS = {
    "number": lambda moment: 3.0,
    "one": lambda moment: (moment.q,),
    "nan": lambda moment: (moment.q, [math.nan]),
    "complex": lambda moment: (moment.q, [1j]),
    "length": lambda moment: (2.0 * moment.q, moment.v),
    "error": lambda moment: 1.0 / 0.0,
}


@pytest.mark.parametrize("how", JUMPS)
def test_a_jump_to_no_state_is_told(how):
    jump = Event(name="hop", when=lambda moment: moment.time - LATE, action=Jump(JUMPS[how]))
    run = turned(CallableDrive(joint="j", torque=lambda t, a, w: 0.1), events=[jump])
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert run.message.startswith("at t = 0.3 s, event 'hop': change of the moment t = 0.3 s gave ")


def test_what_a_function_is_handed_is_its_own():
    """It may write there what it likes: the run does not see it."""

    def meddling(moment: Moment) -> float:
        for part in (moment.q, moment.v, moment.x, moment.memory):
            part[:] = 17.0
        return -1.0

    drive = CallableDrive(joint="j", torque=lambda t, a, w: 0.1)
    runs = [turned(drive, events=[Event(name="e", when=when)]) for when in (meddling, lambda moment: -1.0)]
    assert np.array_equal(runs[0].data.q, runs[1].data.q)
