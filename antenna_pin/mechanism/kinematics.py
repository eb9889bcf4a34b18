"""Where the links of a mechanism are, for many configurations at once."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism.model import Mechanism

__all__ = ["link_poses"]

Array = NDArray[np.float64]


def link_poses(mechanism: Mechanism, q: ArrayLike) -> tuple[Array, Array]:
    """Return the pose of every link's frame in the world.

    Args:
        mechanism: The mechanism.
        q: Configurations, (n, nq).

    Returns:
        Positions (n, links, 3) [m] and attitudes (n, links, 4), quaternions xyzw that do not jump in sign
        along n [-]; links in the URDF's order (``[link.name for link in mechanism.urdf.robot.links]``).
    """
    model = mechanism.model
    configurations = np.ascontiguousarray(q, dtype=float)
    if configurations.ndim != 2 or configurations.shape[1] != model.nq:
        raise InvalidParameterError("link_poses", "q", f"of shape (n, {model.nq})", configurations.shape)
    n = configurations.shape[0]
    data = model.createData()
    joints = np.zeros((n, model.njoints, 4, 4))
    for i in range(n):
        pin.forwardKinematics(model, data, configurations[i])
        for j in range(model.njoints):
            joints[i, j] = data.oMi[j].homogeneous
    names = [link.name for link in mechanism.urdf.robot.links]
    frames = [model.frames[mechanism.frame(name)] for name in names]
    parents = [frame.parentJoint for frame in frames]
    fixed = np.array([frame.placement.homogeneous for frame in frames]).reshape(-1, 4, 4)
    poses = joints[:, parents] @ fixed
    attitude = Rotation.from_matrix(poses[..., :3, :3].reshape(-1, 3, 3)).as_quat()
    quaternions = attitude.reshape(n, len(names), 4)
    jumps = np.sum(quaternions[1:] * quaternions[:-1], axis=2) < 0.0
    quaternions[1:] *= np.where(np.cumsum(jumps, axis=0) % 2 == 1, -1.0, 1.0)[..., None]
    return poses[..., :3, 3].copy(), quaternions
