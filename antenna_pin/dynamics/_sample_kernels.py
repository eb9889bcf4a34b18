"""All that the samples of a run imply but its accelerations, compiled: one pass over the states."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin._compile import inlined, kernel
from antenna_pin.dynamics._audit_kernels import AUDIT_SIZE, audit_state
from antenna_pin.dynamics._inspect import contacts_in
from antenna_pin.dynamics._kernels import element_state, evaluate, stored_energy
from antenna_pin.geometry._kernels import contact_scenario, revolute_contacts
from antenna_pin.joints import _kernels as joint
from antenna_pin.joints._kernels import (
    DISTRIBUTED,
    MEMORY_WIDTH,
    PLANAR,
    REVOLUTE,
    journal_state,
    motion_angle,
    unwrapped,
    wrench_on_journal,
)
from antenna_pin.records import record

# A contact at a sample, by the names of the result's variables.
CONTACT = record(
    ("gap", np.float64),
    ("depth", np.float64),
    ("depth_rate", np.float64),
    ("slip_speed", np.float64),
    ("normal_force", np.float64),
    ("friction_force", np.float64),
    ("contact_force", np.float64, (3,)),
    ("contact_point", np.float64, (3,)),
)
# Of a sample beside what ``audit_state`` writes: energy stored in contacts and in springs [J].
CONTACTS = AUDIT_SIZE
SPRINGS = AUDIT_SIZE + 1
ENERGIES = AUDIT_SIZE + 2


@inlined
def _look_at(table: Any, r: int, seen: Any) -> None:
    """Write what row r of a contact table tells of its contact."""
    force = max(table[r, joint.FORCE], 0.0)
    slip = 0.0
    friction = 0.0
    for k in range(3):
        slip += table[r, joint.SLIP + k] ** 2
        friction += table[r, joint.FRICTION + k] ** 2
        seen.contact_force[k] = force * table[r, 1 + k] + table[r, joint.FRICTION + k]
        seen.contact_point[k] = table[r, 4 + k]
    seen.gap = table[r, 0]
    seen.depth = max(-table[r, 0], 0.0)
    seen.depth_rate = table[r, joint.RATE]
    seen.slip_speed = math.sqrt(slip)
    seen.normal_force = force
    seen.friction_force = math.sqrt(friction)


@kernel
def observe(
    first: int,
    last: int,
    given: bool,
    times: Any,
    states: Any,
    memories: Any,
    program: Any,
    work: Any,
    table: Any,
    rates: Any,
    blocks: Any,
    drives: Any,
    tree: Any,
    gravity: Any,
    room: Any,
    scratch: Any,
    forces: Any,
    contacts: Any,
    poses: Any,
    wrenches: Any,
    scenarios: Any,
    efforts: Any,
    energies: Any,
) -> None:
    """Evaluate the force elements at samples first to last and write what follows from them.

    Args:
        first: First sample.
        last: One behind the last.
        given: Whether forces and contact table of the one sample stand in ``work`` already.
        times: (n,) [s].
        states: (n, state).
        memories: Of the contacts, (n, contacts, MEMORY_WIDTH).
        program: The force elements.
        work: Of :func:`antenna_pin.dynamics._kernels.evaluate`; its contact table is ``table``.
        table: Contact table, (rows, columns).
        rates: To write to.
        blocks: Places of the joints with play in the program.
        drives: Places of the drives.
        tree: Bodies (``BODY``).
        gravity: (3,) [m/s^2].
        room: To write to, (bodies + 2, PLACE_SIZE).
        scratch: A contact table to write to, five rows.
        forces: Generalized forces, (n, nv).
        contacts: ``CONTACT`` of each, (n, contacts).
        poses: Of the journals, (n, joints, POSE_BUFFER).
        wrenches: On the journals, (n, joints, 6).
        scenarios: Of contact, radial and axial, (n, joints, 2).
        efforts: Of the drives, with the reference that they follow and their error, (n, drives, 3).
        energies: (n, ENERGIES).
    """
    nq, nv = int(program[0]), int(program[1])
    start = nv + joint.POSE_BUFFER
    pose = work[nv:start]
    memory = work[start : start + MEMORY_WIDTH * memories.shape[1]].reshape(memories.shape[1], MEMORY_WIDTH)
    for i in range(first, last):
        y = states[i]
        if not given:
            for c in range(memory.shape[0]):
                for k in range(MEMORY_WIDTH):
                    memory[c, k] = memories[i, c, k]
            contacts_in(y, program, pose, table)
            evaluate(times[i], y, program, work, rates)
        for k in range(nv):
            forces[i, k] = work[k]
        for c in range(memory.shape[0]):
            _look_at(table, c, contacts[i, c])
        for k in range(drives.shape[0]):
            own_effort, reference, error = element_state(program, drives[k], times[i], y, nq)
            efforts[i, k, 0], efforts[i, k, 1], efforts[i, k, 2] = own_effort, reference, error
        for k in range(blocks.shape[0]):
            b = blocks[k]
            own = poses[i, k]
            row = int(program[b + joint.FIRST_CONTACT])
            journal_state(program, b, y, nq, own)
            wrench_on_journal(program, b, own, table, row, wrenches[i, k])
            if program[b] == REVOLUTE or program[b] == DISTRIBUTED:
                shape = program[b + joint.SHAPE : b + joint.SHAPE + 6]
                if program[b] == REVOLUTE and program[b + joint.MODE] == 0.0:
                    for r in range(4):  # the rows of the contacts are those of the closed form
                        for n in range(4):
                            scratch[r, n] = table[row + r, n]
                else:
                    revolute_contacts(shape, own[0], own[1], own[2], own[3], own[4], own[5], scratch, 0)
                found = contact_scenario(shape, own[0], own[1], own[2], own[3], own[4], own[5], scratch, 0, 4)
                scenarios[i, k, 0], scenarios[i, k, 1] = found[0], found[1]
            else:
                scenarios[i, k, 0] = 1 if table[row, 0] < 0.0 else 0
        audit_state(y, nq, tree, gravity, room, energies[i])
        stored = stored_energy(y, program, memory, table)
        energies[i, CONTACTS], energies[i, SPRINGS] = stored[0], stored[1]


@kernel
def turned_angles(states: Any, at: int, near: int, out: Any) -> None:
    """Write the angle of a continuous joint, with its whole turns, at every sample.

    Its cosine stands at ``at`` in a state, its turned angle at ``near``.
    """
    for i in range(states.shape[0]):
        out[i] = unwrapped(math.atan2(states[i, at + 1], states[i, at]), states[i, near])


@kernel
def clearance_motion(program: Any, b: int, states: Any, accelerations: Any, out: Any) -> None:
    """Write motion angle, its rate and its acceleration of the joint block at b, (n, 3)."""
    nq, nv = int(program[0]), int(program[1])
    j = int(program[b + 4])
    a = b + joint.AXES
    for i in range(states.shape[0]):
        y = states[i]
        angle, gx, gy = motion_angle(program, b, y, nq + nv)
        out[i, 0] = angle
        if program[b] == PLANAR:
            out[i, 1] = y[nq + j + 2]
            out[i, 2] = accelerations[i, j + 2]
            continue
        w, alpha = y[nq + j + 3 : nq + j + 6], accelerations[i, j + 3 : j + 6]
        wx = program[a] * w[0] + program[a + 3] * w[1] + program[a + 6] * w[2]
        wy = program[a + 1] * w[0] + program[a + 4] * w[1] + program[a + 7] * w[2]
        wz = program[a + 2] * w[0] + program[a + 5] * w[1] + program[a + 8] * w[2]
        ax = program[a] * alpha[0] + program[a + 3] * alpha[1] + program[a + 6] * alpha[2]
        ay = program[a + 1] * alpha[0] + program[a + 4] * alpha[1] + program[a + 7] * alpha[2]
        az = program[a + 2] * alpha[0] + program[a + 5] * alpha[1] + program[a + 8] * alpha[2]
        out[i, 1] = gx * wx + gy * wy + wz
        dgx, dgy = tilt_rate(program, b, y, wx, wy, wz)
        out[i, 2] = gx * ax + gy * ay + az + dgx * wx + dgy * wy


@kernel
def tilt_rate(p: Any, b: int, y: Any, wx: float, wy: float, wz: float) -> tuple[float, float]:
    """Return the rates of gx and gy of the motion angle for the angular velocity in journal axes [1/s]."""
    i = int(p[b + 3]) + 3
    a = b + joint.AXES
    x = p[a] * y[i] + p[a + 3] * y[i + 1] + p[a + 6] * y[i + 2]
    q = p[a + 1] * y[i] + p[a + 4] * y[i + 1] + p[a + 7] * y[i + 2]
    z = p[a + 2] * y[i] + p[a + 5] * y[i + 1] + p[a + 8] * y[i + 2]
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
