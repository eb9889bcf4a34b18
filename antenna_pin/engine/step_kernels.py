"""One step, compiled as a whole: the derivative of a tree, its stages, its error, its dense output.

The stages, the elements and the tree's dynamics are the functions that the other engine calls one by one.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin._compile import inlined, kernel
from antenna_pin.constraints.rows_kernels import write_rows
from antenna_pin.constraints.solve_kernels import solve
from antenna_pin.dynamics.kernels import evaluate, head_of
from antenna_pin.dynamics.point_kernels import add_forces
from antenna_pin.engine.hold_kernels import AS_IT_WAS, LOST, MOVED, factorize_rows, project
from antenna_pin.integrate.kernels import RATES, STATE, bend, dense_coefficients, finish, stage, store
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.mechanism.dynamics_kernels import aba


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


class Tableau(NamedTuple):
    """A Runge-Kutta method (:class:`antenna_pin.integrate.Method`).

    Attributes:
        nodes: Of the stages, (stages,).
        weights: Of the stages, (stages, stages).
        errors: Of the error, (1 or 2, stages).
        polynomials: Of the dense output, (stages, degree).
        last: The stage at the step's end.
        adaptive: Whether it has an error, 1 or 0.
    """

    nodes: Any
    weights: Any
    errors: Any
    polynomials: Any
    last: int
    adaptive: int


@inlined
def derivative(t: float, y: Any, numbers: Any, rates: Any, written: bool) -> None:
    """Write [acceleration (nv), rate of x (nx)] of a tree at time t [s] and state y.

    ``written``: whether the rows of its constraints, if it has any, are those of this state already.
    """
    program = numbers.program
    head = head_of(program)
    tau = numbers.work[: head.nv]
    evaluate(t, y, program, numbers.work, rates)
    if head.points < program.shape[0]:
        add_forces(y, program, numbers.tree, numbers.places, tau, rates)
    if numbers.plan.shape[0] == 0:
        aba(y, head.nq, numbers.tree, numbers.gravity, tau, numbers.room, rates[: head.nv])
        return
    if not written:
        write_rows(t, y, program, numbers.plan, numbers.held)
    factorize_rows(numbers)
    solve(y, program, numbers.plan, numbers.held, tau, numbers.bias, rates)


@kernel
def attempt(
    t: float, h: float, tableau: Any, layout: Any, work: Any, scales: Any, rtol: float, numbers: Any
) -> float:
    """Try a step of size h [s] from the start in the work rows; return its scaled error."""
    space = space_of(layout)
    stages, rates = tableau.weights.shape[0], space.nv + space.nx
    y, out = work[stages + STATE], work[stages + RATES, :rates]
    stage(1, h, tableau.weights, layout, work, False)
    for i in range(1, tableau.last):
        derivative(t + tableau.nodes[i] * h, y, numbers, out, False)
        stage(i + 1, h, tableau.weights, layout, work, True)
    numbers.flag[0] = AS_IT_WAS
    if numbers.plan.shape[0] > 0:
        for k in range(numbers.moved.shape[0]):
            numbers.moved[k] = y[k]
        numbers.flag[0] = project(t + h, work, stages + STATE, layout, numbers)
        if numbers.flag[0] == LOST:
            return math.nan
    derivative(t + h, y, numbers, out, True)
    error = finish(tableau.last, h, tableau.errors, layout, work, scales, rtol)
    return float(error if tableau.adaptive != 0 or not math.isfinite(error) else 0.0)


@kernel
def prepare_dense(
    t: float, h: float, tableau: Any, layout: Any, work: Any, dense: Any, kept: Any, numbers: Any
) -> int:
    """Write the dense output of a step; return how often the derivative was asked.

    ``kept``, (2, size), holds the step's end meanwhile.
    """
    space = space_of(layout)
    stages, rates = tableau.weights.shape[0], space.nv + space.nx
    size = space.nq + rates
    first = tableau.last + 1
    if stages > first:
        for k in range(size):
            kept[0, k] = work[stages + STATE, k]
            kept[1, k] = work[stages + RATES, k]
        y, out = work[stages + STATE], work[stages + RATES, :rates]
        for i in range(first, stages):
            stage(i, h, tableau.weights, layout, work, i > first)
            derivative(t + tableau.nodes[i] * h, y, numbers, out, False)
        store(stages - 1, stages, layout, work)
        for k in range(size):
            work[stages + STATE, k] = kept[0, k]
            work[stages + RATES, k] = kept[1, k]
    dense_coefficients(h, tableau.polynomials, 2 * space.nv + space.nx, work, dense)
    if numbers.flag[0] == MOVED:
        bend(layout, numbers.moved, work[stages + STATE], dense)
    return int(stages - first)
