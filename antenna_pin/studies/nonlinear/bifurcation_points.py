"""Bifurcation points located in a step along a branch: folds, crossings, flips, tori, grazes.

Test functions that pass zero at a bifurcation have the same sign at both ends if they pass zero twice. So a
step is also checked for turns of the parameter's cubic through both ends, for a parabola of the test
functions through a third orbit that approaches zero, and for the number of multipliers that left the unit
circle.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import KroghInterpolator
from scipy.optimize import brentq

from antenna_pin.base.arrays import Array, Complex
from antenna_pin.base.calculus import root_between
from antenna_pin.errors import AntennaPinError
from antenna_pin.studies.nonlinear.orbits import NoOrbitError, Orbit
from antenna_pin.studies.nonlinear.pseudo_arclength import BranchStepper, Node, Point

# --- orbits within a step, and points located among them ----------------------------------------------------

_ROUNDS = 60  # Number of halvings between two orbits, or of secants of a fold.
# Share of the bracket at which orbits about a crossing are computed, stages of refinement, and orbits through
# which the polynomial passes.
_SHARE, _STAGES, _THROUGH = 0.125, 5, 6


# Largest distance of an orbit from the cubic through its neighbours on the branch, over their distance.
_ASIDE = 0.1


Test = Callable[[NDArray[np.complex128]], float]
"""A number of an orbit's multipliers that passes zero where something happens to it."""


class Located(NamedTuple):
    """Location of a bifurcation in a step."""

    value: float  # value of the parameter
    doubt: float  # half of the interval around it
    along: float  # arc along the step


class BranchStep:
    """Step along a branch between two orbits, with the orbits computed between them.

    ``beside`` are orbits before the first and after the last, by their places.
    """

    def __init__(self, stepper: BranchStepper, begin: Node, last: Node, arc: float) -> None:
        self.stepper, self.first, self.last, self.arc = stepper, begin, last, arc
        self._points = {0.0: begin.point, arc: last.point}
        self._nodes = {0.0: begin, arc: last}
        self.beside: dict[float, Node] = {}

    def point(self, along: float) -> Point:
        """Return the orbit at a place of the step."""
        if along not in self._points:
            first, guess = self.first, self._between(along)
            point = self.stepper.correct(first.point, first.tangent, along, guess, guess is not None)
            if guess is not None:
                before, behind = self._about(along)
                if np.linalg.norm(self._place(point) - guess) > _ASIDE * (behind - before):
                    raise NoOrbitError("branch: Newton's method comes back onto another one")
            self._points[along] = point
        return self._points[along]

    def _place(self, point: Point) -> Array:
        """Return an orbit's coordinates about the first, and how far the parameter is from there."""
        origin, begin = self.stepper.chart(self.first.point), self.first.point.value
        return np.append(origin.coordinates(point.orbit.start), (point.value - begin) / self.stepper.unit)

    def _about(self, along: float) -> tuple[float, float]:
        """Return the nearest orbits with a regular direction on both sides of a place."""
        told = [one for one, node in self._nodes.items() if node.regular or one in (0.0, self.arc)]
        return max(one for one in told if one <= along), min(one for one in told if one > along)

    def _between(self, along: float) -> Array | None:
        """Return the point of the cubic through the nearest orbits and directions at a place.

        Where branches are close to one another it is nearer to this one than a straight extrapolation.
        """
        first, about, rows = self.first, self._about(along), []
        for node in (self._nodes[one] for one in about):
            if len(node.tangent) != len(first.tangent):
                return None
            way = self.stepper.transported(node.tangent, node.point, first.point)
            rows += [self._place(node.point), way / (way @ first.tangent)]
        place = np.asarray(KroghInterpolator(np.repeat(about, 2), np.array(rows))(along))
        return place + (along - place @ first.tangent) * first.tangent

    def node(self, along: float) -> Node:
        """Return the orbit at a place of the step, with the branch's direction."""
        if along not in self._nodes:
            self._nodes[along] = self.stepper.node(self.point(along), self.first)
        return self._nodes[along]

    def nodes(self) -> dict[float, Node]:
        """Return all orbits with a direction, adjacent ones too, by place."""
        return self.beside | self._nodes

    def nearest(self, along: float) -> Point:
        """Return the computed orbit nearest to a place."""
        return self._points[min(self._points, key=lambda one: abs(one - along))]

    def turns_at(self, along: float) -> bool:
        """Return whether the parameter turns back between the nearest orbits about a place."""
        before, behind = self._about(along)
        return bool(self.node(before).tangent[-1] * self.node(behind).tangent[-1] < 0.0)

    def slope(self, along: float) -> float:
        """Return the slope of the parameter over the place, in the parameter's unit.

        A step is measured along its initial direction, from which the branch has turned since.
        """
        node = self.node(along)
        ahead = self.stepper.transported(self.first.tangent, self.first.point, node.point)
        return float(node.tangent[-1]) / max(float(node.tangent @ ahead), 1e-3)


def locate_zero(step: BranchStep, test: Test, low: float, high: float, precision: float) -> Located:
    """Return the zero of a smooth test function of the multipliers between two places.

    By Brent's method along the branch, unless a fold is between. It ends within the precision on both sides,
    or at the zero: then the other side is unknown, and the error estimate is the effect of the multipliers'
    error.
    """
    known = {along: test(step.point(along).orbit.multipliers) for along in (low, high)}

    def at(along: float) -> float:
        if along not in known:
            known[along] = test(step.point(along).orbit.multipliers)
        return known[along]

    steepest = max(abs(step.slope(low)), abs(step.slope(high)), 1e-3)
    near = precision / (steepest * abs(step.stepper.unit))
    with contextlib.suppress(AntennaPinError):  # the information so far is final
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
    # The slope is that of the nearest orbit whose test function exceeds its error.
    off = _test_error(test, step.point(behind).orbit)
    rest = [one for one, found in known.items() if abs(found) > 4.0 * off]
    aside = min(rest, key=lambda one: abs(one - along)) if rest else low
    far = abs(step.point(aside).value - value)
    steep = abs(known[aside]) / far if far else 0.0
    doubt = left + (off / steep if steep else abs(step.point(high).value - step.point(low).value))
    return Located(value, max(doubt, 0.5 * precision), along)


def _test_error(test: Test, orbit: Orbit) -> float:
    """Return the error of a test function due to that of the multipliers."""
    values, doubt = orbit.multipliers, orbit.doubt
    ways = doubt * np.eye(len(values))
    return sum(abs(test(values + way) - test(values)) for way in ways)


def locate_fold(step: BranchStep, begin: float, end: float, precision: float) -> Located:
    """Return the fold between two places of a step: an orbit next to it.

    Orbits are computed between them, by regula falsi (Illinois) for the zero of the parameter's part of the
    branch's direction. The distance of the parameter to the fold is at most its slope times the rest of the
    step in which the slope changes its sign: this and the error of orbits are the error estimate.
    """
    low, high = begin, end
    weights, before = [1.0, 1.0], None
    ahead = step.node(begin).tangent[-1]
    for _ in range(_ROUNDS):
        nearest = min(low, high, key=lambda along: abs(step.slope(along)))
        doubt = abs(step.slope(nearest) * (high - low) * step.stepper.unit)
        if doubt <= precision:
            break
        one, other = weights[0] * step.node(low).tangent[-1], weights[1] * step.node(high).tangent[-1]
        along = float((low * other - high * one) / (other - one))
        try:
            on = bool(step.node(along).tangent[-1] * ahead > 0.0)
        except AntennaPinError:
            break  # the information of the two ends is final
        low, high = (along, high) if on else (low, along)
        # An end that is retained twice counts half (Illinois), or it would never move.
        replaced, stays = (0, 1) if on else (1, 0)
        weights[replaced] = 1.0
        weights[stays] *= 0.5 if before is on else 1.0
        before = on
    doubt += step.stepper.tolerance * abs(step.stepper.unit)
    return Located(step.point(nearest).value, doubt, nearest)


def locate_crossing(step: BranchStep, low: float, high: float, precision: float) -> Located:
    """Return the crossing of another branch between two places of a step.

    At a crossing Newton's method is singular: the effect of its tolerance grows with the inverse of the
    distance. So orbits are computed at decreasing distances, and polynomials through them give the zero of
    the determinant. The error estimate is the change by the last orbits, and the effect of the multipliers'
    error.
    """
    places = [low, high]
    found = best = _zero(step, places, 0.5 * (low + high))._replace(doubt=math.inf)
    width = high - low
    for _ in range(_STAGES):
        width *= _SHARE
        about = [along for along in (found.along - width, found.along + width) if low < along < high]
        for along in about:
            with contextlib.suppress(AntennaPinError):  # other information is final
                places += [along] if step.node(along).regular else []
        last, found = found, _zero(step, places, found.along)
        found = found._replace(doubt=max(abs(found.value - last.value), found.doubt))
        best = min(best, found, key=lambda one: one.doubt)
        if best.doubt <= precision:
            break
    return best._replace(doubt=min(best.doubt, abs(step.point(high).value - step.point(low).value)))


def _zero(step: BranchStep, places: Sequence[float], about: float) -> Located:
    """Return the zero of the polynomial through the crossing determinants nearest to a place.

    It uses those at which the sign changes, and their neighbours.
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
    # The error of the least singular value is that of the matrix, in itself and by the orbit's residual; the
    # relative error of the determinant is the same.
    off = max(
        abs(one.crossing) / one.margin * (one.point.orbit.doubt + one.point.orbit.residual / one.margin)
        for one in nodes[:2]
    )
    steep = abs(float(crossing.derivative(along)))
    return Located(float(value(along)), abs(float(value.derivative(along))) * off / steep, along)


# --- test functions, and hidden changes of sign -------------------------------------------------------------

# Places at which a step's cubic is evaluated; value of a parabola, over those at the ends, that needs no
# further orbit.
_PLACES = np.linspace(0.0, 1.0, 33)
_NEAR = 0.3
_ON = 1e-6  # distance from the unit circle within which a multiplier is on neither side


def _pairs(multipliers: Complex) -> list[tuple[complex, complex]]:
    """Return all pairs of an orbit's multipliers."""
    return list(itertools.combinations(multipliers.tolist(), 2))


def flip_test(multipliers: Complex) -> float:
    """Return the test function of period doubling, zero where a multiplier is -1.

    It is the product of all 1 + multiplier, each divided by the multiplier's size if above 1.
    """
    return float(np.prod((multipliers + 1.0) / np.maximum(np.abs(multipliers), 1.0)).real)


def torus_test(multipliers: Complex) -> float:
    """Return the test function of a torus, zero where two multipliers have the product 1.

    The same product with the products of two multipliers, minus 1.
    """
    products = [one * other for one, other in _pairs(multipliers)]
    return float(np.prod([(one - 1.0) / max(abs(one), 1.0) for one in products]).real) if products else 1.0


def is_torus(multipliers: Complex) -> bool:
    """Return whether the pair of multipliers with the product nearest to 1 is complex."""
    one, other = min(_pairs(multipliers), key=lambda pair: abs(pair[0] * pair[1] - 1.0))
    return abs(one.imag) > 1e-9 and abs(one - other.conjugate()) < 1e-6 * abs(one)


def hidden_change(step: BranchStep, low: float, high: float) -> float | None:
    """Return a place between two others that needs one more orbit, or None."""
    one, other = step.node(low), step.node(high)
    if len(one.tangent) != len(other.tangent) or one.point.orbit.onsets != other.point.orbit.onsets:
        return None
    middle = 0.5 * (low + high)
    turns = _hidden_turn(step, low, high)
    if turns is not None:
        return turns
    nodes = step.nodes()
    aside = [along for along in nodes if not low <= along <= high]
    if not aside:
        return middle
    third = min(aside, key=lambda along: abs(along - middle))
    for test in (flip_test, torus_test):
        values = [test(nodes[along].point.orbit.multipliers) for along in (low, high, third)]
        dips = _near_zero((low, high, third), values)
        if dips is not None:
            return dips
    return None if _counts_agree(one, other) else middle


def _hidden_turn(step: BranchStep, low: float, high: float) -> float | None:
    """Return a place near turns of the parameter that its end slopes do not imply."""
    one, other = step.slope(low), step.slope(high)
    rise = (step.point(high).value - step.point(low).value) / (step.stepper.unit * (high - low))
    u = _PLACES
    slopes = one * (1.0 - 4.0 * u + 3.0 * u**2) + other * (3.0 * u**2 - 2.0 * u) + 6.0 * rise * (u - u**2)
    if np.count_nonzero(np.diff(slopes > 0.0)) <= int((one > 0.0) != (other > 0.0)):
        return None
    far = float(u[1:-1][np.argmax(np.abs(slopes - one * (1.0 - u) - other * u)[1:-1])])
    return low + min(max(far, 0.25), 0.75) * (high - low)


def _near_zero(places: tuple[float, float, float], values: list[float]) -> float | None:
    """Return a place where a parabola through values of one sign comes near zero."""
    (low, high, _), (one, other, _) = places, values
    if (one > 0.0) != (other > 0.0):
        return None
    bend, slope, _ = np.polyfit(np.array(places) - low, values, 2)
    if bend == 0.0:
        return None
    turn = -0.5 * slope / bend
    least = one - bend * turn**2
    if not 0.0 < turn < high - low or least * np.sign(one) > _NEAR * min(abs(one), abs(other)):
        return None
    return low + float(np.clip(turn, 0.25 * (high - low), 0.75 * (high - low)))


def _counts_agree(one: Node, other: Node) -> bool:
    """Return whether the multipliers outside the unit circle agree with the test functions' signs."""
    outside = []
    for node in (one, other):
        orbit = node.point.orbit
        sizes = np.abs(orbit.multipliers) - 1.0
        if np.any(np.abs(sizes) <= max(orbit.doubt, _ON)):
            return True  # it is on neither side
        outside.append(int(np.count_nonzero(sizes > 0.0)))
    ends = [node.point.orbit.multipliers for node in (one, other)]
    if len(ends[0]) != len(ends[1]):
        return True
    real = [flip_test(ends[0]) > 0.0, one.tangent[-1] > 0.0, one.crossing > 0.0]
    then = [flip_test(ends[1]) > 0.0, other.tangent[-1] > 0.0, other.crossing > 0.0]
    ways: list[tuple[int, ...]] = [(-1, 1) for was, now in zip(real, then, strict=True) if was != now]
    ways += [(-2, 0, 2)] if (torus_test(ends[0]) > 0.0) != (torus_test(ends[1]) > 0.0) else []
    return outside[1] - outside[0] in {sum(each) for each in itertools.product(*ways)}


# --- grazing ------------------------------------------------------------------------------------------------

# Search ahead: ratio of successive places, their least and largest number, and bisections of the interval.
_DENSER, _LOOKS, _FARTHEST, _CLOSER = 0.7, 16, 100, 5
# Largest distance of the orbits on both sides of a graze, over the first one; and shrinkage of the interval
# required.
_JUMP, _SHRUNK = 0.1, 1e-2


class GrazeAhead(NamedTuple):
    """Change in the number of contacts or events ahead of an orbit."""

    arc: float  # arc ahead
    value: float  # value of the parameter there


def curved_predictor(stepper: BranchStepper, node: Node, arc: float, passed: BranchStep | None) -> Array:
    """Return a predicted place an arc ahead, with the curvature of the last step.

    Coordinates are about the orbit, then the distance of the parameter in its unit, (size + 1,).
    """
    point, way = node.point, node.tangent
    if passed is None or passed.last is not node or len(passed.first.tangent) != len(way):
        return arc * way
    bend = (way - stepper.transported(passed.first.tangent, passed.first.point, point)) / passed.arc
    # The component along the direction is the arc, as orbits are sought.
    return np.asarray(arc * way + 0.5 * arc**2 * (bend - (bend @ way) * way))


def graze_ahead(
    stepper: BranchStepper, node: Node, arc: float, passed: BranchStep | None
) -> GrazeAhead | None:
    """Return the nearest change in contacts or events ahead of an orbit, within an arc.

    Only runs are made, from orbits extrapolated to third order of the distance; the result is the more
    reliable, the nearer the orbit.
    """
    point, chart = node.point, stepper.chart(node.point)

    def other(s: float) -> bool | None:
        to = curved_predictor(stepper, node, s, passed)
        try:
            flow, period = stepper.family(point.value + float(to[-1]) * stepper.unit)
            went = flow.traverse(chart.state(to[:-1], flow.system), period)
        except AntennaPinError:
            return None
        return (went.onsets, went.events) != point.orbit.onsets

    fading = _fading_impact(stepper, node, passed)
    if fading is not None and fading <= arc and _changes_with_parameter(stepper, node, fading):
        to = curved_predictor(stepper, node, fading, passed)
        return GrazeAhead(fading, point.value + float(to[-1]) * stepper.unit)
    # Farther places may agree by accident: the nearest differing place counts.
    far, near, s, looks = 0.0, 0.0, arc, 0
    while looks < _LOOKS or (near == 0.0 and looks < _FARTHEST):
        found = other(s)
        if found:
            far, near = s, 0.0
        elif found is False and far and not near:
            near = s
        s, looks = _DENSER * s, looks + 1
    if not far:
        return None
    for _ in range(_CLOSER):
        middle = 0.5 * (near + far)
        near, far = (near, middle) if other(middle) else (middle, far)
    return GrazeAhead(
        far, point.value + float(curved_predictor(stepper, node, far, passed)[-1]) * stepper.unit
    )


def _fading_impact(stepper: BranchStepper, node: Node, passed: BranchStep | None) -> float | None:
    """Return the distance ahead at which an impact loses its speed, or None.

    Beyond it the extrapolated branch has the impact with the other sign, and runs still have it: no impact
    appears or disappears. But perturbed states reach an impact later by one over its speed, so that the
    inverse derivative of the map is proportional to the speed, and that to the distance along the branch.
    """
    if passed is None or passed.last is not node:
        return None
    one, other = (1.0 / float(np.linalg.norm(each.point.orbit.tangent)) for each in (passed.first, node))
    return passed.arc * other / (one - other) if other < one else None


def _changes_with_parameter(stepper: BranchStepper, node: Node, arc: float) -> bool:
    """Return whether contacts or events come or go with the parameter alone."""
    point = node.point
    for s in (arc, -arc, 0.1 * arc, -0.1 * arc):
        value = point.value + s * stepper.unit
        try:
            flow, period = stepper.family(value)
            start = stepper.chart(point).state(np.zeros(len(node.tangent) - 1), flow.system)
            went = flow.traverse(start, period)
        except AntennaPinError:
            continue
        if (went.onsets, went.events) != point.orbit.onsets:
            return True
    return False


class _Side(NamedTuple):
    """Last orbit on one side of a graze, with the branch's direction on that side."""

    point: Point
    node: Node


def _orbit_from(stepper: BranchStepper, side: _Side, value: float) -> Point | None:
    """Return the orbit at a value near one side of a graze, or None."""
    point, node = side
    ahead = (value - point.value) / (node.tangent[-1] * stepper.unit)
    try:
        way = stepper.transported(node.tangent, node.point, point)[:-1]
        guess = stepper.chart(point).state(ahead * way, stepper.family(value)[0].system)
        return Point(value, stepper.orbit(guess, value, iterations=4))
    except (AntennaPinError, ZeroDivisionError):
        return None


def locate_graze(stepper: BranchStepper, one: Node, other: Node, precision: float) -> tuple[float, float]:
    """Return the parameter of a graze between two orbits, and its error estimate.

    The interval is halved by orbits, searched from both sides. Orbits on both sides must converge to one
    another: one branch.
    """
    low, high = _Side(one.point, one), _Side(other.point, other)
    whole = abs(other.point.value - one.point.value)

    def left() -> float:
        return abs(high.point.value - low.point.value)

    for _ in range(_ROUNDS):
        if left() <= precision:
            break
        value = 0.5 * (low.point.value + high.point.value)
        between = _distance(stepper, low.point, high.point)
        found = None
        for side in (low, high):
            found = _orbit_from(stepper, side, value)
            if found is not None and _distance(stepper, side.point, found) <= between:
                break
            found = None
        if found is None:
            break
        if found.orbit.onsets == one.point.orbit.onsets:
            low = _Side(found, one)
        else:
            high = _Side(found, other)
    if left() > max(precision, _SHRUNK * whole):
        raise NoOrbitError("branch: a contact or an event comes or goes, and no orbit is found that near it")
    if _distance(stepper, low.point, high.point) > _JUMP * _distance(stepper, one.point, other.point):
        raise NoOrbitError("branch: where a contact or an event comes or goes it leaps onto another one")
    return 0.5 * (low.point.value + high.point.value), 0.5 * left()


def _distance(stepper: BranchStepper, one: Point, other: Point) -> float:
    """Return the distance between two orbits."""
    place = stepper.chart(one).coordinates(other.orbit.start)
    return math.hypot(float(np.linalg.norm(place)), (other.value - one.value) / stepper.unit)
