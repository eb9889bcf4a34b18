"""Branches of periodic orbits over a parameter by pseudo-arclength, with their bifurcations."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.capacity import check_count
from antenna_pin.base.interruption import acknowledge
from antenna_pin.base.readable import brief
from antenna_pin.base.rules import Positive
from antenna_pin.base.state import State
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.studies.nonlinear.bifurcation_points import (
    BranchStep,
    GrazeAhead,
    Located,
    Test,
    curved_predictor,
    flip_test,
    graze_ahead,
    hidden_change,
    is_torus,
    locate_crossing,
    locate_fold,
    locate_graze,
    locate_zero,
    torus_test,
)
from antenna_pin.studies.nonlinear.chart import Chart
from antenna_pin.studies.nonlinear.orbits import NoOrbitError, default_tolerance
from antenna_pin.studies.nonlinear.pseudo_arclength import (
    BranchStepper,
    Node,
    Point,
    SolutionFamily,
    in_first_period,
)

# --- bifurcations between two orbits of a branch ------------------------------------------------------------

BifurcationKind = Literal["fold", "branch-point", "flip", "neimark-sacker", "grazing"]
"""It turns back; another branch crosses it; its period doubles; a torus is born of it; a contact or an event
of it comes or goes."""


class Bifurcation(NamedTuple):
    """Bifurcation of a branch."""

    kind: BifurcationKind  # kind of the bifurcation
    value: float  # value of the parameter
    doubt: float  # half of the interval around it
    after: int  # number of the preceding point


class _Occurrence(NamedTuple):
    kind: BifurcationKind
    where: Located


_TESTS: dict[BifurcationKind, Test] = {"flip": flip_test, "neimark-sacker": torus_test}

# Bisections of a step that may hold hidden bifurcations.
_DEEP = 5


def _bifurcations_in(step: BranchStep, after: int, precision: float) -> list[Bifurcation]:
    """Return the bifurcations in a step between two orbits of a branch, in order.

    A step with a fold is examined on both sides of it. If hidden changes are possible, orbits are computed
    between the two.
    """
    found = _between(step, 0.0, step.arc, precision, _DEEP)
    found.sort(key=lambda each: each.where.along)
    return [Bifurcation(kind, where.value, where.doubt, after) for kind, where in found]


def _between(step: BranchStep, low: float, high: float, precision: float, halvings: int) -> list[_Occurrence]:
    """Return the bifurcations between two places of a step."""
    where = hidden_change(step, low, high) if halvings else None
    if where is not None:
        step.node(where)
        return [
            *_between(step, low, where, precision, halvings - 1),
            *_between(step, where, high, precision, halvings - 1),
        ]
    one, other = step.node(low), step.node(high)
    found: list[_Occurrence] = []
    sides, crossed = [(low, high)], False
    if len(one.tangent) == len(other.tangent) and one.tangent[-1] * other.tangent[-1] < 0.0:
        crossing = locate_crossing(step, low, high, precision) if _crosses(one, other) else None
        # An asymmetric branch turns back where it meets the symmetric one: that is no fold.
        crossed = crossing is not None and step.turns_at(crossing.along)
        if crossing is not None and crossed:
            found.append(_Occurrence("branch-point", crossing))
        else:
            turn = locate_fold(step, low, high, precision)
            found.append(_Occurrence("fold", turn))
            sides = [(low, turn.along), (turn.along, high)]
    for begin, end in sides:
        if begin != end:
            found += _on_one_side(step, begin, end, crossed, precision)
    return found


def _crosses(one: Node, other: Node) -> bool:
    return one.regular and other.regular and one.crossing * other.crossing < 0.0


def _on_one_side(
    step: BranchStep, begin: float, end: float, crossed: bool, precision: float
) -> list[_Occurrence]:
    """Return the bifurcations between two places without a fold between them."""
    one, other = step.node(begin), step.node(end)
    if one.point.orbit.onsets != other.point.orbit.onsets:
        value, doubt = locate_graze(step.stepper, one, other, precision)
        return [_Occurrence("grazing", Located(value, doubt, 0.5 * (begin + end)))]
    if len(one.tangent) != len(other.tangent):
        return []
    found = []
    if not crossed and _crosses(one, other):
        found.append(_Occurrence("branch-point", locate_crossing(step, begin, end, precision)))
    for kind, test in _TESTS.items():
        signs = {test(node.point.orbit.multipliers) > 0.0 for node in (one, other)}
        if len(signs) == 2:
            where = locate_zero(step, test, begin, end, precision)
            # Two real multipliers with the product 1: no bifurcation.
            if kind == "flip" or is_torus(step.nearest(where.along).orbit.multipliers):
                found.append(_Occurrence(kind, where))
    return found


# Least arcs over the first: at which the branch ends, and at which it does near a change of contacts or
# events.
_SHORTEST, _NEAREST = 2.0**-10, 2.0**-40
# At a crossing: margin of a singular matrix, and factor of the step to avoid an orbit there.
_ON, _BESIDE = 1e-6, 0.7
_PRECISE = 1e2  # of the tolerance of orbits: how well what happens to them is located, over the range
_SHORT = 2.0**-4  # likewise: shorter steps may turn a branch by nearly a right angle
# Share of the arc to a change of contacts or events that a step may cover, as its place is known to second
# order only.
_TOWARDS = 0.9
_UPON = 1e-2  # and how far it may be, over the first arc, if orbits agree on it
_FARTHER = 4.0  # and how far it is looked for there, over what should be left
_REACHED = "it came to the end of the range"
_BACK = "it came back to the beginning of the range"


@dataclass(frozen=True, slots=True, eq=False)
class Branch:
    """Branch of periodic orbits."""

    __repr__ = brief

    points: tuple[Point, ...]  # orbits in their order along it
    bifurcations: tuple[Bifurcation, ...]  # likewise
    message: str  # reason of its end
    interrupted: bool = False  # whether Ctrl-C has ended it


@takes()
def check_steps(values: tuple[float, float], arc: Positive, most: int) -> None:
    """Refuse step arguments of :func:`continued` before a long transient is run."""
    begin, end = map(float, values)
    if begin == end or not (math.isfinite(begin) and math.isfinite(end)):
        raise InvalidParameterError("branch", "values", "two different, finite ones", values)
    check_count("branch", "most", most, 2)


@takes()
def continued(
    family: SolutionFamily,
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
    tolerance = default_tolerance(flow) if tolerance is None else tolerance
    precision = _PRECISE * tolerance if precision is None else precision
    for name, number in (("tolerance", tolerance), ("precision", precision)):
        check_number("branch", name, number, "positive")
    unit = end - begin
    stepper = BranchStepper(functools.lru_cache(maxsize=64)(family), unit, tolerance)
    near = Chart(flow.system, in_first_period(guess, period))
    point = Point(begin, stepper.orbit(near.state(np.zeros(near.size)), begin))
    nodes = [stepper.node(point, None)]
    found: list[Bifurcation] = []
    interrupted = False
    try:
        message = _follow(stepper, nodes, found, (begin, end), arc, most, precision * abs(unit), progress)
    except KeyboardInterrupt:
        acknowledge()
        interrupted, message = True, f"it was interrupted at {nodes[-1].point.value:g}"
    return Branch(tuple(one.point for one in nodes), tuple(found), message, interrupted)


def _follow(
    stepper: BranchStepper,
    nodes: list[Node],
    bifurcations: list[Bifurcation],
    values: tuple[float, float],
    arc: float,
    most: int,
    near_by: float,
    progress: Callable[[Point], None] | None,
) -> str:
    """Extend a branch from its first node; return the reason for its end."""
    step, moved, failed = arc, -1, ""
    look, ahead = 0.0, None  # how far contacts or events that come or go are looked for ahead
    expected: dict[int, float] = {}  # where they were, by the orbit from which it was looked
    passed: BranchStep | None = None
    while len(nodes) < most:
        last, number = nodes[-1], len(nodes) - 1
        if look > 0.0:
            ahead = graze_ahead(stepper, last, look, passed)
            if ahead is None:
                look = 0.0
            else:
                before = expected.get(number - 1, math.nan)
                graze = _graze(stepper, last, ahead, before, values, arc, near_by)
                if graze is not None:
                    bifurcations.append(Bifurcation("grazing", *graze, number))
                    return f"it ends in a graze at {graze[0]:g}"
                expected[number] = ahead.value
                step = min(step, _TOWARDS * ahead.arc)
        if failed and step < arc * (_SHORTEST if ahead is None else _NEAREST):
            return f"no orbit farther than at {last.point.value:g}: {failed}"
        try:
            guess = None if ahead is None else curved_predictor(stepper, last, step, passed)
            point, made, stopped = _next_orbit(stepper, last, step, values, guess)
            if point.orbit.onsets != last.point.orbit.onsets and moved < len(nodes):
                raise NoOrbitError("branch: a contact or an event comes or goes")
            node = stepper.node(point, last)
            if (
                last.regular
                and not node.regular
                and node.margin < _ON
                and not stopped
                and step == made > arc * _SHORTEST
            ):
                step *= _BESIDE  # upon a crossing directions are any: the next orbit is to be beside it
                continue
            short = made <= _SHORT * arc
            if not stepper.is_smooth(last, node, corner=short):
                if short:
                    raise NoOrbitError("branch: the next orbit is farther away than the step is long")
                step *= 0.5  # too long, or it has come onto another branch
                continue
            here = BranchStep(stepper, last, node, made)
            if passed is not None:
                here.beside[-passed.arc] = passed.first
            happened = _bifurcations_in(here, number, near_by)
        except AntennaPinError as error:
            if moved < len(nodes):
                # An apparent change may only pass the start time of the orbits.
                moved = len(nodes)
                with contextlib.suppress(AntennaPinError):
                    nodes[-1] = stepper.away_from_events(last) or last
                if nodes[-1] is not last:
                    continue
            step, look, failed = 0.5 * step, max(look, step), str(error)
            continue
        nodes.append(node)
        bifurcations += happened
        if passed is not None:
            passed.beside[passed.arc + made] = node
            bifurcations[:] = _revised(passed, bifurcations, number - 1, near_by)
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
    return f"{most} points computed"


def _graze(
    stepper: BranchStepper,
    last: Node,
    ahead: GrazeAhead,
    before: float,
    values: tuple[float, float],
    arc: float,
    near_by: float,
) -> tuple[float, float] | None:
    """Return the value of a graze that ends a branch, with its error, or None.

    That is where there are orbits up to as near as is requested, or far nearer than a step and this one says
    of it what the one before did; nothing is stated about what is beyond the range.
    """
    if not (ahead.value - values[0]) * (values[1] - ahead.value) >= 0.0:
        return None
    doubt = abs(ahead.value - last.point.value)
    near = ahead.arc * abs(stepper.unit) * max(abs(last.tangent[-1]), _ON) <= near_by
    moved = abs(ahead.value - before)
    if ahead.arc <= _UPON * arc and moved <= near_by:
        near, doubt = True, min(moved, doubt)
    return (ahead.value, max(doubt, 0.5 * near_by)) if near else None


def _next_orbit(
    stepper: BranchStepper, last: Node, step: float, values: tuple[float, float], guess: Array | None
) -> tuple[Point, float, str]:
    """Return the next orbit, the arc to it, and the reason to stop there.

    At the end of the range it is the orbit there, also where the step leads beyond it to where there is none.
    """
    begin, end = values
    straight = last.point.value + step * last.tangent[-1] * stepper.unit
    try:
        point = stepper.correct(last.point, last.tangent, step, guess)
    except AntennaPinError:
        if (straight - begin) / (end - begin) < 1.0:
            raise
        return (*stepper.orbit_ahead(last, end), _REACHED)
    share = (point.value - begin) / (end - begin)
    if 0.0 < share < 1.0:
        return point, step, ""
    bound, stopped = (begin, _BACK) if share <= 0.0 else (end, _REACHED)
    made = step
    if point.value != bound:
        point, made = stepper.orbit_at_bound(last.point, last.tangent, step, point, bound)
    return point, made, stopped


def _revised(
    step: BranchStep, bifurcations: list[Bifurcation], after: int, near_by: float
) -> list[Bifurcation]:
    """Return bifurcations with those of a step revised by the orbit behind it."""
    if hidden_change(step, 0.0, step.arc) is None:
        return bifurcations
    try:
        again = _bifurcations_in(step, after, near_by)
    except AntennaPinError:
        return bifurcations
    before = [one for one in bifurcations if one.after < after]
    return [*before, *again, *(one for one in bifurcations if one.after > after)]
