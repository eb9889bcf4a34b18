"""An element at a joint as a block of a system's program."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import CIRCLE, FIXED_AXIS, SLIDE
from antenna_pin.dynamics import kernels
from antenna_pin.elements import BetweenJoints, Element, ForceElement, kind_of
from antenna_pin.errors import MechanismError

__all__ = ["WITH_AXIS", "element_block", "element_head"]

Array = NDArray[np.float64]

#: Joints without play that elements can act at, by their kind.
WITH_AXIS = {"revolute": FIXED_AXIS, "continuous": CIRCLE, "prismatic": SLIDE}


def element_block(system: Any, place: str, element: ForceElement, x: int) -> Array:
    """Return the block of an element, or refuse a joint at which it cannot act.

    That of an element between two joints, or that measures another joint than its own, ends with a head for
    the second.

    Args:
        system: The system, its joints with play laid out.
        place: What it is, for the refusal.
        element: The element.
        x: Where in x what it integrates starts.
    """
    if isinstance(element, BetweenJoints):
        joints = [element.input, element.output]
        found = [element_head(system, place, name) for name in joints]
        element.check_joints(place, (system.slides(element.input), system.slides(element.output)))
    else:
        assert isinstance(element, Element)
        found = [element_head(system, place, element.joint)]
        element.check_joint(place, system.slides(element.joint))
        if element.measured != element.joint:
            found.append(element_head(system, place, element.measured))
            element.check_measured(place, system.slides(element.joint), system.slides(element.measured))
    words = element.words_of_kernel()
    behind = [one.view(np.float64) for one in found[1:]]
    block = np.concatenate([found[0].view(np.float64), words, *behind])
    head = block[: kernels.PARAMETERS].view(kernels.ELEMENT)
    head["kind"], head["length"], head["x"] = kind_of(type(element)), len(block), x
    second = "partner" if isinstance(element, BetweenJoints) else "sensed"
    if behind:
        head[second] = kernels.PARAMETERS + len(words)
    head["senses"] = not isinstance(element, Element) or element.senses
    head["on"] = element.acts
    for part in range(len(found)):
        at = part * int(head[second][0])
        own = block[at : at + kernels.PARAMETERS].view(kernels.ELEMENT)
        own["about"] = kernels.ABOUTS.index(element.about)
    return block


def element_head(system: Any, place: str, joint: str) -> NDArray[Any]:
    """Return the head of an element with what it says of its joint, ``ELEMENT``, (1,)."""
    slot = system.mechanism.joint(joint)
    clearance = system.clearance_blocks.get(joint, -1)
    without_axis = any(j.geometry.motion is None for j in system.clearances if j.name == joint)
    if without_axis or (clearance < 0 and slot.kind not in WITH_AXIS):
        kind_seen = "spherical" if without_axis else slot.kind
        raise MechanismError(
            f"{place}: joint {joint!r} is {kind_seen} and has no axis to act about; "
            "use a revolute, continuous, prismatic or clearance joint"
        )
    head = np.zeros(1, kernels.ELEMENT)
    head["joint"], head["play"] = WITH_AXIS.get(slot.kind, -1), clearance
    head["turn"] = system.turn_x.get(joint, -1)
    head["q"], head["v"] = slot.q.start, slot.v.start
    return head
