"""Equilibria against closed forms, and against a long damped run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import AntennaPinError, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.contact import Hertz
from antenna_pin.dynamics import JointSpring, PointSpring
from antenna_pin.elements import OutsideForce, RigidStop, StickingFriction
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import RevoluteClearance
from antenna_pin.studies.statics import equilibria

G = 9.81


def test_over_centre_spring(bar: Callable[..., Any]):
    """A spring from (-b, 0) to the bar's end at a: rest where it is straight, folded, and of free length."""
    a, b, free, k = 0.8, 0.5, 1.1, 300.0
    spring = PointSpring(
        first=("world", (-b, 0.0, 0.0)), second=("bar", (a, 0.0, 0.0)), free_length=free, stiffness=k
    )
    found = equilibria(System(bar(kind="continuous"), springs={"coil": spring}))
    angles = np.array([one.positions["hinge"] for one in found])
    relaxed = np.arccos((free**2 - a**2 - b**2) / (2.0 * a * b))
    turned = np.sort(np.mod(angles + 1e-9, 2.0 * np.pi))
    # Newton's method to round-off of the forces, k a b, over the stiffness.
    assert turned == pytest.approx([0.0, relaxed, np.pi, 2.0 * np.pi - relaxed], abs=1e-8)
    for one in found:
        phi = one.positions["hinge"]
        length = np.sqrt(a**2 + b**2 + 2.0 * a * b * np.cos(phi))
        slope = a * b * np.sin(phi) / length
        curvature = k * slope**2 - k * (length - free) * (a * b * np.cos(phi) + slope**2) / length
        # Central differences with steps of 2e-5 rad: their square, times the fourth derivative.
        assert one.stiffness[0] == pytest.approx(curvature, rel=1e-7)
        assert one.stability == ("stable" if curvature > 0.0 else "unstable")


def test_friction_under_load_makes_a_set(bar: Callable[..., Any]):
    """A bar hangs where |m g l cos phi| is at most T + mu r m g, its static friction: both ends."""
    friction = StickingFriction(joint="hinge", coulomb=0.1, static=0.3, coefficient=0.2, radius=0.01)
    system = System(bar(G, "continuous"), elements={"frictions": {"dry": friction}})
    weight = 2.0 * G
    off = np.arcsin((0.3 + 0.2 * 0.01 * weight) / (0.5 * weight))
    hanging = next(one for one in equilibria(system) if one.stability == "stable")
    bottom = hanging.positions["hinge"]
    assert np.cos(bottom) == pytest.approx(0.0, abs=1e-12)
    ends = sorted(one.positions["hinge"] - bottom for one in hanging.ends)
    assert ends == pytest.approx([-off, off], abs=1e-10)  # round-off of the torque over the stiffness
    assert hanging.reactions["hinge"][:3] == pytest.approx([0.0, weight, 0.0], abs=1e-9)


def test_pin_in_its_bore_under_a_couple():
    """Tilted until both ends of the bore bear: depth, arm and moment by trigonometry."""
    body = """<robot name="b"><link name="ground"/><link name="body"><inertial><mass value="2"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hole" type="continuous"><parent link="ground"/><child link="body"/><axis xyz="0 0 1"/></joint>
</robot>"""
    radius, play, length, k, couple = 0.01, 2e-4, 0.05, 1e10, 7.0
    geometry = RevoluteClearance.from_clearances(
        bearing_radius=radius,
        radial_clearance=play,
        bearing_length=length,
        axial_clearance=1e-3,
        bearing_outer_radius=0.012,
        flange_radius=0.014,
    )
    law = Hertz(stiffness=k)
    joint = ClearanceJoint(name="hole", geometry=geometry, radial=law, axial=law)
    mechanism = build_mechanism(Urdf.from_text(body, "b").variant(joints={"hole": "free"}), "fixed")
    force = OutsideForce(at=("body", (0.0, 0.0, 0.0)), torque=(0.0, couple, 0.0), axes="world")
    system = System(mechanism, clearances=[joint], elements={"forces": {"couple": force}})
    found = equilibria(system, hold=["hole"])[0]

    def short(tilt: float) -> float:
        depth = 0.5 * length * np.sin(tilt) + (radius - play) - radius * np.cos(tilt)
        arm = 0.5 * length * np.cos(tilt) + radius * np.sin(tilt)
        return 2.0 * arm * k * max(depth, 0.0) ** 1.5 - couple

    tilt = brentq(short, 0.0, 0.02, xtol=1e-16)
    depth = 0.5 * length * np.sin(tilt) + (radius - play) - radius * np.cos(tilt)
    touching = {one.name: one for one in found.contacts}
    assert touching.keys() == {"hole.radial+", "hole.radial-"}
    for one in touching.values():
        # Round-off of a gap, 1e-17 m, over the depth of 5.8e-6 m, and of the poses.
        assert one.depth == pytest.approx(depth, rel=1e-8)
        assert one.force == pytest.approx(k * depth**1.5, rel=1e-8)
    quaternion = found.state[3:7]
    assert 2.0 * np.arcsin(np.hypot(quaternion[0], quaternion[1])) == pytest.approx(tilt, rel=1e-8)


def test_journal_rests_as_after_a_long_run():
    """A pendulum on a hinge with play, let go and damped: its run ends where the equilibrium is."""
    changes = {
        "clearance.hinge.friction": {"replace": True, "law": "none"},
        "springs.hinge.stiffness": 4.0,
        "springs.hinge.rest_angle": 0.5,
        "clearance.hinge.geometry": "closed-form",
        "integrator.method": "radau5",
        "output.rate": 100.0,
    }
    scenario = load_scenario("pendulum", "planar-rest", changes)
    run = simulate(scenario, duration=5.0)
    found = equilibria(scenario)[0]
    assert found.stability == "stable"
    # The run is damped with about 5 / s, so that e^-25 is left of its start, and its tolerance is 1e-10.
    assert float(run.data["motion_angle"][-1].item()) == pytest.approx(found.positions["hinge"], abs=1e-9)
    own = float(run.data["depth"][-1].max())
    assert found.contacts[0].depth == pytest.approx(own, rel=1e-7)


def test_rigid_stop_holds_a_bar(bar: Callable[..., Any]):
    """A bar falls on its stop, whose torque is that of the weight; it is held, not free to move."""
    stop = RigidStop(joint="hinge", lower=-0.4, restitution=0.5)
    found = equilibria(System(bar(G), elements={"stops": {"stop": stop}}))
    held = [one for one in found if one.stability == "held"]
    assert len(held) == 1
    assert held[0].positions["hinge"] == pytest.approx(-0.4, abs=1e-12)
    assert held[0].holding["stops.stop"] == pytest.approx(2.0 * G * 0.5 * np.cos(0.4), rel=1e-12)


def test_two_coupled_bars_have_four_equilibria(bar: Callable[..., Any]):
    """A double pendulum: each bar up or down, one of four stable; random starts find them."""
    link = '<link name="{0}"><inertial><origin xyz="0.5 0 0"/><mass value="2"/><inertia ixx="0.1" iyy="0.1" '
    link += 'izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    joint = (
        '<joint name="{0}" type="continuous"><parent link="{1}"/><child link="{2}"/><origin xyz="{3} 0 0"/>'
    )
    joint += '<axis xyz="0 0 1"/></joint>'
    text = f'<robot name="two"><link name="bus"/>{link.format("a")}{link.format("b")}'
    text += f"{joint.format('one', 'bus', 'a', 0)}{joint.format('two', 'a', 'b', 1)}</robot>"
    system = System(build_mechanism(Urdf.from_text(text, "two"), "fixed", (0.0, -G, 0.0)))
    found = equilibria(system, starts=24)
    kinds = {(round(np.sin(e.positions["one"])), round(np.cos(e.positions["two"]))) for e in found}
    assert kinds == {(-1, 1), (-1, -1), (1, 1), (1, -1)}
    assert sum(one.stability == "stable" for one in found) == 1


def test_hinges_with_play_unfold_to_where_ideal_ones_do():
    """Each turns by half a turn, counted; springs and cables are couples, so no journal is loaded."""
    play, ideal = (equilibria(load_scenario("solar_array", case), starts=0) for case in ("play", "ideal"))
    assert len(play) == len(ideal) == 1
    assert play[0].stability == ideal[0].stability == "stable"
    assert play[0].positions == pytest.approx(ideal[0].positions, abs=1e-12)  # round-off of half a turn
    assert not play[0].contacts


def test_refusals(bar: Callable[..., Any]):
    """One line each: nothing free, a free base under gravity, no such joint."""
    system = System(bar(G), springs={"k": JointSpring(joint="hinge", stiffness=1.0)})
    with pytest.raises(AntennaPinError, match="something must be free to move"):
        equilibria(system, hold=["hinge"])
    with pytest.raises(AntennaPinError, match="joint 'hing' is unknown; did you mean hinge"):
        equilibria(system, hold=["hing"])
    with pytest.raises(AntennaPinError, match="a free base under gravity must be held"):
        equilibria(load_scenario("bai2020", overrides={"mechanism.gravity": [0, 0, -9.81]}))
