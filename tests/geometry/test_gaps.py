"""Gaps, normals and contact points of a joint with play against brute force and against their definition."""

import math

import numpy as np
import pytest

from antenna_pin.base.records import CONTACT
from antenna_pin.joints.geometry import pose_of
from antenna_pin.joints.geometry.revolute_kernels import nearest_on_ellipse
from antenna_pin.joints.geometry.shape import closed_form

from .conftest import Coal

SIDES = (1.0, -1.0)

BACKENDS = {"closed-form": lambda shape: shape, "coal": Coal}
# With exactly parallel axes the closed form errs by round-off. There coal makes a cylinder longer by 1e-10
# of its length, to keep it strictly convex: 2.5 pm at each end.
PARALLEL = {"closed-form": 1e-17, "coal": 3e-12}


def seven(row):
    """A row of a contact table as gap, normal, point."""
    return np.column_stack([row["gap"], row["normal"], row["point"]])


@pytest.fixture(scope="module")
def table(poses):
    """Closed form: (poses, 4, 7) of gap, normal, point."""
    pairs = zip(poses.centre, poses.axis, strict=True)
    return np.array([seven(closed_form(poses.shape, pose_of(*pair))) for pair in pairs])


@pytest.fixture(scope="module")
def coal_table(poses):
    backend = poses.shape.coal(np.eye(3))
    rows = np.zeros((len(poses.centre), 4), CONTACT)
    for k, pair in enumerate(zip(poses.centre, poses.axis, strict=True)):
        backend.query(pose_of(*pair), rows[k], 0)
    return np.array([seven(row) for row in rows])


def test_coal_leaves_the_rows_that_it_is_not_asked_for(poses):
    """What a sample says of a contact that is apart is what was measured, not where a search begins."""
    backend = poses.shape.coal(np.eye(3))
    for pair in zip(poses.centre[:8], poses.axis[:8], strict=True):
        rows = np.zeros(4, CONTACT)
        pose = pose_of(*pair)
        backend.query(pose, rows, 0)
        measured = seven(rows)
        for wanted in (*np.eye(4).tolist(), [0.0] * 4):
            backend.query(pose, rows, 0, wanted)
            np.testing.assert_array_equal(seven(rows), measured)


def test_radial_gap_is_the_least_distance_to_the_journal(poses, table):
    # 5000 poses and both ends. Grids find the minimum to (1e-9 rad)^2; the rest is round-off of 1e-18 m.
    assert np.abs(table[:, :2, 0] - poses.bore).max() < 1e-12


def test_wide_poses_have_two_local_minima(poses):
    """The comparison above is one of global minima only where there is a choice."""
    if "wide" in poses.name:
        assert (poses.minima == 2).sum() > 1000
        assert (poses.minima == 1).sum() > 500
    assert poses.minima.max() <= 2  # the squared distance is a trigonometric polynomial of degree 2


def test_axial_gap_is_the_least_distance_over_the_smaller_edge(poses, table):
    assert np.abs(table[:, 2:, 0] - poses.flange).max() < 1e-12  # as above


def test_contact_point_is_the_root_of_the_derivative(poses, table):
    """Near contact: the point where the distance along the end circle is stationary, found by bisection."""
    shape, checked = poses.shape, 0
    for end, side in enumerate(SIDES):
        near = np.abs(poses.bore[:, end]) < 20e-6
        centre, axis = poses.centre[near], poses.axis[near]
        checked += near.sum()

        def slope(angle, centre=centre, axis=axis, side=side):
            c, s = np.cos(angle), np.sin(angle)
            point = np.stack([shape.bearing_radius * c, shape.bearing_radius * s, 0.0 * c], axis=1)
            arm = point + [0.0, 0.0, 0.5 * side * shape.bearing_length] - centre
            tangent = np.stack([-s, c, 0.0 * c], axis=1)
            return (np.cross(arm, axis) * np.cross(tangent, axis)).sum(axis=1)

        low, high = poses.bore_angle[near, end] - 1e-4, poses.bore_angle[near, end] + 1e-4
        assert (slope(low) < 0.0).all() and (slope(high) > 0.0).all()
        for _ in range(50):
            middle = 0.5 * (low + high)
            rising = slope(middle) > 0.0
            low, high = np.where(rising, low, middle), np.where(rising, middle, high)
        expected = shape.bearing_radius * np.stack([np.cos(low), np.sin(low)], axis=1)
        # The slope is a cancelling sum of terms of 1e-4 m, divided by an eccentricity of 2e-4 m and more.
        assert np.abs(table[near, end, 4:6] - expected).max() < 1e-13
        assert (table[near, end, 6] == 0.5 * side * shape.bearing_length).all()
    assert checked > 100


def test_radial_rows_are_what_they_are_defined_to_be(poses, table):
    """The point lies on the end circle; from it the normal leads square to the journal's axis and onto it."""
    shape = poses.shape
    for end in range(2):
        gap, normal, point = table[:, end, 0], table[:, end, 1:4], table[:, end, 4:7]
        # All of this is round-off on a length of 1e-2 m.
        assert np.abs(np.hypot(point[:, 0], point[:, 1]) - shape.bearing_radius).max() < 1e-16
        assert np.abs(np.linalg.norm(normal, axis=1) - 1.0).max() < 1e-14
        # The normal is found from the arm, so it errs by round-off over the distance from the axis.
        distance = gap + shape.journal_radius
        assert np.abs((normal * poses.axis).sum(axis=1) * distance).max() < 1e-16
        foot = point + distance[:, None] * normal - poses.centre
        assert np.abs(np.cross(foot, poses.axis)).max() < 1e-16
        tangent = np.stack([-point[:, 1], point[:, 0], 0.0 * gap], axis=1) / shape.bearing_radius
        # Stationary along the circle; at the least distances a change of angle by round-off shows as much.
        assert np.abs((normal * tangent).sum(axis=1) * distance).max() < 1e-16


def test_axial_rows_are_what_they_are_defined_to_be(poses, table):
    shape = poses.shape
    covers = shape.flange_radius >= shape.bearing_outer_radius
    for k, side in enumerate(SIDES):
        gap, normal, point = table[:, 2 + k, 0], table[:, 2 + k, 1:4], table[:, 2 + k, 4:7]
        face = poses.centre + 0.5 * side * shape.flange_distance * poses.axis
        if covers:
            assert np.abs(normal - side * poses.axis).max() < 3e-16  # the axis is made unit
            assert np.abs(np.hypot(point[:, 0], point[:, 1]) - shape.bearing_outer_radius).max() < 1e-16
            assert (point[:, 2] == 0.5 * side * shape.bearing_length).all()
            # The gap is measured from the point to the plane of the flange. Round-off.
            assert np.abs(((face - point) * normal).sum(axis=1) - gap).max() < 5e-17
        else:
            assert (normal == [0.0, 0.0, side]).all()
            arm = point - face
            assert np.abs((arm * poses.axis).sum(axis=1)).max() < 1e-16
            assert np.abs(np.linalg.norm(arm, axis=1) - shape.flange_radius).max() < 1e-16
            assert np.abs(side * point[:, 2] - 0.5 * shape.bearing_length - gap).max() < 5e-17


def test_coal_agrees_with_the_closed_form(poses, table, coal_table):
    # 1e-10 m is asked for. Both are closed forms with the contact angle at a root: round-off of 2.5e-2 m.
    assert np.abs(coal_table[:, :, 0] - table[:, :, 0]).max() < 3e-17


def test_coal_gives_the_same_normals_and_points_near_contact(poses, table, coal_table):
    near = np.abs(table[:, :, 0]) < 20e-6
    for row in range(4):
        rows = near[:, row]
        assert rows.sum() > 5
        # The search ends with a step below 1e-5 rad, carried over to first order: (1e-5)^2 remains, times a
        # factor that grows where a second minimum is near.
        assert np.abs(coal_table[rows, row, 1:4] - table[rows, row, 1:4]).max() < 1e-9
        assert np.abs(coal_table[rows, row, 4:7] - table[rows, row, 4:7]).max() < 1e-11  # times R_i


def test_published_gaps_near_the_axis(pose_maker, joint):
    """(3') of the paper, repaired, is within 5 nm at small tilt; (7') is an identity."""
    shape = joint()
    centre, axis = pose_maker(2000, 3, 0.010, 0.0004, 0.0004)
    worst = identity = 0.0
    for p, z in zip(centre, axis, strict=True):
        contacts = shape.contacts(p, z)
        for k, s in enumerate(SIDES):
            d = np.array([0.0, 0.0, 0.5 * s * shape.bearing_length]) - p
            along = d @ z
            d_r = d - along * z
            n = d_r / np.linalg.norm(d_r)
            cosine = math.sqrt(1.0 - n[2] ** 2)
            published = shape.bearing_radius * cosine - shape.journal_radius - np.linalg.norm(d_r)
            worst = max(worst, abs(contacts[k].gap - published))
            sine = math.hypot(z[0], z[1])
            published = 0.5 * shape.flange_distance - s * along - shape.bearing_outer_radius * sine
            identity = max(identity, abs(contacts[2 + k].gap - published))
    assert worst < 5e-9  # of the approximation; its own authority says 4.5e-9
    assert worst > 1e-10  # and it is one
    assert identity < 5e-17  # round-off


@pytest.mark.parametrize("backend", BACKENDS)
def test_centred_and_parallel_every_gap_is_the_clearance(backend, joint):
    contacts = BACKENDS[backend](joint()).contacts([0, 0, 0], [0, 0, 1])
    assert [c.gap for c in contacts] == pytest.approx([2e-4] * 4, abs=PARALLEL[backend])
    for contact in contacts:
        assert np.isfinite(contact.point).all()
        assert np.linalg.norm(contact.normal) == pytest.approx(1.0, rel=1e-15, abs=0.0)
        assert contact.depth == 0.0


@pytest.mark.parametrize("backend", BACKENDS)
def test_parallel_axes_push_apart_along_the_axis(backend, joint):
    """With exactly parallel axes the flange's force acts on the axis: it has no reason to choose a side."""
    for z in (1e-4, -3e-4):
        contacts = BACKENDS[backend](joint()).contacts([1e-4, 2e-5, z], [0, 0, 1])
        for contact, side in zip(contacts[2:], SIDES, strict=True):
            assert contact.gap == pytest.approx(2e-4 + side * z, abs=PARALLEL[backend])
            assert contact.normal.tolist() == [0.0, 0.0, side]
            assert contact.point == pytest.approx([0.0, 0.0, side * 0.025], abs=1e-17)


@pytest.mark.parametrize("backend", BACKENDS)
def test_parallel_axes_and_a_small_flange_push_on_the_journals_axis(backend, joint):
    contacts = BACKENDS[backend](joint(flange_radius=0.011)).contacts([1e-4, 2e-5, 0.0], [0, 0, 1])
    for contact, side in zip(contacts[2:], SIDES, strict=True):
        assert contact.normal.tolist() == [0.0, 0.0, side]
        assert contact.point == pytest.approx([1e-4, 2e-5, side * 0.0252], abs=PARALLEL[backend])


@pytest.mark.parametrize("backend", BACKENDS)
def test_parallel_axes_make_the_bore_a_circle_in_a_circle(backend, joint):
    eccentricity, angle = 1.7e-4, 2.1
    p = [eccentricity * math.cos(angle), eccentricity * math.sin(angle), 5e-5]
    contacts = BACKENDS[backend](joint()).contacts(p, [0, 0, 1])
    for contact, side in zip(contacts[:2], SIDES, strict=True):
        assert contact.gap == pytest.approx(2e-4 - eccentricity, abs=1e-17)  # round-off
        # Round-off over the eccentricity.
        assert contact.normal == pytest.approx([-math.cos(angle), -math.sin(angle), 0.0], abs=1e-13)
        expected = [0.01 * math.cos(angle), 0.01 * math.sin(angle), side * 0.025]
        assert contact.point == pytest.approx(expected, abs=1e-15)


@pytest.mark.parametrize("tilt", [1e-12, 1e-9, 1e-6])
def test_gaps_are_continuous_as_the_tilt_vanishes(tilt, joint):
    shape, p = joint(), [1.2e-4, -0.8e-4, 3e-5]
    straight = shape.contacts(p, [0, 0, 1])
    leaning = shape.contacts(p, [tilt, 0, 1])
    for a, b in zip(straight, leaning, strict=True):
        assert abs(a.gap - b.gap) <= 0.03 * tilt + 1e-17  # lever arms of at most 25 mm and a little


def test_largest_tilt_by_radial_play(joint):
    """Centred, the journal meets both ends at 2 C_r / L_i = 8 mrad; that uses 96 um of the axial play."""
    shape = joint()
    gaps = [c.gap for c in shape.contacts([0, 0, 0], [math.sin(8e-3), 0, math.cos(8e-3)])]
    # First order in the tilt; the second is R_i tilt^2 / 2 = 3e-7 m.
    assert gaps[0] == pytest.approx(0.0, abs=4e-7)
    assert gaps[1] == pytest.approx(0.0, abs=4e-7)
    assert gaps[2] == pytest.approx(2e-4 - 96e-6, abs=1e-6)


def test_turning_the_bearing_end_for_end_swaps_the_ends(pose_maker, joint):
    shape = joint()
    flip = np.diag([1.0, -1.0, -1.0])
    for p, z in zip(*pose_maker(50, 4, 0.01, 3e-4, 3e-4), strict=True):
        one, other = shape.contacts(p, z), shape.contacts(flip @ p, -(flip @ z))
        for a, b in zip(one, [other[1], other[0], other[3], other[2]], strict=True):
            assert a.gap == pytest.approx(b.gap, abs=3e-17)  # round-off
            assert flip @ a.point == pytest.approx(b.point, abs=1e-12)
            assert flip @ a.normal == pytest.approx(b.normal, abs=1e-12)


def test_a_journal_put_in_upside_down_meets_the_same_bore(pose_maker, joint):
    """Its axis is a line; only its flanges are told apart by the direction."""
    shape = joint()
    for p, z in zip(*pose_maker(50, 5, 0.3, 3e-4, 3e-4), strict=True):
        for backend in (shape, Coal(shape)):
            one, other = backend.contacts(p, z), backend.contacts(p, -z)
            for a, b in zip(one[:2], other[:2], strict=True):
                assert a.gap == pytest.approx(b.gap, abs=3e-17)  # round-off


@pytest.mark.parametrize(
    "point",
    [
        (0, 5e-324),
        (0, 1e-311),
        (0, 1e-285),
        (0, 0),
        (3, 0),
        (0, 2),
        (4, 0),
        (5, 0),
        (0, 9),
        (1e-9, 1e-9),
        (-3, 1e-12),
    ],
)
@pytest.mark.parametrize("axes", [(5.0, 3.0), (5.0, 5.0), (5.0, 4.99999), (5.0, 0.1)])
def test_nearest_point_of_an_ellipse(axes, point):
    """Also on the axes of symmetry, at the centre and on a circle, where every point is as near."""
    a, b = axes
    ex, ey = nearest_on_ellipse(a, b, float(point[0]), float(point[1]))
    assert (ex / a) ** 2 + (ey / b) ** 2 == pytest.approx(1.0, rel=1e-14, abs=0.0)  # round-off
    angle = np.linspace(0.0, 2.0 * np.pi, 200_001)
    least = np.hypot(a * np.cos(angle) - point[0], b * np.sin(angle) - point[1]).min()
    # Half a grid step, 1.6e-5 rad, errs by at most a * 1.6e-5 along, squared over twice the distance.
    assert math.hypot(ex - point[0], ey - point[1]) <= least + 1e-13
    assert math.hypot(ex - point[0], ey - point[1]) == pytest.approx(least, abs=1e-6)
