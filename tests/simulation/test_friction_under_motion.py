"""Friction, stops and latches at joints whose rate motions prescribe, their own or that of others."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import RunSettings, simulate
from antenna_pin.dynamics import System, assembled
from antenna_pin.dynamics.constraints import Anchor, Closure, Coupling
from antenna_pin.elements import (
    EndStop,
    PrescribedMotion,
    RigidLatch,
    RigidStop,
    SCurve,
    StickingFriction,
    Sum,
)
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.simulation import Event, Set, Time
from antenna_pin.trajectory import Outcome

LIMIT = '<limit lower="-9" upper="9" effort="1e9" velocity="1e9"/>'
PAIR = f"""<robot name="pair"><link name="base"/>
<joint name="hinge" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>{LIMIT}</joint>
<link name="arm"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="two" type="revolute"><parent link="base"/><child link="leg"/><axis xyz="0 0 1"/>{LIMIT}</joint>
<link name="leg"><inertial><mass value="1"/>
<inertia ixx="0.1" iyy="0.1" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
FOUR = f"""<robot name="four"><link name="g"/>
<link name="a"><inertial><origin xyz="0.25 0 0"/><mass value="1"/>INERTIA</inertial></link>
<link name="b"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>INERTIA</inertial></link>
<link name="c"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>INERTIA</inertial></link>
<joint name="ja" type="revolute"><parent link="g"/><child link="a"/><axis xyz="0 0 1"/>{LIMIT}</joint>
<joint name="jb" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.5 0 0"/>
<axis xyz="0 0 1"/>{LIMIT}</joint>
<joint name="jc" type="revolute"><parent link="g"/><child link="c"/><origin xyz="1 0 0"/>
<axis xyz="0 0 1"/>{LIMIT}</joint></robot>""".replace(
    "INERTIA", '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
)
AT = np.array([1.0, 0.0, 0.0])
AMOUNT, OMEGA, LEVEL = 0.3, 4.0 * np.pi, 0.5
SINE = PrescribedMotion(joint="hinge", amplitude=AMOUNT, frequency=2.0)
SLEW = SCurve(end=np.pi / 3, rate=np.pi / 3, acceleration=2 * np.pi / 3, jerk=10 * np.pi / 3, start=0.5)
SETTINGS = RunSettings(rtol=1e-10, output_rate=160.0)


def pair(motion: PrescribedMotion = SINE, couplings=None, **elements) -> System:
    mechanism = build_mechanism(Urdf.from_text(PAIR, "pair.urdf"), "fixed", (0, 0, 0))
    drives = {"motor": motion}
    return System(mechanism, drives=drives, couplings=couplings or {}, elements=elements)


def ran(system: System, duration: float = 1.0, settings: RunSettings = SETTINGS, **more):
    q, v = assembled(system, system.neutral())
    return simulate(system, q=q, v=v, duration=duration, settings=settings, **more)


def dry(joint: str, **more) -> dict[str, StickingFriction]:
    return {"f": StickingFriction(joint=joint, coulomb=LEVEL, **more)}


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize(
    "more", [{}, {"viscous": 0.2}, {"static": 0.8, "stribeck_rate": 0.4}], ids=["dry", "viscous", "stribeck"]
)
def test_the_torque_of_a_motion_is_that_of_inertia_and_friction(engine, more):
    """Closed form at all samples where the joint moves; at its turning points it slips on the other way."""
    settings = RunSettings(rtol=1e-10, output_rate=160.0, engine=engine)
    run = ran(pair(frictions=dry("hinge", **more)), settings=settings)
    assert run.outcome is Outcome.COMPLETED
    t = run.data["time"].values
    rate = AMOUNT * OMEGA * np.cos(OMEGA * t)
    friction = StickingFriction(joint="hinge", coulomb=LEVEL, **more)
    static, fade = friction.static or LEVEL, 0.0
    if friction.stribeck_rate is not None:
        fade = np.exp(-((rate / friction.stribeck_rate) ** 2))
    dissipative = np.sign(rate) * (LEVEL + (static - LEVEL) * fade) + friction.viscous * rate
    torque = -0.1 * AMOUNT * OMEGA**2 * np.sin(OMEGA * t) + dissipative
    moves = abs(rate) > 1e-6
    assert moves.sum() > 0.9 * len(t)
    assert abs(run.data["drive_torque"].values[:, 0] - torque)[moves].max() < 1e-11  # round-off
    assert abs(run.data["energy_error"].values).max() < 1e-9  # tolerance of the run


def test_a_joint_that_stands_has_the_friction_of_the_way_it_came():
    """Of a slew from rest to rest: none before it has moved, and the last one behind."""
    run = ran(pair(PrescribedMotion(joint="hinge", follows=SLEW), frictions=dry("hinge")), duration=2.5).data
    t, torque = run["time"].values, run["drive_torque"].values[:, 0]
    wanted = np.array([0.1 * SLEW.at(s)[2] + (LEVEL if s > 0.5 else 0.0) for s in t.tolist()])
    around = abs(t - 0.5) < 1e-9
    assert abs(torque - wanted)[~around].max() < 1e-10


def test_it_slips_back_where_the_motion_comes_back_after_a_rest():
    """The sign changes as it moves again, not by round-off while it stands."""
    back = SCurve(end=-1.0, rate=1.0, acceleration=2.0, jerk=20.0, start=1.0)
    to = SCurve(end=1.0, rate=5.0, acceleration=20.0, jerk=200.0)
    motion = PrescribedMotion(joint="hinge", follows=Sum(parts=(to, back)))
    run = ran(pair(motion, frictions=dry("hinge")), duration=2.0)
    changes = [name.rpartition(": ")[2] for name in run.data["change"].values]
    assert changes == ["slips forward", "slips backward"]
    times = run.data["change_time"].values
    # The rate passes 1e-10 rad/s at once, for it grows by 10 t^2.
    assert times == pytest.approx([0.0, 1.0], abs=1e-5)
    assert abs(run.data["energy_error"].values).max() < 1e-9


@pytest.mark.parametrize("multiplier", [2.0, -0.5])
def test_friction_at_a_coupled_joint_is_carried_by_the_motion(multiplier):
    """The motor's torque is that of both inertias and of the follower's friction, by the ratio."""
    coupling = Coupling(follower="two", leader="hinge", multiplier=multiplier)
    run = ran(pair(couplings={"gear": coupling}, frictions=dry("two"))).data
    t = run["time"].values
    inertia = 0.1 + 0.05 * multiplier**2
    rate = np.cos(OMEGA * t)
    torque = -inertia * AMOUNT * OMEGA**2 * np.sin(OMEGA * t) + abs(multiplier) * LEVEL * np.sign(rate)
    moves = abs(rate) > 1e-6
    assert abs(run["drive_torque"].values[:, 0] - torque)[moves].max() < 1e-10


def four(drive: str = "ja", **elements) -> System:
    mechanism = build_mechanism(Urdf.from_text(FOUR, "four.urdf"), "fixed", (0, 0, 0))
    closure = Closure(
        kind="revolute",
        first=Anchor(link="b", rotation=np.eye(3), origin=AT),
        second=Anchor(link="c", rotation=np.eye(3), origin=AT),
    )
    drives = {"motor": PrescribedMotion(joint=drive, position=1.0, amplitude=0.3, frequency=2.0)}
    return System(mechanism, closures={"pin": closure}, drives=drives, elements=elements)


def test_friction_in_a_loop_that_a_motion_moves_takes_the_drives_work():
    """What the drive does over whole periods is what friction takes: 4 A T a period of its joint."""
    system = four(frictions={"f": StickingFriction(joint="jb", coulomb=LEVEL)})
    q, v = assembled(system, [1.0, 0.3, 1.2])
    run = simulate(system, q=q, v=v, duration=1.0, settings=SETTINGS)
    assert run.outcome is Outcome.COMPLETED
    data = run.data
    way = np.abs(np.diff(data["q"].values[:, 1])).sum()
    taken = data["element_loss"].values[-1].sum()
    assert abs(data["energy_error"].values).max() < 1e-8
    # The way by samples misses the turning points by what a joint moves there in 3 ms.
    assert taken == pytest.approx(LEVEL * way, rel=2e-3)
    assert data["drive_work"].values[-1, 0] == pytest.approx(taken, rel=1e-6)


@pytest.mark.parametrize("joint", ["hinge", "two"])
@pytest.mark.parametrize(
    ("family", "element"),
    [
        ("stops", lambda joint: RigidStop(joint=joint, upper=0.2, restitution=0.5)),
        ("latches", lambda joint: RigidLatch(joint=joint, angle=0.2)),
    ],
)
def test_a_rigid_stop_or_latch_where_motions_move_the_joint_is_refused_by_name(family, element, joint):
    coupling = Coupling(follower="two", leader="hinge", multiplier=2.0)
    system = pair(couplings={"gear": coupling}, **{family: {"x": element(joint)}})
    with pytest.raises(
        AntennaPinError, match=f"'x': its joint '{joint}' is held to a motion by drive 'motor'"
    ):
        ran(system)


def test_in_a_loop_too():
    system = four(latches={"x": RigidLatch(joint="jc", angle=0.2)})
    q, v = assembled(system, [1.0, 0.3, 1.2])
    with pytest.raises(
        AntennaPinError, match="latch 'x': its joint 'jc' is held to a motion by drive 'motor'"
    ):
        simulate(system, q=q, v=v, duration=0.1)


def test_one_that_is_off_does_no_harm_and_is_refused_where_it_is_switched_on():
    off = {"x": RigidStop(joint="hinge", upper=0.2, restitution=0.5, on=False)}
    assert ran(pair(stops=off), duration=0.1).outcome is Outcome.COMPLETED
    event = Event(name="e", when=Time(0.05), action=Set("stops.x.on", True))
    with pytest.raises(AntennaPinError, match="stop 'x': its joint 'hinge' is held to a motion"):
        ran(pair(stops=off), duration=0.1, events=[event])


def test_a_latch_that_comes_to_hold_what_motions_move_by_then_ends_the_run_by_name():
    """three = hinge + two: once a latch holds `two`, the motion moves `three`, and none can hold that."""
    leg = PAIR[PAIR.index('<joint name="two"') : PAIR.index("</robot>")]
    text = PAIR.replace("</robot>", leg.replace('"two"', '"three"').replace('"leg"', '"foot"') + "</robot>")
    mechanism = build_mechanism(Urdf.from_text(text, "three.urdf"), "fixed", (0, 0, 0))
    coupling = Coupling(follower="three", leader="hinge", second="two", second_multiplier=1.0)
    latches = {"a": RigidLatch(joint="two", angle=0.1), "b": RigidLatch(joint="three", angle=0.25)}
    system = System(
        mechanism,
        drives={"motor": PrescribedMotion(joint="hinge", rate=0.2)},
        couplings={"gear": coupling},
        elements={"latches": latches},
    )
    q, v = assembled(system, system.neutral(), [0.2, 0.5, 0.7], held=("two",))
    run = simulate(system, q=q, v=v, duration=2.0, settings=SETTINGS)
    assert run.outcome is Outcome.REFUSED
    assert "latch 'b': its joint 'three' is held to a motion by drive 'motor'" in run.message
    three = float(run.data["q"].values[-1, system.mechanism.joint("three").q.start])
    assert three == pytest.approx(0.25, abs=1e-9)  # where it would have been captured


def test_a_stop_that_gives_way_may_stand_there():
    """The motion presses it in; the ledger closes."""
    stops = {"x": EndStop(joint="hinge", upper=0.2, stiffness=100.0, restitution=0.5)}
    run = ran(pair(stops=stops), duration=0.4)
    assert run.outcome is Outcome.COMPLETED
    assert abs(run.data["energy_error"].values).max() < 1e-8


def test_a_free_joint_beside_a_moved_one_still_sticks():
    """The second joint is not the motion's: nothing turns it, and it stays."""
    run = ran(pair(frictions=dry("two")), duration=0.2).data
    assert run.sizes.get("change", 0) == 0
    assert abs(run["q"].values[:, 1]).max() == 0.0
