"""Derived quantities at the samples of a run, except accelerations, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import (
    MEMORY,
    POSE,
    Contact,
    Floats,
    Ints,
    Memory,
    Pose,
    Record,
    Records,
    Vector3,
    layout,
)
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel, released
from antenna_pin.dynamics import link_kernels as _links
from antenna_pin.dynamics import point_kernels as _points
from antenna_pin.dynamics.audit_kernels import AuditRecord, audit_state
from antenna_pin.dynamics.constraints.factor_kernels import factorize
from antenna_pin.dynamics.constraints.force_kernels import write_holding
from antenna_pin.dynamics.constraints.layout_kernels import PLACE_WORDS, applied_in, found_in, plan_of
from antenna_pin.dynamics.constraints.loaded_kernels import solve
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.kernels import (
    ABOUT_POSE,
    HEADER,
    MEMORY_WORDS,
    PARAMETERS,
    POSE_WORDS,
    block_at,
    element_at,
    element_energy,
    element_state,
    evaluate,
    head_of,
    joint_motion,
    stored_energy,
)
from antenna_pin.dynamics.link_kernels import Applied
from antenna_pin.dynamics.point_kernels import Stretched
from antenna_pin.dynamics.query_kernels import answer_queries, has_queries
from antenna_pin.dynamics.trial_kernels import contacts_in
from antenna_pin.elements import kernels as elements
from antenna_pin.joints.geometry.kernels import BORE
from antenna_pin.joints.geometry.revolute_kernels import contact_scenario, revolute_contacts
from antenna_pin.joints.kernels import apart_motion, wrench_on_journal
from antenna_pin.joints.layout_kernels import (
    ALL_COMPILED,
    CLEARANCE,
    JointRecord,
    joint_at,
    primitive_of,
    revolute_of,
)
from antenna_pin.joints.pose_kernels import journal_state, motion_angle
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.room_kernels import BodyRoom
from antenna_pin.mechanism.tree_kernels import PLACE, Body, Place, unwrapped


class ContactSample(Record):
    """A contact at a sample, by the names of the result's variables."""

    gap: float  # [m]
    depth: float  # [m]
    depth_rate: float  # [m/s]
    slip_speed: float  # [m/s]
    normal_force: float  # [N]
    friction_force: float  # [N]
    contact_force: Vector3  # on the journal, bearing axes [N]
    contact_point: Vector3  # from the bearing's centre [m]


SEEN = layout(ContactSample)


class Effort(Record):
    """A drive at a sample."""

    effort: float  # [N m] ([N])
    reference: float  # that it follows [rad] ([m])
    error: float  # from the reference [rad] ([m])


EFFORT = layout(Effort)


class ElementSample(Record):
    """An element of a further family at a sample."""

    effort: float  # [N m] ([N])
    deflection: float  # that it acts by [rad] ([m])
    energy: float  # stored [J]
    mode: float  # of the element


DONE = layout(ElementSample)


@inlined
def _apart_in(
    y: Floats, program: Floats, memory: Records[Memory], pose: Pose, table: Records[Contact]
) -> None:
    """Fill the rows of separated contacts; the evaluation fills the others."""
    nq = head_of(program).nq
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        journal_state(j, y, nq, pose)
        apart_motion(program, b, pose, memory, table)
        b += j.length


@inlined
def _look_at(row: Contact, sample: ContactSample) -> None:
    """Write a contact's results from its row of a contact table."""
    force = max(row.force, 0.0)
    slip = 0.0
    friction = 0.0
    for k in range(3):
        slip += row.slip[k] ** 2
        friction += row.friction[k] ** 2
        sample.contact_force[k] = force * row.normal[k] + row.friction[k]
        sample.contact_point[k] = row.point[k]
    sample.gap = row.gap
    sample.depth = max(-row.gap, 0.0)
    sample.depth_rate = row.rate
    sample.slip_speed = math.sqrt(slip)
    sample.normal_force = force
    sample.friction_force = math.sqrt(friction)


@kernel
def _scenario(
    p: Floats, b: int, pose: Pose, table: Records[Contact], scratch: Records[Contact], out: NDArray[np.int8]
) -> None:
    """Write a joint's contact scenario, or contact flag where it has none."""
    j = joint_at(p, b)
    out[0] = 0
    out[1] = 0
    if primitive_of(p, b, 0) == BORE:
        shape = revolute_of(p, b, 0)
        if j.mode == ALL_COMPILED and j.distributed == 0:
            # The rows of the contacts are those of the closed form.
            out[0], out[1] = contact_scenario(shape, pose, table, j.row, scratch[4])
            return
        revolute_contacts(shape, pose, scratch)
        out[0], out[1] = contact_scenario(shape, pose, scratch, 0, scratch[4])
        return
    for r in range(j.row, j.row + j.contacts):
        if table[r].gap < 0.0:
            out[0] = 1


@by_address
class SampleArrays(NamedTuple):
    """Samples of a run for evaluation."""

    times: Floats  # (n,) [s]
    states: Floats  # (n, state)
    memories: NDArray[Memory]  # of the contacts, MEMORY, (n, contacts)


@by_address
class SystemArrays(NamedTuple):
    """A system, and room for its evaluation."""

    program: Floats  # the force elements
    work: Floats  # of :func:`antenna_pin.dynamics.kernels.evaluate`; its contact table is ``table``
    table: Records[Contact]  # contact table, CONTACT, (rows,)
    rates: Floats  # to write to
    blocks: Ints  # places of the joints with play in the program
    drives: Ints  # places of the drives
    tree: Records[Body]  # bodies (``BODY``)
    gravity: Floats  # (3,) [m/s^2]
    places: Records[Place]  # to write to, PLACE, (bodies + 1,)
    scratch: Records[Contact]  # A contact table to write to, CONTACT, (5,)


@by_address
class Sights(NamedTuple):
    """Results at each of n samples."""

    forces: Floats  # generalized forces, (n, nv)
    contacts: NDArray[ContactSample]  # results of contacts, ``SEEN``, (n, contacts)
    poses: NDArray[Pose]  # poses of journals and wrenches on them, POSE, (n, joints)
    scenarios: NDArray[np.int8]  # contact scenarios, radial and axial, (n, joints, 2)
    efforts: NDArray[Effort]  # results of drives, ``EFFORT``, (n, drives)
    audits: Records[AuditRecord]  # energies and momenta, AUDIT, (n,)
    stretches: NDArray[Stretched]  # results of springs between points, ``STRETCH``, (n, springs)
    applied: NDArray[Applied]  # results at places of forces, ``APPLIED``, (n, places)
    kept: Floats  # energies that forces store [J], (n, forces)
    # actions of elements on links on bodies, (n, 6 bodies), if friction by load needs them, else (n, 0)
    wrenches: Floats


@released
def observe(
    begin: int, last: int, is_evaluated: bool, samples: SampleArrays, whole: SystemArrays, sights: Sights
) -> int:
    """Evaluate the force elements at samples begin to last and write their results.

    Args:
        begin: First sample.
        last: One behind the last.
        is_evaluated: Whether forces and contact table of the one sample are in ``whole.work`` already.
        samples: ``SampleArrays``.
        whole: ``SystemArrays``.
        sights: ``Sights``, written.

    Returns:
        Sample at which coal's machine code failed; ``last`` if it did not.
    """
    program, work, table, places = whole.program, whole.work, whole.table, whole.places
    head = head_of(program)
    nq, nv = head.nq, head.nv
    start = nv + POSE_WORDS
    pose = work[nv:start].view(POSE)
    memory = work[start : start + MEMORY_WORDS * samples.memories.shape[1]].view(MEMORY)
    on_links = head.points < program.shape[0]
    measured = has_queries(program, work)
    for i in range(begin, last):
        t, y = samples.times[i], samples.states[i]
        if not is_evaluated:
            for c in range(memory.shape[0]):
                memory[c] = samples.memories[i, c]
            if measured:
                contacts_in(y, program, pose, table)
                if answer_queries(y, program, work, True) != 0:
                    return i
            else:
                _apart_in(y, program, memory, pose[0], table)
            evaluate(t, y, program, work, whole.rates)
            if on_links:
                _links.add_forces(t, y, program, whole.tree, places, work, whole.rates)
        for k in range(nv):
            sights.forces[i, k] = work[k]
        for c in range(memory.shape[0]):
            _look_at(table[c], sights.contacts[i, c])
        for k in range(whole.drives.shape[0]):
            drive = sights.efforts[i, k]
            drive.effort, drive.reference, drive.error = element_state(program, whole.drives[k], t, y, nq)
        for k in range(whole.blocks.shape[0]):
            b, own = whole.blocks[k], sights.poses[i, k : k + 1]
            journal_state(joint_at(program, b), y, nq, own[0])
            wrench_on_journal(program, b, own, table)
            _scenario(program, b, own[0], table, whole.scratch, sights.scenarios[i, k])
        audit = sights.audits[i : i + 1]
        audit_state(y, nq, whole.tree, whole.gravity, places, audit)
        audit[0].contacts, audit[0].springs = stored_energy(y, program, memory, table)
        if on_links:
            audit[0].springs += _links.stored(y, program, places)
            _points.look_at(program, places, sights.stretches[i])
            _links.look_at_links(program, sights.applied[i], sights.kept[i])
            _links.write_wrenches(program, places, sights.wrenches[i])
    return last


@released
def look_at_elements(
    start: int,
    last: int,
    samples: SampleArrays,
    blocks: Ints,
    whole: SystemArrays,
    out: NDArray[ElementSample],
) -> None:
    """Write what elements do at samples start to last, ``DONE``, (n, blocks)."""
    program = whole.program
    nq = head_of(program).nq
    for i in range(start, last):
        t, y = samples.times[i], samples.states[i]
        for k in range(blocks.shape[0]):
            b, own = blocks[k], out[i, k]
            e = element_at(program, b)
            own.effort, _, _ = element_state(program, b, t, y, nq)
            own.energy = e.on * element_energy(program, b, y, nq)
            own.deflection = 0.0 if e.about == ABOUT_POSE else joint_motion(program, b, y, nq)[0]
            own.mode = elements.mode(e.kind, program, b + PARAMETERS)


@kernel
def turned_angles(states: Floats, at: int, angle: int, out: Floats) -> None:
    """Write a continuous joint's angle with turns at samples; its cosine is at ``at``."""
    for i in range(states.shape[0]):
        out[i] = unwrapped(math.atan2(states[i, at + 1], states[i, at]), states[i, angle])


@kernel
def clearance_motion(program: Floats, b: int, states: Floats, accelerations: Floats, out: Floats) -> None:
    """Write motion angle, rate and acceleration of the joint block at b, (n, 3)."""
    head = head_of(program)
    nq, nv = head.nq, head.nv
    j = joint_at(program, b)
    k = j.v
    for i in range(states.shape[0]):
        y = states[i]
        angle, gx, gy = motion_angle(j, y, nq + nv)
        out[i, 0] = angle
        if j.planar != 0:
            out[i, 1] = y[nq + k + 2]
            out[i, 2] = accelerations[i, k + 2]
            continue
        w, alpha = y[nq + k + 3 : nq + k + 6], accelerations[i, k + 3 : k + 6]
        wx = j.axes[0, 0] * w[0] + j.axes[1, 0] * w[1] + j.axes[2, 0] * w[2]
        wy = j.axes[0, 1] * w[0] + j.axes[1, 1] * w[1] + j.axes[2, 1] * w[2]
        wz = j.axes[0, 2] * w[0] + j.axes[1, 2] * w[1] + j.axes[2, 2] * w[2]
        ax = j.axes[0, 0] * alpha[0] + j.axes[1, 0] * alpha[1] + j.axes[2, 0] * alpha[2]
        ay = j.axes[0, 1] * alpha[0] + j.axes[1, 1] * alpha[1] + j.axes[2, 1] * alpha[2]
        az = j.axes[0, 2] * alpha[0] + j.axes[1, 2] * alpha[1] + j.axes[2, 2] * alpha[2]
        out[i, 1] = gx * wx + gy * wy + wz
        dgx, dgy = tilt_rate(j, y, wx, wy, wz)
        out[i, 2] = gx * ax + gy * ay + az + dgx * wx + dgy * wy


@kernel
def tilt_rate(j: JointRecord, y: Floats, wx: float, wy: float, wz: float) -> tuple[float, float]:
    """Return the rates of gx and gy of the motion angle [1/s]."""
    i = j.q + 3
    x = j.axes[0, 0] * y[i] + j.axes[1, 0] * y[i + 1] + j.axes[2, 0] * y[i + 2]
    q = j.axes[0, 1] * y[i] + j.axes[1, 1] * y[i + 1] + j.axes[2, 1] * y[i + 2]
    z = j.axes[0, 2] * y[i] + j.axes[1, 2] * y[i + 1] + j.axes[2, 2] * y[i + 2]
    s = y[i + 3]
    # Quaternion kinematics in body axes.
    ds = -0.5 * (x * wx + q * wy + z * wz)
    dx = 0.5 * (s * wx + q * wz - z * wy)
    dq = 0.5 * (s * wy + z * wx - x * wz)
    dz = 0.5 * (s * wz + x * wy - q * wx)
    square = z * z + s * s
    if square == 0.0:
        return 0.0, 0.0
    change = 2.0 * (z * dz + s * ds) / square
    gx, gy = (z * x - s * q) / square, (s * x + z * q) / square
    return (
        (dz * x + z * dx - ds * q - s * dq) / square - gx * change,
        (ds * x + s * dx + dz * q + z * dq) / square - gy * change,
    )


# --- with constraints ---------------------------------------------------------------------------------------


@by_address
class ConstraintArrays(NamedTuple):
    """Constraints, and room for their solution."""

    plan: Floats  # the constraints
    work: Floats  # their work array
    mass: Floats  # mass matrix, (nv, nv), scratch
    bias: Floats  # (nv,), scratch
    room: Records[BodyRoom]  # arrays for the tree's dynamics, ROOM, (bodies + 1,)
    # of :func:`antenna_pin.dynamics.constraints.force_kernels.least_forces`, (2 rows (rows + 1),), scratch
    least: Floats
    multipliers: Floats  # (rows,), scratch
    applied: Floats  # actions of elements on links on bodies at the samples, (n, 6 bodies), or (n, 0)


@by_address
class Holding(NamedTuple):
    """Constraint forces and motion of a system at n samples."""

    rates: Floats  # generalized accelerations, and behind them powers of motions, (n, nv + nx)
    closures: Floats  # force [N] and moment [N m] of each closure, (n, closures, 2, 3)
    joints: Floats  # forces of motions, of couplings' followers, and of holding elements, (n, all)
    residuals: Floats  # largest of positions [m], [rad] and of rates [m/s], [rad/s], (n, 4)


@released
def observe_held(
    start: int,
    last: int,
    samples: SampleArrays,
    whole: SystemArrays,
    constraints: ConstraintArrays,
    forces: Floats,
    out: Holding,
) -> None:
    """Solve the constraints at samples start to last.

    Args:
        start: First sample.
        last: One behind the last.
        samples: :class:`antenna_pin.dynamics.sample_kernels.SampleArrays`.
        whole: ``SystemArrays``; its program is that of these samples.
        constraints: ``ConstraintArrays``.
        forces: Generalized forces of the elements, (n, nv).
        out: ``Holding``, to write to.
    """
    plan, work = constraints.plan, constraints.work
    found = found_in(plan, work)
    places = work[: PLACE_WORDS * (plan_of(plan).bodies + 1)].view(PLACE)
    for i in range(start, last):
        t, y = samples.times[i], samples.states[i]
        write_rows(t, y, whole.program, plan, work)
        mass_and_bias(whole.tree, places, whole.gravity, constraints.room, constraints.mass, constraints.bias)
        factorize(plan, work, constraints.mass)
        first_applied, end_applied = applied_in(plan)
        for k in range(first_applied, end_applied):
            work[k] = constraints.applied[i, k - first_applied]
        solve(y, whole.program, plan, work, forces[i], constraints.bias, out.rates[i])
        write_holding(plan, work, constraints.least, constraints.multipliers, out.closures[i], out.joints[i])
        residuals = out.residuals[i]
        residuals[0], residuals[1], residuals[2], residuals[3] = (
            found.gap,
            found.turn,
            found.speed,
            found.spin,
        )
