"""Path of a driven joint: poses in balance one after another."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import number
from antenna_pin.dynamics import JointMotion, acting_in, kernels
from antenna_pin.elements import BetweenJoints, BoucWen
from antenna_pin.errors import MechanismError
from antenna_pin.mechanism.inertia import mass_matrix
from antenna_pin.studies.statics.balance import Balance, NotClosedError
from antenna_pin.studies.statics.reading import components
from antenna_pin.studies.statics.solver import NotBalancedError, Rest, rested, settled_senses
from antenna_pin.studies.statics.static_system import StaticSystem

Array = NDArray[np.float64]

# Longest step of the driven joint at once, and how often it is halved [rad, or lengths of the mechanism].
_LONGEST, _HALVINGS = 0.1, 4
_DEPENDENT = 1e-9
_STEP = 1e-4


class PathPoint(NamedTuple):
    """A position of the driven joint."""

    rest: Rest
    torque: float  # that it needs on its child [N*m] ([N])
    components: dict[str, float]  # of all sources, along the joint's motion [N*m] ([N])
    velocity: Array  # of the mechanism over that of the joint, (nv,)


class Path:
    """Successive poses in balance of a driven joint.

    Args:
        static: The system with its driven joint.
        y: First state, of the original system; it is brought into balance.
        time: Time of motions and forces [s].
        saturated: Whether slipping friction acts with its static limit.
    """

    def __init__(self, static: StaticSystem, y: Array, time: float = 0.0, saturated: bool = False) -> None:
        """Bring the mechanism into balance at its start."""
        assert static.joint is not None
        self.joint = static.joint
        self.balance = Balance(static, static.state_from(y), time)
        self.balance.saturated = saturated
        self._motion = JointMotion(static.system, self.joint)
        self._v = static.system.mechanism.joint(self.joint).v
        self.sliding = static.system.slides(self.joint)
        self._longest = _LONGEST * (self.balance.length if self.sliding else 1.0)
        self._tangent: Array | None = None
        self._rest: Rest | None = None  # the last pose in balance, whose tangent predicts the next one
        y0 = self.balance.projected(self.balance.y.copy())
        self.balance.accept(y0)
        self._check_freedom(y0)

    @property
    def position(self) -> float:
        """Position of the joint [rad] ([m])."""
        return self._motion(self.balance.y)[0]

    def snapshot(self) -> Any:
        """Return a snapshot of the present position."""
        return self.balance.snapshot(), self._tangent, self._rest

    def restore(self, snapshot: Any) -> None:
        """Restore a snapshot."""
        present, self._tangent, self._rest = snapshot
        self.balance.restore(present)

    def forget(self) -> None:
        """Begin anew, without previous motion."""
        self._tangent = self._rest = None

    def _check_freedom(self, y: Array) -> None:
        """Refuse a joint that other constraints hold."""
        direction = self.kinematic_or_none(y)
        if direction is None:
            held = ", ".join(sorted(self.balance.adjustments.held_joints())) or "none"
            raise MechanismError(
                f"statics: joint {self.joint!r} must be free to be driven, got one that closures, couplings, "
                f"motions or latches hold (held by elements: {held}); drive the joint that leads it, or take "
                "a motion or hold away"
            )

    def kinematic_or_none(self, y: Array) -> Array | None:
        """Return the velocity ratios of the mechanism, or None at a held joint."""
        balance = self.balance
        inverse = np.linalg.inv(balance.scale(y))
        rows = balance.rows(y, driven=False) @ inverse
        lengths = np.linalg.norm(rows, axis=1)
        rows = rows[lengths > 0.0] / lengths[lengths > 0.0, None]
        basis = np.eye(balance.model.nv)
        if len(rows):
            _, values, right = np.linalg.svd(rows)
            basis = right[int(np.count_nonzero(values > _DEPENDENT)) :].T
        slope = balance.slope(self._motion, self._v, y) @ inverse
        own = basis.T @ slope
        if np.linalg.norm(own) <= _DEPENDENT * np.linalg.norm(slope):
            return None
        return np.asarray(inverse @ (basis @ own) / (own @ own))

    def kinematic(self, y: Array) -> Array:
        """Return the velocity ratios of the mechanism to the joint, (nv,)."""
        found = self.kinematic_or_none(y)
        if found is None:
            raise NotClosedError(f"statics: {self.joint} stands in a singular position")
        return found

    def rate_of(self, joint: str, velocity: Array) -> float:
        """Return a joint's rate in a velocity, 0 without an axis."""
        try:
            motion = JointMotion(self.balance.system, joint)
        except MechanismError:
            return 0.0
        v = self.balance.system.mechanism.joint(joint).v
        return float(self.balance.slope(motion, v, self.balance.y) @ velocity)

    def geared_rate_of(self, joint: str, velocity: Array) -> float:
        """Return a joint's rate in a velocity with rigid gears."""
        system, balance = self.balance.system, self.balance
        rates = {name: self.rate_of(name, velocity) for name in system.mechanism.joints}
        meshes = [
            (one, kernels.joint_motion(balance.program, one.block, balance.y, balance.model.nq)[2:])
            for one in acting_in(system)
            if isinstance(one.element, BetweenJoints)
        ]
        for _ in meshes:
            for one, (over, over_other) in meshes:
                element: Any = one.element
                ends = element.input, element.output
                if rates[ends[0]] == 0.0 != rates[ends[1]] and over:
                    rates[ends[0]] = -over_other / over * rates[ends[1]]
                elif rates[ends[1]] == 0.0 != rates[ends[0]] and over_other:
                    rates[ends[1]] = -over / over_other * rates[ends[0]]
        return rates[joint]

    def inertia(self, point: PathPoint) -> float:
        """Return the inertia of the mechanism reduced to the joint [kg*m^2] ([kg])."""
        balance = self.balance
        mass = mass_matrix(balance.model, balance.model.createData(), point.rest.y[: balance.model.nq])
        return float(point.velocity @ mass @ point.velocity)

    def elastic(self, point: PathPoint, element: BoucWen) -> float:
        """Return the torque of a Bouc-Wen spring's elastic part along the joint's motion [N*m] ([N])."""
        angle = JointMotion(self.balance.system, element.joint)(point.rest.y)[0]
        torque = -element.alpha * element.stiffness * (angle - element.rest_angle)
        return torque * self.rate_of(element.joint, point.velocity)

    def move(self, position: float, sense: float, where: str = "travel") -> Rest:
        """Move the joint to a position, and find the balance there.

        Args:
            position: New position [rad] ([m]).
            sense: Sense of the motion, 1 or -1, which sets that of friction.
            where: The pose, for messages.
        """
        start = self.position
        parts = max(1, math.ceil(abs(position - start) / self._longest - 1e-9))
        found: Rest | None = None
        if self._rest is None and position != start:
            self._settle(sense, where)
        for k in range(1, parts + 1):
            goal = position if k == parts else start + (position - start) * k / parts
            found = self._step(goal, sense, where, _HALVINGS)
        assert found is not None
        return found

    def _settle(self, sense: float, where: str) -> None:
        """Come into balance where the path begins, as far as there is one."""
        before = self.snapshot()
        try:
            self._at(self.position, sense, where)
            self._tangent = self._tangent_of_slip()
        except (NotBalancedError, NotClosedError):
            self.restore(before)

    def _tangent_of_slip(self) -> Array:
        """Return the velocity ratios of a motion in which joints that stick give way, (nv,)."""
        balance, y = self.balance, self.balance.y
        balance.release()
        free = balance.free(y)
        return self.tangent(Rest(y, 0.0, free, balance.stiffness(y, free)))

    def slip(self, sense: float, where: str = "travel") -> None:
        """Come into balance with all friction against a motion, as after a long way."""
        balance = self.balance
        velocity = sense * self._tangent_of_slip()
        size = float(np.abs(velocity / balance.reach).max())
        for place, one in balance.frictions.items():
            rate = float(velocity[balance.system.mechanism.joint(str(one.element.acts_at)).v.start])
            if abs(rate) > _DEPENDENT * size:
                balance.set_sense(place, math.copysign(1.0, rate))
        self._rest = rested(balance, balance.y, where, [])
        balance.accept(self._rest.y)

    def _step(self, goal: float, sense: float, where: str, halvings: int) -> Rest:
        before, start = self.snapshot(), self.position
        try:
            return self._at(goal, sense, where)
        except (NotBalancedError, NotClosedError) as error:
            self.restore(before)
            if halvings == 0 or goal == start:
                unit = "m" if self.sliding else "rad"
                at = f"{self.joint} at {number(goal)} {unit}"
                raise NotBalancedError(str(error).replace(where, f"{where}, {at}")) from None
        self._step(0.5 * (start + goal), sense, where, halvings - 1)
        return self._step(goal, sense, where, halvings - 1)

    def _at(self, goal: float, sense: float, where: str) -> Rest:
        balance = self.balance
        y, change = balance.y.copy(), goal - self.position
        if change and self._tangent is None and self._rest is not None:
            self._tangent = self.tangent(self._rest)
        balance.release()
        kinematic = self.kinematic_or_none(y)
        if kinematic is None:
            raise NotClosedError(f"statics: {where}: {self.joint} cannot move on: a singular position")
        direction = kinematic if self._tangent is None else self._tangent
        balance.drive_to(goal)
        if change:
            balance.move(y, direction * change)
        balance.velocity = sense * direction if balance.static.contact_friction else balance.velocity
        y = balance.projected(y)
        undetermined = settled_senses(balance, y, sense * kinematic)
        found = rested(balance, y, where, undetermined)
        balance.accept(found.y)
        self._rest, self._tangent = found, None
        return found

    def read(self, rest: Rest) -> PathPoint:
        """Return the joint's needed torque and readings at the present pose."""
        velocity = self.tangent(rest)
        self._tangent = velocity
        parts = components(self.balance, rest.y, velocity)
        return PathPoint(rest, -sum(parts.values()), parts, velocity)

    def tangent(self, rest: Rest) -> Array:
        """Return the velocity of the mechanism along the path over that of the joint, (nv,)."""
        balance, y = self.balance, rest.y
        kinematic = self.kinematic(y)
        directions = rest.free.directions
        if directions.shape[1] == 0:
            return kinematic
        position = self._motion(y)[0]
        step = _STEP / max(1.0, float(np.abs(rest.free.scale @ kinematic).max()))
        sides = []
        for way in (step, -step):
            balance.drive_to(position + way)
            sides.append(balance.forces(balance.displaced(y, way * kinematic)))
        balance.drive_to(position)
        change = directions.T @ (sides[0] - sides[1]) / (2.0 * step)
        response = np.linalg.lstsq(directions.T @ rest.stiffness, change, rcond=1e-10)[0]
        balance.forces(y.copy())
        return np.asarray(kinematic + directions @ response)
