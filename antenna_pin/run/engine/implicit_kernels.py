"""Compiled implicit step, an entry of its own, compiled on demand."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import released
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.outside_kernels import has_failed
from antenna_pin.integrate.explicit_kernels import ASK, FAILED
from antenna_pin.integrate.kernels import RATES, STATE
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.integrate.newton_kernels import Radau
from antenna_pin.integrate.radau_kernels import BEGIN, NOT_SOLVED, go_on
from antenna_pin.run.engine.step_kernels import derivative, end


@released
def attempt_implicit(
    t: float,
    h: float,
    stages: int,
    layout: Ints,
    work: Floats,
    scales: Floats,
    rtol: float,
    radau: Radau,
    numbers: Numbers,
    evaluations: Ints,
) -> float:
    """Try a step of size h [s] from the work rows; return its scaled error.

    ``evaluations``, (1,), is increased by the number of evaluations of the derivative.
    """
    space = space_of(layout)
    y, out = work[stages + STATE], work[stages + RATES, : space.nv + space.nx]
    progress = radau.progress[0]
    progress.phase = BEGIN
    came = go_on(t, h, stages, layout, work, scales, rtol, radau)
    while came == ASK:
        derivative(progress.t, y, numbers, out, False)
        evaluations[0] += 1
        if has_failed(numbers.outside):
            return math.nan
        came = go_on(t, h, stages, layout, work, scales, rtol, radau)
    if came == FAILED:
        return NOT_SOLVED
    evaluations[0] += 1
    return float(progress.error if end(t + h, layout, work, stages, numbers) else math.nan)
