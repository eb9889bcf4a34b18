"""Motorization margin: what drives over what resists, at each position of a travel."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.dynamics import System
from antenna_pin.scenario import Scenario
from antenna_pin.studies.margins.factors import FactorSet
from antenna_pin.studies.margins.result import MotorizationMargin

__all__ = ["motorization_margin"]


@takes()
def motorization_margin(
    model: Scenario | System | str | os.PathLike[str],
    joint: str,
    *,
    travel: Sequence[float | str] | None = None,
    count: int = 61,
    factors: str | FactorSet | Mapping[str, Any] = "ecss-e-st-33-01c",
    by_measurement: Mapping[str, bool] | Sequence[str] = (),
    classes: Mapping[str, str] | None = None,
    additional: Mapping[str, float | str | Sequence[float]] | None = None,
    base_acceleration: ArrayLike | None = None,
    acceleration: float | str = 0.0,
    delivered_torque: float | str = 0.0,
    rate: float | str = 0.0,
    drives: Sequence[str] | None = None,
    available: Mapping[str, float | str] | None = None,
    hold: Sequence[str] = (),
    cases: Mapping[str, Mapping[str, Any]] | None = None,
    ranges: Mapping[str, Sequence[Any]] | None = None,
    search: bool = False,
) -> MotorizationMargin:
    """Return the motorization margin of a function of one freedom over its travel."""
    raise NotImplementedError
