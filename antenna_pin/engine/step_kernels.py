"""One step, compiled as a whole: the derivative of a tree, its stages, its error, its dense output.

What is not compiled is asked outside, by address: Pinocchio's dynamics of the tree, backends, laws and drives
in Python (:mod:`antenna_pin.dynamics.outside_kernels`).
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.constraints.layout_kernels import applied_in
from antenna_pin.constraints.loaded_kernels import solve
from antenna_pin.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.kernels import evaluate, head_of
from antenna_pin.dynamics.link_kernels import add_forces, write_wrenches
from antenna_pin.dynamics.outside_kernels import ask_at, has_failed
from antenna_pin.dynamics.query_kernels import has_queries, set_out_queries, take_in_queries
from antenna_pin.engine.hold_kernels import AS_IT_WAS, LOST, MOVED, factorize_rows, project
from antenna_pin.geometry.coal_kernels import MOST_QUERIES
from antenna_pin.integrate.explicit_kernels import ASK, error_of, go_on, go_on_dense, set_out, set_out_dense
from antenna_pin.integrate.kernels import RATES, STATE, bend
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.mechanism.dynamics_kernels import aba


@by_address
class Numbers(NamedTuple):
    """A system in numbers, and what one run works on.

    Attributes:
        program: Of its elements.
        work: Of :func:`antenna_pin.dynamics.kernels.evaluate`.
        tree: Its bodies, BODY.
        gravity: (3,) [m/s^2].
        room: Of the tree's dynamics, ROOM, (bodies + 1,).
        places: PLACE, (bodies + 1,), scratch.
        plan: Of the constraints, empty where there are none.
        held: Their work array.
        mass: Mass matrix, (nv, nv), scratch.
        bias: (nv,), scratch.
        step: (nv,), scratch.
        pose: POSE, (1,), scratch.
        table: A contact table, scratch.
        own: The contact table that the derivative writes.
        memory: The contact memory.
        rates: Derivatives, (2, nv + nx), scratch.
        force: Generalized force, (nv,), scratch.
        moved: A step's end before it was brought onto the constraints, (size,).
        flag: Whether it was moved, (1,).
        booked: Place in a state of the energy that this puts in.
        outside: What is asked outside.
    """

    program: Any
    work: Any
    tree: Any
    gravity: Any
    room: Any
    places: Any
    plan: Any
    held: Any
    mass: Any
    bias: Any
    step: Any
    pose: Any
    table: Any
    own: Any
    memory: Any
    rates: Any
    force: Any
    moved: Any
    flag: Any
    booked: int
    outside: Any


@inlined
def accelerate(t: float, y: Any, tau: Any, numbers: Any, rates: Any, written: bool) -> None:
    """Write the acceleration at time t [s] and state y under a generalized force into rates[:nv].

    ``written``: whether the rows of constraints, if there are any, are those of this state already.
    """
    if numbers.plan.shape[0] > 0:
        if not written:
            write_rows(t, y, numbers.program, numbers.plan, numbers.held)
        factorize_rows(t, y, numbers)
        solve(y, numbers.program, numbers.plan, numbers.held, tau, numbers.bias, rates)
        return
    outside = numbers.outside
    nv = tau.shape[0]
    if outside.asked[0].acceleration == 0:
        aba(y, head_of(numbers.program).nq, numbers.tree, numbers.gravity, tau, numbers.room, rates[:nv])
        return
    for k in range(nv):
        outside.effort[k] = tau[k]
    ask_at(outside, outside.asked[0].acceleration, t, y)
    for k in range(nv):
        rates[k] = outside.acceleration[k]


@inlined
def ask_elements(t: float, y: Any, numbers: Any) -> None:
    """Have what of the elements is not compiled done at time t [s] and state y, before they are evaluated."""
    asked = numbers.outside.asked[0]
    if asked.elements == 0:
        return
    due = asked.touching == 0
    for c in range(numbers.memory.shape[0]):
        due = due or numbers.memory[c].touching != 0.0
    if not due:
        return
    if not has_queries(numbers.program, numbers.work):
        ask_at(numbers.outside, asked.elements, t, y)
        return
    set_out_queries(y, numbers.program, numbers.work)
    for _ in range(MOST_QUERIES):
        ask_at(numbers.outside, asked.elements, t, y)
        if take_in_queries(y, numbers.program, numbers.work):
            return


@inlined
def derivative(t: float, y: Any, numbers: Any, rates: Any, written: bool) -> None:
    """Write [acceleration (nv), rate of x (nx)] at time t [s] and state y (see ``accelerate``)."""
    program = numbers.program
    head = head_of(program)
    tau = numbers.work[: head.nv]
    ask_elements(t, y, numbers)
    evaluate(t, y, program, numbers.work, rates)
    if head.points < program.shape[0]:
        add_forces(t, y, program, numbers.tree, numbers.places, tau, rates)
        if numbers.plan.shape[0] > 0:
            begin, behind = applied_in(numbers.plan)
            write_wrenches(program, numbers.places, numbers.held[begin:behind])
    accelerate(t, y, tau, numbers, rates, written)


@kernel
def end(t: float, layout: Any, work: Any, stages: int, numbers: Any) -> bool:
    """Bring a step's end at t [s] onto the constraints and evaluate it; return whether it is one."""
    y = work[stages + STATE]
    numbers.flag[0] = AS_IT_WAS
    if numbers.plan.shape[0] > 0:
        for k in range(numbers.moved.shape[0]):
            numbers.moved[k] = y[k]
        numbers.flag[0] = project(t, work, stages + STATE, layout, numbers)
        if numbers.flag[0] == LOST:
            return False
    derivative(t, y, numbers, work[stages + RATES, : numbers.rates.shape[1]], True)
    return not has_failed(numbers.outside)


@kernel
def attempt(
    t: float, h: float, tableau: Any, layout: Any, work: Any, scales: Any, rtol: float, numbers: Any
) -> float:
    """Try a step of size h [s] from the start in the work rows; return its scaled error."""
    space, stages = space_of(layout), tableau.weights.shape[0]
    y, out = work[stages + STATE], work[stages + RATES, : space.nv + space.nx]
    set_out(tableau)
    while go_on(t, h, tableau, layout, work) == ASK:
        derivative(tableau.course[0].t, y, numbers, out, False)
        if has_failed(numbers.outside):
            return math.nan
    if not end(t + h, layout, work, stages, numbers):
        return math.nan
    return float(error_of(h, tableau, layout, work, scales, rtol))


@kernel
def prepare_dense(
    t: float, h: float, tableau: Any, layout: Any, work: Any, dense: Any, kept: Any, numbers: Any
) -> int:
    """Write the dense output of a step; return how often the derivative was asked.

    ``kept``, (2, size), holds the step's end meanwhile.
    """
    space, stages = space_of(layout), tableau.weights.shape[0]
    y, out = work[stages + STATE], work[stages + RATES, : space.nv + space.nx]
    set_out_dense(tableau, layout, work, kept)
    asked = 0
    while go_on_dense(t, h, tableau, layout, work, dense, kept) == ASK:
        derivative(tableau.course[0].t, y, numbers, out, False)
        asked += 1
    if numbers.flag[0] == MOVED:
        bend(layout, numbers.moved, y, dense)
    return asked
