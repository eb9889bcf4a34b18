"""Courses over time, compiled: sums of terms, each a value with its first two derivatives.

Motions, controllers, forces and a shaken base follow them. Before its begin a term has the value that it
begins with, and stands still.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.compiled.lanes import LANES, lane, same_lane, sum_of_lane


class Term(Record):
    """The head of a term of a course."""

    kind: int  # SINE, PIECES, SWEPT, ...
    length: int  # words in all, head included
    count: int  # pieces (swings, lanes of lines) that follow
    powers: int  # coefficients of a piece; of lines the number of the first
    begin: float  # [s]
    span: float  # how long it lasts, or after what time it repeats [s]; 0: never
    amount: float  # its size, in the course's unit
    omega: float  # angular frequency [rad/s]
    phase: float  # [rad]


TERM = layout(Term)
SIZE = words_of(TERM)
#: Pieces of polynomials: behind the record the times between them (count + 1), then ``powers`` coefficients
#: of each piece from the constant on, of the time since its begin. Beyond the last time its end is held; with
#: a span all comes again after it.
PIECES = 0
#: ``amount`` sin(``omega`` t + ``phase``).
SINE = 1
#: A sine whose frequency is swept, in pieces: ``SWEPT_PIECE``.
SWEPT = 2
#: From 0 to ``amount`` over ``span``, as a point of a wheel that rolls on: t/T - sin(2 pi t/T) / 2 pi.
CYCLOID = 3
#: ``count`` sines: behind the record amplitude, angular frequency and phase of each.
SINES = 4
#: Many sines at equal spacing in frequency, which come again after ``span``: ``lines_kernels``.
LINES = 5
#: Most coefficients of a piece.
POWERS = 8


class SweptPieceRecord(Record):
    """A piece of a swept sine: amplitude ``height`` / omega^power, omega from ``begin`` on."""

    start: float  # [s]
    begin: float  # angular frequency at the start [rad/s]
    growth: float  # of the frequency: exp(growth s) in octaves [1/s], else linear [rad/s^2]
    octaves: int  # 1: logarithmic, 0: linear
    phase: float  # at the start [rad]
    height: float  # amplitude times omega^power
    power: int  # 0, 1 or 2


SWEPT_PIECE = layout(SweptPieceRecord)
_PIECE_SIZE = words_of(SWEPT_PIECE)


@inlined
def _pieces(words: Floats, at: int, term: Term, t: float) -> tuple[float, float, float]:
    n, times = term.count, at + SIZE
    own = t
    if term.span > 0.0:
        own -= term.span * math.floor((own - words[times]) / term.span)
    value = rate = acceleration = 0.0
    first, last = words[times], words[times + n]
    s = min(max(own, first), last)
    low, high = 0, n
    while high - low > 1:
        middle = (low + high) // 2
        if words[times + middle] <= s:
            low = middle
        else:
            high = middle
    s -= words[times + low]
    c = times + n + 1 + term.powers * low
    for k in range(term.powers - 1, -1, -1):
        acceleration = acceleration * s + 2.0 * rate
        rate = rate * s + value
        value = value * s + words[c + k]
    if not first <= own <= last:
        rate = acceleration = 0.0
    return value, rate, acceleration


@inlined
def _swing(size: float, angle: float, omega: float) -> tuple[float, float, float]:
    """Return size times the sine of an angle with a rate, and two derivatives."""
    sine, cosine = size * math.sin(angle), size * math.cos(angle)
    return sine, omega * cosine, -omega * omega * sine


@inlined
def _turned(p: SweptPieceRecord, s: float) -> tuple[float, float, float, float]:
    """Return phase since the piece's start, angular frequency and its two derivatives, after s."""
    if p.octaves == 0 or p.growth == 0.0:
        return (p.begin + 0.5 * p.growth * s) * s, p.begin + p.growth * s, p.growth, 0.0
    # (exp(g s) - 1) / g by expm1: right where g s is small.
    grown = p.begin * math.expm1(p.growth * s)
    omega = p.begin + grown
    return grown / p.growth, omega, p.growth * omega, p.growth * p.growth * omega


@inlined
def _swept(words: Floats, at: int, term: Term, t: float) -> tuple[float, float, float]:
    own = at + SIZE
    for _ in range(term.count - 1):
        if t < words[own + _PIECE_SIZE]:
            break
        own += _PIECE_SIZE
    p = record(words[own : own + _PIECE_SIZE], SWEPT_PIECE)
    turned, omega, slope, bend = _turned(p, t - p.start)
    # The amplitude D = height omega^-power with its derivatives.
    size, first, second = p.height, 0.0, 0.0
    if p.power > 0:
        for _ in range(p.power):
            size /= omega
        grows = slope / omega
        first = -p.power * size * grows
        second = p.power * size * ((p.power + 1) * grows * grows - bend / omega)
    sine, cosine = math.sin(turned + p.phase), math.cos(turned + p.phase)
    x = size * sine
    v = first * sine + size * omega * cosine
    a = (second - size * omega * omega) * sine + (2.0 * first * omega + size * slope) * cosine
    return x, v, a


@inlined
def _cycloid(term: Term, t: float) -> tuple[float, float, float]:
    s = (t - term.begin) / term.span
    if s <= 0.0:
        return 0.0, 0.0, 0.0
    if s >= 1.0:
        return term.amount, 0.0, 0.0
    turn = 2.0 * math.pi
    rate = term.amount * (1.0 - math.cos(turn * s)) / term.span
    return (
        term.amount * (s - math.sin(turn * s) / turn),
        rate,
        term.amount * turn * math.sin(turn * s) / term.span**2,
    )


@kernel
def course(words: Floats, at: int, end: int, t: float) -> tuple[float, float, float]:
    """Return value, rate and acceleration at time t [s] of the terms in words[at:end]."""
    value = rate = acceleration = 0.0
    while at < end:
        term = record(words[at : at + SIZE], TERM)
        a = b = c = 0.0
        if term.kind == PIECES:
            a, b, c = _pieces(words, at, term, t)
        elif term.kind == SINE:
            a, b, c = _swing(term.amount, term.omega * t + term.phase, term.omega)
        elif term.kind == CYCLOID:
            a, b, c = _cycloid(term, t)
        elif term.kind == SINES:
            for k in range(at + SIZE, at + SIZE + 3 * term.count, 3):
                one = _swing(words[k], words[k + 1] * t + words[k + 2], words[k + 1])
                a, b, c = a + one[0], b + one[1], c + one[2]
        elif term.kind == LINES:
            spacing, turns = 2.0 * math.pi / term.span, t / term.span
            turned = 2.0 * math.pi * (turns - math.floor(turns))
            a, b, c = lines(words, at + SIZE, term.count, term.powers, turned)
            b, c = spacing * b, spacing * spacing * c
        else:
            a, b, c = _swept(words, at, term, t)
        value += a
        rate += b
        acceleration += c
        at += term.length
    return value, rate, acceleration


# --- spectral lines -----------------------------------------------------------------------------------------


_FIRST = LANES * LANES + LANES
# Sines and cosines follow from those before by one product each; that often they are computed anew.
_ANEW = 64


@inlined
def _lanes_of(words: Floats, at: int, start: float, step: float) -> tuple[Any, Any]:
    """Return the cosines and the sines of start, start + step, ... as lanes."""
    cosines, sines = same_lane(0.0), same_lane(0.0)
    for k in range(LANES):
        own = lane(words, at + k * LANES)
        cosines = cosines + own * math.cos(start + k * step)
        sines = sines + own * math.sin(start + k * step)
    return cosines, sines


@kernel
def lines(words: Floats, at: int, groups: int, lowest: int, turned: float) -> tuple[float, float, float]:
    """Return the sum and its derivatives over the turn [1, 1/rad, 1/rad^2].

    The turn counts from the period's start.

    Args:
        words: In which the lines stand.
        at: Where.
        groups: How many lanes of them.
        lowest: Number of the first line: periods of it in one of all.
        turned: Turn since the start of the period, of line 1 [rad].
    """
    along_step, across_step = math.cos(LANES * turned), math.sin(LANES * turned)
    x, v, a = same_lane(0.0), same_lane(0.0), same_lane(0.0)
    cosines, sines = same_lane(0.0), same_lane(0.0)
    order = lane(words, at + LANES * LANES) + float(lowest)
    for k in range(groups):
        if k % _ANEW == 0:
            cosines, sines = _lanes_of(words, at, (lowest + LANES * k) * turned, turned)
        own = at + _FIRST + 2 * LANES * k
        p, r = lane(words, own), lane(words, own + LANES)
        swing = p * cosines - r * sines
        x = x + swing
        v = v + order * (p * sines + r * cosines)
        a = a + order * (order * swing)
        cosines, sines = (
            cosines * along_step - sines * across_step,
            sines * along_step + cosines * across_step,
        )
        order = order + float(LANES)
    return sum_of_lane(x), -sum_of_lane(v), -sum_of_lane(a)
