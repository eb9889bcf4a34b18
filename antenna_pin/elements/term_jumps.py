"""Jumps of courses over time: where the value or the rate of a sum of terms is not continuous.

The terms are those of :mod:`antenna_pin.elements.term_kernels`. Only pieces of polynomials and swept sines
can jump, where one piece ends and the next begins.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.records import words_of
from antenna_pin.elements import term_kernels as kernels

__all__ = ["TermJump", "continued", "jumps"]

Array = NDArray[np.float64]

# Of the size of the numbers that make up a value or a rate: a difference that is round-off.
_ROUND_OFF = 1e-9
# Times that are nearer than that are one: sums of a start and a duration, written down apart.
_ULPS = 8
_SWEPT_WORDS = words_of(kernels.SWEPT_PIECE)


class TermJump(NamedTuple):
    """A jump of a course.

    Attributes:
        time: When; of a course that comes again, the first time [s].
        begin: The same, or earlier by the round-off of times where several pieces end and begin [s].
        value: By how much the value jumps [rad] ([m]).
        rate: By how much the rate jumps [rad/s] ([m/s]).
        again: After what time it comes again [s]; 0: never.
    """

    time: float
    begin: float
    value: float
    rate: float
    again: float


@lru_cache(maxsize=8)
def jumps(terms: tuple[float, ...]) -> tuple[TermJump, ...]:
    """Return the jumps of a sum of terms that are more than round-off, in the order of time.

    Args:
        terms: As :meth:`antenna_pin.elements.reference.Reference.terms` returns them.
    """
    words = np.array(terms, dtype=float)
    parts: list[Array] = [np.zeros((6, 0))]
    for own, record in _terms(words):
        if record["kind"] == kernels.PIECES:
            rows = _between_pieces(own, record)
            parts.append(np.vstack([np.full(rows.shape[1], record["span"]), rows]))
        elif record["kind"] == kernels.SWEPT:
            rows = _between_sweeps(own)
            parts.append(np.vstack([np.zeros(rows.shape[1]), rows]))
    found = np.hstack(parts)
    found = found[:, np.lexsort((found[1], found[0]))]
    if not found.size:
        return ()
    again, time = found[:2]
    new = (np.diff(again) != 0.0) | (np.diff(time) > _ULPS * np.spacing(np.abs(time[1:])))
    firsts = np.flatnonzero(np.append(True, new))
    lasts = np.append(firsts[1:], found.shape[1]) - 1
    value, rate, size, speed = np.add.reduceat(found[2:], firsts, axis=1)
    value = np.where(np.abs(value) > _ROUND_OFF * size, value, 0.0)
    rate = np.where(np.abs(rate) > _ROUND_OFF * speed, rate, 0.0)
    rows = np.array([time[lasts], time[firsts], value, rate, again[firsts]])
    return tuple(sorted(TermJump(*row) for row in rows[:, (value != 0.0) | (rate != 0.0)].T.tolist()))


def continued(terms: ArrayLike, until: float) -> Array:
    """Return terms of a course that goes on smoothly from what it is before a time [s], (words,)."""
    words = np.array(terms, dtype=float)
    for own, record in _terms(words):
        n = int(record["count"])
        if record["kind"] == kernels.PIECES and record["span"] == 0.0:
            times, rows = _pieces(own, record)
            if times[0] >= until:  # not yet begun: it stands at its first value
                rows[0, 1:] = 0.0
                times[1:] = math.inf
            times[1:][times[1:] >= until] = math.inf
        elif record["kind"] == kernels.SWEPT:
            pieces = own[kernels.SIZE :][: n * _SWEPT_WORDS].view(kernels.SWEPT_PIECE)
            starts = pieces["start"][1:]
            starts[starts >= until] = math.inf
    return words


def _terms(words: Array) -> Iterator[tuple[Array, Any]]:
    """Yield the words of each term, a view, with its record."""
    at = 0
    while at < len(words):
        record = words[at : at + kernels.SIZE].view(kernels.TERM)[0]
        yield words[at : at + int(record["length"])], record
        at += int(record["length"])


def _pieces(own: Array, record: Any) -> tuple[Array, Array]:
    """Return times and coefficients of pieces of polynomials, as views."""
    n, powers = int(record["count"]), int(record["powers"])
    times = own[kernels.SIZE :][: n + 1]
    return times, own[kernels.SIZE + n + 1 :][: n * powers].reshape(n, powers)


def _between_pieces(own: Array, record: Any) -> Array:
    """Return time, jump of value and rate, and their sizes, at all ends of pieces, (5, ends)."""
    times, rows = _pieces(own, record)
    n, powers = rows.shape
    ends = np.isfinite(times[1:])
    lengths = np.where(ends, times[1:], times[:-1]) - times[:-1]
    k = np.arange(powers)
    reached = rows * lengths[:, None] ** k
    faster = rows[:, 1:] * k[1:] * lengths[:, None] ** k[:-1]
    slope = rows[:, 1] if powers > 1 else np.zeros(n)
    # Before the first piece and behind the last the value is held.
    before = np.array([[rows[0, 0], *reached.sum(axis=1)], [0.0, *faster.sum(axis=1)]])
    behind = np.array([[*rows[:, 0], reached[-1].sum()], [*slope, 0.0]])
    sizes = np.array([np.abs(reached).sum(axis=1), np.abs(faster).sum(axis=1)])
    around = np.maximum(np.insert(sizes, 0, 0.0, axis=1), np.append(sizes, np.zeros((2, 1)), axis=1))
    around = np.maximum(around, np.abs(behind))
    kept = np.append(True, ends)
    if record["span"] > 0.0:  # the first piece follows the last
        behind[:, -1] = behind[:, 0]
        around[:, -1] = np.maximum(around[:, -1], around[:, 0])
        kept[0] = False
    return np.vstack([times, behind - before, around])[:, kept]


def _between_sweeps(own: Array) -> Array:
    """Return the same of a swept sine, between its pieces."""
    own = own.copy()
    pieces = own[kernels.SIZE :].view(kernels.SWEPT_PIECE)
    times = pieces["start"][1:].copy()
    found = np.zeros((5, len(times)))
    for k, time in enumerate(times.tolist()):
        sides = []
        for j in (k, k + 1):
            one = np.concatenate([own[: kernels.SIZE], pieces[j : j + 1].view(np.float64)])
            head: Any = one[: kernels.SIZE].view(kernels.TERM)
            head["length"], head["count"] = len(one), 1
            sides.append(kernels.course(one, 0, len(one), time))
        height = [abs(float(pieces[j]["height"])) / _power(pieces[j], time) for j in (k, k + 1)]
        speed = [h * _omega(pieces[j], time) for h, j in zip(height, (k, k + 1), strict=True)]
        found[:, k] = time, sides[1][0] - sides[0][0], sides[1][1] - sides[0][1], max(height), max(speed)
    return found


def _omega(piece: Any, time: float) -> float:
    """Return the angular frequency of a piece of a swept sine at a time [rad/s]."""
    s = time - float(piece["start"])
    if piece["octaves"]:
        return float(piece["begin"] * math.exp(piece["growth"] * s))
    return float(piece["begin"] + piece["growth"] * s)


def _power(piece: Any, time: float) -> float:
    return float(_omega(piece, time) ** piece["power"]) if piece["power"] else 1.0
