"""Where contacts or events of a branch of periodic solutions come or go: ahead of an orbit, between two."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import AntennaPinError
from antenna_pin.nonlinear.follower import Follower, Node, Point
from antenna_pin.nonlinear.locate import Step
from antenna_pin.nonlinear.orbits import NoOrbitError

__all__ = ["Ahead", "bent", "change_ahead", "where_passed"]

Array = NDArray[np.float64]

# Of looking ahead: each place over the one before it, how many there are at least, and at most as long as
# all is different there; and halvings of what is left then.
_DENSER, _LOOKS, _FARTHEST, _CLOSER = 0.7, 16, 100, 5
_ROUNDS = 60  # of halving between two orbits
# Distance of the orbits on both sides of where a branch passes a graze, over that of those it began with; and
# by how much the interval between them must have shrunk to say so.
_JUMP, _SHRUNK = 0.1, 1e-2


class Ahead(NamedTuple):
    """Where, ahead of an orbit, runs of a period have more contacts or events, or fewer.

    Attributes:
        arc: How far ahead.
        value: Of the parameter there.
    """

    arc: float
    value: float


def bent(follower: Follower, node: Node, arc: float, passed: Step | None) -> Array:
    """Return a place an arc ahead of an orbit, if the branch goes on to bend as it did in a step to it.

    Returns:
        Coordinates about the orbit, and how far the parameter is from there in its unit, (size + 1,).
    """
    point, way = node.point, node.way
    if passed is None or passed.last is not node or len(passed.first.way) != len(way):
        return arc * way
    bend = (way - follower.turned(passed.first.way, passed.first.point, point)) / passed.arc
    # What is along the way is so far ahead, as orbits are looked for.
    return np.asarray(arc * way + 0.5 * arc**2 * (bend - (bend @ way) * way))


def change_ahead(follower: Follower, node: Node, arc: float, passed: Step | None) -> Ahead | None:
    """Return where ahead of an orbit, an arc at most, contacts or events come or go.

    No orbits are made, only runs from where they would be if the branch went on as it does, to the third
    order of the distance: so this says how far it is worth to go, and the nearer an orbit is the better it
    does.

    Args:
        follower: Of the branch.
        node: The orbit.
        arc: How far to look.
        passed: The step that has come to it, which says how the branch bends; None if there is none.
    """
    point, chart = node.point, follower.chart(node.point)

    def other(s: float) -> bool | None:
        to = bent(follower, node, s, passed)
        try:
            flow, period = follower.family(point.value + float(to[-1]) * follower.unit)
            went = flow.went(chart.state(to[:-1], flow.system), period)
        except AntennaPinError:
            return None
        return (went.onsets, went.events) != point.orbit.onsets

    fading = _fading(follower, node, passed)
    if fading is not None and fading <= arc and _stirred(follower, node, fading):
        to = bent(follower, node, fading, passed)
        return Ahead(fading, point.value + float(to[-1]) * follower.unit)
    # What is farther may be as it was by accident: the first place at which it is not counts.
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
    return Ahead(far, point.value + float(bent(follower, node, far, passed)[-1]) * follower.unit)


def _fading(follower: Follower, node: Node, passed: Step | None) -> float | None:
    """Return how far ahead of an orbit an impact comes to have no speed, if derivatives say that one does.

    On from there the branch would have it with the other sign, and runs along it have it still: none comes or
    goes. But neighbours come later to an impact by one over its speed, so that one over the derivative of the
    map goes with the speed, and that with the way along the branch.
    """
    if passed is None or passed.last is not node:
        return None
    one, other = (1.0 / float(np.linalg.norm(each.point.orbit.tangent)) for each in (passed.first, node))
    return passed.arc * other / (one - other) if other < one else None


def _stirred(follower: Follower, node: Node, arc: float) -> bool:
    """Whether contacts or events come or go if only the parameter changes, by as much or less."""
    point = node.point
    for s in (arc, -arc, 0.1 * arc, -0.1 * arc):
        value = point.value + s * follower.unit
        try:
            flow, period = follower.family(value)
            start = follower.chart(point).state(np.zeros(len(node.way) - 1), flow.system)
            went = flow.went(start, period)
        except AntennaPinError:
            continue
        if (went.onsets, went.events) != point.orbit.onsets:
            return True
    return False


class _Side(NamedTuple):
    """The last orbit on one side of a graze, and the branch's direction that is known on that side."""

    point: Point
    node: Node


def _orbit_from(follower: Follower, side: _Side, value: float) -> Point | None:
    """Return the orbit at a value that is near to one on one side of a graze, if Newton's method finds it."""
    point, node = side
    ahead = (value - point.value) / (node.way[-1] * follower.unit)
    try:
        way = follower.turned(node.way, node.point, point)[:-1]
        guess = follower.chart(point).state(ahead * way, follower.family(value)[0].system)
        return Point(value, follower.orbit(guess, value, iterations=4))
    except (AntennaPinError, ZeroDivisionError):
        return None


def where_passed(follower: Follower, one: Node, other: Node, precision: float) -> tuple[float, float]:
    """Return where between two orbits of a branch contacts or events come or go, and half of what is left.

    The interval is halved by orbits, which are looked for from both sides. What comes of it must be one
    branch: orbits on both sides come to one another.

    Raises:
        NoOrbitError: They do not, or there are none.
    """
    low, high = _Side(one.point, one), _Side(other.point, other)
    whole = abs(other.point.value - one.point.value)

    def left() -> float:
        return abs(high.point.value - low.point.value)

    for _ in range(_ROUNDS):
        if left() <= precision:
            break
        value = 0.5 * (low.point.value + high.point.value)
        between = _apart(follower, low.point, high.point)
        found = None
        for side in (low, high):
            found = _orbit_from(follower, side, value)
            if found is not None and _apart(follower, side.point, found) <= between:
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
    if _apart(follower, low.point, high.point) > _JUMP * _apart(follower, one.point, other.point):
        raise NoOrbitError("branch: where a contact or an event comes or goes it leaps onto another one")
    return 0.5 * (low.point.value + high.point.value), 0.5 * left()


def _apart(follower: Follower, one: Point, other: Point) -> float:
    """Return how far two orbits are from one another."""
    place = follower.chart(one).coordinates(other.orbit.start)
    return math.hypot(float(np.linalg.norm(place)), (other.value - one.value) / follower.unit)
