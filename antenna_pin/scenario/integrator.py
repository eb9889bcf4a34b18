"""How the motion is computed and recorded."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from antenna_pin.scenario._base import PositiveLength, PositiveSpeed, PositiveTime, Quantity, Spec, refuse

__all__ = ["IntegratorSpec", "OutputSpec", "ScalesSpec"]


class ScalesSpec(Spec):
    """What an error counts as large against, per kind of quantity: ``rtol * (scale + |value|)``.

    Attributes:
        position: [m].
        angle: [rad].
        velocity: [m/s].
        angular_velocity: [rad/s].
        clearance: Position scale of a joint with play, in multiples of its own clearance [-].
        clearance_velocity: Velocity scale of a joint with play [m/s].
        base: Factor on the scales of a free base [-]; None for the mass of the other bodies over the whole
            mass.
    """

    position: PositiveLength = 1.0
    angle: Annotated[float, Quantity("rad", "positive")] = 1.0
    velocity: PositiveSpeed = 1.0
    angular_velocity: Annotated[float, Quantity("rad/s", "positive")] = 1.0
    clearance: Annotated[float, Quantity("1", "positive")] = 1.0
    clearance_velocity: PositiveSpeed = 0.01
    base: Annotated[float, Quantity("1", "positive")] | None = None


class IntegratorSpec(Spec):
    """How the motion is integrated.

    Attributes:
        method: A Runge-Kutta method by name.
        rtol: Relative tolerance of a step of the adaptive methods [-].
        step: Fixed step of ``rk4`` [s].
        max_step: [s].
        min_step: A run whose step falls below this ends [s].
        first_step: None to choose it [s].
        max_steps: Trial steps in all after which a run ends; None for no limit [-].
        max_wall_time: Wall time after which a run ends [s]; None for no limit.
        max_expected_steps: A run that at its present pace would need more trial steps than this to its end
            makes no way, and ends [-].
        scales: What the tolerance is relative to.
    """

    method: Literal["rk4", "bogacki-shampine-32", "dormand-prince-54", "dormand-prince-853"] = (
        "dormand-prince-853"
    )
    rtol: Annotated[float, Quantity("1", "between 0 and 1")] = 1e-8
    step: PositiveTime = 1e-5
    max_step: PositiveTime = 1e-2
    min_step: PositiveTime = 1e-14
    first_step: PositiveTime | None = None
    max_steps: Annotated[int, Field(ge=1)] | None = None
    max_wall_time: PositiveTime | None = None
    max_expected_steps: Annotated[float, Quantity("1", "positive")] = 1e9
    scales: ScalesSpec = Field(default_factory=ScalesSpec)

    @model_validator(mode="after")
    def _check_steps(self) -> Self:
        if not self.min_step < self.max_step:
            refuse(f"must be below max_step = {self.max_step:g} s, got {self.min_step:g} s", "min_step")
        if self.first_step is not None and not self.min_step <= self.first_step <= self.max_step:
            rule = f"must be from min_step = {self.min_step:g} s to max_step = {self.max_step:g} s"
            refuse(f"{rule}, got {self.first_step:g} s", "first_step")
        return self


class OutputSpec(Spec):
    """What is recorded.

    Attributes:
        rate: Samples per time, beside those at events [Hz].
    """

    rate: Annotated[float, Quantity("Hz", "positive")] = 1000.0
