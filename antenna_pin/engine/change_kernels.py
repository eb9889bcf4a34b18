"""A contact that touches or parts: the step made again to end there, and what changes, compiled."""

from __future__ import annotations

import math

from antenna_pin._compile import kernel
from antenna_pin.dynamics.inspect_kernels import fill_nodes
from antenna_pin.dynamics.peak_kernels import track_peaks
from antenna_pin.dynamics.trial_kernels import contacts_in
from antenna_pin.engine.episode_kernels import effective_mass, release, touch
from antenna_pin.engine.pace_kernels import hopeless, note_size, shortened, size_after_change
from antenna_pin.engine.step_kernels import attempt, derivative
from antenna_pin.engine.stretch_kernels import Loop, accept, keep, prepare, remember, start_row
from antenna_pin.integrate.kernels import RATES, START, STATE, begin

RELOCATIONS = 5


@kernel
def change(loop: Loop, c: int, theta: float) -> bool:
    """Let a contact touch or part at a fraction of the trial step; whether the loop may go on."""
    s, ignore = loop.stretch[0], loop.search.ignore
    wished = s.h
    note_size(loop.sizes, loop.book.memory, wished)
    if theta > 0.0:
        error = _relocate(loop, c, theta)
        if not error <= 1.0:
            s.h = shortened(loop.pace, s.tried, error)
            return not hopeless(loop.pace, s.h)
    elif ignore[c] != 0:
        # It has just changed here and would change back at once: a graze. Let it, this once more.
        ignore[c] = 2
        _flip(loop, c, 0.0)
        _restart(loop)
        return True
    numbers = loop.numbers
    contacts_in(loop.work[start_row(loop)], numbers.program, numbers.pose, numbers.table)
    _flip(loop, c, numbers.table[c].rate)
    ignore[c] = 1
    _restart(loop)
    _sample_start(loop)
    s.h = size_after_change(loop.sizes, loop.book.memory, wished)
    return True


@kernel
def _relocate(loop: Loop, c: int, theta: float) -> float:
    """Make the trial step again to end where contact c has no gap, and accept it; return its error."""
    s, numbers = loop.stretch[0], loop.numbers
    end = loop.tableau.weights.shape[0] + STATE
    longest = s.tried
    size = theta * longest
    for _ in range(RELOCATIONS):
        error = attempt(s.t, size, loop.tableau, loop.space, loop.work, loop.scales, loop.rtol, numbers)
        s.evaluations += loop.tableau.last
        s.relocated += 1
        s.tried = size
        if not error <= 1.0:
            return float(error)
        contacts_in(loop.work[end], numbers.program, numbers.pose, numbers.table)
        gap, rate = numbers.table[c].gap, numbers.table[c].rate
        if abs(gap) <= loop.book.places[c].tolerance or rate == 0.0:
            break
        more = gap / rate
        if more == 0.0 or not 0.0 < size + more <= longest:
            break
        size += more
    prepare(loop, s.tried)
    fill_nodes(loop.search.nodes, loop.trial, False)
    track_peaks(s.t, s.tried, loop.search.nodes, loop.search.peaks, loop.trial)
    keep(loop, s.tried)
    accept(loop, s.tried)
    return 0.0


@kernel
def _flip(loop: Loop, c: int, rate: float) -> None:
    """Let a contact touch, at a depth rate [m/s], or part; a sample of its largest force is due then."""
    s, book, buffers = loop.stretch[0], loop.book, loop.buffers
    y = loop.work[start_row(loop)]
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
