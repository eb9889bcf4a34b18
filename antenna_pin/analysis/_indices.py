"""Error indices of one signal, taken as straight between its samples: integrals, means, extremes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arrays import Array

# --- polygons -----------------------------------------------------------------------------------------------
#
# Of a polygon the mean over a window is a quadratic function of the window's place, piece by piece: a piece
# ends where an end of the window passes a sample. So extremes of means, and of differences with them, are
# found in closed form.

Indices = NDArray[np.intp]


@dataclass(frozen=True, slots=True, eq=False)
class Quadratics:
    """Functions ``c0 + c1 x + c2 x^2`` on ``0 <= x <= h``, vector-valued."""

    c0: Array  # (pieces, k)
    c1: Array  # (pieces, k)
    c2: Array  # (pieces, k)
    h: Array  # (pieces,)

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
    """A vector-valued signal, straight between samples; two samples at one time make a jump."""

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
    """Largest numbers of many index ranges, from a table of maxima over powers of two.

    A range whose last index is before its first is empty.
    """

    def __init__(self, begin: Indices, last: Indices) -> None:
        self._first, self._last = begin, last
        self._empty = last < begin
        length = np.where(self._empty, 1, last - begin + 1)
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


# --- indices ------------------------------------------------------------------------------------------------

Period = tuple[float, float]

# Directions at first; sectors above which they are cut no further, and the half angle below which [rad].
_DIRECTIONS, _MOST_SECTORS, _NARROW = 16, 200, 1e-6
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)


class Index(Protocol):
    """An index of one signal."""

    def highest(self, direction: Array) -> float:
        """Largest component along a direction, exact."""

    def samples(self, resolution: int) -> Array:
        """Values at equally likely places, (m, k)."""


@dataclass(frozen=True, slots=True)
class Absolute:
    """The instantaneous error."""

    signal: Polygon

    def highest(self, direction: Array) -> float:
        return float((self.signal.values @ direction).max())

    def samples(self, resolution: int) -> Array:
        return self.signal.at(_places(self.signal.start, self.signal.end, 100 * resolution))


class WindowMean:
    """Mean over a window that starts from ``low`` to ``high``."""

    def __init__(self, signal: Polygon, window: float, low: float, high: float) -> None:
        self._signal, self._window, self._low, self._high = signal, window, low, high
        breaks = signal.breaks(low, high, (0.0, window))
        self._pieces = signal.mean_pieces(breaks, window)

    def highest(self, direction: Array) -> float:
        return float(self._pieces.highest(direction).max())

    def samples(self, resolution: int) -> Array:
        return self.at(100 * resolution)

    def at(self, places: int) -> Array:
        """Return it at a number of places, (places, k)."""
        return self._signal.means(_places(self._low, self._high, places), self._window)


class Relative:
    """Error less its mean over a window that contains that time."""

    def __init__(self, signal: Polygon, window: float) -> None:
        self._signal, self._window = signal, window
        self._last = max(signal.start, signal.end - window)
        breaks = signal.breaks(signal.start, self._last, (0.0, window))
        means = signal.mean_pieces(breaks, window)
        # The polygon's extremes in a window are at its ends or at a sample between them.
        self._ends = (signal.pieces(breaks, 0.0) - means, signal.pieces(breaks, window) - means)
        self._less_mean = Quadratics(-means.c0, -means.c1, -means.c2, means.h)
        first = np.searchsorted(signal.time, breaks[1:], side="left")
        last = np.searchsorted(signal.time, breaks[:-1] + window, side="right") - 1
        self._between = RangeMaximum(first, last)

    def highest(self, direction: Array) -> float:
        peaks = self._between.of(self._signal.values @ direction) + self._less_mean.highest(direction)
        return float(max(peaks.max(), *(end.highest(direction).max() for end in self._ends)))

    def samples(self, resolution: int) -> Array:
        starts = _places(self._signal.start, self._last, resolution)
        part = np.arange(resolution)
        inside = self._window * (part + ((part * math.sqrt(2.0)) % 1.0)[:, None]) / resolution
        errors = self._signal.at((starts[:, None] + inside).ravel())
        means = np.repeat(self._signal.means(starts, self._window), resolution, axis=0)
        return errors - means


class Drift:
    """Difference of the means over two windows at a given spacing within one period."""

    def __init__(self, signal: Polygon, window: float, spacing: float, periods: Sequence[Period]) -> None:
        self._signal, self._window, self._spacing = signal, window, spacing
        self._places = [(low, max(low, high - spacing - window)) for low, high in periods]
        self._pieces = []
        for low, high in self._places:
            breaks = signal.breaks(low, high, (0.0, window, spacing, spacing + window))
            earlier, later = (signal.mean_pieces(breaks, window, offset) for offset in (0.0, spacing))
            self._pieces.append(later - earlier)

    def highest(self, direction: Array) -> float:
        return float(max(pieces.highest(direction).max() for pieces in self._pieces))

    def samples(self, resolution: int) -> Array:
        count = max(1, 100 * resolution // len(self._places))
        starts = np.concatenate([_places(low, high, count) for low, high in self._places])
        means = self._signal.means
        return means(starts + self._spacing, self._window) - means(starts, self._window)


class Reproducibility:
    """Difference of the means over two windows in different periods."""

    def __init__(self, signal: Polygon, window: float, periods: Sequence[Period]) -> None:
        self._means = [WindowMean(signal, window, low, max(low, high - window)) for low, high in periods]

    def highest(self, direction: Array) -> float:
        high = [mean.highest(direction) for mean in self._means]
        low = [-mean.highest(-direction) for mean in self._means]
        count = range(len(high))
        return max(high[i] - low[j] for i in count for j in count if i != j)

    def samples(self, resolution: int) -> Array:
        count = len(self._means)
        places = max(1, 2000 * resolution // (count * (count - 1)))
        means = [mean.at(places) for mean in self._means]
        # Each place of one window with another of the other's, in an order without rhythm.
        other = (places * ((np.arange(places) * _GOLDEN) % 1.0)).astype(int)
        return np.concatenate([means[i] - means[j][other] for i in range(count) for j in range(i)])


def _places(low: float, high: float, count: int) -> Array:
    """Return one place in each of equal parts of an interval.

    Where in its part, goes by the golden ratio: evenly spaced places would meet a periodic error at a few of
    its phases only.
    """
    part = np.arange(count)
    return np.asarray(low + (high - low) * (part + (part * _GOLDEN) % 1.0) / count)


def extremes(index: Index, size: int) -> tuple[float, float]:
    """Return the extremes of a number, or 0 and the greatest length of a vector."""
    if size == 1:
        return -index.highest(np.array([-1.0])), index.highest(np.array([1.0]))

    def along(angle: float) -> float:
        return index.highest(np.array([math.cos(angle), math.sin(angle)]))

    # The greatest length is the greatest component over all directions. In a sector that is at most the one
    # along its middle over the cosine of its half angle: sectors that may hold more than was found are cut in
    # three. Of a circle all may: then sectors are left that miss by 1 - cos(half), 3e-5 at most.
    half = math.pi / _DIRECTIONS
    sectors = [(along(2.0 * k * half), 2.0 * k * half) for k in range(_DIRECTIONS)]
    while half > _NARROW and len(sectors) <= _MOST_SECTORS:
        least = max(sectors)[0] * math.cos(half)
        half /= 3.0
        sectors = [
            sector
            for value, angle in sectors
            if value >= least
            for sector in (
                (value, angle),
                *((along(beside), beside) for beside in (angle - 2.0 * half, angle + 2.0 * half)),
            )
        ]
    best = max(sectors)
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(
        lambda angle: -along(angle),
        bounds=(best[1] - half, best[1] + half),
        method="bounded",
        options={"xatol": 1e-10},
    )
    return 0.0, max(best[0], -float(found.fun))
