"""Results of motorization margins."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.readable import brief, number
from antenna_pin.scenario import Scenario
from antenna_pin.studies.margins.factors import FactorSet

Array = NDArray[np.float64]


class MarginCase(NamedTuple):
    """Combination of extremes with its smallest margin."""

    name: str  # such as "cold, drives.motor.voltage_limit=24"
    overrides: Mapping[str, Any]  # of the scenario's keys
    margin: float  # the smallest over the travel [-]
    position: float  # at which [rad] ([m])
    origin: str  # "nominal", "case", "corner" or "search"


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class MotorizationMargin:
    """Motorization margin of a function over its travel.

    Attributes:
        data: Along ``position`` [rad] ([m]): ``margin`` [-], ``actuation``, the factored drive,
            ``minimum_torque``, T_min, and ``needed_torque``, unfactored [N*m] ([N]); along ``source`` too
            ``resistance`` (zero or more) and ``drive`` (likewise, unfactored), and of each source
            ``symbol``, its class, ``resistance_factor``, ``drive_factor`` and ``by_measurement``. All in
            the nominal case.
        joint: The function's joint.
        sliding: Whether the joint is prismatic.
        factors: Set of factors.
        smallest: Smallest margin of the nominal case [-].
        position: Position of the smallest margin [rad] ([m]).
        cases: All evaluated combinations of extremes and the nominal case, the smallest margin first.
        worst: The first of the cases.
        worst_scenario: Scenario of the worst case, ready to run; None for a system built in Python.
        notes: Assumptions and limits, in sentences.
        scenario: Nominal scenario; None for a system built in Python.
    """

    __repr__ = brief

    data: xr.Dataset
    joint: str
    sliding: bool
    factors: FactorSet
    smallest: float
    position: float
    cases: tuple[MarginCase, ...]
    worst_scenario: Scenario | None = None
    notes: tuple[str, ...] = ()
    scenario: Scenario | None = None

    @property
    def worst(self) -> MarginCase:
        """Case with the smallest margin."""
        return self.cases[0]

    @property
    def margin(self) -> Array:
        """Margin over the travel in the nominal case, (n,) [-]."""
        return np.asarray(self.data["margin"].values)

    @property
    def unit(self) -> str:
        """Unit of torques."""
        return "N" if self.sliding else "N*m"

    def to_dict(self) -> dict[str, Any]:
        """Return the margin in plain numbers."""
        data = self.data
        sources = []
        for name in data["source"].values:
            one = data.sel(source=name)
            sources.append(
                {
                    "source": str(name),
                    "symbol": str(one["symbol"].item()),
                    "resistance_factor": float(one["resistance_factor"].item()),
                    "drive_factor": float(one["drive_factor"].item()),
                    "measured": bool(one["by_measurement"].item()),
                    "resistance": one["resistance"].values.tolist(),
                    "drive": one["drive"].values.tolist(),
                }
            )
        return {
            "joint": self.joint,
            "unit": self.unit,
            "factors": self.factors.name,
            "source_of_factors": self.factors.source,
            "clause": self.factors.clause,
            "required": self.factors.required,
            "smallest_margin": self.smallest,
            "at_position": self.position,
            "worst_case": {**self.worst._asdict(), "overrides": dict(self.worst.overrides)},
            "position": data["position"].values.tolist(),
            "margin": self.margin.tolist(),
            "actuation": data["actuation"].values.tolist(),
            "minimum_torque": data["minimum_torque"].values.tolist(),
            "needed_torque": data["needed_torque"].values.tolist(),
            "sources": sources,
            "cases": [{**one._asdict(), "overrides": dict(one.overrides)} for one in self.cases],
            "notes": list(self.notes),
        }

    def __str__(self) -> str:
        """Show the smallest margins."""
        unit = "m" if self.sliding else "rad"
        return (
            f"MotorizationMargin({self.joint!r}, smallest {number(self.smallest)} at "
            f"{number(self.position)} {unit}, worst case {number(self.worst.margin)})"
        )
