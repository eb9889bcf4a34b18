"""Orthogonal rows of constraints, compiled: J L^-T = R^T Q^T, and the rank.

With M = L L^T the rows of J become those of ``J L^-T``, in which the kinetic energy is the sum of squares.
They are made orthogonal one after another, each time the one with the largest remainder (modified
Gram-Schmidt with pivoting; Golub and Van Loan (2013), Matrix Computations, sections 5.2.8 and 5.4.2); small
remainders are orthogonalised once more. Rows without a remainder are redundant and need not be held.

A direction is removed from all later rows, four rows at a time (:mod:`antenna_pin.compiled.lanes`).
"""

from __future__ import annotations

import math

import numpy as np

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.compiled.lanes import LANES, lane, put_lane, same_lane, sum_of_lane
from antenna_pin.dynamics.constraints.layout_kernels import (
    Coupled,
    closure_at,
    coupled_at,
    driven_at,
    found_in,
    hold_at,
    plan_of,
)
from antenna_pin.dynamics.constraints.root_kernels import write_root

#: Largest remainder of a dependent row, relative to its length: round-off for true redundancy. A row that is
#: small beside those of its closure counts by its size.
DEPENDENT = 1e-9
#: The same within a run, where a row is dropped. Stages of a step violate constraints by their errors, and
#: redundant rows deviate as much from their dependence, which is more than round-off. Near a singular
#: position an almost lost equation amplifies round-off to accelerations, which lead from one branch to
#: another; dropping it leaves an error of the order of this share's square.
FAINT = 1e-5
#: Share of a row above which its components along other directions are round-off only.
ENOUGH = 0.1
#: Size of the numbers of an empty row, over the plan's length: round-off of products.
NOTHING = 1e-12


@inlined
def inner_product(one: Floats, at: int, other: Floats, also_at: int, size: int) -> float:
    """Return the inner product of as many numbers, in whole lanes."""
    total = same_lane(0.0)
    for k in range(0, size, LANES):
        total = total + lane(one, at + k) * lane(other, also_at + k)
    return sum_of_lane(total)


@inlined
def add_multiple(factor: float, one: Floats, at: int, out: Floats, size: int) -> None:
    """Add a factor times as many numbers, in whole lanes."""
    for k in range(0, size, LANES):
        put_lane(out, k, lane(out, k) + factor * lane(one, at + k))


@kernel
def brace(plan: Floats, mass: Floats) -> None:
    """Add terms to a mass matrix, (nv, nv), in place, that couplings make ineffective.

    That is ``c j^T j`` for the row j of each coupling, with its mass c. As ``j a = 0``, neither accelerations
    nor velocities that satisfy it are affected, nor are multipliers. A tree that is singular without its
    couplings, as a finger of knuckles without mass, becomes regular if it is regular with them.
    """
    head = plan_of(plan)
    for k in range(head.couplings):
        own = coupled_at(plan, k)
        if own.brace == 0.0:
            continue
        factor = own.brace * (own.scale * (1.0 if own.slides != 0 else head.length)) ** 2
        for a in range(3):
            first = _slope(own, a)
            for b in range(3):
                mass[own.v[a], own.v[b]] += factor * first * _slope(own, b)


@inlined
def _slope(own: Coupled, k: int) -> float:
    """Return coefficients of a coupling's follower, leader and second leader before scaling."""
    if k == 0:
        return 1.0
    return -float(own.multiplier) if k == 1 else -float(own.second)


@kernel
def factorize(plan: Floats, work: Floats, mass: Floats) -> None:
    """Factorize rows that :func:`write_rows` has written, with the mass matrix, (nv, nv), which is braced."""
    head, found = plan_of(plan), found_in(plan, work)
    brace(plan, mass)
    nv, span, rows, width, root = head.nv, head.span, head.rows, head.width, head.root
    left = work[head.reduced : head.reduced + nv * width]
    triangle = work[head.triangle : head.triangle + rows * width]
    squares = work[head.squares : head.squares + width]
    weights = work[head.weights : head.weights + width]
    order = work[head.order : head.order + width]
    shares = work[head.shares : head.shares + width]
    numbers = work[head.scratch : head.scratch + nv]
    second = head.scratch + max(span, width)
    at = work[second : second + nv].view(np.int64)
    write_root(mass, nv, work[root : root + nv * nv], work[head.first : head.first + nv])
    _reduce(plan, work, left, squares, weights)
    for r in range(rows):
        order[r] = r
    found.rank = 0
    found.least = 1.0
    found.most = 0.0
    for p in range(rows):
        most = -1.0
        for s in range(p, rows):
            most = max(most, weights[s] * squares[s])
        share = math.sqrt(max(most, 0.0))
        if not share > FAINT:
            found.most = share
            for s in range(p, rows):
                shares[int(order[s])] = math.sqrt(weights[s] * squares[s])
            break
        best = p
        while weights[best] * squares[best] != most:
            best += 1
        shares[int(order[best])] = share
        found.least = min(found.least, share)
        found.rank = p + 1
        length = math.sqrt(squares[best])
        own = work[head.directions + p * span : head.directions + (p + 1) * span]
        _take(p, best, 1.0 / length, nv, own, left)
        for j in range(0, p * width, width):
            triangle[j + p], triangle[j + best] = triangle[j + best], triangle[j + p]
        squares[best] = squares[p]
        weights[best] = weights[p]
        order[p], order[best] = order[best], order[p]
        if share < ENOUGH:
            length *= _clean(plan, work, p, length, own, triangle)
        work[head.inverses + p] = 1.0 / length
        count = _gather(nv, own, numbers, at)
        _take_out(p, nv, width, (count, numbers, at), left, triangle, squares)


@inlined
def _reduce(plan: Floats, work: Floats, left: Floats, squares: Floats, weights: Floats) -> None:
    """Write L^-1 J^T, its rows' squared lengths, and their scales; rows of round-off are zero."""
    head = plan_of(plan)
    nv, width = head.nv, head.width
    root = work[head.root : head.root + nv * nv]
    first = work[head.first : head.first + nv]
    rows = work[head.jacobian : head.jacobian + nv * width]
    largest = work[head.shares : head.shares + width]
    for r in range(width):
        largest[r] = 0.0
    for i in range(nv):
        for r in range(width):
            largest[r] = max(largest[r], abs(rows[i * width + r]))
    for r in range(width):
        squares[r] = 0.0
    for i in range(nv):
        for c in range(0, width, LANES):
            at = c * nv
            value = lane(rows, i * width + c)
            for k in range(int(first[i]), i):
                value = value - root[i * nv + k] * lane(left, at + LANES * k)
            value = root[i * nv + i] * value
            put_lane(left, at + LANES * i, value)
            put_lane(squares, c, lane(squares, c) + value * value)
    for r in range(head.rows):
        if not largest[r] > NOTHING * head.length:
            largest[r] = squares[r] = 0.0
            entry = _entry(r, nv)
            for i in range(nv):
                left[entry + LANES * i] = 0.0
    for m in range(head.motions):
        _scale(largest, driven_at(plan, m).row, 1)
    for k in range(head.couplings):
        _scale(largest, coupled_at(plan, k).row, 1)
    for k in range(head.closures):
        closure = closure_at(plan, k)
        ways = closure.along[0] + closure.along[1] + closure.along[2]
        _scale(largest, closure.row, ways)
        _scale(largest, closure.row + ways, closure.rows - ways)
    for k in range(head.holds):
        _scale(largest, hold_at(plan, k).row, 1)
    for r in range(head.rows):
        weights[r] = largest[r] * largest[r] / squares[r] if squares[r] > 0.0 else 0.0


@inlined
def _scale(largest: Floats, row: int, count: int) -> None:
    """Scale a closure's translational or rotational rows by their largest number.

    If a row vanishes, an equation is lost. Numbers of J are geometry: lengths, in which kinetic energies are
    squares, differ by any factor between displacements that rotate a body and those that move it.
    """
    most = 0.0
    for r in range(row, row + count):
        most = max(most, largest[r])
    for r in range(row, row + count):
        if largest[r] != 0.0:
            largest[r] /= most


@inlined
def _entry(s: int, nv: int) -> int:
    """Return the start of the row at place s in the remaining rows."""
    return (s - s % LANES) * nv + s % LANES


@inlined
def _take(p: int, best: int, scale: float, nv: int, own: Floats, left: Floats) -> None:
    """Write a multiple of the row at ``best`` to ``own``, and swap in row p."""
    entry, first = _entry(best, nv), _entry(p, nv)
    for k in range(nv):
        own[k] = scale * left[entry + LANES * k]
        left[entry + LANES * k] = left[first + LANES * k]
    for k in range(nv, own.shape[0]):
        own[k] = 0.0


@inlined
def _gather(nv: int, own: Floats, numbers: Floats, at: Ints) -> int:
    """Write the nonzero numbers of a direction and their lanes; return their count.

    Rows depend on some freedoms only: those of their limbs.
    """
    count = 0
    for k in range(nv):
        numbers[count] = own[k]
        at[count] = LANES * k
        count += 1 if own[k] != 0.0 else 0
    return count


@inlined
def _clean(plan: Floats, work: Floats, p: int, length: float, own: Floats, triangle: Floats) -> float:
    """Remove round-off components of earlier directions from ``own``, normalized row p.

    In a row with a small remainder they are most of it. Returns the factor of its shortening.
    """
    head = plan_of(plan)
    span, first = head.span, head.directions
    for i in range(p):
        inner = inner_product(work, first + i * span, own, 0, span)
        triangle[i * head.width + p] += length * inner
        add_multiple(-inner, work, first + i * span, own, span)
    shrunk = math.sqrt(inner_product(own, 0, own, 0, span))
    for k in range(head.nv):
        own[k] /= shrunk
    return shrunk


@inlined
def _take_out(
    p: int,
    nv: int,
    width: int,
    direction: tuple[int, Floats, Ints],
    left: Floats,
    triangle: Floats,
    squares: Floats,
) -> None:
    """Project direction p out of all later rows; write its row of R.

    ``direction`` is the number of its nonzero numbers, these, and their places.
    """
    count, numbers, at = direction
    behind, row = p + 1, p * width
    begin, even = behind - behind % LANES, count - count % 2
    for c in range(0, begin, LANES):
        put_lane(triangle, row + c, same_lane(0.0))
    for c in range(begin, width, LANES):
        # Two sums: a single one would wait for each addition.
        a = b = same_lane(0.0)
        for n in range(0, even, 2):
            a = a + numbers[n] * lane(left, c * nv + at[n])
            b = b + numbers[n + 1] * lane(left, c * nv + at[n + 1])
        for n in range(even, count):
            a = a + numbers[n] * lane(left, c * nv + at[n])
        inner = a + b
        put_lane(triangle, row + c, inner)
        # Rows of other limbs have no component along it.
        if sum_of_lane(inner * inner) == 0.0:
            continue
        for n in range(count):
            put_lane(left, c * nv + at[n], lane(left, c * nv + at[n]) - numbers[n] * inner)
        a = b = same_lane(0.0)
        for k in range(c * nv, (c + LANES) * nv - LANES, 2 * LANES):
            one, other = lane(left, k), lane(left, k + LANES)
            a, b = a + one * one, b + other * other
        if nv % 2 != 0:
            one = lane(left, (c + LANES) * nv - LANES)
            a = a + one * one
        put_lane(squares, c, a + b)
    # Earlier places are directions: the numbers of their lane are unused.
    for s in range(begin, behind):
        triangle[row + s] = 0.0
