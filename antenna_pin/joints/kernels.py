"""The joint with play, compiled: from pose and twist to generalized force.

A joint is a block of numbers in a system's program (:mod:`antenna_pin.joints.layout_kernels`), its contacts
are rows of a table (:data:`antenna_pin.base.records.CONTACT`) and of the contact memory
(:data:`antenna_pin.base.records.MEMORY`). Integrals of a contact are consecutive in x.

A point load at a flange acts at the deepest point of the rim, or nearer to the axis where the whole annulus
presses (:func:`antenna_pin.joints.row_kernels.lever`); its depth, and so its force and the stored energy,
remain those of the deepest point.
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats, Memory, Pose, Records
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.contact.kernels import NORMAL_SIZE, elastic_energy
from antenna_pin.contact.records import FRICTION_SIZE
from antenna_pin.joints.geometry.kernels import FLANGE, candidate_contact
from antenna_pin.joints.layout_kernels import (
    BRISTLES,
    FORCES_GIVEN,
    GEOMETRY_GIVEN,
    INTEGRALS,
    candidate_at,
    friction_at,
    joint_at,
    normal_at,
    primitive_of,
    revolute_of,
)
from antenna_pin.joints.patch_kernels import (
    loaded_rates,
    patch_energy,
    patch_forces,
    patch_geometry,
    patch_wrench,
)
from antenna_pin.joints.pose_kernels import journal_state, onto_joint
from antenna_pin.joints.row_kernels import (
    add_wrench,
    arm_power,
    bristles,
    friction_power,
    no_forces,
    no_wrench,
    place_flange_force,
    row_forces,
    row_normal_force,
    row_rates,
)


@inlined
def contact_geometry(p: Floats, b: int, pose: Pose, table: Records[Contact]) -> None:
    """Fill gap, normal and point of all of a joint's rows in closed form."""
    j = joint_at(p, b)
    if j.distributed != 0:
        anything = j.contacts > 0
        patch_geometry(p, b, pose, table, anything, anything)
        return
    for k in range(j.contacts):
        candidate_contact(p, candidate_at(b, k), pose, table[j.row + k])


@inlined
def touching_geometry(
    p: Floats, b: int, pose: Pose, memory: Records[Memory], table: Records[Contact]
) -> None:
    """Fill gap, normal and point of the contacts that touch; the others have no force."""
    j = joint_at(p, b)
    if j.distributed != 0:
        bore = memory[j.row].touching != 0.0 or memory[j.row + 1].touching != 0.0
        flanges = memory[j.row + 2].touching != 0.0 or memory[j.row + 3].touching != 0.0
        patch_geometry(p, b, pose, table, bore, flanges)
        return
    for k in range(j.contacts):
        if memory[j.row + k].touching != 0.0:
            candidate_contact(p, candidate_at(b, k), pose, table[j.row + k])


@inlined
def contact_rates(p: Floats, b: int, pose: Pose, table: Records[Contact]) -> None:
    """Fill depth rate and slip of a joint's contacts, and of loaded strips.

    The point of a point load at a flange that presses flat is moved to that of the force.
    """
    j = joint_at(p, b)
    for k in range(j.contacts):
        if j.distributed != 0:
            row_rates(pose, table[j.row + k])
        else:
            _rates_of(p, b, k, pose, table)
    if j.distributed != 0:
        loaded_rates(p, b, pose, table)


@inlined
def _rates_of(p: Floats, b: int, k: int, pose: Pose, table: Records[Contact]) -> None:
    """Fill depth rate and slip of contact k of a joint with point loads."""
    out = table[joint_at(p, b).row + k]
    row_rates(pose, out)
    if primitive_of(p, b, k) == FLANGE:
        place_flange_force(revolute_of(p, b, k), pose, out)


@inlined
def touching_rates(p: Floats, b: int, pose: Pose, memory: Records[Memory], table: Records[Contact]) -> None:
    """Fill depth rate and slip of touching contacts, strips, or all with a backend."""
    j = joint_at(p, b)
    if j.distributed != 0 or j.mode == GEOMETRY_GIVEN:
        contact_rates(p, b, pose, table)
        return
    for k in range(j.contacts):
        if memory[j.row + k].touching != 0.0:
            _rates_of(p, b, k, pose, table)


@inlined
def apart_motion(p: Floats, b: int, pose: Pose, memory: Records[Memory], table: Records[Contact]) -> None:
    """Fill what :func:`touching_geometry` and :func:`touching_rates` leave out: contacts that are apart."""
    j = joint_at(p, b)
    if j.distributed != 0:
        bore = memory[j.row].touching != 0.0 or memory[j.row + 1].touching != 0.0
        flanges = memory[j.row + 2].touching != 0.0 or memory[j.row + 3].touching != 0.0
        patch_geometry(p, b, pose, table, not bore, not flanges)
        return
    for k in range(j.contacts):
        if memory[j.row + k].touching == 0.0:
            contact_motion(p, b, k, pose, table)


@inlined
def contact_motion(p: Floats, b: int, k: int, pose: Pose, table: Records[Contact]) -> None:
    """Fill gap, normal, point, depth rate and slip of contact k under point load."""
    candidate_contact(p, candidate_at(b, k), pose, table[joint_at(p, b).row + k])
    _rates_of(p, b, k, pose, table)


@inlined
def normal_force_of(p: Floats, b: int, k: int, memory: Records[Memory], table: Records[Contact]) -> None:
    """Fill the normal force of contact k under point load; zero without touch."""
    j = joint_at(p, b)
    out, remembered = table[j.row + k], memory[j.row + k]
    if remembered.touching == 0.0:
        out.force = 0.0
        return
    normal = normal_at(b, k)
    row_normal_force(p[normal : normal + NORMAL_SIZE], remembered, out)


@inlined
def contact_forces(
    p: Floats,
    b: int,
    y: Floats,
    x0: int,
    memory: Records[Memory],
    table: Records[Contact],
    rates: Floats,
    r0: int,
) -> None:
    """Fill a joint's row forces by its laws; x is at y[x0], rates at rates[r0]."""
    j = joint_at(p, b)
    for k in range(j.contacts):
        out = table[j.row + k]
        remembered = memory[j.row + k]
        if remembered.touching == 0.0:
            # Both are zero only if all between are; most contacts stay apart.
            if out.force != 0.0 or out.elastic != 0.0:
                no_forces(out)
        elif j.distributed != 0:
            no_forces(out)
            patch_forces(p, b, k, remembered, table)
        else:
            normal = normal_at(b, k)
            friction = friction_at(b, k)
            row_forces(
                p[normal : normal + NORMAL_SIZE], p[friction : friction + FRICTION_SIZE], remembered, out
            )
    if j.stride > BRISTLES:
        bristles(p, b, y, x0, memory, table, rates, r0)


@inlined
def contact_wrench(
    p: Floats, b: int, pose: Pose, table: Records[Contact], tau: Floats, rates: Floats, r0: int
) -> None:
    """Add a joint's row forces to tau, in child axes; write rates of integrals."""
    j = joint_at(p, b)
    distributed = j.distributed != 0
    no_wrench(pose)
    for k in range(j.contacts):
        out = table[j.row + k]
        start = r0 + j.x + k * j.stride
        rate = record(rates[start : start + BRISTLES], INTEGRALS)
        rate.impulse = out.force
        rate.lost_normal = 0.0
        rate.lost_friction = 0.0
        if out.force == 0.0 and out.elastic == 0.0:
            continue
        if distributed:
            rate.lost_normal = out.lost_normal
            rate.lost_friction = out.lost_friction
            continue
        # Where a law without adhesion is cut off at zero, the energy released by the spring is lost too.
        lost = (out.force - out.elastic) * out.rate
        if primitive_of(p, b, k) == FLANGE:
            lost += arm_power(pose, out)
        rate.lost_normal = lost
        if out.force != 0.0:
            rate.lost_friction = friction_power(out)
            add_wrench(pose, out)
    if distributed:
        patch_wrench(p, b, pose, table)
    force, moment = pose.force, pose.moment
    onto_joint(j, pose, (force[0], force[1], force[2]), (moment[0], moment[1], moment[2]), tau)


@kernel
def unit_normal_force(
    p: Floats, b: int, poses: Records[Pose], table: Records[Contact], r: int, tau: Floats
) -> None:
    """Add the generalized force of 1 N along row r's normal to tau."""
    out, pose = table[r], poses[0]
    nx, ny, nz = out.normal[0], out.normal[1], out.normal[2]
    rx = out.point[0] - pose.centre[0]
    ry = out.point[1] - pose.centre[1]
    rz = out.point[2] - pose.centre[2]
    moment = (ry * nz - rz * ny, rz * nx - rx * nz, rx * ny - ry * nx)
    onto_joint(joint_at(p, b), pose, (nx, ny, nz), moment, tau)


@kernel
def wrench_on_journal(p: Floats, b: int, poses: Records[Pose], table: Records[Contact]) -> None:
    """Write the contacts' force and torque about the journal's centre, in bearing axes, into poses[0]."""
    j, pose = joint_at(p, b), poses[0]
    if j.distributed != 0:
        patch_wrench(p, b, pose, table)
        return
    no_wrench(pose)
    for r in range(j.row, j.row + j.contacts):
        if table[r].force != 0.0:
            add_wrench(pose, table[r])


@kernel
def joint_energy(p: Floats, b: int, memory: Records[Memory], table: Records[Contact]) -> float:
    """Energy stored in a joint's touching contacts [J], of compiled laws; gaps from the table."""
    j = joint_at(p, b)
    energy = 0.0
    for k in range(j.contacts):
        if memory[j.row + k].touching == 0.0:
            continue
        if j.distributed != 0:
            energy += patch_energy(p, b, k, table)
        else:
            normal = normal_at(b, k)
            energy += elastic_energy(p[normal : normal + NORMAL_SIZE], -table[j.row + k].gap)
    return energy


@inlined
def clearance_joint(
    p: Floats,
    b: int,
    y: Floats,
    nq: int,
    nv: int,
    memory: Records[Memory],
    table: Records[Contact],
    pose: Pose,
    tau: Floats,
    rates: Floats,
) -> None:
    """Add a clearance joint's generalized force to tau; write the rates of its integrals.

    Only rows of touching contacts in the table are updated (``contact_geometry``: all).
    """
    j = joint_at(p, b)
    journal_state(j, y, nq, pose)
    if j.mode < FORCES_GIVEN:
        if j.mode < GEOMETRY_GIVEN:
            touching_geometry(p, b, pose, memory, table)
        touching_rates(p, b, pose, memory, table)
        contact_forces(p, b, y, nq + nv, memory, table, rates, nv)
    contact_wrench(p, b, pose, table, tau, rates, nv)


@kernel
def alone(
    p: Floats,
    b: int,
    y: Floats,
    nq: int,
    nv: int,
    memory: Records[Memory],
    table: Records[Contact],
    pose: Records[Pose],
    tau: Floats,
    rates: Floats,
) -> None:
    """:func:`clearance_joint` of one joint by itself, called from outside; pose: POSE, (1,)."""
    clearance_joint(p, b, y, nq, nv, memory, table, pose[0], tau, rates)


@kernel
def geometry_alone(
    p: Floats, b: int, y: Floats, nq: int, table: Records[Contact], pose: Records[Pose]
) -> None:
    """Fill gap, normal and point of a joint's rows, for calls with a POSE, (1,)."""
    journal_state(joint_at(p, b), y, nq, pose[0])
    contact_geometry(p, b, pose[0], table)


@kernel
def rates_alone(p: Floats, b: int, table: Records[Contact], pose: Records[Pose]) -> None:
    """Fill depth rates and slips of a joint's rows, for calls with a POSE, (1,)."""
    contact_rates(p, b, pose[0], table)
