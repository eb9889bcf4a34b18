"""Periodic solutions over a parameter: a branch followed by its arclength, and what happens to it there."""

from __future__ import annotations

import contextlib
import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from antenna_pin.brief import brief
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.nonlinear.bifurcations import (
    Bifurcation,
    BifurcationKind,
    bifurcations_between,
    graze_ahead,
)
from antenna_pin.nonlinear.chart import Chart
from antenna_pin.nonlinear.follower import Family, Follower, Node, Point, early
from antenna_pin.nonlinear.orbits import NoOrbitError, near_enough
from antenna_pin.state import State

__all__ = ["Bifurcation", "BifurcationKind", "Branch", "Family", "Point", "check_steps", "continued"]

_SHORTEST = 2.0**-10  # of an arc, over the first: there the branch is given up
# Upon a crossing: where it is as good as singular; and by how much a step is shortened not to end there.
_ON, _BESIDE = 1e-6, 0.7
_PRECISE = 1e2  # of the tolerance of orbits: how well what happens to them is located, over the range
_SHORT = 2.0**-4  # likewise: shorter steps may turn a branch as they like
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


def check_steps(values: tuple[float, float], arc: float, most: int) -> None:
    """Refuse what :func:`continued` does of these arguments, before a long transient is run."""
    begin, end = map(float, values)
    if begin == end or not (math.isfinite(begin) and math.isfinite(end)):
        raise InvalidParameterError("branch", "values", "two different, finite ones", values)
    if not (math.isfinite(arc) and arc > 0.0):
        raise InvalidParameterError("branch", "arc", "positive and finite", arc)
    if most < 2:
        raise InvalidParameterError("branch", "most", "2 points or more", most)


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
    (begin, end), step, moved = values, arc, -1
    while len(nodes) < most:
        last, made, stopped = nodes[-1], step, ""
        try:
            point = follower.correct(last.point, last.way, step)
            share = (point.value - begin) / (end - begin)
            if not 0.0 < share < 1.0:
                bound, stopped = (begin, _BACK) if share <= 0.0 else (end, _REACHED)
                if point.value != bound:
                    point, made = follower.stopped(last.point, last.way, step, point, bound)
            if point.orbit.onsets != last.point.orbit.onsets and moved < len(nodes):
                raise NoOrbitError("branch: a contact or an event comes or goes")
            node = follower.node(point, last)
        except AntennaPinError as error:
            if moved < len(nodes):
                # What seems to come or go may only pass the instant that orbits are told by.
                moved = len(nodes)
                with contextlib.suppress(AntennaPinError):
                    nodes[-1] = follower.in_flight(last) or last
                if nodes[-1] is not last:
                    continue
            grazes = graze_ahead(follower, last, step, len(nodes) - 1, near_by)
            if grazes:
                found += grazes
                return f"it ends in a graze at {grazes[0].value:g}"
            step *= 0.5
            if step < arc * _SHORTEST:
                return f"no orbit farther than at {last.point.value:g}: {error}"
            continue
        if (
            last.told
            and not node.told
            and node.margin < _ON
            and not stopped
            and step == made > arc * _SHORTEST
        ):
            step *= _BESIDE  # upon a crossing directions are any: the next orbit is to be beside it
            continue
        if step > _SHORT * arc and not follower.smooth(last, node):
            step *= 0.5  # too long, or it has come onto another branch
            continue
        happened = bifurcations_between(follower, last, node, made, len(nodes) - 1, near_by)
        nodes.append(node)
        found += happened
        if progress is not None:
            progress(point)
        if stopped:
            return stopped
        if point.orbit.iterations <= 3:
            step = min(2.0 * step, 4.0 * arc)
    return f"{most} points were made"
