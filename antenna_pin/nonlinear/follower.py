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

    def by_parameter(self, chart: Chart, start: State, value: float) -> Array:
        """Return the derivative of the map over the parameter, (size,), per unit."""

        def at(s: float) -> Array:
            flow, period = self.family(value + s * self.unit)
            return chart.coordinates(flow.after(start, period))

        return slope(at, _STEPS).value

    def direction(self, point: Point, last: Array | None) -> Array:
        """Return the unit tangent of the branch, (size + 1,), on from the last one."""
        flow, _ = self.family(point.value)
        chart = Chart(flow.system, point.orbit.start)
        rows = np.column_stack(
            [
                point.orbit.tangent - np.eye(chart.size),
                self.by_parameter(chart, point.orbit.start, point.value),
            ]
        )
        way = np.linalg.svd(rows)[2][-1]
        if last is None or len(last) != len(way):
            return np.asarray(way if way[-1] >= 0.0 else -way)
        return np.asarray(way if way @ last >= 0.0 else -way)

    def correct(self, point: Point, way: Array, arc: float) -> Point:
        """Return the orbit an arc ahead, square to the direction there (Keller's pseudo-arclength)."""
        flow, _ = self.family(point.value)
        origin = Chart(flow.system, point.orbit.start)
        start, value = origin.state(arc * way[:-1]), point.value + float(arc * way[-1] * self.unit)
        last = math.inf
        for k in range(12):
            flow, period = self.family(value)
            chart = Chart(flow.system, start)
            miss = chart.coordinates(flow.after(start, period))
            before, last = last, float(np.linalg.norm(miss))
            if not last < before:
                break  # it does not come nearer: a shorter step may
            if last <= self.tolerance:
                return Point(value, orbit_at(flow, start, period, last, k, False))
            tangent = flow.tangent(start, period, chart, step=NEWTON_STEP)
            matrix = np.block(
                [
                    [
                        tangent.matrix - np.eye(chart.size),
                        self.by_parameter(chart, start, value)[:, None],
                    ],
                    [way[None, :]],
                ]
            )
            step = np.linalg.lstsq(matrix, np.append(-miss, 0.0), rcond=1e-12)[0]
            start, value = chart.state(step[:-1]), value + float(step[-1]) * self.unit
        raise NoOrbitError("branch: Newton's method does not come back onto it")
