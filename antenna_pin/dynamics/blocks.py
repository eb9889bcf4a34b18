"""Blocks of a system's program: put together one by one, those of joints with play and held ones."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.answers import AskedFunction
from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.held import held_slot
from antenna_pin.elements import GROSS_WORK, LOSS, WORK, Element, ForceElement, Integral, Modal, Motion
from antenna_pin.errors import InvalidParameterError, MechanismError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints import layout_kernels as _layout
from antenna_pin.mechanism import JointSlot, Mechanism, frame_aligning_z

__all__ = [
    "Blocks",
    "InPython",
    "check_booked",
    "check_holds",
    "check_motion",
    "clearance_block",
    "held_block",
    "places_in_x",
    "slides",
    "states_in_x",
    "turning",
]

Array = NDArray[np.float64]


class InPython(NamedTuple):
    """An element whose numbers Python writes before each evaluation.

    Attributes:
        block: Where in a program its block stands.
        words: Where its numbers go.
        element: The element.
        functions: Its functions as a run asks them.
    """

    block: int
    words: slice
    element: Element
    functions: tuple[AskedFunction, ...]

    @property
    def said(self) -> str:
        """What refusals call it."""
        return f"what acts at joint {self.element.joint!r}"

    def given(self, t: float, angle: float, rate: float) -> tuple[float, ...]:
        """Return its numbers at time t [s], at an angle and a rate of its joint."""
        return self.element.given(self.functions, t, angle, rate)


def slides(mechanism: Mechanism, clearances: Sequence[ClearanceJoint], joint: str) -> bool:
    """Whether a joint slides along its axis rather than turning about it."""
    return mechanism.joint(joint).kind == "prismatic" or any(
        one.name == joint and one.geometry.motion == "slide" for one in clearances
    )


class Blocks:
    """A program that grows, and with it what its blocks integrate.

    Args:
        x: How many numbers of x are taken already.

    Attributes:
        all: The program's head, still zero, and the blocks so far.
        x: Where in x the next block's numbers start.
        size: How many numbers the program has so far.
    """

    def __init__(self, x: int) -> None:
        """Begin with the head."""
        self.all: list[Array] = [np.zeros(kernels.HEADER)]
        self.x = x
        self.size = int(kernels.HEADER)

    def add(self, block: Array, integrals: int) -> int:
        """Put a block at the end; return where in the program it stands.

        Args:
            block: Its numbers; still to be written to, if need be.
            integrals: How many numbers it has in x.
        """
        at = self.size
        self.all.append(block)
        self.size += len(block)
        self.x += integrals
        return at


def check_booked(family: str, name: str, element: ForceElement) -> None:
    """Refuse an element that integrates what the ledger of its family has no place for.

    Args:
        family: ``drive`` or ``spring``.
        name: Of the element.
        element: The element.
    """
    others = (LOSS,) if family == "drive" else (WORK, GROSS_WORK)
    if strange := [one.name for one in element.integrals if one in others]:
        rule = "work and gross work of a drive, the loss of a spring, or what is no energy"
        raise InvalidParameterError(f"{family} {name!r}", "integrals", rule, strange)


def places_in_x(
    program: Array, elements: Mapping[str, ForceElement], blocks: Mapping[str, int], integral: Integral
) -> NDArray[np.int_]:
    """Return where in x each of some elements integrates something, -1 for one that does not.

    Args:
        program: All blocks.
        elements: By name.
        blocks: Their places in the program, by name.
        integral: What is integrated.
    """
    found = []
    for name, element in elements.items():
        head = program[blocks[name] :][: kernels.PARAMETERS].view(kernels.ELEMENT)
        own = element.integrals
        found.append(int(head["x"][0]) + own.index(integral) if integral in own else -1)
    return np.array(found, dtype=int)


def turning(system: Any) -> dict[str, int]:
    """Return the joints whose configuration knows their angle only but for whole turns, numbered."""
    about_axis = {name for name, kind in system.free_with_axis.items() if kind == "revolute"}
    about_axis |= {j.name for j in system.clearances if j.geometry.motion == "turn"}
    slots = system.mechanism.joints.values()
    names = [slot.name for slot in slots if slot.kind == "continuous" or slot.name in about_axis]
    return {name: k for k, name in enumerate(names)}


def states_in_x(system: Any) -> NDArray[np.int_]:
    """Return where in x all that elements of a system integrate and their efforts depend on stands."""
    found = [
        places_in_x(system.program, {name: element}, system.element_blocks[table], own)
        for table, elements in system.families.items()
        for name, element in elements.items()
        for own in element.states
    ]
    return np.concatenate([np.zeros(0, dtype=int), *found])


def clearance_block(mechanism: Mechanism, joint: ClearanceJoint, row: int, x: int, turn: int) -> Array:
    """Return the block of a joint with play.

    Args:
        mechanism: The joint must have the freedom there that it needs.
        joint: The joint.
        row: Of its first contact in a contact table.
        x: Where in x its contacts' numbers start.
        turn: Place of its turned angle in x, or -1.
    """
    slot = _slot(mechanism, joint)
    axes = np.eye(3) if joint.planar else frame_aligning_z(slot.axis)
    return joint.block(axes, axes[:, 2], slot.q.start, slot.v.start, row, x, turn)


def held_block(mechanism: Mechanism, name: str, slides: bool, row: int, x: int, turn: int) -> Array:
    """Return the block of a joint held by constraint: without contacts, for what elements ask of its axis.

    Args:
        mechanism: The joint must be floating there.
        name: Of the joint.
        slides: Whether it slides along its axis rather than turning about it.
        row: Of the next contact in a contact table.
        x: Where in x the next numbers start.
        turn: Place of its turned angle in x, or -1.
    """
    slot = held_slot(mechanism, name)
    block = np.zeros(_layout.JOINT_WORDS)
    head = block.view(_layout.JOINT)
    head["kind"], head["length"] = _layout.CLEARANCE, len(block)
    head["q"], head["v"], head["row"], head["x"] = slot.q.start, slot.v.start, row, x
    head["turn"], head["slides"] = turn, slides
    head["axes"] = frame_aligning_z(slot.axis)
    return block


def _slot(mechanism: Mechanism, joint: ClearanceJoint) -> JointSlot:
    """Return the slot of a clearance joint, checked to have the freedom that the joint needs."""
    slot = mechanism.joint(joint.name)
    needed = "planar" if joint.planar else "floating"
    if slot.kind != needed:
        raise MechanismError(
            f"clearance joint {joint.name!r}: the joint must be {needed} in the model, got {slot.kind}; "
            f"build the mechanism from urdf.variant(joints={{{joint.name!r}: "
            f"{'planar' if joint.planar else 'free'!r}}})"
        )
    return slot


def check_motion(
    place: str,
    mechanism: Mechanism,
    turning: Collection[str],
    drives: Mapping[str, Element],
    own: str,
    motion: Motion,
) -> None:
    """Refuse a motion of a joint without axis, of a slider with play, or one beside a motion or a drive.

    Args:
        place: What it is, for the refusal.
        mechanism: The mechanism.
        turning: Joints that turn without end, with play or without.
        drives: All drives, the motion among them.
        own: The motion's name.
        motion: The motion.
    """
    slot = mechanism.joint(motion.joint)
    if slot.kind not in ("revolute", "continuous", "prismatic") and motion.joint not in turning:
        raise MechanismError(
            f"{place}: joint {motion.joint!r} is {slot.kind} here, and only a revolute or continuous joint, "
            "with play or without, or a prismatic one without can be made to follow a motion; "
            "drive another joint"
        )
    for name, other in drives.items():
        if name != own and other.joint == motion.joint:
            what = "a motion" if isinstance(other, Motion) else "a drive"
            raise MechanismError(
                f"{place}: joint {motion.joint!r} already has {what}, {name!r}; its motion is "
                "prescribed, so take one of the two away"
            )


def check_holds(place: str, mechanism: Mechanism, element: Element) -> None:
    """Refuse an element that is to hold a joint that no one row holds, or whose load no row tells.

    Args:
        place: What it is, for the refusal.
        mechanism: The mechanism.
        element: The element.
    """
    joint = element.joint
    slot = mechanism.joint(joint)
    if slot.kind not in ("revolute", "continuous", "prismatic"):
        raise MechanismError(
            f"{place}: joint {joint!r} is {slot.kind} here, and only a revolute, continuous or prismatic "
            f"joint without play {_rule(element)}"
        )


def _rule(element: Element) -> str:
    if isinstance(element, Modal):
        return "can be held; take play off it, or an element that does not hold"
    return "tells its own load; take play off it, or friction that no load makes"
