"""The kernels of a bearing, press and kept, on a journal that moves and turns: vectors, and power."""

import numpy as np
import pytest
from plain_kernels import plain
from scipy.spatial.transform import Rotation

from antenna_pin.base.records import POSE, words_of
from antenna_pin.compiled.decorators import record
from antenna_pin.elements import BallBearing, StiffnessBearing
from antenna_pin.elements.bearing import journal_energy, press

PRESS, ENERGY = plain(press), plain(journal_energy)
RANDOM = np.random.default_rng(11)
STIFFNESS, DAMPING = (one @ one.T for one in RANDOM.normal(size=(2, 5, 5)))


def packed(bearing):
    """Return a bearing as its kernels read it: its record, and its balls behind."""
    words, layout = bearing.words_of_kernel(), bearing.layout()
    return record(words[: words_of(layout)], layout), words[words_of(layout) :]


def moving(offset, seed, size=0.3):
    """Return a journal's pose and twist anywhere, its five coordinates and their rates, by vectors."""
    rng = np.random.default_rng(seed)
    pose = np.zeros(1, POSE)
    axis = Rotation.from_rotvec(size * rng.normal(size=3)).apply([0.0, 0.0, 1.0])
    centre, velocity, spin = size * rng.normal(size=3), rng.normal(size=3), rng.normal(size=3)
    for name, value in (("centre", centre), ("axis", axis), ("velocity", velocity), ("spin", spin)):
        pose[name] = value
    point, turned = centre + offset * (axis - [0.0, 0.0, 1.0]), np.cross(spin, axis)
    rates = velocity + offset * turned
    q, v = np.array([*point, -axis[1], axis[0]]), np.array([*rates, -turned[1], turned[0]])
    return pose, q, v


def test_force_and_loss_of_a_bearing_are_those_of_its_matrices():
    """-K q - C q' at the reference point, whose velocity is the centre's and the axis', and q' C q' lost."""
    matrices = {"matrix": tuple(STIFFNESS.ravel()), "damping_matrix": tuple(DAMPING.ravel())}
    bearing = StiffnessBearing(joint="axle", offset=0.4, **matrices)
    for seed in range(3):
        pose, q, v = moving(0.4, seed)
        lost = PRESS(*packed(bearing), pose[0])
        expected = -STIFFNESS @ q - DAMPING @ v
        assert pose["force"][0] == pytest.approx(expected[:3], rel=1e-12)
        assert lost == pytest.approx(v @ DAMPING @ v, rel=1e-12)
        # Force and torque together have the power of the five coordinates' efforts.
        power = pose["force"][0] @ pose["velocity"][0] + pose["moment"][0] @ pose["spin"][0]
        assert power == pytest.approx(expected @ v, rel=1e-12)


@pytest.mark.parametrize(
    ("bearing", "size"),
    [
        (StiffnessBearing(joint="axle", matrix=tuple(STIFFNESS.ravel()), offset=-0.2), 0.3),
        (
            BallBearing(
                joint="axle",
                count=12,
                ball_diameter=6e-3,
                pitch_diameter=40e-3,
                contact_angle=0.26,
                preload=50.0,
                offset=0.01,
                by="balls",
            ),
            3e-6,
        ),
    ],
    ids=["matrix", "balls"],
)
def test_what_a_bearing_stores_is_what_it_takes(bearing, size):
    """Its power along a motion of the journal is the rate of the energy stored, by differences."""
    own, h = packed(bearing), 1e-3 * size
    pose, _, _ = moving(bearing.offset, 3, size)
    velocity, spin = pose["velocity"][0], pose["spin"][0]

    def energy(t):
        axis = Rotation.from_rotvec(t * spin).apply(pose["axis"][0])
        return ENERGY(*own, np.concatenate([pose["centre"][0] + t * velocity, axis]))

    assert PRESS(*own, pose[0]) == 0.0
    slope = 8.0 * (energy(h) - energy(-h)) - energy(2.0 * h) + energy(-2.0 * h)
    power = pose["force"][0] @ velocity + pose["moment"][0] @ spin
    # Of fourth order over a thousandth of the displacement; round-off of the energy over the step.
    assert power == pytest.approx(-slope / (12.0 * h), rel=1e-8)
