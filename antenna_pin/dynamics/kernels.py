"""Force elements of a system as one flat program, compiled.

``program`` is a list of blocks after its head (:data:`antenna_pin.base.records.PROGRAM`). A block begins with
its kind and length (:data:`antenna_pin.base.records.BLOCK`): a clearance joint
(:mod:`antenna_pin.joints.layout_kernels`), or an element at a joint, of one of the kinds of
:mod:`antenna_pin.elements`: ``ELEMENT``, then the record of its kind. Elements on links
(:mod:`antenna_pin.dynamics.link_kernels`) follow, with a separate pass.

A configuration gives an angle up to whole turns. Joints without limits (continuous ones and those with play)
have their *turned angle*, with all turns, in x: that at the last accepted state, to which angles of the step
from there are the nearest (:func:`antenna_pin.mechanism.tree_kernels.unwrapped`).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin.base.records import (
    BLOCK,
    CIRCLE,
    CONTACT,
    MEMORY,
    POSE,
    PROGRAM,
    Block,
    Contact,
    Floats,
    Memory,
    Pose,
    Program,
    Record,
    Records,
    Triple,
    layout,
    words_of,
)
from antenna_pin.compiled.decorators import deferred, inlined, kernel, record
from antenna_pin.elements import kernels as elements
from antenna_pin.joints.kernels import clearance_joint, joint_energy
from antenna_pin.joints.layout_kernels import CLEARANCE, FORCES_GIVEN, JointRecord, joint_at
from antenna_pin.joints.pose_kernels import (
    along_bearing,
    axis_of_parent,
    journal_centre,
    journal_place,
    journal_state,
    motion_angle,
    onto_joint,
)
from antenna_pin.mechanism.tree_kernels import unwrapped

# Typed: Numba gives a plain constant a type of its own, and compiles all callees once more for it.
HEADER: Any = np.int64(words_of(PROGRAM))
BLOCK_WORDS = words_of(BLOCK)
POSE_WORDS = words_of(POSE)
MEMORY_WORDS = words_of(MEMORY)
CONTACT_WORDS = words_of(CONTACT)

# Axis of an element at a joint with play, by its number.
ABOUTS = ("bearing", "journal", "motion", "pose")
ABOUT_JOURNAL, ABOUT_MOTION, ABOUT_POSE = 1, 2, 3


class ElementHead(Record):
    """The head of an element at a joint."""

    kind: int  # kind of the element
    length: int  # length of its block, in 8-byte words
    joint: int  # motion of the joint (FIXED_AXIS, ...), if it has no play
    q: int  # start of the joint's slice of q
    v: int  # start of the joint's slice of v
    x: int  # start of the element's own slice of x
    play: int  # block of the joint with play; -1: none
    about: int  # axis about which it acts
    turn: int  # place of the turned angle in x; -1: none
    senses: int  # 1: it depends on the joint's motion
    partner: int  # distance to the head of the output
    sensed: int  # distance to the head of another joint
    on: float  # 1: acts


ELEMENT = layout(ElementHead)
PARAMETERS = words_of(ELEMENT)


@inlined
def head_of(program: Floats) -> Program:
    """Return a program's head."""
    return record(program[:HEADER], PROGRAM)


@inlined
def block_at(program: Floats, b: int) -> Block:
    """Return what the block at program[b:] is and how long."""
    return record(program[b : b + BLOCK_WORDS], BLOCK)


@inlined
def element_at(program: Floats, b: int) -> ElementHead:
    """Return the head of the element at program[b:]."""
    return record(program[b : b + PARAMETERS], ELEMENT)


@kernel
def joint_motion(p: Floats, b: int, y: Floats, nq: int) -> tuple[float, float, float, float]:
    """Angle (or displacement) and rate of an element's joint, and their slopes.

    For an element at a joint gx and gy of :func:`motion_angle`; for one between two joints its deflection,
    the rate of that, and its derivatives over the positions of the two.
    """
    e = element_at(p, b)
    angle, rate, gx, gy = own_motion(p, b + e.sensed, y, nq)
    if e.partner == 0:
        return angle, rate, gx, gy
    other, other_rate, _, _ = own_motion(p, b + e.partner, y, nq)
    x, speed, over, over_other = elements.between(e.kind, p, b + PARAMETERS, angle, rate, other, other_rate)
    return x, speed, over, over_other


@kernel
def own_motion(p: Floats, b: int, y: Floats, nq: int) -> tuple[float, float, float, float]:
    """Return angle (or position) and rate of a head's joint, with gx, gy."""
    e = element_at(p, b)
    k = nq + e.v
    if e.play < 0 and e.joint != CIRCLE:
        return y[e.q], y[k], 0.0, 0.0
    x0 = nq + head_of(p).nv
    if e.play < 0:
        return unwrapped(math.atan2(y[e.q + 1], y[e.q]), y[x0 + e.turn]), y[k], 0.0, 0.0
    j = joint_at(p, e.play)
    if j.slides != 0:
        way, gx, gy, gz, hx, hy, hz = along_bearing(j, y)
        rate = gx * y[k] + gy * y[k + 1] + gz * y[k + 2] + hx * y[k + 3] + hy * y[k + 4] + hz * y[k + 5]
        return way, rate, 0.0, 0.0
    angle, gx, gy = motion_angle(j, y, x0)
    if j.planar != 0:
        return angle, y[k + 2], 0.0, 0.0
    wx = j.axes[0, 0] * y[k + 3] + j.axes[1, 0] * y[k + 4] + j.axes[2, 0] * y[k + 5]
    wy = j.axes[0, 1] * y[k + 3] + j.axes[1, 1] * y[k + 4] + j.axes[2, 1] * y[k + 5]
    wz = j.axes[0, 2] * y[k + 3] + j.axes[1, 2] * y[k + 4] + j.axes[2, 2] * y[k + 5]
    return angle, gx * wx + gy * wy + wz, gx, gy


@kernel
def element_state(p: Floats, b: int, t: float, y: Floats, nq: int) -> Triple:
    """Return the element's effort at b, its reference and error, NaN without."""
    angle, rate, _, _ = joint_motion(p, b, y, nq)
    e = element_at(p, b)
    wanted, _ = elements.reference(e.kind, p, b + PARAMETERS, t)
    effort = effort_at(p, b, (t, angle, rate), (y, nq + head_of(p).nv + e.x))
    return effort, wanted, wanted - angle


@kernel
def element_kink(p: Floats, b: int, k: int, t: float, y: Floats) -> float:
    """Function k of the element block at b that passes zero where it has kinks."""
    head, e = head_of(p), element_at(p, b)
    angle, rate, _, _ = joint_motion(p, b, y, head.nq)
    own = y, head.nq + head.nv + e.x
    return float(elements.kink_of(e.kind, p, b + PARAMETERS, k, (t, angle, rate), own))


@kernel
def element_switch(p: Floats, b: int, k: int, t: float, y: Floats, load: float) -> tuple[float, float]:
    """Return function k of the element block at b, and its rate (0: unknown).

    The function is positive as long as the mode lasts.

    ``load`` is the torque that its row carries [N m] (force [N]), 0 where it holds nothing.
    """
    angle, rate, _, _ = joint_motion(p, b, y, head_of(p).nq)
    e = element_at(p, b)
    if e.on == 0.0:
        return 1.0, 0.0
    value, slope = elements.switch(e.kind, p, b + PARAMETERS, k, (t, angle, rate, load))
    return float(value), float(slope)


@inlined
def effort_at(p: Floats, b: int, motion: Triple, own: tuple[Floats, int]) -> float:
    """Return effort of the element block at b from time, joint position and rate."""
    e = element_at(p, b)
    return float(e.on * elements.effort_of(e.kind, p, b + PARAMETERS, motion, own))


@inlined
def book_at(p: Floats, b: int, motion: Triple, own: tuple[Floats, int], rates: Floats, x: int) -> None:
    """Write the rates of the integrals of the element block at b."""
    e = element_at(p, b)
    angle, rate, power = motion
    elements.write_rates_of(e.kind, p, b + PARAMETERS, (angle, e.on * rate, power), own, rates, x)


@inlined
def _element(p: Floats, b: int, t: float, y: Floats, head: Program, tau: Floats, rates: Floats) -> None:
    """Add an element's generalized force.

    At a clearance joint it is a couple about the bearing's or the journal's axis, or the gradient of the
    motion angle; at a sliding one a force along the axis, at the journal's centre.
    """
    e, nq = element_at(p, b), head.nq
    if e.partner != 0:
        _between(p, b, t, y, head, tau, rates)
        return
    angle, rate, gx, gy = 0.0, 0.0, 0.0, 0.0
    if e.senses != 0:
        angle, rate, gx, gy = own_motion(p, b, y, nq)
    if e.sensed != 0:
        angle, rate, _, _ = own_motion(p, b + e.sensed, y, nq)
    own = y, nq + head.nv + e.x
    effort = effort_at(p, b, (t, angle, rate), own)
    power = effort * act_at(p, b, effort, (gx, gy), y, nq, tau)
    book_at(p, b, (angle, rate, power), own, rates, head.nv + e.x)


@inlined
def act_at(
    p: Floats, b: int, effort: float, slope: tuple[float, float], y: Floats, nq: int, tau: Floats
) -> float:
    """Add an effort at a head's joint to tau; return its working rate."""
    e = element_at(p, b)
    if e.play < 0:
        tau[e.v] += effort
        return float(y[nq + e.v])
    j = joint_at(p, e.play)
    if j.planar != 0:
        tau[e.v + 2] += effort
        return float(y[nq + e.v + 2])
    return float(_push(j, e, effort, slope, y, nq, tau))


@deferred
def _between(p: Floats, b: int, t: float, y: Floats, head: Program, tau: Floats, rates: Floats) -> None:
    """Add the generalized force of a two-joint element; write its loss and impulse rates."""
    e, nq = element_at(p, b), head.nq
    angle, rate, gx, gy = own_motion(p, b, y, nq)
    other, other_rate, ox, oy = own_motion(p, b + e.partner, y, nq)
    seen = angle, rate, other, other_rate
    effort, other_effort = efforts_between(p, b, t, seen, rates, head.nv + e.x)
    act_at(p, b, effort, (gx, gy), y, nq, tau)
    act_at(p, b + e.partner, other_effort, (ox, oy), y, nq, tau)


@inlined
def efforts_between(
    p: Floats, b: int, t: float, motion: tuple[float, float, float, float], rates: Floats, x: int
) -> tuple[float, float]:
    """Return efforts of an element at its two joints; write its rates of x."""
    e, at = element_at(p, b), b + PARAMETERS
    angle, rate, other, other_rate = motion
    deflection, speed, over, over_other = elements.between(e.kind, p, at, angle, rate, other, other_rate)
    effort = e.on * elements.effort(e.kind, p, at, t, deflection, speed)
    drag = elements.drag(e.kind, p, at, effort * over, rate)
    rates[x] = e.on * elements.dissipation(e.kind, p, at, deflection, speed) - drag * rate
    rates[x + 1] = abs(effort)
    return effort * over + drag, effort * over_other


@kernel
def _push(
    j: JointRecord, e: ElementHead, effort: float, slope: tuple[float, float], y: Floats, nq: int, tau: Floats
) -> float:
    """Add an effort with a ``slope`` (gx, gy) to tau; return its working rate."""
    gx, gy = slope
    nx, ny, nz = j.axes[0, 2], j.axes[1, 2], j.axes[2, 2]
    if e.about == ABOUT_MOTION and j.slides == 0:
        nx += gx * j.axes[0, 0] + gy * j.axes[0, 1]
        ny += gx * j.axes[1, 0] + gy * j.axes[1, 1]
        nz += gx * j.axes[2, 0] + gy * j.axes[2, 1]
    elif (e.about == ABOUT_JOURNAL) == (j.on_child != 0):
        nx, ny, nz = axis_of_parent(j, y)
    k = e.v + 3
    rate = 0.0
    if j.slides != 0:
        cx, cy, cz = journal_centre(j, y)
        mx, my, mz = cy * nz - cz * ny, cz * nx - cx * nz, cx * ny - cy * nx
        tau[k] += effort * mx
        tau[k + 1] += effort * my
        tau[k + 2] += effort * mz
        rate = mx * y[nq + k] + my * y[nq + k + 1] + mz * y[nq + k + 2]
        k = e.v
    tau[k] += effort * nx
    tau[k + 1] += effort * ny
    tau[k + 2] += effort * nz
    return float(rate + nx * y[nq + k] + ny * y[nq + k + 1] + nz * y[nq + k + 2])


@inlined
def _bearing(p: Floats, b: int, y: Floats, head: Program, pose: Pose, tau: Floats, rates: Floats) -> None:
    """Add the generalized force of an element that acts on a journal's whole pose."""
    e = element_at(p, b)
    rates[head.nv + e.x] = 0.0
    if e.on == 0.0:
        return
    j = joint_at(p, e.play)
    journal_state(j, y, head.nq, pose)
    rates[head.nv + e.x] = elements.press(e.kind, p, b + PARAMETERS, pose)
    f, m = pose.force, pose.moment
    onto_joint(j, pose, (f[0], f[1], f[2]), (m[0], m[1], m[2]), tau)


@inlined
def element_forces(p: Floats, b: int, t: float, y: Floats, pose: Pose, tau: Floats, rates: Floats) -> None:
    """Add the generalized force of the joint element at b; write its rates of x."""
    if element_at(p, b).about == ABOUT_POSE:
        _bearing(p, b, y, head_of(p), pose, tau, rates)
    else:
        _element(p, b, t, y, head_of(p), tau, rates)


@inlined
def element_energy(p: Floats, b: int, y: Floats, nq: int) -> float:
    """Energy stored in the element block at b, whether it is on or not [J]."""
    e = element_at(p, b)
    if e.about == ABOUT_POSE:
        return float(
            elements.journal_energy(e.kind, p, b + PARAMETERS, journal_place(joint_at(p, e.play), y))
        )
    own = y, nq + head_of(p).nv + e.x
    return float(elements.stored_of(e.kind, p, b + PARAMETERS, joint_motion(p, b, y, nq)[0], own))


@kernel
def evaluate(t: float, y: Floats, program: Floats, work: Floats, rates: Floats) -> None:
    """Write the generalized force of all elements into work, and their rates of x.

    ``work`` is [generalized force (nv), POSE, MEMORY (contacts), CONTACT (rows)] in one array, because each
    argument adds to the time of a call.
    """
    head = head_of(program)
    nq, nv = head.nq, head.nv
    tau = work[:nv]
    first = nv + POSE_WORDS
    pose = record(work[nv:first], POSE)
    second = first + MEMORY_WORDS * head.contacts
    memory = work[first:second].view(MEMORY)
    table = work[second : second + head.rows * CONTACT_WORDS].view(CONTACT)
    for k in range(nv):
        tau[k] = 0.0
    b = HEADER
    while b < head.points:
        block = block_at(program, b)
        if block.kind == CLEARANCE:
            clearance_joint(program, b, y, nq, nv, memory, table, pose, tau, rates)
        else:
            element_forces(program, b, t, y, pose, tau, rates)
        b += block.length


@kernel
def stored_energy(
    y: Floats, program: Floats, memory: Records[Memory], table: Records[Contact]
) -> tuple[float, float]:
    """Return the energy stored in touching contacts and joint springs [J]."""
    head = head_of(program)
    nq = head.nq
    contacts = springs = 0.0
    b = HEADER
    while b < head.points:
        block = block_at(program, b)
        if block.kind == CLEARANCE:
            if joint_at(program, b).mode < FORCES_GIVEN:
                contacts += joint_energy(program, b, memory, table)
        else:
            e = element_at(program, b)
            if e.senses != 0:
                springs += e.on * element_energy(program, b, y, nq)
        b += block.length
    return contacts, springs
