"""Equilibria of a mechanism, several where there are several, with their stability."""

from __future__ import annotations

import os
from collections.abc import Sequence

from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.dynamics import System
from antenna_pin.scenario import Scenario
from antenna_pin.studies.statics.result import Equilibrium

__all__ = ["equilibria"]


@takes()
def equilibria(
    model: Scenario | System | str | os.PathLike[str],
    *,
    q: ArrayLike | None = None,
    hold: Sequence[str] = (),
    starts: int = 16,
    seed: int = 0,
) -> list[Equilibrium]:
    """Return the equilibria of a mechanism, that next to its start first."""
    raise NotImplementedError
