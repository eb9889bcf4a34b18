"""When to look at a run whose displacements are carried: samples, nodes of integrals, changes."""

from __future__ import annotations

import bisect
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.nonlinear.near import Near
from antenna_pin.nonlinear.numbers import Numbers
from antenna_pin.nonlinear.pieces import Piece
from antenna_pin.nonlinear.within import Within
from antenna_pin.records import CONTACT
from antenna_pin.simulation.loop import Run

__all__ = ["Look", "Pilot", "timetable"]

Array = NDArray[np.float64]

# Gauss's nodes of a step and their weights, over its length: of order 8, as the steps are themselves.
_NODES, _WEIGHTS = (np.array(one) for one in np.polynomial.legendre.leggauss(4))
_NODES, _WEIGHTS = 0.5 * (_NODES + 1.0), 0.5 * _WEIGHTS
# Two instants that are one but for round-off, over the later; and how far numbers are moved, in their scale.
_ONE, _MOVED = 1e-14, 1e-3


class Look(NamedTuple):
    """An instant at which displacements are looked at.

    Attributes:
        time: [s].
        weight: Of a node of an integral [s]; 0 of others.
        sample: Number of a sample; -1 of others.
    """

    time: float
    weight: float = 0.0
    sample: int = -1


class Pilot:
    """Sees where the steps of a run end, where something changes, and when contacts are deepest.

    Args:
        run: Before its first step; its steps are made one by one.
        numbers: Parameters of the system.

    Attributes:
        ends: Of steps, ascending [s].
        changes: Whether something changes there.
        idle: Whether nothing was integrated in the step that ends there, of no neighbour either.
        deepest: Contacts and when their depth is largest [s], in order.
    """

    def __init__(self, run: Run, numbers: Numbers) -> None:
        """Begin at the run's start."""
        self._near, self.idle = Near(run.system, run.settings, numbers), list[bool]()
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
            self.idle.append(not touched.any() and self._is_idle(run.stepper.h))
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

    def _is_idle(self, size: float) -> bool:
        """Whether nothing is integrated at begin, middle and end of a step, with any number moved either."""
        near = self._near
        near.workspace.memory[:], near.workspace.program[:] = self._own.memory, self._own.program
        nv, count = near.system.model.nv, near.parts[-3].stop - near.parts[-3].start
        for theta in (0.0, 0.5, 1.0):
            y = self._within.at(theta)
            for k in range(-1, count):
                moved = np.zeros(near.parts[-1].stop)
                moved[near.parts[-3]][k:][:1] = 0.0 if k < 0 else _MOVED
                if near.at(near.rates, self._time + theta * size, y, moved)[nv:].any():
                    return False
        return True


def timetable(pilot: Pilot, begin: float, samples: Array) -> Iterator[Look]:
    """Yield when to look, in order: at samples, at nodes between them, and where something changes.

    Next to where something changes, nodes are those of :class:`antenna_pin.nonlinear.pieces.Piece`.

    Args:
        pilot: That has seen the run.
        begin: When integrals begin [s].
        samples: Ascending, (n,) [s].
    """
    changes = {end for end, change in zip(pilot.ends, pilot.changes, strict=True) if change}
    borders = sorted(changes.union(pilot.ends, samples.tolist()))
    borders = [one for one in borders if begin <= one <= samples[-1]]
    number, last = 0, begin
    for border in borders:
        step = bisect.bisect_left(pilot.ends, border)
        rests = step < len(pilot.idle) and pilot.idle[step]
        if not rests and border - last > _ONE * max(abs(border), 1e-300):
            yield from _nodes(last, border, last in changes, border in changes)
        while number < len(samples) and samples[number] <= border:
            yield Look(float(samples[number]), sample=number)
            number += 1
        if border in changes:
            yield Look(border)
        last = border


def _nodes(a: float, b: float, graded: bool, falling: bool) -> Iterator[Look]:
    """Yield the nodes of an integral from one time to another [s]."""
    if graded and falling:
        middle = 0.5 * (a + b)
        yield from _nodes(a, middle, True, False)
        yield from _nodes(middle, b, False, True)
        return
    times, slopes = Piece(a, b, graded, falling).at(_NODES)
    for time, weight in zip(times.tolist(), ((b - a) * slopes * _WEIGHTS).tolist(), strict=True):
        yield Look(time, weight)
