"""Shapes and poses shared by the tests of the geometry, and minimisation by brute force."""

from typing import NamedTuple

import numpy as np
import pytest
from hinge_shapes import antenna_hinge
from numpy.typing import NDArray

from antenna_pin.joints.geometry import RevoluteClearance, pose_of
from antenna_pin.joints.geometry.shape import queried_contacts

#: Half a radian fits a short, wide bore. Its end circle, seen along the journal, is so flat an ellipse that
#: the distance has two local minima in the middle of the bore.
WIDE = dict(radial_clearance=0.0018, bearing_length=0.006, axial_clearance=0.006)

#: Name -> shape, largest tilt [rad], largest offset of the journal's centre across and along the axis [m].
POSE_SETS = {
    "antenna": (antenna_hinge(), 0.010, 0.0004, 0.0004),
    "small flange": (antenna_hinge(flange_radius=0.011), 0.010, 0.0004, 0.0004),
    "equal edges": (antenna_hinge(flange_radius=0.012), 0.010, 0.0004, 0.0004),
    "wide": (antenna_hinge(**WIDE), 0.5, 0.002, 0.004),
    "wide, small flange": (antenna_hinge(**WIDE, flange_radius=0.0105), 0.5, 0.002, 0.004),
}


def axis_of(tilt, direction):
    """Unit vectors tilted from z towards an azimuth, (..., 3)."""
    return np.stack(
        [np.sin(tilt) * np.cos(direction), np.sin(tilt) * np.sin(direction), np.cos(tilt)], axis=-1
    )


def random_poses(count, seed, tilt, across, along):
    """Journal centres and axes, (count, 3) each."""
    rng = np.random.default_rng(seed)
    centre = np.empty((count, 3))
    radius, angle = across * np.sqrt(rng.uniform(size=count)), rng.uniform(0, 2 * np.pi, count)
    centre[:, 0], centre[:, 1] = radius * np.cos(angle), radius * np.sin(angle)
    centre[:, 2] = rng.uniform(-along, along, count)
    return centre, axis_of(tilt * np.sqrt(rng.uniform(size=count)), rng.uniform(0, 2 * np.pi, count))


def zoomed_minimum(function, count, *, grid=360, levels=6, zoom=33):
    """Least value over the circle of ``function(index, angle)``, by grids alone: (values, angles, minima).

    A dense grid; around each of its local minima (``minima`` counts them, per index) a finer grid; and so on
    down to 2 pi / 360 / 16^6 = 1e-9 rad, where a minimum differs from its neighbours by less than round-off.
    """
    angles = 2.0 * np.pi * np.arange(grid) / grid
    index = np.arange(count)
    values = function(index[:, None], angles[None, :])
    lowest = (values <= np.roll(values, 1, axis=1)) & (values < np.roll(values, -1, axis=1))
    flat = ~lowest.any(axis=1)
    lowest[flat, 0] = True
    owner, place = np.nonzero(lowest)
    middle, half = angles[place], 2.0 * np.pi / grid
    offsets = np.linspace(-1.0, 1.0, zoom)
    rows = np.arange(owner.size)
    for _ in range(levels):
        around = middle[:, None] + half * offsets
        values = function(owner[:, None], around)
        best = values.argmin(axis=1)
        middle, half = around[rows, best], half * 2.0 / (zoom - 1)
    least = values[rows, best]
    order = np.lexsort((least, owner))
    first = order[np.unique(owner[order], return_index=True)[1]]
    return least[first], middle[first], np.bincount(owner, minlength=count)


def bore_gaps(shape, centre, axis, side):
    """Gap at one end circle: least distance of its points from the journal's axis, less its radius."""
    radius, height = shape.bearing_radius, 0.5 * side * shape.bearing_length

    def distance(index, angle):
        dx = radius * np.cos(angle) - centre[index, 0]
        dy = radius * np.sin(angle) - centre[index, 1]
        dz = height - centre[index, 2]
        zx, zy, zz = (axis[index, k] for k in range(3))
        # |d x z|, which loses nothing to cancellation.
        return np.sqrt((dy * zz - dz * zy) ** 2 + (dz * zx - dx * zz) ** 2 + (dx * zy - dy * zx) ** 2)

    least, angle, minima = zoomed_minimum(distance, len(centre))
    return least - shape.journal_radius, angle, minima


def flange_gaps(shape, centre, axis, side):
    """Gap between flange and end face, over the edge circle of whichever of the two is smaller."""
    if shape.flange_radius >= shape.bearing_outer_radius:

        def distance(index, angle):
            point = np.stack(
                [
                    shape.bearing_outer_radius * np.cos(angle) - centre[index, 0],
                    shape.bearing_outer_radius * np.sin(angle) - centre[index, 1],
                    0.5 * side * shape.bearing_length - centre[index, 2] + 0.0 * angle,
                ]
            )
            along = sum(point[k] * axis[index, k] for k in range(3))
            return 0.5 * shape.flange_distance - side * along

    else:
        # Two unit vectors in the plane of the flange.
        helper = np.where(np.abs(axis[:, :1]) < 0.9, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0])
        first = np.cross(axis, helper)
        first /= np.linalg.norm(first, axis=1, keepdims=True)
        second = np.cross(axis, first)

        def distance(index, angle):
            height = centre[index, 2] + 0.5 * side * shape.flange_distance * axis[index, 2]
            height = height + shape.flange_radius * (
                np.cos(angle) * first[index, 2] + np.sin(angle) * second[index, 2]
            )
            return side * height - 0.5 * shape.bearing_length

    return zoomed_minimum(distance, len(centre), grid=36)[0]


class Poses(NamedTuple):
    """Random poses of a shape with what brute force says of them; sides +1 and -1 along the second axis."""

    name: str
    shape: RevoluteClearance
    centre: NDArray[np.float64]  # (poses, 3)
    axis: NDArray[np.float64]  # (poses, 3)
    bore: NDArray[np.float64]  # (poses, 2), gaps
    bore_angle: NDArray[np.float64]  # (poses, 2), where on the end circle
    minima: NDArray[np.int64]  # (poses, 2), local minima along the end circle
    flange: NDArray[np.float64]  # (poses, 2), gaps


@pytest.fixture(scope="session", params=POSE_SETS)
def poses(request):
    shape, tilt, across, along = POSE_SETS[request.param]
    centre, axis = random_poses(5_000, 20, tilt, across, along)
    bore = [bore_gaps(shape, centre, axis, side) for side in (1, -1)]
    flange = [flange_gaps(shape, centre, axis, side) for side in (1, -1)]
    columns = [np.stack(values, axis=1) for values in zip(*bore, strict=True)]
    return Poses(request.param, shape, centre, axis, *columns, np.stack(flange, axis=1))


@pytest.fixture(scope="session")
def joint():
    """Make the antenna's joint with changes."""
    return antenna_hinge


@pytest.fixture(scope="session")
def pose_maker():
    """Make random poses: (count, seed, tilt, across, along)."""
    return random_poses


class Coal:
    """A shape whose contacts coal finds."""

    def __init__(self, shape):
        self.shape = shape
        self.backend = shape.coal(np.eye(3))

    def contacts(self, p_HJ, attitude):
        return queried_contacts(self.backend, len(self.shape.contact_places), pose_of(p_HJ, attitude))
