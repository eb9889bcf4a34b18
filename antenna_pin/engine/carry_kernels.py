"""Displacements of a state carried along a step of a run, by the run's own method, compiled.

State and displacements w are one set of equations, y' = f(y) and ``w' = dv - [v, w]``, ``dv' = Df w``, and go
by the same stages: what comes of w is of the order of the method, and its embedded weights tell the error.
Next to where contacts begin or end the derivative Df goes with a root of time; there time goes with the
square of what is integrated over.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin._by_address import by_address
from antenna_pin._compile import inlined, kernel
from antenna_pin.engine.tangent_kernels import write_tangent
from antenna_pin.integrate.kernels import RATES, STATE, begin, stage, store
from antenna_pin.integrate.manifold_kernels import space_of, write_bracket


@by_address
class CarryRoom(NamedTuple):
    """What displacements are carried with.

    Attributes:
        tangent: What the derivative of the rates is computed with.
        tableau: The method's.
        work: The rows of a stepper; START, STATE and RATES are those of the state.
        ways: Displacements at the start, (k, displacement).
        now: Those at the stage; at the end those at the end.
        slopes: Rates of their ways, rates and bristles, by stage, (stages, k, moving).
        coarse: Over what a step of differences of each part must be one at most, (displacement,).
        steps: Of differences along them, (k,).
        books: How what is integrated along the run is displaced by the step, (k, nx).
        bracket: Scratch, (nv,).
        both: Derivatives of the rates, by differences of two orders, (2, k, nv + nx).
        errors: By how much the end is off, (k, moving).
        rough: By how much it would be by the other order of differences, (k, moving).
        sizes: Of these two, in units, (2, k).
    """

    tangent: Any
    tableau: Any
    work: Any
    ways: Any
    now: Any
    slopes: Any
    coarse: Any
    steps: Any
    books: Any
    bracket: Any
    both: Any
    errors: Any
    rough: Any
    sizes: Any


@by_address
class ChainRoom(NamedTuple):
    """Steps along which displacements are carried one after another.

    Attributes:
        room: What each is carried with: behind the displacements, as many, is what these are off by.
        times: When they begin, (steps,) [s].
        sizes: Of them, (steps,) [s].
        grades: How time goes in each, as in :func:`carry_along`, (steps,).
        origins: Likewise, (steps,).
        states: Where they begin, (steps, size).
        scales: Of the parts of a displacement in coordinates, (displacement,).
        books: How what is integrated along the run is displaced, so far, (k, nx).
    """

    room: Any
    times: Any
    sizes: Any
    grades: Any
    origins: Any
    states: Any
    scales: Any
    books: Any


@inlined
def _place(s: float, grade: int, origin: float) -> tuple[float, float]:
    """Return which part of the time has gone by at s, from 0 to 1, and how fast it goes there."""
    if grade == 0:
        return s, 1.0
    root = origin + (1.0 - origin) * (s if grade > 0 else 1.0 - s)
    rest = 1.0 - origin * origin
    place, speed = (root * root - origin * origin) / rest, 2.0 * (1.0 - origin) * root / rest
    return (place, speed) if grade > 0 else (1.0 - place, speed)


@inlined
def _displace(i: int, h: float, room: Any) -> None:
    """Write the displacements at stage i."""
    weights, slopes, now = room.tableau.weights, room.slopes, room.now
    for d in range(now.shape[0]):
        for k in range(slopes.shape[2]):
            total = 0.0
            for j in range(i):
                if weights[i, j] != 0.0:
                    total += weights[i, j] * slopes[j, d, k]
            now[d, k] = room.ways[d, k] + h * total


@inlined
def _note(i: int, h: float, speed: float, y: Any, room: Any) -> None:
    """Note how fast the displacements change at stage i, over what is integrated over.

    By how much the two orders of differences part there is added up, by the stage's share in the step; and
    what acts on nothing.
    """
    tangent, now, both = room.tangent, room.now, room.both
    space = space_of(tangent.layout)
    nq, nv = space.nq, space.nv
    v = y[nq : nq + nv]
    part = h * speed * room.tableau.weights[room.tableau.last, i]
    share = abs(part)
    for d in range(now.shape[0]):
        out, rough = room.slopes[i, d], room.rough[d]
        write_bracket(tangent.layout, v, now[d], room.bracket)
        for k in range(nv):
            out[k] = speed * (now[d, nv + k] - room.bracket[k])
            out[nv + k] = speed * both[0, d, k]
            rough[nv + k] += share * abs(both[1, d, k] - both[0, d, k])
        for k in range(tangent.bristles.shape[0]):
            at = nv + tangent.bristles[k]
            out[2 * nv + k] = speed * both[0, d, at]
            rough[2 * nv + k] += share * abs(both[1, d, at] - both[0, d, at])
        if part != 0.0:
            for k in range(room.books.shape[1]):
                room.books[d, k] += part * both[0, d, nv + k]


@inlined
def _judge(h: float, room: Any) -> None:
    """Write by how much displacements are off by the method, and the sizes of that and of roughness."""
    weights, slopes, units = room.tableau.errors, room.slopes, room.tangent.units
    for d in range(slopes.shape[1]):
        first, second = 0.0, 0.0
        for k in range(slopes.shape[2]):
            one, other = 0.0, 0.0
            for j in range(room.tableau.last + 1):
                one += weights[0, j] * slopes[j, d, k]
                if weights.shape[0] == 2:
                    other += weights[1, j] * slopes[j, d, k]
            room.errors[d, k] = h * one
            first += (one / units[k]) ** 2
            second += (other / units[k]) ** 2
        share, parted = 1.0, 0.0
        if weights.shape[0] == 2 and first + second > 0.0:
            # Of order 8(5,3), as the run's own.
            share = math.sqrt(first / (first + 0.01 * second))
        for k in range(slopes.shape[2]):
            room.errors[d, k] *= share
            parted += (room.rough[d, k] / units[k]) ** 2
        room.sizes[0, d] = abs(h) * math.sqrt(first) * share
        room.sizes[1, d] = math.sqrt(parted)


@inlined
def _prepare(room: Any) -> None:
    """Choose steps of differences of what is differentiated as a whole, and let constant parts be."""
    for d in range(room.ways.shape[0]):
        largest = 0.0
        for k in range(room.ways.shape[1]):
            room.now[d, k] = room.ways[d, k]
            largest = max(largest, room.coarse[k] * abs(room.ways[d, k]))
        room.steps[d] = 1.0 / largest if largest > 0.0 else 1.0


@kernel
def carry_along(t: float, h: float, grade: int, origin: float, room: Any) -> None:
    """Carry displacements along a step.

    Args:
        t: Where it begins [s]; the state is in the row STATE of the work rows.
        h: Its size [s].
        grade: Whether time goes with the square of what is integrated over, from an instant before the start
            on, 1, or back from one behind the end, -1; or evenly, 0.
        origin: Where that instant is: the root of the time from there to the nearer end of the step over
            that to the other, [0, 1).
        room: What to carry with.
    """
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
        if speed != 0.0:
            write_tangent(t + place * h, y, room.now, room.steps, tangent, room.both)
            for k in range(space.nv):
                rates[k] = tangent.acceleration[k]
            for k in range(space.nx):
                rates[space.nv + k] = tangent.drift[k]
        _note(i, h, speed, y, room)
        if i == 0:
            begin(stages, layout, work)
        else:
            store(i, stages, layout, work)
        for k in range(n):
            work[i, k] *= speed
    _judge(h, room)


@inlined
def _is_good(good: float, chain: Any) -> bool:
    """Whether a step's displacements are known well enough, and every contact that touches has a force."""
    room, half = chain.room, chain.room.now.shape[0] // 2
    for d in range(half):
        total = 0.0
        for k in range(room.now.shape[1]):
            total += (chain.scales[k] * room.now[d, k]) ** 2
        most = good * math.sqrt(total)
        # Written so that what is no number fails too.
        if not (room.sizes[0, d] <= most and room.sizes[1, d] <= most):
            return False
    memory, own = room.tangent.numbers.memory, room.tangent.numbers.own
    for c in range(memory.shape[0]):
        if memory[c].touching != 0.0 and own[c].force == 0.0:
            return False
    return True


@kernel
def carry_chain(good: float, chain: Any) -> int:
    """Carry displacements, and what they are off by, along steps one after another.

    Args:
        good: What the method, or differences, may be off by in a step, over a displacement.
        chain: The steps, and what to carry with.

    Returns:
        Along how many: up to one in which they are not known well enough, or at whose end a contact that
        touches has no force.
    """
    room = chain.room
    place, half = room.tableau.weights.shape[0] + STATE, room.ways.shape[0] // 2
    for n in range(chain.times.shape[0]):
        for k in range(chain.states.shape[1]):
            room.work[place, k] = chain.states[n, k]
        carry_along(chain.times[n], chain.sizes[n], chain.grades[n], chain.origins[n], room)
        if not _is_good(good, chain):
            return n
        for d in range(half):
            for k in range(room.errors.shape[1]):
                room.now[half + d, k] += room.errors[d, k] + room.rough[d, k]
            for k in range(chain.books.shape[1]):
                chain.books[d, k] += room.books[d, k]
        for d in range(room.ways.shape[0]):
            for k in range(room.ways.shape[1]):
                room.ways[d, k] = room.now[d, k]
    return int(chain.times.shape[0])
