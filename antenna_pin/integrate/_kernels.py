"""Arithmetic of Lie-group Runge-Kutta steps, compiled.

A state ``y = [q, v, x]`` has a configuration on a manifold, a velocity in its tangent space and plain numbers
``x`` (quadratures, bristles). Within a step it is written in a chart about the step's start,

    q = q0 o exp(u),   z = [u, v, x],   z(0) = [0, v0, x0],

and u' follows from v by the inverse of the exponential's derivative. So z obeys an ordinary differential
equation in a vector space, to which any Runge-Kutta method applies with its full order, dense output included
(the method of Runge, Kutta, Munthe-Kaas). Rigid motions are charted as position times rotation, R^3 x SO(3):
p = p0 + u_p in the axes of the parent, R = R0 exp(u_w).

``layout`` is ``[nq, nv, nx, joints]`` and then four numbers per joint: kind, start in q, start in v, size in
v. The rows of ``work`` are the stages' rates and, behind them, U, START, TOTAL, STATE and RATES (see below):
one array, because each argument of a compiled function costs a part of what it computes.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin._compile import inlined, kernel

VECTOR = 0  # q' = v
CIRCLE = 1  # (cos, sin)
PLANE = 2  # (x, y, cos, sin), v = (linear in body axes, rate)
ROTATION = 3  # quaternion xyzw, v in body axes
RIGID = 4  # position, quaternion xyzw; v = (linear, angular) in body axes


@inlined
def _turn(q0: Any, r0: int, i: int, ux: float, uy: float, uz: float, q: Any, r: int) -> None:
    """Write q0 * exp(u / 2) for the quaternions at column i of rows r0 and r, made unit again."""
    square = ux * ux + uy * uy + uz * uz
    if square < 1e-4:
        # sin(t/2)/t and cos(t/2) to round-off for t < 0.01.
        f = 0.5 * (1.0 - square / 24.0 * (1.0 - square / 80.0 * (1.0 - square / 168.0)))
        w = 1.0 - square / 8.0 * (1.0 - square / 48.0 * (1.0 - square / 120.0))
    else:
        angle = math.sqrt(square)
        f = math.sin(0.5 * angle) / angle
        w = math.cos(0.5 * angle)
    x, y, z = f * ux, f * uy, f * uz
    a, b, c, s = q0[r0, i], q0[r0, i + 1], q0[r0, i + 2], q0[r0, i + 3]
    qx = s * x + a * w + b * z - c * y
    qy = s * y + b * w + c * x - a * z
    qz = s * z + c * w + a * y - b * x
    qw = s * w - a * x - b * y - c * z
    scale = 1.0 / math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    q[r, i] = qx * scale
    q[r, i + 1] = qy * scale
    q[r, i + 2] = qz * scale
    q[r, i + 3] = qw * scale


@inlined
def retract(layout: Any, q0: Any, r0: int, u: Any, ru: int, q: Any, r: int) -> None:
    """Write q[r] = q0[r0] o exp(u[ru]).

    Arrays and rows come apart, because a view of a row costs more than the sum it is for.
    """
    for b in range(4, 4 + 4 * layout[3], 4):
        kind = layout[b]
        i = layout[b + 1]
        j = layout[b + 2]
        if kind == VECTOR:
            for k in range(layout[b + 3]):
                q[r, i + k] = q0[r0, i + k] + u[ru, j + k]
        elif kind == RIGID:
            q[r, i] = q0[r0, i] + u[ru, j]
            q[r, i + 1] = q0[r0, i + 1] + u[ru, j + 1]
            q[r, i + 2] = q0[r0, i + 2] + u[ru, j + 2]
            _turn(q0, r0, i + 3, u[ru, j + 3], u[ru, j + 4], u[ru, j + 5], q, r)
        elif kind == ROTATION:
            _turn(q0, r0, i, u[ru, j], u[ru, j + 1], u[ru, j + 2], q, r)
        else:
            if kind == PLANE:
                q[r, i] = q0[r0, i] + u[ru, j]
                q[r, i + 1] = q0[r0, i + 1] + u[ru, j + 1]
                i += 2
                j += 2
            c = math.cos(u[ru, j])
            s = math.sin(u[ru, j])
            qc = q0[r0, i] * c - q0[r0, i + 1] * s
            qs = q0[r0, i] * s + q0[r0, i + 1] * c
            scale = 1.0 / math.sqrt(qc * qc + qs * qs)
            q[r, i] = qc * scale
            q[r, i + 1] = qs * scale


@inlined
def _unwind(x: float, y: float, z: float, wx: float, wy: float, wz: float, out: Any, r: int, j: int) -> None:
    """Write the rate of the rotation vector (x, y, z) for a body angular velocity w.

    It is w times the inverse right Jacobian of SO(3).
    """
    cx = y * wz - z * wy
    cy = z * wx - x * wz
    cz = x * wy - y * wx
    square = x * x + y * y + z * z
    if square < 1e-2:
        # (1 - (t/2) cot(t/2)) / t^2 to round-off for t < 0.1.
        f = 1.0 / 12.0 + square / 720.0 * (
            1.0 + square / 42.0 * (1.0 + square / 40.0 * (1.0 + square / 39.6))
        )
    else:
        angle = math.sqrt(square)
        f = (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / square
    out[r, j] = wx + 0.5 * cx + f * (y * cz - z * cy)
    out[r, j + 1] = wy + 0.5 * cy + f * (z * cx - x * cz)
    out[r, j + 2] = wz + 0.5 * cz + f * (x * cy - y * cx)


@inlined
def chart_rate(layout: Any, u: Any, ru: int, y: Any, ry: int, out: Any, r: int) -> None:
    """Write the rate of u[ru] into out[r] for the state y[ry] = [q, v], whose q is q0 o exp(u)."""
    start = layout[0]
    for b in range(4, 4 + 4 * layout[3], 4):
        kind = layout[b]
        i = layout[b + 1]
        j = layout[b + 2]
        k = start + j
        if kind == VECTOR:
            for n in range(layout[b + 3]):
                out[r, j + n] = y[ry, k + n]
        elif kind == RIGID:
            # p' = R v
            a, b1, c, w = y[ry, i + 3], y[ry, i + 4], y[ry, i + 5], y[ry, i + 6]
            vx, vy, vz = y[ry, k], y[ry, k + 1], y[ry, k + 2]
            tx = 2.0 * (b1 * vz - c * vy)
            ty = 2.0 * (c * vx - a * vz)
            tz = 2.0 * (a * vy - b1 * vx)
            out[r, j] = vx + w * tx + b1 * tz - c * ty
            out[r, j + 1] = vy + w * ty + c * tx - a * tz
            out[r, j + 2] = vz + w * tz + a * ty - b1 * tx
            _unwind(
                u[ru, j + 3],
                u[ru, j + 4],
                u[ru, j + 5],
                y[ry, k + 3],
                y[ry, k + 4],
                y[ry, k + 5],
                out,
                r,
                j + 3,
            )
        elif kind == ROTATION:
            _unwind(u[ru, j], u[ru, j + 1], u[ru, j + 2], y[ry, k], y[ry, k + 1], y[ry, k + 2], out, r, j)
        elif kind == PLANE:
            c = y[ry, i + 2]
            s = y[ry, i + 3]
            out[r, j] = c * y[ry, k] - s * y[ry, k + 1]
            out[r, j + 1] = s * y[ry, k] + c * y[ry, k + 1]
            out[r, j + 2] = y[ry, k + 2]
        else:
            out[r, j] = y[ry, k]


# Rows of the work array behind the stages' rates.
U = 0  # chart coordinates of the state being evaluated
START = 1  # the state at the start of the step
TOTAL = 2  # scratch; the components' magnitudes at the end of a step
STATE = 3  # the state being evaluated
RATES = 4  # its derivative
EXTRA_ROWS = 5
# Rows of a state from dense output: the state, and scratch (typed, for the compiler).
STATE_ROW: Any = np.int64(0)
CHART_ROW: Any = np.int64(1)


@kernel
def begin(stages: int, layout: Any, work: Any) -> None:
    """Make the present state the start of a step and its derivative, evaluated before, the first stage."""
    for k in range(layout[0] + layout[1] + layout[2]):
        work[stages + START, k] = work[stages + STATE, k]
    for k in range(layout[1]):
        work[stages + U, k] = 0.0
    store(0, stages, layout, work)


@inlined
def store(i: int, stages: int, layout: Any, work: Any) -> None:
    """Store the derivative just evaluated as stage i."""
    nv = layout[1]
    chart_rate(layout, work, stages + U, work, stages + STATE, work, i)
    for k in range(nv + layout[2]):
        work[i, nv + k] = work[stages + RATES, k]


@kernel
def stage(i: int, h: float, weights: Any, layout: Any, work: Any, keep: bool) -> None:
    """Store the derivative of stage i - 1 (if ``keep``) and write the state of stage i."""
    nq, nv, nx = layout[0], layout[1], layout[2]
    stages = weights.shape[0]
    if keep:
        store(i - 1, stages, layout, work)
    n = nv + nv + nx
    total = stages + TOTAL
    for k in range(n):
        work[total, k] = 0.0
    for j in range(i):
        w = h * weights[i, j]
        if w != 0.0:
            for k in range(n):
                work[total, k] += w * work[j, k]
    for k in range(nv):
        work[stages + U, k] = work[total, k]
    for k in range(nv + nx):
        work[stages + STATE, nq + k] = work[stages + START, nq + k] + work[total, nv + k]
    retract(layout, work, stages + START, work, total, work, stages + STATE)


@inlined
def _length(rows: Any, r: int, k: int, n: int) -> float:
    """Length of the n numbers of row r from k on."""
    if n == 1:
        return abs(float(rows[r, k]))
    square = 0.0
    for i in range(k, k + n):
        square += rows[r, i] * rows[r, i]
    return math.sqrt(square)


@kernel
def magnitudes(layout: Any, stages: int, work: Any) -> None:
    """Write into TOTAL the size of each component of [u, v, x] that its error is measured against.

    Of a translation in space or in a plane that is the length of the vector: an error weighs the same
    whichever way the axes lie. Of u it is that of the step, of v and x the larger of its two ends'.
    """
    nq, nv, nx = layout[0], layout[1], layout[2]
    total = stages + TOTAL
    for b in range(4, 4 + 4 * layout[3], 4):
        kind = layout[b]
        j = layout[b + 2]
        linear = 3 if kind == RIGID else 2 if kind == PLANE else 0
        k = j
        while k < j + layout[b + 3]:
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
def finish(i: int, h: float, errors: Any, layout: Any, work: Any, scales: Any, rtol: float) -> float:
    """Store the derivative of the last stage i; return the scaled error of the step (1 is the tolerance).

    ``errors`` holds one row of weights, or two (Dormand-Prince 8(5,3), combined after Hairer). The error of a
    component counts against rtol (scale + magnitude); components of infinite scale do not count. The larger
    counts of the root mean square over u and v and that over x: integrals on which nothing depends do not
    thin out the errors of what moves.
    """
    nv, nx = layout[1], layout[2]
    stages = errors.shape[1]
    store(i, stages, layout, work)
    magnitudes(layout, stages, work)
    first: Any = np.int64(0)
    motion = _norm(first, nv + nv, i, h, errors, stages, work, scales, rtol)
    plain = _norm(nv + nv, nv + nv + nx, i, h, errors, stages, work, scales, rtol)
    # Whichever is not finite is the larger.
    return motion if motion != motion or motion >= plain else plain


@inlined
def _norm(
    begin: int, end: int, i: int, h: float, errors: Any, stages: int, work: Any, scales: Any, rtol: float
) -> float:
    """Scaled error of the components from ``begin`` to ``end``."""
    sum_first = 0.0
    sum_second = 0.0
    count = 0
    for k in range(begin, end):
        scale = scales[k]
        if scale == math.inf:
            continue
        bound = rtol * (scale + work[stages + TOTAL, k])
        first = 0.0
        for j in range(i + 1):
            first += errors[0, j] * work[j, k]
        first /= bound
        sum_first += first * first
        if errors.shape[0] == 2:
            second = 0.0
            for j in range(i + 1):
                second += errors[1, j] * work[j, k]
            second /= bound
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
def dense_coefficients(h: float, polynomials: Any, n: int, work: Any, dense: Any) -> None:
    """dense[p] = h sum_j polynomials[j, p] work[j]: z(theta) - z(0) = sum_p dense[p] theta^(p + 1)."""
    for p in range(polynomials.shape[1]):
        for k in range(n):
            dense[p, k] = 0.0
        for j in range(polynomials.shape[0]):
            w = h * polynomials[j, p]
            if w != 0.0:
                for k in range(n):
                    dense[p, k] += w * work[j, k]


@inlined
def _term(theta: float, degree: int, dense: Any, k: int) -> float:
    """Component k of z(theta) - z(0), by Horner's rule."""
    value = dense[degree - 1, k]
    for p in range(degree - 2, -1, -1):
        value = value * theta + dense[p, k]
    return float(value * theta)


@kernel
def dense_state(theta: float, layout: Any, dense: Any, work: Any, start: int, out: Any) -> None:
    """Write the state at the fraction theta of the step from work[start] into out[0]; out[1] is scratch."""
    nq, nv, nx = layout[0], layout[1], layout[2]
    degree = dense.shape[0]
    for k in range(nv):
        out[CHART_ROW, k] = _term(theta, degree, dense, k)
    for k in range(nv, nv + nv + nx):
        out[STATE_ROW, nq - nv + k] = work[start, nq - nv + k] + _term(theta, degree, dense, k)
    retract(layout, work, start, out, CHART_ROW, out, STATE_ROW)


@kernel
def dense_joints(theta: float, layout: Any, dense: Any, work: Any, start: int, out: Any) -> None:
    """Write only the parts of a state that a layout lists: some joints, and x if its nx is not 0."""
    nq, nv = layout[0], layout[1]
    degree = dense.shape[0]
    for b in range(4, 4 + 4 * layout[3], 4):
        j = layout[b + 2]
        for k in range(j, j + layout[b + 3]):
            out[CHART_ROW, k] = _term(theta, degree, dense, k)
            out[STATE_ROW, nq + k] = work[start, nq + k] + _term(theta, degree, dense, nv + k)
    for k in range(nv + nv, nv + nv + layout[2]):
        out[STATE_ROW, nq - nv + k] = work[start, nq - nv + k] + _term(theta, degree, dense, k)
    retract(layout, work, start, out, CHART_ROW, out, STATE_ROW)
