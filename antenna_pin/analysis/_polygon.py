"""A signal between its samples taken as straight, and what follows exactly: integrals, means, extremes.

Of a polygon the mean over a window is a quadratic function of the window's place, piece by piece: a piece
ends where an end of the window passes a sample. So extremes of means, and of differences with them, are
found in closed form.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

__all__ = ["Polygon", "Quadratics", "RangeMaximum"]

Array = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Quadratics:
    """Functions ``c0 + c1 x + c2 x^2`` on ``0 <= x <= h``, vector-valued.

    Attributes:
        c0: (pieces, k).
        c1: (pieces, k).
        c2: (pieces, k).
        h: (pieces,).
    """

    c0: Array
    c1: Array
    c2: Array
    h: Array

    def __sub__(self, other: Quadratics) -> Quadratics:
        return Quadratics(self.c0 - other.c0, self.c1 - other.c1, self.c2 - other.c2, self.h)

    def highest(self, direction: Array) -> Array:
        """Return the largest component along a direction in each piece, (pieces,)."""
        c0, c1, c2 = self.c0 @ direction, self.c1 @ direction, self.c2 @ direction
        found = np.maximum(c0, c0 + self.h * (c1 + self.h * c2))
        bent = c2 < 0.0
        vertex = np.clip(np.divide(-0.5 * c1, c2, out=np.zeros_like(c1), where=bent), 0.0, self.h)
        return np.asarray(np.maximum(found, c0 + vertex * (c1 + vertex * c2)))


class Polygon:
    """A vector-valued signal, straight between samples; two samples at one time make a jump.

    Args:
        time: Not decreasing, (n,) [s].
        values: (n, k).
    """

    def __init__(self, time: Array, values: Array) -> None:
        self.time, self.values = time, values

    # What windows need is made when it is asked for: it takes as much room as the signal.
    @cached_property
    def _slope(self) -> Array:
        return self._slopes(slice(None))

    @cached_property
    def _integral(self) -> Array:
        span = np.diff(self.time)[:, None]
        parts = 0.5 * span * (self.values[1:] + self.values[:-1])
        return np.concatenate([np.zeros((1, self.values.shape[1])), np.cumsum(parts, axis=0)])

    def _slopes(self, segment: Indices | slice) -> Array:
        """Return the slopes of segments, (m, k)."""
        span = (self.time[1:][segment] - self.time[:-1][segment])[:, None]
        rise = self.values[1:][segment] - self.values[:-1][segment]
        return np.divide(rise, span, out=np.zeros_like(rise), where=span > 0.0)

    @property
    def start(self) -> float:
        """Time of the first sample [s]."""
        return float(self.time[0])

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return float(self.time[-1])

    def at(self, times: Array) -> Array:
        """Return the signal at times (m,), after the jump where there is one: (m, k)."""
        if self.time.size == 1:
            return np.repeat(self.values, times.size, axis=0)
        segment = self._segment(times)
        return np.asarray(
            self.values[segment] + self._slopes(segment) * (times - self.time[segment])[:, None]
        )

    def means(self, starts: Array, window: float) -> Array:
        """Return the means over windows that start at times (m,): (m, k)."""
        ends = starts + window
        after, before = (
            self._primitive(ends, self._segment(ends)),
            self._primitive(starts, self._segment(starts)),
        )
        return (after - before) / window

    def breaks(self, low: float, high: float, offsets: Sequence[float]) -> Array:
        """Return where pieces end: ``low``, ``high``, and where place + offset passes a sample between."""
        found = np.concatenate([self.time - offset for offset in offsets])
        slack = 1e-13 * max(abs(self.start), abs(self.end), self.end - self.start)
        found = np.unique(found[(found > low + slack) & (found < high - slack)])
        found = np.concatenate([[low], found, [high]])
        # Neighbours that differ by round-off are one.
        keep = np.concatenate([[True], np.diff(found[:-1]) > slack, [True]])
        return np.asarray(found[keep])

    def pieces(self, breaks: Array, offset: float) -> Quadratics:
        """Return the signal at place + offset, piece by piece."""
        segment = self._segment(0.5 * (breaks[1:] + breaks[:-1]) + offset)
        slope = self._slope[segment]
        return Quadratics(
            self._value(breaks[:-1] + offset, segment), slope, np.zeros_like(slope), np.diff(breaks)
        )

    def mean_pieces(self, breaks: Array, window: float, offset: float = 0.0) -> Quadratics:
        """Return the mean over a window that starts at place + offset, piece by piece."""
        middle = 0.5 * (breaks[1:] + breaks[:-1]) + offset
        first, last = self._segment(middle), self._segment(middle + window)
        start = breaks[:-1] + offset
        end = start + window
        return Quadratics(
            (self._primitive(end, last) - self._primitive(start, first)) / window,
            (self._value(end, last) - self._value(start, first)) / window,
            0.5 * (self._slope[last] - self._slope[first]) / window,
            np.diff(breaks),
        )

    def _segment(self, times: Array) -> Indices:
        found = np.searchsorted(self.time, times, side="right") - 1
        return np.clip(found, 0, self.time.size - 2)

    def _value(self, times: Array, segment: Indices) -> Array:
        return np.asarray(self.values[segment] + self._slope[segment] * (times - self.time[segment])[:, None])

    def _primitive(self, times: Array, segment: Indices) -> Array:
        x = (times - self.time[segment])[:, None]
        return np.asarray(
            self._integral[segment] + x * (self.values[segment] + 0.5 * x * self._slope[segment])
        )


class RangeMaximum:
    """Largest of consecutive numbers, for many ranges at once (a table of maxima over powers of two).

    Args:
        first: First index of each range, (m,).
        last: Last index of each range, (m,); a range whose last is before its first is empty.
    """

    def __init__(self, first: Indices, last: Indices) -> None:
        self._first, self._last = first, last
        self._empty = last < first
        length = np.where(self._empty, 1, last - first + 1)
        self._level = np.floor(np.log2(length)).astype(int)

    def of(self, numbers: Array) -> Array:
        """Return the largest number in each range, (m,); -inf where it is empty."""
        found = np.full(self._first.size, -np.inf)
        table, width = numbers, 1
        for level in range(int(self._level.max(initial=0)) + 1):
            mine = (self._level == level) & ~self._empty
            found[mine] = np.maximum(table[self._first[mine]], table[self._last[mine] - width + 1])
            if 2 * width <= numbers.size:
                table = np.maximum(table[: table.size - width], table[width:])
                width *= 2
        return found
