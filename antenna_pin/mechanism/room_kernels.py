"""Shared kernels of a tree's dynamics, compiled: body motion, symmetric matrices.

Spatial coordinates as in Pinocchio: linear part first, at a body's origin and in its own axes. A symmetric
3 x 3 matrix is given by xx, xy, xz, yy, yz, zz; any other one row after row.
"""

from __future__ import annotations

from typing import Annotated

from antenna_pin.base.records import Floats, Record, Records, Six, Triple, Vector3, Vector6, layout
from antenna_pin.compiled.decorators import inlined
from antenna_pin.mechanism.tree_kernels import Body, Place, relative


class CarrierRecord(Record):
    """A body that may carry others."""

    carries: int  # 1: it or what it carries has inertia


class BodyRoom(Place, CarrierRecord):
    """Workspace of a body: its place, and the inertia and forces it carries.

    It does not begin as :class:`Place` does: Numba would take it for one, which it warns of.
    """

    linear: Vector3  # acceleration of the origin, in which the ground rises against gravity [m/s^2]
    angular: Vector3  # acceleration [rad/s^2]
    force: Vector3  # that its joint must give for it [N]
    moment: Vector3  # that its joint must give for it [N m]
    block_a: Vector6  # force by acceleration
    block_b: Annotated[Floats, 9]  # force by angular acceleration
    block_d: Vector6  # moment by angular acceleration
    ratio: Annotated[Floats, 9]  # of a joint taken out, a' = driven - ratio a
    driven: Vector6  # of a joint taken out


ROOM = layout(BodyRoom)

#: A matrix, row after row.
Nine = tuple[float, float, float, float, float, float, float, float, float]


@inlined
def turned(r: Floats, x: float, y: float, z: float) -> Triple:
    """Return R a: a vector of the body in its parent's axes."""
    return (
        r[0, 0] * x + r[0, 1] * y + r[0, 2] * z,
        r[1, 0] * x + r[1, 1] * y + r[1, 2] * z,
        r[2, 0] * x + r[2, 1] * y + r[2, 2] * z,
    )


@inlined
def turned_back(r: Floats, x: float, y: float, z: float) -> Triple:
    """Return R^T a."""
    return (
        r[0, 0] * x + r[1, 0] * y + r[2, 0] * z,
        r[0, 1] * x + r[1, 1] * y + r[2, 1] * z,
        r[0, 2] * x + r[1, 2] * y + r[2, 2] * z,
    )


@inlined
def crossed(ax: float, ay: float, az: float, bx: float, by: float, bz: float) -> Triple:
    """Return a x b."""
    return ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx


@inlined
def symmetric_times(s: Floats, x: float, y: float, z: float) -> Triple:
    """Return S a of a symmetric matrix."""
    return (
        s[0] * x + s[1] * y + s[2] * z,
        s[1] * x + s[3] * y + s[4] * z,
        s[2] * x + s[4] * y + s[5] * z,
    )


@inlined
def turned_symmetric(r: Floats, s: Floats) -> Six:
    """Return R S R^T of a symmetric matrix."""
    x0, y0, z0 = symmetric_times(s, r[0, 0], r[0, 1], r[0, 2])
    x1, y1, z1 = symmetric_times(s, r[1, 0], r[1, 1], r[1, 2])
    x2, y2, z2 = symmetric_times(s, r[2, 0], r[2, 1], r[2, 2])
    return (
        r[0, 0] * x0 + r[0, 1] * y0 + r[0, 2] * z0,
        r[1, 0] * x0 + r[1, 1] * y0 + r[1, 2] * z0,
        r[2, 0] * x0 + r[2, 1] * y0 + r[2, 2] * z0,
        r[1, 0] * x1 + r[1, 1] * y1 + r[1, 2] * z1,
        r[2, 0] * x1 + r[2, 1] * y1 + r[2, 2] * z1,
        r[2, 0] * x2 + r[2, 1] * y2 + r[2, 2] * z2,
    )


@inlined
def turned_matrix(r: Floats, s: Floats) -> Nine:
    """Return R B R^T of any matrix, row after row, (9,)."""
    x0, x1, x2 = turned(r, s[0], s[3], s[6])
    y0, y1, y2 = turned(r, s[1], s[4], s[7])
    z0, z1, z2 = turned(r, s[2], s[5], s[8])
    a0, a1, a2 = turned(r, x0, y0, z0)
    b0, b1, b2 = turned(r, x1, y1, z1)
    c0, c1, c2 = turned(r, x2, y2, z2)
    return a0, a1, a2, b0, b1, b2, c0, c1, c2


@inlined
def move(body: Body, y: Floats, nq: int, room: Records[BodyRoom], own: BodyRoom, way: BodyRoom) -> None:
    """Write a body's place in its parent, its velocity, and its velocity-dependent acceleration.

    With u and w of the joint, all in the body's axes: ``spin x u + velocity x w`` and ``spin x w``.
    """
    relative(body, y, nq, way)
    p, m, r = body.rotation, way.rotation, own.rotation
    for k in range(3):
        a, b, c = p[k, 0], p[k, 1], p[k, 2]
        own.origin[k] = body.position[k] + a * way.origin[0] + b * way.origin[1] + c * way.origin[2]
        for n in range(3):
            r[k, n] = a * m[0, n] + b * m[1, n] + c * m[2, n]
    ux, uy, uz = way.velocity[0], way.velocity[1], way.velocity[2]
    tx, ty, tz = way.spin[0], way.spin[1], way.spin[2]
    own.slide[0], own.slide[1], own.slide[2] = ux, uy, uz
    own.turn[0], own.turn[1], own.turn[2] = tx, ty, tz
    vx, vy, vz, wx, wy, wz = ux, uy, uz, tx, ty, tz
    if body.parent >= 0:
        on = room[body.parent]
        ax, ay, az = on.spin[0], on.spin[1], on.spin[2]
        bx, by, bz = crossed(ax, ay, az, own.origin[0], own.origin[1], own.origin[2])
        bx, by, bz = turned_back(r, on.velocity[0] + bx, on.velocity[1] + by, on.velocity[2] + bz)
        ax, ay, az = turned_back(r, ax, ay, az)
        vx, vy, vz, wx, wy, wz = vx + bx, vy + by, vz + bz, wx + ax, wy + ay, wz + az
    own.velocity[0], own.velocity[1], own.velocity[2] = vx, vy, vz
    own.spin[0], own.spin[1], own.spin[2] = wx, wy, wz
    ax, ay, az = crossed(wx, wy, wz, ux, uy, uz)
    bx, by, bz = crossed(vx, vy, vz, tx, ty, tz)
    own.bias[0], own.bias[1], own.bias[2] = ax + bx, ay + by, az + bz
    own.bias_spin[0], own.bias_spin[1], own.bias_spin[2] = crossed(wx, wy, wz, tx, ty, tz)


@inlined
def carried_acceleration(body: Body, gravity: Floats, room: Records[BodyRoom], own: BodyRoom) -> Six:
    """Return the acceleration of a body whose joint does not accelerate, (6,)."""
    r, p, bias, bias_spin = own.rotation, own.origin, own.bias, own.bias_spin
    if body.parent < 0:
        ax, ay, az = turned_back(r, -gravity[0], -gravity[1], -gravity[2])
        return ax + bias[0], ay + bias[1], az + bias[2], bias_spin[0], bias_spin[1], bias_spin[2]
    on = room[body.parent]
    bx, by, bz = on.angular[0], on.angular[1], on.angular[2]
    ax, ay, az = crossed(bx, by, bz, p[0], p[1], p[2])
    ax, ay, az = turned_back(r, on.linear[0] + ax, on.linear[1] + ay, on.linear[2] + az)
    bx, by, bz = turned_back(r, bx, by, bz)
    return ax + bias[0], ay + bias[1], az + bias[2], bx + bias_spin[0], by + bias_spin[1], bz + bias_spin[2]


@inlined
def hand_on(own: BodyRoom, on: BodyRoom, force: Triple, moment: Triple) -> None:
    """Add a wrench at a body's origin, in its axes, to its parent's."""
    fx, fy, fz = turned(own.rotation, force[0], force[1], force[2])
    mx, my, mz = turned(own.rotation, moment[0], moment[1], moment[2])
    cx, cy, cz = crossed(own.origin[0], own.origin[1], own.origin[2], fx, fy, fz)
    on.force[0] += fx
    on.force[1] += fy
    on.force[2] += fz
    on.moment[0] += mx + cx
    on.moment[1] += my + cy
    on.moment[2] += mz + cz


@inlined
def gyroscopic_wrench(body: Body, own: BodyRoom) -> Six:
    """Return the wrench at a body's origin for constant spatial velocity.

    With the centre's velocity u: ``f = w x m u`` and ``c x f + w x (I w)``, I about the centre.
    """
    c, m, inertia = body.centre, body.mass, body.inertia
    wx, wy, wz = own.spin[0], own.spin[1], own.spin[2]
    ux, uy, uz = crossed(wx, wy, wz, c[0], c[1], c[2])
    v = own.velocity
    fx, fy, fz = crossed(wx, wy, wz, m * (v[0] + ux), m * (v[1] + uy), m * (v[2] + uz))
    hx, hy, hz = turned(inertia, wx, wy, wz)
    hx, hy, hz = crossed(wx, wy, wz, hx, hy, hz)
    mx, my, mz = crossed(c[0], c[1], c[2], fx, fy, fz)
    return fx, fy, fz, hx + mx, hy + my, hz + mz


@inlined
def inertia_at_origin(body: Body) -> Six:
    """Return a body's inertia about its origin: a symmetric matrix."""
    c, i = body.centre, body.inertia
    x, y, z = c[0], c[1], c[2]
    mx, my, mz = body.mass * x, body.mass * y, body.mass * z
    return (
        i[0, 0] + my * y + mz * z,
        i[0, 1] - mx * y,
        i[0, 2] - mx * z,
        i[1, 1] + mx * x + mz * z,
        i[1, 2] - my * z,
        i[2, 2] + mx * x + my * y,
    )
