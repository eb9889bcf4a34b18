"""Start of the motion."""

from __future__ import annotations

import math
from typing import Annotated, Self

from pydantic import Field, model_validator

from antenna_pin.base.units import shown
from antenna_pin.scenario._base import (
    AngularVelocity,
    Position,
    Quantity,
    Rotation,
    Spec,
    Vector,
    Velocity,
    refuse,
)
from antenna_pin.scenario._joint import JointTable

__all__ = ["InitialBaseSpec", "InitialJointSpec", "InitialSpec"]


class InitialJointSpec(JointTable):
    """Start of a joint; None for zero.

    Attributes:
        position: Of a joint with one degree of freedom [rad] ([m]).
        velocity: Of a joint with one degree of freedom [rad/s] ([m/s]).
        angle: Of a joint with play, about the axis; with it journal_tilt[2] must be zero [rad].
        rate: Of a joint with play, about the axis; with it journal_angular_velocity[2] must be zero [rad/s].
        journal_position: Journal's centre from the bearing's, in bearing axes [m].
        journal_tilt: Rotation vector of the journal's tilt, in bearing axes [rad].
        journal_velocity: Of the journal's centre in bearing axes [m/s].
        journal_angular_velocity: Of the journal relative to the bearing, in bearing axes [rad/s].
        guess: Whether, in loops, what is given is where a search begins rather than held.
    """

    position: Annotated[float, Quantity(("rad", "m"))] | None = None
    velocity: Annotated[float, Quantity(("rad/s", "m/s"))] | None = None
    angle: Annotated[float, Quantity("rad")] | None = None
    rate: Annotated[float, Quantity("rad/s")] | None = None
    journal_position: Position | None = None
    journal_tilt: Rotation | None = None
    journal_velocity: Velocity | None = None
    journal_angular_velocity: AngularVelocity | None = None
    guess: bool = False

    @property
    def gives_a_rate(self) -> bool:
        """Return whether a rate of the joint, or of its journal, is given."""
        given = self.velocity, self.rate, self.journal_velocity, self.journal_angular_velocity
        return any(one is not None for one in given)

    @model_validator(mode="after")
    def _check_pairs(self) -> Self:
        for pair in (("position", "angle"), ("velocity", "rate")):
            if all(getattr(self, name) is not None for name in pair):
                refuse(f"must have at most one of {' and '.join(pair)}, got both")
        return self


class InitialBaseSpec(Spec):
    """Start of a free base.

    Attributes:
        position: Of the base's frame in the world [m].
        attitude: Unit quaternion x, y, z, w [-].
        velocity: In base axes [m/s].
        angular_velocity: In base axes [rad/s].
    """

    position: Position = (0.0, 0.0, 0.0)
    attitude: Annotated[tuple[float, float, float, float], Vector("1", (4,))] = (0.0, 0.0, 0.0, 1.0)
    velocity: Velocity = (0.0, 0.0, 0.0)
    angular_velocity: AngularVelocity = (0.0, 0.0, 0.0)

    @property
    def moves(self) -> bool:
        """Return whether a velocity of the base is given."""
        return any(self.velocity) or any(self.angular_velocity)

    @model_validator(mode="after")
    def _check_attitude(self) -> Self:
        norm = math.hypot(*self.attitude)
        if abs(norm - 1.0) > 1e-6:
            rule = "must be a unit quaternion x, y, z, w"
            refuse(f"{rule}, got {shown(self.attitude)} of length {norm:g}", "attitude", value=self.attitude)
        return self


class InitialSpec(Spec):
    """Initial state; zero and the identity by default.

    Attributes:
        joints: By name of the joint.
        base: Of a free base.
    """

    joints: dict[str, InitialJointSpec] = Field(default_factory=dict)
    base: InitialBaseSpec = Field(default_factory=InitialBaseSpec)
