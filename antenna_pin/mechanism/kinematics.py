"""Placements of links and loads of joints, for many configurations at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism.frames import quaternions
from antenna_pin.mechanism.model import Mechanism

# --- placements ---------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

_AT_ONCE = 8192  # samples


@takes()
def link_poses(mechanism: Mechanism, q: ArrayLike, links: Sequence[str] | None = None) -> tuple[Array, Array]:
    """Return the poses of link frames in the world.

    Args:
        mechanism: The mechanism.
        q: Configurations, (n, nq).
        links: Which; all, in the URDF's order (``[link.name for link in mechanism.urdf.robot.links]``), if
            left out.

    Returns:
        Positions (n, links, 3) [m] and attitudes (n, links, 4), quaternions xyzw that do not jump in sign
        along n [-].
    """
    model = mechanism.model
    configurations = _rows("link_poses", "q", q, model.nq)
    n = configurations.shape[0]
    data = model.createData()
    names = [link.name for link in mechanism.urdf.robot.links] if links is None else links
    frames = [model.frames[mechanism.frame(name)] for name in names]
    used = sorted({int(frame.parentJoint) for frame in frames})
    parents = [used.index(int(frame.parentJoint)) for frame in frames]
    fixed = np.array([frame.placement.homogeneous for frame in frames]).reshape(-1, 4, 4)
    positions, attitudes = np.zeros((n, len(names), 3)), np.zeros((n, len(names), 4))
    # Part by part, since matrices take much more room than what is made of them.
    joints = np.zeros((min(n, _AT_ONCE), len(used), 4, 4))
    for first in range(0, n, _AT_ONCE):
        last = min(first + _AT_ONCE, n)
        for i in range(last - first):
            pin.forwardKinematics(model, data, configurations[first + i])
            for k, j in enumerate(used):
                joints[i, k] = data.oMi[j].homogeneous
        poses = joints[: last - first, parents] @ fixed
        positions[first:last] = poses[..., :3, 3]
        attitudes[first:last] = quaternions(poses[..., :3, :3])
        if first:  # signs go on from those before
            jumped = np.sum(attitudes[first] * attitudes[first - 1], axis=-1) < 0.0
            attitudes[first:last] *= np.where(jumped, -1.0, 1.0)[:, None]
    return positions, attitudes


@takes()
def link_twists(
    mechanism: Mechanism, q: ArrayLike, v: ArrayLike, links: Sequence[str] | None = None
) -> Array:
    """Return the twists of link frames relative to the world, in link axes.

    Args:
        mechanism: The mechanism.
        q: Configurations, (n, nq).
        v: Generalized velocities, (n, nv).
        links: Which; all, in the URDF's order, if left out.

    Returns:
        Twists (n, links, 6), linear part first [m/s, rad/s].
    """
    model = mechanism.model
    configurations = _rows("link_twists", "q", q, model.nq)
    velocities = _rows("link_twists", "v", v, model.nv)
    data = model.createData()
    names = [link.name for link in mechanism.urdf.robot.links] if links is None else links
    frames = [mechanism.frame(name) for name in names]
    twists = np.zeros((configurations.shape[0], len(frames), 6))
    for i in range(configurations.shape[0]):
        pin.forwardKinematics(model, data, configurations[i], velocities[i])
        for k, frame in enumerate(frames):
            twists[i, k] = pin.getFrameVelocity(model, data, frame, pin.ReferenceFrame.LOCAL).vector
    return twists


@takes()
def link_motion(
    mechanism: Mechanism, link: str, q: ArrayLike, v: ArrayLike, a: ArrayLike
) -> tuple[Array, Array]:
    """Return position, velocity and acceleration of a link's frame, in world axes.

    Args:
        mechanism: The mechanism.
        link: Its name.
        q: Configurations, (n, nq).
        v: Generalized velocities, (n, nv).
        a: Generalized accelerations, (n, nv).

    Returns:
        Its attitudes (n, 3, 3) [-], and (n, 5, 3) in world axes: position [m], velocity [m/s], angular
        velocity [rad/s], acceleration of the origin as seen from the world [m/s^2], angular acceleration
        [rad/s^2].
    """
    model = mechanism.model
    states = _states("link_motion", model, q, v, a)
    data, frame = model.createData(), mechanism.frame(link)
    world = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    count = states[0].shape[0]
    placements, found = np.zeros((count, 4, 4)), np.zeros((count, 15))
    for placement, row, qi, vi, ai in zip(placements, found, *states, strict=True):
        pin.forwardKinematics(model, data, qi, vi, ai)
        placement[:] = pin.updateFramePlacement(model, data, frame).homogeneous
        row[3:9] = pin.getFrameVelocity(model, data, frame, world).vector
        row[9:] = pin.getFrameClassicalAcceleration(model, data, frame, world).vector
    found[:, :3] = placements[:, :3, 3]
    return placements[:, :3, :3], found.reshape(count, 5, 3)


def _rows(place: str, name: str, value: ArrayLike, width: int, count: int | None = None) -> Array:
    rows = np.ascontiguousarray(value, dtype=float)
    if rows.ndim != 2 or rows.shape != (len(rows) if count is None else count, width):
        raise InvalidParameterError(place, name, f"of shape (n, {width})", rows.shape)
    return rows


def _states(place: str, model: Any, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> list[Array]:
    first = _rows(place, "q", q, model.nq)
    return [first, *(_rows(place, name, x, model.nv, len(first)) for name, x in (("v", v), ("a", a)))]


# --- loads of joints ----------------------------------------------------------------------------------------


@takes()
def transmitted_wrenches(
    mechanism: Mechanism,
    q: ArrayLike,
    v: ArrayLike,
    a: ArrayLike,
    applied: Iterable[tuple[str, ArrayLike]] = (),
) -> Array:
    """Return the wrench that each moving joint transmits from parent to child.

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
    states = _states("transmitted_wrenches", model, q, v, a)
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
