"""Arithmetic of Lie-group Runge-Kutta steps, compiled.

A state ``y = [q, v, x]`` has a configuration on a manifold, a velocity in its tangent space and plain numbers ``x``
(quadratures, bristles). Within a step it is written in a chart about the step's start,

    q = q0 o exp(u),   z = [u, v, x],   z(0) = [0, v0, x0],

and u' follows from v by the inverse of the exponential's derivative. So z obeys an ordinary differential equation in
a vector space, to which any Runge-Kutta method applies with its full order, dense output included (the method of
Runge, Kutta, Munthe-Kaas). Rigid motions are charted as position times rotation, R^3 x SO(3): p = p0 + u_p in the
axes of the parent, R = R0 exp(u_w).

``blocks`` has a row per joint: [kind, start in q, start in v, size].
"""

from __future__ import annotations

import math
from typing import Any

import numba

VECTOR = 0  # q' = v
CIRCLE = 1  # (cos, sin)
PLANE = 2  # (x, y, cos, sin), v = (linear in body axes, rate)
ROTATION = 3  # quaternion xyzw, v in body axes
RIGID = 4  # position, quaternion xyzw; v = (linear, angular) in body axes


@numba.njit(cache=True)
def _rotate(q: Any, i: int, x: float, y: float, z: float) -> tuple[float, float, float]:
    """Rotate a vector by the unit quaternion at q[i:i + 4] (xyzw)."""
    a, b, c, w = q[i], q[i + 1], q[i + 2], q[i + 3]
    tx = 2.0 * (b * z - c * y)
    ty = 2.0 * (c * x - a * z)
    tz = 2.0 * (a * y - b * x)
    return (
        x + w * tx + b * tz - c * ty,
        y + w * ty + c * tx - a * tz,
        z + w * tz + a * ty - b * tx,
    )


@numba.njit(cache=True)
def _turn(q0: Any, i: int, ux: float, uy: float, uz: float, q: Any) -> None:
    """q = q0 * exp(u / 2) for the quaternions at index i, made unit again."""
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
    a, b, c, s = q0[i], q0[i + 1], q0[i + 2], q0[i + 3]
    qx = s * x + a * w + b * z - c * y
    qy = s * y + b * w + c * x - a * z
    qz = s * z + c * w + a * y - b * x
    qw = s * w - a * x - b * y - c * z
    scale = 1.0 / math.sqrt(qx * qx + qy * qy + qz * qz + qw * qw)
    q[i] = qx * scale
    q[i + 1] = qy * scale
    q[i + 2] = qz * scale
    q[i + 3] = qw * scale


@numba.njit(cache=True)
def retract(blocks: Any, q0: Any, u: Any, q: Any) -> None:
    """Write q = q0 o exp(u)."""
    for b in range(blocks.shape[0]):
        kind = blocks[b, 0]
        i = blocks[b, 1]
        j = blocks[b, 2]
        if kind == VECTOR:
            for k in range(blocks[b, 3]):
                q[i + k] = q0[i + k] + u[j + k]
        elif kind == RIGID:
            q[i] = q0[i] + u[j]
            q[i + 1] = q0[i + 1] + u[j + 1]
            q[i + 2] = q0[i + 2] + u[j + 2]
            _turn(q0, i + 3, u[j + 3], u[j + 4], u[j + 5], q)
        elif kind == ROTATION:
            _turn(q0, i, u[j], u[j + 1], u[j + 2], q)
        else:
            if kind == PLANE:
                q[i] = q0[i] + u[j]
                q[i + 1] = q0[i + 1] + u[j + 1]
                i += 2
                j += 2
            c = math.cos(u[j])
            s = math.sin(u[j])
            qc = q0[i] * c - q0[i + 1] * s
            qs = q0[i] * s + q0[i + 1] * c
            scale = 1.0 / math.sqrt(qc * qc + qs * qs)
            q[i] = qc * scale
            q[i + 1] = qs * scale


@numba.njit(cache=True)
def _unwind(u: Any, j: int, v: Any, k: int, out: Any) -> None:
    """out[j:j+3] = the rate of u for a body angular velocity v[k:k+3] (inverse right Jacobian of SO(3))."""
    x, y, z = u[j], u[j + 1], u[j + 2]
    wx, wy, wz = v[k], v[k + 1], v[k + 2]
    cx = y * wz - z * wy
    cy = z * wx - x * wz
    cz = x * wy - y * wx
    square = x * x + y * y + z * z
    if square < 1e-2:
        # (1 - (t/2) cot(t/2)) / t^2 to round-off for t < 0.1.
        f = 1.0 / 12.0 + square / 720.0 * (1.0 + square / 42.0 * (1.0 + square / 40.0 * (1.0 + square / 39.6)))
    else:
        angle = math.sqrt(square)
        f = (1.0 - 0.5 * angle / math.tan(0.5 * angle)) / square
    out[j] = wx + 0.5 * cx + f * (y * cz - z * cy)
    out[j + 1] = wy + 0.5 * cy + f * (z * cx - x * cz)
    out[j + 2] = wz + 0.5 * cz + f * (x * cy - y * cx)


@numba.njit(cache=True)
def chart_rate(blocks: Any, u: Any, q: Any, v: Any, start: int, out: Any) -> None:
    """Write the rate of u into out for a velocity v[start:], at the configuration q = q0 o exp(u)."""
    for b in range(blocks.shape[0]):
        kind = blocks[b, 0]
        i = blocks[b, 1]
        j = blocks[b, 2]
        if kind == VECTOR:
            for k in range(blocks[b, 3]):
                out[j + k] = v[start + j + k]
        elif kind == RIGID:
            k = start + j
            rx, ry, rz = _rotate(q, i + 3, v[k], v[k + 1], v[k + 2])
            out[j] = rx
            out[j + 1] = ry
            out[j + 2] = rz
            _unwind(u, j + 3, v, k + 3, out)
        elif kind == ROTATION:
            _unwind(u, j, v, start + j, out)
        elif kind == PLANE:
            c = q[i + 2]
            s = q[i + 3]
            k = start + j
            out[j] = c * v[k] - s * v[k + 1]
            out[j + 1] = s * v[k] + c * v[k + 1]
            out[j + 2] = v[k + 2]
        else:
            out[j] = v[start + j]


# Rows of the work array behind the stages' rates.
_U = 0  # chart coordinates of the state being evaluated
_START = 1  # the state at the start of the step


@numba.njit(cache=True)
def begin(stages: int, sizes: Any, work: Any, y: Any, rates: Any, blocks: Any) -> None:
    """Make ``y`` the start of a step and store its derivative, evaluated before, as the first stage."""
    nq, nv, nx = sizes[0], sizes[1], sizes[2]
    u = work[stages + _U]
    start = work[stages + _START]
    for k in range(nq + nv + nx):
        start[k] = y[k]
    for k in range(nv):
        u[k] = 0.0
    chart_rate(blocks, u, y, y, nq, work[0])
    for k in range(nv + nx):
        work[0, nv + k] = rates[k]


@numba.njit(cache=True)
def store(i: int, stages: int, sizes: Any, work: Any, y: Any, rates: Any, blocks: Any) -> None:
    """Store the derivative just evaluated as stage i."""
    nq, nv, nx = sizes[0], sizes[1], sizes[2]
    chart_rate(blocks, work[stages + _U], y, y, nq, work[i])
    for k in range(nv + nx):
        work[i, nv + k] = rates[k]


@numba.njit(cache=True)
def stage(
    i: int, h: float, weights: Any, sizes: Any, work: Any, y: Any, rates: Any, blocks: Any, keep: bool
) -> None:
    """Store the derivative of stage i - 1 (if ``keep``) and write the state of stage i into y."""
    nq, nv, nx = sizes[0], sizes[1], sizes[2]
    stages = weights.shape[0]
    u = work[stages + _U]
    start = work[stages + _START]
    if keep:
        store(i - 1, stages, sizes, work, y, rates, blocks)
    n = nv + nv + nx
    total = work[stages + 2]
    for k in range(n):
        total[k] = 0.0
    for j in range(i):
        w = h * weights[i, j]
        if w != 0.0:
            for k in range(n):
                total[k] += w * work[j, k]
    for k in range(nv):
        u[k] = total[k]
    for k in range(nv + nx):
        y[nq + k] = start[nq + k] + total[nv + k]
    retract(blocks, start, u, y)


@numba.njit(cache=True)
def finish(
    i: int, h: float, errors: Any, sizes: Any, work: Any, y: Any, rates: Any, blocks: Any, scales: Any, rtol: float
) -> float:
    """Store the derivative of the last stage i; return the scaled error of the step (1 is the tolerance).

    ``errors`` holds one row of weights, or two (Dormand-Prince 8(5,3), combined after Hairer). The error of a
    component counts against rtol (scale + |value|); components of infinite scale do not count.
    """
    nq, nv, nx = sizes[0], sizes[1], sizes[2]
    n = nv + nv + nx
    u = work[errors.shape[1] + _U]
    start = work[errors.shape[1] + _START]
    store(i, errors.shape[1], sizes, work, y, rates, blocks)
    sum_first = 0.0
    sum_second = 0.0
    count = 0
    for k in range(n):
        scale = scales[k]
        if scale == math.inf:
            continue
        value = abs(u[k]) if k < nv else max(abs(start[nq - nv + k]), abs(y[nq - nv + k]))
        first = 0.0
        for j in range(i + 1):
            first += errors[0, j] * work[j, k]
        bound = rtol * (scale + value)
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


@numba.njit(cache=True)
def dense_coefficients(h: float, polynomials: Any, n: int, work: Any, dense: Any) -> None:
    """dense[p] = h sum_j polynomials[j, p] work[j]: z(theta) - z(0) = sum_p dense[p] theta^(p + 1)."""
    for p in range(polynomials.shape[1]):
        row = dense[p]
        for k in range(n):
            row[k] = 0.0
        for j in range(polynomials.shape[0]):
            w = h * polynomials[j, p]
            if w != 0.0:
                for k in range(n):
                    row[k] += w * work[j, k]


@numba.njit(cache=True)
def dense_state(
    theta: float, degree: int, sizes: Any, dense: Any, start: Any, blocks: Any, scratch: Any, y: Any
) -> None:
    """Write the state at the fraction theta of the step into y; scratch holds at least nv numbers."""
    nq, nv, nx = sizes[0], sizes[1], sizes[2]
    for k in range(nv + nv + nx):
        value = dense[degree - 1, k]
        for p in range(degree - 2, -1, -1):
            value = value * theta + dense[p, k]
        value *= theta
        if k < nv:
            scratch[k] = value
        else:
            y[nq - nv + k] = start[nq - nv + k] + value
    retract(blocks, start, scratch, y)
