"""Modes against closed forms and against eigenvalue problems that are written here anew."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from flexible_links import LOCKED, PETALS, ROCK
from modal_equations import linear_frequencies
from scipy.linalg import eigh

from antenna_pin import System, Urdf, build_mechanism, build_system, load_scenario
from antenna_pin.dynamics import JointSpring, PointSpring
from antenna_pin.studies.linear import eigenmodes, linearise, modes, prepared

TAU = 2.0 * np.pi

MODE = {"flexible.reflector": {"kind": "modes", "modes": {"rock": ROCK}}}


@pytest.mark.parametrize("base", ["free", "fixed"])
def test_chain_of_springs(chain: Any, base: str):
    """Masses in a row: det(K - w^2 M) of the absolute positions, solved without any mechanism."""
    masses, stiffness = [5.0, 2.0, 1.0, 3.0, 0.5], np.array([400.0, 90.0, 1000.0, 20.0])
    system = System(
        chain(masses, base),
        springs={f"k{k + 1}": JointSpring(joint=f"s{k + 1}", stiffness=c) for k, c in enumerate(stiffness)},
    )
    found = modes(system)
    apart = np.diff(np.eye(5), axis=0)
    own = apart.T @ np.diag(stiffness) @ apart
    first = 0 if base == "free" else 1
    squares = eigh(own[first:, first:], np.diag(masses[first:]), eigvals_only=True)
    expected = np.sqrt(squares[1 if base == "free" else 0 :]) / TAU
    # Round-off of eigenvalues over the largest, here 60 times the least.
    assert found.frequency[-4:] == pytest.approx(expected, rel=1e-13, abs=0.0)
    assert list(found.data["kind"].values) == ["rigid"] * (6 if base == "free" else 0) + ["elastic"] * 4
    assert not found.frequency[:-4].any()
    if base == "fixed":
        # The whole moving mass answers along x: all but the root's.
        assert found.data["effective_mass"].sel(component="x").sum() == pytest.approx(6.5, rel=1e-12)
        assert found.data["rigid_mass"].sel(component="x") == pytest.approx(6.5, rel=1e-12)
    assert found.data["strain_share"].values[-4:].sum(axis=1) == pytest.approx(np.ones(4), rel=1e-12)
    assert found.data["kinetic_share"].values.sum(axis=1) == pytest.approx(np.ones(len(found.frequency)))


@pytest.mark.parametrize("ratio", [0.0, 0.005, 0.3, 0.999, 1.0005, 4.0])
def test_one_damped_spring_on_a_free_base(chain: Any, ratio: float):
    """Two masses on a spring: w^2 = k (1/m + 1/M), and both roots of s^2 + 2 z w s + w^2, over 1 too."""
    reduced = 1.0 / (1.0 / 5.0 + 1.0 / 2.0)
    omega = np.sqrt(300.0 / reduced)
    spring = JointSpring(joint="s1", stiffness=300.0, damping=2.0 * ratio * omega * reduced)
    found = modes(System(chain([5.0, 2.0]), springs={"k": spring}))
    assert found.frequency[-1] * TAU == pytest.approx(omega, rel=1e-13, abs=0.0)
    assert found.data["damped_modulus"].values[-1] * TAU == pytest.approx(omega, rel=1e-12, abs=0.0)
    # Near critical damping roots move by the square root of round-off, but not their sum and product.
    assert found.damping_ratio[-1] == pytest.approx(ratio, rel=1e-12, abs=1e-15)
    swings = abs(found.data["root_imag"].values[-1]) > 0.0
    assert bool(swings.all()) is (ratio < 1.0)


ARM = """<robot name="arm"><link name="bus"><inertial><mass value="9"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="boom"><inertial><origin xyz="0.3 0.1 -0.2" rpy="0.1 0.2 0.3"/><mass value="2"/>
<inertia ixx="0.3" iyy="0.2" izz="0.15" ixy="0.02" ixz="0" iyz="0.01"/></inertial></link>
<link name="dish"><inertial><origin xyz="0.1 -0.3 0.2"/><mass value="1.5"/>
<inertia ixx="0.1" iyy="0.2" izz="0.15" ixy="0" ixz="0.03" iyz="0"/></inertial></link>
<joint name="root" type="continuous"><parent link="bus"/><child link="boom"/>
<origin xyz="0.4 -0.2 0.5" rpy="0.5 -0.3 0.8"/><axis xyz="0 0.6 0.8"/></joint>
<joint name="slide" type="prismatic"><parent link="boom"/><child link="dish"/>
<origin xyz="0.7 0 0.1" rpy="-0.4 0.9 0.2"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>"""


def test_participations_are_blocks_of_the_free_mass_matrix():
    """All modes with the base held: their sum of products is B^T M^-1 B, of joints' and base's blocks.

    Signs and all, in the base's axes about its origin, wherever the base is and however it is turned.
    """
    mechanism = build_mechanism(Urdf.from_text(ARM, "arm"), "free")
    springs = {f"k {name}": JointSpring(joint=name, stiffness=50.0) for name in ("root", "slide")}
    system = System(mechanism, springs=springs)
    model = system.model
    q = pin.integrate(model, pin.neutral(model), np.array([0.3, -1.0, 2.0, 0.4, -0.7, 1.1, 0.6, 0.2]))
    found = modes(system, q=q, hold=["base"])
    mass = pin.crba(model, model.createData(), q)
    mass = np.triu(mass) + np.triu(mass, 1).T
    expected = mass[:6, 6:] @ np.linalg.solve(mass[6:, 6:], mass[6:, :6])
    own = found.data["participation"].values
    # Round-off of inertias of 3 kg m^2.
    assert own.T @ own == pytest.approx(expected, rel=0.0, abs=1e-13)
    own_rigid = found.data["rigid_mass"].values
    bus = np.array([9.0, 9.0, 9.0, 1.0, 1.0, 1.0])
    assert own_rigid in (pytest.approx(np.diag(mass)[:6], rel=1e-12), pytest.approx(np.diag(mass)[:6] - bus))


def test_gravity_does_not_touch_what_falls_freely(chain: Any):
    spring = {"k": JointSpring(joint="s1", stiffness=300.0)}
    still, falling = (
        modes(System(chain([5.0, 2.0], "free", g), springs=spring)) for g in ((0, 0, 0), (1, 2, -9))
    )
    assert falling.frequency == pytest.approx(still.frequency, rel=1e-13, abs=0.0)
    assert list(falling.data["kind"].values) == ["rigid"] * 6 + ["elastic"]
    assert falling.notes == ()


def test_a_single_mode_with_its_hub_held():
    """It has the frequency, damping and effective mass asked for."""
    scenario = load_scenario("bai2020", case="case1", overrides={**MODE, **LOCKED})
    held = modes(scenario, hold=["base", "elevation"])
    assert held.frequency == pytest.approx([15.0], rel=1e-12, abs=0.0)
    assert held.damping_ratio == pytest.approx([0.005], rel=1e-11, abs=0.0)
    # What the modal data of this mode are: 2 kg along y.
    assert held.data["effective_mass"].values[0, :3] == pytest.approx([0.0, 2.0, 0.0], abs=1e-13)


def test_petals_on_the_free_antenna():
    """As Pinocchio's mass matrix and the springs alone have them."""
    scenario = load_scenario("bai2020", case="case1", overrides=PETALS)
    system = build_system(scenario)
    found = modes(system)
    expected = linear_frequencies(system)[8:] / TAU
    assert list(found.data["kind"].values) == ["rigid"] * 6 + ["free"] * 2 + ["elastic"] * 8
    assert found.frequency[8:] == pytest.approx(expected, rel=1e-10, abs=0.0)


def test_derivatives_are_those_of_aba():
    """M^-1 C and M^-1 K of a moving tree are Pinocchio's derivatives of forward dynamics."""
    scenario = load_scenario("bai2020", case="case1", overrides=PETALS)
    system = build_system(scenario)
    rng = np.random.default_rng(3)
    model = system.model
    y = system.state(
        pin.integrate(model, pin.neutral(model), 0.3 * rng.normal(size=model.nv)), rng.normal(size=model.nv)
    )
    linear = linearise(prepared(system, y, moving=True))
    stiff, damp = np.zeros(model.nv), np.zeros(model.nv)
    for spring in system.springs.values():
        v = system.mechanism.joint(spring.joint).v.start
        stiff[v], damp[v] = spring.stiffness, spring.damping
    q, v = y[: model.nq], y[model.nq : model.nq + model.nv]
    # The drives are at zero of their sine.
    tau = -damp * v
    for slot in system.mechanism.joints.values():
        if stiff[slot.v.start]:
            tau[slot.v] -= stiff[slot.v] * q[slot.q]
    data = model.createData()
    pin.computeABADerivatives(model, data, q, v, tau)
    minv = np.triu(data.Minv) + np.triu(data.Minv, 1).T
    by_q, by_v = data.ddq_dq - minv * stiff, data.ddq_dv - minv * damp
    own = np.linalg.solve(linear.mass, np.hstack([-linear.stiffness, -linear.damping]))
    n = linear.directions
    scale = np.abs(by_q).max()
    assert np.abs(n @ own[:, : model.nv] @ n.T - by_q).max() < 1e-10 * scale
    assert np.abs(n @ own[:, model.nv :] @ n.T - by_v).max() < 1e-10 * np.abs(by_v).max()


PENDULUM = """<robot name="p"><link name="w"/><link name="bob"><inertial><origin xyz="0 0 -0.7"/>
<mass value="2"/><inertia ixx="0.3" iyy="0.2" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pin" type="continuous"><parent link="w"/><child link="bob"/><axis xyz="1 0 0"/></joint>
</robot>"""


def test_pendulum_in_gravity_and_upside_down():
    """(I + m l^2) w^2 = m g l; the other way up it runs away at that rate, and says so."""
    mechanism = build_mechanism(Urdf.from_text(PENDULUM, "pendulum"), "fixed", (0, 0, -9.81))
    expected = np.sqrt(2.0 * 9.81 * 0.7 / (0.3 + 2.0 * 0.7**2))
    down = modes(System(mechanism))
    assert down.frequency == pytest.approx([expected / TAU], rel=1e-13, abs=0.0)
    up = modes(System(mechanism), q=[-1.0, 0.0])
    assert list(up.data["kind"].values) == ["unstable"]
    assert sorted(up.data["root_real"].values[0]) == pytest.approx([-expected, expected], rel=1e-12)
    assert any("unstable" in note for note in up.notes)


def test_spring_between_points_has_its_geometric_stiffness():
    """A string under tension T across which a mass moves: k = T / l on both sides, and k along it."""
    text = """<robot name="s"><link name="m"><inertial><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
    springs = {
        side: PointSpring(
            first=("world", (x, 0, 0)), second=("m", (0, 0, 0)), free_length=0.4, stiffness=50.0
        )
        for side, x in (("left", -0.5), ("right", 0.5))
    }
    found = modes(System(build_mechanism(Urdf.from_text(text, "mass"), "free"), springs=springs))
    tension = 50.0 * 0.1
    across, along = np.sqrt(2 * tension / 0.5 / 2.0), np.sqrt(2 * 50.0 / 2.0)
    assert found.frequency[-3:] * TAU == pytest.approx([across, across, along], rel=1e-10, abs=0.0)
    # The mass turns about its centre as it likes.
    assert list(found.data["kind"].values[:3]) == ["free"] * 3


def test_a_free_spinning_body_nutates():
    """An axisymmetric body with spin about its axis: (C / A - 1) spin, seen in its own axes; it is rigid."""
    text = """<robot name="t"><link name="m"><inertial><mass value="2"/>
    <inertia ixx="0.2" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
    system = System(build_mechanism(Urdf.from_text(text, "top"), "free"))
    found = modes(system, q=system.neutral(), v=[0, 0, 0, 0, 0, 4.0], moving=True)
    assert set(found.data["kind"].values) == {"rigid"}
    assert np.abs(found.frequency * TAU - (0.3 / 0.2 - 1.0) * 4.0).min() < 1e-12


@pytest.mark.parametrize("off", [0.5, 1e-3, 2.5e-9, 0.0])
def test_a_free_base_is_placed_by_its_velocity_however_near_its_spin_a_mode_is(off: float):
    """In axes that turn, w = (lambda + D) s, singular at a mode of the spin itself: there the least place."""
    spin = 3.0
    drift = np.zeros((6, 6))
    for first in (0, 3):
        drift[first : first + 2, first : first + 2] = [[0.0, -spin], [spin, 0.0]]
    # Across the spin it moves against the axes, so that its velocity nearly vanishes; along it anyhow.
    place = np.array([1.0, 1j, 0.5, 1j, -1.0, 2.0]) if off else np.array([0.0, 0.0, 0.5, 0.0, 0.0, 2.0])
    value = 1j * spin * (1.0 + off)
    speed = (value * np.eye(6) + drift) @ place
    found = eigenmodes._base_place(SimpleNamespace(drift=drift), value, speed)
    # Of the velocity, known to 1e-16, a part in 1e9 is left.
    assert found == pytest.approx(place, abs=1e-6)
