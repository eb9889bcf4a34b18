"""A fit's problem with the starts of its pieces among what is unknown.

Where a record is compared in pieces, nobody knows the states that they start from: they are fitted, and an interval of
a parameter is as wide as not knowing them makes it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.fit.sure import Residuals

__all__ = ["WithStates"]

Array = NDArray[np.float64]


class WithStates:
    """A problem whose unknowns are parameters and states, told as one list of parameters.

    Args:
        problem: What is fitted; ``states``, if it has them, are unknown too, in steps of ``reach``.
        parameters: How many of the names are parameters: the first ones.
    """

    def __init__(self, problem: Any) -> None:
        """Take the problem's numbers, and the states' behind them."""
        states = np.asarray(getattr(problem, "states", np.zeros(0)), dtype=float)
        more = len(states)
        self._problem: Residuals = problem
        self.parameters = len(problem.names)
        self.names = (*problem.names, *(f"state {k + 1}" for k in range(more)))
        self.start = np.concatenate([problem.start, states])
        self.lower = np.concatenate([problem.lower, np.full(more, -np.inf)])
        self.upper = np.concatenate([problem.upper, np.full(more, np.inf)])
        sizes = problem.sizes()[self.parameters :] if more else np.zeros(0)
        self.scale = np.concatenate([problem.scale, sizes])

    def residuals(self, values: Array) -> Array:
        """Return model less record, and what pieces are apart, (m,) [-]."""
        return self._problem.residuals(values)

    def jacobian(self, values: Array) -> Array:
        """Return their derivatives, (m, p + h)."""
        return self._problem.jacobian(values)
