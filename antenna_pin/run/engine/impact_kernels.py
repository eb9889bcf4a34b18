"""Derivatives of gap, depth rate and effective mass at an onset, compiled.

With n the generalized force of one newton along the normal, the effective mass m is that of the acceleration
u by that force, at rest, without weight and motions, with constraints held by multipliers lambda::

    1/m = n^T u,    M u = n + J^T lambda,    J u = 0
    d(1/m) = u^T (2 dn - dM u + dJ^T lambda) + lambda^T dJ u

since ``n^T du = u^T M du + lambda^T dJ u``. No equations are solved for a tangent: ``dM u - dJ^T lambda`` is
the change of the forces of an acceleration (:mod:`antenna_pin.mechanism.tangent_kernels`), and ``-dJ u`` that
of the right sides of constraints.

``room`` is :class:`antenna_pin.dynamics.tangent_room_kernels.TangentRoom`; joints are of the kinds that it
supports.
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats, Pose
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.driven_kernels import change_motions
from antenna_pin.dynamics.constraints.factor_kernels import factorize
from antenna_pin.dynamics.constraints.layout_kernels import plan_of
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.constraints.solve_kernels import solve_changes
from antenna_pin.dynamics.constraints.tangent_kernels import (
    change_ties,
    let_ties_rest,
    read_ties,
    shift_couplings,
    shift_ties,
)
from antenna_pin.dynamics.tangent_room_kernels import TangentRoom
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.joints.geometry.tangent_kernels import GAP, NORMAL, POINT
from antenna_pin.joints.kernels import contact_motion
from antenna_pin.joints.layout_kernels import JointRecord, joint_at
from antenna_pin.joints.motion_change_kernels import RATE, change_contact, change_pose
from antenna_pin.joints.pose_kernels import journal_state, onto_joint
from antenna_pin.joints.slope_kernels import is_moved
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.number_kernels import write_number_changes
from antenna_pin.mechanism.tangent_kernels import (
    prepare_changes,
    read_bodies,
    subtract_wrenches,
    write_changes,
)
from antenna_pin.run.engine.row_tangent_kernels import has_rows

#: Results for each tangent: change of gap [m], of depth rate [m/s], of the logarithm of the mass.
OPENING, CLOSING, HEAVIER, MET = 0, 1, 2, 3


@inlined
def _press(j: JointRecord, row: Contact, pose: Pose, force: Floats) -> None:
    """Write a contact's unit normal force to the pose, and its generalized force."""
    n, r, f, m = row.normal, row.point, pose.force, pose.moment
    x, y, z = r[0] - pose.centre[0], r[1] - pose.centre[1], r[2] - pose.centre[2]
    f[0], f[1], f[2] = n[0], n[1], n[2]
    m[0], m[1], m[2] = y * n[2] - z * n[1], z * n[0] - x * n[2], x * n[1] - y * n[0]
    for k in range(force.shape[0]):
        force[k] = 0.0
    onto_joint(j, pose, (f[0], f[1], f[2]), (m[0], m[1], m[2]), force)


@inlined
def _press_change(j: JointRecord, row: Contact, room: TangentRoom, out: Floats) -> None:
    """Write how that changes, (nv,), behind how pose and contact do."""
    pose, way, change = room.poses[0], room.poses[1], room.change[0]
    n, r, f, m = row.normal, row.point, way.force, way.moment
    x, y, z = r[0] - pose.centre[0], r[1] - pose.centre[1], r[2] - pose.centre[2]
    dx = change[POINT] - way.centre[0]
    dy = change[POINT + 1] - way.centre[1]
    dz = change[POINT + 2] - way.centre[2]
    a, b, c = change[NORMAL], change[NORMAL + 1], change[NORMAL + 2]
    mx = m[0] + y * c - z * b + dy * n[2] - dz * n[1]
    my = m[1] + z * a - x * c + dz * n[0] - dx * n[2]
    mz = m[2] + x * b - y * a + dx * n[1] - dy * n[0]
    for k in range(out.shape[0]):
        out[k] = 0.0
    onto_joint(j, pose, (f[0] + a, f[1] + b, f[2] + c), (mx, my, mz), out)
    for k in range(3 if j.planar != 0 else 6):
        out[j.v + k] += room.carried[k]


@inlined
def _accelerate(y: Floats, force: Floats, weightless: Floats, room: TangentRoom) -> float:
    """Write the response of a resting tree to a force; return their product.

    The multipliers of constraints are in ``room.rows.force``.
    """
    numbers, nv, nq = room.numbers, force.shape[0], space_of(room.layout).nq
    rest, a = room.state[0], room.acceleration
    for i in range(y.shape[0]):
        rest[i] = y[i]
    for k in range(nv):
        rest[nq + k] = 0.0
    if has_rows(room):
        plan, work, rows = numbers.plan, numbers.held, room.rows
        head = plan_of(plan)
        write_rows(0.0, rest, numbers.program, plan, work)
        mass_and_bias(numbers.tree, room.places, weightless, room.room, room.mass, rows.bias)
        factorize(plan, work, room.mass)
        for r in range(head.width):
            work[head.lack + r] = 0.0
        for k in range(nv):
            a[k] = force[k]
        solve_changes(plan, work, a, rows.force)
        for r in range(head.rows):
            work[head.force + r] = rows.force[r]
        read_bodies(rest, nq, numbers.tree, room.places, weightless, a, room.bodies)
        read_ties(plan, work, weightless, room.bodies, rows.ties)
    else:
        space, scratch = (numbers.tree, room.below), (room.places, room.room, room.mass, a)
        prepare_changes(rest, nq, space, weightless, force, scratch, room.bodies)
    product: float = 0.0
    for k in range(nv):
        product += force[k] * a[k]
    return product


@inlined
def _power(own: Floats, lacks: Floats, room: TangentRoom) -> float:
    """Return u^T of force changes and lambda^T of acceleration biases, sign reversed."""
    total: float = 0.0
    for k in range(own.shape[0]):
        total += room.acceleration[k] * own[k]
    for r in range(room.rows.force.shape[0]):
        total -= room.rows.force[r] * lacks[r]
    return total


@inlined
def _shift(m: int, weightless: Floats, room: TangentRoom) -> None:
    """Write what number m of the system does to ``room.shifts``: forces, and what accelerations lack."""
    numbers, shifts, rows = room.numbers, room.shifts, room.rows
    own, lacks = shifts.forces[m], shifts.lacks[m, 0]
    for k in range(own.shape[0]):
        own[k] = 0.0
    space, pulls = (numbers.tree, room.places), (weightless, weightless)
    write_number_changes(shifts.bodies[m], space, pulls, (room.acceleration, room.body), room.bodies, own)
    if has_rows(room):
        for r in range(lacks.shape[0]):
            lacks[r] = 0.0
        shift_ties(numbers.plan, room.places, shifts.closures[m], rows.ties)
        change_ties(numbers.plan, room.bodies, rows.ties, lacks)
        let_ties_rest(rows.ties)
        shift_couplings(numbers.plan, shifts.couplings[m], rows.force, room.acceleration, lacks, own)
    subtract_wrenches(numbers.tree, room.places, room.bodies, own)


@inlined
def _change_along(way: Floats, weightless: Floats, room: TangentRoom, own: Floats) -> float:
    """Return u^T (dJ^T lambda - dM u) + lambda^T dJ u along a displacement."""
    numbers, shifts, rows, nv = room.numbers, room.shifts, room.rows, own.shape[0]
    lacks = rows.lacks[0]
    for k in range(nv):
        own[k] = 0.0
    write_changes(way, nv, numbers.tree, room.places, weightless, room.bodies)
    if has_rows(room):
        for r in range(lacks.shape[0]):
            lacks[r] = 0.0
        change_ties(numbers.plan, room.bodies, rows.ties, lacks)
        scratch = lacks, rows.speeds, rows.twist
        change_motions(room.state[0], way, room.acceleration, rows.force, numbers.plan, scratch, own)
    subtract_wrenches(numbers.tree, room.places, room.bodies, own)
    total = _power(own, lacks, room)
    for m in range(shifts.steps.shape[0]):
        share = way[room.first_number[0] + m]
        if share != 0.0 and shifts.heavy[m] != 0:
            total += share * _power(shifts.forces[m], shifts.lacks[m, 0], room)
    return total


@kernel
def write_met(
    joint: int, c: int, y: Floats, ways: Floats, masses: bool, room: TangentRoom, out: Floats
) -> None:
    """Write derivatives of a contact's onset along displacements.

    Args:
        joint: Number of the contact's joint among the room's parts.
        c: Number of the contact.
        y: State.
        ways: Displacements, row by row, (k, displacement).
        masses: Whether the derivative of the mass is computed too; else it is zero.
        room: Arrays.
        out: Results, (k, MET).
    """
    numbers, shifts, part, nv = room.numbers, room.shifts, room.parts[joint], room.tau.shape[0]
    p, b = numbers.program, part.block
    j, pose, force, weightless = joint_at(p, b), room.poses[0], room.rates[:nv], room.freedoms[:3]
    row, mass = numbers.own[c], 0.0
    journal_state(j, y, space_of(room.layout).nq, pose)
    contact_motion(p, b, c - j.row, pose, numbers.own)
    _press(j, row, pose, force)
    for k in range(3):
        weightless[k] = 0.0
    if masses:
        mass = 1.0 / _accelerate(y, force, weightless, room)
    for m in range(shifts.steps.shape[0]):
        moved = is_moved(ways, room.first_number[0] + m)
        room.seen[m] = shifts.acts[part.number, m] if moved else 0
        if masses and moved and shifts.heavy[m] != 0:
            _shift(m, weightless, room)
    for d in range(ways.shape[0]):
        change_pose(p, b, y, ways[d], room)
        change_contact(p, b, c - j.row, ways[d], room)
        out[d, OPENING], out[d, CLOSING], out[d, HEAVIER] = room.change[0, GAP], room.change[0, RATE], 0.0
        if not masses:
            continue
        _press_change(j, row, room, force)
        lighter: float = 0.0
        for k in range(nv):
            lighter += 2.0 * room.acceleration[k] * force[k]
        lighter += _change_along(ways[d], weightless, room, force)
        out[d, HEAVIER] = -mass * lighter
