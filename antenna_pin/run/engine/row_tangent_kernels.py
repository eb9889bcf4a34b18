"""Derivative of accelerations under constraints along displacements, compiled.

For M a + b = tau + J^T lambda, J a = lack, a displacement gives

    M da - J^T dlambda = dtau - D[M a + b - J^T lambda],    J da = -D[J a - lack],

with fixed a and lambda on the right: the equations of accelerations themselves, with their factors and
independent rows. Closures are differentiated in closed form
(:mod:`antenna_pin.dynamics.constraints.tangent_kernels`), motions with respect to time and parameters
separately.

``room`` is :class:`antenna_pin.dynamics.tangent_room_kernels.TangentRoom`.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.driven_kernels import change_motions, driven_rate
from antenna_pin.dynamics.constraints.factor_kernels import factorize
from antenna_pin.dynamics.constraints.layout_kernels import driven_at, plan_of
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.constraints.solve_kernels import solve_changes, solve_rows
from antenna_pin.dynamics.constraints.tangent_kernels import (
    change_ties,
    let_ties_rest,
    read_ties,
    shift_couplings,
    shift_ties,
)
from antenna_pin.dynamics.tangent_room_kernels import TangentRoom
from antenna_pin.elements import kernels as elements
from antenna_pin.elements.ledger_kernels import write_work_change
from antenna_pin.integrate.difference_kernels import (
    differentiated,
    displace_words,
    note_words,
    put_back_words,
)
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.tangent_kernels import read_bodies


@inlined
def has_rows(room: TangentRoom) -> bool:
    """Return whether constraints exist."""
    return bool(room.numbers.plan.shape[0] > 0)


@kernel
def prepare_rows(t: float, y: Floats, tau: Floats, room: TangentRoom) -> None:
    """Write motion, acceleration and factors of a constrained tree, with powers of motions."""
    numbers, rows, nv = room.numbers, room.rows, room.tau.shape[0]
    plan, work = numbers.plan, numbers.held
    write_rows(t, y, numbers.program, plan, work)
    mass_and_bias(numbers.tree, room.places, numbers.gravity, room.room, room.mass, rows.bias)
    factorize(plan, work, room.mass)
    solve_rows(y, numbers.program, plan, work, tau, rows.bias, room.rates)
    for k in range(nv):
        room.acceleration[k] = room.rates[k]
    head = plan_of(plan)
    for r in range(head.rows):
        rows.force[r] = work[head.force + r]
    read_bodies(y, head.nq, numbers.tree, room.places, numbers.gravity, room.acceleration, room.bodies)
    read_ties(plan, work, numbers.gravity, room.bodies, rows.ties)


@inlined
def _move_displaced(h: float, t: float, m: int, room: TangentRoom) -> None:
    """Write the accelerations of motions with number m displaced, or the time (-1)."""
    numbers, wanted = room.numbers, room.rows.wanted
    plan, program = numbers.plan, numbers.program
    if m >= 0:
        displace_words(program, room.shifts.program, m, h)
    for k in range(wanted.shape[0]):
        own = driven_at(plan, k)
        _, _, wanted[k] = elements.motion(own.kind, program, own.words, t if m >= 0 else t + h)


_differences = differentiated(_move_displaced)


@kernel
def _differentiate_motions(t: float, m: int, step: float, room: TangentRoom, out: Floats) -> None:
    """Write the derivatives of motions' accelerations over number m, or over time (-1), (kinds, motions)."""
    rows, words, program = room.rows, room.shifts.program, room.numbers.program
    count = plan_of(room.numbers.plan).motions
    if m >= 0:
        note_words(program, words, m)
    _differences(step, (0, count, count, count), (rows.wanted, room.weights, rows.trial), out, t, m, room)
    if m >= 0:
        put_back_words(program, words, m)


@inlined
def _write_motions(columns: Floats, plan: Floats, out: Floats) -> None:
    """Write derivatives of motions' accelerations by row, and their differences between orders."""
    head = plan_of(plan)
    for k in range(head.motions):
        own = driven_at(plan, k)
        scale = 1.0 if own.slides != 0 else head.length
        for kind in range(out.shape[0]):
            value = columns[kind, k] - (columns[0, k] if kind > 0 else 0.0)
            out[kind, own.row] = scale * value


@kernel
def differentiate_over_time(t: float, step: float, room: TangentRoom) -> None:
    """Write how motions' accelerations go with time."""
    _differentiate_motions(t, -1, step, room, room.rows.jerks)


@kernel
def shift_rows(t: float, m: int, room: TangentRoom, out: Floats) -> None:
    """Write changes of rows with number m, and add their forces.

    Args:
        t: Time [s].
        m: Index of the number.
        room: Arrays with the changes of bodies' motions and own wrenches; the effect of closures on the
            latter is subtracted.
        out: Change of tau + J^T lambda, (nv,).
    """
    numbers, rows, shifts = room.numbers, room.rows, room.shifts
    lacks = shifts.lacks[m]
    lacks[:] = 0.0
    shift_ties(numbers.plan, room.places, shifts.closures[m], rows.ties)
    change_ties(numbers.plan, room.bodies, rows.ties, lacks[0])
    let_ties_rest(rows.ties)
    shift_couplings(numbers.plan, shifts.couplings[m], rows.force, room.acceleration, lacks[0], out)
    if shifts.motions[m] != 0:
        _differentiate_motions(t, m, shifts.steps[m], room, rows.column)
        _write_motions(rows.column, numbers.plan, lacks)


@kernel
def change_rows(y: Floats, way: Floats, room: TangentRoom, out: Floats) -> None:
    """Write changes of rows along a displacement, and add their forces.

    Like :func:`shift_rows`, with the changes over time and numbers included.
    """
    numbers, rows, shifts = room.numbers, room.rows, room.shifts
    lacks, plan = rows.lacks, numbers.plan
    time = way[way.shape[0] - 1]
    lacks[:] = 0.0
    if time != 0.0:
        _write_motions(rows.jerks, plan, lacks)
        for kind in range(lacks.shape[0]):
            for r in range(lacks.shape[1]):
                lacks[kind, r] *= time
    for m in range(shifts.steps.shape[0]):
        share = way[room.first_number[0] + m]
        if share != 0.0 and shifts.heavy[m] != 0:
            for kind in range(lacks.shape[0]):
                for r in range(lacks.shape[1]):
                    lacks[kind, r] += share * shifts.lacks[m, kind, r]
    change_ties(plan, room.bodies, rows.ties, lacks[0])
    change_motions(y, way, room.acceleration, rows.force, plan, (lacks[0], rows.speeds, rows.twist), out)


@kernel
def solve_held(y: Floats, d: int, room: TangentRoom, out: Floats) -> None:
    """Write changes of accelerations along displacement d, and powers of motions.

    ``out``, (kinds, k, nv + nx), of all kinds of differences, holds the change by forces: of the first kind,
    and the differences of the others.
    """
    numbers, rows, nv = room.numbers, room.rows, room.tau.shape[0]
    plan, work = numbers.plan, numbers.held
    head = plan_of(plan)
    for kind in range(out.shape[0]):
        own, lacks = out[kind, d, :nv], rows.lacks[kind]
        differs = kind == 0
        for k in range(nv):
            differs = differs or own[k] != 0.0
        for r in range(head.rows):
            differs = differs or lacks[r] != 0.0
            work[head.lack + r] = lacks[r]
            rows.force_change[r] = 0.0
        if differs:
            solve_changes(plan, work, own, rows.force_change)
        for m in range(head.motions):
            driven = driven_at(plan, m)
            at, scale = nv + driven.x, 1.0 if driven.slides != 0 else head.length
            rate = driven_rate(y, plan, work, driven)
            force, change = rows.force[driven.row], rows.force_change[driven.row] * rate
            if kind == 0:
                change += force * rows.speeds[m]
            else:
                change += out[0, d, at] / scale
            write_work_change(force * rate, scale * change, out[kind, d], at)
    for kind in range(1, out.shape[0]):
        for k in range(nv):
            out[kind, d, k] += out[0, d, k]
