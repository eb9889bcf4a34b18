"""Events of contacts inside an accepted trial step, from its dense output, compiled.

At ``NODES`` + 1 equally spaced points of the step each contact's gap, depth rate and force are computed. They
give the first change of contact (with gaps that dip and return between two points), and the largest force and
depth of each touching contact, refined to the maxima of the dense output.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Ints, Records
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.peak_kernels import NODES, Peak, track_peaks
from antenna_pin.dynamics.trial_kernels import (
    DEPTH_RATE,
    GAP,
    NORMAL_FORCE,
    TrialStep,
    apart_contacts_of,
    contacts_at,
    contacts_of,
    rise_of_tangents,
    root_of,
    value_at,
)
from antenna_pin.integrate.kernels import START, STATE

NODE_SIZE = 3


@inlined
def _may_cross(c: int, sign: float, level: float, nodes: Floats) -> bool:
    """Return whether a gap passes the level or reverses within the step."""
    for k in range(NODES):
        if sign * (nodes[GAP, k + 1, c] - level) > 0.0:
            return True
        if -sign * nodes[DEPTH_RATE, k, c] > 0.0 > -sign * nodes[DEPTH_RATE, k + 1, c]:
            return True
    return False


@kernel
def _crossing(c: int, sign: float, level: float, h: float, nodes: Floats, trial: TrialStep) -> float:
    """Return the first fraction at which gap c passes a level, or 2.

    The sign is 1 for upward and -1 for downward passes.

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
                return root_of(GAP, c, a, b, ga, gb, level, trial)
            # At the start, on the surface to round-off: does it dip to the right side first?
            if da < 0.0 < db:
                m = root_of(DEPTH_RATE, c, a, b, ra, rb, 0.0, trial)
                gap = value_at(GAP, m, c, trial) - level
                if sign * gap < 0.0:
                    return root_of(GAP, c, m, b, gap, gb, level, trial)
            return a
        if da > 0.0 > db:
            # It may rise above zero in between, but not beyond the crossing of its end tangents.
            if fa >= 0.0:
                return a
            w = h * (b - a)
            # Twice the rise of the tangents allows for a changing curvature.
            if fa + 2.0 * rise_of_tangents(fa, fb, da, db, w) <= 0.0:
                continue
            m = root_of(DEPTH_RATE, c, a, b, ra, rb, 0.0, trial)
            gap = value_at(GAP, m, c, trial) - level
            if sign * gap > 0.0:
                return root_of(GAP, c, a, m, ga, gap, level, trial)
    return 2.0


@kernel
def fill_nodes(nodes: Floats, trial: TrialStep, from_last: bool, at_end: bool) -> None:
    """Write gap, depth rate and force of each contact at the points of the step.

    ``nodes`` is (NODE_SIZE, NODES + 1, contacts). Its ends are the states themselves, not those of the dense
    output: so a step may reuse (``from_last``) the values at the end of the last one, if nothing has changed
    since, and (``at_end``) the derivative's touching contacts, if it was last evaluated at this one's end.
    """
    table = trial.table
    for k in range(NODES + 1):
        if k == NODES and at_end:
            _take_end(nodes, trial)
            continue
        if k == 0 and from_last:
            for c in range(trial.memory.shape[0]):
                nodes[GAP, 0, c] = nodes[GAP, NODES, c]
                nodes[DEPTH_RATE, 0, c] = nodes[DEPTH_RATE, NODES, c]
                nodes[NORMAL_FORCE, 0, c] = nodes[NORMAL_FORCE, NODES, c]
            continue
        if k == 0:
            contacts_of(trial.start, trial)
        elif k == NODES:
            contacts_of(trial.start + STATE - START, trial)
        else:
            contacts_at(k / NODES, trial)
        for c in range(trial.memory.shape[0]):
            nodes[GAP, k, c] = table[c].gap
            nodes[DEPTH_RATE, k, c] = table[c].rate
            nodes[NORMAL_FORCE, k, c] = table[c].force


@inlined
def _take_end(nodes: Floats, trial: TrialStep) -> None:
    """Write the last point from the evaluated state; only separated contacts are located."""
    apart_contacts_of(trial.start + STATE - START, trial)
    for c in range(trial.memory.shape[0]):
        touching = trial.memory[c].touching != 0.0
        row = trial.own[c] if touching else trial.table[c]
        nodes[GAP, NODES, c] = row.gap
        nodes[DEPTH_RATE, NODES, c] = row.rate
        nodes[NORMAL_FORCE, NODES, c] = row.force if touching else 0.0


@kernel
def inspect_step(
    t: float,
    h: float,
    until: float,
    nodes: Floats,
    ignore: Ints,
    limits: Floats,
    peaks: Records[Peak],
    trial: TrialStep,
    ends: tuple[bool, bool],
) -> tuple[int, float, bool]:
    """Return the first event within the step: contact, fraction, and whether too deep.

    If it is not too deep, past its limit, it changes: touches or parts. Without an event before the fraction
    ``until`` the result is -1 and ``until``; with an ``until`` of 2 such a step will be accepted: then peaks
    are tracked too.

    A contact marked 2 in ``ignore`` has changed twice at the start already: a third change there is ignored.
    ``ends``: flags of the known ends (``from_last`` and ``at_end`` of :func:`fill_nodes`).
    """
    fill_nodes(nodes, trial, ends[0], ends[1])
    memory = trial.memory
    first = -1
    when = until
    deep = False
    for c in range(memory.shape[0]):
        touching = memory[c].touching != 0.0
        sign = 1.0 if touching else -1.0
        theta = _crossing(c, sign, 0.0, h, nodes, trial) if _may_cross(c, sign, 0.0, nodes) else 2.0
        if theta < when and not (ignore[c] == 2 and theta == 0.0):
            first = c
            when = theta
            deep = False
        if touching and _may_cross(c, -1.0, -limits[c], nodes):
            theta = _crossing(c, -1.0, -limits[c], h, nodes, trial)
            if theta < when:
                first = c
                when = theta
                deep = True
    if first < 0 and until > 1.0:
        track_peaks(t, h, nodes, peaks, trial)
    return first, when, deep
