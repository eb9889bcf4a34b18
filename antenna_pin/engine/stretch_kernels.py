"""A stretch of steps: what it works on, and what a step that is accepted leaves, compiled."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin._compile import inlined, kernel
from antenna_pin.dynamics.kernels import turn_on
from antenna_pin.engine.episode_kernels import keep_peaks
from antenna_pin.engine.hold_kernels import close
from antenna_pin.engine.step_kernels import prepare_dense
from antenna_pin.integrate.kernels import START, STATE, STATE_ROW, begin, dense_state
from antenna_pin.records import layout

#: Where the steps are, and what they have come to: time [s], size to try next, and of the trial that stands
#: [s]; samples a second [Hz], from when on [s], until when [s]; samples in the buffer; which of the chosen
#: output times is the next; what was counted; how many trial steps may be made.
STRETCH = layout(
    ("t", "f8"),
    ("h", "f8"),
    ("tried", "f8"),
    ("rate", "f8"),
    ("begin", "f8"),
    ("end", "f8"),
    ("samples", "i8"),
    ("chosen", "i8"),
    ("accepted", "i8"),
    ("rejected", "i8"),
    ("relocated", "i8"),
    ("evaluations", "i8"),
    ("budget", "i8"),
)


class Buffers(NamedTuple):
    """What a stretch writes for the record.

    Attributes:
        times: Of samples, (capacity,) [s].
        states: Of samples, (capacity, size).
        memories: Contact memory at samples, MEMORY, (capacity, contacts).
        early: Whether a sample is one of an earlier time, to be put between others, (capacity,).
        instants: Ends of steps, (budget,) [s].
        ends: States there, (budget, size); empty where nobody wants to look at them.
        kept: Scratch, (2, size).
        out: Scratch, (2, size).
    """

    times: Any
    states: Any
    memories: Any
    early: Any
    instants: Any
    ends: Any
    kept: Any
    out: Any


class Search(NamedTuple):
    """What is looked for in a step (:func:`antenna_pin.dynamics.inspect_kernels.inspect_step`).

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


class Loop(NamedTuple):
    """All that the loop works on.

    Attributes:
        stretch: STRETCH, (1,).
        pace: PACE, (1,).
        breaks: Instants at which steps must end [s].
        chosen: Output times beside those at the rate, (n,), ascending [s].
        tableau: The method, in numbers.
        space: Layout of the manifold.
        work: The stepper's rows.
        dense: Coefficients of the dense output.
        scales: Of errors.
        rtol: Relative tolerance.
        numbers: The system, in numbers.
        search: What is looked for.
        trial: The trial step as it is looked at.
        buffers: What is written.
        book: Of the contacts.
        sizes: Of steps, by pattern of contacts.
        watched: What is looked at from afar.
    """

    stretch: Any
    pace: Any
    breaks: Any
    chosen: Any
    tableau: Any
    space: Any
    work: Any
    dense: Any
    scales: Any
    rtol: float
    numbers: Any
    search: Any
    trial: Any
    buffers: Any
    book: Any
    sizes: Any
    watched: Any


@inlined
def start_row(loop: Any) -> int:
    """Which of the stepper's rows is the state that the step starts from."""
    return int(loop.tableau.weights.shape[0] + START)


@inlined
def is_full(loop: Loop) -> bool:
    """Whether a step more may not find room for what it writes."""
    contacts = loop.search.ignore.shape[0]
    return bool(
        loop.stretch[0].samples + 2 * contacts + 3 > loop.buffers.times.shape[0]
        or loop.book.count[0] >= loop.book.episodes.shape[0]
        or loop.sizes.count[0] >= loop.sizes.sizes.shape[0]
    )


@inlined
def samples_in(loop: Loop, tried: float) -> int:
    """How many output times the trial step has at most."""
    s = loop.stretch[0]
    chosen = s.chosen
    while chosen < loop.chosen.shape[0] and loop.chosen[chosen] <= s.t + tried:
        chosen += 1
    at_rate = math.floor((s.t + tried) * s.rate + 1e-9) - math.floor(s.t * s.rate + 1e-9)
    return int(at_rate + chosen - s.chosen)


@inlined
def prepare(loop: Loop, tried: float) -> None:
    """Compute the dense output of the trial step."""
    s = loop.stretch[0]
    s.evaluations += prepare_dense(
        s.t, tried, loop.tableau, loop.space, loop.work, loop.dense, loop.buffers.kept, loop.numbers
    )


@inlined
def keep(loop: Loop, tried: float) -> None:
    """Keep what the contacts come to in a trial step in which none changes."""
    start = start_row(loop)
    keep_peaks(
        loop.stretch[0].t, tried, loop.space, loop.dense, loop.work, start, loop.buffers.out, loop.book
    )
    for c in range(loop.search.ignore.shape[0]):
        loop.search.ignore[c] = 0


@inlined
def accept(loop: Loop, tried: float) -> None:
    """Sample the trial step and make its end the state."""
    s, work, buffers = loop.stretch[0], loop.work, loop.buffers
    stages, size = loop.tableau.weights.shape[0], loop.buffers.states.shape[1]
    k = math.floor(s.t * s.rate + 1e-9) + 1
    last = math.floor((s.t + tried) * s.rate + 1e-9)
    # A chosen time that is one at the rate but for round-off counts once, as it was chosen.
    same = 1e-9 / s.rate
    while True:
        at_rate, moment = math.inf, math.inf
        if k <= last:
            at_rate = k / s.rate
        if s.chosen < loop.chosen.shape[0] and loop.chosen[s.chosen] <= s.t + tried:
            moment = loop.chosen[s.chosen]
        if at_rate == math.inf and moment == math.inf:
            break
        if moment <= at_rate + same:
            s.chosen += 1
            if at_rate <= moment + same:
                k += 1
        else:
            moment = at_rate
            k += 1
        sample(loop, moment, tried)
    s.t += tried
    if buffers.ends.shape[0] > 0:
        buffers.instants[s.accepted] = s.t
        for i in range(size):
            buffers.ends[s.accepted, i] = work[stages + STATE, i]
    begin(stages, loop.space, work)
    if loop.search.turns.shape[0] > 0:
        loop.pace[0].spin = turn_on(loop.numbers.program, loop.search.turns, work[stages + START])
    if s.t > s.end - 1e-15 * s.end:
        s.t = s.end
    s.accepted += 1


@kernel
def sample(loop: Loop, moment: float, tried: float) -> None:
    """Sample the trial step at an output time [s]."""
    s, work, buffers = loop.stretch[0], loop.work, loop.buffers
    stages, size = loop.tableau.weights.shape[0], loop.buffers.states.shape[1]
    theta = (moment - s.t) / tried
    row = buffers.states[s.samples]
    if theta >= 1.0:
        for i in range(size):
            row[i] = work[stages + STATE, i]
    else:
        dense_state(theta, loop.space, loop.dense, work, stages + START, buffers.out)
        for i in range(size):
            row[i] = buffers.out[STATE_ROW, i]
    if loop.numbers.plan.shape[0] > 0:
        close(moment, buffers.states, s.samples, loop.space, loop.numbers)
    remember(loop, loop.book.memory)
    buffers.times[s.samples] = min(moment, s.end)
    buffers.early[s.samples] = 0
    s.samples += 1


@kernel
def remember(loop: Loop, memory: Any) -> None:
    """Put a contact memory beside the sample that comes next."""
    for c in range(memory.shape[0]):
        kept, held = loop.buffers.memories[loop.stretch[0].samples, c], memory[c]
        kept.touching = held.touching
        kept.approach_speed = held.approach_speed
        kept.effective_mass = held.effective_mass
