"""An implicit step, compiled as a whole: its own entry, compiled when it is first asked for."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import released
from antenna_pin.engine.hold_kernels import AS_IT_WAS, LOST, project
from antenna_pin.engine.step_kernels import derivative
from antenna_pin.integrate.kernels import RATES, STATE
from antenna_pin.integrate.manifold_kernels import space_of
from antenna_pin.integrate.radau_kernels import ASK, BEGIN, FAILED, NOT_SOLVED, go_on


@released
def attempt_implicit(
    t: float,
    h: float,
    stages: int,
    layout: Any,
    work: Any,
    scales: Any,
    rtol: float,
    radau: Any,
    numbers: Any,
    asked: Any,
) -> float:
    """Try a step of size h [s] from the start in the work rows; return its scaled error.

    ``asked``, (1,), is raised by how often the derivative was.
    """
    space = space_of(layout)
    y, out = work[stages + STATE], work[stages + RATES, : space.nv + space.nx]
    progress = radau.progress[0]
    progress.phase = BEGIN
    numbers.flag[0] = AS_IT_WAS
    came = go_on(t, h, stages, layout, work, scales, rtol, radau)
    while came == ASK:
        derivative(progress.t, y, numbers, out, False)
        asked[0] += 1
        came = go_on(t, h, stages, layout, work, scales, rtol, radau)
    if came == FAILED:
        return NOT_SOLVED
    if numbers.plan.shape[0] > 0:
        for k in range(numbers.moved.shape[0]):
            numbers.moved[k] = y[k]
        numbers.flag[0] = project(t + h, work, stages + STATE, layout, numbers)
        if numbers.flag[0] == LOST:
            return math.nan
    derivative(t + h, y, numbers, out, True)
    asked[0] += 1
    return float(progress.error)
