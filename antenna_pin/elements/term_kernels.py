"""References over time, compiled: sums of terms, each a value with its first two derivatives.

Before its begin a term has the value that it begins with, and stands still.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel, record
from antenna_pin.records import layout, words_of

#: A term: what it is, how many words it has in all, how many pieces (swings) follow, when it begins [s], how
#: long it lasts or after what time it comes again [s] (0: never), its size, and numbers of its own.
TERM = layout(
    ("kind", "i8"),
    ("length", "i8"),
    ("count", "i8"),
    ("begin", "f8"),
    ("span", "f8"),
    ("amount", "f8"),
    ("first", "f8"),
    ("second", "f8"),
    ("phase", "f8"),
)
SIZE = words_of(TERM)
#: Pieces of polynomials: behind the record the times between them (count + 1), then ``POWERS`` coefficients
#: of each piece from the constant on, of the time since its begin. Beyond the last time its end is held; with
#: a span all comes again after it.
PIECES = 0
#: ``amount`` sin(``first`` t + ``phase``), first an angular frequency.
SINE = 1
#: A sine whose angular frequency goes from ``first`` by ``second`` a second, over ``span``, and then stays.
CHIRP = 2
#: One whose angular frequency goes from ``first`` by factors: times exp(``second`` t).
SWEEP = 3
#: From 0 to ``amount`` over ``span``, as a point of a wheel that rolls on: t/T - sin(2 pi t/T) / 2 pi.
CYCLOID = 4
#: ``count`` sines: behind the record amplitude, angular frequency and phase of each.
SINES = 5
POWERS = 8


@inlined
def _pieces(words: Any, at: int, term: Any, t: float) -> tuple[float, float, float]:
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
    c = times + n + 1 + POWERS * low
    for k in range(POWERS - 1, -1, -1):
        acceleration = acceleration * s + 2.0 * rate
        rate = rate * s + value
        value = value * s + words[c + k]
    if not first <= own <= last:
        rate = acceleration = 0.0
    return value, rate, acceleration


@inlined
def _swing(size: float, angle: float, omega: float, growth: float) -> tuple[float, float, float]:
    """Return size times the sine of an angle with a rate and its own rate, and two derivatives."""
    sine, cosine = size * math.sin(angle), size * math.cos(angle)
    return sine, omega * cosine, growth * cosine - omega * omega * sine


@inlined
def _chirp(term: Any, t: float) -> tuple[float, float, float]:
    s = t - term.begin
    if s < 0.0:
        return term.amount * math.sin(term.phase), 0.0, 0.0
    own = min(s, term.span)
    growth = term.second if s < term.span else 0.0
    if term.kind == CHIRP:
        omega = term.first + term.second * own
        angle = (term.first + 0.5 * term.second * own) * own
    else:
        # (exp(g t) - 1) / g by expm1: right where g t is small.
        omega = term.first * math.exp(term.second * own)
        angle = term.first * math.expm1(term.second * own) / term.second
        growth *= omega
    angle += omega * (s - own) + term.phase
    return _swing(term.amount, angle, omega, growth)


@inlined
def _cycloid(term: Any, t: float) -> tuple[float, float, float]:
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
def course(words: Any, at: int, end: int, t: float) -> tuple[float, float, float]:
    """Value, rate and acceleration at time t [s] of the sum of the terms in words[at:end]."""
    value = rate = acceleration = 0.0
    while at < end:
        term = record(words[at : at + SIZE], TERM)
        a = b = c = 0.0
        if term.kind == PIECES:
            a, b, c = _pieces(words, at, term, t)
        elif term.kind == SINE:
            a, b, c = _swing(term.amount, term.first * t + term.phase, term.first, 0.0)
        elif term.kind == CYCLOID:
            a, b, c = _cycloid(term, t)
        elif term.kind == SINES:
            for k in range(at + SIZE, at + SIZE + 3 * term.count, 3):
                one = _swing(words[k], words[k + 1] * t + words[k + 2], words[k + 1], 0.0)
                a, b, c = a + one[0], b + one[1], c + one[2]
        else:
            a, b, c = _chirp(term, t)
        value += a
        rate += b
        acceleration += c
        at += term.length
    return value, rate, acceleration
