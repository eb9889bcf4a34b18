"""Gap, depth rate and force of a contact anywhere in a trial step, compiled."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.records import Contact, Floats, Ints, Memory, Pose, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.kernels import HEADER, block_at, head_of
from antenna_pin.dynamics.outside_kernels import Outside, ask, ask_at
from antenna_pin.integrate.kernels import dense_joint
from antenna_pin.integrate.manifold_kernels import factor_of
from antenna_pin.joints.kernels import (
    apart_motion,
    contact_forces,
    contact_geometry,
    contact_motion,
    contact_rates,
    normal_force_of,
)
from antenna_pin.joints.layout_kernels import CLEARANCE, FORCES_GIVEN, joint_at
from antenna_pin.joints.pose_kernels import journal_state

# What is known of a contact at a point of a step.
# (Typed, or all that is called with one is compiled for each.)
GAP: Any = np.int64(0)
DEPTH_RATE: Any = np.int64(1)
NORMAL_FORCE: Any = np.int64(2)
ALL: Any = np.int64(-1)


@by_address
class TrialStep(NamedTuple):
    """Trial step under inspection: its dense output and scratch arrays."""

    layout: Ints  # layout of the joints with play, part of the manifold's
    dense: Floats  # coefficients of the dense output
    work: Floats  # the stepper's rows
    start: int  # row of the step's start
    program: Floats  # the system's program
    memory: Records[Memory]  # contact memory during the step, MEMORY, (contacts,)
    out: Floats  # A state, as far as the layout goes, and scratch, (2, size)
    pose: Records[Pose]  # of one journal, POSE, (1,)
    table: Records[Contact]  # contact table, CONTACT, written
    own: Records[Contact]  # contact table of the derivative
    rates: Floats  # output without use
    outside: Outside  # callbacks for measured gaps and laws in Python


@inlined
def _look(b: int, y: Floats, nq: int, nv: int, trial: TrialStep) -> None:
    """Fill the contact table of the joint block at b, with normal forces."""
    program, pose, table, memory = trial.program, trial.pose[0], trial.table, trial.memory
    j = joint_at(program, b)
    journal_state(j, y, nq, pose)
    if j.distributed != 0:
        contact_geometry(program, b, pose, table)
        contact_rates(program, b, pose, table)
        if j.mode < FORCES_GIVEN:
            contact_forces(program, b, y, nq + nv, memory, table, trial.rates, nv)
        return
    for k in range(j.contacts):
        contact_motion(program, b, k, pose, table)
        if j.mode < FORCES_GIVEN:
            normal_force_of(program, b, k, memory, table)


@inlined
def _ask_outside(y: Floats, contact: int, with_forces: bool, trial: TrialStep) -> None:
    """Evaluate what no kernel computes for a contact, or for all (-1).

    The state is whole, or that of the contact's joint.
    """
    outside, asked = trial.outside, trial.outside.asked[0]
    if asked.gaps == 0 and asked.forces == 0:
        return
    asked.contact = contact
    if asked.gaps != 0:
        ask_at(outside, asked.gaps, 0.0, y)
    if asked.forces != 0 and with_forces:
        ask(outside, asked.forces, 0.0)


@inlined
def contacts_at(theta: float, trial: TrialStep) -> None:
    """Fill the contact table at the fraction theta of a step, normal forces included."""
    program, layout = trial.program, trial.layout
    head = head_of(program)
    nq, nv = head.nq, head.nv
    b = HEADER
    number = 0  # of the joint with play: the layout lists them in the order of their blocks
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        if j.contacts > 0:  # of those that are held or carried, which have none, the layout knows nothing
            factor = factor_of(layout, number)
            dense_joint(theta, factor, nq, nv, trial.dense, trial.work, trial.start, trial.out)
            _look(b, trial.out[0], nq, nv, trial)
        number += 1
        b += j.length
    _ask_outside(trial.out[0], ALL, True, trial)


@kernel
def contacts_of(row: int, trial: TrialStep) -> None:
    """Fill the contact table for the state in a stepper row, normal forces included."""
    program = trial.program
    head = head_of(program)
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        _look(b, trial.work[row], head.nq, head.nv, trial)
        b += joint_at(program, b).length
    _ask_outside(trial.work[row], ALL, True, trial)


@inlined
def apart_contacts_of(row: int, trial: TrialStep) -> None:
    """Fill the contact table of separated contacts for the state in a stepper row."""
    program, memory = trial.program, trial.memory
    head = head_of(program)
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        apart = False
        for r in range(j.row, j.row + j.contacts):
            apart = apart or memory[r].touching == 0.0
        if apart:
            journal_state(j, trial.work[row], head.nq, trial.pose[0])
            apart_motion(program, b, trial.pose[0], memory, trial.table)
        b += j.length


@kernel
def contacts_in(y: Floats, program: Floats, pose: Records[Pose], table: Records[Contact]) -> None:
    """Fill gap, normal, point, depth rate and slip of all contacts in closed form."""
    nq = head_of(program).nq
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        journal_state(j, y, nq, pose[0])
        contact_geometry(program, b, pose[0], table)
        contact_rates(program, b, pose[0], table)
        b += j.length


@kernel
def locate(
    y: Floats, program: Floats, pose: Records[Pose], table: Records[Contact], outside: Outside
) -> None:
    """Fill the contact table of a run as :func:`contacts_in`, gaps that a backend measures included."""
    contacts_in(y, program, pose, table)
    asked = outside.asked[0]
    if asked.gaps != 0:
        asked.contact = ALL
        ask_at(outside, asked.gaps, 0.0, y)


@kernel
def value_at(column: int, theta: float, c: int, trial: TrialStep) -> float:
    """Gap, depth rate or normal force of contact c at theta.

    Of laws in Python forces are there only where they are requested.
    """
    program, table = trial.program, trial.table
    head = head_of(program)
    nq, nv = head.nq, head.nv
    b = HEADER
    number = 0
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        if j.row <= c < j.row + j.contacts:
            factor, y = factor_of(trial.layout, number), trial.out[0]
            dense_joint(theta, factor, nq, nv, trial.dense, trial.work, trial.start, trial.out)
            if j.distributed != 0:
                _look(b, y, nq, nv, trial)
            else:
                journal_state(j, y, nq, trial.pose[0])
                contact_motion(program, b, c - j.row, trial.pose[0], table)
                if column == NORMAL_FORCE and j.mode < FORCES_GIVEN:
                    normal_force_of(program, b, c - j.row, trial.memory, table)
        number += 1
        b += j.length
    _ask_outside(trial.out[0], c, column == NORMAL_FORCE, trial)
    row = table[c]
    if column == GAP:
        return float(row.gap)
    if column == DEPTH_RATE:
        return float(row.rate)
    return float(row.force)


@kernel
def root_of(
    column: int, c: int, low: float, high: float, f_low: float, f_high: float, level: float, trial: TrialStep
) -> float:
    """Return the fraction of a column's level crossing: bisection with regula falsi (Illinois).

    ``f_low`` and ``f_high`` are the column less the level there, of opposite signs.
    """
    side = 0
    a, b, fa, fb = low, high, f_low, f_high
    for _ in range(100):
        if b - a <= 1e-15 * (1.0 + b):
            break
        m = (a * fb - b * fa) / (fb - fa) if fb != fa else 0.5 * (a + b)
        if not a < m < b:
            m = 0.5 * (a + b)
            if not a < m < b:
                break
        fm = value_at(column, m, c, trial) - level
        if fm == 0.0:
            return m
        if (fm > 0.0) == (fb > 0.0):
            b, fb = m, fm
            if side == 1:
                fa *= 0.5
            side = 1
        else:
            a, fa = m, fm
            if side == -1:
                fb *= 0.5
            side = -1
    return 0.5 * (a + b)


@inlined
def rise_of_tangents(at_start: float, at_end: float, rate: float, end_rate: float, width: float) -> float:
    """Return the height of the end tangents' intersection: an upper bound for concave curves."""
    return rate * (at_end - at_start - end_rate * width) / (rate - end_rate)
