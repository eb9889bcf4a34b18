r"""A signal on an even grid, without folding.

:mod:`antenna_pin.analysis.spectrum` gives the reason. Of a signal that is too long for memory any stretch of
the grid can be had by itself (:class:`EvenSignal`).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np
import scipy
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import LONG, ROWS
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError

#: Returns the samples of a signal from one number up to, not including, another: (m,) or (m, k).
Read = Callable[[int, int], Array]

LEAST_SAMPLES = 16
_OVERSAMPLING = 16
_AT_ONCE = 8192  # points of the grid that are filtered at once
_PAD = 10  # points of the grid that the filter reaches to either side
_AROUND = 8  # samples beside those of a part that the cubic through them is made of; it looks at three


class UniformSignal(NamedTuple):
    """A signal on an even grid."""

    time: Array  # (n,) [s]
    values: Array  # (n,) or (n, k)
    rate: float  # samples per time [Hz]


@takes(rate="Hz")
def uniform(time: ArrayLike, values: ArrayLike, rate: float | None = None) -> UniformSignal:
    """Return a signal on an even grid, without folding.

    A signal that lies on an even grid of the rate already is returned as it is.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,) or (n, k).
        rate: Of the grid [Hz]; the run's output rate (the commonest spacing) if left out.

    Returns:
        Times from the first to the last sample, values there, and the rate.

    Raises:
        InvalidParameterError: Fewer than 16 instants, a value that is not finite, or a rate that gives fewer
            than 16 grid points.
    """
    t, x = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if t.ndim != 1 or x.ndim not in (1, 2) or x.shape[:1] != t.shape:
        seen = f"{x.shape} values at {t.shape} times"
        raise InvalidParameterError("spectrum", "values", "(n,) or (n, k), one row per time", seen)
    t, x = _single(t, x)
    if t.size < LEAST_SAMPLES:
        raise InvalidParameterError("spectrum", "time", f"{LEAST_SAMPLES} instants or more", t.size)
    _check_finite(x)
    step, count = _grid(t, rate)
    grid = t[0] + step * np.arange(count)
    if t.size == count and np.abs(t - grid).max() <= 1e-6 * step:
        return UniformSignal(grid, x, 1.0 / step)
    return UniformSignal(grid, _thinned(t, x, grid, step), 1.0 / step)


def _single(time: Array, values: Array) -> tuple[Array, Array]:
    """Return samples at one instant each: of several the first counts."""
    if not np.any(time[1:] <= time[:-1]):
        return time, values
    time, first = np.unique(time, return_index=True)
    return time, values[first]


def _check_finite(values: Array) -> None:
    if not np.isfinite(values).all():
        raise InvalidParameterError(
            "spectrum", "values", "finite; remove the samples that are not", "NaN or infinity"
        )


def _grid(time: Array, rate: float | None) -> tuple[float, int]:
    """Return step [s] and number of points of the even grid."""
    span = float(time[-1] - time[0])
    usual = _usual_step(time) if rate is None else 1.0 / rate
    if not usual > 0.0 or not span / usual >= LEAST_SAMPLES - 1 - 1e-6:
        rule = f"so high that {LEAST_SAMPLES} points lie in {span:.4g} s"
        raise InvalidParameterError("spectrum", "rate", rule, rate)
    count = math.floor(span / usual + 1e-6) + 1
    return span / (count - 1) if abs(span / usual - (count - 1)) < 1e-6 * count else usual, count


def _usual_step(time: Array) -> float:
    """Return the commonest spacing of samples [s], of a long run of its start.

    Half of the steps or more are the output step, whatever events lie between.
    """
    steps = np.diff(time[: LONG + 1])
    steps = steps[steps > 0.0] if time.size > LONG else steps
    return float(np.median(steps[steps >= np.median(steps)]))


def _thinned(t: Array, x: Array, grid: Array, step: float) -> Array:
    """Return averages over fine cells, filtered and thinned to the grid."""
    fine = step / _OVERSAMPLING
    cells = (grid.size - 1) * _OVERSAMPLING + 1  # centred on the fine grid, which has the grid's points
    curve: Any = None
    primitive: Any = None

    def averages(begin: int, last: int) -> Array:
        """Return averages over some of the cells."""
        nonlocal curve, primitive
        edges = grid[0] + fine * (np.arange(begin, last + 1) - 0.5)  # centred on the fine grid
        inside = np.clip(edges, t[0], t[-1])
        if curve is None or t.size > LONG:
            # The cubic is local: of a long signal the one through the samples around is enough.
            low, high = 0, t.size
            if t.size > LONG:
                low = max(int(np.searchsorted(t, inside[0])) - _AROUND, 0)
                high = int(np.searchsorted(t, inside[-1], side="right")) + _AROUND
            curve = scipy.interpolate.Akima1DInterpolator(t[low:high], x[low:high], axis=0, method="makima")
            primitive = curve.antiderivative()
        # Beyond the ends, by half a cell, it goes on straight.
        beyond = (edges - inside).reshape(-1, *[1] * (x.ndim - 1))
        more = beyond * (curve(inside) + 0.5 * beyond * curve(inside, nu=1))
        return np.asarray(np.diff(primitive(inside) + more, axis=0) / fine)

    pad = _PAD * _OVERSAMPLING
    taps = scipy.signal.firwin(2 * pad + 1, 0.9 / _OVERSAMPLING, window=("kaiser", 8.0))
    taps = taps.reshape(taps.size, *[1] * (x.ndim - 1))
    found = np.empty((grid.size, *x.shape[1:]))
    # Part by part: there are more cells than samples, by far.
    for begin in range(0, grid.size, _AT_ONCE):
        end = min(begin + _AT_ONCE, grid.size)
        low, high = begin * _OVERSAMPLING - pad, (end - 1) * _OVERSAMPLING + pad + 1
        part = averages(max(low, 0), min(high, cells))
        # Odd about both ends, so that no jump is made there.
        if low < 0:
            start = averages(0, pad + 1)
            part = np.concatenate([2 * start[0] - start[-low:0:-1], part])
        if high > cells:
            stop = averages(cells - pad - 1, cells)
            part = np.concatenate([part, 2 * stop[-1] - stop[-2 : -2 - (high - cells) : -1]])
        found[begin:end] = scipy.signal.oaconvolve(part, taps, mode="valid", axes=0)[::_OVERSAMPLING]
    return found


class EvenSignal:
    """Signal on an even grid that is too long for memory, as :func:`uniform`.

    Raises:
        InvalidParameterError: Fewer than 16 instants, or a rate that gives fewer than 16 grid points.
    """

    def __init__(self, time: Array, read: Read, rate: float | None = None) -> None:
        if time.size < LEAST_SAMPLES or not time[LEAST_SAMPLES - 1] > time[0]:
            raise InvalidParameterError("spectrum", "time", f"{LEAST_SAMPLES} instants or more", time.size)
        self._time, self._read = time, read
        self._step, self.size = _grid(time, rate)
        self._is_even = time.size == self.size and all(
            np.abs(time[k : k + ROWS] - self.times(k, min(k + ROWS, self.size))).max() <= 1e-6 * self._step
            for k in range(0, self.size, ROWS)
        )

    @property
    def rate(self) -> float:
        """Points of the grid per time [Hz]."""
        return 1.0 / self._step

    def times(self, begin: int, last: int) -> Array:
        """Return the instants of some points [s]."""
        return np.asarray(self._time[0] + self._step * np.arange(begin, last))

    def values(self, begin: int, last: int) -> Array:
        """Return the signal at some points, (m,) or (m, k).

        Raises:
            InvalidParameterError: A value that is not finite.
        """
        if self._is_even:
            found = self._read(begin, last)
            _check_finite(found)
            return found
        parts = []
        for start in range(begin, last, ROWS):
            end = min(start + ROWS, last)
            # Near its ends a part differs from the whole signal: it is cut out of a longer one.
            low, high = max(start - 2 * _PAD, 0), min(end + 2 * _PAD, self.size)
            grid = self.times(low, high)
            sample = max(int(np.searchsorted(self._time, grid[0])) - 2 * _AROUND, 0)
            beyond = int(np.searchsorted(self._time, grid[-1], side="right")) + 2 * _AROUND
            beyond = self._time.size if high == self.size else beyond
            time, values = self._time[sample:beyond], self._read(sample, beyond)
            _check_finite(values)
            parts.append(_thinned(*_single(time, values), grid, self._step)[start - low : end - low])
        return np.concatenate(parts)


# --- spectra of long signals --------------------------------------------------------------------------------

# Points of the longest window of a mean spectrum, and of a spectrogram's.
_SPECTRUM = 2**18
_SPECTROGRAM = 2**13
# Instants of a spectrogram.
_COLUMNS = 77


@takes()
def long_spectrum(time: Array, read: Read) -> xr.Dataset:
    """Return the one-sided power spectral density of a long signal.

    Welch's method with Hann windows that overlap by half, the mean taken off each, as
    :func:`antenna_pin.analysis.spectrum` has it: three windows of half the signal each, or more of 262,144
    points of the even grid where that is less.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        read: Gives the samples, (m, k).

    Returns:
        Over ``frequency`` [Hz] and ``component``: ``power`` [units^2/Hz]. Attributes: ``rate`` of the grid
        [Hz], ``segment``, the length of a window [s], and ``segments``, how many were averaged.
    """
    even = EvenSignal(time, read)
    length = max(min(round(0.5 * (time[-1] - time[0]) * even.rate), _SPECTRUM), LEAST_SAMPLES)
    hop = length - length // 2
    starts = range(0, even.size - length + 1, hop)
    values, frequency = np.zeros((0, 1)), np.zeros(0)
    total: Array | float = 0.0
    for start in starts:
        fresh = even.values(start + len(values), start + length)
        values = np.concatenate([values, fresh]) if len(values) else fresh
        # One after the other: what a transform needs besides is many times the window.
        powers = []
        for column in values.T:
            frequency, power = scipy.signal.welch(column, even.rate, window="hann", nperseg=length)
            powers.append(power)
        total = total + np.stack(powers, axis=1)
        values = values[hop:]
    return xr.Dataset(
        {"power": (("frequency", "component"), np.asarray(total) / len(starts))},
        coords={"frequency": ("frequency", frequency, {"units": "Hz"})},
        attrs={"rate": even.rate, "segment": length / even.rate, "segments": len(starts)},
    )


@takes()
def long_spectrogram(time: Array, read: Read) -> xr.Dataset:
    """Return the power spectral density of a long signal as it changes with time.

    Hann windows of a twentieth of the signal, or of 8192 points of the even grid where that is less, that
    overlap by three quarters. At each of 77 instants the mean over the windows of that part of the time.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        read: Gives the samples, (m, k).

    Returns:
        ``power`` (frequency, time) [units^2/Hz], one-sided, the sum over components. Attributes: ``rate`` of
        the grid [Hz], ``segment``, the length of a window [s], and ``segments``, how many there are.
    """
    even = EvenSignal(time, read)
    length = min(round(even.size / 20.0), _SPECTROGRAM)
    starts = np.arange(0, even.size - length + 1, max(1, length // 4))
    columns = np.array_split(starts, min(_COLUMNS, starts.size))
    middles, maps, frequency = [], [], np.zeros(0)
    for mine in columns:
        first = int(mine[0])
        values = even.values(first, int(mine[-1]) + length)
        total: Array | float = 0.0
        for start in mine - first:
            part = values[start : start + length]
            frequency, power = scipy.signal.periodogram(part, even.rate, window="hann", detrend=False, axis=0)
            total = total + power.sum(axis=1)
        maps.append(np.asarray(total) / mine.size)
        middles.append(float(even.times(first, first + 1)[0] + 0.5 * (mine[-1] - first + length) / even.rate))
    return xr.Dataset(
        {"power": (("frequency", "time"), np.stack(maps, axis=1))},
        coords={
            "frequency": ("frequency", frequency, {"units": "Hz"}),
            "time": ("time", middles, {"units": "s"}),
        },
        attrs={"rate": even.rate, "segment": length / even.rate, "segments": starts.size},
    )


def long_amplitudes(
    even: EvenSignal, trend: Literal["constant", "linear"]
) -> tuple[Array, int, float, float]:
    """Return scaled magnitudes of the transform of a long signal under a Hann window.

    Returns:
        Magnitudes, (n // 2 + 1,); of how many points of the grid, n: the most of which transforms are cheap;
        largest size and extent of the signal.
    """
    n = scipy.fft.prev_fast_len(even.size, real=True)
    values = np.empty(n)
    parts = [slice(first, min(first + ROWS, n)) for first in range(0, n, ROWS)]
    for part in parts:
        values[part] = even.values(part.start, part.stop)
    low, high = float(values.min()), float(values.max())
    values -= values.mean()
    numbers = (np.arange(part.start, part.stop) for part in parts)
    slope = 0.0
    if trend == "linear":
        slope = sum(float((k - 0.5 * (n - 1)) @ values[k[0] : k[-1] + 1]) for k in numbers)
        slope /= n * (n * n - 1.0) / 12.0
        numbers = (np.arange(part.start, part.stop) for part in parts)
    for part, k in zip(parts, numbers, strict=True):
        hann = 0.5 - 0.5 * np.cos(2.0 * np.pi * k / n)
        values[part] = (values[part] - slope * (k - 0.5 * (n - 1))) * hann
    # The window's sum is n / 2.
    return np.abs(np.fft.rfft(values)) / (0.5 * n), n, max(abs(low), abs(high)), high - low
