"""The row of a motion of a joint that does more than turn about its axis, as one with play; compiled.

Its motion angle is the twist about the axis (:mod:`antenna_pin.mechanism.twist_kernels`), the row its
gradient; the multiplier is a couple that acts on both sides, along the axis where these are parallel.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.constraints.layout_kernels import plan_of
from antenna_pin.mechanism.tree_kernels import unwrapped
from antenna_pin.mechanism.twist_kernels import twist_angle, twist_bias
from antenna_pin.records import PLANE


@kernel
def twist_row(y: Any, plan: Any, work: Any, driven: Any) -> tuple[float, float]:
    """Write the columns of a motion of a joint that moves otherwise too: the gradient of its motion angle.

    Returns:
        The angle with its whole turns [rad], and what it accelerates by at accelerations of zero [rad/s^2].
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
def driven_rate(y: Any, plan: Any, work: Any, driven: Any) -> float:
    """Return the rate of a joint with a motion [rad/s or m/s], by its row where that is written."""
    head = plan_of(plan)
    if driven.moves == 0:
        return float(y[head.nq + driven.v])
    rate: float = 0.0
    for k in range(3 if driven.moves == PLANE else 6):
        rate += work[head.jacobian + driven.row + (driven.v + k) * head.width] * y[head.nq + driven.v + k]
    return float(rate / head.length)
