"""Operating point of a linearisation: state, joints with play, loaded journals, held joints."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import gradient
from antenna_pin.base.readable import brief, number
from antenna_pin.base.records import CONTACT, POSE, memory_records
from antenna_pin.dynamics import BASE, System, Workspace, assemble, joints_held
from antenna_pin.errors import InvalidParameterError, MechanismError, UnknownNameError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.mechanism import JointSlot
from antenna_pin.studies.linear.force_derivatives import Forces

# --- a journal under load -----------------------------------------------------------------------------------

# What is left of the load where a journal counts as resting, and how often its pose is improved.
_BALANCED = 1e-12
_ROUNDS = 60


def _press(
    system: System,
    joint: ClearanceJoint,
    y: Array,
    load: Array,
    approach_speed: float | None,
    memory: NDArray[Any],
) -> None:
    """Move a journal to contact equilibrium under a force, in place, without friction.

    Of several equilibria the nearest to the line along the load through the middle of the play is taken, at
    the present angle. Coordinates without load, as an axial position or a tilt, stay.
    """
    place = _JournalPose(system, joint, y, load, memory)
    if joint.planar and load[2] != 0.0:
        raise MechanismError(
            f"modes: load of {joint.name}: must lie in the joint's plane, got {number(float(load[2]))} N "
            "along its axis, where nothing but the ideal plane carries it"
        )
    if joint.geometry.motion == "slide" and load[2] != 0.0:
        raise MechanismError(
            f"modes: load of {joint.name}: must be across the guide, got {number(float(load[2]))} N along "
            "it, where the joint slides"
        )
    start = place.into_contact()
    found = place.balanced(start)
    y[:] = place.state(found)
    place.write_memory(y)
    rows = place.rows
    speed = joint.approach_speed_floor if approach_speed is None else approach_speed
    workspace = Workspace(system)
    for row in rows:
        touches = memory["touching"][row]
        mass = workspace.effective_mass(y, row) if touches else 0.0
        memory[row] = touches, (max(speed, joint.approach_speed_floor) if touches else 0.0), mass


class _JournalPose:
    """Poses of one journal with contact forces and load."""

    def __init__(
        self, system: System, joint: ClearanceJoint, y: Array, load: Array, memory: NDArray[Any]
    ) -> None:
        self.system, self.joint, self.load = system, joint, load
        self.slot = system.mechanism.joint(joint.name)
        self.block, self.rows = system.clearance_blocks[joint.name], _rows_of(system, joint)
        self.memory = memory
        for row in self.rows:
            # A depth of an impact that never was: laws that ask for it at rest do not depend on it.
            memory[row] = 0.0, joint.approach_speed_floor, 1.0
        self.at_rest = y.copy()
        nq = system.model.nq
        self.at_rest[nq : nq + system.model.nv] = 0.0
        self.table = np.zeros(system.rows, CONTACT)
        self.workspace = Workspace(system)
        geometry = joint.geometry
        self.lever = geometry.section_radius + abs(joint.offset) + (geometry.half_length or 0.0)
        self.forces = Forces(system, 0.0, self.at_rest, memory, {})

    # A pose: displacement of the journal's centre in bearing axes [m], and turns in the child's axes [rad].

    def state(self, pose: Array) -> Array:
        """Return the state with the journal's centre at pose[:3], turned by pose[3:]."""
        y = self.at_rest.copy()
        step = np.zeros(self.system.model.nv)
        v = self.slot.v
        ways = v.stop - v.start - (1 if self.joint.planar else 3)
        step[v.start + ways : v.stop] = pose[5:] if self.joint.planar else pose[3:]
        y[: self.system.model.nq] = pin.integrate(self.system.model, y[: self.system.model.nq], step)
        # The centre goes where it is to be; a pure way of the child takes it there in one step.
        seen = np.zeros(1, POSE)
        place_journal(self.system.program, self.block, y, self.system.model.nq, seen)
        missing = pose[:3] - seen["centre"][0]
        way = np.zeros(self.system.model.nv)
        way[v.start : v.start + ways] = self._ways(y, missing)
        y[: self.system.model.nq] = pin.integrate(self.system.model, y[: self.system.model.nq], way)
        return y

    def _ways(self, y: Array, missing: Array) -> Array:
        """Return the child's displacement in its own axes for one of the journal's centre."""
        nq, v = self.system.model.nq, self.slot.v
        count = v.stop - v.start - (1 if self.joint.planar else 3)
        columns = np.zeros((3, count))
        for k in range(count):
            moving = y.copy()
            moving[nq + v.start + k] = 1.0
            seen = np.zeros(1, POSE)
            place_journal(self.system.program, self.block, moving, nq, seen)
            columns[:, k] = seen["velocity"][0]
        return np.asarray(np.linalg.lstsq(columns, missing, rcond=None)[0])

    def write_memory(self, y: Array) -> None:
        """Mark closed gaps as touching."""
        self.workspace.locate(y, self.table)
        for row in self.rows:
            self.memory["touching"][row] = float(self.table["gap"][row] <= 0.0)
        self.forces.memory[:] = self.memory

    def lacks(self, pose: Array) -> Array:
        """Return residual force and moment over the lever [N], in the joint's axes."""
        y = self.state(pose)
        self.write_memory(y)
        tau, _ = self.forces.contacts(y)
        tau = tau + self.forces.load_force(y, self.joint.name, self.load)
        own = tau[self.slot.v].copy()
        own[2 if self.joint.planar else 3 :] /= self.lever
        return own

    def into_contact(self) -> Array:
        """Return a pose along the load whose contacts carry its size."""
        size = float(np.linalg.norm(self.load))
        seen = np.zeros(1, POSE)
        place_journal(self.system.program, self.block, self.at_rest, self.system.model.nq, seen)
        pose = np.zeros(6)
        slides = self.joint.geometry.motion == "slide"
        if slides:
            pose[2] = seen["centre"][0][2]
        if self.joint.geometry.motion is None:
            parts = [self.load / size]
        else:
            across, along = self.load * [1.0, 1.0, 0.0], self.load * [0.0, 0.0, 1.0]
            parts = [part / np.linalg.norm(part) for part in (across, along) if part.any()]
        for direction in parts:
            wanted = float(self.load @ direction)
            pose[:3] += direction * self._depth_for(pose, direction, wanted)
        return pose

    def _pushes(self, pose: Array, direction: Array) -> float:
        """Return the force of the contacts against a direction [N]."""
        y = self.state(pose)
        self.write_memory(y)
        tau, _ = self.forces.contacts(y)
        unit = self.forces.load_force(y, self.joint.name, direction)
        # Of a pure displacement along the direction: its power is the force's component.
        return -float(tau[self.slot.v] @ unit[self.slot.v]) / float(unit[self.slot.v] @ unit[self.slot.v])

    def _depth_for(self, pose: Array, direction: Array, wanted: float) -> float:
        play = self.joint.geometry.radial_clearance
        limit = max(self.joint.depth_limits)
        way = np.concatenate([direction, np.zeros(3)])

        def short(s: float) -> float:
            return wanted - self._pushes(pose + s * way, direction)

        low, high = 0.0, 0.0
        step = 0.25 * play if play > 0.0 else 0.01 * limit
        while True:
            high += step
            if short(high) <= 0.0:
                break
            low = high
            if high > 1e3 * max(play, limit) or high > 10.0 * self.lever:
                raise MechanismError(
                    f"modes: load of {self.joint.name}: must press the journal against the bearing, got "
                    f"{number(wanted)} N along a direction in which no contact carries it"
                )
        for _ in range(200):
            middle = 0.5 * (low + high)
            if middle in (low, high):
                break
            if short(middle) > 0.0:
                low = middle
            else:
                high = middle
        return high

    def balanced(self, pose: Array) -> Array:
        """Improve a pose by Newton's method until contacts and load balance."""
        size = float(np.linalg.norm(self.load))
        free = [0, 1, 5] if self.joint.planar else list(range(6))
        scale = np.array([1.0, 1.0, 1.0, *[1.0 / self.lever] * 3])
        lack = self.lacks(pose)
        best = float(np.abs(lack).max())
        for _ in range(_ROUNDS):
            if best <= _BALANCED * size:
                break
            depth = self._depth(pose)
            rows = self._slopes(pose, np.eye(6)[:, free] * scale[:, None], depth)
            change = np.linalg.lstsq(rows, -lack, rcond=1e-9)[0]
            step = np.zeros(6)
            step[free] = change
            step *= scale
            part = 1.0
            while part > 1e-6:
                trial = pose + part * step
                left = self.lacks(trial)
                if float(np.abs(left).max()) < best:
                    break
                part *= 0.5
            else:
                break
            pose, lack, best = trial, left, float(np.abs(left).max())
        if not best <= 1e-6 * size:
            raise MechanismError(
                f"modes: load of {self.joint.name}: must be one that the contacts can balance, got "
                f"{self.load.tolist()} N, of which {number(best)} N are left; take another direction"
            )
        self.lacks(pose)
        return pose

    def _slopes(self, pose: Array, ways: Array, depth: float) -> Array:
        """Return the derivatives of :meth:`lacks` over displacements."""
        return gradient(lambda step: self.lacks(pose + step), ways, [0.02 * depth, 0.005 * depth])[0]

    def _depth(self, pose: Array) -> float:
        self.workspace.locate(self.state(pose), self.table)
        depths = [-float(self.table["gap"][row]) for row in self.rows if self.table["gap"][row] < 0.0]
        return min(depths) if depths else 1e-9


# --- operating points ---------------------------------------------------------------------------------------

Play = Literal["ideal", "free", "contact"]
"""What a joint with play is taken as: what it is ideally, free in its play, or as it touches in the state."""


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class At:
    """Operating point: a state, and the treatment of its joints."""

    __repr__ = brief

    system: System  # the system
    time: float  # time of the state [s]
    y: Array  # the state [q, v, x]
    memory: NDArray[Any]  # contact memory, with the closed contacts
    play: Mapping[str, Play]  # treatment of each joint with play, by name
    # forces on journals that press them into contact, in bearing axes, by joint, (3,) [N]
    loads: Mapping[str, Array]
    hold: tuple[str, ...] = ()  # names of joints that do not move; ``base`` is a free base
    rest: bool = True  # whether the state is at rest, with unbalanced forces compensated
    # numbers of drives and springs that events have changed: (place, value)
    adjusted: tuple[tuple[str, float], ...] = ()

    @property
    def v(self) -> Array:
        """Velocity, (nv,)."""
        nq = self.system.model.nq
        return self.y[nq : nq + self.system.model.nv]

    @property
    def q(self) -> Array:
        """Configuration, (nq,)."""
        return self.y[: self.system.model.nq]

    def allowed(self) -> Array:
        """Return orthonormal directions that no ``hold`` prevents, without constraints, (nv, k)."""
        nv = self.system.model.nv
        parts = [] if BASE in self.hold else [np.eye(nv)[:, self.system.mechanism.base_v]]
        joints = {joint.name: joint for joint in self.system.clearances}
        held = joints_held(self.system, self.adjusted)
        for name, slot in self.system.mechanism.joints.items():
            if name in self.hold or name in held:
                continue
            own = np.eye(nv)[:, slot.v]
            if self.play.get(name) == "ideal":
                own = own @ ideal_directions(slot, joints[name], self.q)
            parts.append(own)
        return np.hstack(parts) if parts else np.zeros((nv, 0))


def ideal_directions(slot: JointSlot, joint: ClearanceJoint, q: Array) -> Array:
    """Return the motions of a joint with play as ideal, (nv, k).

    The child turns about its own axis, slides along it, or turns about its ball's centre.
    """
    motion = joint.geometry.motion
    if joint.planar:
        return np.eye(3)[:, 2:]
    if motion is None:
        return np.eye(6)[:, 3:]
    found = np.zeros((6, 1))
    if motion == "turn":
        found[3:, 0] = slot.axis
    else:
        found[:3, 0] = slot.axis
    return found


@takes()
def prepared(
    system: System,
    y: Array,
    *,
    time: float = 0.0,
    memory: ArrayLike | None = None,
    play: Play | Mapping[str, Play] | None = None,
    load: ArrayLike | Mapping[str, ArrayLike] | None = None,
    approach_speed: float | None = None,
    hold: Sequence[str] = (),
    moving: bool = False,
    adjusted: tuple[tuple[str, float], ...] = (),
) -> At:
    """Return a checked operating point, with loaded journals pressed into contact.

    Args:
        system: The system.
        y: The state [q, v, x].
        time: Time of the state [s].
        memory: Contact memory, (contacts, 3); by default contacts with a gap of zero or less are closed.
        play: Treatment of joints with play, one for all or by name; by default ``contact`` with a load, else
            ``ideal``.
        load: Force on the journal in bearing axes, (3,) [N]; by joint if there are several with play.
        approach_speed: Approach speed stored for contacts under a load [m/s]; by default their joint's floor.
        hold: Names of joints that do not move; ``base`` is a free base.
        moving: Whether velocities and accelerations of the state count.
        adjusted: Numbers of drives and springs that events have changed.

    Raises:
        AntennaPinError: A name is unknown, a load has no contact to press, or a contact is open.
    """
    y = y.copy()
    names = [joint.name for joint in system.clearances]
    loads = _loads(names, load)
    taken = _play_of_joints(names, play, loads)
    _check_hold(system, hold)
    nq, nv = system.model.nq, system.model.nv
    if not moving:
        y[nq : nq + nv] = 0.0
    workspace = Workspace(system)
    records = workspace.first_memory(y) if memory is None else memory_records(memory).copy()
    for joint in system.clearances:
        rows = _rows_of(system, joint)
        if joint.name in loads:
            _press(system, joint, y, loads[joint.name], approach_speed, records)
        elif taken[joint.name] != "contact":
            records["touching"][rows] = 0.0
        else:
            _check_touching(system, joint, y, records, rows)
    if loads and system.plan is not None:
        # Journals that have moved open loops that were closed.
        try:
            assemble(system, y, list(loads), list(loads))
        except MechanismError as error:
            raise MechanismError(f"modes: the journals under their loads: {error}") from None
        if not moving:
            y[nq : nq + nv] = 0.0
    return At(
        system=system,
        time=time,
        y=y,
        memory=records,
        play=taken,
        loads=loads,
        hold=tuple(hold),
        rest=not moving,
        adjusted=adjusted,
    )


def _loads(names: Sequence[str], load: ArrayLike | Mapping[str, ArrayLike] | None) -> dict[str, Array]:
    if load is None:
        return {}
    if not isinstance(load, Mapping):
        if len(names) != 1:
            known = ", ".join(names) or "none"
            raise InvalidParameterError(
                "modes", "load", f"given by joint, {{name: (x, y, z)}}; with play: {known}", load
            )
        load = {names[0]: load}
    found = {}
    for name, given in load.items():
        if name not in names:
            raise UnknownNameError("modes: load", "joint with play", name, names)
        force = np.array(given, dtype=float)
        if force.shape != (3,) or not np.isfinite(force).all() or not force.any():
            raise InvalidParameterError(
                "modes", f"load of {name}", "three finite numbers [N], not all 0", np.asarray(given).tolist()
            )
        found[name] = force
    return found


def _play_of_joints(
    names: Sequence[str], play: Play | Mapping[str, Play] | None, loads: Mapping[str, Array]
) -> dict[str, Play]:
    given: dict[str, Play] = {}
    if isinstance(play, Mapping):
        given = dict(play)
    elif play is not None:
        given = dict.fromkeys(names, play)
    for name, kind in given.items():
        if name not in names:
            raise UnknownNameError("modes: play", "joint with play", name, names)
        if kind not in get_args(Play):
            raise InvalidParameterError("modes", f"play of {name}", "ideal, free or contact", kind)
        if kind != "contact" and name in loads:
            raise InvalidParameterError(
                "modes", f"play of {name}", "contact, or left out, as the joint has a load", kind
            )
    return {name: given.get(name, "contact" if name in loads else "ideal") for name in names}


def _check_hold(system: System, hold: Sequence[str]) -> None:
    known = [*system.mechanism.joints]
    if system.mechanism.base == "free":
        known.append(BASE)
    for name in hold:
        if name not in known:
            raise UnknownNameError("modes: hold", "joint", name, known)


def _rows_of(system: System, joint: ClearanceJoint) -> list[int]:
    block = system.clearance_blocks[joint.name]
    return [row for row, of in enumerate(system.block_of_contact) if of == block]


def _check_touching(
    system: System, joint: ClearanceJoint, y: Array, memory: NDArray[Any], rows: Sequence[int]
) -> None:
    table = np.zeros(system.rows, CONTACT)
    Workspace(system).locate(y, table)
    if not any(memory["touching"][row] and table["gap"][row] < 0.0 for row in rows):
        raise MechanismError(
            f"modes: joint {joint.name!r}: must touch somewhere to be taken in contact, got a journal in "
            "free flight; give a load that presses it, a state in which it touches, or take it as ideal or "
            "free"
        )
