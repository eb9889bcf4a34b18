"""When contacts are deepest in a run: where the rate of a depth passes zero within its steps."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import CONTACT
from antenna_pin.base.roots import root_between
from antenna_pin.nonlinear.within import Within
from antenna_pin.simulation.tape import Taped

__all__ = ["Deepest"]

Array = NDArray[np.float64]


class Deepest:
    """Sees when contacts are deepest.

    Args:
        within: States within the steps that are looked at, with the contacts that touch in them.

    Attributes:
        found: Contacts and when their depth is largest [s], in order.
    """

    def __init__(self, within: Within) -> None:
        """Begin with none."""
        self._within = within
        self._table = np.zeros(len(within.workspace.table), CONTACT)
        self.found: list[tuple[int, float]] = []

    def look(self, steps: Sequence[Taped]) -> list[float]:
        """Look at steps that follow one another; return when contacts that touch in them are deepest [s]."""
        touching = np.flatnonzero(self._within.touching)
        if not steps or not len(touching):
            return []
        rates = np.array([self._rates(y)[touching] for y in (steps[0].y, *(one.end for one in steps))])
        new: list[tuple[float, int]] = []
        for k, j in zip(*np.nonzero((rates[:-1] > 0.0) & (rates[1:] <= 0.0)), strict=True):
            one, c = steps[k], int(touching[j])
            self._within.begin(one.time, one.y, one.size, one.end)
            ends = float(rates[k, j]), float(rates[k + 1, j])
            theta = root_between(partial(self._rate, c), 0.0, 1.0, absolute=1e-15, ends=ends)
            new.append((one.time + theta * one.size, c))
        new.sort()
        self.found += [(c, time) for time, c in new]
        return [time for time, _ in new]

    def _rate(self, c: int, theta: float) -> float:
        """Return how fast a contact's depth grows at a fraction of the step [m/s]."""
        return float(self._rates(self._within.at(theta))[c])

    def _rates(self, y: Array) -> Array:
        """Return how fast depths grow in a state, (contacts,) [m/s]."""
        self._within.workspace.locate(y, self._table)
        return self._table["rate"].copy()
