"""Temperatures of a scenario: of all parts or of each, tables over temperature, bearings' materials."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from antenna_pin.base.iso_fits import IsoFit
from antenna_pin.base.rules import ABOVE_ZERO
from antenna_pin.base.units import any_quantity, shown
from antenna_pin.scenario.spec import QuantityRule, Spec, Vector, refuse

#: Temperature of dimensions on drawings, 20 degC (ISO 1) [K].
REFERENCE = 293.15

Temperature = Annotated[float, QuantityRule("K", ABOVE_ZERO)]


def _quantities(value: object) -> object:
    if not isinstance(value, list | tuple) or any(any_quantity(one) is None for one in value):
        refuse(f"must be an array of numbers, or of texts with units, got {shown(value)}", value=value)
    return tuple(value)


class TemperatureTable(Spec):
    """A number of the scenario over temperature, linear between its points.

    Attributes:
        key: Key of the number with dots, as in ``--set``.
        temperature: Of the points, increasing [K].
        value: Of the number there, in its unit.
        factor: On the scenario's number there instead [-].
        part: Link whose temperature counts; the temperature of all parts if left out.
    """

    key: str
    temperature: Annotated[tuple[float, ...], Vector("K", (), ABOVE_ZERO)]
    value: Annotated[tuple[Any, ...], BeforeValidator(_quantities)] | None = None
    factor: Annotated[tuple[float, ...], Vector("1", ())] | None = None
    part: str | None = None

    @model_validator(mode="after")
    def _check_points(self) -> Self:
        if (self.value is None) == (self.factor is None):
            refuse(f"must have one of value and factor, got {'neither' if self.value is None else 'both'}")
        column = "factor" if self.value is None else "value"
        count = len(getattr(self, column))
        if len(self.temperature) < 2:
            refuse(f"must have at least 2 entries, got {len(self.temperature)}", "temperature")
        if count != len(self.temperature):
            refuse(f"must have {len(self.temperature)} entries, one a temperature, got {count}", column)
        for k, (before, after) in enumerate(
            zip(self.temperature, self.temperature[1:], strict=False), start=1
        ):
            if not after > before:
                refuse(f"must be above the one before, {before:g} K, got {after:g} K", "temperature", k)
        return self

    def numbers(self) -> tuple[float, ...]:
        """Return values or factors in SI units."""
        if self.factor is not None:
            return self.factor
        read = [any_quantity(one) for one in self.value or ()]
        return tuple(one[0] for one in read if one is not None)

    def at(self, temperature: float) -> float | None:
        """Return value or factor at a temperature [K]; None beyond the table."""
        low, high = self.temperature[0], self.temperature[-1]
        if not low * (1.0 - 1e-12) <= temperature <= high * (1.0 + 1e-12):
            return None
        return float(np.interp(temperature, self.temperature, self.numbers()))


class ThermalBearing(Spec):
    """Materials of shaft and housing around a pair of ball bearings.

    Attributes:
        shaft_material: Of what holds the inner rings apart.
        housing_material: Of what holds the outer rings apart.
        inner_on: Link of the joint with the shaft.
    """

    shaft_material: str
    housing_material: str
    inner_on: Literal["parent", "child"] = "child"


class TemperatureSpec(Spec):
    """Temperatures of the parts, at which dimensions are computed from those at a reference.

    Attributes:
        all: Of all parts without their own [K]; the reference if left out.
        reference: Temperature of the given dimensions, preload and other numbers [K].
        parts: Of links, by name [K].
        tables: Numbers of the scenario over temperature, by names of your own.
        bearings: Materials around pairs of ball bearings, by their names in ``[bearings.NAME]``.
    """

    all: Temperature | None = None
    reference: Temperature = REFERENCE
    parts: dict[str, Temperature] = Field(default_factory=dict)
    tables: dict[str, TemperatureTable] = Field(default_factory=dict)
    bearings: dict[str, ThermalBearing] = Field(default_factory=dict)

    def of(self, part: str | None) -> float:
        """Return the temperature of a link, or of all parts [K]."""
        common = self.reference if self.all is None else self.all
        return common if part is None else self.parts.get(part, common)


def _one(value: object) -> object:
    """Return the table that a single temperature stands for."""
    return value if value is None or isinstance(value, Mapping | TemperatureSpec) else {"all": value}


#: A table of temperatures, or one temperature for all parts.
OneTemperature = Annotated[TemperatureSpec, BeforeValidator(_one)]


@dataclass(frozen=True, slots=True, kw_only=True)
class JointPlay:
    """Play of a joint at the temperatures of its parts.

    Attributes:
        joint: Name of the joint.
        bearing_temperature: Of the part with the bearing [K].
        journal_temperature: Of the part with the journal [K].
        reference: Radial play at the reference temperature [m].
        radial: Radial play at these temperatures, negative of an interference [m].
        axial: Axial play at each flange [m]; NaN of a joint without flanges.
        fit: The fit, with its limits; None without one.
        closing: Share of the way from the reference to these temperatures at which the radial play is gone
            [-]; NaN where it never is.
    """

    joint: str
    bearing_temperature: float
    journal_temperature: float
    reference: float
    radial: float
    axial: float
    fit: IsoFit | None
    closing: float
