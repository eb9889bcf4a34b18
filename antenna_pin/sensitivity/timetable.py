"""When to look at a run whose displacements are carried: samples, and where something changes."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.nonlinear.within import Within
from antenna_pin.records import CONTACT
from antenna_pin.simulation.loop import Run

__all__ = ["Look", "Pilot", "timetable"]

Array = NDArray[np.float64]


class Look(NamedTuple):
    """An instant at which displacements are looked at.

    Attributes:
        time: [s].
        sample: Number of a sample; -1 of others.
    """

    time: float
    sample: int = -1


class Pilot:
    """Sees where the steps of a run end, where something changes, and when contacts are deepest.

    Args:
        run: Before its first step; its steps are made one by one.

    Attributes:
        ends: Of steps, ascending [s].
        changes: Whether something changes there.
        deepest: Contacts and when their depth is largest [s], in order.
    """

    def __init__(self, run: Run) -> None:
        """Begin at the run's start."""
        self.ends: list[float] = []
        self.changes: list[bool] = []
        self.deepest: list[tuple[int, float]] = []
        self._passages: list[object] = []
        run.actions.passages = self._passages  # type: ignore[assignment]
        self._within = Within(run)
        self._own = self._within.workspace
        self._table = np.zeros(len(self._own.table), CONTACT)
        self._take_over(run)

    def _take_over(self, run: Run) -> None:
        self._time, self._y = run.stepper.t, run.here.copy()
        self._within.take_over(run)

    def look(self, run: Run) -> None:
        """Look at a step that the run has made."""
        time = run.stepper.t
        touched, touching = self._own.memory["touching"].copy(), run.workspace.memory["touching"]
        changes = bool(self._passages) or not np.array_equal(touched, touching)
        self._passages.clear()
        if time > self._time:
            self._within.begin(self._time, self._y, run.stepper.h, None)
            if touched.any():
                self._look_for_deepest(np.flatnonzero(touched).tolist(), run.stepper.h)
            self.ends.append(time)
            self.changes.append(changes)
        elif changes and self.changes:
            self.changes[-1] = True
        self._take_over(run)

    def end(self, run: Run) -> None:
        """Look at the last one."""
        self.look(run)

    def _look_for_deepest(self, contacts: list[int], size: float) -> None:
        """Find where depths are largest within a step [s]."""

        def rate(theta: float, c: int) -> float:
            self._own.locate(self._within.at(theta), self._table)
            return float(self._table["rate"][c])

        found = []
        for c in contacts:
            if rate(0.0, c) > 0.0 >= rate(1.0, c):
                theta = float(brentq(rate, 0.0, 1.0, args=(c,), xtol=1e-15))
                found.append((self._time + theta * size, c))
        self.deepest += [(c, time) for time, c in sorted(found)]


def timetable(pilot: Pilot, begin: float, samples: Array) -> Iterator[Look]:
    """Yield when to look, in order: at samples, and where something changes.

    Args:
        pilot: That has seen the run.
        begin: When to begin [s].
        samples: Ascending, (n,) [s].
    """
    changes = {end for end, change in zip(pilot.ends, pilot.changes, strict=True) if change}
    number = 0
    for time in sorted(changes.union(samples.tolist())):
        if not begin <= time <= samples[-1]:
            continue
        if number < len(samples) and samples[number] == time:
            yield Look(time, sample=number)
            number += 1
        if time in changes:
            yield Look(time)
