"""Closures and motions in a compiled step: its end brought onto them, and the energy of that booked.

What :class:`antenna_pin.constraints.Constraints` does by the same kernels, for a state inside compiled code.
"""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined, kernel
from antenna_pin.constraints._layout_kernels import found_in, plan_of
from antenna_pin.constraints._rows_kernels import write_rows
from antenna_pin.constraints._solve_kernels import CLOSED, NEAR, OPEN, ROUNDS, correction, factorize
from antenna_pin.dynamics._audit_kernels import audit_state
from antenna_pin.dynamics._kernels import head_of, stored_energy
from antenna_pin.dynamics._point_kernels import stored
from antenna_pin.dynamics._trial_kernels import contacts_in
from antenna_pin.integrate._manifold_kernels import move_by_velocity
from antenna_pin.mechanism._mass_kernels import mass_and_bias

# What bringing a state onto the constraints came to.
AS_IT_WAS = 0
MOVED = 1
LOST = 2


@inlined
def _in_place(plan: Any, work: Any) -> bool:
    found = found_in(plan, work)
    return bool(found.gap <= CLOSED * plan_of(plan).length and found.turn <= CLOSED)


@inlined
def _in_motion(plan: Any, work: Any) -> bool:
    found = found_in(plan, work)
    return bool(found.speed <= CLOSED * plan_of(plan).length and found.spin <= CLOSED)


@kernel
def close(t: float, rows: Any, r: int, layout: Any, numbers: Any) -> bool:
    """Bring the state rows[r] onto the constraints, in place; return whether it is closed."""
    y = rows[r]
    plan, work = numbers.plan, numbers.held
    head = plan_of(plan)
    nq, nv, length = head.nq, head.nv, head.length
    write_rows(t, y, numbers.program, plan, work)
    found = found_in(plan, work)
    at_rest = _in_place(plan, work)
    last = max(found.gap, found.turn * length)
    near = last < NEAR * length
    mass_and_bias(y, nq, numbers.tree, numbers.gravity, numbers.room, numbers.mass, numbers.bias)
    factorize(plan, work, numbers.mass)
    for _ in range(ROUNDS):
        if at_rest:
            break
        correction(plan, work, False, numbers.step)
        move_by_velocity(layout, rows, r, numbers.step)
        write_rows(t, y, numbers.program, plan, work)
        now = max(found.gap, found.turn * length)
        at_rest = _in_place(plan, work) or now > 0.5 * last
        last = now
        if not near:
            mass_and_bias(y, nq, numbers.tree, numbers.gravity, numbers.room, numbers.mass, numbers.bias)
            factorize(plan, work, numbers.mass)
    correction(plan, work, True, numbers.step)
    for k in range(nv):
        y[nq + k] += numbers.step[k]
    return bool(last <= OPEN * length)


@kernel
def _energy(y: Any, numbers: Any) -> float:
    """Energy that a state stores, with the contact memory as it is [J]."""
    program = numbers.program
    head = head_of(program)
    contacts_in(y, program, numbers.pose, numbers.table)
    audit_state(y, head.nq, numbers.tree, numbers.gravity, numbers.places, numbers.audit)
    contacts, springs = stored_energy(y, program, numbers.memory, numbers.table)
    springs += stored(program, numbers.places)
    audit = numbers.audit[0]
    return float(audit.kinetic + audit.gravity + contacts + springs)


@kernel
def project(t: float, rows: Any, r: int, layout: Any, numbers: Any) -> int:
    """Bring rows[r], a step's end, onto the constraints, in place, and book the energy; return what came."""
    y = rows[r]
    plan, work = numbers.plan, numbers.held
    write_rows(t, y, numbers.program, plan, work)
    if _in_place(plan, work) and _in_motion(plan, work):
        return AS_IT_WAS
    before = _energy(y, numbers)
    if not close(t, rows, r, layout, numbers):
        return LOST
    y[numbers.booked] += _energy(y, numbers) - before
    return MOVED
