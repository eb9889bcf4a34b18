"""Chains of tolerances in a scenario: dimensions with limits, and the play that they leave."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from antenna_pin.base.iso_fits import read_size
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario.spec import Length, QuantityRule, Spec, refuse


class DimensionSpec(Spec):
    """A dimension as in a drawing.

    Attributes:
        nominal: Nominal dimension [m].
        plus: Upper deviation [m].
        minus: Lower deviation with its sign, so mostly negative or zero [m].
        size: Nominal size in millimetres and tolerance class by ISO 286 instead, as ``"20 H7"``.
        coefficient: Part in the sum: 1 adds, -1 takes away, 0.5 makes a radius of a diameter [-].
        distribution: Between the limits: ``normal`` about the middle and cut off at the limits, ``uniform``
            or ``triangular``.
        sigmas: Standard deviations of ``normal`` from the middle to a limit [-].
        material: Name of a material, by whose expansion it follows the temperature; rigid if left out.
        part: Link whose temperature counts; that of all parts if left out.
    """

    nominal: Length | None = None
    plus: Length | None = None
    minus: Length | None = None
    size: str | None = None
    coefficient: Annotated[float, QuantityRule("1")] = 1.0
    distribution: Literal["normal", "uniform", "triangular"] = "normal"
    sigmas: Annotated[float, QuantityRule("1", "positive")] = 3.0
    material: str | None = None
    part: str | None = None

    @model_validator(mode="after")
    def _check_zone(self) -> Self:
        own = ("nominal", "plus", "minus")
        given = [name for name in own if getattr(self, name) is not None]
        if self.coefficient == 0.0:
            refuse("must be other than zero, or the dimension left out", "coefficient", value=0.0)
        if self.part is not None and self.material is None:
            refuse("must be left out without material: its temperature then changes nothing", "part")
        if self.size is None:
            for name in own:
                if name not in given:
                    refuse('is missing; give nominal, plus and minus, or size as "20 H7"', name)
            if not self.limits[2] >= self.limits[1]:
                refuse(
                    f"must be at least minus = {self.minus:g} m, got {self.plus:g} m", "plus", value=self.plus
                )
            return self
        if given:
            refuse(f"must be left out with size = {self.size!r}, which decides it", given[0])
        try:
            read_size(self.size)
        except InvalidParameterError as error:
            refuse(f"must be {error.rule}, got {self.size!r}", "size", value=self.size)
        return self

    @property
    def limits(self) -> tuple[float, float, float]:
        """Nominal dimension, lower and upper deviation [m]."""
        if self.size is not None:
            found = read_size(self.size)
            return found.nominal, found.lower, found.upper
        assert self.nominal is not None and self.minus is not None and self.plus is not None
        return self.nominal, self.minus, self.plus


class ChainSpec(Spec):
    """A chain of dimensions, whose sum is a play or another closing dimension.

    Attributes:
        dimensions: By name.
        least: Least sum that is permitted [m]; 0 of a play.
        most: Largest sum that is permitted [m].
        title: Description of the sum.
    """

    dimensions: dict[str, DimensionSpec] = Field(default_factory=dict)
    least: Length | None = None
    most: Length | None = None
    title: str = ""

    @model_validator(mode="after")
    def _check_chain(self) -> Self:
        if not self.dimensions:
            refuse("must have a dimension at least", "dimensions")
        if self.least is not None and self.most is not None and not self.least <= self.most:
            refuse(f"must be at least least = {self.least:g} m, got {self.most:g} m", "most", value=self.most)
        return self
