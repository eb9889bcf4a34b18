"""Arithmetic of Lie-group Runge-Kutta steps, compiled.

A state ``y = [q, v, x]`` has a configuration on a manifold, a velocity in its tangent space and plain numbers
``x`` (quadratures, bristles). Within a step it is written in a chart about the step's start,

    q = q0 o exp(u),   z = [u, v, x],   z(0) = [0, v0, x0],

and u' follows from v by the inverse of the exponential's derivative. So z obeys an ordinary differential
equation in a vector space, to which any Runge-Kutta method applies with its full order, dense output included
(the method of Runge, Kutta, Munthe-Kaas).

``layout`` is the manifold's (:mod:`antenna_pin.integrate.manifold_kernels`). The rows of ``work`` are the
stages' rates and, behind them, U, START, TOTAL, STATE, RATES and ERRORS (see below): one array, because each
argument of a compiled function costs a part of what it computes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin.base.records import PLANE, RIGID, ROTATION, VECTOR, Floats, Ints
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.compiled.lanes import LANES, lane_of_row, put_lane_of_row, same_lane
from antenna_pin.integrate.manifold_kernels import (
    Factor,
    chart_rate,
    factor_of,
    retract,
    retract_factor,
    space_of,
)

# Rows of the work array behind the stages' rates.
U = 0  # chart coordinates of the state being evaluated
START = 1  # the state at the start of the step
TOTAL = 2  # scratch; the components' magnitudes at the end of a step
STATE = 3  # the state being evaluated
RATES = 4  # its derivative
ERRORS = 5  # sums of stages by the weights of the error, two rows
EXTRA_ROWS = 7
# Rows of a state from dense output: the state, and scratch (typed, for the compiler).
STATE_ROW: Any = np.int64(0)
CHART_ROW: Any = np.int64(1)
FIRST_STAGE: Any = np.int64(0)
# Components summed at a time, in two lanes.
_BLOCK: Any = np.int64(2 * LANES)

#: A step with dense output: layout of states, coefficients, work rows, row of the start, rows to write to.
DenseStep = tuple[Ints, Floats, Floats, int, Floats]


@kernel
def begin(stages: int, layout: Ints, work: Floats) -> None:
    """Make the present state a step's start, with its derivative as first stage."""
    space = space_of(layout)
    for k in range(space.nq + space.nv + space.nx):
        work[stages + START, k] = work[stages + STATE, k]
    for k in range(space.nv):
        work[stages + U, k] = 0.0
    store(FIRST_STAGE, stages, layout, work)


@inlined
def store(i: int, stages: int, layout: Ints, work: Floats) -> None:
    """Store the derivative just evaluated as stage i."""
    space = space_of(layout)
    nv = space.nv
    chart_rate(layout, work, stages + U, work, stages + STATE, work, i)
    for k in range(nv + space.nx):
        work[i, nv + k] = work[stages + RATES, k]


@kernel
def stage(i: int, h: float, weights: Floats, layout: Ints, work: Floats, keep: bool) -> None:
    """Store the derivative of stage i - 1 and write the state of stage i."""
    space = space_of(layout)
    nq, nv, nx = space.nq, space.nv, space.nx
    stages = weights.shape[0]
    if keep:
        store(i - 1, stages, layout, work)
    n = nv + nv + nx
    total = stages + TOTAL
    k = 0
    while k < n:
        if n >= _BLOCK:
            _sum_lanes(i, h, weights, work, total, min(k, n - _BLOCK))
            k += _BLOCK
            continue
        last = 0.0
        for j in range(i):
            w = h * weights[i, j]
            if w != 0.0:
                last += w * work[j, k]
        work[total, k] = last
        k += 1
    for k in range(nv):
        work[stages + U, k] = work[total, k]
    for k in range(nv + nx):
        work[stages + STATE, nq + k] = work[stages + START, nq + k] + work[total, nv + k]
    retract(layout, work, stages + START, work, total, work, stages + STATE)


@inlined
def _sum_lanes(i: int, h: float, weights: Floats, work: Floats, total: int, k: int) -> None:
    """Write the weighted sum of stages before stage i, for lanes from k on.

    The sums stay in the processor's registers, where those of whole rows would be read and written for each
    stage. The last block overlaps the one before: its sums are the same.
    """
    one, other = same_lane(0.0), same_lane(0.0)
    for j in range(i):
        w = h * weights[i, j]
        if w != 0.0:
            one = one + w * lane_of_row(work, j, k)
            other = other + w * lane_of_row(work, j, k + LANES)
    put_lane_of_row(work, total, k, one)
    put_lane_of_row(work, total, k + LANES, other)


@inlined
def _length(rows: Floats, r: int, k: int, n: int) -> float:
    """Length of the n numbers of row r from k on."""
    if n == 1:
        return abs(float(rows[r, k]))
    square = 0.0
    for i in range(k, k + n):
        square += rows[r, i] * rows[r, i]
    return math.sqrt(square)


@kernel
def magnitudes(layout: Ints, stages: int, work: Floats) -> None:
    """Write the error scale of each component of [u, v, x] into TOTAL.

    Of a translation in space or in a plane that is the length of the vector: an error weighs the same
    whichever way the axes lie. Of u it is that of the step, of v and x the larger of its two ends'.
    """
    space = space_of(layout)
    nq, nv, nx = space.nq, space.nv, space.nx
    total = stages + TOTAL
    for f in range(space.factors):
        factor = factor_of(layout, f)
        kind, j = factor.kind, factor.v
        linear = 3 if kind == RIGID else 2 if kind == PLANE else 0
        k = j
        while k < j + factor.nv:
            n = linear if k == j and linear > 0 else 1
            position = _length(work, stages + U, k, n)
            velocity = max(_length(work, stages + START, nq + k, n), _length(work, stages + STATE, nq + k, n))
            for i in range(k, k + n):
                work[total, i] = position
                work[total, nv + i] = velocity
            k += n
    for k in range(nv + nv, nv + nv + nx):
        i = nq - nv + k
        work[total, k] = max(abs(work[stages + START, i]), abs(work[stages + STATE, i]))


@kernel
def finish(
    i: int, h: float, errors: Floats, layout: Ints, work: Floats, scales: Floats, rtol: float
) -> float:
    """Store the derivative of the last stage i; return the step's scaled error.

    ``errors`` holds one row of weights, or two (Dormand-Prince 8(5,3), combined after Hairer). The error of a
    component counts against rtol (scale + magnitude); components of infinite scale do not count. The larger
    counts of the root mean square over u and v and that over x: integrals on which nothing depends do not
    thin out the errors of what moves.
    """
    nv, nx = space_of(layout).nv, space_of(layout).nx
    stages = errors.shape[1]
    store(i, stages, layout, work)
    magnitudes(layout, stages, work)
    for r in range(errors.shape[0]):
        _sum_errors(r, i + 1, errors, work, nv + nv + nx)
    first: Any = np.int64(0)
    motion = _norm((first, nv + nv), h, errors, work, scales, rtol)
    plain = _norm((nv + nv, nv + nv + nx), h, errors, work, scales, rtol)
    # Whichever is not finite is the larger.
    return motion if motion != motion or motion >= plain else plain


@inlined
def _sum_errors(r: int, count: int, errors: Floats, work: Floats, n: int) -> None:
    """Write the sums of stages by row r of the weights."""
    row = errors.shape[1] + ERRORS + r
    k = 0
    while k < n:
        if n >= LANES:
            at = min(k, n - LANES)
            lanes = same_lane(0.0)
            for j in range(count):
                lanes = lanes + errors[r, j] * lane_of_row(work, j, at)
            put_lane_of_row(work, row, at, lanes)
            k += LANES
            continue
        last = 0.0
        for j in range(count):
            last += errors[r, j] * work[j, k]
        work[row, k] = last
        k += 1


@inlined
def _norm(
    part: tuple[int, int], h: float, errors: Floats, work: Floats, scales: Floats, rtol: float
) -> float:
    """Scaled error of a part of the components, from the first number to the second."""
    begin, end = part
    stages = errors.shape[1]
    sum_first = 0.0
    sum_second = 0.0
    count = 0
    for k in range(begin, end):
        scale = scales[k]
        if scale == math.inf:
            continue
        bound = rtol * (scale + work[stages + TOTAL, k])
        first = work[stages + ERRORS, k] / bound
        sum_first += first * first
        if errors.shape[0] == 2:
            second = work[stages + ERRORS + 1, k] / bound
            sum_second += second * second
        count += 1
    if count == 0:
        return 0.0
    if errors.shape[0] == 2:
        if sum_first == 0.0 and sum_second == 0.0:
            return 0.0
        return abs(h) * sum_first / math.sqrt((sum_first + 0.01 * sum_second) * count)
    return abs(h) * math.sqrt(sum_first / count)


@kernel
def dense_coefficients(h: float, polynomials: Floats, n: int, work: Floats, dense: Floats) -> None:
    """Write the dense output's polynomials.

    dense[p] = h sum_j polynomials[j, p] work[j]: z(theta) - z(0) = sum_p dense[p] theta^(p + 1).
    """
    for p in range(polynomials.shape[1]):
        k = 0
        while k < n:
            if n >= _BLOCK:
                at = min(k, n - _BLOCK)
                one, other = same_lane(0.0), same_lane(0.0)
                for j in range(polynomials.shape[0]):
                    w = h * polynomials[j, p]
                    if w != 0.0:
                        one = one + w * lane_of_row(work, j, at)
                        other = other + w * lane_of_row(work, j, at + LANES)
                put_lane_of_row(dense, p, at, one)
                put_lane_of_row(dense, p, at + LANES, other)
                k += _BLOCK
                continue
            last = 0.0
            for j in range(polynomials.shape[0]):
                w = h * polynomials[j, p]
                if w != 0.0:
                    last += w * work[j, k]
            dense[p, k] = last
            k += 1


@deferred
def bend(layout: Ints, before: Floats, after: Floats, dense: Floats) -> None:
    """Move the dense output to a corrected end by 3 theta^2 - 2 theta^3."""
    space = space_of(layout)
    nq, nv = space.nq, space.nv
    for f in range(space.factors):
        factor = factor_of(layout, f)
        kind, i, j = factor.kind, factor.q, factor.v
        if kind == VECTOR:
            for k in range(factor.nv):
                _bend(dense, j + k, after[i + k] - before[i + k])
            continue
        if kind == RIGID or kind == PLANE:
            ways = 3 if kind == RIGID else 2
            for k in range(ways):
                _bend(dense, j + k, after[i + k] - before[i + k])
            i += ways
            j += ways
        if kind == RIGID or kind == ROTATION:
            # Twice the vector part of the quaternion that leads from one to the other.
            ax, ay, az, aw = before[i], before[i + 1], before[i + 2], before[i + 3]
            bx, by, bz, bw = after[i], after[i + 1], after[i + 2], after[i + 3]
            _bend(dense, j, 2.0 * (aw * bx - ax * bw - ay * bz + az * by))
            _bend(dense, j + 1, 2.0 * (aw * by - ay * bw - az * bx + ax * bz))
            _bend(dense, j + 2, 2.0 * (aw * bz - az * bw - ax * by + ay * bx))
        else:
            _bend(dense, j, before[i] * after[i + 1] - before[i + 1] * after[i])
    for k in range(nv + space.nx):
        _bend(dense, nv + k, after[nq + k] - before[nq + k])


@inlined
def _bend(dense: Floats, k: int, way: float) -> None:
    """Bend one component."""
    dense[1, k] += 3.0 * way
    dense[2, k] -= 2.0 * way


@inlined
def _put_terms(theta: float, dense: Floats, column: int, n: int, out: Floats, row: int, at: int) -> None:
    """Write n components of z(theta) - z(0) into out[row, at:], by Horner's rule."""
    degree = dense.shape[0]
    k = 0
    while k < n:
        if n >= LANES:
            k = min(k, n - LANES)
            lanes = lane_of_row(dense, degree - 1, column + k)
            for p in range(degree - 2, -1, -1):
                lanes = lanes * theta + lane_of_row(dense, p, column + k)
            put_lane_of_row(out, row, at + k, lanes * theta)
            k += LANES
            continue
        value = dense[degree - 1, column + k]
        for p in range(degree - 2, -1, -1):
            value = value * theta + dense[p, column + k]
        out[row, at + k] = value * theta
        k += 1


@kernel
def dense_state(theta: float, layout: Ints, dense: Floats, work: Floats, start: int, out: Floats) -> None:
    """Write the state at fraction theta of the step from work[start] into out[0]."""
    space = space_of(layout)
    nq, nv, nx = space.nq, space.nv, space.nx
    _put_terms(theta, dense, 0, nv, out, CHART_ROW, 0)
    _put_terms(theta, dense, nv, nv + nx, out, STATE_ROW, nq)
    for k in range(nq, nq + nv + nx):
        out[STATE_ROW, k] += work[start, k]
    retract(layout, work, start, out, CHART_ROW, out, STATE_ROW)


@inlined
def dense_joint(
    theta: float, factor: Factor, nq: int, nv: int, dense: Floats, work: Floats, start: int, out: Floats
) -> None:
    """Write only the part of a state that is one joint's."""
    j, n = factor.v, factor.nv
    _put_terms(theta, dense, j, n, out, CHART_ROW, j)
    _put_terms(theta, dense, nv + j, n, out, STATE_ROW, nq + j)
    for k in range(nq + j, nq + j + n):
        out[STATE_ROW, k] += work[start, k]
    retract_factor(factor, work, start, out, CHART_ROW, out, STATE_ROW)
