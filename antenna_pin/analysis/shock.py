r"""Shock response spectra of accelerations.

An oscillator of natural frequency f and quality Q = 1/(2 zeta) on a base of acceleration a moves relative to
it by

.. math:: \ddot z + 2 \zeta \omega \dot z + \omega^2 z = -a, \qquad \omega = 2 \pi f

and its absolute acceleration is :math:`-(2 \zeta \omega \dot z + \omega^2 z)`. The signal is taken as the
polygon through its samples, uneven as they are, for which each step is exact; oscillators that are fast for
the steps are examined between them too. On an even grid that is what the ramp-invariant filter does
(Smallwood 1981, Shock and Vibration Bulletin 51, 279).
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Annotated

import numpy as np
import numpy.typing as npt
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import NumberRule
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory.quantities import dataset_of

_PER_OCTAVE = 12
_LOOKS = 24  # in a period of the fastest oscillator: a peak is missed by (pi/24)^2/2, 0.9 % at most
_MOST_LOOKS = 64  # in a step
_AFTER = 48  # in the period after the signal's end
_GROWTH = 20.0  # exponent by which sums may grow before a new one is begun
_SERIES = 0.05  # size below which a series takes the place of a difference: to 2e-12 of it


@takes()
def shock_spectrum(
    time: ArrayLike,
    values: ArrayLike,
    frequencies: ArrayLike | None = None,
    *,
    quality: Annotated[float, NumberRule("above 0.5")] = 10.0,
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
    f = _frequencies(t) if frequencies is None else np.atleast_1d(np.asarray(frequencies, dtype=float))
    if f.ndim != 1 or f.size == 0 or not (np.isfinite(f).all() and (f > 0.0).all()):
        raise InvalidParameterError("shock_spectrum", "frequencies", "positive [Hz]", frequencies)
    _check_steps(t, float(f.max()))
    found = [_swing(*_between(t, a, float(one)), float(one), quality) for one in f]
    largest, least, far = (np.array([one[k] for one in found]) for k in range(3))
    after = _after(np.array([one[3:] for one in found]).T, f, quality)
    high, low = np.maximum(largest, after[0]), np.minimum(least, after[1])
    columns = {
        "positive": high,
        "negative": -low,
        "maximum": np.maximum(high, -low),
        "residual": np.maximum(after[0], -after[1]),
        "pseudo_velocity": 2.0 * np.pi * f * np.maximum(far, after[2]),
    }
    coords = {"frequency": ("frequency", f, {"units": "Hz", "long_name": "natural frequency"})}
    return dataset_of("shock", columns, coords, {"quality": quality}, units=units)


def _frequencies(t: Array) -> Array:
    """Return the default frequencies of oscillators [Hz]."""
    steps = np.diff(t)
    low, high = 1.0 / float(t[-1] - t[0]), 0.1 / float(np.median(steps[steps > 0.0]))
    count = max(2, math.ceil(_PER_OCTAVE * math.log2(max(high / low, 2.0))))
    return np.geomspace(low, max(high, 2.0 * low), count + 1)


def _check_steps(t: Array, fastest: float) -> None:
    """Refuse an oscillator that is too fast for the signal's steps."""
    longest = float(np.diff(t).max())
    if longest * fastest * _LOOKS > _MOST_LOOKS:
        fast = _MOST_LOOKS / _LOOKS / longest
        rule = f"at most {fast:.4g} Hz, the Nyquist frequency of the longest step between samples"
        raise InvalidParameterError("shock_spectrum", "frequencies", rule, said=f"{fastest:g} Hz")


def _between(t: Array, a: Array, frequency: float) -> tuple[Array, Array]:
    """Return short pieces of the polygon for an oscillator.

    Returns:
        (n + 1,) times and (2, n) accelerations: where something jumps, a piece begins with the later of two.
    """
    steps = np.diff(t)
    looks = np.maximum(np.ceil(steps * frequency * _LOOKS).astype(int), (steps > 0.0).astype(int))
    own = np.repeat(np.arange(looks.size, dtype=np.int32), looks)
    part = np.arange(own.size, dtype=np.int32) - np.repeat((np.cumsum(looks) - looks).astype(np.int32), looks)
    times, ends = np.empty(own.size + 1), np.empty((2, own.size))
    times[0], share = t[0], part / looks[own]
    rise, start = np.diff(a)[own], a[own]
    ends[0] = start + share * rise
    share = (part + 1) / looks[own]
    ends[1] = start + share * rise
    times[1:] = t[own] + share * steps[own]
    return times, ends


def _swing(
    t: Array, ends: Array, frequency: float, quality: float
) -> tuple[float, float, float, float, float]:
    r"""Return largest and least absolute acceleration, largest displacement, last displacement and rate.

    With lambda = -zeta omega + i omega sqrt(1 - zeta^2), the number u = z' - conj(lambda) z obeys
    u' = lambda u - a, which sums up step by step: in blocks, in which exp(-lambda t) does not grow too far.
    """
    omega, zeta = 2.0 * math.pi * frequency, 0.5 / quality
    damped = omega * math.sqrt(1.0 - zeta**2)
    root = complex(-zeta * omega, damped)
    u, high, low, far = 0j, 0.0, 0.0, 0.0
    block = ((t[1:] - t[0]) * zeta * omega // _GROWTH).astype(np.int32)
    edges = np.concatenate([[0], np.flatnonzero(np.diff(block)) + 1, [block.size]])
    for first, last in pairwise(edges.tolist()):
        since = t[first + 1 : last + 1] - t[first]
        pushed = _pushed(np.diff(t[first : last + 1]), ends[:, first:last], root)
        state = np.exp(root * since) * (u + np.cumsum(np.exp(-root * since) * pushed))
        u = complex(state[-1])
        z = state.imag / damped
        felt = -(2.0 * zeta * omega * (state.real - zeta * omega * z) + omega**2 * z)
        high, low = max(high, float(felt.max())), min(low, float(felt.min()))
        far = max(far, float(np.abs(z).max()))
    z_last = u.imag / damped
    return high, low, far, z_last, u.real - zeta * omega * z_last


def _pushed(steps: Array, ends: Array, root: complex) -> npt.NDArray[np.complex128]:
    """Return the increments of u over pieces of the polygon."""
    x = root * steps
    once = np.expm1(x) / root
    series = 0.5 + x * (1 / 6 + x * (1 / 24 + x * (1 / 120 + x * (1 / 720 + x / 5040))))
    small = np.abs(x) < _SERIES
    twice = np.where(small, steps**2 * series, (np.expm1(x) - x) / root**2)
    added: npt.NDArray[np.complex128] = -(ends[0] * once + (ends[1] - ends[0]) / steps * twice)
    return added


def _after(state: Array, f: Array, quality: float) -> tuple[Array, Array, Array]:
    """Return the extremes of the free oscillation in the period after the end."""
    omega, zeta = 2.0 * np.pi * f, 0.5 / quality
    damped = omega * math.sqrt(1.0 - zeta**2)
    s = np.linspace(0.0, 1.0, _AFTER + 1)[:, None] * 2.0 * np.pi / damped
    decay = np.exp(-zeta * omega * s)
    cosine, sine = decay * np.cos(damped * s), decay * np.sin(damped * s)
    z = (cosine + zeta * omega / damped * sine) * state[0] + sine / damped * state[1]
    w = -(omega**2) / damped * sine * state[0] + (cosine - zeta * omega / damped * sine) * state[1]
    felt = -(2.0 * zeta * omega * w + omega**2 * z)
    return felt.max(axis=0), felt.min(axis=0), np.abs(z).max(axis=0)
