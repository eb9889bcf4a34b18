"""An element at a joint as a block of a system's program."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.dynamics import kernels
from antenna_pin.elements import Element, kind_of
from antenna_pin.errors import MechanismError
from antenna_pin.records import CIRCLE, FIXED_AXIS, SLIDE

__all__ = ["WITH_AXIS", "element_block"]

Array = NDArray[np.float64]

#: Joints without play that elements can act at, by their kind.
WITH_AXIS = {"revolute": FIXED_AXIS, "continuous": CIRCLE, "prismatic": SLIDE}


def element_block(system: Any, place: str, element: Element, x: int) -> Array:
    """Return the block of an element, or refuse a joint at which it cannot act.

    Args:
        system: The system, its joints with play laid out.
        place: What it is, for the refusal.
        element: The element.
        x: Where in x what it integrates starts.
    """
    slot = system.mechanism.joint(element.joint)
    clearance = system.clearance_blocks.get(element.joint, -1)
    without_axis = any(j.geometry.motion is None for j in system.clearances if j.name == element.joint)
    if without_axis or (clearance < 0 and slot.kind not in WITH_AXIS):
        kind_seen = "spherical" if without_axis else slot.kind
        raise MechanismError(
            f"{place}: joint {element.joint!r} is {kind_seen} and has no axis to act about; "
            "use a revolute, continuous, prismatic or clearance joint"
        )
    element.check_joint(place, system.slides(element.joint))
    words = element.words_of_kernel()
    block = np.concatenate([np.zeros(kernels.PARAMETERS), words])
    head = block[: kernels.PARAMETERS].view(kernels.ELEMENT)
    head["kind"], head["length"] = kind_of(type(element)), len(block)
    head["joint"], head["play"] = WITH_AXIS.get(slot.kind, -1), clearance
    head["turn"] = system.turn_x.get(element.joint, -1)
    head["q"], head["v"], head["x"] = slot.q.start, slot.v.start, x
    head["about"] = kernels.ABOUTS.index(element.about)
    head["senses"], head["on"] = element.senses, element.acts
    return block
