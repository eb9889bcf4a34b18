"""Twist of a body about an axis, from its swing and twist, compiled.

The vector part (hx, hy, hz) and the scalar qw of a rotation's quaternion, in axes of which z is the axis.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Triple
from antenna_pin.compiled.decorators import inlined


@inlined
def twist_angle(hx: float, hy: float, hz: float, qw: float) -> Triple:
    """Return the twist about z [rad], (-pi, pi], and gx, gy of its rate.

    The angular velocity w is the turned body's, in its own axes.
    """
    square = hz * hz + qw * qw
    if qw < 0.0:
        angle = 2.0 * math.atan2(-hz, -qw)
    else:
        angle = 2.0 * math.atan2(hz, qw)
    if square == 0.0:
        return angle, 0.0, 0.0
    return angle, (hz * hx - qw * hy) / square, (qw * hx + hz * hy) / square


@inlined
def twist_slopes(h: Triple, qw: float, way: Triple) -> tuple[float, float]:
    """Return the changes of gx and gy of :func:`twist_angle` by a small rotation.

    By h' = (qw w + h x w) / 2 and qw' = -h . w / 2.
    """
    hx, hy, hz = h
    wx, wy, wz = way
    square = hz * hz + qw * qw
    if square == 0.0:
        return 0.0, 0.0
    dx = 0.5 * (qw * wx + hy * wz - hz * wy)
    dy = 0.5 * (qw * wy + hz * wx - hx * wz)
    dz = 0.5 * (qw * wz + hx * wy - hy * wx)
    dw = -0.5 * (hx * wx + hy * wy + hz * wz)
    grown = 2.0 * (hz * dz + qw * dw)
    gx, gy = (hz * hx - qw * hy) / square, (qw * hx + hz * hy) / square
    first = dz * hx + hz * dx - dw * hy - qw * dy - gx * grown
    second = dw * hx + qw * dx + dz * hy + hz * dy - gy * grown
    return first / square, second / square


@inlined
def twist_bias(h: Triple, qw: float, w: Triple) -> float:
    """Return the twist's acceleration at constant w: gx' wx + gy' wy [rad/s^2]."""
    first, second = twist_slopes(h, qw, w)
    return first * w[0] + second * w[1]
