"""Spectra of signals that are too long for memory: read part by part, in windows of a bounded length."""

from __future__ import annotations

from typing import Literal

import numpy as np
import scipy
import xarray as xr

from antenna_pin.analysis._run import Array
from antenna_pin.analysis.even import LEAST_SAMPLES, EvenSignal, Read
from antenna_pin.analysis.piecewise import ROWS
from antenna_pin.base.arguments import takes

__all__ = ["long_amplitudes", "long_spectrogram", "long_spectrum"]

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
    """Return the magnitudes of the transform of a long signal under a Hann window, over the window's sum.

    Args:
        even: The signal, of one component.
        trend: What is taken off first.

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
