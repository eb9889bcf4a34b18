"""A state in the middle of a run, as a controller sees it at one of its instants."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.directions import direction as unit_of
from antenna_pin.dynamics import Workspace, acting_on_links
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.simulation.moment import Moment

__all__ = ["Sight"]

Array = NDArray[np.float64]


class Sight(Moment):
    """What :class:`antenna_pin.control.Now` says, at a moment of a run.

    Args:
        workspace: What the run works on.

    Attributes:
        tick: Number of the instant, of the controller that looks.
        noted: What it has noted.
    """

    def __init__(self, workspace: Workspace) -> None:
        """Make it once; ``set`` and ``look`` bring it to an instant."""
        super().__init__(workspace)
        self.tick = 0
        self.noted: dict[str, float] = {}
        self._commands: Mapping[str, Callable[[], float]] = {}
        self._data = self.system.mechanism.model.createData()
        self._placed = False

    def set(self, time: float, y: Array) -> Sight:
        """Bring it to another time and state; return it."""
        self._placed = False
        super().set(time, y)
        return self

    def look(self, tick: int, commands: Mapping[str, Callable[[], float]]) -> None:
        """Let a controller look: which of its instants it is, and who tells what is commanded, by name."""
        self.tick, self._commands, self.noted = tick, commands, {}

    def note(self, **signals: float) -> None:
        """Keep numbers beside the commands of this instant."""
        self.noted.update(signals)

    def command(self, name: str) -> float:
        """Return the command that an actuator follows up to now."""
        if name not in self._commands:
            raise UnknownNameError("controller", "actuator", name, self._commands)
        return self._commands[name]()

    # --- the base -------------------------------------------------------------------------------------------

    def _check_base(self, what: str) -> None:
        if self.system.mechanism.base != "free":
            rule = "asked of a free base only; set mechanism.base"
            raise InvalidParameterError("controller", what, rule, "fixed")

    def base_quaternion(self) -> Array:
        """Return the base's attitude in the world, xyzw, (4,)."""
        self._check_base("base_quaternion")
        return self.q[3:7]

    def base_rotation(self) -> Array:
        """Return the base's attitude as a rotation vector, (3,), world axes [rad]."""
        self._check_base("base_rotation")
        return np.asarray(pin.log3(pin.Quaternion(self.q[3:7]).toRotationMatrix()))

    def base_rate(self) -> Array:
        """Return the base's angular velocity, (3,), in its own axes [rad/s]."""
        self._check_base("base_rate")
        return self.v[3:6]

    # --- links and joints -----------------------------------------------------------------------------------

    def direction(self, link: str, axis: ArrayLike) -> Array:
        """Return an axis of a link, (3,), in the world, of length 1."""
        mechanism = self.system.mechanism
        frame = mechanism.model.frames[mechanism.frame(link)]
        if not self._placed:
            pin.forwardKinematics(mechanism.model, self._data, self.q)
            self._placed = True
        turned: Array = self._data.oMi[frame.parentJoint].rotation @ frame.placement.rotation
        return turned @ unit_of(axis, "controller", "axis")

    def off_axis(self, link: str, axis: ArrayLike, target: ArrayLike) -> float:
        """Return the angle between an axis of a link and a direction of the world [rad]."""
        here, there = self.direction(link, axis), unit_of(target, "controller", "target")
        return math.atan2(float(np.linalg.norm(np.cross(here, there))), float(here @ there))

    def joint_load(self, joint: str) -> Array:
        """Return force [N] and moment [N m] that a joint passes to its child, (6,), in the joint's axes.

        What drives and springs at the joint do is in it. It follows from the motion of all that the joint
        carries, less what forces on links do to that; there may be no closures and no springs between points.
        """
        system = self.system
        if system.closures or system.point_springs:
            rule = "asked where there are no closures and no springs between points"
            raise InvalidParameterError("controller", "joint_load", rule, joint)
        slot = system.mechanism.joint(joint)
        self._workspace.derivative(self.time, self._y, self._rates)
        self._evaluated, self._measured, self._placed = True, False, False
        model, data = system.mechanism.model, self._data
        pin.forwardKinematics(model, data, self.q)
        outside = [pin.Force.Zero() for _ in range(model.njoints)]
        for link, wrench in acting_on_links(system, self._workspace.program):
            if link != "world":
                carries = model.frames[system.mechanism.frame(link)].parentJoint
                outside[carries] += data.oMi[carries].actInv(pin.Force(wrench))
        pin.rnea(model, data, self.q, self.v, self._rates[: self._nv].copy(), outside)
        return np.asarray(data.f[slot.joint_id].vector).copy()
