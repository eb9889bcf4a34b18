"""Derivatives of a tree's inverse dynamics with respect to numbers of the tree, compiled.

Masses, centres and moments of inertia act by the wrench of their own body, which is linear in mass, first
moment and moment of inertia: ``I' A + V x* I' V``. A joint's place in its parent is a way d of all behind it,
as one along the joint is (:mod:`antenna_pin.mechanism.tangent_kernels`), and gravity the rise of the ground.
Axes of joints are not among them.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Records
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.mechanism.room_kernels import crossed, turned, turned_symmetric
from antenna_pin.mechanism.spatial_kernels import BodyChange, add_six, cross_wrench, set_six, times_inertia
from antenna_pin.mechanism.tangent_kernels import change_motion
from antenna_pin.mechanism.tree_kernels import Body, Place


@inlined
def write_frame_change(
    frame: tuple[Floats, Floats],
    change: tuple[Floats, Floats],
    parent: int,
    places: Records[Place],
    out: Floats,
) -> None:
    """Write the displacement by a change of a frame's place on its parent."""
    (r, p), (m, d) = frame, change
    x, y, z = 0.0, 0.0, 0.0
    # The turn is that of R' R^T.
    for k in range(3):
        x += 0.5 * (m[2, k] * r[1, k] - m[1, k] * r[2, k])
        y += 0.5 * (m[0, k] * r[2, k] - m[2, k] * r[0, k])
        z += 0.5 * (m[1, k] * r[0, k] - m[0, k] * r[1, k])
    ux, uy, uz = d[0], d[1], d[2]
    px, py, pz = p[0], p[1], p[2]
    if parent >= 0:
        on = places[parent]
        x, y, z = turned(on.rotation, x, y, z)
        ux, uy, uz = turned(on.rotation, ux, uy, uz)
        px, py, pz = turned(on.rotation, px, py, pz)
        px, py, pz = px + on.origin[0], py + on.origin[1], pz + on.origin[2]
    point = places[0].origin
    vx, vy, vz = crossed(px - point[0], py - point[1], pz - point[2], x, y, z)
    set_six(out, (ux + vx, uy + vy, uz + vz, x, y, z))


@inlined
def _inertia_change(body: Body, change: Body, rotation: Floats, own: BodyChange, out: BodyChange) -> None:
    """Write changes of mass, first moment and moment of inertia about the point."""
    c, s, i, j, h = body.centre, change.centre, change.inertia, out.inertia, out.first
    m, dm = body.mass, change.mass
    x, y, z = turned(rotation, c[0], c[1], c[2])
    x, y, z = x + own.origin[0], y + own.origin[1], z + own.origin[2]
    dx, dy, dz = turned(rotation, s[0], s[1], s[2])
    out.mass = dm
    h[0], h[1], h[2] = dm * x + m * dx, dm * y + m * dy, dm * z + m * dz
    j[0], j[1], j[2], j[3], j[4], j[5] = i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]
    j[0], j[1], j[2], j[3], j[4], j[5] = turned_symmetric(rotation, j)
    # Of m (|c|^2 1 - c c^T), as those of a point.
    xx, yy, zz = (dm * x + 2.0 * m * dx) * x, (dm * y + 2.0 * m * dy) * y, (dm * z + 2.0 * m * dz) * z
    j[0] += yy + zz
    j[3] += xx + zz
    j[5] += xx + yy
    j[1] -= dm * x * y + m * (x * dy + y * dx)
    j[2] -= dm * x * z + m * (x * dz + z * dx)
    j[4] -= dm * y * z + m * (y * dz + z * dy)


@kernel
def write_number_changes(
    change: Records[Body],
    space: tuple[Records[Body], Records[Place]],
    pulls: tuple[Floats, Floats],
    scratch: tuple[Floats, Records[BodyChange]],
    bodies: Records[BodyChange],
    out: Floats,
) -> None:
    """Write how bodies' motions and own wrenches change with a number of the tree.

    As :func:`antenna_pin.mechanism.tangent_kernels.write_changes` does along a displacement.

    Args:
        change: By how much each body's own numbers change, BODY, (bodies,).
        space: Bodies, BODY, (bodies,), and where they are, PLACE.
        pulls: Gravity in world axes [m/s^2], and its change, (3,) each.
        scratch: The acceleration that is, (nv,), and room for one body, CHANGE, (1,).
        bodies: How they move (:func:`antenna_pin.mechanism.tangent_kernels.read_bodies`); written to.
        out: What of the forces is no wrench is subtracted from it, (nv,).
    """
    tree, places = space
    gravity, pull = pulls
    acceleration, room = scratch
    more = room[0]
    for b in range(tree.shape[0]):
        body, one, own = tree[b], change[b], bodies[b]
        frame, moved = (body.rotation, body.position), (one.rotation, one.position)
        write_frame_change(frame, moved, body.parent, places, own.way)
        set_six(own.velocity_change, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        change_motion(body.parent, bodies, own, gravity)
        _inertia_change(body, one, places[b].rotation, own, more)
        f = own.wrench_change
        if body.parent < 0:
            for k in range(3):
                own.acceleration_change[k] -= pull[k]
            set_six(more.way, (-pull[0], -pull[1], -pull[2], 0.0, 0.0, 0.0))
            add_six(f, times_inertia(own, more.way))
        set_six(more.momentum, times_inertia(more, own.velocity))
        add_six(f, times_inertia(more, own.acceleration))
        add_six(f, cross_wrench(own.velocity, more.momentum))
        out[body.v] -= one.armature * acceleration[body.v]
