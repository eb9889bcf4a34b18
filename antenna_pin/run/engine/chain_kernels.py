"""Propagation of tangents along successive steps, compiled, in adaptive parts."""

from __future__ import annotations

import math
from typing import NamedTuple

from antenna_pin.base.records import Floats
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.integrate.kernels import START, STATE
from antenna_pin.run.engine.carry_kernels import CarryRoom, carry_along

# Largest number of parts of a step, and margin of the error over the permitted one from which on the next
# step has half as many.
_PARTS, _BETTER = 4, 2.0**-7


@by_address
class ChainRoom(NamedTuple):
    """Steps along which displacements are carried one after another."""

    room: CarryRoom  # arrays of propagation, with errors by three stages
    full: CarryRoom  # the same, by all stages
    times: Floats  # starts of the steps, (steps,) [s]
    sizes: Floats  # step sizes, (steps,) [s]
    since: Floats  # times of the last change of contacts, drives or rates, (steps,) [s]
    until: Floats  # time of the next change, (1,) [s]
    states: Floats  # states at the starts, (steps, size)
    scales: Floats  # scales of the parts of a displacement in coordinates, (displacement,)
    first: Floats  # tangents at the start of a step, scratch, (k, displacement)
    booked: Floats  # change of the integrated numbers of the run in a step, scratch, (few, nx)
    books: Floats  # the same, summed


@inlined
def _worst(good: float, scales: Floats, room: CarryRoom) -> float:
    """Return the relative error of a step's tangents over the tolerance."""
    worst = 0.0
    for d in range(room.few.shape[0]):
        total = 0.0
        for k in range(room.now.shape[1]):
            total += (scales[k] * room.now[d, k]) ** 2
        most = good * math.sqrt(total)
        for kind in range(2):
            # Written so that NaN is not accurate either.
            if not room.sizes[kind, d] <= most:
                return math.inf
            if most > 0.0:
                worst = max(worst, room.sizes[kind, d] / most)
    return worst


@inlined
def _is_rapid(h: float, room: CarryRoom) -> bool:
    """Return whether errors of tangents vary too much in a step for three stages."""
    units, slopes = room.tangent.units, room.slopes
    for d in range(room.few.shape[0], room.now.shape[0]):
        size = 0.0
        for k in range(slopes.shape[2]):
            size += (room.ways[d, k] / units[k]) ** 2
        for i in range(room.asked.shape[0]):
            if room.asked[i] == 0:
                continue
            change = 0.0
            for k in range(slopes.shape[2]):
                change += (h * slopes[i, d, k] / units[k]) ** 2
            if not change <= size:
                return True
    return False


@inlined
def _set(ways: Floats, there: Floats) -> None:
    """Write displacements to others."""
    for d in range(ways.shape[0]):
        for k in range(ways.shape[1]):
            there[d, k] = ways[d, k]


@inlined
def _take(there: CarryRoom, room: CarryRoom) -> None:
    """Begin the next step with the tangents and errors at a step's end."""
    few = there.few.shape[0]
    for d in range(few):
        for k in range(there.errors.shape[1]):
            there.now[few + d, k] += there.errors[d, k] + there.rough[d, k]
    _set(there.now, room.ways)


@kernel
def _carry_in_parts(n: int, parts: int, good: float, chain: ChainRoom) -> float:
    """Propagate tangents along a step in equal parts; return the error as :func:`_worst`."""
    room, full, worst = chain.room, chain.full, 0.0
    stages, size = room.tableau.weights.shape[0], chain.sizes[n] / parts
    for k in range(chain.states.shape[1]):
        room.work[stages + STATE, k] = chain.states[n, k]
    chain.booked[:] = 0.0
    for i in range(parts):
        t = chain.times[n] + i * size
        carry_along(t, size, chain.until[0], chain.since[n], room)
        worst = max(worst, _worst(good, chain.scales, room))
        if not worst <= 1.0:
            return math.inf
        for d in range(chain.booked.shape[0]):
            for k in range(chain.booked.shape[1]):
                chain.booked[d, k] += room.books[d, k]
        if _is_rapid(size, room):
            _set(room.ways, full.ways)
            for k in range(chain.states.shape[1]):
                full.work[stages + STATE, k] = room.work[stages + START, k]
            carry_along(t, size, chain.until[0], chain.since[n], full)
            _take(full, room)
        else:
            _take(room, room)
    return worst


@kernel
def carry_chain(good: float, chain: ChainRoom) -> int:
    """Propagate tangents and their errors along consecutive steps.

    Args:
        good: Permitted error of the method, or of differences, in a step, relative to a tangent.
        chain: The steps, and the arrays of propagation, with the same work rows.

    Returns:
        Number of steps, up to one that is not accurate in any number of parts.
    """
    room, parts = chain.room, 1
    for n in range(chain.times.shape[0]):
        _set(room.ways, chain.first)
        worst = _carry_in_parts(n, parts, good, chain)
        while not worst <= 1.0:
            _set(chain.first, room.ways)
            parts *= 2
            if parts > _PARTS:
                return n
            worst = _carry_in_parts(n, parts, good, chain)
        if parts > 1 and worst < _BETTER:
            parts //= 2
        for d in range(chain.books.shape[0]):
            for k in range(chain.books.shape[1]):
                chain.books[d, k] += chain.booked[d, k]
    return int(chain.times.shape[0])
