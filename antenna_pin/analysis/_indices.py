"""The error indices of one signal: their extremes, exact, and values at equally likely places."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis._polygon import Polygon, Quadratics, RangeMaximum

__all__ = ["Absolute", "Drift", "Index", "Mean", "Period", "Relative", "Reproducibility", "extremes"]

Array = NDArray[np.float64]
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


class Mean:
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
    """Difference of the means over two windows a spacing apart, both in one of the periods."""

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
        self._means = [Mean(signal, window, low, max(low, high - window)) for low, high in periods]

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
    """Return the lowest and highest value of a number; 0 and the greatest length of a vector."""
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
