"""Gaps of a slider in its guide against brute force, coal and their definition."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin.joints.geometry import PrismaticClearance

from .conftest import Coal

SIZES = dict(
    guide_width=0.0401, guide_height=0.0602, slider_width=0.04, slider_height=0.06, slider_length=0.1
)
SHAPES = {
    "sharp": PrismaticClearance(**SIZES),
    "rounded": PrismaticClearance(**SIZES, corner_radius=0.004),
    "rolled": PrismaticClearance(**SIZES, corner_radius=0.004, roll=0.7),
}


def poses(count, seed, tilt):
    """Centres and rotations of sliders, among them some turned by ``tilt`` about any axis [rad]."""
    rng = np.random.default_rng(seed)
    turns = Rotation.from_rotvec(tilt * rng.uniform(-0.5, 0.5, (count, 3))).as_matrix()
    return zip(rng.uniform(-2e-4, 2e-4, (count, 3)), turns, strict=True)


def centres(shape):
    """Centres of the balls at a rounded box's corners, (8, 3): one is the farthest in any direction."""
    half = 0.5 * np.array([shape.slider_width, shape.slider_height, shape.slider_length])
    return np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T * (half - shape.corner_radius)


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("tilt", [0.004, 0.6])
def test_the_least_gap_at_a_wall_is_the_boxs_distance_from_it(name, tilt):
    shape = SHAPES[name]
    roll = Rotation.from_rotvec([0.0, 0.0, shape.roll]).as_matrix()
    corners = centres(shape) @ roll.T
    walls = {"+x": (0, 1), "-x": (0, -1), "+y": (1, 1), "-y": (1, -1)}
    for centre, turn in poses(120, 4, tilt):
        found = dict(zip([p.end for p in shape.contact_places], shape.contacts(centre, turn), strict=True))
        placed = centre + corners @ turn.T
        for wall, (axis, sign) in walls.items():
            outward = sign * roll[:, axis]
            half = 0.5 * (shape.guide_width, shape.guide_height)[axis]
            expected = half - (placed @ outward).max() - shape.corner_radius
            mine = [contact for end, contact in found.items() if end.startswith(wall)]
            assert len(mine) == 4
            assert min(c.gap for c in mine) == pytest.approx(expected, abs=1e-16)  # round-off of 5 cm
            for contact in mine:
                assert contact.normal == pytest.approx(-outward, abs=1e-15)
                # The point is that of the corner's ball next to the wall: its distance is the gap.
                assert half - contact.point @ outward == pytest.approx(contact.gap, abs=1e-16)


@pytest.mark.parametrize("name", SHAPES)
def test_coal_agrees_with_the_closed_form(name):
    shape = SHAPES[name]
    coal = Coal(shape)
    for centre, turn in poses(200, 5, 0.6):
        for one, other in zip(shape.contacts(centre, turn), coal.contacts(centre, turn), strict=True):
            assert one.gap == pytest.approx(other.gap, abs=3e-17)
            assert one.normal == pytest.approx(other.normal, abs=1e-15)
            assert one.point == pytest.approx(other.point, abs=1e-16)


def test_centred_every_gap_is_the_play():
    for contact, place in zip(
        SHAPES["rounded"].contacts([0, 0, 0], np.eye(3)), SHAPES["rounded"].contact_places, strict=True
    ):
        assert contact.gap == pytest.approx(5e-5 if place.end[1] == "x" else 1e-4, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"slider_width": 0.0401}, "slider_width must be below guide_width = 0.0401 m, got 0.0401"),
        ({"slider_height": 0.07}, "slider_height must be below guide_height = 0.0602 m, got 0.07"),
        ({"corner_radius": 0.02}, "corner_radius must be below half of each side, 0.02 m"),
        ({"slider_length": 0.0}, "slider_length must be positive and finite, got 0.0"),
        ({"roll": np.nan}, "roll must be finite, got nan"),
    ],
)
def test_refuses_what_is_no_slider(change, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        PrismaticClearance(**(SIZES | change))
