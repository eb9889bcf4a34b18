"""What happens to a branch of periodic solutions between two of its points."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Literal, NamedTuple

import numpy as np

from antenna_pin.errors import AntennaPinError
from antenna_pin.nonlinear.follower import Follower, Node
from antenna_pin.nonlinear.locate import (
    Located,
    Step,
    where_changed,
    where_crossed,
    where_turned,
    where_zero,
)
from antenna_pin.nonlinear.orbits import Orbit

__all__ = ["Bifurcation", "BifurcationKind", "bifurcations_between", "graze_ahead"]

BifurcationKind = Literal["fold", "branch-point", "flip", "neimark-sacker", "grazing"]
"""It turns back; another branch crosses it; its period doubles; a torus is born of it; a contact or an event
of it comes or goes."""


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


class _Found(NamedTuple):
    kind: BifurcationKind
    where: Located


def _pairs(orbit: Orbit) -> list[tuple[complex, complex]]:
    """Return every two multipliers of an orbit."""
    return list(itertools.combinations(orbit.multipliers.tolist(), 2))


def _doubling(orbit: Orbit) -> float:
    """Return a number that passes zero where an orbit doubles its period."""
    return float(np.prod(orbit.multipliers + 1.0).real)


def _shedding(orbit: Orbit) -> float:
    """Return a number that passes zero where an orbit sheds a torus."""
    products = [one * other - 1.0 for one, other in _pairs(orbit)]
    return float(np.prod(products).real) if products else 1.0


_TESTS: dict[BifurcationKind, Callable[[Orbit], float]] = {"flip": _doubling, "neimark-sacker": _shedding}


def _is_torus(orbit: Orbit) -> bool:
    """Whether the pair of multipliers whose product is nearest to 1 is a complex one, not two real ones."""
    one, other = min(_pairs(orbit), key=lambda pair: abs(pair[0] * pair[1] - 1.0))
    return abs(one.imag) > 1e-9 and abs(one - other.conjugate()) < 1e-6 * abs(one)


def _other_happenings(first: Orbit) -> Callable[[Orbit | None], bool]:
    return lambda orbit: orbit is None or orbit.onsets != first.onsets


def bifurcations_between(
    follower: Follower, one: Node, other: Node, arc: float, after: int, precision: float
) -> list[Bifurcation]:
    """Return what happens in a step from one orbit to another, in order.

    Where the branch turns back in it, on both sides of that.
    """
    step = Step(follower, one, other, arc)
    found: list[_Found] = []
    sides, crossed = [(0.0, arc)], False
    if len(one.way) == len(other.way) and one.way[-1] * other.way[-1] < 0.0:
        crossing = where_crossed(step, 0.0, arc, precision) if _crosses(one, other) else None
        # The branch without a symmetry turns back where it meets that which has it: that is no fold.
        crossed = crossing is not None and step.turns_at(crossing.along)
        if crossing is not None and crossed:
            found.append(_Found("branch-point", crossing))
        else:
            turn, low, high = where_turned(step, precision)
            found.append(_Found("fold", turn))
            sides = [(0.0, low), (high, arc)]
    for begin, end in sides:
        if begin != end:
            found += _on_one_side(step, begin, end, crossed, precision)
    found.sort(key=lambda each: each.where.along)
    return [Bifurcation(kind, where.value, where.doubt, after) for kind, where in found]


def _crosses(one: Node, other: Node) -> bool:
    return one.told and other.told and one.crossing * other.crossing < 0.0


def _on_one_side(step: Step, begin: float, end: float, crossed: bool, precision: float) -> list[_Found]:
    """Return what happens between two places of a step between which the parameter goes one way.

    Args:
        step: The step.
        begin: The first place.
        end: The other.
        crossed: Whether it is known where another branch crosses in this step.
        precision: To locate to.
    """
    one, other = step.node(begin), step.node(end)
    if one.point.orbit.onsets != other.point.orbit.onsets:
        # From the end of the step: at the other the branch may turn back.
        near, far = (one, other) if begin == 0.0 else (other, one)
        happens = _other_happenings(near.point.orbit)
        value, doubt = where_changed(step.follower, near, far.point.value, happens, precision)
        return [_Found("grazing", Located(value, doubt, 0.5 * (begin + end)))]
    if len(one.way) != len(other.way):
        return []
    found = []
    if not crossed and _crosses(one, other):
        found.append(_Found("branch-point", where_crossed(step, begin, end, precision)))
    for kind, test in _TESTS.items():
        if test(one.point.orbit) * test(other.point.orbit) < 0.0:
            where = where_zero(step, test, begin, end, precision)
            # Two real multipliers whose product is 1: nothing happens.
            if kind == "flip" or _is_torus(step.nearest(where.along).orbit):
                found.append(_Found(kind, where))
    return found


def graze_ahead(
    follower: Follower, last: Node, arc: float, after: int, precision: float
) -> list[Bifurcation]:
    """Return the graze that a branch ends in, if it does: a little farther on, more happens or less."""
    point, way = last.point, last.way
    ahead = point.value + arc * way[-1] * follower.unit
    try:
        farther, period = follower.family(ahead)
        went = farther.went(follower.chart(point).state(arc * way[:-1], farther.system), period)
    except AntennaPinError:
        return []
    if (went.onsets, went.events) == point.orbit.onsets:
        return []
    value, doubt = where_changed(follower, last, ahead, _other_happenings(point.orbit), precision)
    return [Bifurcation("grazing", value, doubt, after)]
