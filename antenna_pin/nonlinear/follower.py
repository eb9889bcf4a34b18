"""One step along a branch of periodic solutions: where it leads, and the orbit an arc ahead."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.differences import slope
from antenna_pin.nonlinear.chart import Chart
from antenna_pin.nonlinear.flow import Flow
from antenna_pin.nonlinear.orbits import NEWTON_STEP, NoOrbitError, Orbit, orbit_at, periodic_orbit
from antenna_pin.state import State

__all__ = ["Family", "Follower", "Point"]

Array = NDArray[np.float64]

_STEPS = (1e-3, 2e-4)  # of differences over a parameter, over its unit
_NEAR = 1e-3  # of an arc: how near to an end of the range Newton's method begins there


class Family(Protocol):
    """A flow and its period for every value of a parameter."""

    def __call__(self, value: float) -> tuple[Flow, float]:
        """Return the flow at a value, and the period of its orbits [s]."""


class Point(NamedTuple):
    """An orbit of a branch.

    Attributes:
        value: Of the parameter.
        orbit: The orbit.
    """

    value: float
    orbit: Orbit


class _Reached(NamedTuple):
    """Where a step has come to: value of the parameter, start of the orbit, what is left, iterations."""

    value: float
    start: State
    residual: float
    iterations: int


class Follower:
    """Follows a branch: orbits x of the map P(x, value) = x in coordinates, the parameter in its own unit."""

    def __init__(self, family: Family, unit: float, tolerance: float) -> None:
        """Take over what does not change along a branch."""
        self.family, self.unit, self.tolerance = family, unit, tolerance

    def orbit(self, guess: State, value: float, iterations: int = 12) -> Orbit:
        """Return the orbit at a value of the parameter."""
        flow, period = self.family(value)
        return periodic_orbit(flow, guess, period, tolerance=self.tolerance, iterations=iterations)

    def chart(self, point: Point) -> Chart:
        """Return the coordinates about an orbit's start."""
        return Chart(self.family(point.value)[0].system, point.orbit.start)

    def turned(self, way: Array, of: Point, at: Point) -> Array:
        """Return a direction at one point of a branch, (size + 1,), as one at another."""
        return np.append(self.chart(at).turned(way[:-1], self.chart(of)), way[-1])

    def by_parameter(self, chart: Chart, value: float) -> Array:
        """Return the derivative of the map over the parameter, (size,), per unit, at the chart's origin.

        Where closures or motions move with the parameter, the start is brought onto them across the
        coordinates, which so are those of the origin still: of all that moves only the end counts.
        """

        def at(s: float) -> Array:
            flow, period = self.family(value + s * self.unit)
            return chart.coordinates(flow.after(chart.state(np.zeros(chart.size), flow.system), period))

        return slope(at, _STEPS).value

    def direction(self, point: Point, last: Array | None, of: Point | None = None) -> Array:
        """Return the unit tangent of the branch, (size + 1,), on from the last one, at an orbit before."""
        chart = self.chart(point)
        rows = np.column_stack(
            [point.orbit.tangent - np.eye(chart.size), self.by_parameter(chart, point.value)]
        )
        way = np.linalg.svd(rows)[2][-1]
        if last is None or of is None or len(last) != len(way):
            return np.asarray(way if way[-1] >= 0.0 else -way)
        return np.asarray(way if way @ self.turned(last, of, point) >= 0.0 else -way)

    def correct(self, point: Point, way: Array, arc: float) -> Point:
        """Return the orbit an arc ahead, square to the direction there (Keller's pseudo-arclength)."""
        found = self._reached(point, way, arc)
        flow, period = self.family(found.value)
        return Point(
            found.value, orbit_at(flow, found.start, period, found.residual, found.iterations, False)
        )

    def _reached(self, point: Point, way: Array, arc: float) -> _Reached:
        origin = self.chart(point)
        value = point.value + float(arc * way[-1] * self.unit)
        flow, period = self.family(value)
        start = origin.state(arc * way[:-1], flow.system)
        last = math.inf
        for k in range(12):
            chart = Chart(flow.system, start)
            miss = chart.coordinates(flow.after(start, period))
            before, last = last, float(np.linalg.norm(miss))
            if not last < before:
                break  # it does not come nearer: a shorter step may
            if last <= self.tolerance:
                return _Reached(value, start, last, k)
            tangent = flow.tangent(start, period, chart, step=NEWTON_STEP)
            square = np.append(chart.turned(way[:-1], origin), way[-1])
            rows = np.column_stack([tangent.matrix - np.eye(chart.size), self.by_parameter(chart, value)])
            step = np.linalg.lstsq(np.vstack([rows, square]), np.append(-miss, 0.0), rcond=1e-12)[0]
            value += float(step[-1]) * self.unit
            flow, period = self.family(value)
            start = chart.state(step[:-1], flow.system)
        raise NoOrbitError("branch: Newton's method does not come back onto it")

    def stopped(
        self, point: Point, way: Array, arc: float, beyond: Point, value: float
    ) -> tuple[Point, float]:
        """Return the orbit at a value that a step passes, and the arc to it.

        Along the arc, where the branch cannot be mistaken for another, to a thousandth of it; from there by
        Newton's method at the value itself.

        Args:
            point: That the step begins with, on this side of the value.
            way: The direction there.
            arc: Of the step.
            beyond: What it came to, on the other side.
            value: Of the parameter.
        """
        known = {0.0: point.value, arc: beyond.value}

        def off(s: float) -> float:
            if s not in known:
                known[s] = self._reached(point, way, s).value
            return known[s] - value

        if off(0.0) == 0.0:
            raise NoOrbitError("branch: it begins at this value")
        near = float(brentq(off, 0.0, arc, xtol=_NEAR * arc, rtol=1e-12))
        found = self._reached(point, way, near)
        here = Chart(self.family(found.value)[0].system, found.start)
        guess = here.state(np.zeros(here.size), self.family(value)[0].system)
        orbit = self.orbit(guess, value)
        origin = self.chart(point)
        along = np.append(origin.coordinates(orbit.start), (value - point.value) / self.unit) @ way
        return Point(value, orbit), float(along)
