"""What happens to a branch of periodic solutions between two of its points, and where."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import AntennaPinError
from antenna_pin.nonlinear.follower import Follower, Point
from antenna_pin.nonlinear.orbits import Orbit

__all__ = ["Bifurcation", "BifurcationKind", "bifurcations_between", "graze_ahead"]

Array = NDArray[np.float64]

BifurcationKind = Literal["fold", "flip", "neimark-sacker", "grazing"]
"""It turns back; its period doubles; a torus is born of it; a contact or an event of it comes or goes."""

_ROUNDS = 60  # of halving, or of the secants of a fold, where a bifurcation is located


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
    follower: Follower,
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
        ahead = follower.turned(way, one, known)[:-1] * ((value - known.value) / (way[-1] * follower.unit))
        try:
            guess = follower.chart(known).state(ahead, follower.family(value)[0].system)
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


class _Onward(NamedTuple):
    """An orbit of a step along a branch: how far ``along`` it, and the parameter's part of the direction."""

    along: float
    point: Point
    part: float
    slope: float  # of the parameter over ``along``, in its unit

    @classmethod
    def at(cls, along: float, point: Point, ahead: Array, way: Array) -> _Onward:
        # A step is measured along the direction it began with, which the branch has turned from since.
        return cls(along, point, float(ahead[-1]), float(ahead[-1]) / max(float(ahead @ way), 1e-3))


def _fold(
    follower: Follower, points: list[Point], ways: list[Array], arc: float, precision: float
) -> tuple[float, float]:
    """Return where in the last step the parameter turns back, and by how much it may turn back elsewhere.

    Orbits are made at parts of the step, by regula falsi (Illinois) for where the parameter's part of the
    branch's direction is zero. From an orbit there the parameter goes on, to the fold, by no more than its
    slope times what is left of the step in which that changes its sign.
    """
    way = ways[-2]
    low = _Onward.at(0.0, points[-2], way, way)
    high = _Onward.at(arc, points[-1], ways[-1], follower.turned(way, points[-2], points[-1]))
    weights, before = [1.0, 1.0], None
    for _ in range(_ROUNDS):
        nearest = min(low, high, key=lambda one: abs(one.slope))
        doubt = abs(nearest.slope * (high.along - low.along) * follower.unit)
        if doubt <= precision:
            break
        one, other = weights[0] * low.part, weights[1] * high.part
        along = (low.along * other - high.along * one) / (other - one)
        try:
            point = follower.correct(points[-2], way, along)
        except AntennaPinError:
            break  # what the two ends say is all there is
        here = follower.turned(way, points[-2], point)
        found = _Onward.at(along, point, follower.direction(point, way, points[-2]), here)
        ahead = found.part * way[-1] > 0.0
        low, high = (found, high) if ahead else (low, found)
        # An end that stays once more counts half: or else it would stay for ever.
        replaced, stays = (0, 1) if ahead else (1, 0)
        weights[replaced] = 1.0
        weights[stays] *= 0.5 if before is ahead else 1.0
        before = ahead
    return nearest.point.value, doubt


def bifurcations_between(
    follower: Follower, points: list[Point], ways: list[Array], arc: float, precision: float
) -> list[Bifurcation]:
    """Return what happens between the last two points."""
    one, other = points[-2:]
    after = len(points) - 2
    if len(ways[-1]) == len(ways[-2]) and ways[-1][-1] * ways[-2][-1] < 0.0:
        value, doubt = _fold(follower, points, ways, arc, precision)
        return [Bifurcation("fold", value, doubt, after)]
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


def graze_ahead(
    follower: Follower, points: list[Point], way: Array, arc: float, precision: float
) -> list[Bifurcation]:
    """Return the graze that a branch ends in, if it does: a little farther on, more happens or less."""
    last = points[-1]
    ahead = last.value + arc * way[-1] * follower.unit
    try:
        farther, period = follower.family(ahead)
        went = farther.went(follower.chart(last).state(arc * way[:-1], farther.system), period)
    except AntennaPinError:
        return []
    if (went.onsets, went.events) == last.orbit.onsets:
        return []
    value, doubt = _located(follower, last, way, ahead, _other_happenings(last.orbit), precision)
    return [Bifurcation("grazing", value, doubt, len(points) - 1)]
