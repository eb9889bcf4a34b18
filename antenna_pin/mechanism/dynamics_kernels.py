"""Forward dynamics of a tree of bodies, compiled: the articulated-body algorithm of Featherstone.

Seen from its joint, a body with all that it carries has an inertia and a force at rest that are those of one
body: a joint takes out of them what it lets go, and hands on the rest. A joint of six degrees of freedom lets
go of everything: it hands on its own force and no inertia, and its body's acceleration follows at once.
"""

from __future__ import annotations

from antenna_pin.base.records import PLANE, RIGID, ROTATION, SLIDE, Floats, Records, Six, Triple
from antenna_pin.compiled.decorators import deferred, inlined
from antenna_pin.mechanism.room_kernels import (
    BodyRoom,
    Nine,
    carried_acceleration,
    crossed,
    gyroscopic_wrench,
    hand_on,
    inertia_at_origin,
    move,
    symmetric_times,
    turned_matrix,
    turned_symmetric,
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


# --- take-out -----------------------------------------------------------------------------------------------


@inlined
def _factors(xx: float, xy: float, xz: float, yy: float, yz: float, zz: float) -> Six:
    """Return the factors L (3) and D^-1 (3) of a symmetric matrix, L D L^T."""
    x = 1.0 / xx
    a, b = xy * x, xz * x
    y = 1.0 / (yy - a * xy)
    left = yz - b * xy
    c = left * y
    return a, b, c, x, y, 1.0 / (zz - b * xz - c * left)


@inlined
def _solved(factors: Six, x: float, y: float, z: float) -> Triple:
    """Solve for a vector with the factors of a matrix."""
    a, b, c, dx, dy, dz = factors
    y -= a * x
    z = dz * (z - b * x - c * y)
    y = dy * y - c * z
    return dx * x - a * y - b * z, y, z


@inlined
def sum_inertia(body: Body, own: BodyRoom) -> None:
    """Add a body's own inertia at its origin to what it carries."""
    m, c = body.mass, body.centre
    mx, my, mz = m * c[0], m * c[1], m * c[2]
    a, b, d = own.block_a, own.block_b, own.block_d
    xx, xy, xz, yy, yz, zz = inertia_at_origin(body)
    if own.carries == 0:
        a[0], a[1], a[2], a[3], a[4], a[5] = m, 0.0, 0.0, m, 0.0, m
        b[0], b[1], b[2] = 0.0, mz, -my
        b[3], b[4], b[5] = -mz, 0.0, mx
        b[6], b[7], b[8] = my, -mx, 0.0
        d[0], d[1], d[2], d[3], d[4], d[5] = xx, xy, xz, yy, yz, zz
        return
    a[0] += m
    a[3] += m
    a[5] += m
    b[1] += mz
    b[2] -= my
    b[3] -= mz
    b[5] += mx
    b[6] += my
    b[7] -= mx
    d[0] += xx
    d[1] += xy
    d[2] += xz
    d[3] += yy
    d[4] += yz
    d[5] += zz


@inlined
def let_go(body: Body, own: BodyRoom, tau: Floats) -> None:
    """Write the acceleration of a body whose joint leaves all six freedoms."""
    k, c = body.v, body.centre
    fx, fy, fz = tau[k] - own.force[0], tau[k + 1] - own.force[1], tau[k + 2] - own.force[2]
    mx, my, mz = tau[k + 3] - own.moment[0], tau[k + 4] - own.moment[1], tau[k + 5] - own.moment[2]
    if own.carries == 0:
        # Of one rigid body: about its centre, for itself.
        i = body.inertia
        x, y, z = crossed(c[0], c[1], c[2], fx, fy, fz)
        factors = _factors(i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2])
        ax, ay, az = _solved(factors, mx - x, my - y, mz - z)
        x, y, z = crossed(c[0], c[1], c[2], ax, ay, az)
        lightness = 1.0 / body.mass
        own.linear[0], own.linear[1], own.linear[2] = (
            x + lightness * fx,
            y + lightness * fy,
            z + lightness * fz,
        )
        own.angular[0], own.angular[1], own.angular[2] = ax, ay, az
        return
    sum_inertia(body, own)
    a, b, d = own.block_a, own.block_b, own.block_d
    factors = _factors(a[0], a[1], a[2], a[3], a[4], a[5])
    x0, y0, z0 = _solved(factors, b[0], b[3], b[6])
    x1, y1, z1 = _solved(factors, b[1], b[4], b[7])
    x2, y2, z2 = _solved(factors, b[2], b[5], b[8])
    left = _factors(
        d[0] - b[0] * x0 - b[3] * y0 - b[6] * z0,
        d[1] - b[0] * x1 - b[3] * y1 - b[6] * z1,
        d[2] - b[0] * x2 - b[3] * y2 - b[6] * z2,
        d[3] - b[1] * x1 - b[4] * y1 - b[7] * z1,
        d[4] - b[1] * x2 - b[4] * y2 - b[7] * z2,
        d[5] - b[2] * x2 - b[5] * y2 - b[8] * z2,
    )
    mx -= x0 * fx + y0 * fy + z0 * fz
    my -= x1 * fx + y1 * fy + z1 * fz
    mz -= x2 * fx + y2 * fy + z2 * fz
    ax, ay, az = _solved(left, mx, my, mz)
    fx, fy, fz = _solved(factors, fx, fy, fz)
    own.linear[0] = fx - x0 * ax - x1 * ay - x2 * az
    own.linear[1] = fy - y0 * ax - y1 * ay - y2 * az
    own.linear[2] = fz - z0 * ax - z1 * ay - z2 * az
    own.angular[0], own.angular[1], own.angular[2] = ax, ay, az


@inlined
def take_out_axis(body: Body, own: BodyRoom, tau: Floats) -> None:
    """Eliminate a hinge or a slide from the inertia of its body."""
    a, b, d, ratio, f, m = own.block_a, own.block_b, own.block_d, own.ratio, own.force, own.moment
    x, y, z = body.axis[0], body.axis[1], body.axis[2]
    if body.kind == SLIDE:
        ux, uy, uz = symmetric_times(a, x, y, z)
        tx, ty, tz = (
            b[0] * x + b[3] * y + b[6] * z,
            b[1] * x + b[4] * y + b[7] * z,
            b[2] * x + b[5] * y + b[8] * z,
        )
        inverse = 1.0 / (x * ux + y * uy + z * uz)
        left = tau[body.v] - x * f[0] - y * f[1] - z * f[2]
    else:
        ux, uy, uz = (
            b[0] * x + b[1] * y + b[2] * z,
            b[3] * x + b[4] * y + b[5] * z,
            b[6] * x + b[7] * y + b[8] * z,
        )
        tx, ty, tz = symmetric_times(d, x, y, z)
        inverse = 1.0 / (x * tx + y * ty + z * tz + body.armature)
        left = tau[body.v] - x * m[0] - y * m[1] - z * m[2]
    rx, ry, rz, sx, sy, sz = (
        ux * inverse,
        uy * inverse,
        uz * inverse,
        tx * inverse,
        ty * inverse,
        tz * inverse,
    )
    own.driven[0] = left * inverse
    ratio[0], ratio[1], ratio[2], ratio[3], ratio[4], ratio[5] = rx, ry, rz, sx, sy, sz
    if body.parent < 0:
        return
    a[0] -= ux * rx
    a[1] -= ux * ry
    a[2] -= ux * rz
    a[3] -= uy * ry
    a[4] -= uy * rz
    a[5] -= uz * rz
    b[0] -= ux * sx
    b[1] -= ux * sy
    b[2] -= ux * sz
    b[3] -= uy * sx
    b[4] -= uy * sy
    b[5] -= uy * sz
    b[6] -= uz * sx
    b[7] -= uz * sy
    b[8] -= uz * sz
    d[0] -= tx * sx
    d[1] -= tx * sy
    d[2] -= tx * sz
    d[3] -= ty * sy
    d[4] -= ty * sz
    d[5] -= tz * sz
    f[0] += rx * left
    f[1] += ry * left
    f[2] += rz * left
    m[0] += sx * left
    m[1] += sy * left
    m[2] += sz * left


@inlined
def _condense(own: BodyRoom, k: Floats | Six, n: Nine, q: Floats | Six, x: float, y: float, z: float) -> Nine:
    """Eliminate three free directions: K among them, N to the others, Q among those.

    Writes ``K^-1 N`` and ``K^-1 (x, y, z)`` for the accelerations; returns what is left of Q, and what the
    force (x, y, z) along the free directions does along the others.
    """
    factors = _factors(k[0], k[1], k[2], k[3], k[4], k[5])
    x0, y0, z0 = _solved(factors, n[0], n[3], n[6])
    x1, y1, z1 = _solved(factors, n[1], n[4], n[7])
    x2, y2, z2 = _solved(factors, n[2], n[5], n[8])
    ratio = own.ratio
    ratio[0], ratio[1], ratio[2] = x0, x1, x2
    ratio[3], ratio[4], ratio[5] = y0, y1, y2
    ratio[6], ratio[7], ratio[8] = z0, z1, z2
    own.driven[0], own.driven[1], own.driven[2] = _solved(factors, x, y, z)
    return (
        q[0] - n[0] * x0 - n[3] * y0 - n[6] * z0,
        q[1] - n[0] * x1 - n[3] * y1 - n[6] * z1,
        q[2] - n[0] * x2 - n[3] * y2 - n[6] * z2,
        q[3] - n[1] * x1 - n[4] * y1 - n[7] * z1,
        q[4] - n[1] * x2 - n[4] * y2 - n[7] * z2,
        q[5] - n[2] * x2 - n[5] * y2 - n[8] * z2,
        x0 * x + y0 * y + z0 * z,
        x1 * x + y1 * y + z1 * z,
        x2 * x + y2 * y + z2 * z,
    )


@inlined
def take_out_rotation(body: Body, own: BodyRoom, tau: Floats) -> None:
    """Eliminate a joint with three rotations: only its own moment is transmitted."""
    a, b, d, f, m, v = own.block_a, own.block_b, own.block_d, own.force, own.moment, body.v
    n = (b[0], b[3], b[6], b[1], b[4], b[7], b[2], b[5], b[8])
    x, y, z = tau[v] - m[0], tau[v + 1] - m[1], tau[v + 2] - m[2]
    a[0], a[1], a[2], a[3], a[4], a[5], x, y, z = _condense(own, d, n, a, x, y, z)
    for k in range(9):
        b[k] = 0.0
    for k in range(6):
        d[k] = 0.0
    f[0] += x
    f[1] += y
    f[2] += z
    m[0], m[1], m[2] = tau[v], tau[v + 1], tau[v + 2]


@inlined
def take_out_plane(body: Body, own: BodyRoom, tau: Floats) -> None:
    """Eliminate a joint in the plane of x and y, with rotation about z."""
    a, b, d, f, m, v = own.block_a, own.block_b, own.block_d, own.force, own.moment, body.v
    among = (a[0], a[1], b[2], a[3], b[5], d[5])
    to_others = (a[2], b[0], b[1], a[4], b[3], b[4], b[8], d[2], d[4])
    others = (a[5], b[6], b[7], d[0], d[1], d[3])
    x, y, z = tau[v] - f[0], tau[v + 1] - f[1], tau[v + 2] - m[2]
    left = _condense(own, among, to_others, others, x, y, z)
    for k in range(5):
        a[k] = 0.0
    for k in range(9):
        b[k] = 0.0
    a[5], b[6], b[7] = left[0], left[1], left[2]
    d[0], d[1], d[2], d[3], d[4], d[5] = left[3], left[4], 0.0, left[5], 0.0, 0.0
    f[0], f[1] = tau[v], tau[v + 1]
    f[2] += left[6]
    m[0] += left[7]
    m[1] += left[8]
    m[2] = tau[v + 2]
