"""Start, integration and record of the motion."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import Field, ValidationError, model_validator

from antenna_pin.base.arguments import takes
from antenna_pin.base.settings import ErrorScales, RunSettings, choice_for
from antenna_pin.base.units import shown
from antenna_pin.scenario._class_tables import JointTable, MadeSpec, reads
from antenna_pin.scenario.spec import (
    AngularVelocity,
    Position,
    QuantityRule,
    Rotation,
    Spec,
    Vector,
    Velocity,
    read_quantity,
    refuse,
)


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
        guess: Whether, in loops, the given values are a first guess instead of held.
    """

    position: Annotated[float, QuantityRule(("rad", "m"))] | None = None
    velocity: Annotated[float, QuantityRule(("rad/s", "m/s"))] | None = None
    angle: Annotated[float, QuantityRule("rad")] | None = None
    rate: Annotated[float, QuantityRule("rad/s")] | None = None
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


@reads(ErrorScales)
class ScalesSpec(MadeSpec):
    """Error scale per kind of quantity: ``rtol * (scale + |value|)``."""


_OUTPUT = {f"output_{key}": key for key in ("rate", "times", "form", "keep")}


@reads(RunSettings, without=tuple(_OUTPUT), scales=ScalesSpec)
class IntegratorSpec(MadeSpec):
    """Integration of the motion."""

    @model_validator(mode="before")
    @classmethod
    def _choose(cls, data: Any) -> Any:
        """Refuse an accuracy beside what it chooses, and fill that in."""
        if not isinstance(data, Mapping) or data.get("accuracy") is None:
            return data
        try:
            given = read_quantity(data["accuracy"], "1", "between 0 and 1")
        except ValidationError:
            return data  # refused where it is read
        chosen = dict(zip(("method", "rtol"), choice_for(given), strict=True))
        for name, value in chosen.items():
            if data.get(name, value) != value:
                rule = f"must be left out with accuracy = {given:g}, which chooses it"
                refuse(f"{rule}, got {shown(data[name])}; leave out one of them", name)
        return {**data, **chosen}


@takes()
def settings_key(parameter: str) -> tuple[str, ...]:
    """Return the keys of a scenario for a parameter of the settings."""
    if parameter == "duration":
        return (parameter,)
    output = parameter.removeprefix("output_")
    return ("integrator", parameter) if output == parameter else ("output", output)


@reads(RunSettings, only=tuple(_OUTPUT), renamed=_OUTPUT)
class OutputSpec(MadeSpec):
    """Record of the motion."""
