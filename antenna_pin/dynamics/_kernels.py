"""Force elements of a system as one flat program, compiled.

``program`` is a list of blocks ``[kind, length, ...]`` that starts at ``HEADER``; its head is [nq, nv,
contacts, 0]. A block is a clearance joint (layout in :mod:`antenna_pin.joints._kernels`) or an
element at a joint, of one of the kinds of :mod:`antenna_pin.elements`::

    [kind, length, joint kind, start in q, start in v, start in x, block of the clearance joint or -1,
     what it acts about (its place in ``ABOUTS``), place of the turned angle in x or -1, whether it depends on
     the joint's motion (0 or 1), whether it is on (0 or 1), record of its kind...]

A configuration knows an angle only but for whole turns. Joints that turn without end (continuous ones and
those with play) have their *turned angle*, with all its turns, in x: the angle at the last accepted state, to
which every angle of the step from there is the nearest (:func:`antenna_pin.joints._kernels.unwrapped`).
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.contact._kernels import NORMAL_SIZE, elastic_energy
from antenna_pin.elements import _kernels as elements
from antenna_pin.geometry._kernels import TABLE_WIDTH
from antenna_pin.joints import _kernels as joint
from antenna_pin.joints._kernels import (
    DISTRIBUTED,
    LAST_KIND,
    MEMORY_WIDTH,
    PLANAR,
    clearance_joint,
    motion_angle,
    unwrapped,
    wrapped_angle,
)

HEADER = 4

ONE_DOF = 0.0
CIRCLE = 1.0  # a continuous joint: (cos, sin)
CLEARANCE = 2.0

JOINT_KIND = 2
START_Q = 3
START_V = 4
START_X = 5
CLEARANCE_BLOCK = 6
ABOUT = 7
TURN = 8
SENSES = 9
ON = 10
PARAMETERS = 11

# What an element acts about at a joint with play, by its number.
ABOUTS = ("bearing", "journal", "motion")
ABOUT_BEARING = 0.0
ABOUT_MOTION = 2.0


@kernel
def joint_motion(p: Any, b: int, y: Any, nq: int) -> tuple[float, float, float, float]:
    """Angle and rate of the joint of a drive or spring block, and gx, gy of :func:`motion_angle`."""
    i = int(p[b + START_Q])
    j = nq + int(p[b + START_V])
    kind = p[b + JOINT_KIND]
    if kind == ONE_DOF:
        return y[i], y[j], 0.0, 0.0
    x0 = nq + int(p[1])
    if kind == CIRCLE:
        return unwrapped(math.atan2(y[i + 1], y[i]), y[x0 + int(p[b + TURN])]), y[j], 0.0, 0.0
    c = int(p[b + CLEARANCE_BLOCK])
    angle, gx, gy = motion_angle(p, c, y, x0)
    if p[c] == PLANAR:
        return angle, y[j + 2], 0.0, 0.0
    a = c + joint.AXES
    wx = p[a] * y[j + 3] + p[a + 3] * y[j + 4] + p[a + 6] * y[j + 5]
    wy = p[a + 1] * y[j + 3] + p[a + 4] * y[j + 4] + p[a + 7] * y[j + 5]
    wz = p[a + 2] * y[j + 3] + p[a + 5] * y[j + 4] + p[a + 8] * y[j + 5]
    return angle, gx * wx + gy * wy + wz, gx, gy


@kernel
def element_state(p: Any, b: int, t: float, y: Any, nq: int) -> tuple[float, float, float]:
    """Torque [N m] (force [N] at a prismatic joint) of the element block at b, and what it follows.

    The reference and its error are not-a-number where the element follows none.
    """
    angle, rate, _, _ = joint_motion(p, b, y, nq)
    wanted, _ = elements.reference(int(p[b]), p, b + PARAMETERS, t)
    return p[b + ON] * elements.effort(int(p[b]), p, b + PARAMETERS, t, angle, rate), wanted, wanted - angle


@kernel
def element_kink(p: Any, b: int, t: float, y: Any, nq: int) -> float:
    """Where the element block at b has kinks: a function that passes zero at them."""
    angle, rate, _, _ = joint_motion(p, b, y, nq)
    return float(elements.kink(int(p[b]), p, b + PARAMETERS, t, angle, rate))


@inlined
def _element(p: Any, b: int, t: float, y: Any, nq: int, nv: int, tau: Any, rates: Any) -> None:
    """Add an element's generalized force.

    At a clearance joint it is a couple about the bearing's or the journal's axis, or what derives from the
    motion angle.
    """
    kind = int(p[b])
    angle, rate, gx, gy = 0.0, 0.0, 0.0, 0.0
    on = p[b + ON]
    if p[b + SENSES] != 0.0:
        angle, rate, gx, gy = joint_motion(p, b, y, nq)
    effort = on * elements.effort(kind, p, b + PARAMETERS, t, angle, rate)
    j = int(p[b + START_V])
    c = int(p[b + CLEARANCE_BLOCK])
    if c < 0:
        tau[j] += effort
        power = effort * y[nq + j]
    elif p[c] == PLANAR:
        tau[j + 2] += effort
        power = effort * y[nq + j + 2]
    else:
        a = c + joint.AXES
        nx, ny, nz = p[a + 2], p[a + 5], p[a + 8]
        if p[b + ABOUT] == ABOUT_MOTION:
            nx += gx * p[a] + gy * p[a + 1]
            ny += gx * p[a + 3] + gy * p[a + 4]
            nz += gx * p[a + 6] + gy * p[a + 7]
        elif p[b + ABOUT] == ABOUT_BEARING:
            # The bearing's axis, seen from the journal: rotate by the inverse of the joint's quaternion.
            i = int(p[b + START_Q]) + 3
            qx, qy, qz, qw = -y[i], -y[i + 1], -y[i + 2], y[i + 3]
            tx = 2.0 * (qy * nz - qz * ny)
            ty = 2.0 * (qz * nx - qx * nz)
            tz = 2.0 * (qx * ny - qy * nx)
            nx, ny, nz = (
                nx + qw * tx + qy * tz - qz * ty,
                ny + qw * ty + qz * tx - qx * tz,
                nz + qw * tz + qx * ty - qy * tx,
            )
        tau[j + 3] += effort * nx
        tau[j + 4] += effort * ny
        tau[j + 5] += effort * nz
        k = nq + j + 3
        power = effort * (nx * y[k] + ny * y[k + 1] + nz * y[k + 2])
    elements.write_rates(kind, p, b + PARAMETERS, on * rate, power, rates, nv + int(p[b + START_X]))


@kernel
def evaluate(t: float, y: Any, program: Any, work: Any, rates: Any) -> None:
    """Write the generalized force of all elements into work, and the rates of x behind rates[nv].

    ``work`` is [generalized force (nv), pose, memory (contacts x MEMORY_WIDTH), table (rows x TABLE_WIDTH)]
    in one array, because each argument costs a part of what is computed.
    """
    nq = int(program[0])
    nv = int(program[1])
    contacts = int(program[2])
    tau = work[:nv]
    first = nv + joint.POSE_BUFFER
    pose = work[nv:first]
    second = first + MEMORY_WIDTH * contacts
    memory = work[first:second].reshape(contacts, MEMORY_WIDTH)
    rows = int(program[3])
    table = work[second : second + rows * TABLE_WIDTH].reshape(rows, TABLE_WIDTH)
    for k in range(nv):
        tau[k] = 0.0
    b = HEADER
    end = program.shape[0]
    while b < end:
        kind = program[b]
        if kind < LAST_KIND:
            clearance_joint(program, b, y, nq, nv, memory, table, pose, tau, rates)
        else:
            _element(program, b, t, y, nq, nv, tau, rates)
        b += int(program[b + 1])


@kernel
def stored_energy(y: Any, program: Any, memory: Any, table: Any) -> tuple[float, float]:
    """Energy stored in touching contacts (compiled laws; gaps from the table) and in springs [J]."""
    nq = int(program[0])
    contacts = 0.0
    springs = 0.0
    b = HEADER
    while b < program.shape[0]:
        kind = program[b]
        if kind < LAST_KIND:
            if program[b + joint.MODE] < joint.FORCES_GIVEN:
                row = int(program[b + joint.FIRST_CONTACT])
                for k in range(int(program[b + joint.CONTACTS])):
                    if memory[row + k, 0] == 0.0:
                        continue
                    if kind == DISTRIBUTED:
                        contacts += joint.patch_energy(program, b, k, table)
                    else:
                        law = b + joint.LAWS + k * joint.LAW_SIZE
                        contacts += elastic_energy(program[law : law + NORMAL_SIZE], -table[row + k, 0])
        elif program[b + SENSES] != 0.0:
            angle, _, _, _ = joint_motion(program, b, y, nq)
            springs += program[b + ON] * elements.stored(int(kind), program, b + PARAMETERS, angle)
        b += int(program[b + 1])
    return contacts, springs


@kernel
def turn_on(program: Any, turns: Any, y: Any) -> float:
    """Bring the turned angles in a state's x up to its configuration; return the fastest rate [rad/s].

    ``turns`` has a row per angle: place in x, block of the joint with play or -1, start in q, start in v.
    """
    nq = int(program[0])
    x0 = nq + int(program[1])
    fastest = 0.0
    for k in range(turns.shape[0]):
        at = x0 + turns[k, 0]
        block = turns[k, 1]
        j = nq + turns[k, 3]
        if block < 0:
            i = turns[k, 2]
            angle = math.atan2(y[i + 1], y[i])
            rate = abs(y[j])
        else:
            angle, _, _ = wrapped_angle(program, block, y)
            if program[block] == PLANAR:
                rate = abs(y[j + 2])
            else:
                rate = math.sqrt(y[j + 3] * y[j + 3] + y[j + 4] * y[j + 4] + y[j + 5] * y[j + 5])
        y[at] = unwrapped(angle, y[at])
        fastest = max(fastest, rate)
    return fastest
