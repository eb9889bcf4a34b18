"""Accelerations, multipliers and corrections under constraints, compiled.

With M = L L^T the rows of J become those of ``J L^-T``, in which the kinetic energy is the sum of squares.
They are made orthogonal one after another, each time the one of which most is left (QR with pivoting, each
row twice): rows of which nothing is left are redundant and need not be held. So

    a = L^-T (z + Q mu),    z = L^-1 (tau - h),    R^T (Q^T z + mu) = lack,    R lambda = mu,

and corrections of least kinetic energy come from the same factors.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin._lanes import LANES, lane, put_lane, same_lane, sum_of_lane
from antenna_pin.constraints._layout_kernels import closure_at, driven_at, found_in, plan_of
from antenna_pin.constraints._rows_kernels import write_rows
from antenna_pin.elements._ledger_kernels import write_work

#: What is left of a row that depends on others, of its length, at most: of true redundancy it is round-off. A
#: row that is next to nothing beside those of its closure counts as far as it is something.
DEPENDENT = 1e-9
#: The same within a run, where a row is let go. The stages of a step are off the constraints by their errors,
#: and redundant rows by as much from what they depend on, which is more than round-off. And near a singular
#: position an equation that is all but lost turns round-off into accelerations, which lead from one way to go
#: on to another; let go of, it leaves an error of the order of this share's square.
FAINT = 1e-5
# Residuals below which nothing is corrected, of ways over the plan's length, turns, and their rates: the
# round-off of kinematics is some 1e-16 of the length.
CLOSED = 1e-14
ROUNDS = 8
NEAR = 1e-7
# Residual over the length that a state may have which counts as closed.
OPEN = 1e-11
#: Share of a row from which on what round-off has left in it of other directions is no more than round-off.
ENOUGH = 0.1
#: Size of the numbers of a row that says nothing, over the plan's length: round-off of products.
NOTHING = 1e-12


@inlined
def _inner(one: Any, at: int, other: Any, also_at: int, size: int) -> float:
    """Return the inner product of as many numbers, in whole lanes."""
    total = same_lane(0.0)
    for k in range(0, size, LANES):
        total = total + lane(one, at + k) * lane(other, also_at + k)
    return sum_of_lane(total)


@inlined
def _add(factor: float, one: Any, at: int, out: Any, size: int) -> None:
    """Add a factor times as many numbers, in whole lanes."""
    for k in range(0, size, LANES):
        put_lane(out, k, lane(out, k) + factor * lane(one, at + k))


@kernel
def factorize(plan: Any, work: Any, mass: Any) -> None:
    """Factorize rows that :func:`write_rows` has written, with the mass matrix, (nv, nv)."""
    head, found = plan_of(plan), found_in(plan, work)
    nv, span, rows, width, root = head.nv, head.span, head.rows, head.width, head.root
    left = work[head.reduced : head.reduced + span * width]
    triangle = work[head.triangle : head.triangle + rows * width]
    squares = work[head.squares : head.squares + width]
    weights = work[head.weights : head.weights + width]
    order = work[head.order : head.order + width]
    shares = work[head.shares : head.shares + width]
    own = work[head.scratch : head.scratch + span]
    write_root(mass, nv, work[root : root + nv * nv], work[head.first : head.first + nv])
    _reduce(plan, work, left, squares, weights)
    for r in range(rows):
        order[r] = r
    for k in range(nv, span):
        own[k] = 0.0
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
        _take(p, best, 1.0 / length, nv, span, own, left)
        for j in range(p):
            at = j * width
            triangle[at + p], triangle[at + best] = triangle[at + best], triangle[at + p]
        squares[best] = squares[p]
        weights[best] = weights[p]
        order[p], order[best] = order[best], order[p]
        if share < ENOUGH:
            length *= _clean(plan, work, p, length, own, triangle)
        work[head.diagonal + p] = 1.0 / length
        for k in range(0, span, LANES):
            put_lane(work, head.directions + p * span + k, lane(own, k))
        _take_out(p, span, width, own, left, triangle, squares)


@inlined
def write_root(mass: Any, nv: int, root: Any, first: Any) -> None:
    """Write L of M = L L^T row by row, (nv nv,), and where each row begins: limbs leave zeros in it.

    On the diagonal stand inverses.
    """
    for i in range(nv):
        row = i * nv
        begin = 0
        while begin < i and mass[i, begin] == 0.0:
            begin += 1
        first[i] = begin
        for j in range(begin, i):
            total = mass[i, j]
            for k in range(max(begin, int(first[j])), j):
                total -= root[row + k] * root[j * nv + k]
            root[row + j] = total * root[j * nv + j]
        total = mass[i, i]
        for k in range(begin, i):
            total -= root[row + k] * root[row + k]
        root[row + i] = 1.0 / math.sqrt(total)


@inlined
def _reduce(plan: Any, work: Any, left: Any, squares: Any, weights: Any) -> None:
    """Write L^-1 J^T, the squares of its rows' lengths, and by what these count.

    Of a row whose numbers are round-off all is zero.
    """
    head = plan_of(plan)
    nv, span, width = head.nv, head.span, head.width
    root = work[head.root : head.root + nv * nv]
    first = work[head.first : head.first + nv]
    rows = work[head.jacobian : head.jacobian + nv * width]
    largest = work[head.shares : head.shares + width]
    for r in range(width):
        largest[r] = 0.0
    for i in range(nv):
        for r in range(width):
            largest[r] = max(largest[r], abs(rows[i * width + r]))
    for c in range(0, width, LANES):
        at = c * span
        square = same_lane(0.0)
        for i in range(nv, span):
            put_lane(left, at + LANES * i, square)
        for i in range(nv):
            value = lane(rows, i * width + c)
            for k in range(int(first[i]), i):
                value = value - root[i * nv + k] * lane(left, at + LANES * k)
            value = root[i * nv + i] * value
            put_lane(left, at + LANES * i, value)
            square = square + value * value
        put_lane(squares, c, square)
    for r in range(head.rows):
        if not largest[r] > NOTHING * head.length:
            largest[r] = squares[r] = 0.0
            entry = _entry(r, span)
            for i in range(nv):
                left[entry + LANES * i] = 0.0
    for m in range(head.motions):
        _scale(largest, driven_at(plan, m).row, 1)
    for k in range(head.closures):
        closure = closure_at(plan, k)
        ways = closure.along[0] + closure.along[1] + closure.along[2]
        _scale(largest, closure.row, ways)
        _scale(largest, closure.row + ways, closure.rows - ways)
    for r in range(head.rows):
        weights[r] = largest[r] * largest[r] / squares[r] if squares[r] > 0.0 else 0.0


@inlined
def _scale(largest: Any, first: int, count: int) -> None:
    """Let a closure's rows of ways, or of turns, count by their numbers beside the largest of all.

    Where a row vanishes an equation is lost. Numbers of J are geometry: lengths, in which kinetic energies
    are squares, differ by any factor between ways that turn a body and those that move it.
    """
    most = 0.0
    for r in range(first, first + count):
        most = max(most, largest[r])
    for r in range(first, first + count):
        if largest[r] != 0.0:
            largest[r] /= most


@inlined
def _entry(s: int, span: int) -> int:
    """Return where the row at place s begins in what is left of rows; its next number is a lane further."""
    return (s - s % LANES) * span + s % LANES


@inlined
def _take(p: int, best: int, scale: float, nv: int, span: int, own: Any, left: Any) -> None:
    """Write a multiple of the row at place ``best`` to ``own``, and in its place that of place p."""
    entry, first = _entry(best, span), _entry(p, span)
    for k in range(nv):
        own[k] = scale * left[entry + LANES * k]
        left[entry + LANES * k] = left[first + LANES * k]


@inlined
def _clean(plan: Any, work: Any, p: int, length: float, own: Any, triangle: Any) -> float:
    """Take out of ``own``, the row at place p over its length, what round-off has left of the directions before.

    Of a row of which little was left that is round-off of most of it. Returns by how much it has shrunk.
    """
    head = plan_of(plan)
    span, first = head.span, head.directions
    for i in range(p):
        inner = _inner(work, first + i * span, own, 0, span)
        triangle[i * head.width + p] += length * inner
        _add(-inner, work, first + i * span, own, span)
    shrunk = math.sqrt(_inner(own, 0, own, 0, span))
    for k in range(span):
        own[k] /= shrunk
    return shrunk


@inlined
def _take_out(p: int, span: int, width: int, own: Any, left: Any, triangle: Any, squares: Any) -> None:
    """Take the direction p out of all rows behind it; write its row of R and the squares that are left."""
    behind, row = p + 1, p * width
    begin = behind - behind % LANES
    for c in range(0, begin, LANES):
        put_lane(triangle, row + c, same_lane(0.0))
    for c in range(begin, width, LANES):
        # In four sums: one alone would wait for each addition.
        a = b = d = e = same_lane(0.0)
        at = c * span
        for k in range(0, span, 4):
            a = a + own[k] * lane(left, at)
            b = b + own[k + 1] * lane(left, at + LANES)
            d = d + own[k + 2] * lane(left, at + 2 * LANES)
            e = e + own[k + 3] * lane(left, at + 3 * LANES)
            at += 4 * LANES
        inner = (a + b) + (d + e)
        put_lane(triangle, row + c, inner)
        a = b = d = e = same_lane(0.0)
        at = c * span
        for k in range(0, span, 4):
            one = lane(left, at) - own[k] * inner
            two = lane(left, at + LANES) - own[k + 1] * inner
            three = lane(left, at + 2 * LANES) - own[k + 2] * inner
            four = lane(left, at + 3 * LANES) - own[k + 3] * inner
            put_lane(left, at, one)
            put_lane(left, at + LANES, two)
            put_lane(left, at + 2 * LANES, three)
            put_lane(left, at + 3 * LANES, four)
            a, b, d, e = a + one * one, b + two * two, d + three * three, e + four * four
            at += 4 * LANES
        put_lane(squares, c, (a + b) + (d + e))
    # Places before that are directions: of their lane the numbers say nothing.
    for s in range(begin, behind):
        triangle[row + s] = 0.0


@inlined
def solve_forth(nv: int, root: Any, first: Any, out: Any) -> None:
    """Solve L x = out in place."""
    for i in range(nv):
        total = out[i]
        for k in range(int(first[i]), i):
            total -= root[i * nv + k] * out[k]
        out[i] = total * root[i * nv + i]


@inlined
def solve_back(nv: int, root: Any, first: Any, out: Any) -> None:
    """Solve L^T x = out in place."""
    for i in range(nv - 1, -1, -1):
        out[i] *= root[i * nv + i]
        for k in range(int(first[i]), i):
            out[k] -= root[i * nv + k] * out[i]


@inlined
def _forward(plan: Any, work: Any, wanted: int, sign: float, out: Any) -> None:
    """Solve R^T y = sign * wanted for the rows that count; zero stands for the others, (width,)."""
    head, rank = plan_of(plan), found_in(plan, work).rank
    width = head.width
    triangle = work[head.triangle : head.triangle + head.rows * width]
    for s in range(width):
        out[s] = 0.0
    for s in range(rank):
        out[s] = sign * work[wanted + int(work[head.order + s])]
    for p in range(rank):
        factor = out[p] * work[head.diagonal + p]
        out[p] = factor
        # Before the place behind the diagonal the triangle has zeros.
        for c in range(p + 1 - (p + 1) % LANES, width, LANES):
            put_lane(out, c, lane(out, c) - factor * lane(triangle, p * width + c))
    for s in range(rank, width):
        out[s] = 0.0


@inlined
def _add_directions(plan: Any, work: Any, factors: Any, out: Any) -> None:
    """Add Q times as many factors as rows count to out, (span,)."""
    head = plan_of(plan)
    for p in range(found_in(plan, work).rank):
        _add(factors[p], work, head.directions + p * head.span, out, head.span)


@inlined
def _from_reduced(plan: Any, work: Any, reduced: Any, out: Any) -> None:
    """Write L^-T of numbers into out[:nv]."""
    head = plan_of(plan)
    nv, root = head.nv, head.root
    for i in range(nv):
        out[i] = reduced[i]
    solve_back(nv, work[root : root + nv * nv], work[head.first : head.first + nv], out)


@kernel
def correction(plan: Any, work: Any, of_speed: bool, out: Any) -> None:
    """Write the generalized step that takes the residuals of position (of velocity) away, least in energy."""
    head = plan_of(plan)
    span, width, second = head.span, head.width, head.scratch + max(head.span, head.width)
    reduced, factors = work[head.scratch : head.scratch + span], work[second : second + width]
    _forward(plan, work, head.speed if of_speed else head.gap, -1.0, factors)
    for k in range(span):
        reduced[k] = 0.0
    _add_directions(plan, work, factors, reduced)
    _from_reduced(plan, work, reduced, out)


@kernel
def accelerate(
    t: float, y: Any, program: Any, plan: Any, work: Any, effort: Any, mass: Any, bias: Any, rates: Any
) -> None:
    """Write accelerations under constraints to rates[:nv], powers of motions behind; multipliers to work.

    Args:
        t: Time [s].
        y: State [q, v, x].
        program: Of the system's elements.
        plan: Of the constraints.
        work: To write to.
        effort: Generalized force of the elements, (nv,).
        mass: Mass matrix, (nv, nv).
        bias: Generalized force of gravity and velocities, M a + bias = effort + J^T lambda, (nv,).
        rates: To write to, (nv + nx,).
    """
    write_rows(t, y, program, plan, work)
    solve(y, program, plan, work, effort, mass, bias, rates)


@kernel
def solve(y: Any, program: Any, plan: Any, work: Any, effort: Any, mass: Any, bias: Any, rates: Any) -> None:
    """Do what :func:`accelerate` does once the rows are written, with its arguments."""
    head = plan_of(plan)
    nv, rows, width, root = head.nv, head.rows, head.width, head.root
    factorize(plan, work, mass)
    rank = found_in(plan, work).rank
    span = head.span
    second = head.scratch + max(span, width)
    free, factors = work[head.scratch : head.scratch + span], work[second : second + width]
    triangle = work[head.triangle : head.triangle + rows * width]
    for i in range(nv):
        free[i] = effort[i] - bias[i]
    for i in range(nv, span):
        free[i] = 0.0
    solve_forth(nv, work[root : root + nv * nv], work[head.first : head.first + nv], free)
    _forward(plan, work, head.lack, 1.0, factors)
    # All inner products first: the directions are at right angles but for round-off.
    for p in range(rank):
        factors[p] -= _inner(work, head.directions + p * span, free, 0, span)
    _add_directions(plan, work, factors, free)
    _from_reduced(plan, work, free, rates)
    for r in range(rows):
        work[head.force + r] = 0.0
    for j in range(rank - 1, -1, -1):
        total = same_lane(0.0)
        for c in range(j + 1 - (j + 1) % LANES, width, LANES):
            total = total + lane(triangle, j * width + c) * lane(factors, c)
        factors[j] = (factors[j] - sum_of_lane(total)) * work[head.diagonal + j]
        work[head.force + int(work[head.order + j])] = factors[j]
    for m in range(head.motions):
        driven = driven_at(plan, m)
        rate = y[head.nq + driven.v]
        scale = 1.0 if driven.slides != 0 else head.length
        power = scale * work[head.force + driven.row] * rate
        write_work(program, driven.words, rate, power, rates, nv + driven.x)
