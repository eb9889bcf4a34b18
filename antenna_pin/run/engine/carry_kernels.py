"""Propagation of tangents along a step by the run's own method, compiled.

State and displacements w are one set of equations, y' = f(y) and ``w' = dv - [v, w]``, ``dv' = Df w``, and go
by the same stages: what comes of w is of the order of the method, and its embedded weights tell the error.
Next to where contacts begin or end the derivative Df goes with a root of time; there time goes with the
square of what is integrated over.

What displacements are off by goes by the same equations, and need not be known as well: by three of the
stages, in a method of third order, where these can (``|h A w| < |w|``).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.tangent_room_kernels import TangentRoom
from antenna_pin.integrate.explicit_kernels import Tableau
from antenna_pin.integrate.kernels import RATES, STATE, begin, stage, store
from antenna_pin.integrate.manifold_kernels import space_of, write_bracket
from antenna_pin.run.engine.tangent_kernels import write_tangent

# How near an instant is from which on derivatives go with a root of time: of that to the ends of a step.
_EVEN = 0.9


@by_address
class CarryRoom(NamedTuple):
    """Arrays for the propagation of tangents.

    They are of two kinds: those themselves, and behind them what these are off by.
    """

    tangent: TangentRoom  # what the derivative of the rates is computed with
    tableau: Tableau  # the method's
    work: Floats  # the rows of a stepper; START, STATE and RATES are those of the state
    ways: Floats  # displacements at the start, (k, displacement)
    now: Floats  # those at the stage; at the end those at the end
    slopes: Floats  # rates of their ways, rates and bristles, by stage, (stages, k, moving)
    coarse: Floats  # over what a step of differences of each part must be one at most, (displacement,)
    steps: Floats  # of differences along them, (k,)
    rests: Floats  # weights of the stages of what displacements are off by, (stages, stages)
    asked: Ints  # which of the stages these have, 0 or not, (stages,)
    # the displacements themselves, as ``now``, where the others are not asked for; scratch at last
    few: Floats
    few_steps: Floats  # of differences along these
    few_both: Floats  # as ``both``, of these
    books: Floats  # how what is integrated along the run is displaced by the step, (few, nx)
    bracket: Floats  # scratch, (nv,)
    both: Floats  # derivatives of the rates, by differences of two orders, (2, k, nv + nx)
    errors: Floats  # by how much the end is off, of displacements themselves, (few, moving)
    rough: Floats  # by how much it would be by the other order of differences, (few, moving)
    sizes: Floats  # of these two, in units, (2, few)


@inlined
def _grade(t: float, h: float, until: float, since: float) -> tuple[int, float]:
    """Return how time goes along a step.

    Behind an onset the derivative of a force that begins like depth^1.5 goes with the root of time since, and
    likewise before a release. At a kink there is no derivative, and differences have some of both sides':
    where time goes with a square from or to there, it has no share.

    Returns:
        Whether it goes with the square of what is integrated over, from an instant before the start on, 1, or
        back from one behind the end, -1; or evenly, 0. And where that instant is: the root of the time from
        there to the nearer end of the step over that to the other, [0, 1).
    """
    gone, left = max(t - since, 0.0), max(until - (t + h), 0.0)
    before = math.sqrt(gone / (gone + h)) if gone < math.inf else 1.0
    behind = math.sqrt(left / (left + h)) if left < math.inf else 1.0
    if min(before, behind) >= _EVEN:
        return 0, 0.0
    return (-1, behind) if behind <= before else (1, before)


@inlined
def _place(s: float, grade: int, origin: float) -> tuple[float, float]:
    """Return the fraction of time at s in [0, 1], and its derivative."""
    if grade == 0:
        return s, 1.0
    root = origin + (1.0 - origin) * (s if grade > 0 else 1.0 - s)
    rest = 1.0 - origin * origin
    place, speed = (root * root - origin * origin) / rest, 2.0 * (1.0 - origin) * root / rest
    return (place, speed) if grade > 0 else (1.0 - place, speed)


@inlined
def _displace(i: int, h: float, room: CarryRoom) -> None:
    """Write the tangents at stage i, and their errors if required."""
    slopes, now, few = room.slopes, room.now, room.few.shape[0]
    for d in range(now.shape[0]):
        if d >= few and room.asked[i] == 0 and i < room.tableau.last:
            continue
        weights = room.tableau.weights if d < few else room.rests
        for k in range(slopes.shape[2]):
            now[d, k] = room.ways[d, k]
        # Stage by stage, so that the parts of a displacement go side by side.
        for j in range(i):
            share = h * weights[i, j]
            if share != 0.0:
                for k in range(slopes.shape[2]):
                    now[d, k] += share * slopes[j, d, k]


@inlined
def _note(i: int, h: float, speed: float, y: Floats, both: Floats, room: CarryRoom) -> None:
    """Note how fast the displacements change at stage i, over what is integrated over.

    By how much the two orders of differences part there is added up, by the stage's share in the step; and
    what acts on nothing.
    """
    tangent, now, few = room.tangent, room.now, room.few.shape[0]
    space = space_of(tangent.layout)
    nq, nv = space.nq, space.nv
    v = y[nq : nq + nv]
    part = h * speed * room.tableau.weights[room.tableau.last, i]
    share = abs(part)
    for d in range(both.shape[1]):
        out = room.slopes[i, d]
        write_bracket(tangent.layout, v, now[d], room.bracket)
        for k in range(nv):
            out[k] = speed * (now[d, nv + k] - room.bracket[k])
            out[nv + k] = speed * both[0, d, k]
        for k in range(tangent.bristles.shape[0]):
            out[2 * nv + k] = speed * both[0, d, nv + tangent.bristles[k]]
        if d >= few or share == 0.0:
            continue
        rough = room.rough[d]
        for k in range(nv):
            rough[nv + k] += share * abs(both[1, d, k] - both[0, d, k])
        for k in range(tangent.bristles.shape[0]):
            at = nv + tangent.bristles[k]
            rough[2 * nv + k] += share * abs(both[1, d, at] - both[0, d, at])
        for k in range(room.books.shape[1]):
            room.books[d, k] += part * both[0, d, nv + k]


@inlined
def _judge(h: float, room: CarryRoom) -> None:
    """Write the method's errors of the tangents, with sizes of errors and roughness."""
    weights, slopes, units, others = room.tableau.errors, room.slopes, room.tangent.units, room.few
    for d in range(room.few.shape[0]):
        first, second = 0.0, 0.0
        for k in range(slopes.shape[2]):
            room.errors[d, k], others[d, k] = 0.0, 0.0
        for j in range(room.tableau.last + 1):
            one, other = weights[0, j], weights[1, j] if weights.shape[0] == 2 else 0.0
            for k in range(slopes.shape[2]):
                room.errors[d, k] += one * slopes[j, d, k]
                others[d, k] += other * slopes[j, d, k]
        for k in range(slopes.shape[2]):
            first += (room.errors[d, k] / units[k]) ** 2
            second += (others[d, k] / units[k]) ** 2
        share, parted = 1.0, 0.0
        if weights.shape[0] == 2 and first + second > 0.0:
            # Of order 8(5,3), as the run's own.
            share = math.sqrt(first / (first + 0.01 * second))
        for k in range(slopes.shape[2]):
            room.errors[d, k] *= h * share
            parted += (room.rough[d, k] / units[k]) ** 2
        room.sizes[0, d] = abs(h) * math.sqrt(first) * share
        room.sizes[1, d] = math.sqrt(parted)


@inlined
def _prepare(room: CarryRoom) -> None:
    """Choose difference steps for differences of the whole, and leave constant parts."""
    for d in range(room.ways.shape[0]):
        largest = 0.0
        for k in range(room.ways.shape[1]):
            room.now[d, k] = room.ways[d, k]
            largest = max(largest, room.coarse[k] * abs(room.ways[d, k]))
        room.steps[d] = 1.0 / largest if largest > 0.0 else 1.0
    for d in range(room.few.shape[0]):
        room.few_steps[d] = room.steps[d]


@kernel
def carry_along(t: float, h: float, until: float, since: float, room: CarryRoom) -> None:
    """Carry displacements along a step.

    Args:
        t: Where it begins [s]; the state is in the row STATE of the work rows, where that at the end is left.
        h: Its size [s].
        until: When contacts, drives or rates change next, where it ends or behind that [s].
        since: When they have changed last [s].
        room: What to carry with.
    """
    grade, origin = _grade(t, h, until, since)
    tableau, work, tangent = room.tableau, room.work, room.tangent
    layout = tangent.layout
    space, stages, last = space_of(layout), tableau.weights.shape[0], tableau.last
    size, n = space.nq + space.nv + space.nx, 2 * space.nv + space.nx
    y, rates = work[stages + STATE, :size], work[stages + RATES]
    _prepare(room)
    room.rough[:] = 0.0
    room.books[:] = 0.0
    for i in range(last + 1):
        place, speed = _place(tableau.nodes[i], grade, origin)
        if i > 0:
            stage(i, h, tableau.weights, layout, work, False)
            _displace(i, h, room)
        every = room.asked[i] != 0
        if not every:
            for d in range(room.few.shape[0]):
                for k in range(room.few.shape[1]):
                    room.few[d, k] = room.now[d, k]
        if speed != 0.0:
            if every:
                write_tangent(t + place * h, y, room.now, room.steps, tangent, room.both)
            else:
                write_tangent(t + place * h, y, room.few, room.few_steps, tangent, room.few_both)
            for k in range(space.nv):
                rates[k] = tangent.acceleration[k]
            for k in range(space.nx):
                rates[space.nv + k] = tangent.drift[k]
        if every:
            _note(i, h, speed, y, room.both, room)
        else:
            _note(i, h, speed, y, room.few_both, room)
        if i == 0:
            begin(stages, layout, work)
        else:
            store(i, stages, layout, work)
        for k in range(n):
            work[i, k] *= speed
    _judge(h, room)
