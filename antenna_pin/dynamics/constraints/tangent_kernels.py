"""Derivatives of equations and forces of closures and couplings, compiled.

Spatial vectors are in world axes about one fixed point (:mod:`antenna_pin.mechanism.tangent_kernels`).

Let V, A be the velocities and accelerations of a closure's frames a and b, and U = V_b - V_a with its rate in
axes of a, ``U' = A_b - A_a - V_a x U``. With p the origin of b, X_p = X_linear + X_angular x p of a motion X,
and v = U_p, the rows of :mod:`antenna_pin.dynamics.constraints.rows_kernels` are, for axes n of a, its third
axis z_a, and e = z_b x z_a::

    along n    n . (U'_p + u x v)             u, u' the angular parts of U and U'
    about n    n . u'
    square     e . u' + ((u x z_b) x z_a) . u

Relative to a a displacement moves b by w, the sum of the displacements of the joints from a to b, and::

    dU = dV_b + w x V_b - dV_a                p moves by w_p, z_b by its rotation
    dU' = dA_b + w x A_b - dA_a - dV_a x U - V_a x dU

where d of each body is in its own axes. The wrench F on b is constant in a except for its arm and the
direction e: ``dF = (0, w_p x f + de m)``; in b's own axes, less w x* F.

A frame that moves on its body by s, with a number of the system, adds to this: relative to a everything moves
back by s_a x, and b's frame moves by w - s_a + s_b.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Matrix3, Record, Records, Six, Triple, Vector3, Vector6, layout
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import (
    ClosureRecord,
    Coupled,
    body_at,
    closure_at,
    coupled_at,
    place_at,
    plan_of,
)
from antenna_pin.mechanism.number_kernels import write_frame_change
from antenna_pin.mechanism.room_kernels import crossed
from antenna_pin.mechanism.spatial_kernels import (
    BodyChange,
    Spatial,
    add_six,
    cross_motion,
    cross_wrench,
    set_six,
)
from antenna_pin.mechanism.tree_kernels import Place


class Tie(Record):
    """A closure in a state about a point, and for one displacement."""

    point: Vector3  # origin of its second frame, from the point [m]
    other: Vector3  # third axis of the second frame
    axes: Matrix3  # of the first frame (columns)
    velocity: Vector6  # U
    acceleration: Vector6  # U'
    wrench: Vector6  # wrench on the second body
    couple: float  # moment along e alone [N m]
    first_shift: Vector6  # displacement of the first frame on its body
    second_shift: Vector6  # displacement of the second frame on its body
    way: Vector6  # displacement of the second frame, relative to the first
    velocity_change: Vector6  # change of U
    acceleration_change: Vector6  # change of U'
    wrench_change: Vector6  # change of the wrench


TIE = layout(Tie)


@inlined
def _six(a: Floats) -> Six:
    return a[0], a[1], a[2], a[3], a[4], a[5]


@inlined
def _less(a: Spatial) -> Six:
    return -a[0], -a[1], -a[2], -a[3], -a[4], -a[5]


@inlined
def _at(motion: Spatial, p: Floats) -> Triple:
    """Return what a motion is at a point: its linear part there."""
    x, y, z = crossed(motion[3], motion[4], motion[5], p[0], p[1], p[2])
    return motion[0] + x, motion[1] + y, motion[2] + z


@inlined
def _inner(a: Triple, b: Triple) -> float:
    return float(a[0] * b[0] + a[1] * b[1] + a[2] * b[2])


@inlined
def _column(axes: Floats, k: int) -> Triple:
    return axes[0, k], axes[1, k], axes[2, k]


@inlined
def _own(closure: ClosureRecord, second: bool, bodies: Records[BodyChange], ground: int) -> BodyChange:
    """Return how the body moves that carries a side; the ground stands behind the bodies."""
    b = closure.second if second else closure.first
    found: BodyChange = bodies[b if b >= 0 else ground]
    return found


@inlined
def _axis(work: Floats, b: int, rotation: Floats, k: int, n: int) -> float:
    """Return world component n of axis k of a frame on a body."""
    if b < 0:
        return float(rotation[n, k])
    on = place_at(work, b).rotation
    return float(on[n, 0] * rotation[0, k] + on[n, 1] * rotation[1, k] + on[n, 2] * rotation[2, k])


@kernel
def read_ties(
    plan: Floats, work: Floats, gravity: Floats, bodies: Records[BodyChange], ties: Records[Tie]
) -> None:
    """Write closures in a solved state; subtract their wrenches from those of joints.

    Args:
        plan: Plan of the constraints.
        work: Work array of the solution.
        gravity: In world axes [m/s^2], (3,): the ground's acceleration is minus it.
        bodies: Their motions, CHANGE, (bodies + 1,); the last is the ground, which is written.
        ties: Written: TIE, (closures,).
    """
    head = plan_of(plan)
    set_six(bodies[head.bodies].acceleration, (-gravity[0], -gravity[1], -gravity[2], 0.0, 0.0, 0.0))
    for c in range(head.closures):
        closure, tie = closure_at(plan, c), ties[c]
        _read(plan, work, closure, bodies, tie)
        first, second = closure.first, closure.second
        # Down to the common body: the wrenches cancel for bodies below.
        while first != second:
            if first > second:
                add_six(bodies[first].wrench, _six(tie.wrench))
                first = body_at(plan, first).parent
            else:
                add_six(bodies[second].wrench, _less(tie.wrench))
                second = body_at(plan, second).parent


@inlined
def _read(plan: Floats, work: Floats, closure: ClosureRecord, bodies: Records[BodyChange], tie: Tie) -> None:
    """Write what a closure is in a state."""
    head, p, row = plan_of(plan), tie.point, closure.row
    for n in range(3):
        for k in range(3):
            tie.axes[n, k] = _axis(work, closure.first, closure.first_rotation, k, n)
        tie.other[n] = _axis(work, closure.second, closure.second_rotation, 2, n)
        p[n] = closure.second_origin[n]
    if closure.second >= 0:
        on, x, y, z = place_at(work, closure.second), p[0], p[1], p[2]
        for n in range(3):
            p[n] = on.rotation[n, 0] * x + on.rotation[n, 1] * y + on.rotation[n, 2] * z + on.origin[n]
    for n in range(3):
        p[n] -= place_at(work, 0).origin[n]
    a, b = _own(closure, False, bodies, head.bodies), _own(closure, True, bodies, head.bodies)
    set_six(tie.velocity, _six(b.velocity))
    add_six(tie.velocity, _less(a.velocity))
    set_six(tie.acceleration, _six(b.acceleration))
    add_six(tie.acceleration, _less(a.acceleration))
    add_six(tie.acceleration, _less(cross_motion(a.velocity, tie.velocity)))
    f = tie.wrench
    set_six(f, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
    for part in range(2):
        for k in range(3):
            if (closure.along[k] if part == 0 else closure.about[k]) != 0:
                force = work[head.force + row] * (1.0 if part == 0 else head.length)
                for n in range(3):
                    f[3 * part + n] += force * tie.axes[n, k]
                row += 1
    tie.couple = 0.0
    if closure.square != 0:
        tie.couple = head.length * work[head.force + row]
        b_, z = tie.other, _column(tie.axes, 2)
        ex, ey, ez = crossed(b_[0], b_[1], b_[2], z[0], z[1], z[2])
        add_six(f, (0.0, 0.0, 0.0, tie.couple * ex, tie.couple * ey, tie.couple * ez))
    x, y, z = crossed(p[0], p[1], p[2], f[0], f[1], f[2])
    add_six(f, (0.0, 0.0, 0.0, x, y, z))


@kernel
def change_ties(plan: Floats, bodies: Records[BodyChange], ties: Records[Tie], lack: Floats) -> None:
    """Add changes of right sides of closures' rows; subtract changes of wrenches from bodies'.

    Args:
        plan: Plan of the constraints.
        bodies: Changes of their motions, and written: of their wrenches, CHANGE, (bodies + 1,).
        ties: Closures in the state, TIE; written to.
        lack: Added to: minus the change of ``J a - lack`` at constant accelerations, (width,).
    """
    head = plan_of(plan)
    for c in range(head.closures):
        closure, tie = closure_at(plan, c), ties[c]
        a, b = _own(closure, False, bodies, head.bodies), _own(closure, True, bodies, head.bodies)
        way, shift = tie.way, tie.first_shift
        set_six(way, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        first, second = closure.first, closure.second
        while first != second:
            if first > second:
                add_six(way, _less(bodies[first].way))
                first = body_at(plan, first).parent
            else:
                add_six(way, _six(bodies[second].way))
                second = body_at(plan, second).parent
        _change_motion(a, b, tie)
        # Change of the wrench in the bodies' own axes, after that in its own axes.
        x, y, z, mx, my, mz = _direction_changes(closure, tie)
        f = tie.wrench_change
        set_six(f, (0.0, 0.0, 0.0, mx, my, mz))
        add_six(a.wrench_change, _six(f))
        add_six(a.wrench_change, cross_wrench(shift, tie.wrench))
        add_six(b.wrench_change, _less(f))
        add_six(b.wrench_change, _less(cross_wrench(shift, tie.wrench)))
        add_six(b.wrench_change, cross_wrench(way, tie.wrench))
        add_six(way, _less(shift))
        add_six(way, _six(tie.second_shift))
        _write_lacks(closure, head.length, tie, (x, y, z), lack)


@inlined
def _change_motion(a: BodyChange, b: BodyChange, tie: Tie) -> None:
    """Write how U and U' change."""
    u, du, shift, way = tie.velocity_change, tie.acceleration_change, tie.first_shift, tie.way
    set_six(u, _six(b.velocity_change))
    add_six(u, cross_motion(way, b.velocity))
    add_six(u, _less(a.velocity_change))
    add_six(u, _less(cross_motion(shift, tie.velocity)))
    set_six(du, _six(b.acceleration_change))
    add_six(du, cross_motion(way, b.acceleration))
    add_six(du, _less(a.acceleration_change))
    add_six(du, _less(cross_motion(shift, b.acceleration)))
    add_six(du, cross_motion(shift, a.acceleration))
    add_six(du, _less(cross_motion(a.velocity_change, tie.velocity)))
    add_six(du, cross_motion(cross_motion(shift, a.velocity), tie.velocity))
    add_six(du, _less(cross_motion(a.velocity, u)))


@inlined
def _direction_changes(closure: ClosureRecord, tie: Tie) -> Six:
    """Return changes of e and of the moment of a closure's wrench about the point."""
    w, s, p, b, f = tie.way, (tie.first_shift, tie.second_shift), tie.point, tie.other, tie.wrench
    moved = (
        w[0] - s[0][0] + s[1][0],
        w[1] - s[0][1] + s[1][1],
        w[2] - s[0][2] + s[1][2],
        w[3] - s[0][3] + s[1][3],
        w[4] - s[0][4] + s[1][4],
        w[5] - s[0][5] + s[1][5],
    )
    px, py, pz = _at(moved, p)
    mx, my, mz = crossed(px, py, pz, f[0], f[1], f[2])
    if closure.square == 0:
        return 0.0, 0.0, 0.0, mx, my, mz
    z = _column(tie.axes, 2)
    bx, by, bz = crossed(moved[3], moved[4], moved[5], b[0], b[1], b[2])
    ex, ey, ez = crossed(bx, by, bz, z[0], z[1], z[2])
    return ex, ey, ez, mx + tie.couple * ex, my + tie.couple * ey, mz + tie.couple * ez


@inlined
def _write_lacks(closure: ClosureRecord, length: float, tie: Tie, turned: Triple, lack: Floats) -> None:
    """Write minus the changes of a closure's rows; ``turned`` is that of e."""
    p, b, w, row = tie.point, tie.other, tie.way, closure.row
    U, dU, A, dA = tie.velocity, tie.velocity_change, tie.acceleration, tie.acceleration_change
    v, dv, px = _at(U, p), _at(dU, p), _at(w, p)
    x, y, z = crossed(U[3], U[4], U[5], px[0], px[1], px[2])
    dv = (dv[0] + x, dv[1] + y, dv[2] + z)
    a = _at(dA, p)
    bx, by, bz = crossed(A[3], A[4], A[5], px[0], px[1], px[2])
    cx, cy, cz = crossed(dU[3], dU[4], dU[5], v[0], v[1], v[2])
    dx, dy, dz = crossed(U[3], U[4], U[5], dv[0], dv[1], dv[2])
    a = (a[0] + bx + cx + dx, a[1] + by + cy + dy, a[2] + bz + cz + dz)
    for k in range(3):
        if closure.along[k] != 0:
            lack[row] -= _inner(_column(tie.axes, k), a)
            row += 1
    for k in range(3):
        if closure.about[k] != 0:
            lack[row] -= length * _inner(_column(tie.axes, k), (dA[3], dA[4], dA[5]))
            row += 1
    if closure.square == 0:
        return
    n = _column(tie.axes, 2)
    e = crossed(b[0], b[1], b[2], n[0], n[1], n[2])
    # Rate of z_b, u x z_b, and its change: du x z_b + u x dz_b.
    rate = crossed(U[3], U[4], U[5], b[0], b[1], b[2])
    db = crossed(w[3], w[4], w[5], b[0], b[1], b[2])
    one, other = crossed(dU[3], dU[4], dU[5], b[0], b[1], b[2]), crossed(U[3], U[4], U[5], *db)
    turning = crossed(rate[0], rate[1], rate[2], n[0], n[1], n[2])
    more = crossed(one[0] + other[0], one[1] + other[1], one[2] + other[2], n[0], n[1], n[2])
    change = _inner(turned, (A[3], A[4], A[5])) + _inner(e, (dA[3], dA[4], dA[5]))
    change += _inner(more, (U[3], U[4], U[5])) + _inner(turning, (dU[3], dU[4], dU[5]))
    lack[row] -= length * change


@kernel
def shift_ties(
    plan: Floats, places: Records[Place], moved: Records[ClosureRecord], ties: Records[Tie]
) -> None:
    """Write displacements of closures' frames on their bodies with a number of the system.

    Args:
        plan: Plan of the constraints.
        places: Places of bodies, PLACE.
        moved: Changes of closures' own numbers, CLOSURE, (closures,).
        ties: Written: TIE.
    """
    for c in range(plan_of(plan).closures):
        own, one, tie = closure_at(plan, c), moved[c], ties[c]
        frame, change = (own.first_rotation, own.first_origin), (one.first_rotation, one.first_origin)
        write_frame_change(frame, change, own.first, places, tie.first_shift)
        frame, change = (own.second_rotation, own.second_origin), (one.second_rotation, one.second_origin)
        write_frame_change(frame, change, own.second, places, tie.second_shift)


@kernel
def let_ties_rest(ties: Records[Tie]) -> None:
    """Let closures' frames rest on their bodies."""
    for c in range(ties.shape[0]):
        set_six(ties[c].first_shift, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
        set_six(ties[c].second_shift, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0))


@kernel
def shift_couplings(
    plan: Floats, moved: Records[Coupled], force: Floats, acceleration: Floats, lack: Floats, out: Floats
) -> None:
    """Add changes, over one number, of biases and forces of couplings' rows.

    The scale of a row has no effect.

    Args:
        plan: Plan of the constraints.
        moved: Changes of couplings' own numbers, COUPLED, (couplings,).
        force: Multipliers, (rows,).
        acceleration: (nv,).
        lack: Added to, as by :func:`change_ties`.
        out: Change of J^T lambda, added to, (nv,).
    """
    for k in range(plan_of(plan).couplings):
        own, one = coupled_at(plan, k), moved[k]
        number = own.scale * (plan_of(plan).length if own.slides == 0 else 1.0)
        lack[own.row] += number * (
            one.multiplier * acceleration[own.v[1]] + one.second * acceleration[own.v[2]]
        )
        out[own.v[1]] -= number * one.multiplier * force[own.row]
        out[own.v[2]] -= number * one.second * force[own.row]
