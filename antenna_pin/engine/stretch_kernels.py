"""A stretch of steps: what it works on, how a step is tried, what an accepted one leaves, compiled."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from antenna_pin.base.records import layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.outside_kernels import ANSWERED, REFUSED, ask, has_failed
from antenna_pin.dynamics.trial_kernels import contacts_in
from antenna_pin.dynamics.turn_kernels import turn_on
from antenna_pin.engine.episode_kernels import keep_peaks
from antenna_pin.engine.gross_kernels import settle
from antenna_pin.engine.hold_kernels import close
from antenna_pin.engine.step_kernels import attempt, prepare_dense
from antenna_pin.engine.touch_kernels import keep_efforts
from antenna_pin.integrate.kernels import START, STATE, STATE_ROW, begin, dense_state

# Where a step is: it has not begun; longer ones did not pass; its trial stands, and is to be searched; a
# contact is known to change in it; its end is the state, at which a contact is to change.
FRESH = 0
AGAIN = 1
STANDS = 2
MEETS = 3
CHANGES = 4

# Where a stretch ends besides: nowhere, where a contact has changed, there and behind each step.
FREELY = 0
TO_CHANGES = 1
SINGLY = 2

#: Where the steps are, and what they have come to: time [s]; size to try next, and what it was when the step
#: began [s]; that of the trial that stands [s], its scaled error, and the fraction up to which it is
#: searched; samples a second [Hz], from when on [s], until when [s]; where a step is (see above); trials of
#: it that did not pass; the contact that changes, at which fraction, and whether it is too deep then; whether
#: the derivative was asked last at the end of the trial, of contacts in closed form; whether the loop outside
#: sees to this step, where the stretch ends besides (see above), whether a contact has changed, whether the
#: loop outside was told of the first step that the run's end cuts; whether the last trial failed by a
#: function that refuses; whether the search knows the contacts at the start; samples in the buffer, and for
#: how many there must be room; which of the chosen output times is the next; what was counted; how many trial
#: steps may be made.
STRETCH = layout(
    ("t", "f8"),
    ("h", "f8"),
    ("wished", "f8"),
    ("tried", "f8"),
    ("error", "f8"),
    ("until", "f8"),
    ("rate", "f8"),
    ("begin", "f8"),
    ("end", "f8"),
    ("phase", "i8"),
    ("in_row", "i8"),
    ("contact", "i8"),
    ("theta", "f8"),
    ("deep", "i8"),
    ("ended", "i8"),
    ("watched", "i8"),
    ("shown", "i8"),
    ("flipped", "i8"),
    ("cut", "i8"),
    ("refused", "i8"),
    ("known", "i8"),
    ("samples", "i8"),
    ("needed", "i8"),
    ("chosen", "i8"),
    ("accepted", "i8"),
    ("rejected", "i8"),
    ("relocated", "i8"),
    ("evaluations", "i8"),
    ("budget", "i8"),
)


@by_address
class Buffers(NamedTuple):
    """What a stretch writes for the record.

    Attributes:
        times: Of samples, (capacity,) [s].
        states: Of samples, (capacity, size).
        memories: Contact memory at samples, MEMORY, (capacity, contacts).
        early: Whether a sample is one of an earlier time, to be put between others, (capacity,).
        instants: Ends of steps, (budget,) [s].
        sizes: Of these steps, (budget,) [s].
        ends: States there, (budget, size); empty where nobody wants to look at them.
        kept: Scratch, (2, size).
        out: Scratch, (2, size).
    """

    times: Any
    states: Any
    memories: Any
    early: Any
    instants: Any
    sizes: Any
    ends: Any
    kept: Any
    out: Any


@by_address
class Search(NamedTuple):
    """What is looked for in a step (:func:`antenna_pin.dynamics.inspect_kernels.inspect_step`).

    Attributes:
        nodes: Scratch.
        ignore: How often each contact has changed at the start.
        limits: Depths at which a run ends.
        peaks: Largest forces.
        turns: Turned angles, TURN.
        compared: Contacts whose gaps coal measures, as 1, (contacts,); nobody's: (0,).
        difference: Largest one of their gaps and the closed form's so far, where forces come from them, (1,)
            [m].
    """

    nodes: Any
    ignore: Any
    limits: Any
    peaks: Any
    turns: Any
    compared: Any
    difference: Any


@by_address
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
        works: Where works and their gross works stand in x, (n, 2).
        touches: Largest efforts of elements in touch, TOUCH, (n,).
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
    works: Any
    touches: Any


@inlined
def start_row(loop: Any) -> int:
    """Which of the stepper's rows is the state that the step starts from."""
    return int(loop.tableau.weights.shape[0] + START)


@inlined
def is_full(loop: Loop) -> bool:
    """Whether a step more may not find room for what it writes."""
    contacts = loop.search.ignore.shape[0]
    return bool(
        loop.stretch[0].samples + 2 * contacts + 4 > loop.buffers.times.shape[0]
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
    return int(at_rate + chosen - s.chosen + (1 if s.t < s.begin <= s.t + tried else 0))


@inlined
def try_step(loop: Loop, tried: float) -> float:
    """Make a trial step of a size [s]; return its scaled error."""
    s, outside = loop.stretch[0], loop.numbers.outside
    asked = outside.asked[0]
    s.tried = tried
    if asked.step != 0:
        ask(outside, asked.step, tried)
        s.error = asked.answer
        s.ended = 0
    else:
        s.error = attempt(
            s.t, tried, loop.tableau, loop.space, loop.work, loop.scales, loop.rtol, loop.numbers
        )
        s.evaluations += loop.tableau.last
        s.ended = 1 if asked.gaps == 0 and asked.forces == 0 else 0
    s.refused = 0
    if asked.failed != ANSWERED:
        s.error = math.nan
        if asked.failed == REFUSED:  # a shorter step may not come to where a function has no answer
            s.refused = 1
            asked.failed = ANSWERED
    return float(s.error)


@kernel
def _compare(loop: Loop) -> None:
    """Note how far the gaps that coal has measured at the step's end are from the closed form."""
    numbers, search = loop.numbers, loop.search
    end = loop.work[loop.tableau.weights.shape[0] + STATE]
    contacts_in(end, numbers.program, numbers.pose, numbers.table)
    for c in range(search.compared.shape[0]):
        if search.compared[c] != 0 and numbers.memory[c].touching != 0.0:
            difference = abs(numbers.table[c].gap - numbers.own[c].gap)
            search.difference[0] = max(search.difference[0], difference)


@inlined
def prepare(loop: Loop) -> None:
    """Compute the dense output of the trial step; before, coal's gaps at its end are looked at."""
    s = loop.stretch[0]
    if loop.search.compared.shape[0] > 0:
        _compare(loop)
    more = prepare_dense(
        s.t, s.tried, loop.tableau, loop.space, loop.work, loop.dense, loop.buffers.kept, loop.numbers
    )
    s.evaluations += more
    if more > 0:
        s.ended = 0


@inlined
def keep(loop: Loop) -> None:
    """Keep what the contacts come to in a trial step in which none changes."""
    s, start = loop.stretch[0], start_row(loop)
    keep_peaks(s.t, s.tried, loop.space, loop.dense, loop.work, start, loop.buffers.out, loop.book)
    for c in range(loop.search.ignore.shape[0]):
        loop.search.ignore[c] = 0


@inlined
def _settle(loop: Loop, theta: float, y: Any) -> None:
    """Write the gross works of a state at a fraction of the trial step."""
    settle(theta, loop.works, loop.tableau, loop.space, loop.work, loop.dense, y)


@inlined
def accept(loop: Loop) -> None:
    """Sample the trial step and make its end the state."""
    s, work, buffers = loop.stretch[0], loop.work, loop.buffers
    tried = s.tried
    stages, size = loop.tableau.weights.shape[0], loop.buffers.states.shape[1]
    k = math.floor(s.t * s.rate + 1e-9) + 1
    last = math.floor((s.t + tried) * s.rate + 1e-9)
    # A chosen time that is one at the rate but for round-off counts once, as it was chosen.
    same = 1e-9 / s.rate
    before = s.samples
    _settle(loop, 1.0, work[stages + STATE])
    if s.t < s.begin <= s.t + tried:
        sample(loop, s.begin, tried)
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
        if moment > s.begin or s.begin <= s.t:
            sample(loop, moment, tried)
    if has_failed(loop.numbers.outside):
        s.samples = before
        return
    if loop.touches.shape[0] > 0:
        step = loop.space, loop.dense, work, stages + START, buffers.out
        keep_efforts(s.t, tried, loop.touches, step, loop.numbers)
    s.t += tried
    begin(stages, loop.space, work)
    loop.numbers.outside.asked[0].new = 1
    if loop.search.turns.shape[0] > 0:
        loop.pace[0].spin = turn_on(loop.numbers.program, loop.search.turns, work[stages + START])
    last = loop.pace[0].next >= loop.breaks.shape[0]
    aim = s.end if last else loop.breaks[loop.pace[0].next]
    if s.t >= s.end or abs(s.t - aim) <= 1e-15 * aim:  # by the round-off of a sum: a step ends where it is to
        s.t = min(aim, s.end)
    if buffers.ends.shape[0] > 0:
        buffers.instants[s.accepted], buffers.sizes[s.accepted] = s.t, tried
        for i in range(size):
            buffers.ends[s.accepted, i] = work[stages + START, i]
    s.accepted += 1
    s.phase = FRESH


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
        _settle(loop, theta, row)
    if loop.numbers.plan.shape[0] > 0:
        close(moment, buffers.states, s.samples, loop.space, loop.numbers)
    remember(loop, loop.book.memory)
    buffers.times[s.samples] = moment
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
