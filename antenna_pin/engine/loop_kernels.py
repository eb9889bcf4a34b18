"""The loop of steps, compiled: tried, searched for contacts that change, sampled, accepted.

The rules are those of :class:`antenna_pin.simulation.loop.Run`, which makes the steps that this one leaves to
it: those that the run's end cuts, those in which something happens that is not a contact, and the last ones.
"""

from __future__ import annotations

import math

from antenna_pin._compile import released
from antenna_pin.dynamics.inspect_kernels import inspect_step
from antenna_pin.engine.change_kernels import change
from antenna_pin.engine.pace_kernels import cut, following, hopeless, shortened
from antenna_pin.engine.step_kernels import attempt
from antenna_pin.engine.stretch_kernels import Loop, accept, is_full, keep, prepare, samples_in, start_row
from antenna_pin.engine.watch_kernels import may_happen

# Why a stretch ends: the run's end; the budget, or a full buffer; what the loop outside has to see to: a step
# to be made, or a trial step that passes, with its dense output.
ENDED = 0
PAUSED = 1
STEP_DUE = 2
TRIAL_STANDS = 3

REJECTED_IN_A_ROW = 1000


@released
def go_on(loop: Loop) -> int:
    """Make steps until something happens that the loop outside has to see to; return what (see above)."""
    s, pace = loop.stretch[0], loop.pace
    contacts = loop.search.ignore.shape[0]
    events = loop.watched.functions.shape[0] + loop.watched.instants.shape[0]
    from_last = False  # whether the search of the last step knows the contacts at the start of this one
    while s.accepted + s.rejected + s.relocated < s.budget:
        if s.t >= s.end:
            return ENDED
        if s.t < s.begin:
            return STEP_DUE
        if is_full(loop):
            return PAUSED
        wished, rejected, error = s.h, 0, math.inf
        h = wished
        while True:
            tried, by_end = cut(pace, loop.breaks, s.t, h)
            if by_end or s.t + tried == s.t:
                s.h = h
                return STEP_DUE
            error = attempt(
                s.t, tried, loop.tableau, loop.space, loop.work, loop.scales, loop.rtol, loop.numbers
            )
            s.evaluations += loop.tableau.last
            if error <= 1.0:
                break
            rejected += 1
            s.rejected += 1
            h = shortened(pace, tried, error)
            if hopeless(pace, h) or rejected >= REJECTED_IN_A_ROW:
                s.h = tried  # for the loop outside to try again, and to end the run
                s.rejected -= 1
                return STEP_DUE
        s.tried = tried
        s.h = following(pace, h, tried, error, rejected > 0)
        samples = samples_in(loop, tried)
        if contacts > 0 or samples > 0 or events > 0:
            prepare(loop, tried)
        if s.samples + samples + 2 * contacts + 2 > loop.buffers.times.shape[0]:
            return TRIAL_STANDS
        if events > 0 and may_happen(
            s.t,
            tried,
            loop.space,
            loop.dense,
            loop.work,
            start_row(loop),
            loop.buffers.out,
            loop.numbers,
            loop.watched,
        ):
            return TRIAL_STANDS
        if contacts > 0:
            c, theta, deep = inspect_step(
                s.t,
                tried,
                2.0,
                loop.search.nodes,
                loop.search.ignore,
                loop.search.limits,
                loop.search.peaks,
                loop.trial,
                from_last,
            )
            if c >= 0:
                if deep:
                    return TRIAL_STANDS
                from_last = False
                if change(loop, c, theta):
                    continue
                s.h = wished  # for the loop outside to come to the same, and to end the run
                return STEP_DUE
            keep(loop, tried)
            from_last = True
        accept(loop, tried)
    return PAUSED
