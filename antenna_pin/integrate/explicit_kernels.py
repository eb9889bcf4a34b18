"""Explicit steps and the stages of their dense output, compiled, by reverse communication.

The caller makes a step by calling :func:`go_on` until it returns MADE. Each time before, it returns ASK with
a state in the row STATE, and wants the derivative there at ``progress.t`` in the row RATES. With MADE the
step's end is in STATE: it may be moved, as onto constraints, is evaluated too, and :func:`error_of` tells
its error. So the one rule of the stages serves compiled steps and a derivative in Python alike; implicit
steps keep to the same order (:mod:`antenna_pin.integrate.radau_kernels`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from antenna_pin.base import records
from antenna_pin.base.records import Floats, Ints, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.integrate.kernels import RATES, STATE, dense_coefficients, finish, stage, store
from antenna_pin.integrate.manifold_kernels import space_of

# What comes of a call: the derivative is wanted, the step is made, or it cannot be made.
ASK = 0
MADE = 1
FAILED = 2


class ExplicitProgress(records.Record):
    """The progress of an explicit step."""

    stage: int  # whose state was written last
    t: float  # its time [s]


COURSE = records.layout(ExplicitProgress)


@by_address
class Tableau(NamedTuple):
    """A Runge-Kutta method (:class:`antenna_pin.integrate.Method`), and where a step by it is."""

    nodes: Floats  # of the stages, (stages,)
    weights: Floats  # of the stages, (stages, stages)
    errors: Floats  # of the error, (1 or 2, stages)
    polynomials: Floats  # of the dense output, (stages, degree)
    last: int  # the stage at the step's end
    adaptive: int  # whether it has an error, 1 or 0
    course: Records[ExplicitProgress]  # COURSE, (1,)


@inlined
def set_out(tableau: Tableau) -> None:
    """Begin a step from the start in the work rows."""
    tableau.course[0].stage = 0


@inlined
def go_on(t: float, h: float, tableau: Tableau, layout: Ints, work: Floats) -> int:
    """Write the state of the next stage; return the required evaluation."""
    course = tableau.course[0]
    i = course.stage + 1
    stage(i, h, tableau.weights, layout, work, i > 1)
    course.stage = i
    course.t = t + tableau.nodes[i] * h
    return MADE if i == tableau.last else ASK


@kernel
def error_of(h: float, tableau: Tableau, layout: Ints, work: Floats, scales: Floats, rtol: float) -> float:
    """Return the scaled error of a completed step; 0 for fixed steps."""
    error = finish(tableau.last, h, tableau.errors, layout, work, scales, rtol)
    return float(error if tableau.adaptive != 0 or not math.isfinite(error) else 0.0)


@inlined
def set_out_dense(tableau: Tableau, layout: Ints, work: Floats, scratch: Floats) -> None:
    """Begin the dense output of a completed step; scratch (2, size) holds its end."""
    space, stages = space_of(layout), tableau.weights.shape[0]
    tableau.course[0].stage = tableau.last
    if stages > tableau.last + 1:
        for k in range(space.nq + space.nv + space.nx):
            scratch[0, k] = work[stages + STATE, k]
            scratch[1, k] = work[stages + RATES, k]


@inlined
def go_on_dense(
    t: float, h: float, tableau: Tableau, layout: Ints, work: Floats, dense: Floats, scratch: Floats
) -> int:
    """Write the state of the dense output's next stage; return MADE when complete."""
    course, stages = tableau.course[0], tableau.weights.shape[0]
    space = space_of(layout)
    i = course.stage + 1
    if i < stages:
        stage(i, h, tableau.weights, layout, work, i > tableau.last + 1)
        course.stage = i
        course.t = t + tableau.nodes[i] * h
        return ASK
    if stages > tableau.last + 1:
        store(stages - 1, stages, layout, work)
        for k in range(space.nq + space.nv + space.nx):
            work[stages + STATE, k] = scratch[0, k]
            work[stages + RATES, k] = scratch[1, k]
    dense_coefficients(h, tableau.polynomials, 2 * space.nv + space.nx, work, dense)
    return MADE
