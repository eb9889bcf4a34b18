r"""Spectra of sampled signals, their peaks, and spectrograms.

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

from typing import Literal

import numpy as np
import scipy
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import LONG
from antenna_pin.analysis.even import LEAST_SAMPLES, EvenSignal, Read, UniformSignal, long_amplitudes, uniform
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory.quantities import dataset_of

_ROUND_OFF = 1e-10  # of the size of a quantity: what it varies by without a cause
_LEAST_SHARE = 1e-3  # of the strongest peak, for one to be named beside it


@takes(rate="Hz", segment="s")
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
    length = window_length(even, segment)
    frequency, power = scipy.signal.welch(
        even.values, even.rate, window="hann", nperseg=length, noverlap=length // 2, axis=0
    )
    segments = 1 + (even.time.size - length) // (length - length // 2)
    return dataset_of(
        "spectrum" if power.ndim == 1 else "spectra",
        {"density": np.sqrt(power), "power": power},
        {"frequency": ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})},
        {"resolution": 1.5 * even.rate / length, "segments": segments, "rate": even.rate},
        density=f"{units or '1'}/sqrt(Hz)",
        power=_power_unit(units),
    )


@takes(rate="Hz")
def dominant_frequencies(
    time: ArrayLike,
    values: ArrayLike | Read,
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

    exact for one sine in a long signal (Grandke 1983). Sines closer together than 4/T are not distinguished,
    below 2/T none is found (and below 3/T a frequency is off by up to 4 %), and an amplitude is a
    mean over the whole signal: a decaying one reads low. Of more than 100,000 samples the last few of the
    even grid are left out, so that their number is a product of small primes: another would take ten times
    the memory. The attribute ``left_out`` says how many.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,), or a function that returns those from one number up to another.
        count: Most peaks to return.
        rate: Of the even grid [Hz]; see :func:`uniform`.
        detrend: What is removed first: the mean, or a straight line, which frees a drifting signal of its
            drift but also bends slow waves.
        units: Of the values.
        scale: Size of such quantities in the same run, where it is larger than this one's [units].

    Returns:
        Over ``peak``, strongest first: ``frequency`` [Hz], ``amplitude`` [units] of the sine and
        ``contrast``, the maximum over the median around it [-]. Attributes ``resolution``: 1/T [Hz];
        ``round_off``: 1 if the whole signal varies by no more than round-off. No rows if nothing stands out.
    """
    times = np.asarray(time, dtype=float)
    if times.size > LONG:
        read = values if callable(values) else _reader(values)
        even = EvenSignal(times, read, rate)
        size, n, largest, extent = long_amplitudes(even, detrend)
        step_rate, left_out = even.rate, even.size - n
    else:
        whole = uniform(times, values(0, times.size) if callable(values) else values, rate)
        if whole.values.ndim != 1:
            rule = "one signal, (n,)"
            raise InvalidParameterError("dominant_frequencies", "values", rule, whole.values.shape)
        n, step_rate, left_out = whole.values.size, whole.rate, 0
        window = scipy.signal.get_window("hann", n)
        size = np.abs(np.fft.rfft(scipy.signal.detrend(whole.values, type=detrend) * window)) / window.sum()
        largest, extent = float(np.abs(whole.values).max()), float(np.ptp(whole.values))
    round_off = _ROUND_OFF * max(largest, scale)
    around = max(9, n // 16)
    median = scipy.ndimage.median_filter(size, size=min(around, size.size), mode="reflect")
    level = np.asarray(median) + 1e-15 * largest
    peaks, _ = scipy.signal.find_peaks(size)
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
        frequency.append((k + side * delta) * step_rate / n)
        amplitude.append(2.0 * size[k] * (1.0 - delta**2) / np.sinc(delta))
        kept.append(int(k))
        if len(kept) == count:
            break
    contrast = [size[k] / level[k] for k in kept]
    about = {"resolution": step_rate / n, "rate": step_rate, "left_out": left_out}
    return dataset_of(
        "peaks",
        {"frequency": np.array(frequency), "amplitude": np.array(amplitude), "contrast": np.array(contrast)},
        {"peak": np.arange(len(kept))},
        about | {"round_off": int(extent <= 2.0 * round_off)},
        units=units,
    )


@takes(rate="Hz", segment="s")
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
    length = window_length(even, span / 20.0 if segment is None else segment)
    hop = max(1, length // 4)
    transform = scipy.signal.ShortTimeFFT(
        scipy.signal.get_window("hann", length), hop, even.rate, fft_mode="onesided2X", scale_to="psd"
    )
    n = even.values.size
    # Windows that lie inside the signal altogether.
    first = transform.lower_border_end[1]
    last = max(transform.upper_border_begin(n)[1], first + 1)
    found = np.abs(transform.stft(even.values - even.values.mean(), p0=first, p1=last)) ** 2
    middles = even.time[0] + transform.delta_t * np.arange(first, last)
    return dataset_of(
        "spectrogram",
        {"power": found},
        {
            "frequency": ("frequency", transform.f, {"units": "Hz", "long_name": "frequency"}),
            "time": ("time", middles, {"units": "s", "long_name": "middle of the window"}),
        },
        {"resolution": 1.5 * even.rate / length, "segment": length / even.rate, "rate": even.rate},
        power=_power_unit(units),
    )


def _reader(values: ArrayLike) -> Read:
    held = np.asarray(values, dtype=float)
    if held.ndim != 1:
        raise InvalidParameterError("dominant_frequencies", "values", "one signal, (n,)", held.shape)
    return lambda begin, end: held[begin:end]


def window_length(even: UniformSignal, segment: float | None) -> int:
    """Return the length of a window in samples."""
    n = even.time.size
    if segment is None:
        return n
    length = round(segment * even.rate)
    if length > n or length < LEAST_SAMPLES:
        least, most = LEAST_SAMPLES / even.rate, n / even.rate
        rule = f"from {least:.4g} to {most:.4g} s ({LEAST_SAMPLES} samples to all)"
        raise InvalidParameterError("spectrum", "segment", rule, segment)
    return length


def _power_unit(units: str) -> str:
    return f"({units})^2/Hz" if units else "1/Hz"
