"""One step along a branch of periodic solutions: where it leads, and the orbit an arc ahead."""

from __future__ import annotations

import math
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.differences import slope
from antenna_pin.nonlinear.chart import Chart
from antenna_pin.nonlinear.flow import Flow
from antenna_pin.nonlinear.orbits import NEWTON_STEP, NoOrbitError, Orbit, orbit_at, periodic_orbit
from antenna_pin.state import State

__all__ = ["Family", "Follower", "Point"]

Array = NDArray[np.float64]

_STEPS = (1e-3, 2e-4)  # of differences over a parameter, over its unit


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
                return Point(value, orbit_at(flow, start, period, last, k, False))
            tangent = flow.tangent(start, period, chart, step=NEWTON_STEP)
            square = np.append(chart.turned(way[:-1], origin), way[-1])
            rows = np.column_stack([tangent.matrix - np.eye(chart.size), self.by_parameter(chart, value)])
            step = np.linalg.lstsq(np.vstack([rows, square]), np.append(-miss, 0.0), rcond=1e-12)[0]
            value += float(step[-1]) * self.unit
            flow, period = self.family(value)
            start = chart.state(step[:-1], flow.system)
        raise NoOrbitError("branch: Newton's method does not come back onto it")
