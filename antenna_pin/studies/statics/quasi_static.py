"""Quasi-static travel: a joint moved through its positions without inertia."""

from __future__ import annotations

import os
from collections.abc import Sequence

from antenna_pin.base.arguments import takes
from antenna_pin.dynamics import System
from antenna_pin.scenario import Scenario
from antenna_pin.studies.statics.result import QuasiStaticTravel

__all__ = ["travel"]


@takes()
def travel(
    model: Scenario | System | str | os.PathLike[str],
    joint: str,
    positions: Sequence[float | str] | None = None,
    *,
    start: float | str | None = None,
    stop: float | str | None = None,
    count: int = 61,
    back: bool = True,
    hold: Sequence[str] = (),
) -> QuasiStaticTravel:
    """Return the torque that a joint needs along its travel, and back."""
    raise NotImplementedError
