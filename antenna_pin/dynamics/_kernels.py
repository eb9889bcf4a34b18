"""Force elements of a system as one flat program, compiled.

``program`` is a list of blocks ``[kind, length, ...]`` that starts at ``HEADER``; its head is [nq, nv,
contacts, 0]. A block is a clearance joint (layout in :mod:`antenna_pin.joints._kernels`), a drive or a
spring. Drives and springs::

    [kind, length, joint kind, start in q, start in v, start in x, block of the clearance joint or -1,
     acts about the journal's axis (0 or 1), place of the turned angle in x or -1, parameters...]

A configuration knows an angle only but for whole turns. Joints that turn without end (continuous ones and
those with play) have their *turned angle*, with all its turns, in x: the angle at the last accepted state, to
which every angle of the step from there is the nearest (:func:`antenna_pin.joints._kernels.unwrapped`).
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.contact._kernels import NORMAL_SIZE, elastic_energy
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

CONSTANT = 10.0
SINE = 11.0
TABLE = 12.0
GIVEN = 13.0  # a callable: Python writes its value before each evaluation
SPRING = 20.0

ONE_DOF = 0.0
CIRCLE = 1.0  # a continuous joint: (cos, sin)
CLEARANCE = 2.0

JOINT_KIND = 2
START_Q = 3
START_V = 4
START_X = 5
CLEARANCE_BLOCK = 6
ABOUT_JOURNAL = 7
TURN = 8
PARAMETERS = 9


@inlined
def drive_effort(p: Any, b: int, t: float) -> float:
    """Torque [N m] (force [N] at a prismatic joint) of the drive block at b."""
    kind = p[b]
    i = b + PARAMETERS
    if kind == SINE:
        return float(p[i] * math.sin(p[i + 1] * t + p[i + 2]))
    if kind == TABLE:
        n = int(p[i])
        knots = i + 1
        low = 0
        high = n - 1
        while high - low > 1:
            middle = (low + high) // 2
            if p[knots + middle] <= t:
                low = middle
            else:
                high = middle
        s = t - p[knots + low]
        c = knots + n + 4 * low
        return float(((p[c] * s + p[c + 1]) * s + p[c + 2]) * s + p[c + 3])
    return float(p[i])


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


@inlined
def _drive(p: Any, b: int, t: float, y: Any, nq: int, nv: int, tau: Any, rates: Any) -> None:
    """Add a drive's generalized force.

    At a clearance joint it is a couple about the bearing's or the journal's axis.
    """
    effort = drive_effort(p, b, t)
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
        if p[b + ABOUT_JOURNAL] == 0.0:
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
    x = nv + int(p[b + START_X])
    rates[x] = power
    rates[x + 1] = abs(power)


@kernel
def spring_deflection(p: Any, b: int, angle: float) -> float:
    """Angle of a spring block's joint from rest; the shorter way round if it asks for that."""
    turned = float(angle - p[b + PARAMETERS + 2])
    if p[b + PARAMETERS + 3] != 0.0:
        return unwrapped(turned, 0.0)
    return turned


@kernel
def _spring(p: Any, b: int, y: Any, nq: int, nv: int, tau: Any, rates: Any) -> None:
    """Add a spring and damper; at a clearance joint the force that derives from the motion angle."""
    angle, rate, gx, gy = joint_motion(p, b, y, nq)
    damping = p[b + PARAMETERS + 1] * rate
    effort = -p[b + PARAMETERS] * spring_deflection(p, b, angle) - damping
    j = int(p[b + START_V])
    c = int(p[b + CLEARANCE_BLOCK])
    if c < 0:
        tau[j] += effort
    elif p[c] == PLANAR:
        tau[j + 2] += effort
    else:
        a = c + joint.AXES
        for k in range(3):
            tau[j + 3 + k] += effort * (gx * p[a + 3 * k] + gy * p[a + 3 * k + 1] + p[a + 3 * k + 2])
    rates[nv + int(p[b + START_X])] = damping * rate


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
        elif kind < SPRING:
            _drive(program, b, t, y, nq, nv, tau, rates)
        else:
            _spring(program, b, y, nq, nv, tau, rates)
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
        elif kind == SPRING:
            angle, _, _, _ = joint_motion(program, b, y, nq)
            turned = spring_deflection(program, b, angle)
            springs += 0.5 * program[b + PARAMETERS] * turned * turned
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
