"""Elastic parts: what they are to their hub to first order, and that nothing of the link is lost."""

from __future__ import annotations

import re
import shutil
from typing import Any

import numpy as np
import pytest
from flexible_links import DATA, DISH, KINDS, LOCKED
from modal_equations import frequencies, linear_frequencies, spatial

from antenna_pin import load_scenario, models_path
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.flexible import EffectiveMode, MassProperties, Petals, petal_body, realised
from antenna_pin.mechanism.flexible.inertia import share_taken
from antenna_pin.mechanism.flexible.modal_data import hinged
from antenna_pin.scenario.assemble import build_system, urdf_variant


def rigid(name: str = "reflector") -> MassProperties:
    return urdf_variant(load_scenario("bai2020", case="case1")).mass_properties(name)


@KINDS
def test_hub_and_parts_have_mass_centre_and_inertia_of_the_link(overrides: dict[str, Any]):
    """The parts' numbers go through the URDF's text, as any other tool would read them."""
    urdf = urdf_variant(load_scenario("bai2020", case="case1", overrides=overrides))
    total = urdf.mass_properties("reflector").moments
    for joint in urdf.robot.joints:
        if joint.parent == "reflector":
            total = total + urdf.mass_properties(joint.child).moved(urdf.placement(joint.name)).moments
    found, link = MassProperties.of_moments(total), rigid()
    assert found.mass == pytest.approx(link.mass, rel=1e-12, abs=0.0)
    assert np.abs(found.centre - link.centre).max() < 1e-12  # of lengths of 0.1 m
    assert np.abs(found.inertia - link.inertia).max() < 1e-12


def test_radius_of_gyration_of_a_ball():
    """sqrt(2/5) of its radius: from 2/5 m r^2 about every axis, wherever the ball is."""
    ball = MassProperties.of(3.0, [1.0, 2.0, -1.0], 0.4 * 3.0 * 0.7**2 * np.eye(3))
    assert ball.gyration == pytest.approx(np.sqrt(0.4) * 0.7, rel=1e-14, abs=0.0)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("least", [False, True])
def test_every_mode_is_a_body_on_a_joint(seed: int, least: bool, random_link: Any):
    """Participation, frequency and damping ratio are those asked for, and the body can exist.

    Translations and rotations of all sizes, with a pitch and without, on bodies of any shape.
    """
    rng = np.random.default_rng(seed)
    link = random_link(rng)
    t, r = (rng.normal(size=3) * 10.0 ** rng.uniform(-5.0, 0.0) for _ in range(2))
    if seed % 4 == 1:
        r = np.cross(rng.normal(size=3), t)
    elif seed % 4 == 2:
        t = np.zeros(3)
    elif seed % 4 == 3:
        r = np.cross(link.centre, t) + rng.normal() * t
    part = realised("mode", link, t, r, 2.0 * np.pi * 5.0, 0.01, least=least)
    found = part.participation(np.zeros(3))
    size = np.linalg.norm(t) * link.gyration + np.linalg.norm(r)
    # Round-off of a mass put up to a hundred radii of gyration away.
    assert np.abs(found[:3] - t).max() * link.gyration < 1e-11 * size
    assert np.abs(found[3:] - r).max() < 1e-11 * size
    assert part.frequency == pytest.approx(5.0, rel=1e-13, abs=0.0)
    assert part.damping_ratio == pytest.approx(0.01, rel=1e-13, abs=0.0)
    assert np.linalg.eigvalsh(part.body.moments)[0] > 0.0


def test_a_part_acts_on_its_hub_as_pinocchio_says():
    """delta is what the joint's column of the mass matrix says, scaled to unit modal mass.

    With the root's acceleration a: M a + delta^T eta'' = F and eta'' + ... + delta a = 0 about the root, in
    the appendage's axes; M is the rigid link's.
    """
    import pinocchio as pin

    scenario = load_scenario("bai2020", case="case1", overrides=DATA)
    urdf = urdf_variant(scenario)
    model = pin.buildModelFromXML(urdf.to_xml(), pin.JointModelFreeFlyer())
    mass = np.array(pin.crba(model, model.createData(), pin.neutral(model)))
    mass = np.triu(mass) + np.triu(mass, 1).T
    data = scenario.flexible["reflector"].build()
    modal, columns = [], [model.joints[model.getJointId(f"reflector_mode{k}")].idx_v for k in (1, 2, 3)]
    # The root's frame in that of the base, at zero angles: the link's, then the appendage's in it.
    root = np.array([0.0, 0.5, 1.0]) + np.array(DATA["flexible.reflector"]["root_xyz"])
    turn = pin.rpy.rpyToMatrix(*DATA["flexible.reflector"]["root_rpy"])
    for column in columns:
        linear, angular = mass[:3, column], mass[3:6, column]
        about = angular - np.cross(root, linear)
        modal.append(np.concatenate([turn.T @ linear, turn.T @ about]) / np.sqrt(mass[column, column]))
    assert np.abs(np.array(modal) - data.factors).max() < 1e-12
    assert np.abs(mass[np.ix_(columns, columns)] - np.diag(np.diag(mass)[columns])).max() < 1e-15


@KINDS
def test_frequencies_with_the_hub_held_are_those_asked_for(overrides: dict[str, Any]):
    scenario = load_scenario("bai2020", case="case1", overrides=overrides)
    system = build_system(scenario)
    found = linear_frequencies(system, ("base", "azimuth", "elevation")) / (2.0 * np.pi)
    asked = sorted(scenario.flexible["reflector"].build().frequencies.values())
    assert found == pytest.approx(asked, rel=1e-12, abs=0.0)


def test_a_single_mode_on_a_free_base_has_the_frequency_of_the_closed_form():
    """omega_free = omega / sqrt(1 - delta M^-1 delta^T): of a mass m off the centre on a body of mass M."""
    link, mass = MassProperties.of(8.0, (0, 0, 0), np.diag([1.0, 0.7, 0.7])), 2.0
    mode = EffectiveMode(frequency=15.0, mass=mass, direction=(0, 1, 0), place=(0.1, 0.0, 0.2))
    part = mode.part("rock", link)
    # Of translation along y m/M, of turning about x (arm 0.2) and about z (arm 0.1).
    share = mass / 8.0 + mass * 0.2**2 / 1.0 + mass * 0.1**2 / 0.7
    expected = 15.0 / np.sqrt(1.0 - share)
    found = frequencies([part], spatial(link)) / (2.0 * np.pi)
    assert found == pytest.approx(expected, rel=1e-12, abs=0.0)


@KINDS
def test_coupled_frequencies_are_those_of_the_modal_equations(overrides: dict[str, Any]):
    """Pinocchio's mass matrix of the antenna locked into one body, against M, delta and omega alone.

    To 1e-8: the eigenvalues of a matrix with six zeros, and petals that are six times the same.
    """
    scenario = load_scenario("bai2020", case="case1", overrides={**overrides, **LOCKED})
    system = build_system(scenario)
    found = linear_frequencies(system, ("elevation",))
    urdf = urdf_variant(load_scenario("bai2020", case="case1"))
    moments = np.zeros((4, 4))
    for name, place in (
        ("body", (0, 0, 0)),
        ("shaft1", (0, 0, 0.5)),
        ("shaft2", (0, 0, 1)),
        ("reflector", (0, 0.5, 1)),
    ):
        frame = np.eye(4)
        frame[:3, 3] = place
        moments += urdf.mass_properties(name).moved(frame).moments
    shift = np.eye(4)
    shift[:3, 3] = (0.0, -0.5, -1.0)
    whole = MassProperties.of_moments(moments).moved(shift)
    parts = scenario.flexible["reflector"].build().parts("reflector", rigid())
    expected = frequencies(parts, spatial(whole))
    assert found[6:] == pytest.approx(expected, rel=1e-8, abs=0.0)


def test_petals_are_the_dish():
    """All petals together are the even shell: centre on the axis, inertia by integrals along the radius."""
    numbers = {
        key: value for key, value in DISH.items() if key not in ("kind", "frequency", "replaces", "vertex")
    }
    dish = Petals(frequency=20.0, boresight=(0.0, 0.0, 1.0), **numbers)
    parts = dish.parts("dish", MassProperties.of(20.0, (0, 0, 0), np.eye(3)))
    whole = MassProperties.of_moments(sum(part.body.moments for part in parts))
    f, r = 0.12, np.linspace(0.1, 0.486, 200_001)
    density = r * np.sqrt(1.0 + (r / (2.0 * f)) ** 2)
    mean = {k: np.trapezoid(density * r**k, r) / np.trapezoid(density, r) for k in (2, 4)}
    assert whole.mass == pytest.approx(6.0, rel=1e-14)
    # The trapezoidal rule errs by the square of a step of 2e-6 m over lengths of 0.1 m.
    assert whole.centre == pytest.approx([0.0, 0.0, mean[2] / (4.0 * f)], rel=1e-9, abs=1e-14)
    assert whole.inertia[2, 2] == pytest.approx(6.0 * mean[2], rel=1e-9)
    across = 6.0 * (0.5 * mean[2] + (mean[4] - mean[2] ** 2) / (16.0 * f**2))
    assert np.diag(whole.inertia)[:2] == pytest.approx([across, across], rel=1e-9)


def test_a_petal_is_a_sector_of_the_shell():
    """Against sums over a grid of points: midpoints in angle, whose error is that of a step's square."""
    f, inner, outer, half = 0.12, 0.1, 0.486, np.pi / 8.0
    edges, angles = np.linspace(inner, outer, 4001), np.linspace(-half, half, 4001)
    r, angle = 0.5 * (edges[1:] + edges[:-1]), 0.5 * (angles[1:] + angles[:-1])
    weight = r * np.sqrt(1.0 + (r / (2.0 * f)) ** 2)
    weight *= 0.75 / (weight.sum() * len(angle))
    cos, sin = np.cos(angle), np.sin(angle)
    along, across = (np.array([one.sum(), (one**2).sum()]) for one in (cos, sin))
    z = r**2 / (4.0 * f)
    expected = np.zeros((4, 4))
    expected[0, 0], expected[1, 1] = along[1] * (weight @ r**2), across[1] * (weight @ r**2)
    expected[2, 2], expected[0, 2] = len(angle) * (weight @ z**2), along[0] * (weight @ (r * z))
    expected[0, 3], expected[2, 3] = along[0] * (weight @ r), len(angle) * (weight @ z)
    expected[3, 3] = 0.75
    expected = np.triu(expected) + np.triu(expected, 1).T
    found = petal_body(0.75, f, inner, outer, half).moments
    assert np.abs(found - expected).max() < 1e-7 * 0.75


def test_the_body_chosen_takes_least_of_all_that_are_looked_at(random_link: Any):
    """They are looked at all at once: some of them, made one by one, take no less."""
    rng = np.random.default_rng(5)
    for _ in range(10):
        link = random_link(rng)
        t, r = rng.normal(size=3), rng.normal(size=3)
        best = share_taken(link, realised("m", link, t, r, 1.0, 0.0, least=True).body)
        about = r - np.cross(link.centre, t)
        size, away = np.linalg.norm(t), np.linalg.norm(about - (about @ t) * t / (t @ t))
        reach = size * link.gyration
        low = min(max(abs(t @ r) / size, away - reach, 1e-3 * (away + reach)), away + reach)
        for lever in (low, min(max(low, away), away + reach)):
            extra = lever * size / link.gyration + (lever / link.gyration) ** 2
            for factor, flat in ((0.125, 0.1), (1.0, 0.5), (8.0, 0.9)):
                other = hinged("m", link, t, r, lever, factor * extra, 1.0, 0.0, flat)
                assert best <= share_taken(link, other.body) * (1.0 + 1e-12)


@pytest.mark.parametrize("place", ["-0.2755 a 0", "-0.2755 0", "nan 0 0"])
def test_a_shape_that_goes_with_a_part_must_have_a_place(tmp_path, place):
    """It is moved from the link's frame to the part's; one that is only drawn may have any."""
    folder = shutil.copytree(models_path() / "bai2020", tmp_path / "bai2020")
    file = folder / "antenna.urdf"
    file.write_text(file.read_text().replace('<origin xyz="-0.2755 0 0"/>', f'<origin xyz="{place}"/>'))
    rule = f"shape 'dish' of link 'reflector': <origin xyz> must be three finite numbers, got '{place}'"
    with pytest.raises(MechanismError, match=re.escape(rule)):
        build_system(load_scenario(folder, case="flexible"))


@pytest.mark.parametrize("place", [None, (0.1, -0.2, 0.3)])
def test_a_mode_without_shapes_is_drawn_as_a_small_ball_where_its_body_is(place: Any):
    """Its radius is 8 % of the link's radius of gyration: of a link twice as large, twice as much."""
    for size in (0.7, 1.4):
        link = MassProperties.of(3.0, [1.0, 2.0, -1.0], 0.4 * 3.0 * size**2 * np.eye(3))
        mode = EffectiveMode(frequency=3.0, mass=0.5, direction=(0.0, 0.0, 1.0), place=place)
        (ball,) = mode.part("mode", link).drawn
        assert ball.radius == pytest.approx(0.08 * np.sqrt(0.4) * size, rel=1e-14)
        expected = link.centre if place is None else np.array(place)
        np.testing.assert_array_equal(ball.placement[:3, 3], expected)


@pytest.mark.parametrize("count", [2, 4, 8, 40])
def test_a_petal_without_a_mesh_is_drawn_as_strips_over_the_paraboloid(count: int):
    """They end on it, follow one another from hub to rim, and cover nearly their own sector alone."""
    f, hub, rim = 0.12, 0.1, 0.486
    dish = Petals(
        petals=count,
        mass=6.0,
        rim_radius=rim,
        hub_radius=hub,
        focal_length=f,
        boresight=(0.0, 0.0, 1.0),
        frequency=20.0,
    )
    first, second, *_ = dish.parts("dish", MassProperties.of(20.0, (0, 0, 0), np.eye(3)))
    at = hub
    for box in first.drawn:
        middle, half = box.placement[:3, 3], 0.5 * box.size[0] * box.placement[:3, 0]
        for (x, y, z), r in ((middle - half, at), (middle + half, middle[0] + half[0])):
            assert (x, y, z) == pytest.approx((r, 0.0, r**2 / (4.0 * f)), abs=1e-15)
        at = middle[0] + half[0]
        assert box.placement[:3, 1] == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
        sector = 2.0 * middle[0] * np.tan(np.pi / count) if count > 2 else 4.0 * middle[0]
        assert (0.9 if count > 2 else 0.5) * sector < box.size[1] < sector
    assert at == pytest.approx(rim, rel=1e-14)
    cos, sin = np.cos(2.0 * np.pi / count), np.sin(2.0 * np.pi / count)
    for box, other in zip(first.drawn, second.drawn, strict=True):
        x, _, z = box.placement[:3, 3]
        assert other.placement[:3, 3] == pytest.approx([x * cos, x * sin, z], abs=1e-15)
