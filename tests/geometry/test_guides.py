"""Gaps of sliders in guides that end, square and round, against brute force, coal and their definition."""

import dataclasses
import math
import re

import coal
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin.joints.geometry import LOOKS, CylindricalClearance, PrismaticClearance

from .conftest import Coal, axis_of, zoomed_minimum

SIDES = dict(guide_width=0.0401, guide_height=0.0602, slider_width=0.04, slider_height=0.06)
SQUARE = {
    "short guide": PrismaticClearance(**SIDES, slider_length=0.1, guide_length=0.03),
    "long guide": PrismaticClearance(**SIDES, slider_length=0.1, guide_length=0.15, roll=0.3),
    "rounded": PrismaticClearance(**SIDES, slider_length=0.1, guide_length=0.08, corner_radius=0.003),
}
ROUND = dict(bearing_radius=0.01, journal_radius=0.0099)
ROD = {
    "short guide": CylindricalClearance(**ROUND, slider_length=0.1, guide_length=0.03),
    "long guide": CylindricalClearance(**ROUND, slider_length=0.05, guide_length=0.08),
    "no end": CylindricalClearance(**ROUND, slider_length=0.05),
}
KEY = dict(key_width=4e-3, keyway_width=4.1e-3, key_reach=0.011)


def poses(count, seed, tilt, across, along):
    """Centres and rotations of sliders."""
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(tilt * rng.uniform(-0.5, 0.5, (count, 3))).as_matrix()
    centres = rng.uniform(-1.0, 1.0, (count, 3)) * [across, across, along]
    return zip(centres, turns, strict=True)


def wall_and_box(shape, wall, centre, turn):
    """Distance of a slider from the block behind a wall, by coal's boxes, in mm for its tolerance [m]."""
    axis, sign = "xy".index(wall[1]), 1.0 if wall[0] == "+" else -1.0
    half = 0.5 * (shape.guide_width, shape.guide_height)[axis]
    roll = Rotation.from_rotvec([0.0, 0.0, shape.roll]).as_matrix()
    thick, r = 100.0, shape.corner_radius
    size = np.array([400.0, 400.0, 1e3 * shape.guide_length])
    size[axis] = thick
    place = np.zeros(3)
    place[axis] = sign * (1e3 * half + 0.5 * thick)
    sides = 1e3 * (np.array([shape.slider_width, shape.slider_height, shape.slider_length]) - 2.0 * r)
    request = coal.DistanceRequest()
    request.gjk_tolerance = request.epa_tolerance = 1e-10
    request.gjk_max_iterations = request.epa_max_iterations = 1000
    result = coal.DistanceResult()
    distance = coal.distance(
        coal.Box(*size), coal.Transform3s(roll, roll @ place),
        coal.Box(*sides), coal.Transform3s(turn @ roll, 1e3 * np.array(centre)), request, result,
    )  # fmt: skip
    return 1e-3 * distance - r


@pytest.mark.parametrize("name", SQUARE)
@pytest.mark.parametrize("tilt", [0.002, 0.2])
def test_the_least_gap_at_a_wall_is_the_distance_of_two_boxes(name, tilt):
    """Of slider and block: apart, wherever the slider is along the guide; GJK in mm is good to 1e-11 m."""
    shape = SQUARE[name]
    ends = [p.end for p in shape.contact_places]
    compared = 0
    for centre, turn in poses(150, 3, tilt, 2e-5 if tilt < 0.1 else 2e-3, 0.06):
        found = dict(zip(ends, shape.contacts(centre, turn), strict=True))
        for wall in ("+x", "-x", "+y", "-y"):
            least = min((c for end, c in found.items() if end.startswith(wall)), key=lambda c: c.gap)
            truth = wall_and_box(shape, wall, centre, turn)
            if truth > 0.0:
                compared += 1
                assert least.gap == pytest.approx(truth, abs=3e-11), (wall, centre)
    assert compared > 20


def mouth_and_line(shape, end, centre, turn):
    """Distance of the mouth's edge next to an end from the slider's long edge there, as endless lines [m]."""
    wall, across, along = (1.0 if end[k] == "+" else -1.0 for k in (0, 2, 4))
    axis = "xy".index(end[1])
    roll = Rotation.from_rotvec([0.0, 0.0, shape.roll]).as_matrix()
    half = 0.5 * np.array([shape.slider_width, shape.slider_height, shape.slider_length])
    corner = np.zeros(3)
    corner[axis], corner[1 - axis], corner[2] = wall, across, along
    place = np.asarray(centre) + turn @ roll @ (corner * (half - shape.corner_radius))
    mouth = roll[:, axis] * 0.5 * wall * (shape.guide_width, shape.guide_height)[axis]
    mouth = mouth + np.array([0.0, 0.0, 0.5 * along * shape.guide_length])
    normal = np.cross(roll[:, 1 - axis], turn[:, 2])
    normal /= np.linalg.norm(normal)
    normal *= -wall * np.sign(normal @ roll[:, axis])
    return normal @ (place - mouth) - shape.corner_radius, normal


def test_where_a_slider_reaches_out_of_a_mouth_its_edge_meets_the_mouths():
    """In a guide shorter than the slider all candidates are crossings of two lines, pressed or not."""
    shape = SQUARE["short guide"]
    for centre, turn in poses(300, 5, 0.01, 2e-4, 0.02):
        for place, contact in zip(shape.contact_places, shape.contacts(centre, turn), strict=True):
            gap, normal = mouth_and_line(shape, place.end, centre, turn)
            assert contact.gap == pytest.approx(gap, abs=2e-17)  # round-off of 5 cm
            assert contact.normal == pytest.approx(normal, abs=1e-15)
            # The slider's point beside the mouth: as far from it as the gap.
            assert abs(contact.point[2] - math.copysign(0.015, contact.point[2])) <= abs(gap) * 0.02


@pytest.mark.parametrize("shape", [*SQUARE.values(), *ROD.values()], ids=str)
def test_the_rate_of_a_gap_is_that_of_the_slider_at_the_point_along_the_normal(shape):
    """A force along the normal at the point has a potential; central differences over 1e-7."""
    rng = np.random.default_rng(8)
    h = 1e-7
    for centre, turn in poses(100, 9, 0.004, 1e-4, 0.05):
        velocity, spin = rng.normal(size=3), rng.normal(size=3)

        def at(s, centre=centre, turn=turn, velocity=velocity, spin=spin):
            turned = Rotation.from_rotvec(s * spin).as_matrix() @ turn
            return shape.contacts(centre + s * velocity, turned)

        for now, before, after in zip(at(0.0), at(-h), at(h), strict=True):
            if np.linalg.norm(after.normal - before.normal) > 1e-5:
                continue  # a corner that passes the mouth meanwhile
            rate = now.normal @ (velocity + np.cross(spin, now.point - centre))
            # Round-off of centimetres over h, and of normals that turn fast where a rod is nearly centred.
            assert (after.gap - before.gap) / (2.0 * h) == pytest.approx(rate, abs=5e-8)


@pytest.mark.parametrize("shape", [*SQUARE.values(), *ROD.values()], ids=str)
@pytest.mark.parametrize("depth", [-2e-6, 3e-5])
def test_a_gap_does_not_jump_as_a_slider_goes_through_its_guide(shape, depth):
    """Pressed and apart, tilted, all the way into the guide and out again."""
    turn = Rotation.from_rotvec([0.3e-3, -0.8e-3, 0.1e-3]).as_matrix()
    way = np.linspace(-0.16, 0.16, 401)
    gaps = np.array(
        [[c.gap for c in shape.contacts([5e-5 - depth + 0.8e-3 * z, 1e-5, z], turn)] for z in way]
    )
    # Of a rate of 1 where the slider leaves along the axis.
    assert np.abs(np.diff(gaps, axis=0)).max() <= 1.001 * (way[1] - way[0])
    centre = np.array([5e-5 - depth, 1e-5, 0.0])
    lengths = shape.slider_length, shape.guide_length or math.inf
    edge = 0.5 * abs(lengths[1] - lengths[0])
    if math.isfinite(edge):
        for end in (-1.0, 1.0):
            fine = end * edge + np.linspace(-1e-7, 1e-7, 201)
            close = np.array([[c.gap for c in shape.contacts(centre + [0.0, 0.0, z], turn)] for z in fine])
            # A way of 1e-9 m along a slope of 1e-3: no step beside it.
            assert np.abs(np.diff(close, axis=0)).max() < 2e-12


@pytest.mark.parametrize("name", ROD)
def test_a_rods_gap_is_the_least_over_rim_or_mouth(name):
    """The slider's rim from the wall where it ends within, else the mouth from the slider's barrel."""
    shape = ROD[name]
    rng = np.random.default_rng(2)
    count = 400
    centre = np.stack([*rng.uniform(-1.5e-4, 1.5e-4, (2, count)), rng.uniform(-0.02, 0.02, count)], axis=1)
    axis = axis_of(4e-3 * np.sqrt(rng.uniform(size=count)), rng.uniform(0, 2 * np.pi, count))
    first = np.cross(axis, [0.0, 1.0, 0.0])
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    second = np.cross(axis, first)
    guide = 0.5 * shape.guide_length if shape.guide_length else math.inf
    for k, side in enumerate((1.0, -1.0)):

        def rim(i, angle, side=side):
            c, s = np.cos(angle), np.sin(angle)
            at = [
                centre[i, n]
                + 0.5 * side * shape.slider_length * axis[i, n]
                + shape.journal_radius * (c * first[i, n] + s * second[i, n])
                for n in (0, 1)
            ]
            return shape.bearing_radius - np.hypot(*at)

        def mouth(i, angle, side=side):
            q = [shape.bearing_radius * np.cos(angle), shape.bearing_radius * np.sin(angle), side * guide]
            d = [q[n] - centre[i, n] for n in range(3)]
            z = [axis[i, n] for n in range(3)]
            square = sum(
                (d[a] * z[b] - d[b] * z[a]) ** 2 for a, b in ((0, 1), (1, 2), (2, 0))
            )  # fmt: skip
            return np.sqrt(square) - shape.journal_radius

        within = side * (centre[:, 2] + 0.5 * side * shape.slider_length * axis[:, 2]) < guide
        truth = zoomed_minimum(rim, count)[0]
        if math.isfinite(guide):
            truth = np.where(within, truth, zoomed_minimum(mouth, count)[0])
        # An end within 1e-4 m of the mouth, where the rim's lowest point may be out: another test's.
        clear = np.abs(side * centre[:, 2] + 0.5 * shape.slider_length - guide) > 1e-4
        assert clear.sum() > 300
        found = np.array([shape.contacts(p, z)[k].gap for p, z in zip(centre, axis, strict=True)])
        assert found[clear] == pytest.approx(truth[clear], abs=1e-17 + 2e-17)  # round-off of a centimetre


@pytest.mark.parametrize("shape", [*SQUARE.values(), *ROD.values(), CylindricalClearance(
    **ROUND, **KEY, slider_length=0.05, guide_length=0.04)], ids=str)  # fmt: skip
def test_coal_agrees_with_the_closed_form(shape):
    asked = Coal(shape)
    for centre, turn in poses(200, 6, 0.004, 1e-4, 0.06):
        for one, other in zip(shape.contacts(centre, turn), asked.contacts(centre, turn), strict=True):
            assert one.gap == pytest.approx(other.gap, abs=5e-17)
            assert one.normal == pytest.approx(other.normal, abs=1e-12)  # coal's are differences of points


def test_a_longer_guide_is_one_without_end():
    endless = PrismaticClearance(**SIDES, slider_length=0.1, roll=0.3)
    for centre, turn in poses(100, 7, 0.004, 1e-4, 0.02):
        for one, other in zip(
            SQUARE["long guide"].contacts(centre, turn), endless.contacts(centre, turn), strict=True
        ):
            assert one.gap == pytest.approx(other.gap, abs=1e-17)
            assert one.point == pytest.approx(other.point, abs=1e-16)


def test_a_key_bears_on_its_keyway_after_its_play():
    """Turned by phi, its flank at (a, b) is at a sin + b cos across; the keyway's wall at b + 50 um."""
    shape = CylindricalClearance(**ROUND, **KEY, slider_length=0.05)
    for angle in (0.0, 2e-3, -5e-3, 0.02):
        turn = Rotation.from_rotvec([0.0, 0.0, angle]).as_matrix()
        for place, contact in zip(shape.contact_places, shape.contacts([0, 0, 0], turn), strict=True):
            if place.kind == "key":
                flank = 1.0 if place.end[0] == "+" else -1.0
                across = 0.011 * math.sin(angle) + 0.002 * flank * math.cos(angle)
                assert contact.gap == pytest.approx(2.05e-3 - flank * across, abs=1e-18)
                assert contact.normal == pytest.approx([0.0, -flank, 0.0])


KEYED = CylindricalClearance(**ROUND, **KEY, slider_length=0.05, guide_length=0.04)


@pytest.mark.parametrize("shape", [*ROD.values(), KEYED], ids=str)
def test_a_centred_rod_touches_at_its_limits_of_tilt_and_twist(shape):
    """Both mouths, or both ends; and a flank of its key touches a wall of the keyway."""
    limits = LOOKS["cylindrical"].across(dataclasses.asdict(shape), np.zeros((1, 3)), np.eye(3)[2:])

    def gaps(turned):
        found = shape.contacts([0.0, 0.0, 0.0], Rotation.from_rotvec(turned).as_matrix())
        kinds = [place.kind for place in shape.contact_places]
        return {k: min(c.gap for c, n in zip(found, kinds, strict=True) if n == k) for k in kinds}

    for azimuth in (0.0, 1.0, 4.0):
        at = limits.tilt * np.array([math.cos(azimuth), math.sin(azimuth), 0.0])
        assert gaps(at)["radial"] == pytest.approx(0.0, abs=2e-17)  # round-off of a centimetre
        assert gaps(0.9 * at)["radial"] > 5e-6
    assert math.isnan(limits.twist) != ("key" in gaps(np.zeros(3)))
    if shape.key_width:
        assert gaps([0.0, 0.0, limits.twist])["key"] == pytest.approx(0.0, abs=2e-17)


@pytest.mark.parametrize(
    ("kind", "shape"),
    [("prismatic", one) for one in SQUARE.values()] + [("cylindrical", one) for one in ROD.values()],
    ids=str,
)
def test_a_sliders_axis_is_seen_at_the_ends_of_what_is_guided(kind, shape):
    """At each end of the slider, or of the guide where that ends before: brute force along the axis."""
    guide = shape.guide_length or math.inf
    s = np.linspace(-0.5, 0.5, 10_001)[:, None] * shape.slider_length
    for centre, turn in poses(20, 10, 0.01, 1e-4, 0.02):
        axis = turn[:, 2]
        line = centre + s * axis
        line = line[np.abs(line[:, 2]) <= 0.5 * guide]
        seen = LOOKS[kind].across(dataclasses.asdict(shape), centre[None], axis[None])
        # The step along the axis.
        assert seen.offset[0] == pytest.approx(line[[-1, 0]], abs=1.01e-4 * shape.slider_length)
        assert seen.eccentricity[0] == pytest.approx(np.linalg.norm(seen.offset[0, :, :2], axis=1))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"journal_radius": 0.02}, "journal_radius must be below bearing_radius = 0.01 m, got 0.02"),
        ({"guide_length": -1.0}, "guide_length must be zero or more, and finite, got -1.0"),
        ({"guide_length": math.nan}, "guide_length must be zero or more, and finite, got nan"),
        ({"key_width": 1e-3}, "keyway_width must be positive, as a key has all three, got 0.0"),
        (KEY | {"key_width": 5e-3}, "key_width must be below keyway_width = 0.0041 m, got 0.005"),
        ({"slider_length": 0.0}, "slider_length must be positive and finite, got 0.0"),
    ],
)  # fmt: skip
def test_refuses_what_is_no_rod_in_a_guide(change, message):
    with pytest.raises(ValueError, match=re.escape(f"CylindricalClearance: {message}")):
        CylindricalClearance(**(ROUND | {"slider_length": 0.05} | change))
