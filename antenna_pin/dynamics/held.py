"""Joints of the tree that are free there and held by constraint to what they are ideally."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal

import numpy as np

from antenna_pin.constraints import Anchor, Closure
from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.mechanism import JointSlot, Mechanism, frame_aligning_z

__all__ = ["HeldKind", "closures_by_name", "held_slot"]

HeldKind = Literal["revolute", "prismatic", "spherical"]


def held_slot(mechanism: Mechanism, name: str) -> JointSlot:
    """Return the slot of a joint that is held, checked to be free."""
    slot = mechanism.joint(name)
    if slot.kind != "floating":
        raise MechanismError(
            f"joint {name!r}: must be floating in the model to be held by constraint, got {slot.kind}"
        )
    return slot


def closures_by_name(
    mechanism: Mechanism,
    held: Mapping[str, HeldKind],
    closures: Mapping[str, Closure],
) -> dict[str, Closure]:
    """Return all closures by name, those of joints held by constraint first.

    Args:
        mechanism: The mechanism.
        held: What each joint that is held is held to, by name.
        closures: Those that close loops, by name.
    """
    found = {name: _held_closure(mechanism, name, kind) for name, kind in held.items()}
    for name, closure in closures.items():
        # Of a load, a closure and a joint of one name could not be told apart.
        if name in mechanism.joints:
            raise InvalidParameterError(
                "System", f"closures[{name!r}]", "of another name than a joint's", name
            )
        found[name] = closure
    return found


def _held_closure(mechanism: Mechanism, name: str, kind: HeldKind) -> Closure:
    """Return the closure that holds a floating joint to a kind of joint at its own place."""
    if kind not in ("revolute", "prismatic", "spherical"):
        raise InvalidParameterError("System", f"held[{name!r}]", "revolute, prismatic or spherical", kind)
    slot = held_slot(mechanism, name)
    joint = mechanism.urdf.joint(name)
    own = np.eye(4)
    own[:3, :3] = frame_aligning_z(slot.axis)
    on_parent = mechanism.urdf.placement(name) @ own
    return Closure(
        kind=kind,
        first=Anchor(link=joint.parent, rotation=on_parent[:3, :3], origin=on_parent[:3, 3]),
        second=Anchor(link=joint.child, rotation=own[:3, :3], origin=own[:3, 3]),
    )
