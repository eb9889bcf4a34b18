"""Forward dynamics of a tree of bodies, compiled: the articulated-body algorithm of Featherstone.

Seen from its joint, a body with all that it carries has an inertia and a force at rest that are those of one
body: a joint takes out of them what it lets go, and hands on the rest. A joint of six degrees of freedom lets
go of everything: it hands on its own force and no inertia, and its body's acceleration follows at once.
"""

from __future__ import annotations

from antenna_pin.base.records import PLANE, RIGID, ROTATION, SLIDE, Floats, Records
from antenna_pin.compiled.decorators import deferred, inlined
from antenna_pin.mechanism.room_kernels import (
    BodyRoom,
    carried_acceleration,
    gyroscopic_wrench,
    hand_on,
    move,
    symmetric_times,
    turned_matrix,
    turned_symmetric,
)
from antenna_pin.mechanism.take_out_kernels import (
    let_go,
    sum_inertia,
    take_out_axis,
    take_out_plane,
    take_out_rotation,
)
from antenna_pin.mechanism.tree_kernels import Body


@deferred
def aba(
    y: Floats,
    nq: int,
    tree: Records[Body],
    gravity: Floats,
    tau: Floats,
    room: Records[BodyRoom],
    acceleration: Floats,
) -> None:
    """Write the acceleration of a tree under generalized forces.

    Args:
        y: State, q and v first.
        nq: Where v starts in it.
        tree: Bodies, parents first, BODY, (bodies,).
        gravity: In world axes [m/s^2], (3,).
        tau: Generalized force, (nv,).
        room: To write to, ROOM, (bodies + 1,); the last is scratch.
        acceleration: To write to, (nv,).
    """
    bodies = tree.shape[0]
    for b in range(bodies):
        body, own = tree[b], room[b]
        move(body, y, nq, room, own, room[bodies])
        fx, fy, fz, mx, my, mz = gyroscopic_wrench(body, own)
        own.force[0], own.force[1], own.force[2] = fx, fy, fz
        own.moment[0], own.moment[1], own.moment[2] = mx, my, mz
        own.carries = 0
    for b in range(bodies - 1, -1, -1):
        body, own = tree[b], room[b]
        if body.kind == RIGID:
            let_go(body, own, tau)
            if body.parent >= 0:
                k = body.v
                force, moment = (tau[k], tau[k + 1], tau[k + 2]), (tau[k + 3], tau[k + 4], tau[k + 5])
                hand_on(own, room[body.parent], force, moment)
            continue
        sum_inertia(body, own)
        if body.kind == ROTATION:
            take_out_rotation(body, own, tau)
        elif body.kind == PLANE:
            take_out_plane(body, own, tau)
        else:
            take_out_axis(body, own, tau)
        if body.parent >= 0:
            _hand_on_inertia(own, room[body.parent])
    for b in range(bodies):
        _accelerate(tree[b], gravity, room, room[b], acceleration)


@inlined
def _hand_on_inertia(own: BodyRoom, on: BodyRoom) -> None:
    """Add a joint's remaining inertia and its wrench to the parent body."""
    a, b, d, c, s, f, m = (
        own.block_a,
        own.block_b,
        own.block_d,
        own.bias,
        own.bias_spin,
        own.force,
        own.moment,
    )
    ax, ay, az = symmetric_times(a, c[0], c[1], c[2])
    mx, my, mz = symmetric_times(d, s[0], s[1], s[2])
    force = (
        f[0] + ax + b[0] * s[0] + b[1] * s[1] + b[2] * s[2],
        f[1] + ay + b[3] * s[0] + b[4] * s[1] + b[5] * s[2],
        f[2] + az + b[6] * s[0] + b[7] * s[1] + b[8] * s[2],
    )
    moment = (
        m[0] + mx + b[0] * c[0] + b[3] * c[1] + b[6] * c[2],
        m[1] + my + b[1] * c[0] + b[4] * c[1] + b[7] * c[2],
        m[2] + mz + b[2] * c[0] + b[5] * c[1] + b[8] * c[2],
    )
    hand_on(own, on, force, moment)
    r, x, y, z = own.rotation, own.origin[0], own.origin[1], own.origin[2]
    xx, xy, xz, yy, yz, zz = turned_symmetric(r, a)
    p0, p1, p2, p3, p4, p5, p6, p7, p8 = turned_matrix(r, b)
    # At the other origin, p away: B - A [p x], and D - B^T [p x] + [p x] (B - A [p x]).
    g0, g1, g2 = p0 - (xy * z - xz * y), p1 - (xz * x - xx * z), p2 - (xx * y - xy * x)
    g3, g4, g5 = p3 - (yy * z - yz * y), p4 - (yz * x - xy * z), p5 - (xy * y - yy * x)
    g6, g7, g8 = p6 - (yz * z - zz * y), p7 - (zz * x - xz * z), p8 - (xz * y - yz * x)
    d0, d1, d2, d3, d4, d5 = turned_symmetric(r, d)
    d0 += y * g6 - z * g3 - (p3 * z - p6 * y)
    d1 += y * g7 - z * g4 - (p6 * x - p0 * z)
    d2 += y * g8 - z * g5 - (p0 * y - p3 * x)
    d3 += z * g1 - x * g7 - (p7 * x - p1 * z)
    d4 += z * g2 - x * g8 - (p1 * y - p4 * x)
    d5 += x * g5 - y * g2 - (p2 * y - p5 * x)
    a, b, d = on.block_a, on.block_b, on.block_d
    if on.carries == 0:
        on.carries = 1
        a[0], a[1], a[2], a[3], a[4], a[5] = xx, xy, xz, yy, yz, zz
        b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8] = g0, g1, g2, g3, g4, g5, g6, g7, g8
        d[0], d[1], d[2], d[3], d[4], d[5] = d0, d1, d2, d3, d4, d5
        return
    a[0] += xx
    a[1] += xy
    a[2] += xz
    a[3] += yy
    a[4] += yz
    a[5] += zz
    b[0] += g0
    b[1] += g1
    b[2] += g2
    b[3] += g3
    b[4] += g4
    b[5] += g5
    b[6] += g6
    b[7] += g7
    b[8] += g8
    d[0] += d0
    d[1] += d1
    d[2] += d2
    d[3] += d3
    d[4] += d4
    d[5] += d5


@inlined
def _accelerate(
    body: Body, gravity: Floats, room: Records[BodyRoom], own: BodyRoom, acceleration: Floats
) -> None:
    """Write how a joint accelerates, and its body."""
    ax, ay, az, bx, by, bz = carried_acceleration(body, gravity, room, own)
    kind, k, ratio, w, axis = body.kind, body.v, own.ratio, own.driven, body.axis
    linear, angular = own.linear, own.angular
    if kind == RIGID:
        acceleration[k] = linear[0] - ax
        acceleration[k + 1] = linear[1] - ay
        acceleration[k + 2] = linear[2] - az
        acceleration[k + 3] = angular[0] - bx
        acceleration[k + 4] = angular[1] - by
        acceleration[k + 5] = angular[2] - bz
        return
    if kind == ROTATION:
        x = w[0] - ratio[0] * ax - ratio[1] * ay - ratio[2] * az
        y = w[1] - ratio[3] * ax - ratio[4] * ay - ratio[5] * az
        z = w[2] - ratio[6] * ax - ratio[7] * ay - ratio[8] * az
        acceleration[k], acceleration[k + 1], acceleration[k + 2] = x - bx, y - by, z - bz
        bx, by, bz = x, y, z
    elif kind == PLANE:
        x = w[0] - ratio[0] * az - ratio[1] * bx - ratio[2] * by
        y = w[1] - ratio[3] * az - ratio[4] * bx - ratio[5] * by
        z = w[2] - ratio[6] * az - ratio[7] * bx - ratio[8] * by
        acceleration[k], acceleration[k + 1], acceleration[k + 2] = x - ax, y - ay, z - bz
        ax, ay, bz = x, y, z
    else:
        rate = w[0] - (
            ratio[0] * ax + ratio[1] * ay + ratio[2] * az + ratio[3] * bx + ratio[4] * by + ratio[5] * bz
        )
        acceleration[k] = rate
        x, y, z = rate * axis[0], rate * axis[1], rate * axis[2]
        if kind == SLIDE:
            ax, ay, az = ax + x, ay + y, az + z
        else:
            bx, by, bz = bx + x, by + y, bz + z
    linear[0], linear[1], linear[2] = ax, ay, az
    angular[0], angular[1], angular[2] = bx, by, bz
