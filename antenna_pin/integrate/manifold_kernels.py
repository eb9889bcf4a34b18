"""Configurations on a product of joint spaces: steps and chart rates, compiled.

A configuration q0 o exp(u) has chart coordinates u about q0, and u' follows from v by the inverse of the
exponential's derivative. Rigid motions are charted as position times rotation, R^3 x SO(3): p = p0 + u_p in
the axes of the parent, R = R0 exp(u_w).

``layout`` is the space as flat numbers: ``SPACE``, and a ``FACTOR`` for each joint.
"""

from __future__ import annotations

import math

from antenna_pin.base import records
from antenna_pin.base.records import PLANE, RIGID, ROTATION, VECTOR, Floats, Ints, Triple
from antenna_pin.compiled.decorators import inlined, kernel, record


class Space(records.Record):
    """The head of a configuration space's layout; its factors follow."""

    nq: int  # size of q
    nv: int  # size of v
    nx: int  # size of x
    factors: int  # how many


SPACE = records.layout(Space)


class Factor(records.Record):
    """A factor of the configuration space."""

    kind: int  # how its joint moves: VECTOR, CIRCLE, ...
    q: int  # start in q
    v: int  # start in v
    nv: int  # its numbers in v


FACTOR = records.layout(Factor)
SPACE_WORDS = records.words_of(SPACE)
FACTOR_WORDS = records.words_of(FACTOR)


@inlined
def space_of(layout: Ints) -> Space:
    """Return the head of a layout."""
    return record(layout[:SPACE_WORDS], SPACE)


@inlined
def factor_of(layout: Ints, number: int) -> Factor:
    """Return one of the factors that a layout lists."""
    at = SPACE_WORDS + number * FACTOR_WORDS
    return record(layout[at : at + FACTOR_WORDS], FACTOR)


@inlined
def _turn(q0: Floats, r0: int, i: int, way: Triple, q: Floats, r: int) -> None:
    """Write q0 * exp(u / 2), normalized, for the quaternions at column i."""
    ux, uy, uz = way
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
def retract_factor(factor: Factor, q0: Floats, r0: int, u: Floats, ru: int, q: Floats, r: int) -> None:
    """Write one factor of q[r] = q0[r0] o exp(u[ru])."""
    kind, i, j = factor.kind, factor.q, factor.v
    if kind == VECTOR:
        for k in range(factor.nv):
            q[r, i + k] = q0[r0, i + k] + u[ru, j + k]
    elif kind == RIGID:
        q[r, i] = q0[r0, i] + u[ru, j]
        q[r, i + 1] = q0[r0, i + 1] + u[ru, j + 1]
        q[r, i + 2] = q0[r0, i + 2] + u[ru, j + 2]
        _turn(q0, r0, i + 3, (u[ru, j + 3], u[ru, j + 4], u[ru, j + 5]), q, r)
    elif kind == ROTATION:
        _turn(q0, r0, i, (u[ru, j], u[ru, j + 1], u[ru, j + 2]), q, r)
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
def retract(layout: Ints, q0: Floats, r0: int, u: Floats, ru: int, q: Floats, r: int) -> None:
    """Write q[r] = q0[r0] o exp(u[ru]).

    Arrays and rows come apart, because a view of a row costs more than the sum it is for.
    """
    for f in range(space_of(layout).factors):
        retract_factor(factor_of(layout, f), q0, r0, u, ru, q, r)


@inlined
def move_factor(factor: Factor, rows: Floats, r: int, step: Floats) -> None:
    """:func:`move_by_velocity` of one factor."""
    kind, i, j = factor.kind, factor.q, factor.v
    if kind == VECTOR:
        for k in range(factor.nv):
            rows[r, i + k] += step[j + k]
    elif kind == RIGID:
        x, y, z, w = rows[r, i + 3], rows[r, i + 4], rows[r, i + 5], rows[r, i + 6]
        tx = 2.0 * (y * step[j + 2] - z * step[j + 1])
        ty = 2.0 * (z * step[j] - x * step[j + 2])
        tz = 2.0 * (x * step[j + 1] - y * step[j])
        rows[r, i] += step[j] + w * tx + y * tz - z * ty
        rows[r, i + 1] += step[j + 1] + w * ty + z * tx - x * tz
        rows[r, i + 2] += step[j + 2] + w * tz + x * ty - y * tx
        _turn(rows, r, i + 3, (step[j + 3], step[j + 4], step[j + 5]), rows, r)
    elif kind == ROTATION:
        _turn(rows, r, i, (step[j], step[j + 1], step[j + 2]), rows, r)
    else:
        angle = step[j]
        if kind == PLANE:
            c, s = rows[r, i + 2], rows[r, i + 3]
            rows[r, i] += c * step[j] - s * step[j + 1]
            rows[r, i + 1] += s * step[j] + c * step[j + 1]
            i += 2
            angle = step[j + 2]
        c, s = math.cos(angle), math.sin(angle)
        qc = rows[r, i] * c - rows[r, i + 1] * s
        qs = rows[r, i] * s + rows[r, i + 1] * c
        scale = 1.0 / math.sqrt(qc * qc + qs * qs)
        rows[r, i] = qc * scale
        rows[r, i + 1] = qs * scale


@inlined
def factor_size(factor: Factor) -> int:
    """Return how many numbers of q a factor has."""
    if factor.kind == VECTOR:
        return int(factor.nv)
    return 7 if factor.kind == RIGID else 4 if factor.kind == ROTATION or factor.kind == PLANE else 2


@kernel
def move_by_velocity(layout: Ints, rows: Floats, r: int, step: Floats) -> None:
    """Move the configuration rows[r], in place, by a first-order tangent step in body axes."""
    for f in range(space_of(layout).factors):
        move_factor(factor_of(layout, f), rows, r, step)


@inlined
def _unwind(vector: Triple, spin: Triple, out: Floats, r: int, j: int) -> None:
    """Write the rate of a rotation vector, J_r^-1 of SO(3) times a body angular velocity."""
    x, y, z = vector
    wx, wy, wz = spin
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
def chart_rate(layout: Ints, u: Floats, ru: int, y: Floats, ry: int, out: Floats, r: int) -> None:
    """Write the rate of u[ru] into out[r] for q = q0 o exp(u)."""
    start = space_of(layout).nq
    for f in range(space_of(layout).factors):
        factor = factor_of(layout, f)
        kind, i, j = factor.kind, factor.q, factor.v
        k = start + j
        if kind == VECTOR:
            for n in range(factor.nv):
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
            vector = (u[ru, j + 3], u[ru, j + 4], u[ru, j + 5])
            _unwind(vector, (y[ry, k + 3], y[ry, k + 4], y[ry, k + 5]), out, r, j + 3)
        elif kind == ROTATION:
            vector = (u[ru, j], u[ru, j + 1], u[ru, j + 2])
            _unwind(vector, (y[ry, k], y[ry, k + 1], y[ry, k + 2]), out, r, j)
        elif kind == PLANE:
            c = y[ry, i + 2]
            s = y[ry, i + 3]
            out[r, j] = c * y[ry, k] - s * y[ry, k + 1]
            out[r, j + 1] = s * y[ry, k] + c * y[ry, k + 1]
            out[r, j + 2] = y[ry, k + 2]
        else:
            out[r, j] = y[ry, k]


@kernel
def write_bracket(layout: Ints, v: Floats, way: Floats, out: Floats) -> None:
    """Write the bracket [v, w] of two tangent vectors at one configuration, (nv,)."""
    for f in range(space_of(layout).factors):
        factor = factor_of(layout, f)
        kind, j = factor.kind, factor.v
        if kind == PLANE:
            out[j] = v[j + 1] * way[j + 2] - v[j + 2] * way[j + 1]
            out[j + 1] = v[j + 2] * way[j] - v[j] * way[j + 2]
            out[j + 2] = 0.0
        elif kind == RIGID or kind == ROTATION:
            k = j + factor.nv - 3
            x, y, z = v[k], v[k + 1], v[k + 2]
            a, b, c = way[k], way[k + 1], way[k + 2]
            out[k], out[k + 1], out[k + 2] = y * c - z * b, z * a - x * c, x * b - y * a
            if kind == RIGID:
                p, q, r = way[j], way[j + 1], way[j + 2]
                s, t, u = v[j], v[j + 1], v[j + 2]
                out[j] = y * r - z * q + t * c - u * b
                out[j + 1] = z * p - x * r + u * a - s * c
                out[j + 2] = x * q - y * p + s * b - t * a
        else:
            for k in range(j, j + factor.nv):
                out[k] = 0.0
