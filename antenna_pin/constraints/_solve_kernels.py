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
def _inner(one: Any, other: Any) -> float:
    """Return an inner product, in four sums: one alone would wait for each addition."""
    a = b = c = d = 0.0
    n = one.shape[0]
    whole = n - n % 4
    for k in range(0, whole, 4):
        a += one[k] * other[k]
        b += one[k + 1] * other[k + 1]
        c += one[k + 2] * other[k + 2]
        d += one[k + 3] * other[k + 3]
    for k in range(whole, n):
        a += one[k] * other[k]
    return (a + b) + (c + d)


@kernel
def factorize(plan: Any, work: Any, mass: Any) -> None:
    """Factorize rows that :func:`write_rows` has written, with the mass matrix, (nv, nv)."""
    head, found = plan_of(plan), found_in(plan, work)
    nv, rows, root = head.nv, head.rows, head.root
    write_root(mass, nv, work[root : root + nv * nv], work[head.first : head.first + nv])
    for r in range(rows):
        _reduce(plan, work, r)
        work[head.order + r] = r
    for m in range(head.motions):
        _scale(plan, work, driven_at(plan, m).row, 1)
    for c in range(head.closures):
        closure = closure_at(plan, c)
        ways = closure.along[0] + closure.along[1] + closure.along[2]
        _scale(plan, work, closure.row, ways)
        _scale(plan, work, closure.row + ways, closure.rows - ways)
    found.rank = 0
    found.least = 1.0
    found.most = 0.0
    for p in range(rows):
        best, most = p, -1.0
        for s in range(p, rows):
            r = int(work[head.order + s])
            share = work[head.lengths + 2 * r]
            if share > most:
                best, most = s, share
        if not most > FAINT:
            found.most = max(most, 0.0)
            break
        r = int(work[head.order + best])
        work[head.order + best] = work[head.order + p]
        work[head.order + p] = r
        found.least = min(found.least, most)
        found.rank = p + 1
        _orthogonalize(plan, work, p, r, most)


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
def _scale(plan: Any, work: Any, first: int, count: int) -> None:
    """Let a closure's rows of ways, or of turns, count by their numbers beside the largest of all.

    Where a row vanishes an equation is lost. Numbers of J are geometry: lengths, in which kinetic energies
    are squares, differ by any factor between ways that turn a body and those that move it.
    """
    lengths = plan_of(plan).lengths
    largest = 0.0
    for r in range(first, first + count):
        largest = max(largest, work[lengths + 2 * r])
    for r in range(first, first + count):
        if work[lengths + 2 * r] != 0.0:
            work[lengths + 2 * r] /= largest
            work[lengths + 2 * r + 1] /= work[lengths + 2 * r]


@inlined
def _reduce(plan: Any, work: Any, r: int) -> None:
    """Write L^-1 J_r^T, its length, and the largest number of J_r; zero if that is round-off."""
    head = plan_of(plan)
    nv, root = head.nv, head.root
    row, out = head.jacobian + r * nv, head.reduced + r * nv
    largest = 0.0
    for k in range(nv):
        work[out + k] = work[row + k]
        largest = max(largest, abs(work[row + k]))
    square = solve_forth(
        nv, work[root : root + nv * nv], work[head.first : head.first + nv], work[out : out + nv]
    )
    work[head.lengths + 2 * r] = largest if largest > NOTHING * head.length else 0.0
    work[head.lengths + 2 * r + 1] = math.sqrt(square)
    for p in range(head.rows):
        work[head.triangle + p * head.rows + r] = 0.0


@inlined
def solve_forth(nv: int, root: Any, first: Any, out: Any) -> float:
    """Solve L x = out in place; return the square of its length."""
    begin = 0
    while begin < nv and out[begin] == 0.0:
        begin += 1
    square = 0.0
    for i in range(begin, nv):
        total = out[i]
        for k in range(max(begin, int(first[i])), i):
            total -= root[i * nv + k] * out[k]
        total *= root[i * nv + i]
        out[i] = total
        square += total * total
    return square


@inlined
def _orthogonalize(plan: Any, work: Any, p: int, r: int, share: float) -> None:
    """Make row r, of which that share is left, the direction p, and take it out of all rows after it."""
    head = plan_of(plan)
    nv, rows, reduced, triangle = head.nv, head.rows, head.reduced, head.triangle
    own = work[reduced + r * nv : reduced + (r + 1) * nv]
    # What round-off has left of the directions before it: of most of a row that is round-off.
    for i in range(p if share < ENOUGH else 0):
        at = reduced + int(work[head.order + i]) * nv
        other = work[at : at + nv]
        inner = _inner(other, own)
        work[triangle + i * rows + r] += inner
        for k in range(nv):
            own[k] -= inner * other[k]
    length = math.sqrt(_inner(own, own))
    work[triangle + p * rows + r] = length
    for k in range(nv):
        own[k] /= length
    for s in range(p + 1, rows):
        later = int(work[head.order + s])
        if work[head.lengths + 2 * later] == 0.0:
            continue
        at = reduced + later * nv
        other = work[at : at + nv]
        inner = _inner(own, other)
        work[triangle + p * rows + later] = inner
        if inner == 0.0:
            continue
        for k in range(nv):
            other[k] -= inner * own[k]
        scale = work[head.lengths + 2 * later + 1]
        before = work[head.lengths + 2 * later] * scale
        left = before * before - inner * inner
        if left < 0.5 * before * before:  # a difference of what is alike: measured instead
            left = _inner(other, other)
        work[head.lengths + 2 * later] = math.sqrt(left) / scale


@inlined
def _forward(plan: Any, work: Any, wanted: int, sign: float, at: int) -> None:
    """Solve R^T y = sign * wanted for the rows that count; y to work[at:]."""
    head, rank = plan_of(plan), found_in(plan, work).rank
    for j in range(rank):
        r = int(work[head.order + j])
        total = sign * work[wanted + r]
        for p in range(j):
            total -= work[head.triangle + p * head.rows + r] * work[at + p]
        work[at + j] = total / work[head.triangle + j * head.rows + r]


@inlined
def solve_back(nv: int, root: Any, first: Any, out: Any) -> None:
    """Solve L^T x = out in place."""
    for i in range(nv - 1, -1, -1):
        out[i] *= root[i * nv + i]
        for k in range(int(first[i]), i):
            out[k] -= root[i * nv + k] * out[i]


@inlined
def _from_reduced(plan: Any, work: Any, at: int, out: Any) -> None:
    """Write L^-T of the numbers at work[at:] into out[:nv]."""
    head = plan_of(plan)
    nv, root = head.nv, head.root
    for i in range(nv):
        out[i] = work[at + i]
    solve_back(nv, work[root : root + nv * nv], work[head.first : head.first + nv], out)


@kernel
def correction(plan: Any, work: Any, of_speed: bool, out: Any) -> None:
    """Write the generalized step that takes the residuals of position (of velocity) away, least in energy."""
    head = plan_of(plan)
    nv, first = head.nv, head.scratch
    second = first + max(nv, head.rows)
    _forward(plan, work, head.speed if of_speed else head.gap, -1.0, second)
    for k in range(nv):
        work[first + k] = 0.0
    for p in range(found_in(plan, work).rank):
        direction = head.reduced + int(work[head.order + p]) * nv
        for k in range(nv):
            work[first + k] += work[second + p] * work[direction + k]
    _from_reduced(plan, work, first, out)


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
    head = plan_of(plan)
    nv, rows, root, first = head.nv, head.rows, head.root, head.scratch
    second = first + max(nv, rows)
    write_rows(t, y, program, plan, work)
    factorize(plan, work, mass)
    rank = found_in(plan, work).rank
    for i in range(nv):
        work[first + i] = effort[i] - bias[i]
    solve_forth(nv, work[root : root + nv * nv], work[head.first : head.first + nv], work[first : first + nv])
    _forward(plan, work, head.lack, 1.0, second)
    for p in range(rank):
        direction = head.reduced + int(work[head.order + p]) * nv
        inner = 0.0
        for k in range(nv):
            inner += work[direction + k] * work[first + k]
        work[second + p] -= inner
    # All inner products first: the directions are at right angles but for round-off.
    for p in range(rank):
        direction = head.reduced + int(work[head.order + p]) * nv
        for k in range(nv):
            work[first + k] += work[second + p] * work[direction + k]
    _from_reduced(plan, work, first, rates)
    for r in range(rows):
        work[head.force + r] = 0.0
    for j in range(rank - 1, -1, -1):
        total = work[second + j]
        for i in range(j + 1, rank):
            r = int(work[head.order + i])
            total -= work[head.triangle + j * rows + r] * work[head.force + r]
        r = int(work[head.order + j])
        work[head.force + r] = total / work[head.triangle + j * rows + r]
    for m in range(head.motions):
        driven = driven_at(plan, m)
        rate = y[head.nq + driven.v]
        scale = 1.0 if driven.slides != 0 else head.length
        power = scale * work[head.force + driven.row] * rate
        write_work(program, driven.words, rate, power, rates, nv + driven.x)
