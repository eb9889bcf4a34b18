r"""What frequencies a sampled signal holds: spectra, their peaks, and how they change with time.

Samples of a run are uneven: the output rate, and more of them at events. A spectrum needs an even grid, and
laying a signal with impacts on one naively folds what is faster than half the grid's rate back into the
spectrum. :func:`uniform` goes another way: a local cubic through the samples (modified Akima, which does not
ring at pulses) is averaged, exactly, over cells 16 times finer than the grid, which keeps its integral, and
these averages are filtered and thinned to the grid by a linear-phase low pass.

What a run did not sample is not known. A pulse shorter than the output step is seen at onset, peak and
release only: its integral is about a fifth low if it is half a sine, and its shape is not the true one. Among
samples of the plain output rate the cubic takes 0.3 % off a sine of a tenth of that rate, 3 % at a fifth,
13 % at three tenths. So read amplitudes below a fifth of the output rate, and raise the rate to see more.
"""

from __future__ import annotations

import math
from typing import Literal, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike
from scipy import signal
from scipy.interpolate import Akima1DInterpolator
from scipy.ndimage import median_filter

from antenna_pin.analysis._run import Array
from antenna_pin.analysis.blocks import LONG
from antenna_pin.errors import InvalidParameterError

__all__ = ["UniformSignal", "dominant_frequencies", "spectrogram", "spectrum", "uniform"]

_OVERSAMPLING = 16
_AT_ONCE = 8192  # points of the grid that are filtered at once
_AROUND = 8  # samples beside those of a part that the cubic through them is made of; it looks at three
_LEAST_SAMPLES = 16
_ROUND_OFF = 1e-10  # of the size of a quantity: what it varies by without a cause
_LEAST_SHARE = 1e-3  # of the strongest peak, for one to be named beside it


class UniformSignal(NamedTuple):
    """A signal on an even grid."""

    time: Array  # (n,) [s]
    values: Array  # (n,) or (n, k)
    rate: float  # samples per time [Hz]


def uniform(time: ArrayLike, values: ArrayLike, rate: float | None = None) -> UniformSignal:
    """Return a signal on an even grid, without folding; the module's text says how.

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
    if np.any(t[1:] <= t[:-1]):
        t, first = np.unique(t, return_index=True)
        x = x[first]
    if t.size < _LEAST_SAMPLES:
        raise InvalidParameterError("spectrum", "time", f"{_LEAST_SAMPLES} instants or more", t.size)
    if not np.isfinite(x).all():
        raise InvalidParameterError("spectrum", "values", "finite; cut off what is not", "NaN or infinity")
    span = float(t[-1] - t[0])
    usual = usual_step(t) if rate is None else 1.0 / rate
    if not usual > 0.0 or not span / usual >= _LEAST_SAMPLES - 1 - 1e-6:
        rule = f"so high that {_LEAST_SAMPLES} points lie in {span:.4g} s"
        raise InvalidParameterError("spectrum", "rate", rule, rate)
    count = math.floor(span / usual + 1e-6) + 1
    step = span / (count - 1) if abs(span / usual - (count - 1)) < 1e-6 * count else usual
    grid = t[0] + step * np.arange(count)
    if t.size == count and np.abs(t - grid).max() <= 1e-6 * step:
        return UniformSignal(grid, x, 1.0 / step)
    return UniformSignal(grid, _thinned(t, x, grid, step), 1.0 / step)


def usual_step(time: Array) -> float:
    """Return the commonest spacing of samples [s]; of a long run that of its first ones.

    Half of the steps or more are the output step, whatever events lie between.
    """
    steps = np.diff(time[: LONG + 1])
    return float(np.median(steps[steps >= np.median(steps)]))


def _thinned(t: Array, x: Array, grid: Array, step: float) -> Array:
    """Return averages over fine cells, filtered and thinned to the grid."""
    fine = step / _OVERSAMPLING
    cells = (
        grid.size - 1
    ) * _OVERSAMPLING + 1  # centred on the fine grid, so that the grid's points are in it
    curve = primitive = None

    def averages(first: int, last: int) -> Array:
        """Return those over some of the cells."""
        nonlocal curve, primitive
        edges = t[0] + fine * (np.arange(first, last + 1) - 0.5)  # centred on the fine grid
        inside = np.clip(edges, t[0], t[-1])
        if curve is None or primitive is None or t.size > LONG:
            # The cubic is local: of a long signal the one through the samples around is enough.
            low, high = 0, t.size
            if t.size > LONG:
                low = max(int(np.searchsorted(t, inside[0])) - _AROUND, 0)
                high = int(np.searchsorted(t, inside[-1], side="right")) + _AROUND
            curve = Akima1DInterpolator(t[low:high], x[low:high], axis=0, method="makima")
            primitive = curve.antiderivative()
        # Beyond the ends, by half a cell, it goes on straight.
        beyond = (edges - inside).reshape(-1, *[1] * (x.ndim - 1))
        more = beyond * (curve(inside) + 0.5 * beyond * curve(inside, nu=1))
        return np.asarray(np.diff(primitive(inside) + more, axis=0) / fine)

    pad = 10 * _OVERSAMPLING
    taps = signal.firwin(2 * pad + 1, 0.9 / _OVERSAMPLING, window=("kaiser", 8.0))
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
        found[begin:end] = signal.oaconvolve(part, taps, mode="valid", axes=0)[::_OVERSAMPLING]
    return found


def spectrum(
    time: ArrayLike,
    values: ArrayLike,
    *,
    rate: float | None = None,
    segment: float | None = None,
    units: str = "",
) -> xr.Dataset:
    """Return the one-sided amplitude spectral density of a signal.

    Welch's method with Hann windows that overlap by half, the mean taken off each; one window over the whole
    signal if no segment is given, which resolves most and averages nothing.

    Args:
        time: Sample times, not decreasing, uneven if need be, (n,) [s].
        values: Samples, (n,) or (n, k).
        rate: Of the even grid [Hz]; see :func:`uniform`.
        segment: Length of a window [s]; the whole signal if left out.
        units: Of the values.

    Returns:
        Over ``frequency`` [Hz] (and ``component``): ``density`` [units/sqrt(Hz)] and ``power`` [units^2/Hz],
        its square. Attributes: ``resolution``, the equivalent noise bandwidth of the window, 1.5 over its
        length [Hz]; ``segments``, how many were averaged; ``rate`` of the grid [Hz], half of which is the
        highest frequency. From 0.8 of that on the low pass of :func:`uniform` takes its share.
    """
    even = uniform(time, values, rate)
    length = _segment(even, segment)
    frequency, power = signal.welch(
        even.values, even.rate, window="hann", nperseg=length, noverlap=length // 2, axis=0
    )
    segments = 1 + (even.time.size - length) // (length - length // 2)
    dims = ("frequency",) if power.ndim == 1 else ("frequency", "component")
    return xr.Dataset(
        {
            "density": (
                dims,
                np.sqrt(power),
                {"units": _per(units, "sqrt(Hz)"), "long_name": "amplitude density"},
            ),
            "power": (dims, power, {"units": _per(_squared(units), "Hz"), "long_name": "power density"}),
        },
        coords={"frequency": ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})},
        attrs={"resolution": 1.5 * even.rate / length, "segments": segments, "rate": even.rate},
    )


def dominant_frequencies(
    time: ArrayLike,
    values: ArrayLike,
    count: int = 5,
    *,
    rate: float | None = None,
    detrend: Literal["constant", "linear"] = "constant",
    units: str = "",
    scale: float = 0.0,
) -> xr.Dataset:
    r"""Return the strongest periodic parts of a signal, frequencies and amplitudes interpolated between bins.

    The mean is taken off and a Hann window laid over the whole signal. Local maxima of its spectrum X
    count that are above five times the median of their surroundings (an eighth of the band), above a
    thousandth of the strongest, and above round-off: 1e-10 of the largest value or of the scale.
    With :math:`\alpha` the ratio of the larger neighbour to the maximum,

    .. math:: f = (k \pm \delta)/T, \quad \delta = \frac{2\alpha - 1}{1 + \alpha}, \qquad
              A = 2 |X_k| \frac{\pi\delta}{\sin\pi\delta} (1 - \delta^2),

    exact for one sine in a long signal (Grandke 1983). Sines closer together than 4/T are not told apart,
    below 2/T none is found (and below 3/T a frequency is off by up to 4 %), and an amplitude is a
    mean over the whole signal: a decaying one reads low.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,).
        count: Most peaks to return.
        rate: Of the even grid [Hz]; see :func:`uniform`.
        detrend: What is taken off first: the mean, or a straight line, which frees a drifting signal of its
            drift but also bends slow waves.
        units: Of the values.
        scale: Size of such quantities in the same run, where it is larger than this one's [units].

    Returns:
        Over ``peak``, strongest first: ``frequency`` [Hz], ``amplitude`` [units] of the sine and
        ``contrast``, the maximum over the median around it [-]. Attributes ``resolution``: 1/T [Hz];
        ``round_off``: 1 if the whole signal varies by no more than round-off. No rows if nothing stands out.
    """
    even = uniform(time, values, rate)
    if even.values.ndim != 1:
        raise InvalidParameterError("dominant_frequencies", "values", "one signal, (n,)", even.values.shape)
    n = even.values.size
    window = signal.get_window("hann", n)
    size = np.abs(np.fft.rfft(signal.detrend(even.values, type=detrend) * window)) / window.sum()
    largest = float(np.abs(even.values).max())
    round_off = _ROUND_OFF * max(largest, scale)
    around = max(9, n // 16)
    level = _running_median(size, around) + 1e-15 * largest
    peaks, _ = signal.find_peaks(size)
    peaks = peaks[(peaks >= 2) & (size[peaks] > 5.0 * level[peaks]) & (2.0 * size[peaks] > round_off)]
    peaks = peaks[np.argsort(-size[peaks], kind="stable")]
    peaks = peaks[size[peaks] >= _LEAST_SHARE * size[peaks].max(initial=0.0)]
    frequency: list[float] = []
    amplitude: list[float] = []
    kept: list[int] = []
    for k in peaks:
        # Side lobes of a stronger one, less than the main lobe away, are no peaks of their own.
        if any(abs(int(k) - other) < 4 for other in kept):
            continue
        side = 1 if size[k + 1] >= size[k - 1] else -1
        alpha = size[k + side] / size[k]
        delta = min(max((2.0 * alpha - 1.0) / (1.0 + alpha), 0.0), 0.5)
        frequency.append((k + side * delta) * even.rate / n)
        amplitude.append(2.0 * size[k] * (1.0 - delta**2) / np.sinc(delta))
        kept.append(int(k))
        if len(kept) == count:
            break
    return xr.Dataset(
        {
            "frequency": ("peak", np.array(frequency), {"units": "Hz", "long_name": "frequency"}),
            "amplitude": ("peak", np.array(amplitude), {"units": units, "long_name": "amplitude"}),
            "contrast": (
                "peak",
                np.array([size[k] / level[k] for k in kept]),
                {"units": "1", "long_name": "over the spectrum around it"},
            ),
        },
        coords={"peak": np.arange(len(kept))},
        attrs={
            "resolution": even.rate / n,
            "rate": even.rate,
            "round_off": int(np.ptp(even.values) <= 2.0 * round_off),
        },
    )


def spectrogram(
    time: ArrayLike,
    values: ArrayLike,
    *,
    segment: float | None = None,
    rate: float | None = None,
    units: str = "",
) -> xr.Dataset:
    """Return the power spectral density of a signal as it changes with time.

    Short-time Fourier transform with Hann windows that overlap by three quarters, each inside the signal.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,).
        segment: Length of a window [s]; a twentieth of the signal if left out.
        rate: Of the even grid [Hz]; see :func:`uniform`.
        units: Of the values.

    Returns:
        ``power`` (frequency, time) [units^2/Hz], one-sided, at the windows' middles. Attributes
        ``resolution`` in frequency [Hz] (1.5 over the window's length), ``segment`` [s] and ``rate`` [Hz].
    """
    even = uniform(time, values, rate)
    if even.values.ndim != 1:
        raise InvalidParameterError("spectrogram", "values", "one signal, (n,)", even.values.shape)
    span = even.time.size / even.rate
    length = _segment(even, span / 20.0 if segment is None else segment)
    hop = max(1, length // 4)
    transform = signal.ShortTimeFFT(
        signal.get_window("hann", length), hop, even.rate, fft_mode="onesided2X", scale_to="psd"
    )
    n = even.values.size
    # Windows that lie inside the signal altogether.
    first = transform.lower_border_end[1]
    last = max(transform.upper_border_begin(n)[1], first + 1)
    found = np.abs(transform.stft(even.values - even.values.mean(), p0=first, p1=last)) ** 2
    middles = even.time[0] + transform.delta_t * np.arange(first, last)
    return xr.Dataset(
        {
            "power": (
                ("frequency", "time"),
                found,
                {"units": _per(_squared(units), "Hz"), "long_name": "power density"},
            )
        },
        coords={
            "frequency": ("frequency", transform.f, {"units": "Hz", "long_name": "frequency"}),
            "time": ("time", middles, {"units": "s", "long_name": "middle of the window"}),
        },
        attrs={"resolution": 1.5 * even.rate / length, "segment": length / even.rate, "rate": even.rate},
    )


def _segment(even: UniformSignal, segment: float | None) -> int:
    """Return the length of a window in samples."""
    n = even.time.size
    if segment is None:
        return n
    length = round(segment * even.rate)
    if length > n or length < _LEAST_SAMPLES:
        least, most = _LEAST_SAMPLES / even.rate, n / even.rate
        rule = f"from {least:.4g} to {most:.4g} s ({_LEAST_SAMPLES} samples to all)"
        raise InvalidParameterError("spectrum", "segment", rule, segment)
    return length


def _running_median(values: Array, width: int) -> Array:
    """Return the median of the neighbours within half a width; ends take what there is."""
    return np.asarray(median_filter(values, size=min(width, values.size), mode="reflect"))


def _squared(units: str) -> str:
    return f"({units})^2" if units else ""


def _per(units: str, below: str) -> str:
    return f"{units}/{below}" if units else f"1/{below}"
