"""Periodic solutions over a parameter: a branch followed by its arclength, and what happens to it there."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.brief import brief
from antenna_pin.base.capacity import check_count
from antenna_pin.base.interruption import acknowledge
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.nonlinear.chart import Chart
from antenna_pin.nonlinear.follower import Family, Follower, Node, Point, early
from antenna_pin.nonlinear.grazes import Ahead, bent, change_ahead, where_passed
from antenna_pin.nonlinear.hidden import doubling, hidden, is_torus, shedding
from antenna_pin.nonlinear.locate import Located, Step, Test, where_crossed, where_turned, where_zero
from antenna_pin.nonlinear.orbits import NoOrbitError, near_enough

__all__ = ["Bifurcation", "BifurcationKind", "Branch", "Family", "Point", "check_steps", "continued"]


# --- what happens to a branch of periodic solutions between two of its points ---

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


Array = NDArray[np.float64]

# Of an arc, over the first: there the branch is given up; there it is if contacts or events change ahead.
_SHORTEST, _NEAREST = 2.0**-10, 2.0**-40
# Upon a crossing: where it is as good as singular; and by how much a step is shortened not to end there.
_ON, _BESIDE = 1e-6, 0.7
_PRECISE = 1e2  # of the tolerance of orbits: how well what happens to them is located, over the range
_SHORT = 2.0**-4  # likewise: shorter steps may turn a branch by nearly a right angle
# Of the way to where contacts or events come or go ahead: how far the next orbit is at most, as where that is
# is known to second order only.
_TOWARDS = 0.9
_UPON = 1e-2  # and how far it may be, over the first arc, if orbits agree on it
_FARTHER = 4.0  # and how far it is looked for there, over what should be left
_REACHED = "it came to the end of the range"
_BACK = "it came back to the beginning of the range"


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """A family of periodic solutions.

    Attributes:
        points: In their order along it.
        bifurcations: Likewise.
        message: Why it ends.
        interrupted: Whether Ctrl-C has ended it.
    """

    __repr__ = brief

    points: tuple[Point, ...]
    bifurcations: tuple[Bifurcation, ...]
    message: str
    interrupted: bool = False


@takes()
def check_steps(values: tuple[float, float], arc: float, most: int) -> None:
    """Refuse what :func:`continued` does of these arguments, before a long transient is run."""
    begin, end = map(float, values)
    if begin == end or not (math.isfinite(begin) and math.isfinite(end)):
        raise InvalidParameterError("branch", "values", "two different, finite ones", values)
    if not (math.isfinite(arc) and arc > 0.0):
        raise InvalidParameterError("branch", "arc", "positive and finite", arc)
    check_count("branch", "most", most, 2)


@takes()
def continued(
    family: Family,
    guess: State,
    values: tuple[float, float],
    *,
    arc: float = 0.05,
    most: int = 200,
    tolerance: float | None = None,
    precision: float | None = None,
    progress: Callable[[Point], None] | None = None,
) -> Branch:
    """Follow a branch of periodic solutions over a parameter, round folds too (pseudo-arclength).

    What Ctrl-C interrupts, once there is a first orbit, is returned as far as it is.

    Args:
        family: Flow and period of every value of the parameter. Systems that depend on time have the period
            of their drives, or a multiple.
        guess: A state near the orbit at the first value.
        values: First value of the parameter, and the one at which the branch ends, to the last bit; it ends
            likewise where it comes back to the first one.
        arc: Length of its steps: of states in error scales, of the parameter over the whole range [-]. Steps
            are halved where Newton's method does not come back, and doubled where it comes back at once.
        most: Points at most.
        tolerance: As for :func:`periodic_orbit` [-].
        precision: To which bifurcations are located, over the range of the parameter; if left out a hundred
            times the tolerance [-].
        progress: Called with each point.

    Raises:
        NoOrbitError: There is no orbit near the guess at the first value.
    """
    check_steps(values, arc, most)
    begin, end = map(float, values)
    flow, period = family(begin)
    tolerance = near_enough(flow) if tolerance is None else tolerance
    precision = _PRECISE * tolerance if precision is None else precision
    for name, number in (("tolerance", tolerance), ("precision", precision)):
        if not (math.isfinite(number) and number > 0.0):
            raise InvalidParameterError("branch", name, "positive and finite", number)
    unit = end - begin
    follower = Follower(functools.lru_cache(maxsize=64)(family), unit, tolerance)
    near = Chart(flow.system, early(guess, period))
    point = Point(begin, follower.orbit(near.state(np.zeros(near.size)), begin))
    nodes = [follower.node(point, None)]
    found: list[Bifurcation] = []
    interrupted = False
    try:
        message = _followed(follower, nodes, found, (begin, end), arc, most, precision * abs(unit), progress)
    except KeyboardInterrupt:
        acknowledge()
        interrupted, message = True, f"it was interrupted at {nodes[-1].point.value:g}"
    return Branch(tuple(one.point for one in nodes), tuple(found), message, interrupted)


def _followed(
    follower: Follower,
    nodes: list[Node],
    found: list[Bifurcation],
    values: tuple[float, float],
    arc: float,
    most: int,
    near_by: float,
    progress: Callable[[Point], None] | None,
) -> str:
    """Follow a branch on from its first node, and return why it ends; what is found is added to the lists."""
    step, moved, failed = arc, -1, ""
    look, ahead = 0.0, None  # how far contacts or events that come or go are looked for ahead
    expected: dict[int, float] = {}  # where they were, by the orbit from which it was looked
    passed: Step | None = None
    while len(nodes) < most:
        last, number = nodes[-1], len(nodes) - 1
        if look > 0.0:
            ahead = change_ahead(follower, last, look, passed)
            if ahead is None:
                look = 0.0
            else:
                before = expected.get(number - 1, math.nan)
                graze = _graze(follower, last, ahead, before, values, arc, near_by)
                if graze is not None:
                    found.append(Bifurcation("grazing", *graze, number))
                    return f"it ends in a graze at {graze[0]:g}"
                expected[number] = ahead.value
                step = min(step, _TOWARDS * ahead.arc)
        if failed and step < arc * (_SHORTEST if ahead is None else _NEAREST):
            return f"no orbit farther than at {last.point.value:g}: {failed}"
        try:
            guess = None if ahead is None else bent(follower, last, step, passed)
            point, made, stopped = _next(follower, last, step, values, guess)
            if point.orbit.onsets != last.point.orbit.onsets and moved < len(nodes):
                raise NoOrbitError("branch: a contact or an event comes or goes")
            node = follower.node(point, last)
            if (
                last.told
                and not node.told
                and node.margin < _ON
                and not stopped
                and step == made > arc * _SHORTEST
            ):
                step *= _BESIDE  # upon a crossing directions are any: the next orbit is to be beside it
                continue
            short = made <= _SHORT * arc
            if not follower.smooth(last, node, corner=short):
                if short:
                    raise NoOrbitError("branch: the next orbit is farther away than the step is long")
                step *= 0.5  # too long, or it has come onto another branch
                continue
            here = Step(follower, last, node, made)
            if passed is not None:
                here.beside[-passed.arc] = passed.first
            happened = bifurcations_in(here, number, near_by)
        except AntennaPinError as error:
            if moved < len(nodes):
                # What seems to come or go may only pass the instant that orbits are told by.
                moved = len(nodes)
                with contextlib.suppress(AntennaPinError):
                    nodes[-1] = follower.in_flight(last) or last
                if nodes[-1] is not last:
                    continue
            step, look, failed = 0.5 * step, max(look, step), str(error)
            continue
        nodes.append(node)
        found += happened
        if passed is not None:
            passed.beside[passed.arc + made] = node
            found[:] = _looked_at_again(passed, found, number - 1, near_by)
        passed, failed = here, ""
        if progress is not None:
            progress(point)
        if stopped:
            return stopped
        if ahead is not None:
            left = ahead.arc - made
            look = step = min(look, _FARTHER * left) if left > 0.0 else made
        elif point.orbit.iterations <= 3:
            step = min(2.0 * step, 4.0 * arc)
    return f"{most} points were made"


def _graze(
    follower: Follower,
    last: Node,
    ahead: Ahead,
    before: float,
    values: tuple[float, float],
    arc: float,
    near_by: float,
) -> tuple[float, float] | None:
    """Return where a branch ends in a graze ahead of its last orbit, and the doubt of it, if it is known.

    That is where there are orbits up to as near as is asked for, or far nearer than a step and this one says
    of it what the one before did; nothing is said of what is beyond the range.
    """
    if not (ahead.value - values[0]) * (values[1] - ahead.value) >= 0.0:
        return None
    doubt = abs(ahead.value - last.point.value)
    near = ahead.arc * abs(follower.unit) * max(abs(last.way[-1]), _ON) <= near_by
    moved = abs(ahead.value - before)
    if ahead.arc <= _UPON * arc and moved <= near_by:
        near, doubt = True, min(moved, doubt)
    return (ahead.value, max(doubt, 0.5 * near_by)) if near else None


def _next(
    follower: Follower, last: Node, step: float, values: tuple[float, float], guess: Array | None
) -> tuple[Point, float, str]:
    """Return the orbit a step ahead, how far that is, and why the branch ends there, if it does.

    At the end of the range it is the orbit there, also where the step leads beyond it to where there is none.

    Raises:
        AntennaPinError: None is found.
    """
    begin, end = values
    straight = last.point.value + step * last.way[-1] * follower.unit
    try:
        point = follower.correct(last.point, last.way, step, guess)
    except AntennaPinError:
        if (straight - begin) / (end - begin) < 1.0:
            raise
        return (*follower.up_to(last, end), _REACHED)
    share = (point.value - begin) / (end - begin)
    if 0.0 < share < 1.0:
        return point, step, ""
    bound, stopped = (begin, _BACK) if share <= 0.0 else (end, _REACHED)
    made = step
    if point.value != bound:
        point, made = follower.stopped(last.point, last.way, step, point, bound)
    return point, made, stopped


def _looked_at_again(step: Step, found: list[Bifurcation], after: int, near_by: float) -> list[Bifurcation]:
    """Return what has been found with what happens in a step as the orbit behind it, known since, tells."""
    if not more_happens(step):
        return found
    try:
        again = bifurcations_in(step, after, near_by)
    except AntennaPinError:
        return found
    before = [one for one in found if one.after < after]
    return [*before, *again, *(one for one in found if one.after > after)]
