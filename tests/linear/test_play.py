"""Joints with play: ideal, free, or pressed into contact, against closed forms of the contact."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hinge_shapes import antenna_hinge

from antenna_pin import AntennaPinError, System, Urdf, build_mechanism, load_scenario
from antenna_pin.contact import Hertz, LankaraniNikravesh, LuGre, Tanh
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.geometry import PlanarClearance
from antenna_pin.studies.linear import linearise, modes
from antenna_pin.studies.linear.operating_point import ideal_directions

TAU = 2.0 * np.pi
K, MASS, PLAY = 2e9, 2.0, 1e-3

BODY = """<robot name="b"><link name="ground"/><link name="body"><inertial><mass value="2"/>
<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="hole" type="continuous"><parent link="ground"/><child link="body"/><axis xyz="0 0 1"/></joint>
</robot>"""


def disc(law: Any = None, inertia: float = 0.01, **joint: Any) -> System:
    """A disc in a round hole, in a plane."""
    urdf = Urdf.from_text(BODY.format(i=inertia), "body").variant(joints={"hole": "planar"})
    clearance = ClearanceJoint(
        name="hole",
        geometry=PlanarClearance(bearing_radius=0.01, journal_radius=0.01 - PLAY),
        radial=law or Hertz(stiffness=K),
        **{"backend": "closed-form", **joint},
    )
    return System(build_mechanism(urdf, "fixed"), clearances=[clearance])


def bush(**joint: Any) -> System:
    """A pin with flanges in a bore of 50 mm, a body about its middle."""
    urdf = Urdf.from_text(BODY.format(i=0.01), "body").variant(joints={"hole": "free"})
    geometry = antenna_hinge()
    law = Hertz(stiffness=1e10)
    clearance = ClearanceJoint(
        name="hole", geometry=geometry, radial=law, axial=law, **{"backend": "closed-form", **joint}
    )
    return System(build_mechanism(urdf, "fixed"), clearances=[clearance])


@pytest.mark.parametrize("backend", ["closed-form", "coal"])
@pytest.mark.parametrize("force", [0.5, 200.0, 2e4])
@pytest.mark.parametrize("bearing_on", ["parent", "child"])
def test_hertz_tangent_stiffness(backend: str, force: float, bearing_on: str):
    """Along the load 3/2 F / depth, across it F / eccentricity as a pendulum, no turning stiffness.

    With the bearing on the body the load turns with it, which the inertia about the axis feels a little.
    """
    found = modes(disc(backend=backend, bearing_on=bearing_on), load=[0.6 * force, 0.8 * force, 0.0])
    depth = (force / K) ** (2.0 / 3.0)
    along = np.sqrt(1.5 * force / depth / MASS) / TAU
    across = np.sqrt(force / (PLAY + depth) / MASS) / TAU
    assert list(found.data["kind"].values) == ["free", "elastic", "elastic"]
    # The gap's round-off, 1e-17 m, over steps of 0.02 of the depth, which is 4e-7 m at the least load.
    assert found.frequency[2] == pytest.approx(along, rel=1e-8, abs=0.0)
    lever = 0.0 if bearing_on == "parent" else (PLAY + depth) ** 2 * MASS / 0.01
    assert found.frequency[1] == pytest.approx(across * np.sqrt(1.0 + lever), rel=1e-8, abs=0.0)
    assert found.damping_ratio[1:] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("speed", [None, 0.3])
def test_damping_of_the_contact_law(speed: float | None):
    """d F / d rate = 3/4 (1 - c^2) F / v0 of Lankarani and Nikravesh, with the approach speed given."""
    law = LankaraniNikravesh(stiffness=K, restitution=0.9)
    joint = disc(law)
    found = modes(joint, load=[150.0, 0.0, 0.0], approach_speed=speed)
    omega = TAU * found.frequency[-1]
    v0 = joint.clearances[0].approach_speed_floor if speed is None else speed
    expected = 0.75 * (1.0 - 0.9**2) * 150.0 / v0 / (2.0 * MASS * omega)
    assert found.damping_ratio[-1] == pytest.approx(expected, rel=1e-8)
    assert found.data["damped_modulus"].values[-1] == pytest.approx(found.frequency[-1], rel=1e-9)


def test_friction_at_rest_is_viscous_or_a_spring():
    """tanh(v / v_t): mu F / v_t; stuck bristles: F sigma_0, beside F / eccentricity of the pendulum."""
    heavy = 1e9  # inertia, so that the disc does not roll
    viscous = Tanh(coefficient_of_friction=0.1, transition_speed=0.5)
    found = modes(disc(inertia=heavy, friction=viscous), load=[100.0, 0.0, 0.0])
    k = 100.0 / (PLAY + (100.0 / K) ** (2.0 / 3.0))
    (across,) = [m for m in found.elastic if abs(found.shape(m)[1]) > 0.5]
    assert found.frequency[across - 1] == pytest.approx(np.sqrt(k / MASS) / TAU, rel=1e-8)
    damping = 0.1 * 100.0 / 0.5
    assert found.damping_ratio[across - 1] == pytest.approx(damping / (2 * np.sqrt(k * MASS)), rel=1e-7)
    bristles = LuGre(static=0.2, dynamic=0.1, stribeck_speed=0.01, bristle_stiffness=1e5)
    found = modes(disc(inertia=heavy, friction=bristles), load=[100.0, 0.0, 0.0])
    (across,) = [m for m in found.elastic if abs(found.shape(m)[1]) > 0.5]
    expected = np.sqrt((k + 100.0 * 1e5) / MASS) / TAU
    assert found.frequency[across - 1] == pytest.approx(expected, rel=1e-8)
    assert found.data["damped_modulus"].values[across - 1] == pytest.approx(expected, rel=1e-7)


def test_a_bore_shares_the_load_between_its_ends():
    """Two ends with half the load each; the body tilts on them against k (L/2)^2 about the axis across."""
    found = modes(bush(), load=[0.0, 300.0, 0.0])
    depth = (150.0 / 1e10) ** (2.0 / 3.0)
    k = 2.0 * 1.5 * 150.0 / depth
    along = np.sqrt(k / MASS) / TAU
    assert np.abs(found.frequency / along - 1.0).min() < 1e-8
    stiffness = found.linearisation.stiffness
    # And the load's own moment as the body tilts, F times the way to the contact's axis: 1e-3 of it.
    assert stiffness[3, 3] == pytest.approx(k * 0.025**2, rel=1e-3)
    # Slid along its bore, the pin is loaded off the middle, tilts, and slides on: F couples both.
    assert stiffness[2, 3] == pytest.approx(300.0, rel=1e-7)
    assert stiffness[3, 2] == pytest.approx(300.0, rel=1e-7)
    assert stiffness[2, 2] == pytest.approx(0.0, abs=1e-3)
    assert list(found.data["kind"].values[:2]) == ["free", "unstable"]


def test_a_load_across_and_along_balances():
    system = bush()
    found = modes(system, load=[80.0, 0.0, 150.0])
    at = found.linearisation.at
    assert set(np.flatnonzero(at.memory["touching"])) >= {0, 1}
    from antenna_pin.studies.linear.force_derivatives import Forces

    left = Forces(system, 0.0, at.y, at.memory, at.loads).whole()
    assert np.abs(left).max() < 1e-9 * 170.0
    assert found.notes[:1] == () or "balance" not in found.notes[0]


@pytest.mark.parametrize("case", ["case3", "case2-planar"])
def test_play_taken_as_ideal_is_the_ideal_joint(case: str):
    """By directions that are left of the free joint, and by another model with a hinge."""
    spring = {"springs.tie": {"joint": "elevation", "stiffness": "300 N*m/rad", "damping": "2 N*m*s/rad"}}
    with_play = modes(load_scenario("bai2020", case=case, overrides=spring))
    ideal = modes(load_scenario("bai2020", case="case1", overrides=spring))
    assert with_play.frequency == pytest.approx(ideal.frequency, rel=1e-11)
    assert with_play.damping_ratio[7:] == pytest.approx(ideal.damping_ratio[7:], rel=1e-10)
    assert list(with_play.data["kind"].values) == list(ideal.data["kind"].values)


def test_play_taken_as_free_resists_nothing():
    """A joint held by constraint is the joint of the tree."""
    found = modes(load_scenario("bai2020", case="case3"), play="free")
    assert list(found.data["kind"].values) == ["rigid"] * 6 + ["free"] * 7
    assert not found.frequency.any()
    spring = {"springs.tie": {"joint": "elevation", "stiffness": "300 N*m/rad"}}
    held = modes(load_scenario("bai2020", case="case1-constraint", overrides=spring))
    ideal = modes(load_scenario("bai2020", case="case1", overrides=spring))
    assert held.frequency == pytest.approx(ideal.frequency, rel=1e-11)


def test_in_contact_as_it_is_in_a_run():
    """Where the run ended, a deep contact: the tangent of the force that the run recorded."""
    from antenna_pin import simulate

    system = disc()
    run = simulate(system, q=[PLAY, 0.0, 1.0, 0.0], v=[0.5, 0.0, 0.0], duration=2e-4)
    assert run.end is not None and run.end.memory[0, 0] == 1.0
    found = modes(system, at=run.end, play="contact")
    depth = float(np.hypot(*run.end.q[:2])) - PLAY
    assert found.frequency[-1] * TAU == pytest.approx(np.sqrt(1.5 * K * depth**0.5 / MASS), rel=1e-8)
    # The contact's force is not balanced by anything; that is said.
    assert any("not in balance" in note for note in found.notes)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"play": "contact"}, "must touch somewhere to be taken in contact"),
        ({"play": "stiff"}, "ideal, free or contact"),
        ({"play": {"pin": "free"}}, "joint with play 'pin' is unknown"),
        ({"load": [0, 0, 0]}, "load of hole must be three finite numbers"),
        ({"load": [1.0, 0, 2.0]}, "must lie in the joint's plane"),
        ({"load": [1.0, 0, 0], "play": "free"}, "play of hole must be contact, or left out"),
        ({"hold": ["hole"]}, "something must be left free to move"),
        ({"at": -1.0}, "at must be zero or more, and finite [s]"),
        ({"at": 1.0, "q": [0, 0, 1, 0]}, "left out with at"),
    ],
)
def test_refusals_are_one_line(given: dict[str, Any], said: str):
    with pytest.raises(AntennaPinError) as refused:
        modes(disc(), **given)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_kink_is_said():
    """A controller at its limit has two slopes there."""
    scenario = load_scenario(
        "bai2020",
        case="case1",
        overrides={
            "drives.elevation": {
                "replace": True,
                "joint": "elevation",
                "kind": "pd",
                "kp": "5 N*m/rad",
                "limit": "0.5 N*m",
                "angle": "0.1 rad",
            }
        },
    )
    found = modes(scenario)
    assert any("at elevation a force has a kink" in note for note in found.notes)
    assert linearise(found.linearisation.at).forces.rough == ("elevation",)


@pytest.mark.parametrize("motion", ["turn", "slide"])
def test_an_ideal_joint_s_way_is_about_or_along_its_own_axis(motion):
    axis = np.array([0.0, 0.6, 0.8])
    joint = SimpleNamespace(geometry=SimpleNamespace(motion=motion), planar=False)
    (way,) = ideal_directions(SimpleNamespace(axis=axis), joint, np.zeros(7)).T
    still = np.zeros(3)
    assert np.array_equal(way, np.append(still, axis) if motion == "turn" else np.append(axis, still))
