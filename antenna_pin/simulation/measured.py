"""Contacts whose gaps a backend in Python measures, and nothing else: when they change, how deep they were.

The compiled search of a step knows gaps in closed form only. Here the same is done with any backend's: gap
and rate at the same points of the step, dips between them by the sign of the rate, roots closed in on.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.dynamics import Workspace, peak_kernels
from antenna_pin.integrate import Stepper

__all__ = ["NOTHING", "Found", "Measured", "passage"]

Function = Callable[[float], float]

POINTS = tuple(k / peak_kernels.NODES for k in range(peak_kernels.NODES + 1))


class Found(NamedTuple):
    """What happens first to the contacts of a step.

    Attributes:
        contact: Its number, or -1.
        theta: At which fraction of the step; 2 or more if nowhere.
        deep: Whether it is too deep then; else it changes.
    """

    contact: int
    theta: float
    deep: bool


#: Nothing.
NOTHING = Found(-1, 2.0, False)


def _root(function: Function, a: float, b: float) -> float:
    return float(brentq(function, a, b, xtol=1e-15, rtol=4.0 * np.finfo(float).eps))


def passage(
    sign: float,
    points: Sequence[float],
    gaps: Sequence[float],
    rates: Sequence[float],
    gap: Function,
    rate: Function,
) -> float:
    """Return the first fraction of a step at which a gap passes zero, or 2 (as in the compiled search).

    Args:
        sign: 1: upwards; -1: downwards.
        points: Fractions of the step that are looked at first, from 0 to 1.
        gaps: There [m].
        rates: Of penetration there [m/s].
        gap: Gap at a fraction [m].
        rate: Rate of penetration at a fraction [m/s].
    """
    # f = sign gap is negative before, or zero at the start, on the surface to round-off.
    for k in range(len(points) - 1):
        a, b = points[k], points[k + 1]
        fa, fb = sign * gaps[k], sign * gaps[k + 1]
        da, db = -sign * rates[k], -sign * rates[k + 1]
        if fb > 0.0:
            if fa < 0.0:
                return _root(gap, a, b)
            if da < 0.0 < db:  # does it dip to the right side first?
                m = _root(rate, a, b)
                if sign * gap(m) < 0.0:
                    return _root(gap, m, b)
            return a
        if da > 0.0 > db:  # it may rise above zero in between
            if fa >= 0.0:
                return a
            m = _root(rate, a, b)
            if sign * gap(m) > 0.0:
                return _root(gap, a, m)
    return 2.0


def _raised(function: Function, by: float) -> Function:
    return lambda theta: function(theta) + by


class Measured:
    """Looks at those contacts inside trial steps.

    Args:
        workspace: What the run works on.
        stepper: Whose steps.
        table: Contact table, written.

    Attributes:
        contacts: Their numbers.
    """

    def __init__(self, workspace: Workspace, stepper: Stepper, table: NDArray[Any]) -> None:
        """Find out which they are."""
        self._workspace = workspace
        self._stepper = stepper
        self._table = table
        self._y = np.zeros(workspace.manifold.size)
        self._of = {
            c: path for path in workspace.measured for c in range(path.row, path.row + len(path.laws))
        }
        self.contacts = tuple(self._of)

    def at(self, theta: float, c: int) -> Any:
        """Return the row of a contact at a fraction of the trial step."""
        self._stepper.interpolate(theta, self._y)
        self._of[c].locate(self._y, self._table)
        return self._table[c]

    def _looked_at(self, c: int) -> tuple[list[float], list[float], Function, Function]:
        rows = [(float(row.gap), float(row.rate)) for row in (self.at(theta, c) for theta in POINTS)]
        gaps, rates = [gap for gap, _ in rows], [rate for _, rate in rows]
        return (
            gaps,
            rates,
            lambda theta: float(self.at(theta, c).gap),
            lambda theta: float(self.at(theta, c).rate),
        )

    def first(self, until: float, ignore: NDArray[np.int64], limits: NDArray[np.float64]) -> Found:
        """Return what happens first, before a fraction of the step (as the compiled ``inspect_step``)."""
        found = Found(-1, until, False)
        for c in self.contacts:
            gaps, rates, gap, rate = self._looked_at(c)
            touching = bool(self._workspace.memory[c].touching)
            theta = passage(1.0 if touching else -1.0, POINTS, gaps, rates, gap, rate)
            if theta < found.theta and not (ignore[c] == 2 and theta == 0.0):
                found = Found(c, theta, False)
            if touching:
                limit = float(limits[c])
                theta = passage(-1.0, POINTS, [g + limit for g in gaps], rates, _raised(gap, limit), rate)
                if theta < found.theta:
                    found = Found(c, theta, True)
        return found

    def track_depths(self, peaks: NDArray[Any]) -> None:
        """Raise the largest depth of those that touch, in the run's ``PEAK``, to the dense output's."""
        for c in self.contacts:
            if not self._workspace.memory[c].touching:
                continue
            gaps, rates, gap, rate = self._looked_at(c)
            least = min(gaps)
            for k in range(len(POINTS) - 1):
                if rates[k] > 0.0 > rates[k + 1]:
                    least = min(least, gap(_root(rate, POINTS[k], POINTS[k + 1])))
            peaks[c].depth = max(peaks[c].depth, -least)
