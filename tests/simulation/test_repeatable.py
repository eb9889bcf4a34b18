"""A function of a user's with a memory, of chance or of the clock is found out, whatever kind it is."""

import dataclasses
import itertools
import math
import random

import numba
import numpy as np
import pytest

from antenna_pin import Outcome, RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.contact import CustomFriction, CustomNormal, Hertz, NoFriction
from antenna_pin.elements import CallableDrive, CallableMotion, JointSpring, SineDrive
from antenna_pin.run.simulation import Event, function_checks

ARM = """<robot name="arm"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j" type="continuous"><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint>
<link name="tip"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
STIFF = 1e6


def arm(drive, **springs):
    mechanism = build_mechanism(Urdf.from_text(ARM, "arm.urdf"), base="fixed")
    return System(mechanism, drives={"m": drive}, springs=springs)


def driven(torque, duration=2.0, **more):
    return simulate(arm(CallableDrive(joint="j", torque=torque)), duration=duration, v=[0.3], **more)


class Sampled:
    """A controller with zero-order hold: its output is computed where a new period begins."""

    def __init__(self, rate=100.0, integral=1.0):
        self.rate, self.integral, self.n, self.u, self.i = rate, integral, -1, 0.0, 0.0

    def __call__(self, t, angle, speed):
        n = int(t * self.rate + 1e-9)
        if n != self.n:
            self.i += (-0.5 - angle) / self.rate
            self.u, self.n = 5.0 * (-0.5 - angle) + self.integral * self.i - 3.0 * speed, n
        return self.u


class Backlash:
    """The play operator: its state moves only where the angle drags it along."""

    def __init__(self, width=0.05):
        self.width, self.state = width, 0.0

    def __call__(self, t, angle, speed):
        self.state = min(max(self.state, angle - self.width), angle + self.width)
        return -2.0 * self.state


class Relay:
    """A switch with hysteresis: it remembers at which of two thresholds the angle has been last."""

    def __init__(self):
        self.value = 0.2

    def __call__(self, t, angle, speed):
        if abs(angle) > 0.1:
            self.value = -math.copysign(0.2, angle)
        return self.value


class Filter:
    """A first-order filter over the calls."""

    def __init__(self):
        self.y = 0.0

    def __call__(self, t, angle, speed):
        self.y += 0.1 * (angle - self.y)
        return -self.y


def clock():
    ticks = itertools.count()
    return lambda t, angle, speed: 1e-9 * next(ticks)


def late():
    """One that counts its calls and changes its mind once."""
    calls = itertools.count()
    return lambda t, angle, speed: -0.1 if next(calls) > 700 else 0.1


@numba.njit
def chance(t, angle, speed):
    return 1e-3 * np.random.random()


MEMORIES = {
    "pid": (lambda: Sampled(), 0.05),  # found within five periods
    "hold without integral": (lambda: Sampled(integral=0.0), 0.1),
    "slow pid": (lambda: Sampled(rate=2.0), 1.5),
    "fast pid": (lambda: Sampled(rate=1e4), 0.01),
    "backlash": (Backlash, 1.0),
    "relay": (Relay, 1.9),
    "filter": (Filter, 0.1),
    "chance": (lambda: lambda t, angle, speed: random.gauss(0.0, 1e-6), 0.1),
    "clock": (clock, 0.1),
    "late": (late, 1.9),
}


@pytest.mark.parametrize("kind", MEMORIES)
def test_a_drive_with_a_memory_is_found_out(kind):
    random.seed(1)
    made, until = MEMORIES[kind]
    run = driven(made())
    assert run.outcome is Outcome.FUNCTION_WITH_MEMORY, run.message
    assert run.data.time.values[-1] <= until
    for part in ("drive 'm'", "torque of t = ", "angle = ", "rad/s gave", "and then", "sampled controller"):
        assert part in run.message
    assert not run.completed and run.data.q.shape[0] == run.data.time.size


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_chance_in_a_compiled_function_is_found_out(engine):
    run = driven(chance, settings=RunSettings(engine=engine, max_steps=20_000))
    assert run.outcome is Outcome.FUNCTION_WITH_MEMORY, run.message


def test_what_keeps_nothing_runs_as_before_bit_for_bit(monkeypatch):
    """Asked again or not, a function of state alone gives one and the same run; asking costs little."""
    calls = itertools.count()

    def held(t, angle, speed):
        next(calls)
        return 5.0 * (-0.5 - angle) - 0.2 * speed + 0.1 * math.sin(300.0 * t)

    asked = driven(held, duration=5.0)
    most = next(calls)
    monkeypatch.setattr(function_checks, "user_functions", lambda workspace, events: ())
    calls = itertools.count()
    plain = driven(held, duration=5.0)
    assert asked.completed and plain.completed
    assert np.array_equal(asked.data.q, plain.data.q) and np.array_equal(asked.data.v, plain.data.v)
    assert asked.counts.evaluations == plain.counts.evaluations
    # Beside the looks at the first steps and all that is kept at the end, three calls in 192.
    assert most - next(calls) < 0.017 * plain.counts.evaluations + 3 * 33 + 9


def test_a_motion_with_a_memory_is_found_out():
    class Drift:
        def __init__(self):
            self.calls = 0

        def __call__(self, t):
            self.calls += 1
            return math.sin(t) + 1e-13 * self.calls

    motion = CallableMotion(
        joint="j", position=Drift(), velocity=math.cos, acceleration=lambda t: -math.sin(t)
    )
    run = simulate(arm(motion), duration=1.0, v=[1.0])
    assert run.outcome is Outcome.FUNCTION_WITH_MEMORY
    assert "drive 'm': position of t = " in run.message


def law(force=None, energy=None, elastic=None):
    known = Hertz(stiffness=STIFF, exponent=1.0)
    return CustomNormal(
        force=force or (lambda depth, rate, speed: known.elastic_force(depth)),
        elastic_force=elastic or known.elastic_force,
        elastic_energy=energy or known.elastic_energy,
    )


class Yielding:
    """A plastic contact that keeps its largest depth."""

    def __init__(self):
        self.deepest = 0.0

    def __call__(self, depth, rate, speed):
        self.deepest = max(self.deepest, depth)
        return max(0.0, STIFF * (depth - 0.5 * self.deepest))


def thrown(system, duration=0.1, **more):
    return simulate(system, duration=duration, v=[0.1, 0.02, 1.0], **more)


def test_a_normal_law_with_a_memory_is_found_out(impact_rig):
    run = thrown(impact_rig(law(force=Yielding())))
    assert run.outcome is Outcome.FUNCTION_WITH_MEMORY, run.message
    assert "joint 'hole': radial law: force of depth = " in run.message
    assert "approach speed = " in run.message


def test_a_friction_law_with_a_memory_is_found_out(impact_rig):
    heat = itertools.count()
    warm = CustomFriction(coefficient=lambda speed: math.tanh(speed / 1e-6) * (0.1 + 1e-6 * next(heat)))
    run = thrown(impact_rig(law(), friction=warm))
    assert run.outcome is Outcome.FUNCTION_WITH_MEMORY, run.message
    assert "joint 'hole': friction law: coefficient of slip speed = " in run.message


class Bore:
    """A round bore whose radius grows with each look, or whose search is good to round-off only."""

    def __init__(self, wear, noise=0.0):
        self.wear, self.noise, self.calls = wear, noise, 0

    def query(self, pose, table, row, wanted=None):
        self.calls += 1
        centre = pose[0].centre
        distance = math.hypot(centre[0], centre[1])
        normal = -centre / distance if distance else np.array([1.0, 0.0, 0.0])
        play = 1e-3 + self.wear * self.calls + self.noise * (self.calls % 2)
        table[row].gap = play - distance
        table[row].normal = normal
        table[row].point = -0.01 * normal


@pytest.mark.parametrize("wear", [1e-9, 0.0])
def test_a_geometry_with_a_memory_is_found_out(impact_rig, wear):
    made = impact_rig(law(), friction=NoFriction())
    joint = dataclasses.replace(made.clearances[0], backend=Bore(wear, noise=1e-17))
    run = thrown(System(made.mechanism, clearances=[joint]))
    assert (run.outcome is Outcome.FUNCTION_WITH_MEMORY) == (wear > 0.0), run.message
    if wear:
        assert "joint 'hole': geometry: query of journal at x = " in run.message


@pytest.mark.parametrize("part", ["when", "rate"])
def test_an_event_with_a_memory_is_found_out(part):
    class Threshold:
        def __init__(self):
            self.calls = 0

        def __call__(self, moment):
            self.calls += part == "when"
            return moment.angle("j") - 0.5 - 1e-7 * self.calls * (part == "when")

        def rate(self, moment):
            self.calls += part == "rate"
            return moment.rate("j") + 1e-9 * self.calls * (part == "rate")

    swing = arm(
        SineDrive(joint="j", amplitude=1.0, frequency=1.0), coil=JointSpring(joint="j", stiffness=1.0)
    )
    run = simulate(swing, duration=1.0, events=[Event(name="there", when=Threshold())])
    assert run.outcome is Outcome.FUNCTION_WITH_MEMORY, run.message
    assert f"event 'there': {part} of the moment t = " in run.message


def test_an_event_of_contacts_that_keeps_nothing_is_not_accused(impact_rig):
    """It sees gaps, forces and what touches, which change: they are as they were when it is asked again."""
    seen = Event(
        name="hit", when=lambda moment: moment.force("hole.radial") - 1.0 + moment.touching("hole.radial")
    )
    for backend in ("closed-form", "coal"):
        made = impact_rig(law())
        joint = dataclasses.replace(made.clearances[0], backend=backend)
        run = thrown(System(made.mechanism, clearances=[joint]), events=[seen])
        assert run.outcome is Outcome.COMPLETED, run.message
        assert run.data.sizes["event"] > 2
