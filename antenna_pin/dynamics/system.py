"""The equations of motion: a Pinocchio tree and the force elements on it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.dynamics import _kernels
from antenna_pin.dynamics.hinge import Hinge, hinge_slot
from antenna_pin.dynamics.workspace import Workspace
from antenna_pin.elements import GROSS_WORK, LOSS, WORK, CallableDrive, Drive, Element, JointSpring
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.integrate import Manifold
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints import _layout_kernels as _layout
from antenna_pin.mechanism import JointSlot, Mechanism, frame_aligning_z
from antenna_pin.records import PROGRAM, memory_numbers, memory_records, place_of

__all__ = ["System"]

Array = NDArray[np.float64]

_SPACES = {
    "JointModelFreeFlyer": "rigid",
    "JointModelSpherical": "rotation",
    "JointModelPlanar": "plane",
}


# How far from 1 the length of a quaternion may be and still be taken for round-off.
_UNIT_TOLERANCE = 1e-6


def _spaces(model: Any) -> tuple[str, ...]:
    """Return the configuration space of each joint of a Pinocchio model."""
    kinds = []
    for joint in list(model.joints)[1:]:
        name = joint.shortname()
        if name in _SPACES:
            kinds.append(_SPACES[name])
        elif (joint.nq, joint.nv) == (1, 1):
            kinds.append("vector")
        elif (joint.nq, joint.nv) == (2, 1):
            kinds.append("circle")
        else:
            raise MechanismError(
                f"joint {model.names[joint.id]!r}: {name} has no place in the state space; use revolute, "
                "continuous, prismatic, planar, floating or spherical joints"
            )
    return tuple(kinds)


class System:
    """A mechanism with its force elements, as data: what a state is, and all numbers that its motion needs.

    Nothing in it changes once it is made: runs share it, in threads too, and it can be pickled (with drives
    in Python as far as those can). What a run works on is its :class:`antenna_pin.dynamics.Workspace`.

    The state is ``y = [q, v, x]``: Pinocchio's configuration and velocity, and in x the turned angles of
    joints that turn without end (see :meth:`turn_on`) and what the elements integrate (per contact impulse,
    work lost in normal direction and to friction, bristles; per drive work and gross work; per spring the
    work lost in its damper).

    Beside it stands the contact memory, the contacts' discrete state, one record each
    (:data:`antenna_pin.records.MEMORY`: touching, approach speed, effective mass). It is not part of ``y``;
    whoever advances the system changes it, at located events only.

    Args:
        mechanism: Its joints named by clearance joints and hinges must be floating (planar for a planar
            clearance).
        clearances: Joints with play.
        drives: Torques by name.
        springs: Springs and dampers by name.
        hinges: Floating joints held as ideal revolute joints by Pinocchio's constrained dynamics.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        *,
        clearances: Sequence[ClearanceJoint] = (),
        drives: Mapping[str, Drive] | None = None,
        springs: Mapping[str, JointSpring] | None = None,
        hinges: Sequence[Hinge] = (),
    ) -> None:
        """Lay out the state and compose the program of force elements."""
        self.mechanism = mechanism
        self.model = mechanism.model
        self.clearances = tuple(clearances)
        self.drives = dict(drives or {})
        self.springs = dict(springs or {})
        self.hinges = tuple(hinges)
        self._compose()

    # --- layout ---------------------------------------------------------------------------------------------

    def _compose(self) -> None:
        names = [joint.name for joint in self.clearances]
        if len(set(names)) != len(names):
            raise InvalidParameterError("System", "clearances", "of different joints", names)
        self.contact_names = tuple(name for joint in self.clearances for name in joint.contact_names)
        #: Least approach speed of each contact [m/s].
        self.approach_speed_floors = tuple(
            joint.approach_speed_floor for joint in self.clearances for _ in joint.contact_names
        )
        blocks: list[Array] = [np.zeros(_kernels.HEADER)]
        size, row = _kernels.HEADER, 0
        #: Place in x of the turned angle of each joint that has one, by name.
        self.turn_x = self._turning()
        x = len(self.turn_x)
        self.clearance_blocks: dict[str, int] = {}
        first_x, strides = [], []
        for joint in self.clearances:
            slot = mechanism_slot(self.mechanism, joint)
            axes = np.eye(3) if joint.planar else frame_aligning_z(slot.axis)
            turn = self.turn_x.get(joint.name, -1)
            block = joint.block(axes, axes[:, 2], slot.q.start, slot.v.start, row, x, turn)
            self.clearance_blocks[joint.name] = size
            blocks.append(block)
            first_x += [x + k * joint.stride for k in range(joint.contacts)]
            strides += [joint.stride] * joint.contacts
            size += len(block)
            row += joint.contacts
            x += joint.contacts * joint.stride
        for hinge in self.hinges:
            # A block without contacts: what a drive or spring needs to know of the joint's axis.
            slot = hinge_slot(self.mechanism, hinge)
            block = np.zeros(_layout.JOINT_WORDS)
            head = block.view(_layout.JOINT)
            head["kind"], head["length"] = _layout.CLEARANCE, len(block)
            head["q"], head["v"], head["row"], head["x"] = slot.q.start, slot.v.start, row, x
            head["turn"] = self.turn_x[hinge.joint]
            head["axes"] = frame_aligning_z(slot.axis)
            self.clearance_blocks[hinge.joint] = size
            blocks.append(block)
            size += len(block)
        #: Where in the program the joint of each contact stands.
        self.block_of_contact = tuple(
            self.clearance_blocks[joint.name] for joint in self.clearances for _ in joint.contact_names
        )
        starts = np.array(first_x, dtype=int)
        self.impulse_x = starts + place_of(_layout.INTEGRALS, "impulse")
        self.lost_normal_x = starts + place_of(_layout.INTEGRALS, "lost_normal")
        self.lost_friction_x = starts + place_of(_layout.INTEGRALS, "lost_friction")
        self.bristle_x = np.array(
            [
                first + k
                for first, stride in zip(first_x, strides, strict=True)
                for k in range(_layout.BRISTLES, stride)
            ],
            dtype=int,
        )
        # Strips and sectors of joints with distributed load have their rows behind those of all contacts.
        rows = row
        for joint in self.clearances:
            rows += joint.place_strips(blocks[1 + self.clearances.index(joint)], rows)
        #: Rows of a contact table: those of the contacts, then those of strips and sectors.
        self.rows = rows
        blocks[0].view(PROGRAM)[0] = self.model.nq, self.model.nv, row, rows
        #: Places in x of what elements integrate, by its name; in the order of the elements.
        integrals: dict[str, list[int]] = {}
        #: Drives in Python: their block, and where in the program their value goes.
        self.callables: list[tuple[int, int, CallableDrive]] = []
        self.drive_blocks: dict[str, int] = {}
        self.spring_blocks: dict[str, int] = {}
        families: tuple[tuple[str, Mapping[str, Element], dict[str, int]], ...] = (
            ("drive", self.drives, self.drive_blocks),
            ("spring", self.springs, self.spring_blocks),
        )
        for family, elements, places in families:
            for name, element in elements.items():
                block = self.element_block(f"{family} {name!r}", element, x)
                places[name] = size
                if isinstance(element, CallableDrive):
                    self.callables.append((size, size + _kernels.PARAMETERS, element))
                blocks.append(block)
                size += len(block)
                for integral in element.integrals:
                    integrals.setdefault(integral.name, []).append(x)
                    x += 1
        self.work_x, self.gross_work_x, self.damper_x = (
            np.array(integrals.get(one.name, []), dtype=int) for one in (WORK, GROSS_WORK, LOSS)
        )
        self.program = np.concatenate(blocks)
        slots = {name: self.mechanism.joint(name) for name in self.turn_x}
        #: What :func:`_kernels.turn_on` needs to know of the turned angles.
        self.turns = np.array(
            [
                [x, self.clearance_blocks.get(name, -1), slots[name].q.start, slots[name].v.start]
                for name, x in self.turn_x.items()
            ],
            dtype=np.int64,
        ).reshape(-1, 4)
        self.manifold = Manifold(_spaces(self.model), x)

    def _turning(self) -> dict[str, int]:
        """Return the joints whose configuration knows their angle only but for whole turns, numbered."""
        about_axis = {hinge.joint for hinge in self.hinges}
        about_axis |= {j.name for j in self.clearances if j.geometry.motion == "turn"}
        names = [
            slot.name
            for slot in self.mechanism.joints.values()
            if slot.kind == "continuous" or slot.name in about_axis
        ]
        return {name: k for k, name in enumerate(names)}

    def element_block(self, place: str, element: Element, x: int) -> Array:
        """Return the block of an element, or refuse a joint at which it cannot act.

        Args:
            place: What it is, for the refusal.
            element: The element.
            x: Where in x what it integrates starts.
        """
        slot = self.mechanism.joint(element.joint)
        clearance = self.clearance_blocks.get(element.joint, -1)
        play = [j.geometry for j in self.clearances if j.name == element.joint]
        without_axis = any(geometry.motion is None for geometry in play)
        if clearance >= 0 and not without_axis:
            joint_kind = _kernels.PLAY
        elif slot.kind in ("revolute", "prismatic"):
            joint_kind = _kernels.ONE_DOF
        elif slot.kind == "continuous":
            joint_kind = _kernels.CIRCLE
        else:
            kind_seen = "spherical" if without_axis else slot.kind
            raise MechanismError(
                f"{place}: joint {element.joint!r} is {kind_seen} and has no axis to act about; "
                "use a revolute, continuous, prismatic or clearance joint"
            )
        slides = slot.kind == "prismatic" or any(geometry.motion == "slide" for geometry in play)
        element.check_joint(place, slides)
        words = element.words_of_kernel()
        block = np.concatenate([np.zeros(_kernels.PARAMETERS), words])
        head = block[: _kernels.PARAMETERS].view(_kernels.ELEMENT)
        head["kind"], head["length"] = element.compiled().KIND, len(block)
        head["joint"], head["play"], head["turn"] = joint_kind, clearance, self.turn_x.get(element.joint, -1)
        head["q"], head["v"], head["x"] = slot.q.start, slot.v.start, x
        head["about"] = _kernels.ABOUTS.index(element.about)
        head["senses"], head["on"] = element.senses, 1.0
        return block

    # --- states ---------------------------------------------------------------------------------------------

    def state(self, q: ArrayLike, v: ArrayLike, angles: Mapping[str, float] | None = None) -> Array:
        """Return the state [q, v, x] with nothing integrated yet, (nq + nv + nx,).

        Args:
            q: Configuration, (nq,). Its quaternions, and the cosine and sine of continuous and planar joints,
                are made unit where they are so to 1e-6, and refused where they are not.
            v: Velocity, (nv,).
            angles: Angles of joints that turn without end [rad]: of one of these q gives what is left of it
                without whole turns, here are the turns. Others, and all if not given, are in (-pi, pi].
        """
        configuration, velocity = np.array(q, dtype=float), np.asarray(v, dtype=float)
        if configuration.shape != (self.model.nq,) or not np.isfinite(configuration).all():
            raise InvalidParameterError("System", "q", f"{self.model.nq} finite numbers", q)
        if velocity.shape != (self.model.nv,) or not np.isfinite(velocity).all():
            raise InvalidParameterError("System", "v", f"{self.model.nv} finite numbers", v)
        for name, place in self._unit_parts():
            length = float(np.linalg.norm(configuration[place]))
            if not abs(length - 1.0) <= _UNIT_TOLERANCE:
                what = "quaternion" if place.stop - place.start == 4 else "cosine and sine"
                raise InvalidParameterError(
                    f"q[{place.start}:{place.stop}]",
                    f"{what} of {name}",
                    f"of length 1 to {_UNIT_TOLERANCE:g}; divide it by its length",
                    length,
                )
            configuration[place] /= length
        y = np.concatenate([configuration, velocity, np.zeros(self.manifold.nx)])
        x = y[self.model.nq + self.model.nv :]
        for name, angle in (angles or {}).items():
            if name not in self.turn_x:
                raise UnknownNameError(
                    "System.state: angles", "joint that turns without end", name, self.turn_x
                )
            if not math.isfinite(angle):
                raise InvalidParameterError("System", f"angles[{name!r}]", "finite [rad]", angle)
            x[self.turn_x[name]] = angle
        _kernels.turn_on(self.program, self.turns, y)
        return y

    def _unit_parts(self) -> Iterator[tuple[str, slice]]:
        """Yield what of q must be of length one: name of the joint, place in q."""
        if self.mechanism.base == "free":
            yield "the base", slice(3, 7)
        inside = {
            "floating": slice(3, 7),
            "planar": slice(2, 4),
            "continuous": slice(0, 2),
            "spherical": slice(0, 4),
        }
        for slot in self.mechanism.joints.values():
            if slot.kind in inside:
                part, start = inside[slot.kind], slot.q.start
                yield f"joint {slot.name!r}", slice(start + part.start, start + part.stop)

    def turn_on(self, y: Array) -> float:
        """Bring the turned angles in y, in place, up to its configuration; return the fastest rate [rad/s].

        To be called where a step is accepted: an angle is unique as long as no joint turns by half a turn
        from there.
        """
        return float(_kernels.turn_on(self.program, self.turns, y))

    def contact_memory(self, y: Array) -> Array:
        """Return the contact memory of a state that comes without one, (contacts, 3).

        Contacts with a gap of zero or less touch, as if for the first time: with the depth rate there and
        then as approach speed, at least the floor, and with the effective mass there and then.
        """
        return memory_numbers(Workspace(self).first_memory(y))

    def acceleration(self, t: float, q: ArrayLike, v: ArrayLike, memory: ArrayLike | None = None) -> Array:
        """Return the generalized acceleration in a state, (nv,).

        Args:
            t: Time [s].
            q: Configuration, (nq,).
            v: Velocity, (nv,).
            memory: Of the contacts, (contacts, 3); by the rule of :meth:`contact_memory` if not given.
        """
        y = self.state(q, v)
        workspace = Workspace(self)
        workspace.memory[:] = workspace.first_memory(y) if memory is None else memory_records(memory)
        rates = np.zeros(self.model.nv + self.manifold.nx)
        workspace.bind(y, rates)(t)
        return rates[: self.model.nv].copy()

    def neutral(self) -> Array:
        """Return the configuration with every joint at zero and journals centred, (nq,)."""
        q: Array = pin.neutral(self.model)
        return q


def mechanism_slot(mechanism: Mechanism, joint: ClearanceJoint) -> JointSlot:
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
