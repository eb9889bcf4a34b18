"""Batch of steps, compiled: arrays, trial of a step, results of acceptance."""

from __future__ import annotations

import math
from typing import NamedTuple

from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints, Memory, Record, Records, layout
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.numbers_kernels import Numbers
from antenna_pin.dynamics.outside_kernels import ANSWERED, REFUSED, ask, has_failed
from antenna_pin.dynamics.peak_kernels import Peak
from antenna_pin.dynamics.trial_kernels import TrialStep, contacts_in
from antenna_pin.dynamics.turn_kernels import TurnedAngle, turn_on
from antenna_pin.integrate.explicit_kernels import Tableau
from antenna_pin.integrate.kernels import START, STATE, STATE_ROW, begin, dense_state
from antenna_pin.run.engine.episode_kernels import Book, keep_peaks
from antenna_pin.run.engine.gross_kernels import settle
from antenna_pin.run.engine.hold_kernels import close
from antenna_pin.run.engine.pace_kernels import PaceRecord, StepSizeArrays
from antenna_pin.run.engine.step_kernels import attempt, prepare_dense
from antenna_pin.run.engine.touch_kernels import TouchRecord, keep_efforts
from antenna_pin.run.engine.watch_kernels import Watched

# Phase of a step: not begun; longer ones rejected; trial step passed, to be searched; a change of contact
# found in it; its end is the state at which a contact changes.
FRESH = 0
AGAIN = 1
STANDS = 2
MEETS = 3
CHANGES = 4

# Further ends of a batch: none, at changes of contact, there and after each step.
FREELY = 0
TO_CHANGES = 1
SINGLY = 2


class Stretch(Record):
    """The state of a batch of steps."""

    t: float  # time [s]
    h: float  # next step size [s]
    wished: float  # step size at the begin of the step [s]
    tried: float  # size of the passed trial step [s]
    error: float  # its scaled error
    until: float  # fraction up to which it is searched
    rate: float  # rate of samples [Hz]
    begin: float  # first time of samples [s]
    end: float  # last time of samples [s]
    phase: int  # phase of a step: FRESH, AGAIN, ...
    in_row: int  # rejected trials of this step
    contact: int  # contact that changes
    theta: float  # fraction of the step at the change
    deep: int  # 1: the contact is too deep there
    ended: int  # 1: the last evaluation was at the trial's end, with contacts in closed form
    watched: int  # 1: the outer loop searches this step for events
    shown: int  # further end of the batch: FREELY, TO_CHANGES, SINGLY
    flipped: int  # 1: a contact has changed
    cut: int  # 1: the outer loop was notified of the first step cut by the run's end
    refused: int  # 1: a function without a valid result rejected the last trial
    known: int  # 1: the search has stored the contacts at the start
    samples: int  # number in the buffer
    needed: int  # required space
    chosen: int  # index of the next chosen output time
    accepted: int  # number of steps
    rejected: int  # number of steps
    relocated: int  # number of steps
    evaluations: int  # evaluations of the derivative
    budget: int  # remaining trial steps


STRETCH = layout(Stretch)


@by_address
class Buffers(NamedTuple):
    """Output arrays of a batch of steps."""

    times: Floats  # times of samples, (capacity,) [s]
    states: Floats  # states of samples, (capacity, size)
    memories: NDArray[Memory]  # contact memory at samples, MEMORY, (capacity, contacts)
    early: Ints  # whether a sample is of an earlier time, to be sorted in, (capacity,)
    instants: Floats  # ends of steps, (budget,) [s]
    sizes: Floats  # step sizes, (budget,) [s]
    ends: Floats  # states there, (budget, size); empty without a step log
    kept: Floats  # scratch, (2, size)
    out: Floats  # scratch, (2, size)


@by_address
class EventSearch(NamedTuple):
    """Arrays for event location (:func:`antenna_pin.dynamics.inspect_kernels.inspect_step`)."""

    nodes: Floats  # scratch
    ignore: Ints  # changes of each contact at the start
    limits: Floats  # depths at which a run ends
    peaks: Records[Peak]  # largest forces
    turns: Records[TurnedAngle]  # turned angles, TURN
    compared: Ints  # contacts with gaps by coal, as 1, (contacts,); none: (0,)
    # largest difference so far between coal's gaps and the closed form, (1,) [m]
    difference: Floats


@by_address
class Loop(NamedTuple):
    """All that the loop works on."""

    stretch: Records[Stretch]  # STRETCH, (1,)
    pace: Records[PaceRecord]  # PACE, (1,)
    breaks: Floats  # times at which steps must end [s]
    chosen: Floats  # chosen output times, (n,), ascending [s]
    tableau: Tableau  # coefficients of the method
    space: Ints  # layout of the manifold
    work: Floats  # rows of the stepper
    dense: Floats  # coefficients of the dense output
    scales: Floats  # error scales
    rtol: float  # relative tolerance
    numbers: Numbers  # the system in numbers
    search: EventSearch  # search for changes of contact
    trial: TrialStep  # trial step under search
    buffers: Buffers  # output
    book: Book  # contacts and episodes
    sizes: StepSizeArrays  # step sizes by pattern of contacts
    watched: Watched  # functions of the coarse check
    works: Ints  # places of works and their gross works in x, (n, 2)
    touches: Records[TouchRecord]  # largest efforts of elements in touch, TOUCH, (n,)


@inlined
def start_row(loop: Loop) -> int:
    """Return the stepper row of the step's start."""
    return int(loop.tableau.weights.shape[0] + START)


@inlined
def is_full(loop: Loop) -> bool:
    """Return whether another step might exceed the output arrays."""
    contacts = loop.search.ignore.shape[0]
    return bool(
        loop.stretch[0].samples + 2 * contacts + 4 > loop.buffers.times.shape[0]
        or loop.book.count[0] >= loop.book.episodes.shape[0]
        or loop.sizes.count[0] >= loop.sizes.sizes.shape[0]
    )


@inlined
def samples_in(loop: Loop, tried: float) -> int:
    """Return the largest possible number of output times in the trial step."""
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
        if asked.failed == REFUSED:  # a shorter step may avoid a state without a valid result
            s.refused = 1
            asked.failed = ANSWERED
    return float(s.error)


@kernel
def _compare(loop: Loop) -> None:
    """Record the largest difference between coal's gaps and the closed form."""
    numbers, search = loop.numbers, loop.search
    end = loop.work[loop.tableau.weights.shape[0] + STATE]
    contacts_in(end, numbers.program, numbers.pose, numbers.table)
    for c in range(search.compared.shape[0]):
        if search.compared[c] != 0 and numbers.memory[c].touching != 0.0:
            difference = abs(numbers.table[c].gap - numbers.own[c].gap)
            search.difference[0] = max(search.difference[0], difference)


@inlined
def prepare(loop: Loop) -> None:
    """Compute the dense output of the trial step, after a comparison of coal's gaps."""
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
def _settle(loop: Loop, theta: float, y: Floats) -> None:
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
    # A chosen time that equals one of the rate up to round-off counts once, as chosen.
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
    if s.t >= s.end or abs(s.t - aim) <= 1e-15 * aim:  # round-off of a sum: the end is exact
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
def remember(loop: Loop, memory: Records[Memory]) -> None:
    """Put a contact memory beside the sample that comes next."""
    for c in range(memory.shape[0]):
        kept, held = loop.buffers.memories[loop.stretch[0].samples, c], memory[c]
        kept.touching = held.touching
        kept.approach_speed = held.approach_speed
        kept.effective_mass = held.effective_mass
