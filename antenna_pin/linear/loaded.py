"""A journal under a load: where it rests in its bearing."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from antenna_pin.base.differences import gradient
from antenna_pin.base.readable import number
from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.dynamics import System, Workspace
from antenna_pin.errors import MechanismError
from antenna_pin.joints import ClearanceJoint
from antenna_pin.joints.pose_kernels import place_journal
from antenna_pin.linear.forces import Forces

__all__ = ["press"]

Array = NDArray[np.float64]

# What is left of the load where a journal counts as resting, and how often its pose is improved.
_BALANCED = 1e-12
_ROUNDS = 60


def press(
    system: System,
    joint: ClearanceJoint,
    y: Array,
    load: Array,
    approach_speed: float | None,
    memory: NDArray[Any],
) -> None:
    """Move a journal to where its contacts balance a force on it, in place; at rest, without friction.

    Of the places where it could rest it is the one next to that straight along the load from the middle of
    the play, with the angle that it has. What the load does not press, an axial position or a tilt, stays.

    Args:
        system: The system.
        joint: The joint with play.
        y: State [q, v, x]; the joint's part of q is written.
        load: Force on the journal at its centre in bearing axes, (3,) [N].
        approach_speed: What the contacts remember of how they came about [m/s]; the joint's floor if None.
        memory: Contact memory; the joint's part is written.

    Raises:
        MechanismError: No contact carries it.
    """
    place = _Place(system, joint, y, load, memory)
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


class _Place:
    """Poses of one journal, and what its contacts and its load do there."""

    def __init__(
        self, system: System, joint: ClearanceJoint, y: Array, load: Array, memory: NDArray[Any]
    ) -> None:
        self.system, self.joint, self.load = system, joint, load
        self.slot = system.mechanism.joint(joint.name)
        block = system.clearance_blocks[joint.name]
        self.block = block
        self.rows = [row for row, of in enumerate(system.block_of_contact) if of == block]
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
        """Return the state with the journal displaced: its centre at pose[:3], turned by pose[3:]."""
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
        """Return the child's displacement in its own axes that moves the journal's centre by a vector."""
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
        """Let touch what is not apart."""
        self.workspace.locate(y, self.table)
        for row in self.rows:
            self.memory["touching"][row] = float(self.table["gap"][row] <= 0.0)
        self.forces.memory[:] = self.memory

    def lacks(self, pose: Array) -> Array:
        """Return what is left of load and contacts: force, and moment over the lever [N], joint's axes."""
        y = self.state(pose)
        self.write_memory(y)
        tau, _ = self.forces.contacts(y)
        tau = tau + self.forces.load_force(y, self.joint.name, self.load)
        own = tau[self.slot.v].copy()
        own[2 if self.joint.planar else 3 :] /= self.lever
        return own

    def into_contact(self) -> Array:
        """Return a pose straight along the load in which the contacts carry it all but its direction."""
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
        reach = 0.0
        while True:
            high += step
            reach = high
            if short(high) <= 0.0:
                break
            low = high
            if reach > 1e3 * max(play, limit) or reach > 10.0 * self.lever:
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
        """Return the derivatives of :meth:`lacks` along ways."""
        return gradient(lambda step: self.lacks(pose + step), ways, [0.02 * depth, 0.005 * depth])[0]

    def _depth(self, pose: Array) -> float:
        self.workspace.locate(self.state(pose), self.table)
        depths = [-float(self.table["gap"][row]) for row in self.rows if self.table["gap"][row] < 0.0]
        return min(depths) if depths else 1e-9
