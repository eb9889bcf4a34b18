"""Changes of a joint with play along a displacement, compiled, in closed form.

A displacement moves the journal in its bearing, changes its twist, and may change dimensions. Kinematics
gives the changes of its pose; these and those of dimensions give the changes of gap, normal and point
(:mod:`antenna_pin.joints.geometry.tangent_kernels`); all together those of depth rate and slip. Ends of
sliders in guides are the exception, whose gap is one of several: these are differentiated along the change of
the pose.

``room`` is a :class:`~.tangent_room_kernels.JointRoom`. Its first pose is the journal, the second its change,
the third the pose displaced for differences.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Floats, Pose, Records, Six, Triple
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.integrate.difference_kernels import (
    clear,
    differentiated,
    displace_words,
    note_words,
    put_back_words,
)
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.joints.geometry.kernels import CANDIDATE, FLANGE, candidate_contact
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE, Revolute
from antenna_pin.joints.geometry.tangent_kernels import (
    CHANGED,
    GAP,
    NORMAL,
    POINT,
    contact_changes,
    has_closed_changes,
)
from antenna_pin.joints.layout_kernels import JointRecord, candidate_at, joint_at, primitive_of, revolute_of
from antenna_pin.joints.pose_kernels import journal_state, onto_joint
from antenna_pin.joints.row_kernels import lever, lever_slope
from antenna_pin.joints.tangent_room_kernels import JointRoom

#: After the changes of gap, normal and point: those of depth rate, slip, and of the effect of a flange's arm.
RATE, SLIP, TWIRL, LOOKED = CHANGED, CHANGED + 1, CHANGED + 4, CHANGED + 5
#: Dependence of a joint's block on a number of the system, added up: dimensions of contacts, laws, places of
#: the joint's frames.
MOVES, RULES, PLACES = 1, 2, 4
# First step of differences, over units.
_WAY = 1e-3


@inlined
def _twist(j: JointRecord, pose: Pose, x: Floats, k: int) -> Six:
    """Return the journal's velocity and spin for x[k:] as joint velocity, transpose of ``onto_joint``."""
    r, o = pose.rotation, pose.centre
    if j.planar != 0:
        w = x[k + 2]
        if j.on_child != 0:
            return w * o[1] - x[k], -w * o[0] - x[k + 1], 0.0, 0.0, 0.0, -w
        return r[0, 0] * x[k] + r[0, 1] * x[k + 1], r[1, 0] * x[k] + r[1, 1] * x[k + 1], 0.0, 0.0, 0.0, w
    a, c = j.axes, j.centre
    wx, wy, wz = x[k + 3], x[k + 4], x[k + 5]
    vx = x[k] + wy * c[2] - wz * c[1]
    vy = x[k + 1] + wz * c[0] - wx * c[2]
    vz = x[k + 2] + wx * c[1] - wy * c[0]
    if j.on_child == 0:
        return (
            r[0, 0] * vx + r[0, 1] * vy + r[0, 2] * vz,
            r[1, 0] * vx + r[1, 1] * vy + r[1, 2] * vz,
            r[2, 0] * vx + r[2, 1] * vy + r[2, 2] * vz,
            r[0, 0] * wx + r[0, 1] * wy + r[0, 2] * wz,
            r[1, 0] * wx + r[1, 1] * wy + r[1, 2] * wz,
            r[2, 0] * wx + r[2, 1] * wy + r[2, 2] * wz,
        )
    # The journal is on the parent: it moves relative to the child's point at its centre.
    tx = a[0, 0] * wx + a[1, 0] * wy + a[2, 0] * wz
    ty = a[0, 1] * wx + a[1, 1] * wy + a[2, 1] * wz
    tz = a[0, 2] * wx + a[1, 2] * wy + a[2, 2] * wz
    return (
        tz * o[1] - ty * o[2] - (a[0, 0] * vx + a[1, 0] * vy + a[2, 0] * vz),
        tx * o[2] - tz * o[0] - (a[0, 1] * vx + a[1, 1] * vy + a[2, 1] * vz),
        ty * o[0] - tx * o[1] - (a[0, 2] * vx + a[1, 2] * vy + a[2, 2] * vz),
        -tx,
        -ty,
        -tz,
    )


@kernel
def change_pose(p: Floats, b: int, y: Floats, way: Floats, room: JointRoom) -> None:
    """Write the change of a journal's pose and twist along a displacement to ``room.poses[1]``.

    Its force and moment receive the change of a wrench in bearing axes equivalent to the effect of the
    constant wrench along the displaced freedoms; ``room.carried`` receives the part due to the joint's
    frames.
    """
    j, pose, out, nv = joint_at(p, b), room.poses[0], room.poses[1], room.tau.shape[0]
    v, w, f, m = pose.velocity, pose.spin, pose.force, pose.moment
    dx, dy, dz, ax, ay, az = _twist(j, pose, way, j.v)
    vx, vy, vz, wx, wy, wz = _twist(j, pose, way, nv + j.v)
    out.centre[0], out.centre[1], out.centre[2] = dx, dy, dz
    for k in range(3):
        x, y_, z = pose.rotation[0, k], pose.rotation[1, k], pose.rotation[2, k]
        out.rotation[0, k] = ay * z - az * y_
        out.rotation[1, k] = az * x - ax * z
        out.rotation[2, k] = ax * y_ - ay * x
    x, y_, z = pose.axis[0], pose.axis[1], pose.axis[2]
    out.axis[0], out.axis[1], out.axis[2] = ay * z - az * y_, az * x - ax * z, ax * y_ - ay * x
    if j.on_child == 0:
        # Twist and wrench rotate with the journal, in whose part's axes they are constant.
        out.velocity[0] = vx + ay * v[2] - az * v[1]
        out.velocity[1] = vy + az * v[0] - ax * v[2]
        out.velocity[2] = vz + ax * v[1] - ay * v[0]
        out.spin[0] = wx + ay * w[2] - az * w[1]
        out.spin[1] = wy + az * w[0] - ax * w[2]
        out.spin[2] = wz + ax * w[1] - ay * w[0]
        out.force[0], out.force[1], out.force[2] = (
            az * f[1] - ay * f[2],
            ax * f[2] - az * f[0],
            ay * f[0] - ax * f[1],
        )
        out.moment[0] = az * m[1] - ay * m[2]
        out.moment[1] = ax * m[2] - az * m[0]
        out.moment[2] = ay * m[0] - ax * m[1]
    else:
        # The bearing's part is at rest in its axes; the wrench acts on it at the journal's centre.
        out.velocity[0] = vx + w[1] * dz - w[2] * dy
        out.velocity[1] = vy + w[2] * dx - w[0] * dz
        out.velocity[2] = vz + w[0] * dy - w[1] * dx
        out.spin[0], out.spin[1], out.spin[2] = wx, wy, wz
        out.force[0], out.force[1], out.force[2] = 0.0, 0.0, 0.0
        out.moment[0] = dy * f[2] - dz * f[1]
        out.moment[1] = dz * f[0] - dx * f[2]
        out.moment[2] = dx * f[1] - dy * f[0]
    for k in range(6):
        room.carried[k] = 0.0
    shifts = room.shifts
    for number in range(shifts.steps.shape[0]):
        share = way[room.first_number[0] + number]
        if share != 0.0 and room.seen[number] & PLACES != 0:
            _change_places(p, b, y, number, share, room)
    across = pose.axis[0] * out.axis[0] + pose.axis[1] * out.axis[1]
    out.sine = across / pose.sine if pose.sine > 0.0 else 0.0


@inlined
def _change_places(p: Floats, b: int, y: Floats, number: int, share: float, room: JointRoom) -> None:
    """Add to the changes of a pose those with a number of the joint's frames.

    Of these a pose, and what a wrench does, are polynomials of less than the differences' order.
    """
    j, out, moved, tau = joint_at(p, b), room.poses[1], room.poses[2], room.tau
    words, step, nq = room.shifts.program, room.shifts.steps[number], space_of(room.layout).nq
    f, m, count = room.poses[0].force, room.poses[0].moment, 3 if j.planar != 0 else 6
    note_words(p, words, number)
    for point in range(room.weights.shape[1]):
        for side in (1.0, -1.0):
            weight = share * side * room.weights[0, point] / step
            displace_words(p, words, number, side * (point + 1.0) * step)
            journal_state(j, y, nq, moved)
            for k in range(count):
                tau[j.v + k] = 0.0
            onto_joint(j, moved, (f[0], f[1], f[2]), (m[0], m[1], m[2]), tau)
            for k in range(count):
                room.carried[k] += weight * tau[j.v + k]
            for i in range(3):
                out.centre[i] += weight * moved.centre[i]
                out.axis[i] += weight * moved.axis[i]
                out.velocity[i] += weight * moved.velocity[i]
                out.spin[i] += weight * moved.spin[i]
                for k in range(3):
                    out.rotation[i, k] += weight * moved.rotation[i, k]
    put_back_words(p, words, number)


@kernel
def _change_shape(p: Floats, b: int, k: int, way: Floats, room: JointRoom) -> None:
    """Write by how much the dimensions of a contact change to ``room.shapes[0]``."""
    first, out, shifts = candidate_at(b, k), room.shapes[0], room.shifts
    words = shifts.program
    for i in range(CANDIDATE):
        out[i] = 0.0
    for m in range(shifts.steps.shape[0]):
        share = way[room.first_number[0] + m]
        if share != 0.0 and room.seen[m] & MOVES != 0:
            for i in range(words.first[m], words.first[m + 1]):
                at = words.at[i] - first
                if at >= 0 and at < CANDIDATE:
                    out[at] += share * words.slopes[i]


@inlined
def _size(p: Floats, b: int, way: Floats, room: JointRoom) -> float:
    """Return how large a displacement is for a joint's geometry, in units."""
    j, size = joint_at(p, b), 0.0
    for k in range(3 if j.planar != 0 else 6):
        size = max(size, abs(way[j.v + k]) / room.units[j.v + k])
    for m in range(room.shifts.steps.shape[0]):
        if room.seen[m] & (MOVES | PLACES) != 0:
            size = max(size, abs(way[room.first_number[0] + m]) * _WAY / room.shifts.steps[m])
    return float(size)


@inlined
def _look_displaced(h: float, at: Floats, row: Contact, room: JointRoom) -> None:
    """Write gap, normal and point with pose and dimensions displaced by h times their changes."""
    pose, way, moved = room.poses[0], room.poses[1], room.poses[2]
    for i in range(3):
        moved.centre[i] = pose.centre[i] + h * way.centre[i]
        moved.axis[i] = pose.axis[i] + h * way.axis[i]
        for k in range(3):
            moved.rotation[i, k] = pose.rotation[i, k] + h * way.rotation[i, k]
    moved.sine = math.sqrt(moved.axis[0] * moved.axis[0] + moved.axis[1] * moved.axis[1])
    shape, change = room.shapes[1], room.shapes[0]
    shape[0] = at[0]  # the primitive
    for i in range(1, CANDIDATE):
        shape[i] = at[i] + h * change[i]
    candidate_contact(shape, 0, moved, row)
    room.looked[GAP] = row.gap
    for i in range(3):
        room.looked[NORMAL + i], room.looked[POINT + i] = row.normal[i], row.point[i]


_differences = differentiated(_look_displaced)


@kernel
def _differentiate_contact(p: Floats, b: int, k: int, way: Floats, room: JointRoom) -> None:
    """Write the differences of gap, normal and point with pose and dimensions."""
    first, size = candidate_at(b, k), _size(p, b, way, room)
    row = room.numbers.table[joint_at(p, b).row + k]
    if size == 0.0:
        clear(room.change, CHANGED)
        return
    arrays = room.looked, room.weights, room.trial
    words = p[first : first + CANDIDATE]
    _differences(_WAY / size, (GAP, NORMAL, POINT, CHANGED), arrays, room.change, words, row, room)


@inlined
def _change_arm(shape: Revolute, change: Revolute, poses: Records[Pose], row: Contact, out: Floats) -> Triple:
    """Shift the change of a flange's deepest point to the point of its force.

    Returns the change of the arm.

    See :func:`antenna_pin.joints.row_kernels.place_flange_force`.
    """
    pose, way = poses[0], poses[1]
    covers, side, depth = shape.flange_radius >= shape.outer_radius, shape.side, -row.gap
    narrow = shape.outer_radius if covers else shape.flange_radius
    whole = 2.0 * narrow * pose.sine
    if depth <= 0.0 or whole >= depth:
        return 0.0, 0.0, 0.0
    grown = change.outer_radius if covers else change.flange_radius
    s = whole / depth
    steeper = lever_slope(s) * (2.0 * (grown * pose.sine + narrow * way.sine) + s * out[GAP]) / depth
    rest = 1.0 - lever(depth, whole)
    x, y, z = row.point[0] + row.arm[0], row.point[1] + row.arm[1], row.point[2] + row.arm[2]
    # From the middle of the annulus to the deepest point, and the change of the middle.
    mx, my, mz = 0.0, 0.0, side * change.half_length
    if covers:
        z -= side * shape.half_length
    else:
        far, o, n = side * shape.half_distance, pose.centre, pose.axis
        x, y, z = x - o[0] - far * n[0], y - o[1] - far * n[1], z - o[2] - far * n[2]
        more = side * change.half_distance
        mx = way.centre[0] + more * n[0] + far * way.axis[0]
        my = way.centre[1] + more * n[1] + far * way.axis[1]
        mz = way.centre[2] + more * n[2] + far * way.axis[2]
    ax = rest * (out[POINT] - mx) - steeper * x
    ay = rest * (out[POINT + 1] - my) - steeper * y
    az = rest * (out[POINT + 2] - mz) - steeper * z
    out[POINT] -= ax
    out[POINT + 1] -= ay
    out[POINT + 2] -= az
    return ax, ay, az


@inlined
def _change_rates(poses: Records[Pose], row: Contact, arm: Triple, out: Floats) -> None:
    """Write the changes of depth rate and slip, with those of a flange's ``arm``."""
    pose, way, n, r = poses[0], poses[1], row.normal, row.point
    w, dw, a = pose.spin, way.spin, row.arm
    x, y, z = r[0] - pose.centre[0], r[1] - pose.centre[1], r[2] - pose.centre[2]
    dx = out[POINT] - way.centre[0]
    dy = out[POINT + 1] - way.centre[1]
    dz = out[POINT + 2] - way.centre[2]
    vx = way.velocity[0] + dw[1] * z - dw[2] * y + w[1] * dz - w[2] * dy
    vy = way.velocity[1] + dw[2] * x - dw[0] * z + w[2] * dx - w[0] * dz
    vz = way.velocity[2] + dw[0] * y - dw[1] * x + w[0] * dy - w[1] * dx
    m = (out[NORMAL], out[NORMAL + 1], out[NORMAL + 2])
    # The velocity of the journal's point over the bearing's is slip - rate n.
    opening = vx * n[0] + vy * n[1] + vz * n[2]
    for i in range(3):
        opening += (row.slip[i] - row.rate * n[i]) * m[i]
    out[RATE] = -opening
    out[SLIP] = vx - opening * n[0] + row.rate * m[0]
    out[SLIP + 1] = vy - opening * n[1] + row.rate * m[1]
    out[SLIP + 2] = vz - opening * n[2] + row.rate * m[2]
    ax, ay, az = arm
    tx = dw[1] * a[2] - dw[2] * a[1] + w[1] * az - w[2] * ay
    ty = dw[2] * a[0] - dw[0] * a[2] + w[2] * ax - w[0] * az
    tz = dw[0] * a[1] - dw[1] * a[0] + w[0] * ay - w[1] * ax
    twirl = tx * n[0] + ty * n[1] + tz * n[2]
    twirl += (w[1] * a[2] - w[2] * a[1]) * m[0] + (w[2] * a[0] - w[0] * a[2]) * m[1]
    out[TWIRL] = twirl + (w[0] * a[1] - w[1] * a[0]) * m[2]


@kernel
def change_contact(p: Floats, b: int, k: int, way: Floats, room: JointRoom) -> None:
    """Write the changes of a contact along a displacement to ``room.change``.

    That is for each kind of differences, (kinds, LOOKED); :func:`change_pose` has been.
    """
    first, out, row = candidate_at(b, k), room.change, room.numbers.own[joint_at(p, b).row + k]
    _change_shape(p, b, k, way, room)
    closed = has_closed_changes(primitive_of(p, b, k))
    if closed:
        words = p[first : first + CANDIDATE]
        contact_changes(words, room.shapes[0], room.poses[0], room.poses[1], row, out[0])
    else:
        _differentiate_contact(p, b, k, way, room)
    flange, arm = primitive_of(p, b, k) == FLANGE, (0.0, 0.0, 0.0)
    change = record(room.shapes[0], REVOLUTE)
    for kind in range(out.shape[0]):
        if kind > 0 and closed:
            for i in range(LOOKED):
                out[kind, i] = out[0, i]
            continue
        if flange:
            arm = _change_arm(revolute_of(p, b, k), change, room.poses, row, out[kind])
        else:
            arm = (0.0, 0.0, 0.0)
        _change_rates(room.poses, row, arm, out[kind])
