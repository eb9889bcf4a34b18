"""Rotations between a joint's own axis and the ``z`` axis that other rooms count on."""

from __future__ import annotations

import math
from typing import TypeAlias

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from antenna_pin.arguments import takes
from antenna_pin.directions import direction

__all__ = ["Matrix3", "Vector3", "frame_aligning_z", "quaternions", "roll_pitch_yaw"]

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
    a, b, c = (float(u) for u in direction(axis, "frame_aligning_z", "axis"))
    radial = a * a + b * b
    if c < 0.0 and radial < 1e-280:  # so near -z that its reciprocal would overflow
        return np.diag([1.0, -1.0, -1.0])
    h = 1.0 / (1.0 + c) if c >= 0.0 else (1.0 - c) / radial
    rotation = np.array([[1.0 - h * a * a, -h * a * b, a], [-h * a * b, 1.0 - h * b * b, b], [-a, -b, c]])
    return rotation + 0.0  # no negative zeros


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


@takes()
def quaternions(rotations: npt.ArrayLike) -> npt.NDArray[np.float64]:
    """Return rotations over time as quaternions xyzw that do not jump in sign from one to the next.

    Args:
        rotations: Rotation matrices, (n, ..., 3, 3) [-].

    Returns:
        (n, ..., 4) [-].
    """
    matrices = np.asarray(rotations, dtype=np.float64)
    found = Rotation.from_matrix(matrices.reshape(-1, 3, 3)).as_quat().reshape(*matrices.shape[:-2], 4)
    jumps = np.sum(found[1:] * found[:-1], axis=-1) < 0.0
    found[1:] *= np.where(np.cumsum(jumps, axis=0) % 2 == 1, -1.0, 1.0)[..., None]
    return np.asarray(found)
