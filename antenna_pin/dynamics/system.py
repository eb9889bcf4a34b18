"""The equations of motion: a Pinocchio tree and the force elements on it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.dynamics import _inspect, _kernels
from antenna_pin.dynamics.elements import CallableDrive, Drive, JointSpring
from antenna_pin.dynamics.hinge import Hinge, constrained_acceleration
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.geometry import SphericalClearance
from antenna_pin.geometry.shapes import TABLE_WIDTH
from antenna_pin.integrate import Manifold
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints import _kernels as _joint
from antenna_pin.joints.clearance import PythonPath
from antenna_pin.mechanism import JointSlot, Mechanism, frame_aligning_z

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
    """A mechanism with its force elements: the derivative that an integrator asks for.

    The state is ``y = [q, v, x]``: Pinocchio's configuration and velocity, and in x the turned angles of
    joints that turn without end (see :meth:`turn_on`) and what the elements integrate (per contact impulse,
    work lost in normal direction and to friction, bristles; per drive work and gross work; per spring the
    work lost in its damper).

    ``memory`` is the contacts' discrete state, one row each: [touching, approach speed, effective mass]. It
    is not part of ``y``; whoever advances the system changes it, at located events only.

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
        self.data = mechanism.model.createData()
        self.clearances = tuple(clearances)
        self.drives = dict(drives or {})
        self.springs = dict(springs or {})
        self.hinges = tuple(hinges)
        self._compose()
        self._acceleration: Callable[[Array, Array, Array], Array] = (
            constrained_acceleration(mechanism, self.data, self.hinges)
            if self.hinges
            else partial(pin.aba, self.model, self.data)
        )
        #: ``derivative(t, y, rates)`` writes [acceleration (nv), rate of x (nx)] at time t [s] and state y
        # into : rates; fastest when the two arrays are the same in each call.
        self.derivative = self._derivative()

    # --- layout ---------------------------------------------------------------------------------------------

    def _compose(self) -> None:
        names = [joint.name for joint in self.clearances]
        if len(set(names)) != len(names):
            raise InvalidParameterError("System", "clearances", "of different joints", names)
        self.contact_names = tuple(name for joint in self.clearances for name in joint.contact_names)
        nq = self.model.nq
        blocks: list[Array] = [np.array([nq, self.model.nv, 0.0, 0.0])]
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
            slot = self.mechanism.joint(hinge.joint)
            block = np.zeros(_joint.LAWS)
            head = [_joint.REVOLUTE, _joint.LAWS, 0, slot.q.start, slot.v.start, row, 0, x, 0]
            block[:10] = [*head, self.turn_x[hinge.joint]]
            block[_joint.AXES : _joint.AXES + 9] = frame_aligning_z(slot.axis).ravel()
            self.clearance_blocks[hinge.joint] = size
            blocks.append(block)
            size += len(block)
        self.impulse_x = np.array(first_x, dtype=int) + _joint.IMPULSE
        self.lost_normal_x = np.array(first_x, dtype=int) + _joint.LOST_NORMAL
        self.lost_friction_x = np.array(first_x, dtype=int) + _joint.LOST_FRICTION
        self.bristle_x = np.array(
            [first + k for first, stride in zip(first_x, strides, strict=True) for k in range(3, stride)],
            dtype=int,
        )
        nv = self.model.nv
        # Strips and sectors of joints with distributed load have their rows behind those of all contacts.
        rows = row
        for joint in self.clearances:
            rows += joint.place_strips(blocks[1 + self.clearances.index(joint)], rows)
        table = nv + _joint.POSE_BUFFER + _joint.MEMORY_WIDTH * row
        self._work = np.zeros(table + rows * TABLE_WIDTH)
        self.tau = self._work[:nv]
        self.memory = self._work[nv + _joint.POSE_BUFFER : table].reshape(row, _joint.MEMORY_WIDTH)
        self.table = self._work[table:].reshape(rows, TABLE_WIDTH)
        blocks[0][2:4] = row, rows
        work_x, self.drive_blocks = [], {}
        self._callables: list[tuple[int, int, CallableDrive]] = []
        for name, drive in self.drives.items():
            kind, parameters = drive.code()
            self.drive_blocks[name] = size
            about = 1.0 if drive.axis == "journal" else 0.0
            block = self._element(f"drive {name!r}", drive.joint, kind, x, about, parameters)
            if isinstance(drive, CallableDrive):
                self._callables.append((size, size + _kernels.PARAMETERS, drive))
            blocks.append(block)
            size += len(block)
            work_x.append(x)
            x += 2
        self.work_x = np.array(work_x, dtype=int)
        self.gross_work_x = self.work_x + 1
        damper_x, self.spring_blocks = [], {}
        for name, spring in self.springs.items():
            self.spring_blocks[name] = size
            if spring.shorter_way and self.mechanism.joint(spring.joint).kind == "prismatic":
                raise InvalidParameterError(
                    f"spring {name!r}", "shorter_way", f"false: joint {spring.joint!r} slides", True
                )
            values = (spring.stiffness, spring.damping, spring.rest_angle, float(spring.shorter_way))
            block = self._element(f"spring {name!r}", spring.joint, _kernels.SPRING, x, 0.0, values)
            blocks.append(block)
            size += len(block)
            damper_x.append(x)
            x += 1
        self.damper_x = np.array(damper_x, dtype=int)
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
        self._slow = bool(self._callables)
        self._paths: list[PythonPath] = []
        for joint in self.clearances:
            start = self.clearance_blocks[joint.name]
            if self.program[start + _joint.MODE] != 0.0:
                end = start + int(self.program[start + 1])
                self._paths.append(PythonPath(joint, self.program[start:end], nq))
                self._slow = True

    def _turning(self) -> dict[str, int]:
        """Return the joints whose configuration knows their angle only but for whole turns, numbered."""
        about_axis = {hinge.joint for hinge in self.hinges}
        about_axis |= {j.name for j in self.clearances if not isinstance(j.geometry, SphericalClearance)}
        names = [
            slot.name
            for slot in self.mechanism.joints.values()
            if slot.kind == "continuous" or slot.name in about_axis
        ]
        return {name: k for k, name in enumerate(names)}

    def _element(
        self, place: str, joint: str, kind: float, x: int, about: float, parameters: Sequence[float]
    ) -> Array:
        slot = self.mechanism.joint(joint)
        clearance = self.clearance_blocks.get(joint, -1)
        spherical = any(
            j.name == joint and isinstance(j.geometry, SphericalClearance) for j in self.clearances
        )
        if clearance >= 0 and not spherical:
            joint_kind = _kernels.CLEARANCE
        elif slot.kind in ("revolute", "prismatic"):
            joint_kind = _kernels.ONE_DOF
        elif slot.kind == "continuous":
            joint_kind = _kernels.CIRCLE
        else:
            kind_seen = "spherical" if spherical else slot.kind
            raise MechanismError(
                f"{place}: joint {joint!r} is {kind_seen} and has no axis to act about; "
                "use a revolute, continuous, prismatic or clearance joint"
            )
        head = [kind, _kernels.PARAMETERS + len(parameters), joint_kind, slot.q.start, slot.v.start, x]
        turn = self.turn_x.get(joint, -1)
        return np.array([*head, clearance, about, turn, *parameters], dtype=float)

    # --- the equations of motion ----------------------------------------------------------------------------

    def measure(self, y: Array) -> None:
        """Bring all rows of ``table`` up to date for a state: gap, normal, point, rates of every contact.

        The derivative itself updates the touching contacts only. Coal's gaps are asked for where it is the
        backend.
        """
        pose = self._work[self.model.nv : self.model.nv + _joint.POSE_BUFFER]
        _inspect.contacts_in(y, self.program, pose, self.table)
        for path in self._paths:
            path.prepare(y, self.memory, self.table, everything=True)

    def apply_elements(self, t: float, y: Array, rates: Array) -> None:
        """Evaluate the elements: ``tau``, the contacts' ``table``, and x rates behind rates[nv]."""
        for path in self._paths:
            path.prepare(y, self.memory, self.table)
        for block, slot, drive in self._callables:
            angle, rate, _, _ = _kernels.joint_motion(self.program, block, y, self.model.nq)
            self.program[slot] = drive.torque(t, angle, rate)
        _kernels.evaluate(t, y, self.program, self._work, rates)

    def bind(self, y: Array, rates: Array) -> Callable[[float], None]:
        """Return the derivative of a state held in an array, as a function of time alone.

        What an integrator calls: the arrays are looked at once, and no attribute is looked up (which would
        cost a tenth of an ABA).

        Args:
            y: State [q, v, x], contiguous; read at each call.
            rates: Output [acceleration (nv), rate of x (nx)], written at each call.
        """
        nq, nv = self.model.nq, self.model.nv
        q, v, out = y[:nq], y[nq : nq + nv], rates[:nv]
        program, work, tau = self.program, self._work, self.tau
        evaluate, model, data, aba = _kernels.evaluate, self.model, self.data, pin.aba
        if self._slow or self.hinges:
            elements, acceleration = self.apply_elements, self._acceleration

            def general(t: float) -> None:
                elements(t, y, rates)
                out[:] = acceleration(q, v, tau)

            return general

        def fused(t: float) -> None:
            evaluate(t, y, program, work, rates)
            out[:] = aba(model, data, q, v, tau)

        return fused

    def _derivative(self) -> Callable[[float, Array, Array], None]:
        """Return :meth:`derivative` as a closure that binds new arrays only when it is given new ones."""
        known = np.zeros(self.manifold.size)
        output = np.zeros(self.model.nv + self.manifold.nx)
        bound = self.bind(known, output)

        def derivative(t: float, y: Array, rates: Array) -> None:
            nonlocal known, output, bound
            if y is not known or rates is not output:
                known, output, bound = y, rates, self.bind(y, rates)
            bound(t)

        return derivative

    def acceleration(self, t: float, q: ArrayLike, v: ArrayLike) -> Array:
        """Return the generalized acceleration in a state, with the contact memory as it is, (nv,)."""
        y = self.state(q, v)
        rates = np.zeros(self.model.nv + self.manifold.nx)
        self.derivative(t, y, rates)
        return rates[: self.model.nv].copy()

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

    def effective_mass(self, y: Array, contact: int) -> float:
        """Return the mass that an impact along a contact's normal sees there and then [kg].

        With the normal's direction n in the space of generalized velocities, of the material points at the
        contact, it is ``(n^T M^-1 n)^-1``: the acceleration along n under a unit force gives it, constraints
        included.

        Args:
            y: State [q, v, x].
            contact: Number of the contact.
        """
        nq, nv = self.model.nq, self.model.nv
        pose, table = np.zeros(_joint.POSE_BUFFER), np.zeros_like(self.table)
        _inspect.contacts_in(y, self.program, pose, table)
        for joint in self.clearances:
            block = self.clearance_blocks[joint.name]
            if 0 <= contact - int(self.program[block + _joint.FIRST_CONTACT]) < joint.contacts:
                break
        _joint.journal_state(self.program, block, y, nq, pose)
        direction, rest = np.zeros(nv), np.zeros(nv)
        _joint.unit_normal_force(self.program, block, pose, table, contact, direction)
        free = np.array(self._acceleration(y[:nq], rest, rest))
        return float(1.0 / (direction @ (self._acceleration(y[:nq], rest, direction) - free)))

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
