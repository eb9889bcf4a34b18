"""Quasi-static travels against virtual work and closed forms."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import AntennaPinError, System, Urdf, build_mechanism, load_scenario
from antenna_pin.dynamics import JointSpring, PointSpring
from antenna_pin.elements import (
    BoucWen,
    ConstantDrive,
    EndStop,
    Gear,
    HarnessSpring,
    JointFriction,
    LuGreFriction,
    MaxwellSlip,
)
from antenna_pin.studies.margins import margin
from antenna_pin.studies.statics import equilibria, statics, travel

from .conftest import BAR

G = 9.81


def test_torque_of_a_four_bar_is_the_slope_of_its_energy(four_bar: Callable[..., Any]):
    """Gravity and a spring at the knee: T = dV/dphi of positions that are solved here, by differences."""
    lengths, gravity, k, rest = (0.4, 1.1, 0.8), G, 7.0, 0.3
    mechanism, closures = four_bar(lengths, gravity)
    system = System(
        mechanism,
        closures=closures,
        springs={"coil": JointSpring(joint="knee", stiffness=k, rest_angle=rest)},
    )
    found = travel(system, "crank", start=0.3, stop=2.5, count=12)
    a, b, c = lengths

    def pose(phi: float, near: float) -> tuple[float, float]:
        elbow = a * np.array([np.cos(phi), np.sin(phi)])

        def gap(theta: float) -> float:
            end = elbow + b * np.array([np.cos(theta), np.sin(theta)])
            return float(np.hypot(*(end - [1.0, 0.0])) - c)

        return elbow, brentq(gap, near - 0.3, near + 0.3, xtol=1e-15)

    def energy(phi: float, near: float) -> float:
        elbow, theta = pose(phi, near)
        end = elbow + b * np.array([np.cos(theta), np.sin(theta)])
        down = np.array([1.0, 0.0]) - end
        rocker = np.arctan2(down[1], down[0])
        knee = np.mod(rocker - theta + np.pi, 2.0 * np.pi) - np.pi
        heights = [0.5 * elbow[1], 0.5 * (elbow[1] + end[1]), 0.5 * end[1]]
        return gravity * np.dot([1.0, 2.0, 3.0], heights) + 0.5 * k * (knee - rest) ** 2

    pins = found.data["joint_position"].sel(sense="out", joint="pin").values
    h = 1e-3
    for phi, pin, torque in zip(found.position, pins, found.torque, strict=True):
        near = phi + np.mod(pin + np.pi, 2.0 * np.pi) - np.pi
        values = [energy(phi + s * h, near) for s in (-2, -1, 1, 2)]
        slope = (values[0] - 8.0 * values[1] + 8.0 * values[2] - values[3]) / (12.0 * h)
        # Differences of fourth order: 1e-12 over the energy, and round-off, 1e-14 / h.
        assert torque == pytest.approx(slope, abs=1e-9)
    # Without friction the way back needs the same; what holds the pivot holds the weight with the pin's base.
    assert found.torque_back == pytest.approx(found.torque, abs=1e-10)
    upwards = found.data["reaction"].sel(sense="out", component_axis="fy")
    grounded = upwards.sel(reacting="crank") + upwards.sel(reacting="pivot")
    assert grounded.values == pytest.approx(np.full(12, 6.0 * G), abs=1e-8)


def test_hysteresis_follows_the_way(bar: Callable[..., Any]):
    """Harness, Bouc-Wen, Maxwell and LuGre: exponentials and limits of the way, out and back."""
    d, reach, reversal = 0.05, 0.02, 0.04
    elements = {
        "wen": BoucWen(joint="hinge", alpha=0.1, stiffness=2.0, yield_angle=d),
        "slips": MaxwellSlip(joint="hinge", stiffness=(30.0,), slip=(30.0 * reach,)),
        "harness": HarnessSpring(
            joint="hinge",
            angle=(-2.0, 2.0),
            torque=(-0.2, -0.2),
            torque_back=(0.4, 0.4),
            reversal=reversal,
            interpolation="linear",
        ),
        "round": JointFriction(joint="hinge", friction=0.3, damping=5.0),
    }
    bristles = LuGreFriction(joint="hinge", coulomb=0.5, static=0.8, stribeck_rate=0.1, stiffness=40.0)
    system = System(bar(), springs=elements, elements={"frictions": {"bristles": bristles}})
    places = np.array([0.0, 0.01, 0.03, 0.1, 0.4])
    found = travel(system, "hinge", places.tolist())
    out = {name: -found.component(f"springs.{name}") for name in elements}
    back = {name: -found.component(f"springs.{name}", "back") for name in elements}
    z = 1.0 - np.exp(-places / d)
    # Exponentials to round-off.
    assert out["wen"] == pytest.approx(0.2 * places + 1.8 * d * z, rel=1e-13, abs=1e-15)
    assert out["slips"] == pytest.approx(30.0 * np.minimum(places, reach), rel=1e-13, abs=1e-15)
    assert out["harness"] == pytest.approx(-0.1 + 0.3 * (1.0 - np.exp(-places / reversal)), rel=1e-13)
    assert out["round"] == pytest.approx(np.full(5, 0.3), rel=1e-13)
    assert back["round"] == pytest.approx(np.full(5, -0.3), rel=1e-13)
    own = -found.component("frictions.bristles")
    # LuGre's g falls from its static value by the square of a rate of 1e-10 over 0.1 rad/s: not at all.
    assert own == pytest.approx(0.8 * (1.0 - np.exp(-40.0 * places / 0.8)), rel=1e-12, abs=1e-15)
    way = places[-1] - places
    unloaded = z[-1] - way / d  # linear down to zero
    fallen = np.where(unloaded > 0.0, unloaded, -(1.0 - np.exp(-np.maximum(way / d - z[-1], 0.0))))
    assert back["wen"] == pytest.approx(0.2 * places + 1.8 * d * fallen, rel=1e-12, abs=1e-13)
    assert back["slips"] == pytest.approx(30.0 * np.maximum(reach - way, -reach), rel=1e-12, abs=1e-13)


def test_preloaded_pair(bar: Callable[..., Any]):
    """Two stops pressed on each other by d: K (d + x)^n - K (d - x)^n, until one comes off."""
    k, n, d = 4e4, 1.5, 1e-3
    pair = {
        "one": EndStop(joint="hinge", upper=-d, stiffness=k, exponent=n, law="elastic"),
        "other": EndStop(joint="hinge", lower=d, stiffness=k, exponent=n, law="elastic"),
    }
    found = travel(System(bar(), elements={"stops": pair}), "hinge", start=-2e-3, stop=2e-3, count=9)
    x = found.position
    expected = k * (np.maximum(d + x, 0.0) ** n - np.maximum(d - x, 0.0) ** n)
    assert found.torque == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_friction_of_a_free_joint_sticks_and_slips():
    """A carriage on a driven one: friction carries it until a spring to the ground pulls as much."""
    text = """<robot name="c"><link name="ground"/><link name="sledge"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="load"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="drive" type="prismatic"><parent link="ground"/><child link="sledge"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
<joint name="slide" type="prismatic"><parent link="sledge"/><child link="load"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>"""
    k, t = 50.0, 3.0
    spring = PointSpring(
        first=("ground", (0.0, 0.0, 0.0)), second=("load", (0.0, 0.0, 0.0)), free_length=0.0, stiffness=k
    )
    friction = JointFriction(joint="slide", friction=t)
    system = System(
        build_mechanism(Urdf.from_text(text, "c"), "fixed"), springs={"k": spring, "dry": friction}
    )
    found = travel(system, "drive", start=0.0, stop=0.2, count=21)
    s = found.position
    assert found.torque == pytest.approx(np.minimum(k * s, t), abs=1e-9)
    # On the way back the load stays until the force has turned round, 2 T / k = 0.12 m later.
    assert found.torque_back == pytest.approx(np.maximum(t - k * (0.2 - s), -t), abs=1e-9)


def test_contact_friction_of_a_hinge_with_play():
    """A pendulum in its bearing: the friction circle, W (r - depth) sin(arctan mu)."""
    scenario = load_scenario("pendulum", "planar")
    found = travel(scenario, "hinge", start=-0.4, stop=0.4, count=5)
    weight = found.data["reaction"].sel(sense="out", reacting="hinge", component_axis="fz").values
    arm = -found.component("gravity") / np.sin(found.position + 1e-300) / weight
    # Depth of the law under the whole weight, and under its normal part.
    depth = 2.45535420996285e-07 * np.cos(np.arctan(0.15)) ** (2.0 / 3.0)
    friction = weight * (0.0099 - depth) * np.sin(np.arctan(0.15))
    assert found.torque == pytest.approx(-found.component("gravity") + friction, rel=1e-9)
    assert found.torque_back == pytest.approx(-found.component("gravity") - friction, rel=1e-9)
    assert arm[[0, 1, 3, 4]] == pytest.approx(np.full(4, 0.2), rel=1e-9)


def test_motor_behind_an_elastic_gear_of_high_ratio(bar: Callable[..., Any]):
    """A rotor turns 100 times as far as the joint: its friction times the ratio, its turns counted."""
    text = BAR.format(kind="revolute").replace("</robot>", "") + (
        '<link name="rotor"><inertial><mass value="0.1"/><inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" '
        'ixz="0" iyz="0"/></inertial></link><joint name="motor" type="continuous"><parent link="bus"/>'
        '<child link="rotor"/><axis xyz="0 0 1"/></joint></robot>'
    )
    ratio, dry, push = 100.0, 2e-3, 1e-4
    system = System(
        build_mechanism(Urdf.from_text(text, "geared"), "fixed"),
        springs={"dry": JointFriction(joint="motor", friction=dry)},
        drives={"motor": ConstantDrive(joint="motor", value=push)},
        elements={"gears": {"train": Gear(input="motor", output="hinge", ratio=ratio, stiffness=500.0)}},
    )
    found = travel(system, "hinge", start=-1.2, stop=1.2, count=4)
    # Round-off of the rotor's angle of 120 rad over the wind-up of 4e-4 rad at the joint.
    # At the ends the rotor has not turned round yet.
    assert found.torque[1:] == pytest.approx(np.full(3, ratio * (dry - push)), rel=1e-9)
    assert found.torque_back[:-1] == pytest.approx(np.full(3, -ratio * (dry + push)), rel=1e-9)
    turned = found.data["joint_position"].sel(sense="out", joint="motor").values[1:]
    assert turned == pytest.approx(ratio * (found.position[1:] - ratio * (dry - push) / 500.0), rel=1e-9)
    # A margin starts from rest where the motion is to begin: all friction against it.
    over = margin(system, "hinge", travel=(-1.2, 1.2), count=4).margin
    assert over == pytest.approx(np.full(4, push / (2.0 * 3.0 * dry) - 1.0), rel=1e-9)


def test_travel_of_a_joint_with_play_goes_from_limit_to_limit():
    """A joint that is free in its variant keeps the limits that its URDF states, as ends of the travel."""
    found = travel(load_scenario("gimbal", "ideal"), "elevation", count=2, back=False)
    assert found.position.tolist() == [-1.0, 1.0]
    assert travel(load_scenario("gimbal"), "azimuth", count=2, back=False).position.tolist() == [-2.0, 2.0]


def test_refusals(bar: Callable[..., Any], four_bar: Callable[..., Any]):
    """One line each: joint, limits, a joint that something holds, a balance that there is not."""
    system = System(bar(G), drives={"motor": ConstantDrive(joint="hinge", value=1.0)})
    with pytest.raises(AntennaPinError, match="joint or drive 'hing' is unknown; did you mean hinge"):
        travel(system, "hing")
    with pytest.raises(AntennaPinError, match=r"within the limits of joint 'hinge', .1.5 to 1.5 rad"):
        travel(system, "hinge", start=0.0, stop=2.0)
    with pytest.raises(AntennaPinError, match="in one sense"):
        travel(system, "hinge", [0.0, 1.0, 0.5])
    assert travel(system, "motor", start=0.0, stop=0.1, count=2).joint == "hinge"
    mechanism, closures = four_bar((0.4, 1.1, 0.8), 0.0)
    with pytest.raises(AntennaPinError, match="joint 'crank' must be free to be driven"):
        travel(System(mechanism, closures=closures), "crank", start=0.0, stop=1.0, hold=["knee"])
    with pytest.raises(AntennaPinError, match="5 N m at joint1 that nothing balances"):
        travel("you2010", "joint2", start=-0.1, stop=0.1, count=2)


def test_statics_in_one_call_gives_what_its_parts_give(bar: Callable[..., Any]):
    """Equilibria without a joint; with one its travel, its loop, or both."""
    system = System(bar(G), springs={"k": JointSpring(joint="hinge", stiffness=3.0)})
    assert [one.positions for one in statics(system).equilibria] == [
        one.positions for one in equilibria(system)
    ]
    whole = statics(system, "hinge", start=-0.2, stop=0.2, count=3, loop=2.0)
    assert whole.travel is not None and whole.loop is not None and whole.equilibria == ()
    own = travel(system, "hinge", start=-0.2, stop=0.2, count=3)
    assert whole.travel.torque.tolist() == own.torque.tolist()
    alone = statics(system, "hinge", loop=2.0)
    assert alone.travel is None and whole.loop.stiffness == alone.loop.stiffness
    with pytest.raises(AntennaPinError, match="statics: loop must be given with a joint, got 2.0"):
        statics(system, loop=2.0)
