"""Mass matrix of a tree of bodies, and bias force of gravity and velocities, compiled.

``M a + bias = tau``. The matrix is made of composite bodies: a column is the wrench that accelerates all that
a joint moves along one of its directions, as the joints below it feel it; bias is inverse dynamics at rest of
the velocities (Featherstone (2008), Rigid Body Dynamics Algorithms, chapters 5 and 6). Where bodies are and
how they move is known: all is in world axes, and goes from a body to the one it is on without being turned.
"""

from __future__ import annotations

from antenna_pin.base.records import PLANE, RIGID, ROTATION, SLIDE, Floats, Records, Triple
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.mechanism.room_kernels import (
    BodyRoom,
    crossed,
    symmetric_times,
    turned,
    turned_back,
    turned_symmetric,
)
from antenna_pin.mechanism.tree_kernels import Body, Place


@kernel
def mass_and_bias(
    tree: Records[Body],
    places: Records[Place],
    gravity: Floats,
    room: Records[BodyRoom],
    mass: Floats,
    bias: Floats,
) -> None:
    """Write the mass matrix and the generalized force of gravity and velocities.

    Args:
        tree: Bodies, parents first, BODY, (bodies,).
        places: Where they are and how they move, PLACE, with what
            :func:`antenna_pin.mechanism.tree_kernels.bias_accelerations` writes, (bodies + 1,).
        gravity: In world axes [m/s^2], (3,).
        room: To write to, ROOM, (bodies + 1,). Of a body: ``origin`` from that of the body it is on, its
            joint's axis (``turn``), and mass, first moment and inertia of all it carries about its origin.
        mass: To write to, both halves, (nv, nv).
        bias: To write to, (nv,).
    """
    bodies = tree.shape[0]
    for b in range(bodies):
        _rest(tree[b], gravity, places, places[b], room[b])
    nv = bias.shape[0]
    for i in range(nv):
        for j in range(nv):
            mass[i, j] = 0.0
    for b in range(bodies - 1, -1, -1):
        body, own = tree[b], room[b]
        _project_bias(body, places[b], own, bias)
        if body.parent >= 0:
            _hand_on(own, room[body.parent])
        _columns(tree, places, room, b, mass)
        mass[body.v, body.v] += body.armature


@inlined
def _rest(body: Body, gravity: Floats, places: Records[Place], place: Place, own: BodyRoom) -> None:
    """Write a body's inertia and its wrench at zero generalized acceleration."""
    r, axis, c, m, w = place.rotation, body.axis, body.centre, body.mass, place.spin
    own.turn[0], own.turn[1], own.turn[2] = turned(r, axis[0], axis[1], axis[2])
    for k in range(3):
        own.origin[k] = place.origin[k]
    if body.parent >= 0:
        on = places[body.parent]
        for k in range(3):
            own.origin[k] -= on.origin[k]
    x, y, z = turned(r, c[0], c[1], c[2])
    d, h, inertia = own.block_d, own.block_b, own.block_a
    # Of the inertia about the centre only one half is looked at.
    i = body.inertia
    d[0], d[1], d[2], d[3], d[4], d[5] = i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]
    d[0], d[1], d[2], d[3], d[4], d[5] = turned_symmetric(r, d)
    wx, wy, wz = w[0], w[1], w[2]
    ax, ay, az = place.bias_spin[0], place.bias_spin[1], place.bias_spin[2]
    # Of the centre: the origin's acceleration, in which the ground rises, alpha x c + w x (w x c).
    ux, uy, uz = crossed(wx, wy, wz, x, y, z)
    ux, uy, uz = crossed(wx, wy, wz, ux, uy, uz)
    vx, vy, vz = crossed(ax, ay, az, x, y, z)
    fx = m * (place.bias[0] - gravity[0] + ux + vx)
    fy = m * (place.bias[1] - gravity[1] + uy + vy)
    fz = m * (place.bias[2] - gravity[2] + uz + vz)
    ux, uy, uz = symmetric_times(d, wx, wy, wz)
    ux, uy, uz = crossed(wx, wy, wz, ux, uy, uz)
    vx, vy, vz = symmetric_times(d, ax, ay, az)
    sx, sy, sz = crossed(x, y, z, fx, fy, fz)
    own.force[0], own.force[1], own.force[2] = fx, fy, fz
    own.moment[0], own.moment[1], own.moment[2] = ux + vx + sx, uy + vy + sy, uz + vz + sz
    inertia[0] = m
    h[0], h[1], h[2] = m * x, m * y, m * z
    d[0] += h[1] * y + h[2] * z
    d[1] -= h[0] * y
    d[2] -= h[0] * z
    d[3] += h[0] * x + h[2] * z
    d[4] -= h[1] * z
    d[5] += h[0] * x + h[1] * y


@inlined
def _project_bias(body: Body, place: Place, own: BodyRoom, bias: Floats) -> None:
    """Write the bias force of a joint from its body's wrench."""
    f, m, k, axis = own.force, own.moment, body.v, own.turn
    if body.kind == RIGID or body.kind == ROTATION or body.kind == PLANE:
        fx, fy, fz = turned_back(place.rotation, f[0], f[1], f[2])
        mx, my, mz = turned_back(place.rotation, m[0], m[1], m[2])
        if body.kind == PLANE:
            bias[k], bias[k + 1], bias[k + 2] = fx, fy, mz
            return
        if body.kind == RIGID:
            bias[k], bias[k + 1], bias[k + 2] = fx, fy, fz
            k += 3
        bias[k], bias[k + 1], bias[k + 2] = mx, my, mz
    elif body.kind == SLIDE:
        bias[k] = axis[0] * f[0] + axis[1] * f[1] + axis[2] * f[2]
    else:
        bias[k] = axis[0] * m[0] + axis[1] * m[1] + axis[2] * m[2]


@inlined
def _hand_on(own: BodyRoom, on: BodyRoom) -> None:
    """Add wrench, mass, first moment and inertia of a body to its parent's."""
    f, n, m, h, p, d, inertia = (
        own.force,
        own.moment,
        own.block_a[0],
        own.block_b,
        own.origin,
        on.block_d,
        own.block_d,
    )
    x, y, z = p[0], p[1], p[2]
    cx, cy, cz = crossed(x, y, z, f[0], f[1], f[2])
    on.force[0] += f[0]
    on.force[1] += f[1]
    on.force[2] += f[2]
    on.moment[0] += n[0] + cx
    on.moment[1] += n[1] + cy
    on.moment[2] += n[2] + cz
    on.block_a[0] += m
    on.block_b[0] += h[0] + m * x
    on.block_b[1] += h[1] + m * y
    on.block_b[2] += h[2] + m * z
    # What D gains of p and the first moment h: (q . p) - (q p^T + p q^T) / 2, q = 2 h + m p.
    hx, hy, hz = 2.0 * h[0] + m * x, 2.0 * h[1] + m * y, 2.0 * h[2] + m * z
    d[0] += inertia[0] + hy * y + hz * z
    d[1] += inertia[1] - 0.5 * (hx * y + hy * x)
    d[2] += inertia[2] - 0.5 * (hx * z + hz * x)
    d[3] += inertia[3] + hx * x + hz * z
    d[4] += inertia[4] - 0.5 * (hy * z + hz * y)
    d[5] += inertia[5] + hx * x + hy * y


@inlined
def _columns(
    tree: Records[Body], places: Records[Place], room: Records[BodyRoom], b: int, mass: Floats
) -> None:
    """Write the entries of a joint in the mass matrix: its own and its ancestors'."""
    body, own, r = tree[b], room[b], places[b].rotation
    m, h, d, k, turn = own.block_a[0], own.block_b, own.block_d, body.v, own.turn
    kind, bodies, axis = body.kind, (tree, places, room), (turn[0], turn[1], turn[2])
    if kind == SLIDE:
        _way(bodies, b, k, m, h, axis, mass)
        return
    if kind != RIGID and kind != ROTATION and kind != PLANE:
        _turn(bodies, b, k, h, d, axis, mass)
        return
    for n in range(0 if kind == ROTATION else 2 if kind == PLANE else 3):
        _way(bodies, b, k, m, h, (r[0, n], r[1, n], r[2, n]), mass)
        k += 1
    for n in range(2 if kind == PLANE else 0, 3):
        _turn(bodies, b, k, h, d, (r[0, n], r[1, n], r[2, n]), mass)
        k += 1


@inlined
def _way(
    bodies: tuple[Records[Body], Records[Place], Records[BodyRoom]],
    b: int,
    at: int,
    m: float,
    h: Floats,
    axis: Triple,
    mass: Floats,
) -> None:
    """Write the column of a displacement along an axis."""
    x, y, z = axis
    moment = crossed(h[0], h[1], h[2], x, y, z)
    _column(bodies, b, at, (m * x, m * y, m * z), moment, mass)


@inlined
def _turn(
    bodies: tuple[Records[Body], Records[Place], Records[BodyRoom]],
    b: int,
    at: int,
    h: Floats,
    d: Floats,
    axis: Triple,
    mass: Floats,
) -> None:
    """Write the column of a turn about an axis."""
    x, y, z = axis
    force = crossed(x, y, z, h[0], h[1], h[2])
    _column(bodies, b, at, force, symmetric_times(d, x, y, z), mass)


@kernel
def _column(
    bodies: tuple[Records[Body], Records[Place], Records[BodyRoom]],
    b: int,
    at: int,
    force: Triple,
    moment: Triple,
    mass: Floats,
) -> None:
    """Write a column and its mirror image by projection of a wrench on joints."""
    tree, places, room = bodies
    fx, fy, fz = force
    mx, my, mz = moment
    while True:
        body, own = tree[b], room[b]
        k, kind, axis = body.v, body.kind, own.turn
        if kind == SLIDE:
            _mirror(mass, k, at, axis[0] * fx + axis[1] * fy + axis[2] * fz)
        elif kind == RIGID or kind == ROTATION or kind == PLANE:
            rotation = places[b].rotation
            ux, uy, uz = turned_back(rotation, fx, fy, fz)
            tx, ty, tz = turned_back(rotation, mx, my, mz)
            if kind != ROTATION:
                _mirror(mass, k, at, ux)
                _mirror(mass, k + 1, at, uy)
                k += 2
            if kind == RIGID:
                _mirror(mass, k, at, uz)
                k += 1
            if kind != PLANE:
                _mirror(mass, k, at, tx)
                _mirror(mass, k + 1, at, ty)
                k += 2
            _mirror(mass, k, at, tz)
        else:
            _mirror(mass, k, at, axis[0] * mx + axis[1] * my + axis[2] * mz)
        if body.parent < 0:
            return
        p = own.origin
        cx, cy, cz = crossed(p[0], p[1], p[2], fx, fy, fz)
        mx, my, mz = mx + cx, my + cy, mz + cz
        b = body.parent


@inlined
def _mirror(mass: Floats, i: int, j: int, value: float) -> None:
    """Write an entry of a symmetric matrix."""
    mass[i, j] = value
    mass[j, i] = value
