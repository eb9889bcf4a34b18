"""Changes of the wrench of a joint with play with its state, compiled.

A joint's contacts depend on its own twelve numbers only (six in a plane). Two functions link these to the
wrench, each smooth on a scale of its own: geometry, on that of the play, and laws, on that of a depth, which
may be a millionth of it. Geometry has closed forms, along any displacement
(:mod:`antenna_pin.joints.motion_change_kernels`); laws are differentiated over *their* arguments: force and
friction over gap, depth rate, slip, and contact memory. The rest is the chain rule. No small number is the
difference of large ones: a derivative of a force is good to round-off at any depth.

``room`` is a :class:`~.tangent_room_kernels.JointRoom`; contacts are of closed form with compiled laws, of
point loads.
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.joints.geometry.kernels import FLANGE
from antenna_pin.joints.geometry.tangent_kernels import GAP, NORMAL, POINT
from antenna_pin.joints.layout_kernels import BRISTLES, joint_at, primitive_of
from antenna_pin.joints.motion_change_kernels import RATE, RULES, SLIP, TWIRL, change_contact, change_pose
from antenna_pin.joints.pose_kernels import journal_state, onto_joint
from antenna_pin.joints.row_kernels import add_wrench, arm_rate, no_wrench
from antenna_pin.joints.slope_kernels import (
    A_BRISTLE,
    A_GAP,
    A_MASS,
    A_NORMAL,
    A_RATE,
    A_SLIP,
    A_SPEED,
    V_BRISTLE,
    V_ELASTIC,
    V_FRICTION,
    differentiate_laws,
    is_moved,
    said_by,
    slip_speed,
)
from antenna_pin.joints.tangent_room_kernels import JointRoom, Part


@inlined
def _answer(p: Floats, b: int, k: int, way: Floats, kind: int, room: JointRoom) -> None:
    """Write the changes of a contact's law results to the workspace."""
    j, nv, change, said = joint_at(p, b), room.tau.shape[0], room.change[kind], room.said
    states, count, asked, shifts = j.stride - BRISTLES, said_by(p, b), room.asked, room.shifts
    speeds, contacts = 2 * nv + room.bristles.shape[0], room.numbers.memory.shape[0]
    asked[A_GAP], asked[A_RATE] = change[GAP], change[RATE]
    asked[A_SPEED], asked[A_MASS] = way[speeds + j.row + k], way[speeds + contacts + j.row + k]
    for i in range(3):
        asked[A_SLIP + i], asked[A_NORMAL + i] = 0.0, 0.0
    if states == 0:
        asked[A_SLIP] = _along_slip(room.numbers.own[j.row + k], change)
    else:
        for i in range(3):
            asked[A_SLIP + i], asked[A_NORMAL + i] = change[SLIP + i], change[NORMAL + i]
        for i in range(states):
            asked[A_BRISTLE + i] = way[2 * nv + room.bristle_of[j.x + k * j.stride + BRISTLES + i]]
    for i in range(V_FRICTION + 3 + states):
        said[i] = 0.0
    for n in range(A_BRISTLE + states):
        share = asked[n]
        if share != 0.0:
            for i in range(count):
                said[i] += share * room.laws[k, n, kind, i]
    first = shifts.rules.first[j.row + k]
    for m in range(shifts.steps.shape[0]):
        moved = way[room.first_number[0] + m]
        if moved != 0.0 and room.seen[m] & RULES != 0:
            for n in range(first, shifts.rules.first[j.row + k + 1]):
                share = moved * shifts.rules.slopes[n, m]
                for i in range(count):
                    said[i] += share * shifts.laws[k, n - first, kind, i]
    if states == 0:
        _turn_friction(room.numbers.own[j.row + k], change, room.laws[k, A_SLIP, kind, V_FRICTION], said)


@inlined
def _along_slip(row: Contact, change: Floats) -> float:
    """Return the change of the size of slip; zero at rest."""
    speed, total = slip_speed(row), 0.0
    for i in range(3):
        total += row.slip[i] * change[SLIP + i]
    return total / speed if speed > 0.0 else 0.0


@inlined
def _turn_friction(row: Contact, change: Floats, at_rest: float, slopes: Floats) -> None:
    """Write the change of friction along slip, from the change of its size.

    The change of slip across itself rotates it: by friction over slip, of which ``at_rest`` is the limit.
    """
    speed, along, friction = slip_speed(row), slopes[V_FRICTION], 0.0
    turned, more = at_rest, _along_slip(row, change)
    if speed > 0.0:
        for i in range(3):
            friction += row.friction[i] * row.slip[i]
        turned = friction / (speed * speed)
    for i in range(3):
        way = row.slip[i] / speed if speed > 0.0 else 0.0
        slopes[V_FRICTION + i] = along * way + turned * (change[SLIP + i] - more * way)


@inlined
def _write(p: Floats, b: int, k: int, kind: int, room: JointRoom, out: Floats) -> None:
    """Add the effects of changed forces and geometry to ``room.wrench`` and rates."""
    j, nv, change, said = joint_at(p, b), room.tau.shape[0], room.change[kind], room.said
    row, here, moved, wrench = room.numbers.own[j.row + k], room.poses[0], room.poses[1], room.wrench[kind]
    start = nv + j.x + k * j.stride
    n, r, fr, centre = row.normal, row.point, row.friction, here.centre
    force = row.force
    # Force g = F n + f and lever r of the contact, and their changes.
    dx = said[0] * n[0] + force * change[NORMAL] + said[V_FRICTION]
    dy = said[0] * n[1] + force * change[NORMAL + 1] + said[V_FRICTION + 1]
    dz = said[0] * n[2] + force * change[NORMAL + 2] + said[V_FRICTION + 2]
    gx, gy, gz = force * n[0] + fr[0], force * n[1] + fr[1], force * n[2] + fr[2]
    rx, ry, rz = r[0] - centre[0], r[1] - centre[1], r[2] - centre[2]
    sx = change[POINT] - moved.centre[0]
    sy = change[POINT + 1] - moved.centre[1]
    sz = change[POINT + 2] - moved.centre[2]
    wrench[0] += dx
    wrench[1] += dy
    wrench[2] += dz
    wrench[3] += ry * dz - rz * dy + sy * gz - sz * gy
    wrench[4] += rz * dx - rx * dz + sz * gx - sx * gz
    wrench[5] += rx * dy - ry * dx + sx * gy - sy * gx
    out[start] = said[0]
    lost = (said[0] - said[V_ELASTIC]) * row.rate + (force - row.elastic) * change[RATE]
    if primitive_of(p, b, k) == FLANGE:
        lost += said[V_ELASTIC] * arm_rate(here, row) + row.elastic * change[TWIRL]
    out[start + 1] = lost
    taken = 0.0
    for i in range(3):
        taken -= said[V_FRICTION + i] * row.slip[i] + fr[i] * change[SLIP + i]
    out[start + 2] = taken
    for i in range(j.stride - BRISTLES):
        out[start + BRISTLES + i] = said[V_BRISTLE + i]


@kernel
def _along(p: Floats, b: int, y: Floats, way: Floats, d: int, room: JointRoom, out: Floats) -> None:
    """Add the changes of a joint's generalized force and integral rates along d."""
    j, here, moved = joint_at(p, b), room.poses[0], room.poses[1]
    change_pose(p, b, y, way, room)
    for kind in range(out.shape[0]):
        for i in range(3):
            room.wrench[kind, i], room.wrench[kind, 3 + i] = moved.force[i], moved.moment[i]
    for k in range(j.contacts):
        if room.numbers.memory[j.row + k].touching != 0.0:
            change_contact(p, b, k, way, room)
            for kind in range(out.shape[0]):
                _answer(p, b, k, way, kind, room)
                _write(p, b, k, kind, room, out[kind, d])
    for kind in range(out.shape[0]):
        f = room.wrench[kind]
        onto_joint(j, here, (f[0], f[1], f[2]), (f[3], f[4], f[5]), out[kind, d])
        for i in range(3 if j.planar != 0 else 6):
            out[kind, d, j.v + i] += room.carried[i]


@kernel
def add_joint_changes(p: Floats, part: Part, y: Floats, ways: Floats, room: JointRoom, out: Floats) -> None:
    """Add changes of generalized forces and rates of x along displacements by a joint.

    Args:
        p: Program.
        part: The joint, :data:`antenna_pin.dynamics.tangent_kernels.PART`.
        y: State, for which ``room.numbers.own`` has the contacts.
        ways: Displacements, row by row, (k, displacement).
        room: Arrays; its ``state`` is y.
        out: (kinds, k, nv + nx).
    """
    b = part.block
    j, memory, pose, shifts = joint_at(p, b), room.numbers.memory, room.poses[0], room.shifts
    nq = space_of(room.layout).nq
    touches = False
    journal_state(j, y, nq, pose)
    no_wrench(pose)
    for k in range(j.contacts):
        row = room.numbers.own[j.row + k]
        if memory[j.row + k].touching != 0.0:
            touches = True
            if row.force != 0.0:
                add_wrench(pose, row)
    if not touches:
        return
    for m in range(shifts.steps.shape[0]):
        moved = is_moved(ways, room.first_number[0] + m)
        room.seen[m] = shifts.acts[part.number, m] if moved else 0
    for k in range(j.contacts):
        if memory[j.row + k].touching != 0.0:
            differentiate_laws(p, b, k, y, nq + room.tau.shape[0], room.numbers.own[j.row + k], room)
    for d in range(ways.shape[0]):
        _along(p, b, y, ways[d], d, room, out)
