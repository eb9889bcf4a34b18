"""What passes through the joints: by inverse dynamics, of ideal joints as of joints with play."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism.model import Mechanism

__all__ = ["transmitted_wrenches"]

Array = NDArray[np.float64]


@takes()
def transmitted_wrenches(
    mechanism: Mechanism,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    applied: Iterable[tuple[str, ArrayLike]] = (),
) -> Array:
    """Return the wrench that each moving joint passes from parent to child.

    It is what the bodies beyond the joint need for their accelerations, less what else acts on them, so it
    holds for any joint: constraint forces, contact and motor torque together.

    Args:
        mechanism: The mechanism.
        q: Configurations, (n, nq).
        v: Generalized velocities, (n, nv).
        a: Generalized accelerations, (n, nv).
        applied: What acts on links beside the joints of the tree, as the forces of closed loops do: a link,
            and force [N] and moment about the world's origin [N m], (n, 6), world axes.

    Returns:
        (n, joints, 6): force [N], then torque about the origin of the joint's frame on the child [N m], in
        world axes; joints in the order of ``mechanism.joints``.
    """
    model = mechanism.model
    states = [np.ascontiguousarray(x, dtype=float) for x in (q, v, a)]
    for name, array, width in zip("qva", states, (model.nq, model.nv, model.nv), strict=True):
        if array.ndim != 2 or array.shape != (states[0].shape[0], width):
            raise InvalidParameterError("transmitted_wrenches", name, f"of shape (n, {width})", array.shape)
    n = states[0].shape[0]
    others = np.zeros((n, model.njoints, 6))
    for link, wrench in applied:
        others[:, model.frames[mechanism.frame(link)].parentJoint] += np.asarray(wrench, dtype=float)
    loaded = others.any()
    ids = [slot.joint_id for slot in mechanism.joints.values()]
    wrenches = np.zeros((n, len(ids), 6))
    rotations = np.zeros((n, len(ids), 3, 3))
    data = model.createData()
    for i, (qi, vi, ai) in enumerate(zip(*states, strict=True)):
        pin.forwardKinematics(model, data, qi)
        if loaded:
            own = [place.actInv(pin.Force(w)) for place, w in zip(data.oMi, others[i], strict=True)]
            pin.rnea(model, data, qi, vi, ai, own)
        else:
            pin.rnea(model, data, qi, vi, ai)
        for k, j in enumerate(ids):
            wrenches[i, k] = data.f[j].vector
            rotations[i, k] = data.oMi[j].rotation
    wrenches[..., :3] = np.einsum("ijkl,ijl->ijk", rotations, wrenches[..., :3])
    wrenches[..., 3:] = np.einsum("ijkl,ijl->ijk", rotations, wrenches[..., 3:])
    return wrenches
