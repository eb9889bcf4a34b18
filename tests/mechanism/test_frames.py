"""Rotations that turn z to an axis, and their URDF angles."""

import math

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import frame_aligning_z, quaternion, roll_pitch_yaw
from antenna_pin.mechanism import rotation as of_quaternion
from antenna_pin.mechanism.frames import of_roll_pitch_yaw

Z = np.array([0.0, 0.0, 1.0])
ROUND_OFF = 4e-15  # some tens of roundings of numbers up to 1

component = st.floats(-1.0, 1.0) | st.sampled_from([0.0, 1e-200, 1e-20, 1e-9, -1e-9, 1.0, -1.0])


def rotation(roll, pitch, yaw):
    """R = Rz(yaw) Ry(pitch) Rx(roll), as the URDF specification has it."""
    (sr, sp, sy), (cr, cp, cy) = np.sin([roll, pitch, yaw]), np.cos([roll, pitch, yaw])
    about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    return about_z @ about_y @ about_x


@settings(deadline=None)
@example((0.0, 3.2482148825046154e-208, -1.4294095585084296e-47), 1.0)
@given(st.tuples(component, component, component), st.sampled_from([1.0, 1e-150, 1e150]))
def test_the_shortest_rotation_takes_z_to_the_axis(axis, length):
    """A proper rotation, its third column the axis, its angle the one between z and the axis."""
    assume(any(axis))
    unit = np.array(axis) / max(map(abs, axis))
    unit /= np.linalg.norm(unit)
    r = frame_aligning_z(np.array(axis) / max(map(abs, axis)) * length)
    assert np.abs(r.T @ r - np.eye(3)).max() < ROUND_OFF
    assert np.linalg.det(r) == pytest.approx(1.0, abs=ROUND_OFF)
    assert np.abs(r @ Z - unit).max() < ROUND_OFF
    # Shortest: 1 + 2 cos(angle) is the trace of a rotation, and cos(angle) is the axis' own z.
    assert np.trace(r) == pytest.approx(1.0 + 2.0 * unit[2], abs=ROUND_OFF)
    assert np.array_equal(r, frame_aligning_z(np.array(axis) / max(map(abs, axis)) * length))


def test_the_plain_axes_are_turned_without_rounding():
    """Quarter turns and half turns have entries 0 and 1 only; z itself is not turned."""
    assert np.array_equal(frame_aligning_z(Z), np.eye(3))
    assert np.array_equal(frame_aligning_z(-3.0 * Z), np.diag([1.0, -1.0, -1.0]))
    assert np.array_equal(
        frame_aligning_z([0.0, 1.0, 0.0]), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]]
    )
    assert np.array_equal(
        frame_aligning_z([1.0, 0.0, 0.0]), [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]
    )


@pytest.mark.parametrize("axis", [(0.0, 0.0, 0.0), (1.0, 0.0), (math.nan, 0.0, 1.0), (math.inf, 0.0, 0.0)])
def test_what_has_no_direction_is_refused(axis):
    with pytest.raises(InvalidParameterError, match="axis must be three finite numbers, not all zero"):
        frame_aligning_z(axis)


angle = st.floats(-math.pi, math.pi) | st.sampled_from(
    [0.0, math.pi / 2, -math.pi / 2, 1.57079632679, math.pi]
)


@settings(deadline=None)
@given(angle, angle, angle)
def test_urdf_angles_rebuild_the_rotation_also_at_a_pitch_of_ninety_degrees(roll, pitch, yaw):
    """The usual formulas lose half the digits within 1e-8 rad of a quarter turn."""
    r = rotation(roll, pitch, yaw)
    # A product, as in use: its zeros are round-off, which is what misleads the usual formulas.
    r = r @ rotation(0.4, 0.1, -0.2) @ rotation(0.4, 0.1, -0.2).T
    assert np.abs(rotation(*roll_pitch_yaw(r)) - r).max() < ROUND_OFF


@pytest.mark.parametrize("largest", [*range(4), None])
def test_quaternions_are_those_of_scipy(largest):
    """Bit for bit, whichever of the four is the largest: results that hold them do not change."""
    rng = np.random.default_rng(5)
    given = rng.normal(size=(200, 4))
    if largest is not None:
        given[:, largest] += 20.0
    there = Rotation.from_quat(given)
    matrices = there.as_matrix()
    assert np.array_equal(quaternion(matrices), Rotation.from_matrix(matrices).as_quat())
    assert np.array_equal(quaternion(matrices[3]), quaternion(matrices)[3])
    assert of_quaternion(there.as_quat()) == pytest.approx(matrices, abs=ROUND_OFF)


def test_quarter_and_half_turns_have_exact_quaternions():
    half, quarter = np.diag([-1.0, 1.0, -1.0]), rotation(0.0, 0.0, math.pi / 2.0)
    assert quaternion(np.eye(3)).tolist() == [0.0, 0.0, 0.0, 1.0]
    assert quaternion(half).tolist() == [0.0, 1.0, 0.0, 0.0]
    assert quaternion(quarter) == pytest.approx([0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5)], abs=ROUND_OFF)


@given(st.tuples(*[st.floats(-7.0, 7.0)] * 3))
def test_the_rotation_of_urdf_angles_is_that_of_its_definition(angles):
    found = of_roll_pitch_yaw(*angles)
    assert found == pytest.approx(rotation(*angles), abs=ROUND_OFF)
    assert not np.any(np.signbit(found) & (found == 0.0))
