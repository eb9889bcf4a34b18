"""Where in one step along a branch of periodic solutions something happens to it."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import KroghInterpolator
from scipy.optimize import brentq

from antenna_pin.base.roots import root_between
from antenna_pin.errors import AntennaPinError
from antenna_pin.nonlinear.follower import Follower, Node, Point
from antenna_pin.nonlinear.orbits import NoOrbitError, Orbit

__all__ = ["Located", "Step", "Test", "where_crossed", "where_turned", "where_zero"]

Array = NDArray[np.float64]

_ROUNDS = 60  # of halving, or of the secants of a fold
# Orbits about a crossing are made at this share of where it may be, then at this share of that, so often; a
# polynomial goes through so many of them.
_SHARE, _STAGES, _THROUGH = 0.125, 5, 6


# How far an orbit between others may be from the cubic through them, over how far they are from one another.
_ASIDE = 0.1


Test = Callable[[NDArray[np.complex128]], float]
"""A number of an orbit's multipliers that passes zero where something happens to it."""


class Located(NamedTuple):
    """Where something happens.

    Attributes:
        value: Of the parameter.
        doubt: Half of the interval that it is known to be in.
        along: How far along the step.
    """

    value: float
    doubt: float
    along: float


class Step:
    """A step along a branch, from one orbit to the next, and the orbits between.

    Args:
        follower: Of the branch.
        first: What it begins with; how far along is measured in the direction there.
        last: What it comes to.
        arc: How far that is.

    Attributes:
        beside: Orbits before its first and behind its last, by how far along they would be.
    """

    def __init__(self, follower: Follower, first: Node, last: Node, arc: float) -> None:
        """Know both ends."""
        self.follower, self.first, self.last, self.arc = follower, first, last, arc
        self._points = {0.0: first.point, arc: last.point}
        self._nodes = {0.0: first, arc: last}
        self.beside: dict[float, Node] = {}

    def point(self, along: float) -> Point:
        """Return the orbit so far along.

        Raises:
            AntennaPinError: Newton's method finds none.
        """
        if along not in self._points:
            first, guess = self.first, self._between(along)
            point = self.follower.correct(first.point, first.way, along, guess, guess is not None)
            if guess is not None:
                before, behind = self._about(along)
                if np.linalg.norm(self._place(point) - guess) > _ASIDE * (behind - before):
                    raise NoOrbitError("branch: Newton's method comes back onto another one")
            self._points[along] = point
        return self._points[along]

    def _place(self, point: Point) -> Array:
        """Return an orbit's coordinates about the first, and how far the parameter is from there."""
        origin, begin = self.follower.chart(self.first.point), self.first.point.value
        return np.append(origin.coordinates(point.orbit.start), (point.value - begin) / self.follower.unit)

    def _about(self, along: float) -> tuple[float, float]:
        """Return the next orbits on both sides of a place at which the branch's direction is told."""
        told = [one for one, node in self._nodes.items() if node.told or one in (0.0, self.arc)]
        return max(one for one in told if one <= along), min(one for one in told if one > along)

    def _between(self, along: float) -> Array | None:
        """Return where the cubic through the next orbits with their directions is so far along.

        Where branches are close to one another it is nearer to this one than what is straight ahead.
        """
        first, about, rows = self.first, self._about(along), []
        for node in (self._nodes[one] for one in about):
            if len(node.way) != len(first.way):
                return None
            way = self.follower.turned(node.way, node.point, first.point)
            rows += [self._place(node.point), way / (way @ first.way)]
        place = np.asarray(KroghInterpolator(np.repeat(about, 2), np.array(rows))(along))
        return place + (along - place @ first.way) * first.way

    def node(self, along: float) -> Node:
        """Return the orbit so far along, and the branch's direction at it."""
        if along not in self._nodes:
            self._nodes[along] = self.follower.node(self.point(along), self.first)
        return self._nodes[along]

    def nodes(self) -> dict[float, Node]:
        """Return the orbits at which the branch's direction is known, those beside it too, by place."""
        return self.beside | self._nodes

    def nearest(self, along: float) -> Point:
        """Return that of the orbits that have been made which is nearest to a place."""
        return self._points[min(self._points, key=lambda one: abs(one - along))]

    def turns_at(self, along: float) -> bool:
        """Whether the parameter turns back between the next orbits on both sides of a place."""
        before, behind = self._about(along)
        return bool(self.node(before).way[-1] * self.node(behind).way[-1] < 0.0)

    def slope(self, along: float) -> float:
        """Return the slope of the parameter over how far along, in the parameter's unit.

        A step is measured along the direction it began with, which the branch has turned from since.
        """
        node = self.node(along)
        ahead = self.follower.turned(self.first.way, self.first.point, node.point)
        return float(node.way[-1]) / max(float(node.way @ ahead), 1e-3)


def where_zero(step: Step, test: Test, low: float, high: float, precision: float) -> Located:
    """Return where between two places of a step a number of the multipliers, which is smooth, passes zero.

    By Brent's method along the branch, where no fold is in the way. It ends within the precision on both
    sides, or upon the zero: of that no other side is known, and what is in doubt is by how much the number
    would be another, had the multipliers been wrong by their doubt.
    """
    known = {along: test(step.point(along).orbit.multipliers) for along in (low, high)}

    def at(along: float) -> float:
        if along not in known:
            known[along] = test(step.point(along).orbit.multipliers)
        return known[along]

    steepest = max(abs(step.slope(low)), abs(step.slope(high)), 1e-3)
    near = precision / (steepest * abs(step.follower.unit))
    with contextlib.suppress(AntennaPinError):  # what is known by then is all there is
        brentq(at, low, high, xtol=0.5 * near, rtol=1e-14)
    upon = [along for along, found in known.items() if found == 0.0]
    before = max(along for along, found in known.items() if (found > 0.0) == (known[low] > 0.0))
    behind = min(along for along in known if along > before)
    if upon:
        behind = upon[0]
        value, along, left = step.point(behind).value, behind, 0.0
    else:
        one, other = step.point(before).value, step.point(behind).value
        value, along, left = 0.5 * (one + other), 0.5 * (before + behind), 0.5 * abs(other - one)
    # The nearest orbit at which the number is more than what it may be off by says how steep it is.
    off = _off(test, step.point(behind).orbit)
    rest = [one for one, found in known.items() if abs(found) > 4.0 * off]
    aside = min(rest, key=lambda one: abs(one - along)) if rest else low
    far = abs(step.point(aside).value - value)
    steep = abs(known[aside]) / far if far else 0.0
    doubt = left + (off / steep if steep else abs(step.point(high).value - step.point(low).value))
    return Located(value, max(doubt, 0.5 * precision), along)


def _off(test: Test, orbit: Orbit) -> float:
    """Return by how much a number of multipliers may be wrong, as these are."""
    values, doubt = orbit.multipliers, orbit.doubt
    ways = doubt * np.eye(len(values))
    return sum(abs(test(values + way) - test(values)) for way in ways)


def where_turned(step: Step, begin: float, end: float, precision: float) -> Located:
    """Return where between two places of a step the parameter turns back: an orbit next to it.

    Orbits are made between them, by regula falsi (Illinois) for where the parameter's part of the
    branch's direction is zero. From an orbit there the parameter goes on, to the fold, by no more than its
    slope times what is left of the step in which that changes its sign: this is the doubt, and what orbits
    are in doubt by.
    """
    low, high = begin, end
    weights, before = [1.0, 1.0], None
    ahead = step.node(begin).way[-1]
    for _ in range(_ROUNDS):
        nearest = min(low, high, key=lambda along: abs(step.slope(along)))
        doubt = abs(step.slope(nearest) * (high - low) * step.follower.unit)
        if doubt <= precision:
            break
        one, other = weights[0] * step.node(low).way[-1], weights[1] * step.node(high).way[-1]
        along = float((low * other - high * one) / (other - one))
        try:
            on = bool(step.node(along).way[-1] * ahead > 0.0)
        except AntennaPinError:
            break  # what the two ends say is all there is
        low, high = (along, high) if on else (low, along)
        # An end that stays once more counts half: or else it would stay for ever.
        replaced, stays = (0, 1) if on else (1, 0)
        weights[replaced] = 1.0
        weights[stays] *= 0.5 if before is on else 1.0
        before = on
    doubt += step.follower.tolerance * abs(step.follower.unit)
    return Located(step.point(nearest).value, doubt, nearest)


def where_crossed(step: Step, low: float, high: float, precision: float) -> Located:
    """Return where between two places of a step another branch crosses.

    There Newton's method has no direction to go back by: what its tolerance leaves grows like one over the
    distance. So orbits are made about the place, not at it, nearer and nearer, and polynomials through them
    say where the determinant that is zero there is so. The doubt is by how much the last orbits moved that,
    and what multipliers are doubted by.
    """
    places = [low, high]
    found = best = _zero(step, places, 0.5 * (low + high))._replace(doubt=math.inf)
    width = high - low
    for _ in range(_STAGES):
        width *= _SHARE
        about = [along for along in (found.along - width, found.along + width) if low < along < high]
        for along in about:
            with contextlib.suppress(AntennaPinError):  # what else is known is all there is
                places += [along] if step.node(along).told else []
        last, found = found, _zero(step, places, found.along)
        found = found._replace(doubt=max(abs(found.value - last.value), found.doubt))
        best = min(best, found, key=lambda one: one.doubt)
        if best.doubt <= precision:
            break
    return best._replace(doubt=min(best.doubt, abs(step.point(high).value - step.point(low).value)))


def _zero(step: Step, places: Sequence[float], about: float) -> Located:
    """Return where the polynomial through what a step's orbits at some places have is zero, near one of them.

    Through those at which the sign changes, and those next to it.
    """
    places = sorted(places)
    signs = [step.node(along).crossing > 0.0 for along in places]
    changes = [
        pair for pair, (one, other) in zip(pairwise(places), pairwise(signs), strict=True) if one != other
    ]
    low, high = min(changes, key=lambda pair: abs(0.5 * (pair[0] + pair[1]) - about))
    rest = sorted(
        (along for along in places if not low <= along <= high), key=lambda along: abs(along - about)
    )
    through = np.array([low, high, *rest[: _THROUGH - 2]])
    nodes = [step.node(along) for along in through]
    crossing = KroghInterpolator(through, [one.crossing for one in nodes])
    value = KroghInterpolator(through, [one.point.value for one in nodes])
    ends = nodes[0].crossing, nodes[1].crossing
    along = root_between(
        lambda s: float(crossing(s)), low, high, absolute=1e-15 * step.arc, relative=1e-14, ends=ends
    )
    # The least singular value is wrong by what the matrix is, in itself and as the orbit is beside the true
    # one, the determinant by as large a part of itself.
    off = max(
        abs(one.crossing) / one.margin * (one.point.orbit.doubt + one.point.orbit.residual / one.margin)
        for one in nodes[:2]
    )
    steep = abs(float(crossing.derivative(along)))
    return Located(float(value(along)), abs(float(value.derivative(along))) * off / steep, along)
