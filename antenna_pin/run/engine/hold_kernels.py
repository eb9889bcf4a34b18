"""Closures and motions in a compiled step: end correction and its energy.

The same kernels as in :class:`antenna_pin.dynamics.constraints.Constraints`, for a state inside compiled
code. Mass matrix and bias are those of the compiled tree, or of a callback.
"""

from __future__ import annotations

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.dynamics.audit_kernels import energy_of
from antenna_pin.dynamics.constraints.factor_kernels import factorize
from antenna_pin.dynamics.constraints.layout_kernels import PLACE_WORDS, found_in, plan_of
from antenna_pin.dynamics.constraints.rows_kernels import write_residuals, write_rows
from antenna_pin.dynamics.constraints.solve_kernels import CLOSED, NEAR, OPEN, ROUNDS, correction
from antenna_pin.dynamics.kernels import head_of, stored_energy
from antenna_pin.dynamics.link_kernels import stored
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.outside_kernels import ask_at
from antenna_pin.dynamics.trial_kernels import locate
from antenna_pin.integrate.manifold_kernels import move_by_velocity
from antenna_pin.mechanism.mass_kernels import mass_and_bias
from antenna_pin.mechanism.tree_kernels import PLACE

# Results of the projection of a state onto the constraints.
AS_IT_WAS = 0
MOVED = 1
LOST = 2


@inlined
def _in_place(plan: Floats, work: Floats) -> bool:
    found = found_in(plan, work)
    return bool(found.gap <= CLOSED * plan_of(plan).length and found.turn <= CLOSED)


@inlined
def _in_motion(plan: Floats, work: Floats) -> bool:
    found = found_in(plan, work)
    return bool(found.speed <= CLOSED * plan_of(plan).length and found.spin <= CLOSED)


@deferred
def factorize_rows(t: float, y: Floats, numbers: Numbers) -> None:
    """Factorize fresh rows with the mass matrix of the same state; write ``bias``."""
    plan, work, terms = numbers.plan, numbers.held, numbers.outside.asked[0].terms
    if terms != 0:
        ask_at(numbers.outside, terms, t, y)
    else:
        places = work[: PLACE_WORDS * (plan_of(plan).bodies + 1)].view(PLACE)
        mass_and_bias(numbers.tree, places, numbers.gravity, numbers.room, numbers.mass, numbers.bias)
    factorize(plan, work, numbers.mass)


@inlined
def set_motions(t: float, y: Floats, numbers: Numbers) -> None:
    """Write the numbers of Python motions at a time into the program."""
    motions = numbers.outside.asked[0].motions
    if motions != 0:
        ask_at(numbers.outside, motions, t, y)


@deferred
def close(t: float, rows: Floats, r: int, layout: Ints, numbers: Numbers) -> bool:
    """Bring the state rows[r] onto the constraints, in place; return whether it is closed."""
    set_motions(t, rows[r], numbers)
    write_rows(t, rows[r], numbers.program, numbers.plan, numbers.held)
    return _close(t, rows, r, layout, numbers)


@kernel
def _close(t: float, rows: Floats, r: int, layout: Ints, numbers: Numbers) -> bool:
    """Do what :func:`close` does for a state whose rows are written."""
    y = rows[r]
    plan, work = numbers.plan, numbers.held
    head, found = plan_of(plan), found_in(plan, work)
    nq, nv, length = head.nq, head.nv, head.length
    at_rest = _in_place(plan, work)
    last = max(found.gap, found.turn * length)
    near = last < NEAR * length
    factorize_rows(t, y, numbers)
    for _ in range(ROUNDS):
        if at_rest:
            break
        correction(plan, work, False, numbers.step)
        move_by_velocity(layout, rows, r, numbers.step)
        if near:
            write_residuals(t, y, numbers.program, plan, work)
        else:
            write_rows(t, y, numbers.program, plan, work)
        now = max(found.gap, found.turn * length)
        at_rest = _in_place(plan, work) or now > 0.5 * last
        last = now
        if not near:
            factorize_rows(t, y, numbers)
    correction(plan, work, True, numbers.step)
    for k in range(nv):
        y[nq + k] += numbers.step[k]
    return bool(last <= OPEN * length)


@kernel
def _energy(t: float, y: Floats, numbers: Numbers) -> float:
    """Return the energy stored in a state with written rows [J]."""
    program = numbers.program
    on_links = head_of(program).points < program.shape[0]
    if on_links:
        set_motions(t, y, numbers)  # elements on links in Python tell what they store
    places = numbers.held[: PLACE_WORDS * (plan_of(numbers.plan).bodies + 1)].view(PLACE)
    locate(y, program, numbers.pose, numbers.table, numbers.outside)
    contacts, springs = stored_energy(y, program, numbers.memory, numbers.table)
    if on_links:
        springs += stored(y, program, places)
    return float(energy_of(numbers.tree, places, numbers.gravity) + contacts + springs)


@deferred
def project(t: float, rows: Floats, r: int, layout: Ints, numbers: Numbers) -> int:
    """Project rows[r], a step's end, onto the constraints; book its energy; return status.

    The rows of constraints are written afterwards, unless the projection fails.
    """
    y = rows[r]
    plan, work = numbers.plan, numbers.held
    set_motions(t, y, numbers)
    write_rows(t, y, numbers.program, plan, work)
    if _in_place(plan, work) and _in_motion(plan, work):
        return AS_IT_WAS
    before = _energy(t, y, numbers)
    if not _close(t, rows, r, layout, numbers):
        return LOST
    write_rows(t, y, numbers.program, plan, work)
    y[numbers.booked] += _energy(t, y, numbers) - before
    return MOVED
