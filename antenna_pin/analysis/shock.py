r"""Shock response spectra: what an acceleration would do to oscillators of any frequency on it.

An oscillator of natural frequency f and quality Q = 1/(2 zeta) on a base of acceleration a moves relative to
it by

.. math:: \ddot z + 2 \zeta \omega \dot z + \omega^2 z = -a, \qquad \omega = 2 \pi f

and its absolute acceleration is :math:`-(2 \zeta \omega \dot z + \omega^2 z)`. The signal is taken as the
polygon through its samples, uneven as they are, for which each step is exact; oscillators that are fast for
the steps are looked at between them too. On an even grid that is what the ramp-invariant filter does
(Smallwood 1981, Shock and Vibration Bulletin 51, 279).
"""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import Array
from antenna_pin.arguments import takes
from antenna_pin.errors import InvalidParameterError

__all__ = ["shock_spectrum"]

_PER_OCTAVE = 12
_LOOKS = 24  # in a period of the fastest oscillator: a peak is missed by (pi/24)^2/2, 0.9 % at most
_MOST_LOOKS = 64  # in a step
_AFTER = 48  # in the period after the signal's end


@takes()
def shock_spectrum(
    time: ArrayLike,
    values: ArrayLike,
    frequencies: ArrayLike | None = None,
    *,
    quality: float = 10.0,
    units: str = "m/s^2",
) -> xr.Dataset:
    """Return the shock response spectrum of an acceleration.

    Oscillators are at rest at first, on a base that has no acceleration before.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Acceleration, (n,).
        frequencies: Of the oscillators, positive [Hz]; 12 to an octave, from the signal's length to a tenth
            of its sample rate, if left out.
        quality: Q, above a half [-].
        units: Of the values.

    Returns:
        Over ``frequency`` [Hz]: ``positive`` and ``negative``, the largest absolute acceleration in either
        sense during and after the signal, ``maximum``, the larger of both, ``residual``, the largest in
        either sense after its end [units], and ``pseudo_velocity``, the largest relative displacement times
        omega [units s]. Attribute ``quality``.
    """
    t, a = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    if t.ndim != 1 or t.shape != a.shape or t.size < 2:
        seen = f"{a.shape} values at {t.shape} times"
        raise InvalidParameterError(
            "shock_spectrum", "values", "(n,), one for each of two times or more", seen
        )
    if np.any(np.diff(t) < 0.0) or not np.isfinite(a).all():
        rule = "finite, at times that do not decrease"
        raise InvalidParameterError("shock_spectrum", "values", rule, said="others")
    if not 0.5 < quality < math.inf:
        raise InvalidParameterError("shock_spectrum", "quality", "above 0.5 and finite", quality)
    f = _frequencies(t) if frequencies is None else np.atleast_1d(np.asarray(frequencies, dtype=float))
    if f.ndim != 1 or f.size == 0 or not (np.isfinite(f).all() and (f > 0.0).all()):
        raise InvalidParameterError("shock_spectrum", "frequencies", "positive [Hz]", frequencies)
    t, a = _between(t, a, float(f.max()))
    largest, least, far, state = _swings(t, a, f, quality)
    after = _after(state, f, quality)
    high, low = np.maximum(largest, after[0]), np.minimum(least, after[1])
    residual = np.maximum(after[0], -after[1])
    about = (
        ("positive", high, units, "largest absolute acceleration, positive sense"),
        ("negative", -low, units, "largest absolute acceleration, negative sense"),
        ("maximum", np.maximum(high, -low), units, "largest absolute acceleration"),
        ("residual", residual, units, "largest absolute acceleration after the signal"),
        (
            "pseudo_velocity",
            2.0 * np.pi * f * np.maximum(far, after[2]),
            f"{units} s",
            "omega times the largest relative displacement",
        ),
    )
    return xr.Dataset(
        {
            name: ("frequency", column, {"units": unit, "long_name": words})
            for name, column, unit, words in about
        },
        coords={"frequency": ("frequency", f, {"units": "Hz", "long_name": "natural frequency"})},
        attrs={"quality": quality},
    )


def _frequencies(t: Array) -> Array:
    """Return frequencies from the reciprocal of the signal's length to a tenth of its sample rate [Hz]."""
    steps = np.diff(t)
    low, high = 1.0 / float(t[-1] - t[0]), 0.1 / float(np.median(steps[steps > 0.0]))
    count = max(2, math.ceil(_PER_OCTAVE * math.log2(max(high / low, 2.0))))
    return np.geomspace(low, max(high, 2.0 * low), count + 1)


def _between(t: Array, a: Array, fastest: float) -> tuple[Array, Array]:
    """Return the polygon with points between its own, where oscillators are fast for its steps."""
    looks = np.ceil(np.diff(t) * fastest * _LOOKS).astype(int)
    if int(looks.max(initial=1)) > _MOST_LOOKS:
        high = _MOST_LOOKS / _LOOKS / float(np.diff(t).max())
        rule = f"at most {high:.4g} Hz, of which the longest step between samples tells"
        raise InvalidParameterError("shock_spectrum", "frequencies", rule, said=f"{fastest:g} Hz")
    looks = np.maximum(looks, (np.diff(t) > 0.0).astype(int))
    own = np.repeat(np.arange(looks.size), looks)
    part = np.arange(own.size) - np.repeat(np.cumsum(looks) - looks, looks)
    share = (part + 1) / looks[own]
    fine = np.concatenate([t[:1], t[own] + share * np.diff(t)[own]])
    # Of two samples at one instant, where something jumps, the later one begins the next step.
    return fine, np.stack([a[own] + part / looks[own] * np.diff(a)[own], a[own] + share * np.diff(a)[own]])


def _swings(t: Array, ends: Array, f: Array, quality: float) -> tuple[Array, Array, Array, Array]:
    """Return largest and least absolute acceleration, largest displacement and last state, (m,) each."""
    omega = 2.0 * np.pi * f
    zeta = 0.5 / quality
    damped = omega * math.sqrt(1.0 - zeta**2)
    z, w = np.zeros(f.size), np.zeros(f.size)
    high, low, far = np.zeros(f.size), np.zeros(f.size), np.zeros(f.size)
    last = -1.0
    for k in range(t.size - 1):
        step = float(t[k + 1] - t[k])
        if step != last:  # those of an even grid are made once
            decay = np.exp(-zeta * omega * step)
            cosine, sine = decay * np.cos(damped * step), decay * np.sin(damped * step)
            zz, zw = cosine + zeta * omega / damped * sine, sine / damped
            wz, ww = -(omega**2) / damped * sine, cosine - zeta * omega / damped * sine
            last = step
        first, slope = ends[0, k], (ends[1, k] - ends[0, k]) / step
        # What a ramp alone makes, and about it the free swing.
        rate = -slope / omega**2
        begin = -first / omega**2 + 2.0 * zeta * slope / omega**3
        z, w = z - begin, w - rate
        z, w = zz * z + zw * w + begin + rate * step, wz * z + ww * w + rate
        felt = -(2.0 * zeta * omega * w + omega**2 * z)
        np.maximum(high, felt, out=high)
        np.minimum(low, felt, out=low)
        np.maximum(far, np.abs(z), out=far)
    return high, low, far, np.stack([z, w])


def _after(state: Array, f: Array, quality: float) -> tuple[Array, Array, Array]:
    """Return the extremes of the free swing in the period after the end, its start included."""
    omega, zeta = 2.0 * np.pi * f, 0.5 / quality
    damped = omega * math.sqrt(1.0 - zeta**2)
    s = np.linspace(0.0, 1.0, _AFTER + 1)[:, None] * 2.0 * np.pi / damped
    decay = np.exp(-zeta * omega * s)
    cosine, sine = decay * np.cos(damped * s), decay * np.sin(damped * s)
    z = (cosine + zeta * omega / damped * sine) * state[0] + sine / damped * state[1]
    w = -(omega**2) / damped * sine * state[0] + (cosine - zeta * omega / damped * sine) * state[1]
    felt = -(2.0 * zeta * omega * w + omega**2 * z)
    return felt.max(axis=0), felt.min(axis=0), np.abs(z).max(axis=0)
