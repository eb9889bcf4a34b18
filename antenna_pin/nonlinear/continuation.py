"""Periodic solutions over a parameter: a branch followed by its arclength, and what happens to it there."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.differences import slope
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.nonlinear.chart import Chart
from antenna_pin.nonlinear.flow import Flow
from antenna_pin.nonlinear.orbits import NEWTON_STEP, NoOrbitError, Orbit, orbit_at, periodic_orbit
from antenna_pin.state import State

__all__ = ["Bifurcation", "BifurcationKind", "Branch", "Family", "Point", "continued"]

Array = NDArray[np.float64]

BifurcationKind = Literal["fold", "flip", "neimark-sacker", "grazing"]
"""It turns back; its period doubles; a torus is born of it; a contact or an event of it comes or goes."""

_STEPS = (1e-3, 2e-4)  # of differences over a parameter, over its unit
_SHORTEST = 2.0**-10  # of an arc, over the first: there the branch is given up
_ROUNDS = 60  # of halving, where a bifurcation is located


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


class Bifurcation(NamedTuple):
    """What happens to a branch.

    Attributes:
        kind: Which.
        value: Of the parameter, where.
        doubt: Half of the interval that it is known to be in.
        after: Number of the point that it comes after.
    """

    kind: BifurcationKind
    value: float
    doubt: float
    after: int


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """A family of periodic solutions.

    Attributes:
        points: In their order along it.
        bifurcations: Likewise.
        message: Why it ends.
    """

    points: tuple[Point, ...]
    bifurcations: tuple[Bifurcation, ...]
    message: str


def _early(state: State, period: float) -> State:
    """Return a state of a periodic system as one of its first period: the same phase whatever the period."""
    time = math.fmod(state.time, period)
    return dataclasses.replace(state, time=time, reached=time)


class _Follower:
    """Follows a branch: orbits x of the map P(x, value) = x in coordinates, the parameter in its own unit."""

    def __init__(self, family: Family, unit: float, tolerance: float) -> None:
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
        start, value = origin.state(arc * way[:-1]), point.value + arc * way[-1] * self.unit
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


def _pairs(orbit: Orbit) -> list[tuple[complex, complex]]:
    """Return every two multipliers of an orbit."""
    return list(itertools.combinations(orbit.multipliers.tolist(), 2))


def _tests(orbit: Orbit) -> dict[BifurcationKind, float]:
    """Return numbers that pass zero where an orbit doubles its period, or sheds a torus."""
    products = [one * other - 1.0 for one, other in _pairs(orbit)]
    return {
        "flip": float(np.prod(orbit.multipliers + 1.0).real),
        "neimark-sacker": float(np.prod(products).real) if products else 1.0,
    }


def _is_torus(orbit: Orbit) -> bool:
    """Whether the pair of multipliers whose product is nearest to 1 is a complex one, not two real ones."""
    one, other = min(_pairs(orbit), key=lambda pair: abs(pair[0] * pair[1] - 1.0))
    return abs(one.imag) > 1e-9 and abs(one - other.conjugate()) < 1e-6 * abs(one)


def _located(
    follower: _Follower,
    one: Point,
    way: Array,
    beyond: float,
    passed: Callable[[Orbit | None], bool],
    precision: float,
) -> tuple[float, float]:
    """Return where from a point to a value of the parameter ``passed`` changes, and half of what is left.

    Orbits are looked for where the branch's direction at the point leads, which near a graze must be near.
    """
    low, high, known = one.value, beyond, one
    for _ in range(_ROUNDS):
        if abs(high - low) <= precision:
            break
        value = 0.5 * (low + high)
        chart = Chart(follower.family(known.value)[0].system, known.orbit.start)
        guess = chart.state(way[:-1] * ((value - known.value) / (way[-1] * follower.unit)))
        try:
            orbit: Orbit | None = follower.orbit(guess, value, iterations=4)
        except AntennaPinError:
            orbit = None
        if passed(orbit):
            high = value
        else:
            low = value
            known = known if orbit is None else Point(value, orbit)
    return 0.5 * (low + high), 0.5 * abs(high - low)


def _sign_of(kind: BifurcationKind, sign: float) -> Callable[[Orbit | None], bool]:
    return lambda orbit: orbit is None or math.copysign(1.0, _tests(orbit)[kind]) != sign


def _other_happenings(first: Orbit) -> Callable[[Orbit | None], bool]:
    return lambda orbit: orbit is None or orbit.onsets != first.onsets


def _between(
    follower: _Follower, points: list[Point], ways: list[Array], arc: float, precision: float
) -> list[Bifurcation]:
    """Return what happens between the last two points."""
    one, other = points[-2:]
    after = len(points) - 2
    if len(ways[-1]) == len(ways[-2]) and ways[-1][-1] * ways[-2][-1] < 0.0:
        # The parameter over the arc is a parabola there: its top, between the two directions.
        share = abs(ways[-2][-1]) / (abs(ways[-2][-1]) + abs(ways[-1][-1]))
        top = one.value + 0.5 * share * arc * ways[-2][-1] * follower.unit
        doubt = max(abs(top - one.value), abs(top - other.value))
        return [Bifurcation("fold", top, doubt, after)]
    if one.orbit.onsets != other.orbit.onsets:
        value, doubt = _located(follower, one, ways[-2], other.value, _other_happenings(one.orbit), precision)
        return [Bifurcation("grazing", value, doubt, after)]
    found: list[Bifurcation] = []
    before, behind = _tests(one.orbit), _tests(other.orbit)
    for kind in before:
        if len(one.orbit.multipliers) != len(other.orbit.multipliers) or before[kind] * behind[kind] >= 0.0:
            continue
        if kind == "neimark-sacker" and not _is_torus(one.orbit):
            continue  # two real ones whose product is 1: nothing happens
        sign = math.copysign(1.0, before[kind])
        value, doubt = _located(follower, one, ways[-2], other.value, _sign_of(kind, sign), precision)
        found.append(Bifurcation(kind, value, doubt, after))
    return found


def _at_its_end(
    follower: _Follower, points: list[Point], way: Array, arc: float, precision: float
) -> list[Bifurcation]:
    """Return the graze that a branch ends in, if it does: a little farther on, more happens or less."""
    last = points[-1]
    flow, _ = follower.family(last.value)
    ahead = last.value + arc * way[-1] * follower.unit
    try:
        farther, period = follower.family(ahead)
        went = farther.went(Chart(flow.system, last.orbit.start).state(arc * way[:-1]), period)
    except AntennaPinError:
        return []
    if (went.onsets, went.events) == last.orbit.onsets:
        return []
    value, doubt = _located(follower, last, way, ahead, _other_happenings(last.orbit), precision)
    return [Bifurcation("grazing", value, doubt, len(points) - 1)]


def continued(
    family: Family,
    guess: State,
    values: tuple[float, float],
    *,
    arc: float = 0.05,
    most: int = 200,
    tolerance: float = 1e-9,
    precision: float = 1e-7,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow a branch of periodic solutions over a parameter, round folds too (pseudo-arclength).

    Args:
        family: Flow and period of every value of the parameter. Systems that depend on time have the period
            of their drives, or a multiple.
        guess: A state near the orbit at the first value.
        values: First value of the parameter, and the one at which the branch has been followed far enough;
            it also ends where it comes back past the first one.
        arc: Length of its steps: of states in error scales, of the parameter over the whole range [-]. Steps
            are halved where Newton's method does not come back, and doubled where it comes back at once.
        most: Points at most.
        tolerance: As for :func:`periodic_orbit` [-].
        precision: To which bifurcations are located, over the range of the parameter [-].
        progress: Called with each point.

    Raises:
        NoOrbitError: There is no orbit near the guess at the first value.
    """
    begin, end = map(float, values)
    if begin == end or not (math.isfinite(begin) and math.isfinite(end)):
        raise InvalidParameterError("branch", "values", "two different, finite ones", values)
    for name, number in (("arc", arc), ("tolerance", tolerance), ("precision", precision)):
        if not (math.isfinite(number) and number > 0.0):
            raise InvalidParameterError("branch", name, "positive and finite", number)
    if most < 2:
        raise InvalidParameterError("branch", "most", "2 points or more", most)
    unit = end - begin
    follower = _Follower(functools.lru_cache(maxsize=64)(family), unit, tolerance)
    _, period = family(begin)
    points = [Point(begin, follower.orbit(_early(guess, period), begin))]
    ways = [follower.direction(points[0], None)]
    found: list[Bifurcation] = []
    message, step = f"{most} points were made", arc
    while len(points) < most:
        try:
            point = follower.correct(points[-1], ways[-1], step)
        except AntennaPinError as error:
            grazes = _at_its_end(follower, points, ways[-1], step, precision * abs(unit))
            if grazes:
                found += grazes
                message = f"it ends in a graze at {grazes[0].value:g}"
                break
            step *= 0.5
            if step < arc * _SHORTEST:
                message = f"no orbit farther than at {points[-1].value:g}: {error}"
                break
            continue
        points.append(point)
        ways.append(follower.direction(point, ways[-1]))
        found += _between(follower, points, ways, step, precision * abs(unit))
        if progress is not None:
            progress(point)
        share = (point.value - begin) / unit
        if not 0.0 <= share <= 1.0:
            message = "the range of the parameter was left"
            break
        if point.orbit.iterations <= 3:
            step = min(2.0 * step, 4.0 * arc)
    return Branch(tuple(points), tuple(found), message)
