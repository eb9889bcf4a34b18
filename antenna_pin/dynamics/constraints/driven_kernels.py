"""Rows of motions of joints with more freedom than one axis, compiled.

The motion angle is the twist about the axis (:mod:`antenna_pin.mechanism.spatial_kernels`), the row its
gradient; the multiplier is a couple that acts on both sides, along the axis where these are parallel. Its
change along a displacement is a difference of the gradient and of the bias alone: over angles, they are
smooth on the scale of one.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import PLANE, Floats, Triple
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import Driven, driven_at, plan_of
from antenna_pin.mechanism.spatial_kernels import twist_angle, twist_bias
from antenna_pin.mechanism.tree_kernels import unwrapped

# Step of differences over angles [rad]; of sixth order their error is 1e-19 for functions that are smooth on
# the scale of one, and their round-off 1e-13.
_TURN = 1e-3


@kernel
def twist_row(y: Floats, plan: Floats, work: Floats, driven: Driven) -> tuple[float, float]:
    """Write the columns of such a motion: the gradient of its motion angle.

    Returns:
        The angle with its whole turns [rad], and its acceleration at zero accelerations of the coordinates
        [rad/s^2].
    """
    head, axes = plan_of(plan), driven.axes
    near = y[head.nq + head.nv + driven.turn]
    at, width = head.jacobian + driven.row, head.width
    if driven.moves == PLANE:
        work[at + (driven.v + 2) * width] = head.length
        return unwrapped(math.atan2(y[driven.q + 3], y[driven.q + 2]), near), 0.0
    q, v = driven.q + 3, head.nq + driven.v + 3
    hx = axes[0, 0] * y[q] + axes[1, 0] * y[q + 1] + axes[2, 0] * y[q + 2]
    hy = axes[0, 1] * y[q] + axes[1, 1] * y[q + 1] + axes[2, 1] * y[q + 2]
    hz = axes[0, 2] * y[q] + axes[1, 2] * y[q + 1] + axes[2, 2] * y[q + 2]
    wx = axes[0, 0] * y[v] + axes[1, 0] * y[v + 1] + axes[2, 0] * y[v + 2]
    wy = axes[0, 1] * y[v] + axes[1, 1] * y[v + 1] + axes[2, 1] * y[v + 2]
    wz = axes[0, 2] * y[v] + axes[1, 2] * y[v + 1] + axes[2, 2] * y[v + 2]
    angle, gx, gy = twist_angle(hx, hy, hz, y[q + 3])
    for k in range(3):
        gradient = axes[k, 0] * gx + axes[k, 1] * gy + axes[k, 2]
        work[at + (driven.v + 3 + k) * width] = head.length * gradient
    return unwrapped(angle, near), twist_bias((hx, hy, hz), y[q + 3], (wx, wy, wz))


@inlined
def _about(axes: Floats, values: Floats, at: int, k: int) -> float:
    """Return component k of a vector at values[at:] in axes that are columns."""
    return float(axes[0, k] * values[at] + axes[1, k] * values[at + 1] + axes[2, k] * values[at + 2])


@inlined
def _turned_twist(h: Triple, qw: float, s: float, turn: Triple, w: Triple) -> Triple:
    """Return gx, gy and bias of a twist after a further turn by s."""
    x, y, z = turn
    hx = h[0] + 0.5 * s * (qw * x + h[1] * z - h[2] * y)
    hy = h[1] + 0.5 * s * (qw * y + h[2] * x - h[0] * z)
    hz = h[2] + 0.5 * s * (qw * z + h[0] * y - h[1] * x)
    own = qw - 0.5 * s * (h[0] * x + h[1] * y + h[2] * z)
    _, gx, gy = twist_angle(hx, hy, hz, own)
    # Not of length one: gx and gy are ratios, and so is their rate.
    return gx, gy, twist_bias((hx, hy, hz), own, w)


@kernel
def change_of_twist(
    y: Floats, way: Floats, acceleration: Floats, plan: Floats, driven: Driven, out: Floats
) -> None:
    """Write changes of gradient, bias and rate of a driven twist along a displacement.

    Args:
        y: State.
        way: Displacement, [w (nv), dv (nv), ...].
        acceleration: (nv,).
        plan: Plan of the constraints.
        driven: The motion.
        out: Changes of the angle's acceleration at constant accelerations of the coordinates [rad/s^2], of
            its rate [rad/s], and of its gradient, along the joint's axes x and y [-], (4,).
    """
    head, axes, v = plan_of(plan), driven.axes, driven.v + 3
    for k in range(4):
        out[k] = 0.0
    if driven.moves == PLANE:
        out[1] = way[head.nv + driven.v + 2]
        return
    q = driven.q + 3
    h = (_about(axes, y, q, 0), _about(axes, y, q, 1), _about(axes, y, q, 2))
    at = head.nq + v
    w = (_about(axes, y, at, 0), _about(axes, y, at, 1), _about(axes, y, at, 2))
    turn = (_about(axes, way, v, 0), _about(axes, way, v, 1), _about(axes, way, v, 2))
    at = head.nv + v
    faster = (_about(axes, way, at, 0), _about(axes, way, at, 1), _about(axes, way, at, 2))
    size = math.sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2])
    bias = 0.0
    for point in range(3 if size > 0.0 else 0):
        s = (point + 1.0) * _TURN / size
        ahead, behind = _turned_twist(h, y[q + 3], s, turn, w), _turned_twist(h, y[q + 3], -s, turn, w)
        weight = (45.0 if point == 0 else (-9.0 if point == 1 else 1.0)) / 60.0 * size / _TURN
        out[2] += weight * (ahead[0] - behind[0])
        out[3] += weight * (ahead[1] - behind[1])
        bias += weight * (ahead[2] - behind[2])
    # A quadratic form of w, whose central difference is exact for any step.
    more = (w[0] + faster[0], w[1] + faster[1], w[2] + faster[2])
    less = (w[0] - faster[0], w[1] - faster[1], w[2] - faster[2])
    bias += 0.5 * (twist_bias(h, y[q + 3], more) - twist_bias(h, y[q + 3], less))
    _, gx, gy = twist_angle(h[0], h[1], h[2], y[q + 3])
    out[0] = out[2] * _about(axes, acceleration, v, 0) + out[3] * _about(axes, acceleration, v, 1) + bias
    out[1] = out[2] * w[0] + out[3] * w[1] + gx * faster[0] + gy * faster[1] + faster[2]


@kernel
def change_motions(
    y: Floats,
    way: Floats,
    acceleration: Floats,
    force: Floats,
    plan: Floats,
    scratch: tuple[Floats, Floats, Floats],
    out: Floats,
) -> None:
    """Add changes of motions' rows along a displacement at constant time and parameters.

    Args:
        y: State.
        way: Displacement, [w (nv), dv (nv), ...].
        acceleration: (nv,).
        force: Multipliers, (rows,).
        plan: Plan of the constraints.
        scratch: Minus the changes of ``J a - lack``, (width,), added to; changes of rates, (motions,),
            written; and scratch, (4,).
        out: Change of J^T lambda, added to, (nv,).
    """
    lack, speeds, room = scratch
    head = plan_of(plan)
    for m in range(head.motions):
        driven = driven_at(plan, m)
        speeds[m] = way[head.nv + driven.v]
        if driven.moves == 0:
            continue
        change_of_twist(y, way, acceleration, plan, driven, room)
        speeds[m] = room[1]
        lack[driven.row] -= head.length * room[0]
        if driven.moves == PLANE:
            continue
        for k in range(3):
            change = driven.axes[k, 0] * room[2] + driven.axes[k, 1] * room[3]
            out[driven.v + 3 + k] += head.length * force[driven.row] * change


@inlined
def driven_rate(y: Floats, plan: Floats, work: Floats, driven: Driven) -> float:
    """Return the rate of a joint with a motion [rad/s or m/s]."""
    head = plan_of(plan)
    if driven.moves == 0:
        return float(y[head.nq + driven.v])
    rate: float = 0.0
    for k in range(3 if driven.moves == PLANE else 6):
        rate += work[head.jacobian + driven.row + (driven.v + k) * head.width] * y[head.nq + driven.v + k]
    return float(rate / head.length)
