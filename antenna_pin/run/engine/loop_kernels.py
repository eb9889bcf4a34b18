"""The only time loop, compiled: steps tried, searched for contacts that change, sampled, accepted.

The dense output of a trial step with a passed error test is searched for the first contact that changes; if
there is one, the step is repeated to end there, the discrete state is changed, and integration restarts from
that state. So the equations are smooth inside every accepted step. :func:`go_on` returns where the outer loop
must act, and continues there at the next call: the position within a step is in ``STRETCH``.
"""

from __future__ import annotations

from antenna_pin.compiled.decorators import inlined, kernel, released
from antenna_pin.dynamics.inspect_kernels import inspect_step
from antenna_pin.dynamics.outside_kernels import has_failed
from antenna_pin.run.engine.change_kernels import (
    FAILED,
    GOES_ON,
    HOPELESS,
    change,
    graze,
    make_again,
    take_up,
)
from antenna_pin.run.engine.gross_kernels import turn_back
from antenna_pin.run.engine.pace_kernels import cut, following, hopeless, note_size, shortened
from antenna_pin.run.engine.stretch_kernels import (
    AGAIN,
    CHANGES,
    FREELY,
    FRESH,
    MEETS,
    SINGLY,
    STANDS,
    Loop,
    accept,
    is_full,
    keep,
    prepare,
    samples_in,
    start_row,
    try_step,
)
from antenna_pin.run.engine.watch_kernels import may_happen

# Further reasons for the outer loop: the end of the run; the budget, or a full buffer; the first step cut by
# the run's end, before it is made; a trial step with a possible event, or with one at ``until``; a
# contact that changes before the event at the end of a step; a step that is made, or a change;
# a contact that is too deep; steps too short to advance time; too many rejected steps.
ENDED = 3
PAUSED = 4
CUT_BY_END = 5
TRIAL_STANDS = 6
EVENT = 7
MET = 8
MOVED_ON = 9
TOO_DEEP = 10
STANDS_STILL = 11
NO_WAY = 12

REJECTED_IN_A_ROW = 1000


@released
def go_on(loop: Loop) -> int:
    """Make steps until the outer loop must act; return the reason (see above)."""
    s = loop.stretch[0]
    s.known = 0
    s.ended = 0
    s.flipped = 0
    reason = GOES_ON
    while reason == GOES_ON:
        if s.phase == FRESH:
            if s.accepted + s.rejected + s.relocated >= s.budget or _is_shown(loop):
                return PAUSED
            if s.t >= s.end:
                return ENDED
            if is_full(loop):
                return PAUSED
            s.wished = s.h
            s.in_row = 0
            s.phase = AGAIN
        if s.phase == AGAIN:
            reason = _try(loop)
        elif s.phase == STANDS:
            reason = _search(loop)
        elif s.phase == MEETS:
            reason = _meet(loop)
        else:
            reason = _in_turn(loop, change(loop))
    return reason


@released
def end_at(loop: Loop, size: float, longest: float, search: bool) -> int:
    """Repeat the trial step to end at an event (:func:`make_again`), and accept it.

    The buffers have space once :func:`go_on` has returned EVENT. ``search``: whether earlier changes of
    contacts are searched; :func:`go_on` handles such a change.
    """
    s = loop.stretch[0]
    s.phase = STANDS
    reason = make_again(loop, -1, 0.0, size, longest)
    if reason != GOES_ON or s.phase == FRESH:
        return reason
    s.until = 2.0
    s.watched = 1
    if not search:
        reason = take_up(loop)
        return MOVED_ON if reason == GOES_ON else reason
    reason = _search(loop)
    return MET if reason == GOES_ON else reason


@inlined
def _in_turn(loop: Loop, reason: int) -> int:
    """Return the next state of the loop behind a completed part."""
    return MOVED_ON if reason == GOES_ON and loop.stretch[0].watched != 0 else reason


@inlined
def _is_shown(loop: Loop) -> bool:
    """Return whether the outer loop must process the step."""
    s = loop.stretch[0]
    return bool(s.shown != FREELY and (s.flipped != 0 or (s.shown == SINGLY and s.accepted > 0)))


@inlined
def _has_room(loop: Loop) -> bool:
    """Return whether buffers suffice for the samples of the trial step and an event."""
    s = loop.stretch[0]
    s.needed = samples_in(loop, s.tried) + 2 * loop.search.ignore.shape[0] + 4
    return bool(s.samples + s.needed <= loop.buffers.times.shape[0])


@inlined
def _try(loop: Loop) -> int:
    """Try a step; if accepted, prepare its inspection."""
    s, pace, outside = loop.stretch[0], loop.pace, loop.numbers.outside
    tried, by_end = cut(pace, loop.breaks, s.t, s.h)
    if by_end and s.cut == 0:
        s.cut = 1
        return CUT_BY_END
    s.tried = tried
    if s.t + tried == s.t:
        return STANDS_STILL
    error = try_step(loop, tried)
    if has_failed(outside):
        return FAILED
    if not error <= 1.0:
        s.in_row += 1
        s.rejected += 1
        if s.in_row >= REJECTED_IN_A_ROW:
            return NO_WAY
        s.h = shortened(pace, tried, error)
        return HOPELESS if hopeless(pace, s.h) else GOES_ON
    s.h = following(pace, s.h, tried, error, s.in_row > 0)
    s.phase = STANDS
    s.until = 2.0
    s.watched = 0
    watched = loop.watched
    events = watched.functions.shape[0] + watched.instants.shape[0] + watched.unknown
    if events > 0:  # watched functions are evaluated
        s.ended = 0
    if loop.search.ignore.shape[0] > 0 or events > 0 or samples_in(loop, tried) > 0:
        prepare(loop)
    elif turn_back(loop.works, loop.tableau, loop.space, loop.work):
        prepare(loop)
    if events > 0 and may_happen(
        s.t,
        tried,
        loop.space,
        loop.dense,
        loop.work,
        start_row(loop),
        loop.buffers.out,
        loop.numbers,
        watched,
    ):
        s.watched = 1
    if has_failed(outside):
        return FAILED
    return TRIAL_STANDS if s.watched != 0 else GOES_ON


@inlined
def _search(loop: Loop) -> int:
    """Search the trial step for the first contact event; accept it if none."""
    s, search = loop.stretch[0], loop.search
    if not _has_room(loop):
        return PAUSED
    s.contact = -1
    if search.ignore.shape[0] > 0:
        c, theta, deep = inspect_step(
            s.t,
            s.tried,
            s.until,
            search.nodes,
            search.ignore,
            search.limits,
            search.peaks,
            loop.trial,
            (s.known != 0, s.ended != 0),
        )
        s.known = 0
        if has_failed(loop.numbers.outside):
            return FAILED
        if c >= 0:
            s.contact = c
            s.theta = theta
            s.deep = 1 if deep else 0
            s.phase = MEETS
            return GOES_ON
    if s.until <= 1.0:
        return EVENT
    if search.ignore.shape[0] > 0:
        keep(loop)
        s.known = 1
    accept(loop)
    if has_failed(loop.numbers.outside):
        return FAILED
    return _in_turn(loop, GOES_ON)


@kernel
def _meet(loop: Loop) -> int:
    """Make the trial step again to end where its contact changes, or is too deep."""
    s, c = loop.stretch[0], loop.stretch[0].contact
    if s.deep == 0:
        note_size(loop.sizes, loop.book.memory, s.h)
    if s.theta > 0.0:
        level = -loop.search.limits[c] if s.deep != 0 else 0.0
        reason = make_again(loop, c, level, s.theta * s.tried, s.tried)
        if reason != GOES_ON:
            return reason
        if s.phase == FRESH:  # a shorter step is tried
            return _in_turn(loop, GOES_ON)
        reason = take_up(loop)
        if reason != GOES_ON:
            return reason
    elif s.deep == 0 and loop.search.ignore[c] != 0:
        return _in_turn(loop, graze(loop))
    if s.deep != 0:
        s.phase = FRESH
        return TOO_DEEP
    s.phase = CHANGES
    return _in_turn(loop, GOES_ON)
