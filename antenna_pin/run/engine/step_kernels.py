"""Compiled step: derivative of a tree, stages, error and dense output.

Uncompiled parts are called by address: Pinocchio's dynamics of the tree, backends, laws and drives in Python
(:mod:`antenna_pin.dynamics.outside_kernels`).
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import applied_in
from antenna_pin.dynamics.constraints.loaded_kernels import solve
from antenna_pin.dynamics.constraints.rows_kernels import write_rows
from antenna_pin.dynamics.kernels import evaluate, head_of
from antenna_pin.dynamics.link_kernels import add_forces, write_wrenches
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.outside_kernels import ANSWERED, ask_at, has_failed
from antenna_pin.dynamics.query_kernels import (
    answer_queries,
    has_queries,
    set_out_queries,
    take_in_queries,
)
from antenna_pin.integrate.explicit_kernels import (
    ASK,
    Tableau,
    error_of,
    go_on,
    go_on_dense,
    set_out,
    set_out_dense,
)
from antenna_pin.integrate.kernels import RATES, STATE, bend
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.joints.geometry.coal_kernels import MOST_QUERIES
from antenna_pin.mechanism.dynamics_kernels import aba
from antenna_pin.run.engine.hold_kernels import AS_IT_WAS, LOST, MOVED, factorize_rows, project


@inlined
def accelerate(t: float, y: Floats, tau: Floats, numbers: Numbers, rates: Floats, written: bool) -> None:
    """Write acceleration at t [s] and y under a generalized force into rates[:nv].

    ``written``: whether the rows of constraints, if any, are already those of this state.
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
def ask_elements(t: float, y: Floats, numbers: Numbers) -> None:
    """Call back for uncompiled elements at t [s] and y, before their evaluation."""
    asked = numbers.outside.asked[0]
    if asked.queried != 0 and asked.failed == ANSWERED:
        asked.failed = answer_queries(y, numbers.program, numbers.work, False)
    if asked.elements == 0:
        return
    due = asked.touching == 0
    for c in range(numbers.memory.shape[0]):
        due = due or numbers.memory[c].touching != 0.0
    if not due:
        return
    if asked.queried != 0 or not has_queries(numbers.program, numbers.work):
        ask_at(numbers.outside, asked.elements, t, y)
        return
    set_out_queries(y, numbers.program, numbers.work)
    for _ in range(MOST_QUERIES):
        ask_at(numbers.outside, asked.elements, t, y)
        if take_in_queries(y, numbers.program, numbers.work):
            return


@inlined
def derivative(t: float, y: Floats, numbers: Numbers, rates: Floats, written: bool) -> None:
    """Write [acceleration (nv), rate of x (nx)] at t [s] and y."""
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
def end(t: float, layout: Ints, work: Floats, stages: int, numbers: Numbers) -> bool:
    """Project a step's end at t [s] onto the constraints and evaluate; return success."""
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
    t: float,
    h: float,
    tableau: Tableau,
    layout: Ints,
    work: Floats,
    scales: Floats,
    rtol: float,
    numbers: Numbers,
) -> float:
    """Try a step of size h [s] from the work rows; return its scaled error."""
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
    t: float,
    h: float,
    tableau: Tableau,
    layout: Ints,
    work: Floats,
    dense: Floats,
    scratch: Floats,
    numbers: Numbers,
) -> int:
    """Write the dense output of a step; return the number of evaluations.

    ``scratch``, (2, size), holds the step's end meanwhile.
    """
    space, stages = space_of(layout), tableau.weights.shape[0]
    y, out = work[stages + STATE], work[stages + RATES, : space.nv + space.nx]
    set_out_dense(tableau, layout, work, scratch)
    asked = 0
    while go_on_dense(t, h, tableau, layout, work, dense, scratch) == ASK:
        derivative(tableau.course[0].t, y, numbers, out, False)
        asked += 1
    if numbers.flag[0] == MOVED:
        bend(layout, numbers.moved, y, dense)
    return asked
