"""How the wrench of a joint with play changes with the joint's state, compiled.

A joint's contacts know its own twelve numbers only (six in a plane). Two things are between these and the
wrench, each smooth on a scale of its own: geometry, on that of the play, and laws, on that of a depth, which
may be a millionth of it. So each is differentiated by itself, over *its* arguments: of geometry gap, normal,
point, depth rate and slip along each way of the joint (rates are linear in the twist); of laws force and
friction over gap, depth rate, slip, and what contacts remember. The rest is the chain rule. Nothing small is
the difference of large numbers: a derivative of a force is good to round-off at any depth.

``room`` is :class:`antenna_pin.engine.tangent_kernels.TangentRoom`; contacts are of closed form with compiled
laws, of point loads.
"""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.geometry.kernels import FLANGE
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.joints.layout_kernels import BRISTLES, joint_at, primitive_of
from antenna_pin.joints.pose_kernels import journal_state, onto_joint
from antenna_pin.joints.row_kernels import add_wrench, no_wrench, row_rates
from antenna_pin.joints.slope_kernels import (
    A_BRISTLE,
    A_MASS,
    A_NORMAL,
    A_RATE,
    A_SLIP,
    A_SPEED,
    CARRIED,
    CENTRE,
    FEW,
    FIRST,
    GAP,
    LOOKED,
    MOVES,
    NORMAL,
    POINT,
    RATE,
    RULES,
    SLIP,
    TWIRL,
    V_BRISTLE,
    V_ELASTIC,
    V_FRICTION,
    differentiate_geometry,
    differentiate_geometry_over,
    differentiate_laws,
    differentiate_laws_over,
    is_moved,
    look,
)


@inlined
def _twist(p: Any, b: int, way: Any, y: Any, room: Any) -> None:
    """Write to ``room.looked`` how the rates of a joint's contacts change along a change of its twist.

    They are linear in it: what they are at the change itself.
    """
    j, pose, state = joint_at(p, b), room.poses[1], room.state[0]
    nq, nv = space_of(room.layout).nq, room.tau.shape[0]
    memory, table, own = room.numbers.memory, room.numbers.table, room.numbers.own
    count = 3 if j.planar != 0 else 6
    for k in range(count):
        state[nq + j.v + k] = way[nv + j.v + k]
    journal_state(j, state, nq, pose)
    for k in range(count):
        state[nq + j.v + k] = y[nq + j.v + k]
    for k in range(j.contacts):
        if memory[j.row + k].touching != 0.0:
            row, here = table[j.row + k], own[j.row + k]
            for i in range(3):
                row.normal[i], row.point[i], row.arm[i] = here.normal[i], here.point[i], here.arm[i]
            row_rates(pose, row)
            look(p, b, k, pose, row, room.looked)


@inlined
def _sum_up(p: Any, b: int, way: Any, d: int, kind: int, room: Any) -> None:
    """Write to ``room.change`` how what is looked at changes along d; of its twist in ``room.looked``."""
    j, change, geometry = joint_at(p, b), room.change, room.geometry
    count, freedoms = FIRST + j.contacts * LOOKED, 3 if j.planar != 0 else 6
    if room.asks[FEW] != 0:
        for i in range(count):
            change[i] = geometry[d, kind, i]
    else:
        for i in range(count):
            change[i] = 0.0
        for n in range(freedoms):
            share = way[j.v + n]
            if share != 0.0:
                for i in range(count):
                    change[i] += share * geometry[n, kind, i]
    for k in range(j.contacts):
        at = FIRST + k * LOOKED
        for i in range(at + RATE, at + LOOKED):
            change[i] += room.looked[i]
    shifts = room.shifts
    for m in range(shifts.steps.shape[0]):
        share = way[room.first_number[0] + m]
        if share != 0.0 and room.seen[m] & MOVES != 0:
            for i in range(count):
                change[i] += share * shifts.geometry[m, kind, i]


@inlined
def _answer(p: Any, b: int, k: int, way: Any, kind: int, room: Any) -> None:
    """Write to ``room.said`` how what a contact's laws say changes along a displacement."""
    j, nv, change, said = joint_at(p, b), room.tau.shape[0], room.change, room.said
    at, states = FIRST + k * LOOKED, j.stride - BRISTLES
    asked = room.asked
    asked[GAP], asked[A_RATE] = change[at + GAP], change[at + RATE]
    for i in range(3):
        asked[A_SLIP + i], asked[A_NORMAL + i] = change[at + SLIP + i], change[at + NORMAL + i]
    speeds, contacts = 2 * nv + room.bristles.shape[0], room.numbers.memory.shape[0]
    asked[A_SPEED], asked[A_MASS] = way[speeds + j.row + k], way[speeds + contacts + j.row + k]
    for i in range(states):
        asked[A_BRISTLE + i] = way[2 * nv + room.bristle_of[j.x + k * j.stride + BRISTLES + i]]
    for i in range(V_BRISTLE + states):
        said[i] = 0.0
    for n in range(A_BRISTLE + states):
        share = asked[n]
        if share != 0.0:
            for i in range(V_BRISTLE + states):
                said[i] += share * room.laws[k, n, kind, i]
    shifts = room.shifts
    for m in range(shifts.steps.shape[0]):
        share = way[room.first_number[0] + m]
        if share != 0.0 and room.seen[m] & RULES != 0:
            for i in range(V_BRISTLE + states):
                said[i] += share * shifts.laws[k, m, kind, i]


@inlined
def _write(p: Any, b: int, k: int, room: Any, out: Any) -> None:
    """Add what changes of a contact's forces and geometry do: to the wrench of pose 1, and to rates of x."""
    j, nv, change, said = joint_at(p, b), room.tau.shape[0], room.change, room.said
    row, here, pose = room.numbers.own[j.row + k], room.poses[0], room.poses[1]
    at, start = FIRST + k * LOOKED, nv + j.x + k * j.stride
    n, r, fr, centre = row.normal, row.point, row.friction, here.centre
    force = row.force
    # Force g = F n + f and lever r of the contact, and how they change.
    dx = said[0] * n[0] + force * change[at + NORMAL] + said[V_FRICTION]
    dy = said[0] * n[1] + force * change[at + NORMAL + 1] + said[V_FRICTION + 1]
    dz = said[0] * n[2] + force * change[at + NORMAL + 2] + said[V_FRICTION + 2]
    gx, gy, gz = force * n[0] + fr[0], force * n[1] + fr[1], force * n[2] + fr[2]
    rx, ry, rz = r[0] - centre[0], r[1] - centre[1], r[2] - centre[2]
    sx = change[at + POINT] - change[CENTRE]
    sy = change[at + POINT + 1] - change[CENTRE + 1]
    sz = change[at + POINT + 2] - change[CENTRE + 2]
    pose.force[0] += dx
    pose.force[1] += dy
    pose.force[2] += dz
    pose.moment[0] += ry * dz - rz * dy + sy * gz - sz * gy
    pose.moment[1] += rz * dx - rx * dz + sz * gx - sx * gz
    pose.moment[2] += rx * dy - ry * dx + sx * gy - sy * gx
    out[start] = said[0]
    lost = (said[0] - said[V_ELASTIC]) * row.rate + (force - row.elastic) * change[at + RATE]
    if primitive_of(p, b, k) == FLANGE:
        lost += said[V_ELASTIC] * room.twirls[k] + row.elastic * change[at + TWIRL]
    out[start + 1] = lost
    taken = 0.0
    for i in range(3):
        taken -= said[V_FRICTION + i] * row.slip[i] + fr[i] * change[at + SLIP + i]
    out[start + 2] = taken
    for i in range(j.stride - BRISTLES):
        out[start + BRISTLES + i] = said[V_BRISTLE + i]


@kernel
def _along(p: Any, b: int, y: Any, way: Any, d: int, room: Any, out: Any) -> None:
    """Add how a joint's generalized force, and the rates of what its contacts integrate, change along d."""
    j = joint_at(p, b)
    count = 3 if j.planar != 0 else 6
    _twist(p, b, way, y, room)
    for kind in range(out.shape[0]):
        _sum_up(p, b, way, d, kind, room)
        pose, change = room.poses[1], room.change
        no_wrench(pose)
        for k in range(j.contacts):
            if room.numbers.memory[j.row + k].touching != 0.0:
                _answer(p, b, k, way, kind, room)
                _write(p, b, k, room, out[kind, d])
        f, m, here = pose.force, pose.moment, room.poses[0]
        onto_joint(j, here, (f[0], f[1], f[2]), (m[0], m[1], m[2]), out[kind, d])
        for i in range(count):
            out[kind, d, j.v + i] += change[CARRIED + i]


@kernel
def add_joint_changes(p: Any, part: Any, y: Any, ways: Any, room: Any, out: Any) -> None:
    """Add how a joint with play changes generalized forces and rates of x along displacements.

    Args:
        p: Program.
        part: The joint, :data:`antenna_pin.dynamics.tangent_kernels.PART`.
        y: State, for which ``room.numbers.own`` has the contacts.
        ways: Displacements, row by row, (k, displacement).
        room: What to compute with; its ``state`` is y.
        out: (kinds, k, nv + nx).
    """
    b, f = part.block, part.factor[0]
    j, memory, pose = joint_at(p, b), room.numbers.memory, room.poses[0]
    nq = space_of(room.layout).nq
    touches = False
    journal_state(j, y, nq, pose)
    no_wrench(pose)
    for k in range(j.contacts):
        row = room.numbers.own[j.row + k]
        if memory[j.row + k].touching != 0.0:
            touches = True
            look(p, b, k, pose, row, room.looked)
            room.twirls[k] = room.looked[FIRST + k * LOOKED + TWIRL]
            if row.force != 0.0:
                add_wrench(pose, row)
    if not touches:
        return
    count = 3 if j.planar != 0 else 6
    room.asks[FEW] = 1 if ways.shape[0] < count else 0
    if room.asks[FEW] != 0:
        for d in range(ways.shape[0]):
            own = ways[d, j.v : j.v + count]
            differentiate_geometry(p, b, f, y, own, room, room.geometry[d])
    else:
        for n in range(count):
            if not is_moved(ways, j.v + n):
                continue
            for i in range(count):
                room.freedoms[i] = 1.0 if i == n else 0.0
            differentiate_geometry(p, b, f, y, room.freedoms, room, room.geometry[n])
    shifts = room.shifts
    for m in range(shifts.steps.shape[0]):
        moved = is_moved(ways, room.first_number[0] + m)
        room.seen[m] = shifts.acts[part.number, m] if moved else 0
        if room.seen[m] & MOVES != 0:
            differentiate_geometry_over(p, b, m, room, shifts.geometry[m])
    for k in range(j.contacts):
        if memory[j.row + k].touching != 0.0:
            differentiate_laws(p, b, k, y, nq + room.tau.shape[0], room.numbers.own[j.row + k], room)
            for m in range(shifts.steps.shape[0]):
                if room.seen[m] & RULES != 0:
                    differentiate_laws_over(p, b, k, m, room, shifts.laws[k, m])
    for d in range(ways.shape[0]):
        _along(p, b, y, ways[d], d, room, out)
