"""Rotations: as matrices, quaternions and URDF's angles, and between a joint's own axis and ``z``.

A reader of results may take SciPy's; what leads to a run does not wait a third of a second for its loading.
"""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from antenna_pin.base.arguments import takes
from antenna_pin.base.directions import direction

Vector3: TypeAlias = npt.NDArray[np.float64]
"""Shape (3,)."""

Matrix3: TypeAlias = npt.NDArray[np.float64]
"""Shape (3, 3)."""


@takes()
def frame_aligning_z(axis: npt.ArrayLike) -> Matrix3:
    r"""Return the shortest rotation that takes ``z`` to an axis.

    For the unit axis :math:`(a, b, c)` this is Rodrigues' formula about :math:`z \times axis`:

    .. math::

        R = \begin{bmatrix} 1 - h a^2 & -h a b & a \\ -h a b & 1 - h b^2 & b \\ -a & -b & c \end{bmatrix},
        \qquad h = \frac{1}{1 + c} = \frac{1 - c}{a^2 + b^2}

    The second form of h is used for c < 0, where the first cancels. ``axis = z`` gives the identity and
    ``axis = y`` a quarter turn about -x, both exactly; ``axis = -z``, where no rotation is the shortest,
    gives the half turn about x.

    Args:
        axis: Any nonzero (3,) vector [-]; only its direction counts.

    Returns:
        (3, 3) rotation [-]. Its columns are the axes of the aligned frame in the axes that ``axis`` is given
        in.
    """
    (rotation,) = frames_aligning_z(direction(axis, "frame_aligning_z", "axis")[None])
    return np.asarray(rotation)


@takes()
def frames_aligning_z(axes: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Return the shortest rotations that take ``z`` to unit axes (n, 3), (n, 3, 3)."""
    a, b, c = axes.T
    radial = a * a + b * b
    opposite = (c < 0.0) & (radial < 1e-280)  # so near -z that its reciprocal would overflow
    h = np.where(c >= 0.0, 1.0 / np.maximum(1.0 + c, 1.0), (1.0 - c) / np.where(radial < 1e-280, 1.0, radial))
    rows = [[1.0 - h * a * a, -h * a * b, a], [-h * a * b, 1.0 - h * b * b, b], [-a, -b, c]]
    rotations = np.moveaxis(np.array(rows), 2, 0) + 0.0  # no negative zeros
    rotations[opposite] = np.diag([1.0, -1.0, -1.0])
    return rotations


@takes()
def roll_pitch_yaw(rotation: Matrix3) -> tuple[float, float, float]:
    """Return the URDF angles of a rotation, ``R = Rz(yaw) Ry(pitch) Rx(roll)``.

    The roll is read after the yaw was taken out, so the three angles rebuild the matrix to round-off
    everywhere. Read straight from the last row, as is usual, they lose digits near a pitch of 90 degrees: an
    axis along x.

    Args:
        rotation: (3, 3) rotation matrix [-].

    Returns:
        Roll, pitch and yaw [rad].
    """
    r = rotation
    yaw = math.atan2(r[1, 0], r[0, 0])
    s, c = math.sin(yaw), math.cos(yaw)
    pitch = math.atan2(-r[2, 0], c * r[0, 0] + s * r[1, 0])
    roll = math.atan2(s * r[0, 2] - c * r[1, 2], c * r[1, 1] - s * r[0, 1])
    return roll + 0.0, pitch + 0.0, yaw + 0.0


def of_roll_pitch_yaw(roll: float, pitch: float, yaw: float) -> Matrix3:
    """Return the rotation matrix (3, 3) of URDF's angles [rad], ``R = Rz(yaw) Ry(pitch) Rx(roll)``."""
    si, sj, sk = np.sin((roll, pitch, yaw))
    ci, cj, ck = np.cos((roll, pitch, yaw))
    cc, cs, sc, ss = ci * ck, ci * sk, si * ck, si * sk
    rotation = np.array(
        [
            [cj * ck, sj * sc - cs, sj * cc + ss],
            [cj * sk, sj * ss + cc, sj * cs - sc],
            [-sj, cj * si, cj * ci],
        ]
    )
    return rotation + 0.0  # no negative zeros


@takes()
def quaternions(rotations: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return rotations over time as quaternions xyzw without jumps of sign.

    Args:
        rotations: Rotation matrices, (n, ..., 3, 3) [-].

    Returns:
        (n, ..., 4) [-].
    """
    matrices = np.asarray(rotations, dtype=np.float64)
    found = quaternion(matrices)
    jumps = np.sum(found[1:] * found[:-1], axis=-1) < 0.0
    found[1:] *= np.where(np.cumsum(jumps, axis=0) % 2 == 1, -1.0, 1.0)[..., None]
    return found


@takes()
def quaternion(rotations: npt.ArrayLike) -> npt.NDArray[np.float64]:
    r"""Return rotation matrices as quaternions xyzw of length 1.

    The largest of the four is found first, since nothing cancels in it: with the trace t,
    :math:`4 q_i^2 = 1 - t + 2 R_{ii}` and :math:`4 w^2 = 1 + t`; the others follow from sums and differences
    of entries, which are 4 times their products with it (Shepperd). The largest is positive.

    Args:
        rotations: (..., 3, 3) [-], orthogonal to round-off.

    Returns:
        (..., 4) [-].

    References:
        Shepperd (1978), J. Guid. Control 1(3), 223-224.
    """
    matrices = np.asarray(rotations, dtype=np.float64)
    flat = matrices.reshape(-1, 3, 3)
    trace = flat[:, 0, 0] + flat[:, 1, 1] + flat[:, 2, 2]
    of_largest = np.stack([flat[:, 0, 0], flat[:, 1, 1], flat[:, 2, 2], trace], axis=1).argmax(axis=1)
    found = np.empty((len(flat), 4))
    for i in range(3):
        at = of_largest == i
        some, j, k = flat[at], (i + 1) % 3, (i + 2) % 3
        found[at, i] = 1.0 - trace[at] + 2.0 * some[:, i, i]
        found[at, j] = some[:, j, i] + some[:, i, j]
        found[at, k] = some[:, k, i] + some[:, i, k]
        found[at, 3] = some[:, k, j] - some[:, j, k]
    at = of_largest == 3
    some = flat[at]
    found[at, 0] = some[:, 2, 1] - some[:, 1, 2]
    found[at, 1] = some[:, 0, 2] - some[:, 2, 0]
    found[at, 2] = some[:, 1, 0] - some[:, 0, 1]
    found[at, 3] = 1.0 + trace[at]
    x, y, z, w = found.T
    found /= np.sqrt(x * x + y * y + z * z + w * w)[:, None]
    return found.reshape(*matrices.shape[:-2], 4)


@takes()
def rotation(quaternions: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return quaternions xyzw of length 1, (..., 4), as rotation matrices (..., 3, 3) [-]."""
    x, y, z, w = np.moveaxis(np.asarray(quaternions, dtype=np.float64), -1, 0)
    rows = (
        (x * x - y * y - z * z + w * w, 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)),
        (2.0 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2.0 * (y * z - x * w)),
        (2.0 * (x * z - y * w), 2.0 * (y * z + x * w), -x * x - y * y + z * z + w * w),
    )
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)
