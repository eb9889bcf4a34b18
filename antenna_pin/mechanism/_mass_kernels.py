"""Mass matrix of a tree of bodies, and what gravity and velocities ask of its joints, compiled.

``M a + bias = tau``. The matrix is made of composite bodies: a column is the wrench that accelerates all that
a joint moves along one of its directions, as the joints below it feel it; bias is inverse dynamics at rest of
the velocities.
"""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.mechanism._room_kernels import (
    carried_acceleration,
    crossed,
    gyroscopic_wrench,
    hand_on,
    inertia_at_origin,
    move,
    symmetric_times,
    turned,
    turned_symmetric,
)
from antenna_pin.mechanism._tree_kernels import PLANE, RIGID, ROTATION, SLIDE


@kernel
def mass_and_bias(y: Any, nq: int, tree: Any, gravity: Any, room: Any, mass: Any, bias: Any) -> None:
    """Write the mass matrix and the generalized force of gravity and velocities.

    Args:
        y: State, q and v first.
        nq: Where v starts in it.
        tree: Bodies, parents first, BODY, (bodies,).
        gravity: In world axes [m/s^2], (3,).
        room: To write to, ROOM, (bodies + 1,); the last is scratch.
        mass: To write to, both halves, (nv, nv).
        bias: To write to, (nv,).
    """
    bodies = tree.shape[0]
    for b in range(bodies):
        body, own = tree[b], room[b]
        move(body, y, nq, room, own, room[bodies])
        _rest(body, gravity, room, own)
    nv = bias.shape[0]
    for i in range(nv):
        for j in range(nv):
            mass[i, j] = 0.0
    for b in range(bodies - 1, -1, -1):
        body, own = tree[b], room[b]
        _project_bias(body, own, bias)
        if body.parent >= 0:
            f, m = own.force, own.moment
            hand_on(own, room[body.parent], f[0], f[1], f[2], m[0], m[1], m[2])
            _hand_on_composite(own, room[body.parent])
        _columns(tree, room, b, mass)


@inlined
def _rest(body: Any, gravity: Any, room: Any, own: Any) -> None:
    """Write a body's acceleration while no velocity changes, the wrench that takes, and its inertia."""
    ax, ay, az, bx, by, bz = carried_acceleration(body, gravity, room, own)
    own.linear[0], own.linear[1], own.linear[2] = ax, ay, az
    own.angular[0], own.angular[1], own.angular[2] = bx, by, bz
    m, c, d, h = body.mass, body.centre, own.block_d, own.block_b
    h[0], h[1], h[2] = m * c[0], m * c[1], m * c[2]
    own.block_a[0] = m
    d[0], d[1], d[2], d[3], d[4], d[5] = inertia_at_origin(body)
    fx, fy, fz, mx, my, mz = gyroscopic_wrench(body, own)
    x, y, z = crossed(bx, by, bz, h[0], h[1], h[2])
    own.force[0], own.force[1], own.force[2] = fx + m * ax + x, fy + m * ay + y, fz + m * az + z
    x, y, z = crossed(h[0], h[1], h[2], ax, ay, az)
    bx, by, bz = symmetric_times(d, bx, by, bz)
    own.moment[0], own.moment[1], own.moment[2] = mx + x + bx, my + y + by, mz + z + bz


@inlined
def _project_bias(body: Any, own: Any, bias: Any) -> None:
    """Write what a joint must give of the wrench that its body needs."""
    f, m, k, axis = own.force, own.moment, body.v, body.axis
    if body.kind == RIGID:
        for n in range(3):
            bias[k + n], bias[k + 3 + n] = f[n], m[n]
    elif body.kind == ROTATION:
        for n in range(3):
            bias[k + n] = m[n]
    elif body.kind == PLANE:
        bias[k], bias[k + 1], bias[k + 2] = f[0], f[1], m[2]
    elif body.kind == SLIDE:
        bias[k] = axis[0] * f[0] + axis[1] * f[1] + axis[2] * f[2]
    else:
        bias[k] = axis[0] * m[0] + axis[1] * m[1] + axis[2] * m[2]


@inlined
def _hand_on_composite(own: Any, on: Any) -> None:
    """Add mass, first moment and inertia of a body with all it carries to the one it is on."""
    m, h, p, d = own.block_a[0], own.block_b, own.origin, on.block_d
    hx, hy, hz = turned(own.rotation, h[0], h[1], h[2])
    xx, xy, xz, yy, yz, zz = turned_symmetric(own.rotation, own.block_d)
    x, y, z = p[0], p[1], p[2]
    on.block_a[0] += m
    on.block_b[0] += hx + m * x
    on.block_b[1] += hy + m * y
    on.block_b[2] += hz + m * z
    # What D gains of p and the first moment h: (q . p) - (q p^T + p q^T) / 2, q = 2 h + m p.
    hx, hy, hz = 2.0 * hx + m * x, 2.0 * hy + m * y, 2.0 * hz + m * z
    d[0] += xx + hy * y + hz * z
    d[1] += xy - 0.5 * (hx * y + hy * x)
    d[2] += xz - 0.5 * (hx * z + hz * x)
    d[3] += yy + hx * x + hz * z
    d[4] += yz - 0.5 * (hy * z + hz * y)
    d[5] += zz + hx * x + hy * y


@inlined
def _columns(tree: Any, room: Any, b: int, mass: Any) -> None:
    """Write what the mass matrix has of a joint: with itself, and with those that carry it."""
    body, own = tree[b], room[b]
    m, h, d, k, axis = own.block_a[0], own.block_b, own.block_d, body.v, body.axis
    kind = body.kind
    if kind == SLIDE:
        _way(tree, room, b, k, m, h, axis[0], axis[1], axis[2], mass)
        return
    if kind != RIGID and kind != ROTATION and kind != PLANE:
        _turn(tree, room, b, k, h, d, axis[0], axis[1], axis[2], mass)
        return
    if kind != ROTATION:
        _way(tree, room, b, k, m, h, 1.0, 0.0, 0.0, mass)
        _way(tree, room, b, k + 1, m, h, 0.0, 1.0, 0.0, mass)
        k += 2
    if kind == RIGID:
        _way(tree, room, b, k, m, h, 0.0, 0.0, 1.0, mass)
        k += 1
    if kind != PLANE:
        _turn(tree, room, b, k, h, d, 1.0, 0.0, 0.0, mass)
        _turn(tree, room, b, k + 1, h, d, 0.0, 1.0, 0.0, mass)
        k += 2
    _turn(tree, room, b, k, h, d, 0.0, 0.0, 1.0, mass)


@inlined
def _way(
    tree: Any, room: Any, b: int, at: int, m: float, h: Any, x: float, y: float, z: float, mass: Any
) -> None:
    """Write the column of a displacement along (x, y, z)."""
    mx, my, mz = crossed(h[0], h[1], h[2], x, y, z)
    _column(tree, room, b, at, m * x, m * y, m * z, mx, my, mz, mass)


@inlined
def _turn(
    tree: Any, room: Any, b: int, at: int, h: Any, d: Any, x: float, y: float, z: float, mass: Any
) -> None:
    """Write the column of a turn about (x, y, z)."""
    fx, fy, fz = crossed(x, y, z, h[0], h[1], h[2])
    mx, my, mz = symmetric_times(d, x, y, z)
    _column(tree, room, b, at, fx, fy, fz, mx, my, mz, mass)


@kernel
def _column(
    tree: Any,
    room: Any,
    b: int,
    at: int,
    fx: float,
    fy: float,
    fz: float,
    mx: float,
    my: float,
    mz: float,
    mass: Any,
) -> None:
    """Write a column and its mirror image: what a wrench on a body is to its joint and those below."""
    while True:
        body = tree[b]
        k, axis = body.v, body.axis
        if body.kind == RIGID:
            _mirror(mass, k, at, fx)
            _mirror(mass, k + 1, at, fy)
            _mirror(mass, k + 2, at, fz)
            _mirror(mass, k + 3, at, mx)
            _mirror(mass, k + 4, at, my)
            _mirror(mass, k + 5, at, mz)
        elif body.kind == ROTATION:
            _mirror(mass, k, at, mx)
            _mirror(mass, k + 1, at, my)
            _mirror(mass, k + 2, at, mz)
        elif body.kind == PLANE:
            _mirror(mass, k, at, fx)
            _mirror(mass, k + 1, at, fy)
            _mirror(mass, k + 2, at, mz)
        elif body.kind == SLIDE:
            _mirror(mass, k, at, axis[0] * fx + axis[1] * fy + axis[2] * fz)
        else:
            _mirror(mass, k, at, axis[0] * mx + axis[1] * my + axis[2] * mz)
        if body.parent < 0:
            return
        own = room[b]
        p = own.origin
        fx, fy, fz = turned(own.rotation, fx, fy, fz)
        mx, my, mz = turned(own.rotation, mx, my, mz)
        cx, cy, cz = crossed(p[0], p[1], p[2], fx, fy, fz)
        mx, my, mz = mx + cx, my + cy, mz + cz
        b = body.parent


@inlined
def _mirror(mass: Any, i: int, j: int, value: float) -> None:
    """Write an entry of a symmetric matrix."""
    mass[i, j] = value
    mass[j, i] = value
