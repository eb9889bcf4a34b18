"""Accelerations under constraints and friction by the joints' own load, compiled.

Let tau_j be the torques of friction by load of the slipping joints. Accelerations and multipliers are affine
in them, and so are the forces and moments W_i at the joints::

    W_i = W_i0 + sum_j W_ij tau_j,    tau_i = c_i N(W_i)

with N of :mod:`antenna_pin.elements.sticking_friction` and c_i a coefficient of friction against the rate.
W_i0 is the load without such friction, W_ij that of one unit torque; Newton's method from tau = 0 solves the
rest. N is convex: for one joint it converges, from the side of too little friction, to the solution of least
friction. Without a solution, or if Newton's matrix has lost its sign without friction (at a solution that no
growing friction leads to), accelerations are NaN, and the step fails.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.dynamics.constraints.carried_kernels import write_carried
from antenna_pin.dynamics.constraints.factor_kernels import factorize
from antenna_pin.dynamics.constraints.layout_kernels import Driven, PlanRecord, hold_at, plan_of
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.constraints.solve_kernels import solve_rows
from antenna_pin.elements import kernels as elements

# Rounds of Newton's method, which squares the error each time, and permitted error relative to the
# torques: some ulps.
_ROUNDS = 40
_RIGHT = 1e-15


@kernel
def accelerate(
    t: float,
    y: Floats,
    program: Floats,
    plan: Floats,
    work: Floats,
    effort: Floats,
    mass: Floats,
    bias: Floats,
    rates: Floats,
) -> None:
    """Write accelerations under constraints to rates[:nv], powers of motions behind; multipliers to work.

    Args:
        t: Time [s].
        y: State [q, v, x].
        program: Program of the system's elements.
        plan: Plan of the constraints.
        work: Written.
        effort: Generalized force of the elements, (nv,).
        mass: Mass matrix, (nv, nv).
        bias: Generalized force of gravity and velocities, M a + bias = effort + J^T lambda, (nv,).
        rates: Written, (nv + nx,).
    """
    write_rows(t, y, program, plan, work)
    factorize(plan, work, mass)
    solve(y, program, plan, work, effort, bias, rates)


@deferred
def solve(
    y: Floats, program: Floats, plan: Floats, work: Floats, effort: Floats, bias: Floats, rates: Floats
) -> None:
    """Do what :func:`accelerate` does once rows are written and factorized, with its arguments."""
    solve_rows(y, program, plan, work, effort, bias, rates)
    if plan_of(plan).loaded != 0:
        _bear(y, program, plan, work, effort, bias, rates)


@kernel
def _bear(
    y: Floats, program: Floats, plan: Floats, work: Floats, effort: Floats, bias: Floats, rates: Floats
) -> None:
    """Add load-dependent friction to a frictionless solution, and store the elements' loads."""
    head = plan_of(plan)
    nv, n = head.nv, head.holds
    at = head.loaded + 6 * head.bodies
    total, at = work[at : at + nv], at + nv
    tau, at = work[at : at + n], at + n
    carried, at = work[at : at + 6 * n * (n + 1)], at + 6 * n * (n + 1)
    room = work[at:]
    for k in range(nv):
        total[k] = effort[k]
    write_carried(program, plan, work, rates, room, carried)
    slipping = 0
    for j in range(n):
        tau[j] = 0.0
        own = hold_at(plan, j)
        if _rub(y, program, head, own) == 0.0:
            continue
        slipping += 1
        total[own.v] += 1.0
        solve_rows(y, program, plan, work, total, bias, rates)
        total[own.v] = effort[own.v]
        one = carried[6 * n * (j + 1) : 6 * n * (j + 2)]
        write_carried(program, plan, work, rates, room, one)
        for k in range(6 * n):
            one[k] -= carried[k]
    if slipping > 0:
        found = _newton(y, program, plan, carried, tau, room)
        for j in range(n):
            total[hold_at(plan, j).v] += tau[j]
        solve_rows(y, program, plan, work, total, bias, rates)
        if not found:
            for k in range(nv):
                rates[k] = math.nan
    for j in range(n):
        own = hold_at(plan, j)
        burden, _ = _burden(program, plan, own, carried, tau, j, -1)
        elements.bear(own.kind, program, own.words, burden)
        if tau[j] != 0.0:
            rates[nv + own.x] -= tau[j] * y[head.nq + own.v]
            work[head.force + own.row] = tau[j] / (1.0 if own.slides != 0 else head.length)


@inlined
def _rub(y: Floats, program: Floats, head: PlanRecord, own: Driven) -> float:
    """Return the torque of a hold's friction by its load, with its sign."""
    if program[own.words - 1] == 0.0:  # off by the last number of its head
        return 0.0
    states = y, head.nq + head.nv + own.x
    return float(elements.rub(own.kind, program, own.words, y[head.nq + own.v], states))


@kernel
def _newton(y: Floats, program: Floats, plan: Floats, carried: Floats, tau: Floats, room: Floats) -> bool:
    """Write the torques of load-dependent friction, starting at zero; return whether they converge."""
    head = plan_of(plan)
    n = head.holds
    for _ in range(_ROUNDS):
        step, size = 0.0, 0.0
        positive = True
        for i in range(n):
            own, row = hold_at(plan, i), i * (n + 1)
            factor = _rub(y, program, head, own)
            burden = 0.0
            if factor != 0.0:
                burden, _ = _burden(program, plan, own, carried, tau, i, -1)
            for j in range(n):
                slope = 0.0
                if factor != 0.0:
                    _, slope = _burden(program, plan, own, carried, tau, i, j)
                room[row + j] = (1.0 if i == j else 0.0) - factor * slope
            room[row + n] = factor * burden - tau[i]
        positive = _eliminate(n, room)
        for i in range(n):
            tau[i] += room[i * (n + 1) + n]
            step = max(step, abs(room[i * (n + 1) + n]))
            size = max(size, abs(tau[i]))
        if not math.isfinite(size):
            return False
        if step <= _RIGHT * size:
            return positive
    # It alternates by an ulp or two, or has no solution.
    return positive and step <= 64.0 * _RIGHT * size


@inlined
def _eliminate(n: int, room: Floats) -> bool:
    """Solve n equations in place, right sides behind the rows; return whether det > 0."""
    positive = True
    for p in range(n):
        best = p
        for i in range(p + 1, n):
            if abs(room[i * (n + 1) + p]) > abs(room[best * (n + 1) + p]):
                best = i
        if best != p:
            positive = not positive
            for k in range(n + 1):
                kept = room[p * (n + 1) + k]
                room[p * (n + 1) + k] = room[best * (n + 1) + k]
                room[best * (n + 1) + k] = kept
        pivot = room[p * (n + 1) + p]
        positive = positive == (pivot > 0.0)
        for i in range(n):
            if i != p:
                factor = room[i * (n + 1) + p] / pivot
                for k in range(p, n + 1):
                    room[i * (n + 1) + k] -= factor * room[p * (n + 1) + k]
    for p in range(n):
        room[p * (n + 1) + n] /= room[p * (n + 1) + p]
    return positive


@kernel
def _burden(
    program: Floats, plan: Floats, own: Driven, carried: Floats, tau: Floats, i: int, j: int
) -> tuple[float, float]:
    """Return the load N of hold i and its derivative over hold j's friction torque."""
    n = plan_of(plan).holds
    radial, axial, bending, _ = elements.bearing(own.kind, program, own.words)
    if radial == 0.0 and axial == 0.0:
        return 0.0, 0.0
    load, slope = 0.0, 0.0
    # Across the axis two components of force, then two of moment; along it one each. For a sliding joint the
    # moment along its axis counts like the others, the force along it does not.
    for part in range(3):
        weight = radial if part == 0 else (bending if part == 1 else axial)
        first, count = (0, 2) if part == 0 else ((2, 2) if part == 1 else (4, 1))
        if own.slides != 0 and part == 1:
            count = 4
        square, change = 0.0, 0.0
        for c in range(first, first + count):
            if own.slides != 0 and c == 4:
                continue
            at = 6 * i + c
            value = carried[at]
            for k in range(n):
                value += carried[6 * n * (k + 1) + at] * tau[k] if tau[k] != 0.0 else 0.0
            square += value * value
            if j >= 0:
                change += value * carried[6 * n * (j + 1) + at]
        size = math.sqrt(square)
        load += weight * size
        if size > 0.0:
            slope += weight * change / size
    return load, slope
