"""Accelerations, multipliers and corrections under constraints, compiled.

With M = L L^T and J L^-T = R^T Q^T of independent rows
(:mod:`antenna_pin.dynamics.constraints.factor_kernels`)

    a = L^-T (z + Q mu),    z = L^-1 (tau - h),    R^T (Q^T z + mu) = lack,    R lambda = mu,

and corrections of least kinetic energy come from the same factors.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.compiled.lanes import LANES, lane, put_lane, same_lane, sum_of_lane
from antenna_pin.dynamics.constraints.driven_kernels import driven_rate
from antenna_pin.dynamics.constraints.factor_kernels import add_multiple, inner_product
from antenna_pin.dynamics.constraints.layout_kernels import driven_at, found_in, plan_of
from antenna_pin.dynamics.constraints.root_kernels import solve_back, solve_forth
from antenna_pin.elements.ledger_kernels import write_work

# Residuals that are not corrected, of displacements over the plan's length, angles, and their rates: the
# round-off of kinematics is some 1e-16 of the length.
CLOSED = 1e-14
ROUNDS = 8
NEAR = 1e-7
# Residual over the length of a state that counts as closed.
OPEN = 1e-11


@inlined
def _forward(plan: Floats, work: Floats, wanted: int, sign: float, out: Floats) -> None:
    """Solve R^T y = sign * wanted for the active rows; zero for others, (width,)."""
    head, rank = plan_of(plan), found_in(plan, work).rank
    width = head.width
    triangle = work[head.triangle : head.triangle + head.rows * width]
    for s in range(width):
        out[s] = 0.0
    for s in range(rank):
        out[s] = sign * work[wanted + int(work[head.order + s])]
    for p in range(rank):
        factor = out[p] * work[head.inverses + p]
        out[p] = factor
        # Before the place behind the diagonal the triangle has zeros.
        for c in range(p + 1 - (p + 1) % LANES, width, LANES):
            put_lane(out, c, lane(out, c) - factor * lane(triangle, p * width + c))
    for s in range(rank, width):
        out[s] = 0.0


@inlined
def _add_directions(plan: Floats, work: Floats, factors: Floats, out: Floats) -> None:
    """Add Q times as many factors as rows count to out, (span,)."""
    head = plan_of(plan)
    for p in range(found_in(plan, work).rank):
        add_multiple(factors[p], work, head.directions + p * head.span, out, head.span)


@inlined
def _from_reduced(plan: Floats, work: Floats, reduced: Floats, out: Floats) -> None:
    """Write L^-T of numbers into out[:nv]."""
    head = plan_of(plan)
    nv, root = head.nv, head.root
    for i in range(nv):
        out[i] = reduced[i]
    solve_back(nv, work[root : root + nv * nv], work[head.first : head.first + nv], out)


@kernel
def correction(plan: Floats, work: Floats, of_speed: bool, out: Floats) -> None:
    """Write the least-energy generalized step that removes residuals of position or velocity."""
    head = plan_of(plan)
    span, width, second = head.span, head.width, head.scratch + max(head.span, head.width)
    reduced, factors = work[head.scratch : head.scratch + span], work[second : second + width]
    _forward(plan, work, head.speed if of_speed else head.gap, -1.0, factors)
    for k in range(span):
        reduced[k] = 0.0
    _add_directions(plan, work, factors, reduced)
    _from_reduced(plan, work, reduced, out)


@kernel
def solve_rows(
    y: Floats, program: Floats, plan: Floats, work: Floats, effort: Floats, bias: Floats, rates: Floats
) -> None:
    """Write accelerations, powers of motions and multipliers, once rows are written and factorized.

    The arguments are those of :func:`antenna_pin.dynamics.constraints.loaded_kernels.accelerate`; friction of
    joints by their load is not included.
    """
    head = plan_of(plan)
    nv = head.nv
    free = work[head.scratch : head.scratch + head.span]
    for i in range(nv):
        free[i] = effort[i] - bias[i]
    _solve(plan, work, rates, work[head.force : head.force + head.rows])
    for m in range(head.motions):
        driven = driven_at(plan, m)
        rate = driven_rate(y, plan, work, driven)
        scale = 1.0 if driven.slides != 0 else head.length
        power = scale * work[head.force + driven.row] * rate
        write_work(power, rates, nv + driven.x)


@kernel
def solve_changes(plan: Floats, work: Floats, out: Floats, force: Floats) -> None:
    """Write changes of accelerations and multipliers, where rows are factorized.

    Changes of ``M a + h - J^T lambda = tau`` and of ``J a - lack`` at constant a and lambda act on
    accelerations and multipliers like forces and right sides.

    Args:
        plan: Plan of the constraints.
        work: With the factors, and minus the change of ``J a - lack`` in place of the right sides.
        out: Change of tau + J^T lambda - h - M a, (nv,); overwritten by that of accelerations.
        force: Written: change of the multipliers, (rows,).
    """
    head = plan_of(plan)
    free = work[head.scratch : head.scratch + head.span]
    for i in range(head.nv):
        free[i] = out[i]
    _solve(plan, work, out, force)


@inlined
def _solve(plan: Floats, work: Floats, rates: Floats, force: Floats) -> None:
    """Write accelerations and multipliers under forces that stand, (nv,), where numbers for scratch begin."""
    head = plan_of(plan)
    nv, rows, width, root = head.nv, head.rows, head.width, head.root
    rank = found_in(plan, work).rank
    span = head.span
    second = head.scratch + max(span, width)
    free, factors = work[head.scratch : head.scratch + span], work[second : second + width]
    triangle = work[head.triangle : head.triangle + rows * width]
    for i in range(nv, span):
        free[i] = 0.0
    solve_forth(nv, work[root : root + nv * nv], work[head.first : head.first + nv], free)
    _forward(plan, work, head.lack, 1.0, factors)
    # All inner products first: the directions are orthogonal up to round-off.
    for p in range(rank):
        factors[p] -= inner_product(work, head.directions + p * span, free, 0, span)
    _add_directions(plan, work, factors, free)
    _from_reduced(plan, work, free, rates)
    for r in range(rows):
        force[r] = 0.0
    for j in range(rank - 1, -1, -1):
        total = same_lane(0.0)
        for c in range(j + 1 - (j + 1) % LANES, width, LANES):
            total = total + lane(triangle, j * width + c) * lane(factors, c)
        factors[j] = (factors[j] - sum_of_lane(total)) * work[head.inverses + j]
        force[int(work[head.order + j])] = factors[j]
