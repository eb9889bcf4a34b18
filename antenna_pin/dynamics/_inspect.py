"""What happens to the contacts inside an accepted trial step, from its dense output, compiled.

At ``NODES`` + 1 equally spaced points of the step each contact's gap, depth rate and force are computed. From
them follow the first change of contact (with the gaps that dipped and came back between two points), and the
largest force and depth of each touching contact, refined to the maxima of the dense output.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from antenna_pin._compile import inlined, kernel
from antenna_pin.dynamics._kernels import HEADER, block_at, head_of
from antenna_pin.integrate._kernels import START, STATE, dense_joint, dense_plain
from antenna_pin.integrate._manifold_kernels import factor_of
from antenna_pin.joints._kernels import contact_forces, contact_geometry, contact_rates
from antenna_pin.joints._layout_kernels import CLEARANCE, FORCES_GIVEN, joint_at
from antenna_pin.joints._pose_kernels import journal_state
from antenna_pin.records import layout

NODES = 4
# What is recorded of a contact while it lasts: largest force [N] and when [s], largest depth [m].
PEAK = layout(("force", "f8"), ("time", "f8"), ("depth", "f8"))
# What is known of each contact at the points of a step.
# (Typed, or all that is called with one is compiled for each.)
GAP: Any = np.int64(0)
DEPTH_RATE: Any = np.int64(1)
NORMAL_FORCE: Any = np.int64(2)
NODE_SIZE = 3
ALL: Any = np.int64(-1)


class Trial(NamedTuple):
    """A trial step as it is looked at: its dense output, and where the looking writes.

    Attributes:
        layout: Of the joints with play, a part of the manifold's.
        dense: Coefficients of the dense output.
        work: The stepper's rows.
        start: Which of them is the state that the step starts from.
        program: The system's.
        memory: Contact memory during the step, MEMORY, (contacts,).
        out: A state, as far as the layout goes, and scratch, (2, size).
        pose: Of one journal, POSE, (1,).
        table: Contact table, CONTACT, written.
        rates: Written, and of no use.
        measured: Which contacts are not looked at, for no closed form knows their gaps, (contacts,).
    """

    layout: Any
    dense: Any
    work: Any
    start: int
    program: Any
    memory: Any
    out: Any
    pose: Any
    table: Any
    rates: Any
    measured: Any


@inlined
def _look(b: int, y: Any, nq: int, nv: int, trial: Any) -> None:
    """Fill the contact table for the joint whose block stands at b and the state y, forces included."""
    program, pose, table = trial.program, trial.pose, trial.table
    j = joint_at(program, b)
    journal_state(j, y, nq, pose[0])
    contact_geometry(program, b, pose[0], table)
    contact_rates(program, b, pose[0], table)
    if j.mode < FORCES_GIVEN:
        contact_forces(program, b, y, nq + nv, trial.memory, table, trial.rates, nv)


@kernel
def contacts_at(theta: float, trial: Any, contact: int) -> None:
    """Fill the contact table at the fraction theta of a step, in closed form, with compiled laws' forces.

    Of a contact's joint, or of all if its number is negative.
    """
    program, layout = trial.program, trial.layout
    head = head_of(program)
    nq, nv = head.nq, head.nv
    dense_plain(theta, layout, trial.dense, trial.work, trial.start, trial.out)
    b = HEADER
    number = 0  # of the joint with play: the layout lists them in the order of their blocks
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        if contact < 0 or j.row <= contact < j.row + j.contacts:
            factor = factor_of(layout, number)
            dense_joint(theta, factor, nq, nv, trial.dense, trial.work, trial.start, trial.out)
            _look(b, trial.out[0], nq, nv, trial)
        number += 1
        b += j.length


@kernel
def _contacts_of(row: int, trial: Any) -> None:
    """Fill the contact table for the state in one of the stepper's rows."""
    program = trial.program
    head = head_of(program)
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        _look(b, trial.work[row], head.nq, head.nv, trial)
        b += joint_at(program, b).length


@kernel
def contacts_in(y: Any, program: Any, pose: Any, table: Any) -> None:
    """Fill gap, normal, point, depth rate and slip of all contacts in a state, in closed form."""
    nq = head_of(program).nq
    b = HEADER
    while b < program.shape[0] and block_at(program, b).kind == CLEARANCE:
        j = joint_at(program, b)
        journal_state(j, y, nq, pose[0])
        contact_geometry(program, b, pose[0], table)
        contact_rates(program, b, pose[0], table)
        b += j.length


@kernel
def _value(column: int, theta: float, c: int, trial: Any) -> float:
    """Gap, depth rate or normal force of contact c at theta."""
    contacts_at(theta, trial, c)
    row = trial.table[c]
    if column == GAP:
        return float(row.gap)
    if column == DEPTH_RATE:
        return float(row.rate)
    return float(row.force)


@kernel
def _root(
    column: int, c: int, low: float, high: float, f_low: float, f_high: float, level: float, trial: Any
) -> float:
    """Where a column is at a level, between two fractions: bisection with regula falsi (Illinois).

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
        fm = _value(column, m, c, trial) - level
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


@kernel
def _crossing(c: int, sign: float, level: float, h: float, nodes: Any, trial: Any) -> float:
    """First fraction at which the gap of contact c passes a level, or 2. sign = 1: upwards, -1: downwards.

    f = sign * (gap - level) is negative (or zero, at the start) before; f' has the sign of -sign * depth
    rate.
    """
    for k in range(NODES):
        a = k / NODES
        b = (k + 1) / NODES
        ga = nodes[GAP, k, c] - level
        gb = nodes[GAP, k + 1, c] - level
        ra = nodes[DEPTH_RATE, k, c]
        rb = nodes[DEPTH_RATE, k + 1, c]
        fa = sign * ga
        fb = sign * gb
        da = -sign * ra
        db = -sign * rb
        if fb > 0.0:
            if fa < 0.0:
                return _root(GAP, c, a, b, ga, gb, level, trial)
            # At the start, on the surface to round-off: does it dip to the right side first?
            if da < 0.0 < db:
                m = _root(DEPTH_RATE, c, a, b, ra, rb, 0.0, trial)
                gap = _value(GAP, m, c, trial) - level
                if sign * gap < 0.0:
                    return _root(GAP, c, m, b, gap, gb, level, trial)
            return a
        if da > 0.0 > db:
            # It may rise above zero in between; below the crossing of its end tangents it cannot be.
            if fa >= 0.0:
                return a
            w = h * (b - a)
            s = (fb - fa - db * w) / (da - db)
            if fa + 2.0 * da * s <= 0.0:  # twice the rise of the tangent: room for a changing curvature
                continue
            m = _root(DEPTH_RATE, c, a, b, ra, rb, 0.0, trial)
            gap = _value(GAP, m, c, trial) - level
            if sign * gap > 0.0:
                return _root(GAP, c, a, m, ga, gap, level, trial)
    return 2.0


@kernel
def fill_nodes(nodes: Any, trial: Any, from_last: bool) -> None:
    """Write gap, depth rate and force of each contact at the points of the step.

    ``nodes`` is (NODE_SIZE, NODES + 1, contacts). Its ends are the states themselves, not those of the dense
    output: so a step may take over (``from_last``) what the last one has found at its end, if nothing has
    changed since.
    """
    table = trial.table
    for k in range(NODES + 1):
        if k == 0 and from_last:
            for c in range(trial.memory.shape[0]):
                nodes[GAP, 0, c] = nodes[GAP, NODES, c]
                nodes[DEPTH_RATE, 0, c] = nodes[DEPTH_RATE, NODES, c]
                nodes[NORMAL_FORCE, 0, c] = nodes[NORMAL_FORCE, NODES, c]
            continue
        if k == 0:
            _contacts_of(trial.start, trial)
        elif k == NODES:
            _contacts_of(trial.start + STATE - START, trial)
        else:
            contacts_at(k / NODES, trial, ALL)
        for c in range(trial.memory.shape[0]):
            nodes[GAP, k, c] = table[c].gap
            nodes[DEPTH_RATE, k, c] = table[c].rate
            nodes[NORMAL_FORCE, k, c] = table[c].force


@kernel
def track_peaks(t: float, h: float, nodes: Any, peaks: Any, trial: Any) -> None:
    """Raise the peaks of each touching contact (``PEAK``) to the maxima of this step's dense output."""
    memory = trial.memory
    ratio = 0.3819660112501051  # golden section
    for c in range(memory.shape[0]):
        if memory[c].touching == 0.0 or trial.measured[c]:
            continue
        peak = peaks[c]
        best = 0
        for k in range(1, NODES + 1):
            if nodes[NORMAL_FORCE, k, c] > nodes[NORMAL_FORCE, best, c]:
                best = k
        force = nodes[NORMAL_FORCE, best, c]
        if force > peak.force:
            peak.force = force
            peak.time = t + h * best / NODES
        refine = force > 0.0 and 1.05 * force > peak.force
        if refine and best == NODES:
            refine = _value(NORMAL_FORCE, 1.0 - 1e-3, c, trial) > force
        elif refine and best == 0:
            refine = _value(NORMAL_FORCE, 1e-3, c, trial) > force
        if refine:
            a = max(0.0, (best - 1) / NODES)
            b = min(1.0, (best + 1) / NODES)
            m1 = a + ratio * (b - a)
            m2 = b - ratio * (b - a)
            f1 = _value(NORMAL_FORCE, m1, c, trial)
            f2 = _value(NORMAL_FORCE, m2, c, trial)
            for _ in range(24):
                if f1 > f2:
                    b, m2, f2 = m2, m1, f1
                    m1 = a + ratio * (b - a)
                    f1 = _value(NORMAL_FORCE, m1, c, trial)
                else:
                    a, m1, f1 = m1, m2, f2
                    m2 = b - ratio * (b - a)
                    f2 = _value(NORMAL_FORCE, m2, c, trial)
            top = max(f1, f2)
            if top > peak.force:
                peak.force = top
                peak.time = t + h * (m1 if f1 > f2 else m2)
        for k in range(NODES + 1):
            if -nodes[GAP, k, c] > peak.depth:
                peak.depth = -nodes[GAP, k, c]
        for k in range(NODES):
            if nodes[DEPTH_RATE, k, c] > 0.0 > nodes[DEPTH_RATE, k + 1, c]:
                m = _root(
                    DEPTH_RATE,
                    c,
                    k / NODES,
                    (k + 1) / NODES,
                    nodes[DEPTH_RATE, k, c],
                    nodes[DEPTH_RATE, k + 1, c],
                    0.0,
                    trial,
                )
                depth = -_value(GAP, m, c, trial)
                if depth > peak.depth:
                    peak.depth = depth


@kernel
def inspect_step(
    t: float,
    h: float,
    until: float,
    nodes: Any,
    ignore: Any,
    limits: Any,
    peaks: Any,
    trial: Any,
    from_last: bool,
) -> tuple[int, float, bool]:
    """Return what happens first within the step: which contact, at what fraction, and whether it is too deep.

    If it is not too deep, past its limit, it changes: touches or parts. Where nothing happens before the
    fraction ``until`` that is -1 and ``until``; with an ``until`` of 2 such a step will be accepted as it is:
    then the peaks are tracked too.

    A contact marked 2 in ``ignore`` has changed twice at the start already: a third change there is not
    believed. ``from_last``: see :func:`fill_nodes`.
    """
    fill_nodes(nodes, trial, from_last)
    memory = trial.memory
    first = -1
    when = until
    deep = False
    for c in range(memory.shape[0]):
        if trial.measured[c]:
            continue
        touching = memory[c].touching != 0.0
        theta = _crossing(c, 1.0 if touching else -1.0, 0.0, h, nodes, trial)
        if theta < when and not (ignore[c] == 2 and theta == 0.0):
            first = c
            when = theta
            deep = False
        if touching:
            theta = _crossing(c, -1.0, -limits[c], h, nodes, trial)
            if theta < when:
                first = c
                when = theta
                deep = True
    if first < 0 and until > 1.0:
        track_peaks(t, h, nodes, peaks, trial)
    return first, when, deep
