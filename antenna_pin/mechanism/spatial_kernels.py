"""Spatial vectors of six numbers in world axes, motions and wrenches, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, Six, Triple, Vector3, Vector6, layout
from antenna_pin.compiled.decorators import inlined
from antenna_pin.mechanism.room_kernels import crossed, symmetric_times

#: Six numbers, the linear ones first, in an array or by themselves.
Spatial = Floats | Six


class BodyChange(Record):
    """A body about the point, in world axes, and its changes by one displacement."""

    origin: Vector3  # place of its origin [m]
    velocity: Vector6  # of the body
    acceleration: Vector6  # of the body, in which the ground rises against gravity
    joint_rate: Vector6  # what its joint adds to the velocity
    momentum: Vector6  # of the body
    wrench: Vector6  # that its joint gives
    mass: float  # [kg]
    first: Vector3  # moment of mass [kg m]
    inertia: Vector6  # moment of inertia [kg m^2]
    way: Vector6  # displacement by the joint
    velocity_change: Vector6  # by the displacement
    acceleration_change: Vector6  # by the displacement
    wrench_change: Vector6  # by the displacement


CHANGE = layout(BodyChange)


@inlined
def set_six(out: Floats, x: Spatial) -> None:
    """Write six numbers."""
    a, b, c, d, e, f = x
    out[0], out[1], out[2], out[3], out[4], out[5] = a, b, c, d, e, f


@inlined
def add_six(out: Floats, x: Spatial) -> None:
    """Add six numbers."""
    a, b, c, d, e, f = x
    out[0] += a
    out[1] += b
    out[2] += c
    out[3] += d
    out[4] += e
    out[5] += f


@inlined
def cross_motion(a: Spatial, b: Spatial) -> Six:
    """Return a x b of two motions."""
    x, y, z = crossed(a[3], a[4], a[5], b[3], b[4], b[5])
    p, q, r = crossed(a[3], a[4], a[5], b[0], b[1], b[2])
    u, v, w = crossed(a[0], a[1], a[2], b[3], b[4], b[5])
    return p + u, q + v, r + w, x, y, z


@inlined
def cross_wrench(a: Spatial, f: Spatial) -> Six:
    """Return a x* f of a motion and a wrench."""
    x, y, z = crossed(a[3], a[4], a[5], f[0], f[1], f[2])
    p, q, r = crossed(a[3], a[4], a[5], f[3], f[4], f[5])
    u, v, w = crossed(a[0], a[1], a[2], f[0], f[1], f[2])
    return x, y, z, p + u, q + v, r + w


@inlined
def times_inertia(own: BodyChange, a: Spatial) -> Six:
    """Return I a, of a mass, first moment and moment of inertia."""
    m, h = own.mass, own.first
    x, y, z = crossed(a[3], a[4], a[5], h[0], h[1], h[2])
    p, q, r = crossed(h[0], h[1], h[2], a[0], a[1], a[2])
    u, v, w = symmetric_times(own.inertia, a[3], a[4], a[5])
    return m * a[0] + x, m * a[1] + y, m * a[2] + z, p + u, q + v, r + w


# --- twist about an axis ------------------------------------------------------------------------------------


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
