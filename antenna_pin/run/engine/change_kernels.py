"""Repetition of a step up to an event, and contacts that begin or end, compiled."""

from __future__ import annotations

import math

from antenna_pin.compiled.decorators import deferred, kernel
from antenna_pin.dynamics.inspect_kernels import fill_nodes
from antenna_pin.dynamics.outside_kernels import ask, has_failed
from antenna_pin.dynamics.peak_kernels import track_peaks
from antenna_pin.dynamics.trial_kernels import locate
from antenna_pin.integrate.kernels import RATES, START, STATE, begin
from antenna_pin.run.engine.episode_kernels import effective_mass, release, touch
from antenna_pin.run.engine.pace_kernels import hopeless, shortened, size_after_change
from antenna_pin.run.engine.step_kernels import derivative
from antenna_pin.run.engine.stretch_kernels import (
    FRESH,
    Loop,
    accept,
    keep,
    prepare,
    remember,
    start_row,
    try_step,
)

RELOCATIONS = 5

# Results of a part of the loop: it continues; the outer loop has to handle a step so short that it is
# hopeless, or a call outside that failed.
GOES_ON = 0
HOPELESS = 1
FAILED = 2


@kernel
def make_again(loop: Loop, c: int, level: float, size: float, longest: float) -> int:
    """Repeat the trial step up to an event, and compute its dense output.

    The error of the full step does not bound that of the shortened one. If the latter is too large, a shorter
    step is tried.

    Args:
        loop: The loop.
        c: Contact whose gap reaches a level; -1: the callback ``lack`` gives the correction of the step size.
        level: That gap [m].
        size: Time of the event within the step, by a dense output [s].
        longest: Upper bound of the corrected step size [s].
    """
    s, outside = loop.stretch[0], loop.numbers.outside
    for _ in range(RELOCATIONS):
        error = try_step(loop, size)
        s.relocated += 1
        if has_failed(outside):
            return FAILED
        if not error <= 1.0:
            s.phase = FRESH
            s.h = shortened(loop.pace, s.tried, error)
            return HOPELESS if hopeless(loop.pace, s.h) else GOES_ON
        more = _lack(loop, c, level)
        if has_failed(outside):
            return FAILED
        if more == 0.0 or not 0.0 < size + more <= longest:
            break
        size += more
    prepare(loop)
    return FAILED if has_failed(outside) else GOES_ON


@kernel
def _lack(loop: Loop, c: int, level: float) -> float:
    """Return the Newton correction of the step size to the event [s], or zero."""
    numbers = loop.numbers
    outside = numbers.outside
    if c < 0:
        loop.stretch[0].ended = 0
        ask(outside, outside.asked[0].lack, loop.stretch[0].tried)
        return float(outside.asked[0].answer)
    end = loop.work[loop.tableau.weights.shape[0] + STATE]
    locate(end, numbers.program, numbers.pose, numbers.table, outside)
    gap, rate = numbers.table[c].gap - level, numbers.table[c].rate
    if abs(gap) <= loop.book.places[c].tolerance or rate == 0.0:
        return 0.0
    return float(gap / rate)


@kernel
def take_up(loop: Loop) -> int:
    """Accept a trial step that was made again, in which no contact changes."""
    s = loop.stretch[0]
    if loop.search.ignore.shape[0] > 0:
        fill_nodes(loop.search.nodes, loop.trial, False, s.ended != 0)
        track_peaks(s.t, s.tried, loop.search.nodes, loop.search.peaks, loop.trial)
        keep(loop)
    accept(loop)
    return FAILED if has_failed(loop.numbers.outside) else GOES_ON


@kernel
def change(loop: Loop) -> int:
    """Apply onset or release of the contact located at the present state."""
    s, numbers, c = loop.stretch[0], loop.numbers, loop.stretch[0].contact
    locate(loop.work[start_row(loop)], numbers.program, numbers.pose, numbers.table, numbers.outside)
    _flip(loop, c, numbers.table[c].rate)
    loop.search.ignore[c] = 1
    _restart(loop)
    if has_failed(numbers.outside):
        return FAILED
    _sample_start(loop)
    s.h = size_after_change(loop.sizes, loop.book.memory, s.h)
    return GOES_ON


@deferred
def graze(loop: Loop) -> int:
    """Let a contact that has just changed here change back at once, this once more."""
    c = loop.stretch[0].contact
    loop.search.ignore[c] = 2
    _flip(loop, c, 0.0)
    _restart(loop)
    return FAILED if has_failed(loop.numbers.outside) else GOES_ON


@kernel
def _flip(loop: Loop, c: int, rate: float) -> None:
    """Apply onset, at a depth rate [m/s], or release; schedule its peak sample."""
    s, book, buffers = loop.stretch[0], loop.book, loop.buffers
    y = loop.work[start_row(loop)]
    s.phase, s.flipped = FRESH, 1
    if book.memory[c].touching == 0.0:
        touch(book, c, s.t, rate, effective_mass(c, y, loop.numbers), y)
        return
    release(book, c, s.t, y)
    if book.moments[c] >= s.begin:
        remember(loop, book.memories[c])
        for k in range(y.shape[0]):
            buffers.states[s.samples, k] = book.states[c, k]
        buffers.times[s.samples] = book.moments[c]
        buffers.early[s.samples] = 1
        s.samples += 1
    book.moments[c] = math.nan


@kernel
def _restart(loop: Loop) -> None:
    """Evaluate the derivative at the start anew: something has changed there."""
    s, work = loop.stretch[0], loop.work
    stages, n = loop.tableau.weights.shape[0], loop.numbers.rates.shape[1]
    for k in range(work.shape[1]):
        work[stages + STATE, k] = work[stages + START, k]
    derivative(s.t, work[stages + STATE], loop.numbers, work[stages + RATES, :n], False)
    s.evaluations += 1
    begin(stages, loop.space, work)
    loop.numbers.outside.asked[0].new = 1


@kernel
def _sample_start(loop: Loop) -> None:
    """Put a sample of the present state into the buffer."""
    s, y = loop.stretch[0], loop.work[start_row(loop)]
    remember(loop, loop.book.memory)
    for k in range(y.shape[0]):
        loop.buffers.states[s.samples, k] = y[k]
    loop.buffers.times[s.samples] = s.t
    loop.buffers.early[s.samples] = 0
    s.samples += 1
