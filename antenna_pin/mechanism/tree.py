"""The tree of moving bodies in numbers, from a Pinocchio model."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.records import CIRCLE, FIXED_AXIS, PLANE, RIGID, ROTATION, SLIDE
from antenna_pin.mechanism import tree_kernels as _bodies
from antenna_pin.mechanism.model import Mechanism
from antenna_pin.mechanism.tree_kernels import BODY, PLACE

__all__ = ["BODY", "PLACE", "body_tree", "freedoms_below"]

_KINDS = {
    "revolute": FIXED_AXIS,
    "continuous": CIRCLE,
    "prismatic": SLIDE,
    "floating": RIGID,
    "spherical": ROTATION,
    "planar": PLANE,
}

_FREEDOMS = {RIGID: 6, ROTATION: 3, PLANE: 3}


@takes()
def body_tree(mechanism: Mechanism) -> NDArray[Any]:
    """Return the moving bodies as the kernels take them, (bodies,) of ``BODY``; parents first."""
    model = mechanism.model
    kinds = {slot.joint_id: (_KINDS[slot.kind], slot.axis) for slot in mechanism.joints.values()}
    free = mechanism.base == "free"
    if free:
        kinds[1] = (RIGID, np.zeros(3))
    tree = np.zeros(model.njoints - 1, dtype=_bodies.BODY)
    for i, body in enumerate(tree, start=1):
        placement, inertia = model.jointPlacements[i], model.inertias[i]
        if kinds[i][0] in (FIXED_AXIS, CIRCLE):
            body["armature"] = model.armature[model.idx_vs[i]]
        body["parent"] = model.parents[i] - 1
        body["kind"], body["axis"] = kinds[i]
        body["q"], body["v"] = model.idx_qs[i], model.idx_vs[i]
        body["counts"] = not (free and i == 1)
        body["rotation"], body["position"] = placement.rotation, placement.translation
        body["mass"], body["centre"], body["inertia"] = inertia.mass, inertia.lever, inertia.inertia
    return tree


@takes()
def freedoms_below(tree: NDArray[Any]) -> NDArray[np.int64]:
    """Return the freedom next below each one of a tree, towards its root, -1 where there is none, (nv,).

    Args:
        tree: Bodies, parents first, ``BODY``, (bodies,).
    """
    below: list[int] = []
    last: list[int] = []
    for body in tree:
        under = last[body["parent"]] if body["parent"] >= 0 else -1
        count = _FREEDOMS.get(int(body["kind"]), 1)
        below += [under, *range(len(below), len(below) + count - 1)]
        last.append(len(below) - 1)
    return np.array(below, dtype=np.int64)
