r"""Signals between uneven samples: interpolation, and statistics weighted by time.

A run is sampled at its output rate and at every event, so samples crowd where something happens. A plain mean
over them would weigh impacts more than they last; here every sample counts for the time around it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import LONG, ROWS
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError

_FEW = 33  # levels that all segments of a polygon are compared with


@takes()
def resampled(
    time: ArrayLike, values: ArrayLike, at: ArrayLike, derivative: ArrayLike | None = None
) -> Array:
    """Return a smooth signal at other times; NaN outside its span.

    A cubic Hermite spline through values and derivatives if the derivative is known and finite, else a cubic
    spline through the values: both err by the fourth power of the spacing. Of samples at the same instant the
    first counts, and none that is not finite. It is for smooth signals: across a jump a spline overshoots.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,) or (n, k).
        at: Times wanted, (m,) [s].
        derivative: Time derivative of the values, like them [1/s].

    Returns:
        (m,) or (m, k), in the unit of the values.
    """
    own, first = np.unique(np.asarray(time, dtype=float), return_index=True)
    wanted = np.asarray(at, dtype=float)
    held = np.asarray(values, dtype=float)[first]
    finite = np.isfinite(held).reshape(own.size, -1).all(axis=1)
    own, first, held = own[finite], first[finite], held[finite]
    if own.size < 2:
        result = np.full((wanted.size, *held.shape[1:]), np.nan)
        if own.size:
            result[wanted == own[0]] = held[0]
        return result
    from scipy.interpolate import CubicHermiteSpline, CubicSpline  # a quarter of a second

    slope = None if derivative is None else np.asarray(derivative, dtype=float)[first]
    if slope is not None and np.isfinite(slope).all():
        spline = CubicHermiteSpline(own, held, slope, extrapolate=False)
    else:
        spline = CubicSpline(own, held, extrapolate=False)
    return np.asarray(spline(wanted), dtype=float)


def straight_line(x: Array, y: Array) -> tuple[float, float]:
    """Return slope and coefficient of determination of a straight line, by least squares."""
    dx, dy = x - x.mean(), y - y.mean()
    slope = float(dx @ dy / (dx @ dx))
    left = dy - slope * dx
    return slope, float(1.0 - left @ left / (dy @ dy))


class Mean:
    """Mean over time by the trapezoidal rule, of samples added part by part.

    In one part it is that of the rule over all, in several it differs from that by round-off.
    """

    def __init__(self) -> None:
        self._start: Any = None
        self._end: Any = None
        self._first: Any = None
        self._last: Any = None
        self._area: Any = 0.0

    def add(self, time: Array, values: Array) -> None:
        """Add samples."""
        if self._start is None:
            self._start, self._first = time[0], values[0]
        else:
            time, values = np.append(self._end, time), np.concatenate([self._last[None], values])
        self._area = np.trapezoid(values, time, axis=0) + self._area
        self._end, self._last = time[-1], values[-1]

    @property
    def value(self) -> Array:
        """The mean of all that has come, () or (...)."""
        if self._end == self._start:
            return np.asarray(self._first)
        return np.asarray(self._area / (self._end - self._start))


@takes()
def time_mean(time: ArrayLike, values: ArrayLike) -> Array:
    """Return the mean over time by the trapezoidal rule; of one instant, its value.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,) or (n, ...).

    Returns:
        () or (...), in the unit of the values.
    """
    return _mean_of(*_checked(time, values), lambda part: part)


def _mean_of(time: Array, values: Array, function: Callable[[Array], Array]) -> Array:
    """Return the mean of a function of samples, of many of them part by part."""
    mean = Mean()
    rows = time.size if time.size <= LONG else ROWS
    for first in range(0, time.size, rows):
        part = slice(first, first + rows)
        mean.add(time[part], function(values[part]))
    return mean.value


@takes()
def time_rms(time: ArrayLike, values: ArrayLike) -> Array:
    """Return the root mean square over time, the square integrated by the trapezoidal rule.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,) or (n, ...).

    Returns:
        () or (...), in the unit of the values.
    """
    return np.sqrt(_mean_of(*_checked(time, values), np.square))


@takes()
def time_percentiles(time: ArrayLike, values: ArrayLike, percent: ArrayLike) -> Array:
    """Return the percentiles of a signal over time.

    Exact for the polygon through the samples. A signal that rests at a value for a share of the time has that
    value as a whole range of percentiles.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,).
        percent: From 0 to 100, (p,) [%].

    Returns:
        (p,), in the unit of the values.
    """
    t, x = _checked(time, values)
    shares = np.atleast_1d(np.asarray(percent, dtype=float)) / 100.0
    if not np.all((shares >= 0.0) & (shares <= 1.0)):
        raise InvalidParameterError("time_percentiles", "percent", "from 0 to 100 [%]", percent)
    if t[-1] == t[0]:
        return np.full(shares.size, x[0])
    rows = t.size if t.size <= LONG else ROWS
    parts = [slice(first, first + rows + 1) for first in range(0, max(t.size - 1, 1), rows)]
    segments = (_Segments.of(t[part], x[part]) for part in parts)
    whole = sum(float(np.diff(t[part]).sum()) for part in parts)
    levels = np.unique(x)
    # Between which of a few levels each share lies is found from all segments; the rest from those there.
    few = np.unique(np.linspace(0, levels.size - 1, _FEW).astype(int))
    table = np.zeros(few.size)
    for one in segments:
        table += [one.below(levels[k], True) for k in few]
    found = np.minimum(np.searchsorted(table / whole, shares - 1e-15), few.size - 1)

    def quantile(share: float, place: int) -> float:
        if place == 0:
            return float(levels[0])
        first, last = int(few[place - 1]), int(few[place])
        near = [_Segments.of(t[part], x[part]).between(levels[first], levels[last]) for part in parts]
        under = sum(below for below, _ in near)

        def below(level: float, including: bool) -> float:
            """Return the share of the time below a level, or at it."""
            return (under + sum(one.below(level, including) for _, one in near)) / whole

        first += 1  # the least level that the polygon is not above for the share
        while first < last:
            middle = (first + last) // 2
            if below(levels[middle], True) >= share - 1e-15:
                last = middle
            else:
                first = middle + 1
        before, until = below(levels[first - 1], True), below(levels[first], False)
        if share >= until or until == before:
            return float(levels[first])
        # Between two levels of samples the share grows in a straight line.
        part = (share - before) / (until - before)
        return float(levels[first - 1] + part * (levels[first] - levels[first - 1]))

    return np.array([quantile(share, place) for share, place in zip(shares, found, strict=True)])


class _Segments(NamedTuple):
    """Straight segments of a polygon: their ends by size, and how long they last [s]."""

    low: Array
    high: Array
    time: Array

    @classmethod
    def of(cls, t: Array, x: Array) -> Self:
        """Return the segments between samples."""
        return cls(np.minimum(x[:-1], x[1:]), np.maximum(x[:-1], x[1:]), np.diff(t))

    def below(self, level: float, including: bool) -> float:
        """Return the time below a level, or at it [s]."""
        low, high, time = self
        rise = np.where(high > low, high - low, 1.0)
        rests = (low <= level) if including else (low < level)
        part = np.where(high > low, np.clip((level - low) / rise, 0.0, 1.0), rests)
        return float(part @ time)

    def between(self, low: float, high: float) -> tuple[float, Self]:
        """Return the time below two levels [s], and the segments between them."""
        under = self.high <= low
        mine = ~under & (self.low <= high)
        kept = type(self)(self.low[mine], self.high[mine], self.time[mine])
        return float(self.time[under].sum()), kept


def _checked(time: ArrayLike, values: ArrayLike) -> tuple[Array, Array]:
    t, x = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if t.ndim != 1 or t.size == 0 or x.shape[:1] != t.shape:
        raise InvalidParameterError(
            "samples", "values", "one per time, at least one", f"{x.shape} values at {t.shape} times"
        )
    if np.any(np.diff(t) < 0.0):
        raise InvalidParameterError("samples", "time", "not decreasing [s]", "times that go back")
    return t, x
