"""Steps that nothing interrupts, compiled: tried, searched for contacts that change, sampled, accepted."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin._compile import kernel
from antenna_pin.dynamics._inspect import inspect_step
from antenna_pin.dynamics._kernels import turn_on
from antenna_pin.engine._hold_kernels import close
from antenna_pin.engine._pace_kernels import cut, following, hopeless, shortened
from antenna_pin.engine._step_kernels import attempt, prepare_dense
from antenna_pin.integrate._kernels import START, STATE, STATE_ROW, begin, dense_state
from antenna_pin.records import layout

#: Where the steps are, and what they have come to: time [s], size to try next, and of the trial that stands
#: [s]; samples a second [Hz], from when on [s], until when [s]; samples in the buffer; what was counted;
#: how many steps may be made.
STRETCH = layout(
    ("t", "f8"),
    ("h", "f8"),
    ("tried", "f8"),
    ("rate", "f8"),
    ("begin", "f8"),
    ("end", "f8"),
    ("samples", "i8"),
    ("accepted", "i8"),
    ("rejected", "i8"),
    ("evaluations", "i8"),
    ("budget", "i8"),
)

# Why a stretch ends: the run's end, the budget; what the loop outside has to see to: a step to be made, or a
# trial step that passes, with its dense output.
ENDED = 0
PAUSED = 1
STEP_DUE = 2
TRIAL_STANDS = 3

REJECTED_IN_A_ROW = 1000


class Buffers(NamedTuple):
    """What a stretch writes for the record.

    Attributes:
        times: Of samples, (capacity,) [s].
        states: Of samples, (capacity, size).
        moments: When each contact's force was the largest so far, as its state was kept, (contacts,) [s].
        peaks: That state, (contacts, size).
        instants: Ends of steps, (budget,) [s].
        ends: States there, (budget, size); empty where nobody wants to look at them.
        kept: Scratch, (2, size).
        out: Scratch, (2, size).
    """

    times: Any
    states: Any
    moments: Any
    peaks: Any
    instants: Any
    ends: Any
    kept: Any
    out: Any


class Search(NamedTuple):
    """What is looked for in a step (:func:`antenna_pin.dynamics._inspect.inspect_step`).

    Attributes:
        nodes: Scratch.
        ignore: How often each contact has changed at the start.
        limits: Depths at which a run ends.
        peaks: Largest forces.
        turns: Turned angles, TURN.
    """

    nodes: Any
    ignore: Any
    limits: Any
    peaks: Any
    turns: Any


@kernel
def go_on(
    stretch: Any,
    pace: Any,
    breaks: Any,
    tableau: Any,
    space: Any,
    work: Any,
    dense: Any,
    scales: Any,
    rtol: float,
    numbers: Any,
    search: Any,
    trial: Any,
    buffers: Any,
) -> int:
    """Make steps until something happens that the loop outside has to see to; return what (see above)."""
    s = stretch[0]
    stages = tableau.weights.shape[0]
    contacts = search.ignore.shape[0]
    size = buffers.states.shape[1]
    for _ in range(s.budget):
        if s.t >= s.end:
            return ENDED
        if s.t < s.begin:
            return STEP_DUE
        h, rejected, error = s.h, 0, math.inf
        while True:
            tried, by_end = cut(pace, breaks, s.t, h)
            if by_end or s.t + tried == s.t:
                s.h = h
                return STEP_DUE
            error = attempt(s.t, tried, tableau, space, work, scales, rtol, numbers)
            s.evaluations += tableau.last
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
        first = math.floor(s.t * s.rate + 1e-9) + 1
        last = math.floor((s.t + tried) * s.rate + 1e-9)
        if contacts > 0 or last >= first:
            s.evaluations += prepare_dense(s.t, tried, tableau, space, work, dense, buffers.kept, numbers)
        if s.samples + last - first + 1 > buffers.times.shape[0]:
            return TRIAL_STANDS
        if contacts > 0:
            contact, _, _ = inspect_step(
                s.t, tried, 2.0, search.nodes, search.ignore, search.limits, search.peaks, trial
            )
            if contact >= 0:
                return TRIAL_STANDS
            _keep_peaks(s.t, tried, space, dense, work, stages, trial, search, buffers)
            for c in range(contacts):
                search.ignore[c] = 0
        for k in range(first, last + 1):
            moment = k / s.rate
            theta = (moment - s.t) / tried
            row = buffers.states[s.samples]
            if theta >= 1.0:
                for i in range(size):
                    row[i] = work[stages + STATE, i]
            else:
                dense_state(theta, space, dense, work, stages + START, buffers.out)
                for i in range(size):
                    row[i] = buffers.out[STATE_ROW, i]
            if numbers.plan.shape[0] > 0:
                close(moment, buffers.states, s.samples, space, numbers)
            buffers.times[s.samples] = min(moment, s.end)
            s.samples += 1
        s.t += tried
        if buffers.ends.shape[0] > 0:
            buffers.instants[s.accepted] = s.t
            for i in range(size):
                buffers.ends[s.accepted, i] = work[stages + STATE, i]
        begin(stages, space, work)
        if search.turns.shape[0] > 0:
            pace[0].spin = turn_on(numbers.program, search.turns, work[stages + START])
        if s.t > s.end - 1e-15 * s.end:
            s.t = s.end
        s.accepted += 1
    return PAUSED


@kernel
def _keep_peaks(
    t: float, h: float, space: Any, dense: Any, work: Any, stages: int, trial: Any, search: Any, buffers: Any
) -> None:
    """Keep the state at the largest force so far of each touching contact."""
    for c in range(search.ignore.shape[0]):
        if trial.memory[c].touching == 0.0:
            continue
        moment = search.peaks[c].time
        if t < moment <= t + h and buffers.moments[c] != moment:
            dense_state((moment - t) / h, space, dense, work, stages + START, buffers.out)
            for i in range(buffers.peaks.shape[1]):
                buffers.peaks[c, i] = buffers.out[STATE_ROW, i]
            buffers.moments[c] = moment
