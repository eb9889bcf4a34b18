"""Blocks of a system's program: assembly, joints with play and joints by constraint."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import AskedFunction
from antenna_pin.base.calculus import root_between
from antenna_pin.base.records import CIRCLE, FIXED_AXIS, SLIDE
from antenna_pin.dynamics import kernels
from antenna_pin.dynamics.constraints import Anchor, Closure
from antenna_pin.elements import (
    GROSS_WORK,
    LOSS,
    WORK,
    AxialPreload,
    Bearing,
    BetweenJoints,
    Element,
    ForceElement,
    Integral,
    JointFriction,
    Modal,
    Motion,
    kind_of,
)
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints import layout_kernels as _layout
from antenna_pin.mechanism import JointSlot, Mechanism, frame_aligning_z

# --- joints held by constraint ------------------------------------------------------------------------------

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
    held_kinds: Mapping[str, HeldKind],
    closures: Mapping[str, Closure],
) -> dict[str, Closure]:
    """Return all closures by name, those of joints held by constraint first."""
    found = {name: _held_closure(mechanism, name, kind) for name, kind in held_kinds.items()}
    for name, closure in closures.items():
        # A load, a closure and a joint of one name would be ambiguous.
        if name in mechanism.joints:
            raise InvalidParameterError(
                "System", f"closures[{name!r}]", "of another name than a joint's", name
            )
        found[name] = closure
    return found


def _held_closure(mechanism: Mechanism, name: str, kind: HeldKind) -> Closure:
    """Return the closure that makes a floating joint one of another kind."""
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


# --- elements at joints -------------------------------------------------------------------------------------

Array = NDArray[np.float64]

#: Joints without play at which elements can act, by their kind.
WITH_AXIS = {"revolute": FIXED_AXIS, "continuous": CIRCLE, "prismatic": SLIDE}


def element_block(system: Any, place: str, element: ForceElement, x: int) -> Array:
    """Return the block of an element, or refuse a joint at which it cannot act.

    The block of an element between two joints, or with measurements at another joint, ends with a head for
    the second.
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
    """Return the head of an element with its joint's numbers, ``ELEMENT``, (1,)."""
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


# --- blocks of a program ------------------------------------------------------------------------------------


class InPython(NamedTuple):
    """An element whose numbers Python writes before each evaluation."""

    block: int  # place of its block in a program
    words: slice  # places of its numbers
    element: Element  # the element
    functions: tuple[AskedFunction, ...]  # callbacks of a run

    @property
    def label(self) -> str:
        """Name in refusals."""
        return f"what acts at joint {self.element.joint!r}"

    def values(self, t: float, angle: float, rate: float) -> tuple[float, ...]:
        """Return the controller's numbers at time t [s] for a joint's angle and rate."""
        return self.element.record_numbers(self.functions, t, angle, rate)


def slides(mechanism: Mechanism, clearances: Sequence[ClearanceJoint], joint: str) -> bool:
    """Return whether a joint slides along its axis rather than turning about it."""
    return mechanism.joint(joint).slides or any(
        one.name == joint and one.geometry.motion == "slide" for one in clearances
    )


class Blocks:
    """A growing program, and the integrals of its blocks.

    Attributes:
        all: The program's head, still zero, and the blocks so far.
        x: Start of the next block's numbers in x.
        size: Number of words so far.
    """

    def __init__(self, x: int) -> None:
        """Begin with the head."""
        self.all: list[Array] = [np.zeros(kernels.HEADER)]
        self.x = x
        self.size = int(kernels.HEADER)

    def add(self, block: Array, integrals: int) -> int:
        """Put a block at the end; return where in the program it stands."""
        at = self.size
        self.all.append(block)
        self.size += len(block)
        self.x += integrals
        return at


def check_booked(family: str, name: str, element: ForceElement) -> None:
    """Refuse an element that integrates what the ledger of its family has no place for."""
    others = (LOSS,) if family == "drive" else (WORK, GROSS_WORK)
    if strange := [one.name for one in element.integrals if one in others]:
        rule = "work and gross work of a drive, the loss of a spring, or what is no energy"
        raise InvalidParameterError(f"{family} {name!r}", "integrals", rule, strange)


def places_in_x(
    program: Array, elements: Mapping[str, ForceElement], blocks: Mapping[str, int], integral: Integral
) -> NDArray[np.int_]:
    """Return the index in x of each element's integral, -1 for none."""
    found = []
    for name, element in elements.items():
        head = program[blocks[name] :][: kernels.PARAMETERS].view(kernels.ELEMENT)
        own = element.integrals
        found.append(int(head["x"][0]) + own.index(integral) if integral in own else -1)
    return np.array(found, dtype=int)


def turning(system: Any) -> dict[str, int]:
    """Return the joints whose configuration determines their angle up to whole turns, numbered."""
    about_axis = {name for name, kind in system.free_with_axis.items() if kind == "revolute"}
    about_axis |= {j.name for j in system.clearances if j.geometry.motion == "turn"}
    slots = system.mechanism.joints.values()
    names = [slot.name for slot in slots if slot.kind == "continuous" or slot.name in about_axis]
    return {name: k for k, name in enumerate(names)}


def states_in_x(system: Any) -> NDArray[np.int_]:
    """Return the indices in x of all integrals that elements' efforts depend on."""
    found = [
        places_in_x(system.program, {name: element}, system.element_blocks[table], own)
        for table, elements in system.families.items()
        for name, element in elements.items()
        for own in element.states
    ]
    return np.concatenate([np.zeros(0, dtype=int), *found])


def clearance_block(mechanism: Mechanism, joint: ClearanceJoint, row: int, x: int, turn: int) -> Array:
    """Return the block of a joint with play.

    Contacts begin at ``row`` of a contact table and at ``x``; ``turn`` is the place of the turned angle in x,
    or -1.
    """
    slot = _slot(mechanism, joint)
    axes = np.eye(3) if joint.planar else frame_aligning_z(slot.axis)
    return joint.block(axes, axes[:, 2], slot.q.start, slot.v.start, row, x, turn)


def held_block(mechanism: Mechanism, name: str, slides: bool, row: int, x: int, turn: int) -> Array:
    """Return the block of a joint by constraint, without contacts.

    ``row`` and ``x`` are the next free ones; ``turn`` is the place of the turned angle in x, or -1.
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
    """Return the slot of a clearance joint after a check of its freedoms."""
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
    """Refuse a motion without a suitable axis, or beside another motion or drive."""
    slot = mechanism.joint(motion.joint)
    if not slot.has_one_axis and motion.joint not in turning:
        raise MechanismError(
            f"{place}: joint {motion.joint!r} is {slot.kind} here, and only a revolute or continuous joint, "
            "with play or without, or a prismatic one without can follow a motion; drive another joint"
        )
    for name, other in drives.items():
        if name != own and other.joint == motion.joint:
            what = "a motion" if isinstance(other, Motion) else "a drive"
            raise MechanismError(
                f"{place}: joint {motion.joint!r} already has {what}, {name!r}; its motion is prescribed, "
                f"so remove one of the two"
            )


def check_holds(place: str, mechanism: Mechanism, element: Element) -> None:
    """Refuse a holding element without a row of its own, or with indeterminate load."""
    joint = element.joint
    slot = mechanism.joint(joint)
    if not slot.has_one_axis:
        raise MechanismError(
            f"{place}: joint {joint!r} is {slot.kind} here, and only a revolute, continuous or prismatic "
            f"joint without play {_rule(element)}"
        )


def _rule(element: Element) -> str:
    if isinstance(element, Modal):
        return "can be held; take play off it, or an element that does not hold"
    return "tells its own load; take play off it, or friction that no load makes"


# --- joints on bearings -------------------------------------------------------------------------------------

Families = Mapping[str, Mapping[str, ForceElement]]


def bearings_in(families: Families) -> Iterator[tuple[str, str, Bearing]]:
    """Yield family, name and bearing of all elements that act on a journal's whole pose."""
    for table, elements in families.items():
        for name, element in elements.items():
            if isinstance(element, Bearing):
                yield table, name, element


def on_bearings(
    mechanism: Mechanism, families: Families, with_play: Collection[str], held_joints: Collection[str]
) -> tuple[str, ...]:
    """Return the names of the joints without play that bearings carry.

    Raises:
        MechanismError: A joint is not free in the tree, is held by constraint, or moves in a plane only.
        InvalidParameterError: A preload at a joint without play.
    """
    found: dict[str, None] = {}
    for _, name, bearing in bearings_in(families):
        place, joint = f"bearing {name!r}", bearing.joint
        kind = mechanism.joint(joint).kind
        if joint in held_joints:
            raise MechanismError(
                f"{place}: joint {joint!r} is held by constraint, so a bearing would carry no load; remove "
                f"the constraint or the bearing"
            )
        if joint not in with_play and not bearing.frees:
            rule = "one with play: a preload acts between a journal and its bearing"
            raise InvalidParameterError(place, "joint", rule, joint)
        if kind != "floating":
            raise MechanismError(
                f"{place}: joint {joint!r} must be free in the model, got {kind}; build the mechanism from "
                f"urdf.variant(joints={{{joint!r}: 'free'}})"
            )
        if joint not in with_play:
            found[joint] = None
    return tuple(found)


def kinds_about_axis(held_kinds: Mapping[str, HeldKind], carried: Collection[str]) -> dict[str, HeldKind]:
    """Return the kinds of tree-free joints with an axis and no play, by name."""
    found: dict[str, HeldKind] = {**held_kinds}
    for name in carried:
        found[name] = "revolute"
    return {name: kind for name, kind in found.items() if kind != "spherical"}


def with_preloads_placed(
    families: dict[str, dict[str, ForceElement]], clearances: Sequence[ClearanceJoint]
) -> dict[str, dict[str, ForceElement]]:
    """Return elements with preloads placed where their force acts in the play of their joint."""
    with_play = {joint.name: joint for joint in clearances}
    placed = {table: dict(elements) for table, elements in families.items()}
    for table, name, one in bearings_in(families):
        if isinstance(one, AxialPreload) and one.position is None and one.joint in with_play:
            position = _position(f"bearing {name!r}", one, with_play[one.joint])
            placed[table][name] = dataclasses.replace(one, position=position)
    return placed


def with_friction_of_bearings(
    families: dict[str, dict[str, ForceElement]],
) -> dict[str, dict[str, ForceElement]]:
    """Return elements with friction of ball bearings at their preloads.

    Raises:
        UnknownNameError: There is no such bearing.
        InvalidParameterError: The bearing has no balls, or is of another joint.
    """
    bearings = families.get("bearings", {})
    found = {table: dict(elements) for table, elements in families.items()}
    for name, one in found.get("springs", {}).items():
        if not isinstance(one, JointFriction) or one.bearing is None:
            continue
        from antenna_pin.elements import BallBearing  # a kind is loaded for a scenario that has it

        place, bearing = f"spring {name!r}", bearings.get(one.bearing)
        if bearing is None:
            raise UnknownNameError(place, "bearing", one.bearing, bearings)
        if not isinstance(bearing, BallBearing) or bearing.joint != one.joint:
            rule = f"a bearing of kind balls of joint {one.joint!r}"
            raise InvalidParameterError(place, "bearing", rule, one.bearing)
        found["springs"][name] = one.under_preload(bearing)
    return found


def _position(place: str, preload: AxialPreload, joint: ClearanceJoint) -> float:
    """Return where along the bearing's axis a preload's force is given [m]."""
    if preload.given_at == "centred":
        return 0.0
    way = joint.axial_clearance
    if way is None or joint.axial is None:
        rule = f"centred, for joint {joint.name!r} has no flanges; or give position"
        raise InvalidParameterError(place, "given_at", rule, preload.given_at)
    if preload.given_at == "rest":
        way += _depth(place, preload, joint)
    return math.copysign(way, preload.force)


def _depth(place: str, preload: AxialPreload, joint: ClearanceJoint) -> float:
    """Return how deep a flange is pressed on by a preload [m]."""
    law, force = joint.axial, abs(preload.force)
    assert law is not None
    places = zip(joint.depth_limits, joint.geometry.contact_places, strict=True)
    most = min(limit for limit, of in places if of.kind == "axial")
    if not law.elastic_force(most) > force:
        rule = f"below {law.elastic_force(most):g} N, at which the flange is pressed in by {most:g} m"
        raise InvalidParameterError(place, "force", rule, preload.force)
    return root_between(lambda depth: law.elastic_force(depth) - force, 0.0, most, absolute=1e-20)
