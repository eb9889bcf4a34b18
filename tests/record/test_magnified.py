"""The joint close up: drawn gaps are M times the real ones, so drawn contact is real contact."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin.joints.geometry import (
    PlanarClearance,
    PrismaticClearance,
    RevoluteClearance,
    SphericalClearance,
)
from antenna_pin.show.record.magnified import (
    MagnifiedBall,
    MagnifiedJournal,
    MagnifiedSlider,
    default_magnification,
)

M = 100.0
COVERED = dict(
    bearing_radius=10e-3,
    journal_radius=9.8e-3,
    bearing_length=50e-3,
    flange_distance=50.4e-3,
    bearing_outer_radius=12e-3,
    flange_radius=14e-3,
)
SMALL_FLANGE = COVERED | {"flange_radius": 11e-3}


def poses(count=200, seed=3):
    """Journal poses that reach a little into contact everywhere: centres [m] and unit axes."""
    rng = np.random.default_rng(seed)
    centre = rng.uniform(-1.0, 1.0, (count, 3)) * [1.2e-4, 1.2e-4, 2.1e-4]
    tilt = rng.uniform(-1.0, 1.0, (count, 2)) * 4e-3
    axis = Rotation.from_rotvec(np.hstack([tilt, np.zeros((count, 1))])).apply([0.0, 0.0, 1.0])
    return centre, axis


def recorded(geometry, centre, axis):
    """Gaps and points as a run records them."""
    found = [geometry.contacts(p, z) for p, z in zip(centre, axis, strict=True)]
    return np.array([[c.gap for c in row] for row in found]), np.array(
        [[c.point for c in row] for row in found]
    )


def drawn_journal_centre(placement, z):
    """Where the drawn barrel's axis crosses a plane, (n, 2)."""
    along = (z - placement[:, 2, 3]) / placement[:, 2, 2]
    return placement[:, :2, 3] + placement[:, :2, 2] * along[:, None]


@pytest.mark.parametrize("dimensions", [COVERED, SMALL_FLANGE], ids=["covering", "small flange"])
def test_drawn_gaps_of_a_revolute_joint_are_the_real_ones_magnified(dimensions):
    geometry = RevoluteClearance(**dimensions)
    shape = MagnifiedJournal.of(dimensions, M)
    centre, axis = poses()
    gap, point = recorded(geometry, centre, axis)
    assert (gap < 0.0).any(axis=0).all() and (gap > 0.0).any(axis=0).all()
    centres = shape.eccentricity(gap[:, :2], point[:, :2])
    flanges = [shape.flange(s, gap[:, 2 + k], axis[:, :2], centres) for k, s in enumerate((1.0, -1.0))]
    barrel = shape.barrel(centres, 0.5 * (flanges[0][:, 2, 3] + flanges[1][:, 2, 3]))
    for k, sign in enumerate((1.0, -1.0)):
        # In the bore: section of the drawn barrel with the end circle's plane, a circle of its own radius.
        at = drawn_journal_centre(barrel, 0.5 * sign * shape.length)
        drawn = shape.bore_radius - shape.journal_radius - np.linalg.norm(at, axis=1)
        assert drawn == pytest.approx(M * gap[:, k], rel=1e-9, abs=1e-12)  # round-off
        # At the flange: the drawn face over the edge that touches, at a thousand places of it.
        angle = np.linspace(0.0, 2.0 * np.pi, 1000, endpoint=False)
        circle = shape.drawn_edge * np.stack([np.cos(angle), np.sin(angle)])
        face = flanges[k]
        if shape.covered:  # height of the face above the bearing's edge
            local = circle[None] - face[:, :2, 3, None]
        else:  # height of the flange's own edge
            local = np.broadcast_to(circle, (len(centre), 2, 1000))
        height = face[:, 2, 3, None] + np.einsum("nk,nki->ni", face[:, 2, :2], local)
        least = (sign * height - 0.5 * shape.length).min(axis=1)
        # The minimum over a thousand places is off by the tilted circle's curvature, M R t (pi / 1000)^2 / 2.
        assert least == pytest.approx(M * gap[:, 2 + k], rel=0.0, abs=M * 14e-3 * 6e-3 * 5e-6)


def test_drawn_eccentricity_and_tilt_are_those_of_the_pose_to_first_order():
    geometry = RevoluteClearance(**COVERED)
    shape = MagnifiedJournal.of(COVERED, M)
    centre, axis = poses()
    gap, point = recorded(geometry, centre, axis)
    centres = shape.eccentricity(gap[:, :2], point[:, :2])
    for k, sign in enumerate((1.0, -1.0)):
        along = (0.5 * sign * COVERED["bearing_length"] - centre[:, 2]) / axis[:, 2]
        crossing = centre[:, :2] + axis[:, :2] * along[:, None]
        # Second order: the journal's section is an ellipse, wider by R_j tilt^2 / 2 (tilt up to 6e-3).
        assert np.abs(centres[:, k] / M - crossing).max() < 10e-3 * 0.5 * 6e-3**2 * 2.0


def test_drawn_contacts_lie_on_the_drawn_edges_and_a_covering_flange_covers():
    shape = MagnifiedJournal.of(COVERED, M)
    centre, axis = poses()
    gap, point = recorded(RevoluteClearance(**COVERED), centre, axis)
    bore = shape.radial_points(1.0, point[:, 0])
    assert np.hypot(bore[:, 0], bore[:, 1]) == pytest.approx(shape.bore_radius, rel=1e-12)
    assert (bore[:, 2] == 0.5 * shape.length).all()
    centres = shape.eccentricity(gap[:, :2], point[:, :2])
    flange = shape.flange(1.0, gap[:, 2], axis[:, :2], centres)
    edge = shape.axial_points(1.0, point[:, 2], flange)
    assert np.hypot(edge[:, 0], edge[:, 1]) == pytest.approx(shape.drawn_edge, rel=1e-9)
    # A point load with parallel axes acts on the axis, and is drawn there.
    assert np.allclose(shape.axial_points(1.0, np.array([[0.0, 0.0, 0.025]]), flange[:1])[0, :2], 0.0)
    within = np.linalg.norm(edge[:, :2] - flange[:, :2, 3], axis=1)
    assert (within <= shape.flange_radius).all()


def test_planar_joint():
    dimensions = {"bearing_radius": 10e-3, "journal_radius": 9.9e-3}
    shape = MagnifiedJournal.of(dimensions, M)
    centre, axis = poses()
    centre[:, 2], axis = 0.0, np.tile([0.0, 0.0, 1.0], (len(axis), 1))
    gap, point = recorded(PlanarClearance(**dimensions), centre, axis)
    centres = shape.eccentricity(gap, point)
    assert centres[:, 0] == pytest.approx(M * centre[:, :2], rel=1e-9, abs=1e-15)  # exact but for round-off
    barrel = shape.barrel(centres, np.zeros(len(gap)))
    drawn = shape.bore_radius - shape.journal_radius - np.linalg.norm(barrel[:, :2, 3], axis=1)
    assert drawn == pytest.approx(M * gap[:, 0], rel=1e-9, abs=1e-12)


def test_ball_joint():
    dimensions = {"socket_radius": 15e-3, "ball_radius": 14.9e-3}
    shape = MagnifiedBall.of(dimensions, M)
    centre, axis = poses()
    gap, point = recorded(SphericalClearance(**dimensions), centre, axis)
    drawn = shape.centre(gap[:, 0], centre)
    assert drawn == pytest.approx(M * centre, rel=1e-9, abs=1e-15)
    left = shape.socket_radius - shape.ball_radius - np.linalg.norm(drawn, axis=1)
    assert left == pytest.approx(M * gap[:, 0], rel=1e-9, abs=1e-12)
    assert np.linalg.norm(shape.points(point[:, 0]), axis=1) == pytest.approx(shape.socket_radius, rel=1e-12)


@pytest.mark.parametrize(
    ("clearance", "factor"), [(0.2e-3, 15.0), (50e-6, 70.0), (1e-6, 3000.0), (5e-3, 1.0), (20e-3, 1.0)]
)
def test_play_is_drawn_about_a_third_as_wide_as_the_pin(clearance, factor):
    """Steps are apart by a half or less: within a quarter of 0.3, unless the play is drawn as it is."""
    assert default_magnification(10e-3, clearance) == factor
    assert factor == 1.0 or 0.24 < factor * clearance / 10e-3 < 0.375


def test_a_long_bearing_is_drawn_short_with_its_gaps_as_they_are():
    """A metre of hinge on 10 mm pins: gaps at its ends and its flanges are drawn as those of a short one."""
    dimensions = COVERED | {"bearing_length": 1.0, "flange_distance": 1.0004}
    shape = MagnifiedJournal.of(dimensions, M)
    assert shape.length == pytest.approx(10.0 * shape.bore_radius)
    assert shape.shortened * shape.length == pytest.approx(1.0)
    assert shape.flange_gap == pytest.approx(M * 0.2e-3, rel=1e-9)
    centre, axis = poses()
    axis = np.column_stack([0.04 * axis[:, :2], axis[:, 2]])  # what a long bearing leaves room for
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    gap, point = recorded(RevoluteClearance(**dimensions), centre, axis)
    centres = shape.eccentricity(gap[:, :2], point[:, :2])
    flanges = [shape.flange(s, gap[:, 2 + k], axis[:, :2], centres) for k, s in enumerate((1.0, -1.0))]
    barrel = shape.barrel(centres, np.zeros(len(gap)))
    for k, sign in enumerate((1.0, -1.0)):
        at = drawn_journal_centre(barrel, 0.5 * sign * shape.length)
        drawn = shape.bore_radius - shape.journal_radius - np.linalg.norm(at, axis=1)
        assert drawn == pytest.approx(M * gap[:, k], rel=1e-9, abs=1e-12)  # round-off
        # The flange over the bearing's edge: its face is nearest at M times the gap.
        angle = np.linspace(0.0, 2.0 * np.pi, 3601)
        rim = shape.outer_radius * np.array([np.cos(angle), np.sin(angle)])
        for placement, real in zip(flanges[k], gap[:, 2 + k], strict=True):
            # z of the face over the edge: p + A x, with x so that its place across is the rim's.
            across = np.linalg.solve(placement[:2, :2], rim - placement[:2, 3:])
            face = placement[2, 3] + placement[2, :2] @ across
            nearest = (sign * face - 0.5 * shape.length).min()
            assert nearest == pytest.approx(M * real, rel=1e-6, abs=1e-9)  # of 3600 places of the rim


def test_slider(guide):
    """Drawn gaps are the real ones magnified at any tilt; a mark is where its drawn corner touches."""
    geometry = PrismaticClearance(**guide)
    shape = MagnifiedSlider.of(guide, M)
    rng = np.random.default_rng(5)
    position = rng.uniform(-1.0, 1.0, (100, 3)) * [1.5e-4, 1.5e-4, 0.5]
    turned = Rotation.from_rotvec(rng.uniform(-1.0, 1.0, (100, 3)) * [6e-3, 6e-3, 2e-2])
    gap, _ = recorded(geometry, position, turned.as_matrix())
    assert (gap < 0.0).any(axis=0).all() and (gap > 0.0).any(axis=0).all()
    attitude = turned.as_quat()
    placed = shape.slider(position, attitude)
    for k, place in enumerate(geometry.contact_places):
        signs = {place.end[i + 1]: 1.0 if place.end[i] == "+" else -1.0 for i in (0, 2, 4)}
        wall, sign = "xy".index(place.end[1]), 1.0 if place.end[0] == "+" else -1.0
        corner = shape.turn @ (0.5 * shape.size * [signs["x"], signs["y"], signs["z"]])
        drawn = (placed[:, :, :3] @ corner + placed[:, :, 3]) @ shape.turn  # section axes
        # Round-off of lengths of 15 mm, which the factor stretches.
        assert 0.5 * shape.guide[wall] - sign * drawn[:, wall] == pytest.approx(M * gap[:, k], abs=1e-13)
        # The mark: on the wall, below the centre of the corner's rounding, which is r from its other side.
        mark = shape.point(place.end, position, attitude) @ shape.turn
        assert sign * mark[:, wall] == pytest.approx(0.5 * shape.guide[wall], rel=1e-14)
        other = 1 - wall
        beside = drawn[:, other] - signs["xy"[other]] * 0.5e-3
        assert mark[:, other] == pytest.approx(beside, abs=1e-15)
    # Along the axis the picture goes along, in true size.
    assert np.abs(placed[:, 2, 3]).max() == 0.0
