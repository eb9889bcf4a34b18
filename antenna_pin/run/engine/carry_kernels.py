"""Propagation of tangents along a step by the run's own method, compiled.

State and tangents w are one system of equations, y' = f(y) and ``w' = dv - [v, w]``, ``dv' = Df w``,
integrated with the same stages: w has the order of the method, and the embedded weights estimate its error.
Near an onset or a release the derivative Df varies with a root of time; there the integration variable is the
root of time.

Errors of tangents obey the same equations, and need less accuracy: three of the stages give a method of third
order, where these suffice (``|h A w| < |w|``).
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

# Distance of an event from the step, relative to the farther end, below which time is graded.
_EVEN = 0.9


@by_address
class CarryRoom(NamedTuple):
    """Arrays for the propagation of tangents.

    Rows of ``ways`` are the tangents, followed by their errors.
    """

    tangent: TangentRoom  # arrays for the derivative of the rates
    tableau: Tableau  # coefficients of the method
    work: Floats  # rows of a stepper; START, STATE and RATES are those of the state
    ways: Floats  # tangents at the start, (k, displacement)
    now: Floats  # tangents at the stage; finally those at the end
    slopes: Floats  # rates of their displacements, rates and bristles, by stage, (stages, k, moving)
    coarse: Floats  # upper bounds of a step of differences of each part, inverse, (displacement,)
    steps: Floats  # steps of differences along them, (k,)
    rests: Floats  # weights of the stages for errors of tangents, (stages, stages)
    asked: Ints  # stages that errors use, 0 or not, (stages,)
    # the tangents alone, as ``now``, at stages that errors do not use; finally scratch
    few: Floats
    few_steps: Floats  # steps of differences along these
    few_both: Floats  # as ``both``, of these
    books: Floats  # change of the integrated numbers of the run in the step, (few, nx)
    bracket: Floats  # scratch, (nv,)
    both: Floats  # derivatives of the rates, by differences of two orders, (2, k, nv + nx)
    errors: Floats  # errors of tangents at the end by the method, (few, moving)
    rough: Floats  # errors by the other order of differences, (few, moving)
    sizes: Floats  # sizes of both, in units, (2, few)


@inlined
def _grade(t: float, h: float, until: float, since: float) -> tuple[int, float]:
    """Return the grading of time along a step.

    After an onset the derivative of a force that begins like depth^1.5 varies with the root of time since,
    and likewise before a release. At a kink there is no derivative, and differences mix both sides: with a
    graded time that point has no weight.

    Returns:
        1 if time is the square of the integration variable since an event before the start, -1 if before an
        event after the end, 0 if even. Further the place of the event: root of the time from there to the
        nearer end of the step over that to the other, [0, 1).
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
        # Stage by stage, so that the parts of a tangent are vectorised.
        for j in range(i):
            share = h * weights[i, j]
            if share != 0.0:
                for k in range(slopes.shape[2]):
                    now[d, k] += share * slopes[j, d, k]


@inlined
def _note(i: int, h: float, speed: float, y: Floats, both: Floats, room: CarryRoom) -> None:
    """Write the rates of the tangents at stage i, over the integration variable.

    Differences between the two orders are added up with the stage's weight in the step, and so are the
    effects on integrated numbers.
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
            # Of order 8(5,3), like the run's own.
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
    """Propagate tangents along a step.

    Args:
        t: Start [s]; the state is in the row STATE of the work rows, where that at the end is written.
        h: Step size [s].
        until: Time of the next change of contacts, drives or rates, at the end or later [s].
        since: Time of their last change [s].
        room: Arrays.
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
