r"""Step of Radau IIA of order 5 in a chart, compiled, by reverse communication.

With the increments Z_i = z(c_i h) - z(0) of the three stages the method is Z = h (A x I) F(Z). It is solved
by simplified Newton steps, in coordinates W in which they part into a real system and a complex one (Hairer
and Wanner, Solving Ordinary Differential Equations II, IV.8, from which error estimate and stopping rule are
too):

    (g/h - J) dW_0 = ...,   ((a + i b)/h - J) (dW_1 + i dW_2) = ...

J is computed again at each step's start, by differences, so that a step depends on its start alone; it serves
all trials from there. Only components that the derivative depends on have a column, ``columns``; the others
(integrals) follow from those.

Evaluation is the caller's: :func:`go_on` returns ASK with the state of interest in the row STATE, wants the
derivative at ``progress.t`` in the row RATES, and is to be called again, until it returns what came of it (as
:mod:`antenna_pin.integrate.explicit_kernels`, which names what that may be).
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.integrate.explicit_kernels import ASK, FAILED, MADE
from antenna_pin.integrate.kernels import store
from antenna_pin.integrate.newton_kernels import (
    END,
    ERROR_ROW,
    FIRST,
    Radau,
    estimate,
    factorize,
    keep_column,
    newton_step,
    vary,
    write_slopes,
    write_state,
)

# What an answer is for.
BEGIN = 0
COLUMN = 1
STAGE = 2
FILTER = 3

NEWTON_STEPS = 10  # in a row
#: A scaled error that stands for a step which cannot be solved: the next is half as long.
NOT_SOLVED = 10.0


@inlined
def _ask(phase: int, t: float, radau: Radau) -> int:
    radau.progress[0].phase = phase
    radau.progress[0].t = t
    return ASK


@kernel
def _next_round(t: float, h: float, stages: int, layout: Ints, work: Floats, radau: Radau) -> int:
    """Ask for the derivative at the first stage."""
    radau.progress[0].stage = 0
    write_state(radau.z, FIRST, stages, layout, work)
    return _ask(STAGE, t + radau.nodes[0] * h, radau)


@kernel
def _set_out(
    t: float, h: float, stages: int, layout: Ints, work: Floats, scales: Floats, rtol: float, radau: Radau
) -> int:
    """Make the first Newton step, with the start derivative for all stages."""
    p = radau.progress[0]
    p.fresh = 1
    if not factorize(h, radau):
        return FAILED
    for k in range(radau.z.shape[1]):
        for i in range(3):
            radau.w[i, k] = 0.0
            radau.f[i, k] = work[0, k]
    p.rounds = 1
    p.step = newton_step(h, stages, layout, work, scales, rtol, radau)
    if not math.isfinite(p.step):
        return FAILED
    return _next_round(t, h, stages, layout, work, radau)


@kernel
def _conclude(
    h: float, stages: int, layout: Ints, work: Floats, scales: Floats, rtol: float, radau: Radau
) -> int:
    """Set the step's end and estimate the error; refine a large estimate."""
    write_slopes(h, stages, layout, work, radau)
    write_state(radau.z, END, stages, layout, work)
    p = radau.progress[0]
    p.error = estimate(h, FIRST, stages, layout, work, scales, rtol, radau)
    return ASK if p.error > 1.0 else MADE


@kernel
def go_on(
    t: float, h: float, stages: int, layout: Ints, work: Floats, scales: Floats, rtol: float, radau: Radau
) -> int:
    """Continue a step of size h [s] with an evaluation; return the next request.

    ``progress.phase`` is BEGIN at its beginning. Once MADE, the step's end is in STATE, its error in
    ``progress.error``.
    """
    p = radau.progress[0]
    if p.phase == BEGIN:
        if p.fresh != 0 or radau.columns.shape[0] == 0:
            return _set_out(t, h, stages, layout, work, scales, rtol, radau)
        p.column = 0
        vary(radau, stages, layout, work, scales)
        return _ask(COLUMN, t, radau)
    if p.phase == COLUMN:
        keep_column(radau, stages, layout, work, scales)
        p.column += 1
        if p.column == radau.columns.shape[0]:
            return _set_out(t, h, stages, layout, work, scales, rtol, radau)
        vary(radau, stages, layout, work, scales)
        return _ask(COLUMN, t, radau)
    if p.phase == FILTER:
        store(ERROR_ROW, stages, layout, work)
        write_state(radau.z, END, stages, layout, work)
        p.error = estimate(h, ERROR_ROW, stages, layout, work, scales, rtol, radau)
        return MADE
    _keep_stage(stages, layout, work, radau)
    if p.stage < 2:
        p.stage += 1
        write_state(radau.z, p.stage, stages, layout, work)
        return _ask(STAGE, t + radau.nodes[p.stage] * h, radau)
    before = p.step
    p.step = newton_step(h, stages, layout, work, scales, rtol, radau)
    p.rounds += 1
    rate = p.step / before if before > 0.0 else 0.0
    wanted = max(10.0 * 2.3e-16 / rtol, min(0.03, math.sqrt(rtol)))
    if p.step == 0.0 or (rate < 1.0 and rate / (1.0 - rate) * p.step <= wanted):
        if _conclude(h, stages, layout, work, scales, rtol, radau) == MADE:
            return MADE
        for k in range(radau.z.shape[1]):
            radau.f[0, k] = h * work[ERROR_ROW, k]
        write_state(radau.f, FIRST, stages, layout, work)
        return _ask(FILTER, t, radau)
    # The second step also makes up for what the first one did not know: how the derivative depends on time.
    if p.rounds >= NEWTON_STEPS or (p.rounds > 2 and not rate < 1.0) or not math.isfinite(p.step):
        return FAILED
    return _next_round(t, h, stages, layout, work, radau)


@kernel
def _keep_stage(stages: int, layout: Ints, work: Floats, radau: Radau) -> None:
    """Keep the derivative at the present stage."""
    store(ERROR_ROW, stages, layout, work)
    for k in range(radau.z.shape[1]):
        radau.f[radau.progress[0].stage, k] = work[ERROR_ROW, k]
