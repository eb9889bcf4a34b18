"""Changes of gaps, normals and points in closed form: against differences, and as a velocity's parts."""

import numpy as np
import pytest
from hinge_shapes import antenna_hinge
from scipy.spatial.transform import Rotation

from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.joints.geometry import (
    PlanarClearance,
    PrismaticClearance,
    SphericalClearance,
    kernels,
    pose_of,
)
from antenna_pin.joints.geometry.tangent_kernels import CHANGED, GAP, NORMAL, POINT, contact_changes

from .conftest import WIDE

SHAPES = {
    "flanges cover": antenna_hinge(),
    "small flanges": antenna_hinge(flange_radius=0.011),
    "wide": antenna_hinge(**WIDE),
    "planar": PlanarClearance(bearing_radius=0.01, journal_radius=0.0098),
    "ball": SphericalClearance(ball_radius=0.0099, socket_radius=0.01),
    "walls": PrismaticClearance(
        guide_width=0.0401,
        guide_height=0.0602,
        slider_width=0.04,
        slider_height=0.06,
        slider_length=0.1,
        corner_radius=3e-3,
    ),
}
# Of rotations and of lengths, over the scale of a play: a sixth-order difference is off by (0.01)^6.
STEP = 1e-6


def displaced(shape, centre, turn, seed):
    """Candidates, a pose, its change and that of the dimensions; and what makes both of a step."""
    rng = np.random.default_rng(seed)
    words = shape.candidates(np.eye(3))
    way, spin = rng.normal(size=3), rng.normal(size=3) * (1.0 if shape is not SHAPES["planar"] else [0, 0, 1])
    dimensions = rng.normal(size=words.shape)
    dimensions[:, 0] = 0.0  # the primitive
    if words[0].view(np.int64)[0] in (kernels.BORE, kernels.FLANGE):
        dimensions[:, 1] = 0.0  # the side
    rotation = Rotation.from_rotvec(turn).as_matrix()

    def at(h):
        moved = pose_of(centre + h * way, Rotation.from_rotvec(h * spin).as_matrix() @ rotation)
        return np.ascontiguousarray(np.where(dimensions == 0.0, words, words + h * dimensions)), moved

    change, pose = np.zeros(1, POSE), at(0.0)[1]
    change["centre"], change["rotation"] = way, np.cross(spin, rotation, axisb=0, axisc=0)
    change["axis"] = change["rotation"][0, :, 2]
    if pose["sine"][0] > 0.0:
        change["sine"] = pose["axis"][0, :2] @ change["axis"][0, :2] / pose["sine"][0]
    return words, pose, change, dimensions, at


def filled(words, pose):
    table = np.zeros(len(words), CONTACT)
    kernels.fill(np.ascontiguousarray(words).reshape(-1), pose, table)
    return np.column_stack([table["gap"], table["normal"], table["point"]]), table


def poses(name, count=6):
    rng = np.random.default_rng(5)
    tilt, off = (0.3, 1.5e-3) if name == "wide" else (5e-3, 2e-4)
    for _ in range(count):
        turn = np.append(tilt * rng.uniform(-1.0, 1.0, 2), rng.uniform(-3.0, 3.0))
        centre = off * rng.uniform(0.3, 1.0, 3) * rng.choice([-1.0, 1.0], 3)
        if name in ("planar", "walls"):
            turn[:2] *= 0.0 if name == "planar" else 0.2
        if name == "planar":
            centre[2] = 0.0
        if name == "walls":
            turn[2] = 0.0
        yield centre, turn


def changes(words, dimensions, pose, change, table):
    out = np.zeros((len(words), CHANGED))
    for own, grown, row, found in zip(words, dimensions, table, out, strict=True):
        contact_changes(own, grown, pose[0], change[0], row, found)
    return out


@pytest.mark.parametrize("name", SHAPES)
def test_gaps_normals_and_points_change_as_differences_say(name):
    """Along random motions and changes of all dimensions at once."""
    for seed, (centre, turn) in enumerate(poses(name)):
        words, pose, change, dimensions, at = displaced(SHAPES[name], centre, turn, seed)
        here, table = filled(words, pose)
        found = changes(words, dimensions, pose, change, table)
        right = np.zeros_like(here)
        for k, weight in enumerate(WEIGHTS[0]):
            for side in (1.0, -1.0):
                right += side * weight * filled(*at(side * (k + 1.0) * STEP))[0] / STEP
        # Places are known to 1e-18 m, normals to 1e-16: over a step, and a point's way over a play, 1e-4 m.
        assert found[:, GAP] == pytest.approx(right[:, GAP], rel=1e-9, abs=1e-9)
        for part in (slice(NORMAL, POINT), slice(POINT, CHANGED)):
            size = np.abs(right[:, part]).max()
            assert found[:, part] == pytest.approx(right[:, part], rel=0.0, abs=1e-8 * max(size, 1.0))


@pytest.mark.parametrize("name", SHAPES)
def test_a_gap_opens_by_the_velocity_along_its_normal(name):
    """Of the journal's point there: what moves along the surfaces does not part them."""
    for seed, (centre, turn) in enumerate(poses(name)):
        words, pose, change, dimensions, _ = displaced(SHAPES[name], centre, turn, seed)
        _, table = filled(words, pose)
        found = changes(words, 0.0 * dimensions, pose, change, table)
        spin = change["rotation"][0] @ pose["rotation"][0].T  # its cross product
        arms = table["point"] - pose["centre"]
        along = np.einsum("ni,ni->n", table["normal"], change["centre"] + arms @ spin.T)
        # Places of centimetres, known to round-off, turned by a radian.
        assert found[:, GAP] == pytest.approx(along, rel=1e-13, abs=1e-15)
