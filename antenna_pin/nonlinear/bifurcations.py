"""What happens to a branch of periodic solutions between two of its points."""

from __future__ import annotations

from typing import Literal, NamedTuple

from antenna_pin.nonlinear.follower import Node
from antenna_pin.nonlinear.grazes import where_passed
from antenna_pin.nonlinear.hidden import doubling, hidden, is_torus, shedding
from antenna_pin.nonlinear.locate import Located, Step, Test, where_crossed, where_turned, where_zero

__all__ = ["Bifurcation", "BifurcationKind", "bifurcations_in", "more_happens"]

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


_TESTS: dict[BifurcationKind, Test] = {"flip": doubling, "neimark-sacker": shedding}

# How often a step is halved where more may happen in it than its ends tell of.
_DEEP = 5


def bifurcations_in(step: Step, after: int, precision: float) -> list[Bifurcation]:
    """Return what happens in a step from one orbit of a branch to the next, in order.

    Where the branch turns back in it, on both sides of that. Where more may happen than the ends tell of,
    orbits are made between them.

    Args:
        step: The step.
        after: Number of the orbit that it begins with.
        precision: To locate to.

    Raises:
        AntennaPinError: It cannot be told: the step is too long, or leads onto another branch.
    """
    found = _within(step, 0.0, step.arc, precision, _DEEP)
    found.sort(key=lambda each: each.where.along)
    return [Bifurcation(kind, where.value, where.doubt, after) for kind, where in found]


def more_happens(step: Step) -> bool:
    """Whether more may happen in a step than its ends tell of, as the orbits beside it have it."""
    return hidden(step, 0.0, step.arc) is not None


def _within(step: Step, low: float, high: float, precision: float, halvings: int) -> list[_Found]:
    """Return what happens between two places of a step, between which so many halvings are left."""
    where = hidden(step, low, high) if halvings else None
    if where is not None:
        step.node(where)
        return [
            *_within(step, low, where, precision, halvings - 1),
            *_within(step, where, high, precision, halvings - 1),
        ]
    one, other = step.node(low), step.node(high)
    found: list[_Found] = []
    sides, crossed = [(low, high)], False
    if len(one.way) == len(other.way) and one.way[-1] * other.way[-1] < 0.0:
        crossing = where_crossed(step, low, high, precision) if _crosses(one, other) else None
        # The branch without a symmetry turns back where it meets that which has it: that is no fold.
        crossed = crossing is not None and step.turns_at(crossing.along)
        if crossing is not None and crossed:
            found.append(_Found("branch-point", crossing))
        else:
            turn = where_turned(step, low, high, precision)
            found.append(_Found("fold", turn))
            sides = [(low, turn.along), (turn.along, high)]
    for begin, end in sides:
        if begin != end:
            found += _on_one_side(step, begin, end, crossed, precision)
    return found


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
        value, doubt = where_passed(step.follower, one, other, precision)
        return [_Found("grazing", Located(value, doubt, 0.5 * (begin + end)))]
    if len(one.way) != len(other.way):
        return []
    found = []
    if not crossed and _crosses(one, other):
        found.append(_Found("branch-point", where_crossed(step, begin, end, precision)))
    for kind, test in _TESTS.items():
        signs = {test(node.point.orbit.multipliers) > 0.0 for node in (one, other)}
        if len(signs) == 2:
            where = where_zero(step, test, begin, end, precision)
            # Two real multipliers whose product is 1: nothing happens.
            if kind == "flip" or is_torus(step.nearest(where.along).orbit.multipliers):
                found.append(_Found(kind, where))
    return found
