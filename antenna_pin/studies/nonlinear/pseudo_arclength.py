"""Predictor and corrector of one step along a branch of periodic orbits."""

from __future__ import annotations

import dataclasses
import itertools
import math
from typing import NamedTuple, Protocol

import numpy as np
from scipy.optimize import brentq

from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import slope
from antenna_pin.base.state import State
from antenna_pin.studies.nonlinear.chart import Chart
from antenna_pin.studies.nonlinear.flow import Flow
from antenna_pin.studies.nonlinear.orbits import (
    NoOrbitError,
    Orbit,
    changing_coordinates,
    evaluate_orbit,
    periodic_orbit,
)

# Difference steps over a parameter, in its unit: the small ones serve near a graze.
_STEPS = (1e-3, 2e-4, 4e-5, 8e-6, 1.6e-6)
_NEWTON_STEP = 1e-6  # of those that Newton's method steps by: what counts is where it ends
_LEADS = 0.05  # of a direction's length, the parameter's part with which differences are made along it
_SINGULAR = 1e-6  # least singular values over the largest that are none
# Cosines of the largest turn in a step, of the chord to the directions at its ends, and of the chord at a
# corner.
_TURN, _ASIDE, _CORNER = 0.9, 0.99, 0.1
_NEAR = 2e-2  # of an arc: how near to an end of the range Newton's method begins there


class SolutionFamily(Protocol):
    """A flow and its period for every value of a parameter."""

    def __call__(self, value: float) -> tuple[Flow, float]:
        """Return the flow at a value, and the period of its orbits [s]."""


class Point(NamedTuple):
    """An orbit of a branch."""

    value: float  # of the parameter
    orbit: Orbit  # the orbit


def in_first_period(state: State, period: float) -> State:
    """Return a state with its time reduced to the first period."""
    time = math.fmod(state.time, period)
    return dataclasses.replace(state, time=time, reached=time)


class Node(NamedTuple):
    """Orbit of a branch, with the branch's direction."""

    point: Point  # the orbit
    tangent: Array  # unit tangent of the branch, (size + 1,): coordinates, and the parameter in its unit
    # determinant of the map's derivatives less 1 over way, bordered by that: on along a branch it passes zero
    # where another branch crosses, and not where the branch turns back
    crossing: float
    margin: float  # least singular value of that matrix [-]
    regular: bool  # whether that is above doubt, so that the determinant has a sign and the tangent is one


class _Corrected(NamedTuple):
    """Result of the corrector: parameter value, start of the orbit, residual, iterations."""

    value: float
    start: State
    residual: float
    iterations: int


class BranchStepper:
    """Predictor and corrector of a branch: orbits x of the map P(x, value) = x."""

    def __init__(self, family: SolutionFamily, unit: float, tolerance: float) -> None:
        self.family, self.unit, self.tolerance = family, unit, tolerance

    def orbit(self, guess: State, value: float, iterations: int = 12) -> Orbit:
        """Return the orbit at a value of the parameter."""
        flow, period = self.family(value)
        return periodic_orbit(flow, guess, period, tolerance=self.tolerance, iterations=iterations)

    def chart(self, point: Point) -> Chart:
        """Return the coordinates about an orbit's start."""
        return Chart(self.family(point.value)[0].system, point.orbit.start)

    def transported(self, way: Array, of: Point, at: Point) -> Array:
        """Return a direction at one point of a branch, (size + 1,), at another point."""
        return np.append(self.chart(at).transported(way[:-1], self.chart(of)), way[-1])

    def parameter_derivative(
        self, chart: Chart, value: float, matrix: Array, way: Array | None, step: float | None = None
    ) -> Array:
        """Return the derivative of the map over the parameter, (size,), per unit, at the origin.

        By differences of second order of a step, or, without one, of sixth order: along the branch, less what
        the state's part of that does. Of a state that stays, an impact that is about to go would be gone at
        a change of the parameter that is as small as the square of its speed.

        Where closures or motions move with the parameter, the start is brought onto them across the
        coordinates, which so are those of the origin still: of all that moves only the end counts.

        The branch leads along ``way``, (size + 1,), if that is known; the step is over the parameter's unit.
        """
        along = np.append(np.zeros(chart.size), 1.0)
        if way is not None and abs(way[-1]) > _LEADS:
            along = way

        def at(s: float) -> Array:
            flow, period = self.family(value + s * float(along[-1]) * self.unit)
            return chart.coordinates(flow.after(chart.state(s * along[:-1], flow.system), period))

        whole = slope(at, _STEPS).value if step is None else (at(step) - at(-step)) / (2.0 * step)
        return np.asarray((whole - matrix @ along[:-1]) / along[-1])

    def node(self, point: Point, last: Node | None) -> Node:
        """Return an orbit with the branch's unit tangent, oriented by the orbit before."""
        chart = self.chart(point)
        tangent = point.orbit.tangent
        here = None
        if last is not None and len(last.tangent) == chart.size + 1:
            here = self.transported(last.tangent, last.point, point)
        over = self.parameter_derivative(chart, point.value, tangent, here)
        rows = np.column_stack([tangent - np.eye(chart.size), over])
        # The memory of a lasting contact is constant: orbits come in families of it.
        free = np.append(changing_coordinates(chart, tangent), True)
        matrix = rows[np.ix_(free[:-1], free)]
        sizes, basis = np.linalg.svd(matrix)[1:]
        before = None if here is None else here[free]
        way = basis[-1]
        if before is not None and len(sizes) and sizes[-1] < _SINGULAR * sizes[0]:
            # At a crossing a plane is tangent: the branch continues in its own direction.
            left = basis[np.append(sizes < _SINGULAR * sizes[0], True)]
            ahead = left.T @ (left @ before)
            way = ahead / np.linalg.norm(ahead) if np.linalg.norm(ahead) > 0.5 else way
        sign = way[-1] if before is None else way @ before
        whole = np.zeros(len(free))
        whole[free] = way if sign >= 0.0 else -way
        square = np.vstack([matrix, whole[free]])
        margin = float(np.linalg.svd(square, compute_uv=False)[-1])
        told = margin > max(10.0 * point.orbit.doubt, _SINGULAR)
        return Node(point, whole, float(np.linalg.det(square)), margin, told)

    def is_smooth(self, one: Node, other: Node, corner: bool = False) -> bool:
        """Return whether directions allow the next orbit on the same branch.

        They turn little, and their chord lies half way between them, to the turn's second order. An orbit of
        a branch that crosses this one is aside.

        At a ``corner``, as at a graze, of less than a right angle, what is farther away than the step is long
        is another branch.
        """
        if len(one.tangent) != len(other.tangent):
            return True
        first = one.point
        place = self.chart(first).coordinates(other.point.orbit.start)
        chord = np.append(place, (other.point.value - first.value) / self.unit)
        if corner:
            return bool(one.tangent @ chord >= _CORNER * np.linalg.norm(chord))
        way = self.transported(other.tangent, other.point, first)
        half = (one.tangent + way) @ chord / (np.linalg.norm(one.tangent + way) * np.linalg.norm(chord))
        return bool(one.tangent @ way >= _TURN and half >= _ASIDE)

    def away_from_events(self, node: Node) -> Node | None:
        """Return the orbit started far from onsets, releases and events, or None.

        That is the middle of the longest time between them, free of contact if there is such; None where
        the orbit's own start is about as good. The branch's direction is carried there by the flow.
        """
        point = node.point
        flow, period = self.family(point.value)
        start = point.orbit.start
        went = flow.traverse(start, period)
        phases = [t - start.time for t in went.changes]
        if not phases:
            return None
        spans = [(one - start.time, other - start.time) for one, other in went.touching]

        def touching(phase: float) -> int:
            return sum(one < phase < other for one, other in spans)

        gaps = []
        for one, other in itertools.pairwise([*phases, phases[0] + period]):
            middle = math.fmod(0.5 * (one + other), period)
            gaps.append((touching(middle), one - other, middle))
        fewest, length, phase = min(gaps)
        near = min(min(abs(t - s) for s in (0.0, period)) for t in phases)
        if touching(0.0) == fewest and near >= -0.25 * length:
            return None
        there = Point(point.value, self.orbit(in_first_period(flow.after(start, phase), period), point.value))
        here, chart = self.chart(point), self.chart(there)

        def carried(s: float) -> Array:
            other, _ = self.family(point.value + s * node.tangent[-1] * self.unit)
            return chart.coordinates(other.after(here.state(s * node.tangent[:-1], other.system), phase))

        way = np.append(slope(carried, _STEPS).value, node.tangent[-1])
        return self.node(there, node._replace(point=there, tangent=way / np.linalg.norm(way)))

    def correct(
        self, point: Point, way: Array, arc: float, guess: Array | None = None, twice: bool = False
    ) -> Point:
        """Return the orbit an arc ahead, square to the direction (Keller's pseudo-arclength).

        The guess, (size + 1,), straight ahead by default, is of coordinates about the point and the distance
        of the parameter in its unit; ``twice`` is for one more step of Newton's method than necessary.
        """
        found = self._solve(point, way, arc, guess, twice)
        flow, period = self.family(found.value)
        return Point(
            found.value, evaluate_orbit(flow, found.start, period, found.residual, found.iterations, False)
        )

    def _solve(
        self, point: Point, way: Array, arc: float, guess: Array | None = None, twice: bool = False
    ) -> _Corrected:
        origin = self.chart(point)
        place = arc * way if guess is None else guess
        value = point.value + float(place[-1] * self.unit)
        flow, period = self.family(value)
        start = origin.state(place[:-1], flow.system)
        last, good = math.inf, None
        for k in range(12):
            chart = Chart(flow.system, start)
            miss = chart.coordinates(flow.after(start, period))
            before, last = last, float(np.linalg.norm(miss))
            if not last < before:
                break  # it does not come nearer: a shorter step may
            if last <= self.tolerance:
                enough = not twice or good is not None
                good = _Corrected(value, start, last, k)
                if enough:
                    break
            tangent = flow.tangent(start, period, chart)
            square = np.append(chart.transported(way[:-1], origin), way[-1])
            over = self.parameter_derivative(chart, value, tangent.matrix, square, _NEWTON_STEP)
            rows = np.column_stack([tangent.matrix - np.eye(chart.size), over])
            matrix = np.vstack([rows, square])
            matrix[:, :-1][:, ~changing_coordinates(chart, tangent.matrix)] = 0.0
            step = np.linalg.lstsq(matrix, np.append(-miss, 0.0), rcond=1e-12)[0]
            value += float(step[-1]) * self.unit
            flow, period = self.family(value)
            start = chart.state(step[:-1], flow.system)
        if good is None:
            raise NoOrbitError("branch: Newton's method does not come back onto it")
        return good

    def orbit_ahead(self, node: Node, value: float) -> tuple[Point, float]:
        """Return the orbit at a value straight ahead of another, and the arc to it."""
        point, way = node.point, node.tangent
        ahead = (value - point.value) / (way[-1] * self.unit)
        origin = self.chart(point)
        guess = origin.state(ahead * way[:-1], self.family(value)[0].system)
        return self._at(point, way, self.orbit(guess, value, iterations=4), value)

    def _at(self, point: Point, way: Array, orbit: Orbit, value: float) -> tuple[Point, float]:
        """Return an orbit at a value, and its distance along a direction at a point."""
        place = self.chart(point).coordinates(orbit.start)
        along = np.append(place, (value - point.value) / self.unit) @ way
        return Point(value, orbit), float(along)

    def orbit_at_bound(
        self, point: Point, way: Array, arc: float, beyond: Point, value: float
    ) -> tuple[Point, float]:
        """Return the orbit at a value that a step passes, and the arc to it.

        Along the arc, where the branch cannot be mistaken for another, until it is near; from there by
        Newton's method at the value itself.
        """
        known = {arc: beyond.value}

        def off(s: float) -> float:
            if s not in known:
                known[s] = self._solve(point, way, s).value if s else point.value
            return known[s] - value

        # A step may begin at the value and return to it.
        first = 0.0 if point.value != value else _NEAR * arc
        if off(first) * off(arc) > 0.0:
            raise NoOrbitError("branch: Newton's method does not come back onto it")
        near = float(brentq(off, first, arc, xtol=_NEAR * arc, rtol=1e-12))
        found = self._solve(point, way, near)
        here = Chart(self.family(found.value)[0].system, found.start)
        guess = here.state(np.zeros(here.size), self.family(value)[0].system)
        return self._at(point, way, self.orbit(guess, value), value)
