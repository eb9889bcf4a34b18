"""Elements that begin switched off: they hold nothing and refuse nothing until an event switches them on."""

import dataclasses
import math
import re

import numpy as np
import pytest
from wheel import INERTIA, wheel_urdf

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System
from antenna_pin.elements import (
    EndStop,
    JointSpring,
    Latch,
    MaxwellSlip,
    RigidLatch,
    RigidStop,
    StickingFriction,
    TableSpring,
)
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import build_mechanism
from antenna_pin.run.session import start
from antenna_pin.run.simulation import Angle, Event, Set, Time
from antenna_pin.studies.linear import modes
from antenna_pin.trajectory import Outcome

STIFFNESS, REST = INERTIA, 0.3  # 1 rad/s: q = 0.3 (1 - cos t) from rest at zero
LATER = 2.3  # [s]: at 0.4999 rad, with 0.2237 rad/s

# What would hold the wheel at zero, or be in its way there, were it on.
HOLDS = {
    "friction": ("frictions", StickingFriction(joint="axle", coulomb=0.02, on=False)),
    "much friction": ("frictions", StickingFriction(joint="axle", coulomb=2.0, static=3.0, on=False)),
    "rigid latch": ("latches", RigidLatch(joint="axle", angle=0.0, width=0.01, on=False)),
    "latch": ("latches", Latch(joint="axle", angle=0.0, width=0.01, stiffness=50.0, on=False)),
    "rigid stop, on it": ("stops", RigidStop(joint="axle", upper=0.0, restitution=0.5, on=False)),
    "rigid stop, beyond": ("stops", RigidStop(joint="axle", upper=-0.2, restitution=0.5, on=False)),
    "stop, beyond": ("stops", EndStop(joint="axle", upper=-0.2, stiffness=9.0, restitution=0.5, on=False)),
    "slip": ("springs", MaxwellSlip(joint="axle", stiffness=(2.0,), slip=(0.3,), rest_angle=-0.1, on=False)),
    "table": (
        "springs",
        TableSpring(joint="axle", angle=(1.0, 2.0), torque=(1.0, -1.0), outside="refuse", on=False),
    ),
}
# What acts from 0.4999 rad on, which it neither holds nor bars at once.
ACTS = {
    **{name: HOLDS[name] for name in ("friction", "much friction", "slip")},
    "falling friction": (
        "frictions",
        StickingFriction(joint="axle", coulomb=0.02, static=0.06, stribeck_rate=0.05, on=False),
    ),
    "latch around": ("latches", Latch(joint="axle", angle=0.5, width=0.05, stiffness=50.0, on=False)),
    "rigid latch aside": ("latches", RigidLatch(joint="axle", angle=0.1, width=0.05, on=False)),
    "rigid stop": ("stops", RigidStop(joint="axle", upper=0.55, restitution=0.5, on=False)),
    "stop": ("stops", EndStop(joint="axle", upper=0.55, stiffness=90.0, restitution=0.5, on=False)),
    "stop, beyond": ("stops", EndStop(joint="axle", upper=0.3, stiffness=9.0, restitution=0.5, on=False)),
}


def _wheel(family="springs", element=None):
    elements = {"springs": {"coil": JointSpring(joint="axle", stiffness=STIFFNESS, rest_angle=REST)}}
    if element is not None:
        elements.setdefault(family, {})["x"] = element
    springs = elements.pop("springs")
    mechanism = build_mechanism(wheel_urdf("revolute"), "fixed")
    return System(mechanism, springs=springs, elements=elements)


def _run(system, duration, engine="pinocchio", events=(), q=0.0, v=0.0):
    settings = RunSettings(rtol=1e-10, output_rate=20.0, engine=engine)
    return simulate(system, q=[q], v=[v], duration=duration, settings=settings, events=list(events))


def _acting(element):
    return dataclasses.replace(element, on=True)


def _on(family, when):
    return Event(name="on", when=when, action=Set(f"{family}.x.on", True))


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("name", HOLDS)
def test_what_is_off_lets_the_joint_go(name, engine):
    """The free oscillation, through the whole of it, from where it would hold or bar the joint."""
    family, element = HOLDS[name]
    run = _run(_wheel(family, element), 4.0, engine)
    assert run.completed and run.data.sizes.get("change", 0) == 0
    # Errors of 1e-10 of each step, some hundred steps.
    assert np.abs(run.data.q.values[:, 0] - REST * (1.0 - np.cos(run.data.time.values))).max() < 1e-8


@pytest.mark.parametrize("name", HOLDS)
def test_what_is_off_is_not_in_small_motions(name):
    """1 rad/s of the spring alone; differences know it to 1e-6."""
    found = modes(_wheel(*HOLDS[name]), q=[0.0])
    assert found.frequency == pytest.approx([1.0 / (2.0 * math.pi)], rel=1e-6)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("name", ACTS)
def test_what_is_switched_on_later_acts_as_if_the_run_began_there(name, engine):
    family, element = ACTS[name]
    system = _wheel(family, element)
    later = _run(system, 4.0, engine, [_on(family, Time(LATER))])
    q, v = REST * (1.0 - math.cos(LATER)), REST * math.sin(LATER)
    begun = _run(_wheel(family, _acting(element)), 4.0 - LATER, engine, q=q, v=v)
    assert later.completed and begun.completed
    for one in ("q", "v"):
        # Errors of 1e-10 of each step, some hundred steps, magnified by a blow.
        assert later.data[one].values[-1, 0] == pytest.approx(begun.data[one].values[-1, 0], abs=1e-7)


@pytest.mark.parametrize("holding", [True, False])
def test_friction_switched_on_at_rest_sticks_if_it_is_enough(holding):
    """At its turning point, 0.6 rad, the spring pulls with 0.15 N m."""
    level = 0.16 if holding else 0.14
    system = _wheel("frictions", StickingFriction(joint="axle", coulomb=level, on=False))
    run = _run(system, 5.0, events=[_on("frictions", Time(math.pi))])
    # Else it swings about the place where friction balances the spring, 0.3 + 0.28 rad.
    end = 0.6 if holding else 0.58 + 0.02 * math.cos(5.0 - math.pi)
    assert run.data.q.values[-1, 0] == pytest.approx(end, abs=1e-8)


@pytest.mark.parametrize(
    ("place", "value", "said"),
    [
        (
            "on",
            True,
            r"rigid stop: position of axle must be within its rigid stop, upper = 0\.2; .*got 0\.49",
        ),
        ("upper", 0.1, r"event 'late' sets stops\.x\.upper = 0\.1: rigid stop: .*upper = 0\.1; .*got 0\.49"),
    ],
)
def test_a_rigid_stop_does_not_come_to_be_behind_the_joint(place, value, said):
    """Nothing says how the joint would come back; the run so far is kept, the joint where it was."""
    stop = RigidStop(joint="axle", upper=0.2 if place == "on" else 0.55, restitution=0.5, on=place != "on")
    late = Event(name="late", when=Time(LATER), action=Set(f"stops.x.{place}", value))
    run = _run(_wheel("stops", stop), 4.0, events=[late])
    assert run.outcome is Outcome.REFUSED
    assert float(run.data.time[-1]) == LATER
    assert run.data.q.values[-1, 0] == pytest.approx(REST * (1.0 - math.cos(LATER)), abs=1e-8)
    assert re.search(said, run.message)


def test_a_session_refuses_such_a_command_and_goes_on():
    """Nothing is changed: it swings on as if nothing had been commanded."""
    system = _wheel("stops", RigidStop(joint="axle", upper=0.2, restitution=0.5, on=False))
    session = start(system, settings=RunSettings(rtol=1e-10))
    session.step(LATER)
    with pytest.raises(InvalidParameterError, match=r"within its rigid stop, upper = 0\.2; .*got 0\.49"):
        session.on("stops.x")
    assert session.step(4.0 - LATER)
    assert session.trajectory().data.q.values[-1, 0] == pytest.approx(REST * (1.0 - math.cos(4.0)), abs=1e-8)


def test_a_rigid_stop_may_be_switched_on_where_the_joint_is_at_it():
    """The event that switches it is located on the stop itself, to round-off: half of the rate comes back."""
    system = _wheel("stops", RigidStop(joint="axle", upper=0.4, restitution=0.5, on=False))
    run = _run(system, 2.5, events=[_on("stops", Angle("axle", 0.4))])
    assert run.completed
    t = math.acos(1.0 - 0.4 / REST)
    assert [float(one) for one in run.data.change_time] == pytest.approx([t], abs=1e-8)
    back = -0.5 * REST * math.sin(t)
    expected = REST + 0.1 * math.cos(2.5 - t) + back * math.sin(2.5 - t)
    assert run.data.q.values[-1, 0] == pytest.approx(expected, abs=1e-8)


def test_a_rigid_stop_that_leaves_a_joint_at_rest_on_it_lets_it_go():
    """At 0.2 rad the spring still pushes with 0.05 N m: about 0.3 rad by 0.1 rad from then on."""
    system = _wheel("stops", RigidStop(joint="axle", upper=0.2, restitution=0.0))
    moved = Event(name="moved", when=Time(2.0), action=Set("stops.x.upper", 0.9))
    run = _run(system, 4.0, events=[moved])
    assert run.completed
    assert run.data.q.values[-1, 0] == pytest.approx(REST - 0.1 * math.cos(2.0), abs=1e-8)


def test_a_table_that_is_off_ends_no_run_until_it_is_switched_on():
    """The joint is beyond its table at 2.3 s, which ends the run; from 0.1 rad on it ends at 0.2 rad."""
    table = TableSpring(
        joint="axle", angle=(-0.1, 0.2), torque=(0.0, 0.0), interpolation="linear", outside="refuse", on=False
    )
    late = _run(_wheel("springs", table), 4.0, events=[_on("springs", Time(LATER))])
    assert late.outcome is Outcome.STOPPED
    assert float(late.data.time[-1]) == pytest.approx(LATER, abs=1e-12)
    early = _run(_wheel("springs", table), 4.0, events=[_on("springs", Angle("axle", 0.1))])
    assert early.outcome is Outcome.STOPPED
    assert float(early.data.time[-1]) == pytest.approx(math.acos(1.0 - 0.2 / REST), abs=1e-8)


def test_what_is_on_still_refuses_its_start():
    with pytest.raises(InvalidParameterError, match="within its rigid stop, upper = -0.2; start it there"):
        _run(_wheel("stops", _acting(HOLDS["rigid stop, beyond"][1])), 1.0)
