"""Derivative of a tree's forward dynamics with respect to state and forces, compiled.

By ``M a + b(q, v) = tau`` a displacement (w, dv) of the state, w and dv in the coordinates of velocities, and
one of the forces make

    M da = dtau - D[M a + b] (w, dv),

the derivative of inverse dynamics at the acceleration that is. With spatial vectors in world axes about one
point that rests, no transforms are needed, and of a body, as its own axes see them (Featherstone (2008),
Rigid Body Dynamics Algorithms, chapter 2; the derivatives are those of Carpentier and Mansard (2018),
Analytical Derivatives of Rigid Body Dynamics Algorithms, RSS, along one direction)::

    dV = dV_p - d x V_p + S dv                       d = S w,  V = V_p + S v
    dA = dA_p - d x A_p + dV x S v + V x S dv        A = A_p + S v' + V x S v,  A_0 = -g
    dF = I dA + dV x* I V + V x* I dV + sum (dF_c + d_c x* F_c)
    S^T dF                                           F = I A + V x* I V + sum F_c

The mass matrix is factorized from the leaves on, where it has its zeros (ibid., section 6.5).

Of a number of the tree (:mod:`antenna_pin.mechanism.number_kernels`) the same holds.
"""

from __future__ import annotations

from antenna_pin.base.records import CIRCLE, FIXED_AXIS, PLANE, RIGID, ROTATION, SLIDE, Floats, Ints, Records
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.room_kernels import BodyRoom, crossed, turned, turned_back, turned_symmetric
from antenna_pin.mechanism.spatial_kernels import (
    BodyChange,
    add_six,
    cross_motion,
    cross_wrench,
    set_six,
    times_inertia,
)
from antenna_pin.mechanism.tree_kernels import Body, Place, bias_accelerations, place_bodies

#: How many right-hand sides are solved for side by side.
LANES = 16


@inlined
def _along_joint(body: Body, rotation: Floats, own: BodyChange, x: Floats, out: Floats) -> None:
    """Write the motion of a body by its joint's part of a generalized velocity."""
    k, kind, axis = body.v, body.kind, body.axis
    ux, uy, uz, wx, wy, wz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    if kind == FIXED_AXIS or kind == CIRCLE:
        wx, wy, wz = x[k] * axis[0], x[k] * axis[1], x[k] * axis[2]
    elif kind == SLIDE:
        ux, uy, uz = x[k] * axis[0], x[k] * axis[1], x[k] * axis[2]
    elif kind == RIGID:
        ux, uy, uz, wx, wy, wz = x[k], x[k + 1], x[k + 2], x[k + 3], x[k + 4], x[k + 5]
    elif kind == ROTATION:
        wx, wy, wz = x[k], x[k + 1], x[k + 2]
    else:
        ux, uy, wz = x[k], x[k + 1], x[k + 2]
    ux, uy, uz = turned(rotation, ux, uy, uz)
    wx, wy, wz = turned(rotation, wx, wy, wz)
    p = own.origin
    px, py, pz = crossed(p[0], p[1], p[2], wx, wy, wz)
    set_six(out, (ux + px, uy + py, uz + pz, wx, wy, wz))


@inlined
def _onto_joint(body: Body, rotation: Floats, own: BodyChange, out: Floats) -> None:
    """Subtract a wrench's change, projected on the joint, from ``out``."""
    f, p, k, kind, axis = own.wrench_change, own.origin, body.v, body.kind, body.axis
    x, y, z = crossed(p[0], p[1], p[2], f[0], f[1], f[2])
    mx, my, mz = turned_back(rotation, f[3] - x, f[4] - y, f[5] - z)
    if kind == FIXED_AXIS or kind == CIRCLE:
        out[k] -= axis[0] * mx + axis[1] * my + axis[2] * mz
        return
    fx, fy, fz = turned_back(rotation, f[0], f[1], f[2])
    if kind == SLIDE:
        out[k] -= axis[0] * fx + axis[1] * fy + axis[2] * fz
        return
    if kind != ROTATION:
        out[k] -= fx
        out[k + 1] -= fy
        k += 2
    if kind == RIGID:
        out[k] -= fz
        k += 1
    if kind != PLANE:
        out[k] -= mx
        out[k + 1] -= my
        k += 2
    out[k] -= mz


@kernel
def read_bodies(
    y: Floats,
    nq: int,
    tree: Records[Body],
    places: Records[Place],
    gravity: Floats,
    a: Floats,
    bodies: Records[BodyChange],
) -> None:
    """Write bodies' motions about the first origin at acceleration a, and their wrenches."""
    count = tree.shape[0]
    point = places[0].origin
    for b in range(count):
        body, place, own = tree[b], places[b], bodies[b]
        r, c, i = place.rotation, body.centre, body.inertia
        p = own.origin
        for k in range(3):
            p[k] = place.origin[k] - point[k]
        v = own.velocity
        x, y_, z = crossed(p[0], p[1], p[2], place.spin[0], place.spin[1], place.spin[2])
        v[0], v[1], v[2] = place.velocity[0] + x, place.velocity[1] + y_, place.velocity[2] + z
        v[3], v[4], v[5] = place.spin[0], place.spin[1], place.spin[2]
        m, j, h = body.mass, own.inertia, own.first
        x, y_, z = turned(r, c[0], c[1], c[2])
        x, y_, z = x + p[0], y_ + p[1], z + p[2]
        j[0], j[1], j[2], j[3], j[4], j[5] = i[0, 0], i[0, 1], i[0, 2], i[1, 1], i[1, 2], i[2, 2]
        j[0], j[1], j[2], j[3], j[4], j[5] = turned_symmetric(r, j)
        own.mass = m
        h[0], h[1], h[2] = m * x, m * y_, m * z
        j[0] += h[1] * y_ + h[2] * z
        j[1] -= h[0] * y_
        j[2] -= h[0] * z
        j[3] += h[0] * x + h[2] * z
        j[4] -= h[1] * z
        j[5] += h[0] * x + h[1] * y_
        _along_joint(body, r, own, y[nq:], own.joint_rate)
        _along_joint(body, r, own, a, own.acceleration)
        add_six(own.acceleration, cross_motion(v, own.joint_rate))
        if body.parent < 0:
            for k in range(3):
                own.acceleration[k] -= gravity[k]
        else:
            on = bodies[body.parent].acceleration
            add_six(own.acceleration, (on[0], on[1], on[2], on[3], on[4], on[5]))
        set_six(own.momentum, times_inertia(own, v))
        set_six(own.wrench, times_inertia(own, own.acceleration))
        add_six(own.wrench, cross_wrench(v, own.momentum))
    for b in range(count - 1, -1, -1):
        if tree[b].parent >= 0:
            f = bodies[b].wrench
            add_six(bodies[tree[b].parent].wrench, (f[0], f[1], f[2], f[3], f[4], f[5]))


@inlined
def change_motion(parent: int, bodies: Records[BodyChange], own: BodyChange, gravity: Floats) -> None:
    """Write changes of a body's motion and own wrench by displacement and parent.

    ``own`` has its way, and what its joint adds to the change of velocity.
    """
    u, a, f, rate = own.velocity_change, own.acceleration_change, own.wrench_change, own.joint_rate
    set_six(a, cross_motion(own.velocity, u))
    if parent < 0:
        x, y, z = crossed(own.way[3], own.way[4], own.way[5], gravity[0], gravity[1], gravity[2])
        a[0] += x
        a[1] += y
        a[2] += z
    else:
        on = bodies[parent]
        p, q = on.velocity_change, on.acceleration_change
        add_six(u, (p[0], p[1], p[2], p[3], p[4], p[5]))
        add_six(u, cross_motion(on.velocity, own.way))
        add_six(a, (q[0], q[1], q[2], q[3], q[4], q[5]))
        add_six(a, cross_motion(on.acceleration, own.way))
    add_six(a, cross_motion(u, rate))
    set_six(f, times_inertia(own, u))
    set_six(f, cross_wrench(own.velocity, f))
    add_six(f, times_inertia(own, a))
    add_six(f, cross_wrench(u, own.momentum))


@kernel
def subtract_wrenches(
    tree: Records[Body], places: Records[Place], bodies: Records[BodyChange], out: Floats
) -> None:
    """Subtract the changes of all bodies' wrenches, projected on joints, from ``out``."""
    for b in range(tree.shape[0] - 1, -1, -1):
        body, own = tree[b], bodies[b]
        _onto_joint(body, places[b].rotation, own, out)
        if body.parent >= 0:
            f, on = own.wrench_change, bodies[body.parent].wrench_change
            add_six(on, (f[0], f[1], f[2], f[3], f[4], f[5]))
            add_six(on, cross_wrench(own.way, own.wrench))


@kernel
def write_changes(
    way: Floats,
    nv: int,
    tree: Records[Body],
    places: Records[Place],
    gravity: Floats,
    bodies: Records[BodyChange],
) -> None:
    """Write changes of bodies' motions and own wrenches along a displacement, after :func:`read_bodies`.

    What these do along the joints, :func:`subtract_wrenches` makes of them: how M a + b changes.

    Args:
        way: Displacement, [w (nv), dv (nv), ...].
        nv: Size of the generalized velocity.
        tree: Bodies, parents first, BODY, (bodies,).
        places: Where they are, PLACE.
        gravity: In world axes [m/s^2], (3,).
        bodies: How they move; written to, CHANGE, (bodies,).
    """
    for b in range(tree.shape[0]):
        body, place, own = tree[b], places[b], bodies[b]
        _along_joint(body, place.rotation, own, way, own.way)
        _along_joint(body, place.rotation, own, way[nv:], own.velocity_change)
        change_motion(body.parent, bodies, own, gravity)


@kernel
def factorize_tree(mass: Floats, below: Ints) -> None:
    """Factorize a tree's mass matrix in place: L^T D L, unit L below D.

    ``below``: the freedom next below each one, -1 at the root, (nv,); where a freedom is not below another
    the matrix and L have zeros, which are skipped.
    """
    for k in range(below.shape[0] - 1, -1, -1):
        i = below[k]
        while i >= 0:
            share = mass[k, i] / mass[k, k]
            j = i
            while j >= 0:
                mass[i, j] -= share * mass[k, j]
                j = below[j]
            mass[k, i] = share
            i = below[i]


@kernel
def solve_tree(factors: Floats, below: Ints, x: Floats) -> None:
    """Solve M x = x in place, with the factors of :func:`factorize_tree`."""
    for i in range(below.shape[0] - 1, -1, -1):
        j = below[i]
        while j >= 0:
            x[j] -= factors[i, j] * x[i]
            j = below[j]
    for i in range(below.shape[0]):
        x[i] /= factors[i, i]
        j = below[i]
        while j >= 0:
            x[i] -= factors[i, j] * x[j]
            j = below[j]


@kernel
def solve_trees(factors: Floats, below: Ints, lanes: Floats, x: Floats) -> None:
    """Solve M x = x for each row of x, (k, nv), in interleaved lanes.

    So many as ``lanes``, (nv, LANES), holds go side by side there.
    """
    for first in range(0, x.shape[0], LANES):
        count = min(LANES, x.shape[0] - first)
        for i in range(below.shape[0]):
            for d in range(LANES):
                lanes[i, d] = x[first + d, i] if d < count else 0.0
        _solve_lanes(factors, below, lanes)
        for d in range(count):
            for i in range(below.shape[0]):
                x[first + d, i] = lanes[i, d]


@inlined
def _solve_lanes(factors: Floats, below: Ints, x: Floats) -> None:
    """Solve M x = x for each of the columns."""
    for i in range(below.shape[0] - 1, -1, -1):
        j = below[i]
        while j >= 0:
            share = factors[i, j]
            for d in range(LANES):
                x[j, d] -= share * x[i, d]
            j = below[j]
    for i in range(below.shape[0]):
        share = 1.0 / factors[i, i]
        for d in range(LANES):
            x[i, d] *= share
        j = below[i]
        while j >= 0:
            share = factors[i, j]
            for d in range(LANES):
                x[i, d] -= share * x[j, d]
            j = below[j]


@kernel
def prepare_changes(
    y: Floats,
    nq: int,
    space: tuple[Records[Body], Ints],
    gravity: Floats,
    tau: Floats,
    scratch: tuple[Records[Place], Records[BodyRoom], Floats, Floats],
    bodies: Records[BodyChange],
) -> None:
    """Write motions and accelerations of bodies under forces, and the mass matrix's factors.

    Args:
        y: State, q and v first.
        nq: Where v starts in it.
        space: Bodies, and the freedom next below each (:func:`factorize_tree`).
        gravity: In world axes [m/s^2], (3,).
        tau: Generalized force, (nv,).
        scratch: PLACE and ROOM, (bodies + 1,) each, mass matrix, (nv, nv), and acceleration, (nv,): written.
        bodies: To write to, CHANGE, (bodies,).
    """
    tree, below = space
    places, room, mass, acceleration = scratch
    place_bodies(y, nq, tree, places)
    bias_accelerations(tree, places)
    mass_and_bias(tree, places, gravity, room, mass, acceleration)
    factorize_tree(mass, below)
    for k in range(tau.shape[0]):
        acceleration[k] = tau[k] - acceleration[k]
    solve_tree(mass, below, acceleration)
    read_bodies(y, nq, tree, places, gravity, acceleration, bodies)
