"""Curves through the points of a table, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined


@inlined
def _piece(words: Floats, at: int, points: int, t: float) -> int:
    """Return which of the pieces between a curve's points time t lies in."""
    low = 0
    high = points - 1
    while high - low > 1:
        middle = (low + high) // 2
        if words[at + middle] <= t:
            low = middle
        else:
            high = middle
    return low


@inlined
def curve(words: Floats, at: int, points: int, t: float) -> tuple[float, float]:
    """Return value and slope at t of the curve at words[at:], times then cubics."""
    low = _piece(words, at, points, t)
    s = t - words[at + low]
    c = at + points + 4 * low
    value = ((words[c] * s + words[c + 1]) * s + words[c + 2]) * s + words[c + 3]
    slope = (3.0 * words[c] * s + 2.0 * words[c + 1]) * s + words[c + 2]
    return float(value), float(slope)


@inlined
def area(words: Floats, at: int, points: int, t: float) -> float:
    """Return the integral up to t of the curve at words[at:]."""
    low = _piece(words, at, points, t)
    s = t - words[at + low]
    c = at + points + 4 * low
    own = (((words[c] / 4.0 * s + words[c + 1] / 3.0) * s + words[c + 2] / 2.0) * s + words[c + 3]) * s
    return float(words[at + points + 4 * (points - 1) + low] + own)
