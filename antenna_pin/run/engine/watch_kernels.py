"""Coarse check of a step for possible events, compiled.

A watched function may pass zero where its sign at a point of a step differs from its side, or where it
approaches zero and recedes. Functions without a known rate, such as the load of a row, are interpolated:
their points are unevenly spaced, so that no drive is sampled at one phase only, and a further point checks
the interpolation. Where an event is possible, or the check fails, the outer loop searches the step; so the
check may report too many events, never too few.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from antenna_pin.base.records import Floats, Ints, Record, Records, layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import hold_at, plan_of
from antenna_pin.dynamics.kernels import element_kink, element_switch, evaluate, head_of, joint_motion
from antenna_pin.dynamics.link_kernels import kink_on_links
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.trial_kernels import locate
from antenna_pin.integrate.kernels import STATE_ROW, DenseStep, dense_state
from antenna_pin.run.engine.step_kernels import ask_elements, derivative

# Kinds of watched functions: of an element whose effort has a kink, angle (or displacement) of a joint, its
# rate, a gap, a normal force, of an element whose mode changes.
KINK = 0
ANGLE = 1
RATE = 2
GAP = 3
FORCE = 4
SWITCH = 5
# Function that needs its joint's reduced inertia, which only the outer loop computes: NaN here while it
# counts, so that steps are searched.
WEIGHED = -2

# Points of a step for a function without a rate, and for the check of its interpolation.
FIRST_POINT, SECOND_POINT, THIRD_POINT = 0.2113248654051871, 0.4721359549995796, 0.7886751345948129
CHECK_POINT = 0.6180339887498949
# Shares of the spread of its values: permitted error of the interpolation there, and nearness to zero.
_OFF, _NEAR = 0.05, 0.1
# Points at which the interpolation is evaluated.
_FINE = 16


class Watch(Record):
    """Something watched within steps."""

    what: int  # kind of the function
    where: int  # block of the element, of the joint in the watch's own program, or the contact
    value: float  # value to be passed
    side: float  # present side; 0: unknown
    parts: int  # inspected points of a step
    number: int  # number of the function, of a kink or a change of mode
    hold: int  # hold whose load a change of mode needs; -1: none, -2: WEIGHED


WATCHED = layout(Watch)


@by_address
class Watched(NamedTuple):
    """Watched functions other than contacts."""

    functions: Records[Watch]  # WATCHED, (n,)
    program: Floats  # program with a block for each watched joint
    rates: Floats  # scratch, (nv + nx,)
    instants: Floats  # required ends of steps for the outer loop, increasing [s]
    values: Floats  # value and rate, scratch, (2,)
    dips: Floats  # values of one function in a step, scratch, (6,)
    unknown: int  # number of functions that are not compiled


@kernel
def _look(w: Watch, t: float, y: Floats, numbers: Numbers, watched: Watched) -> None:
    """Write a function's deviation from its value at t [s], and its rate (0: unknown)."""
    program, out = numbers.program, watched.values
    nq = head_of(program).nq
    out[1] = 0.0
    if w.what == KINK and w.where >= head_of(program).points:
        ask_elements(t, y, numbers)
        out[0] = kink_on_links(t, y, program, w.where, numbers.tree, numbers.places)
    elif w.what == KINK:
        out[0] = element_kink(program, w.where, w.number, t, y)
    elif w.what == SWITCH:
        load = math.nan if w.hold == WEIGHED else 0.0
        if w.hold >= 0:
            derivative(t, y, numbers, watched.rates, False)
            plan, own = plan_of(numbers.plan), hold_at(numbers.plan, w.hold)
            load = numbers.held[plan.force + own.row] * (1.0 if own.slides != 0 else plan.length)
        out[0], out[1] = element_switch(program, w.where, w.number, t, y, load)
    elif w.what == ANGLE or w.what == RATE:
        angle, rate, _, _ = joint_motion(watched.program, w.where, y, nq)
        out[0] = angle if w.what == ANGLE else rate
        out[1] = rate if w.what == ANGLE else 0.0
    elif w.what == GAP:
        locate(y, program, numbers.pose, numbers.table, numbers.outside)
        out[0] = numbers.table[w.where].gap
        out[1] = -numbers.table[w.where].rate
    else:
        ask_elements(t, y, numbers)
        evaluate(t, y, program, numbers.work, watched.rates)
        memory = numbers.memory[w.where]
        out[0] = max(0.0, numbers.own[w.where].force) if memory.touching != 0.0 else 0.0
    out[0] -= w.value


@inlined
def interpolated(x: float, f: Floats) -> float:
    """Return the quartic interpolant's value through five points of a step."""
    a, b, c = FIRST_POINT, SECOND_POINT, THIRD_POINT
    return float(
        f[0] * (x - a) * (x - b) * (x - c) * (x - 1.0) / (a * b * c)
        + f[1] * x * (x - b) * (x - c) * (x - 1.0) / (a * (a - b) * (a - c) * (a - 1.0))
        + f[2] * x * (x - a) * (x - c) * (x - 1.0) / (b * (b - a) * (b - c) * (b - 1.0))
        + f[3] * x * (x - a) * (x - b) * (x - 1.0) / (c * (c - a) * (c - b) * (c - 1.0))
        + f[4] * x * (x - a) * (x - b) * (x - c) / ((1.0 - a) * (1.0 - b) * (1.0 - c))
    )


@kernel
def _may_dip(t: float, h: float, w: Watch, step: DenseStep, numbers: Numbers, watched: Watched) -> bool:
    """Return whether a function without a rate may reach zero in a step."""
    space, dense, work, start, out = step
    f = watched.dips
    f[0] = w.side * watched.values[0]
    least, most = f[0], f[0]
    for k in range(1, 6):
        theta = 1.0
        if k == 1:
            theta = FIRST_POINT
        elif k == 2:
            theta = SECOND_POINT
        elif k == 3:
            theta = THIRD_POINT
        elif k == 5:
            if most - least <= 1e-12 * abs(most):
                return False
            theta = CHECK_POINT
        dense_state(theta, space, dense, work, start, out)
        _look(w, t + theta * h, out[STATE_ROW], numbers, watched)
        f[k] = w.side * watched.values[0]
        if not f[k] > 0.0:
            return True
        least, most = min(least, f[k]), max(most, f[k])
    spread = most - least
    if abs(interpolated(CHECK_POINT, f) - f[5]) > _OFF * spread:
        return True
    for k in range(1, _FINE):
        if interpolated(k / _FINE, f) < _NEAR * spread:
            return True
    return False


@deferred
def may_happen(
    t: float,
    h: float,
    space: Ints,
    dense: Floats,
    work: Floats,
    start: int,
    out: Floats,
    numbers: Numbers,
    watched: Watched,
) -> bool:
    """Return whether a watched event is possible within the step from t [s]."""
    if watched.unknown > 0:
        return True
    for k in range(watched.instants.shape[0]):
        if t < watched.instants[k] <= t + h:
            return True
    for k in range(watched.functions.shape[0]):
        w = watched.functions[k]
        if w.side == 0.0:
            return True
        _look(w, t, work[start], numbers, watched)
        if not w.side * watched.values[0] > 0.0:
            return True
        before = w.side * watched.values[1]
        if w.what == SWITCH and before == 0.0:
            if _may_dip(t, h, w, (space, dense, work, start, out), numbers, watched):
                return True
            continue
        for part in range(1, w.parts + 1):
            theta = part / w.parts
            dense_state(theta, space, dense, work, start, out)
            _look(w, t + theta * h, out[STATE_ROW], numbers, watched)
            rate = w.side * watched.values[1]
            if not w.side * watched.values[0] > 0.0 or before < 0.0 < rate:
                return True
            before = rate
    return False
