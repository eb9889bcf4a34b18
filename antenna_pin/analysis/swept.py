r"""The response to a swept sine, by synchronous demodulation.

While the base sweeps, its phase :math:`\varphi(t)` is known exactly. In windows of some periods any signal is
fitted by

.. math:: y = m + n (t - t_0) + \Re[(c + d (\varphi - \varphi_0)) e^{i \varphi}]

in least squares, weighted by time and a Hann window; c, at the window's middle, is the signal's part that
follows the sweep. The ratio of two is a response. What is left of the signal, its mean and drift apart, does
not follow: higher harmonics, subharmonics, what play makes.
"""

from __future__ import annotations

from typing import Annotated

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import RunLike, data_of, floats, sample_times
from antenna_pin.analysis.quantity import quantity
from antenna_pin.analysis.shaken import shaken_link, shakes_of
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import NumberRule
from antenna_pin.elements import SweptPiece, sines_of
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.trajectory.quantities import dataset_of

_LEAST_SAMPLES = 12


@takes()
def following(
    time: ArrayLike,
    values: ArrayLike,
    phase: ArrayLike,
    periods: Annotated[float, NumberRule("2 or more")] = 10.0,
) -> xr.Dataset:
    """Return the part of a signal at a phase, in overlapping windows.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        values: Samples, (n,).
        phase: At the samples, rising, (n,) [rad].
        periods: Length of a window [periods].

    Returns:
        Over ``window``: ``time`` of its middle [s], ``part``, complex: the signal's is that of part times
        exp(i phase), ``rest``, the root mean square of what does not follow [units].
    """
    t, y, turned = (np.asarray(one, dtype=float) for one in (time, values, phase))
    half = np.pi * periods
    middles = np.arange(turned[0] + half, turned[-1] - half + 1e-9, half)
    weights = np.gradient(t) if t.size > 1 else np.ones(t.size)
    found = []
    for middle in middles:
        first, last = np.searchsorted(turned, [middle - half, middle + half])
        part = slice(int(first), int(last))
        if last - first < max(_LEAST_SAMPLES, 4.0 * periods):
            rate = 4.0 * (turned[-1] - turned[0]) / (2.0 * np.pi * (t[-1] - t[0]))
            rule = f"sampled 4 times in a period or more: raise output.rate above {rate:.4g} Hz"
            raise InvalidParameterError("following", "values", rule, said=f"{last - first} in {periods:g}")
        found.append(_fitted(t[part], y[part], turned[part], weights[part], middle, half))
    if not found:
        rule = f"of {periods:g} periods or more"
        raise InvalidParameterError("following", "time", rule, said="a shorter signal")
    rows = np.array(found)
    return xr.Dataset(
        {
            "time": ("window", rows[:, 0].real, {"units": "s", "long_name": "middle of the window"}),
            "part": ("window", rows[:, 1], {"long_name": "what follows the phase"}),
            "rest": ("window", rows[:, 2].real, {"long_name": "root mean square of what does not"}),
        }
    )


def _fitted(t: Array, y: Array, turned: Array, weight: Array, middle: float, half: float) -> list[complex]:
    """Return time of the window's middle, synchronous part, and root mean square of the rest."""
    off = (turned - middle) / half
    own = np.maximum(weight, 0.0) * np.cos(0.5 * np.pi * off) ** 2
    at = float(np.interp(middle, turned, t))
    drift = (t - at) / max(float(t[-1] - t[0]), 1e-300)
    cosine, sine = np.cos(turned), np.sin(turned)
    columns = np.stack([np.ones(t.size), drift, cosine, sine, off * cosine, off * sine], axis=1)
    root = np.sqrt(own)
    fit = np.linalg.lstsq(columns * root[:, None], y * root, rcond=None)[0]
    rest = y - columns @ fit
    return [at, complex(fit[2], -fit[3]), float(np.sqrt(own @ rest**2 / own.sum()))]


@takes()
def base_acceleration(run: RunLike, shake: str) -> Array:
    """Return the acceleration of the base by one motion, (n,) [m/s^2] ([rad/s^2])."""
    data = data_of(run)
    known = shakes_of(data)
    if shake not in known:
        shaken_link(data)
        raise UnknownNameError("base", "motion", shake, known)
    return floats(data["a"].sel(coordinate=str(known[shake]["joint"])))


@takes()
def swept_response(
    run: RunLike, target: str, *, shake: str | None = None, periods: float = 10.0
) -> xr.Dataset:
    """Return the response of a quantity to a swept or plain sine of the base.

    Args:
        run: A run whose base is shaken by a sine or a sweep, or its data.
        target: Name of a quantity (:func:`antenna_pin.analysis.quantities`): of an acceleration the answer
            is a transmissibility.
        shake: Name of the motion of the base; the first one that is a sine or a sweep if left out.
        periods: Length of a window [periods].

    Returns:
        Over ``window``, in the order of time: ``frequency`` [Hz], ``way`` (1 up, -1 down, 0 neither),
        ``time`` [s], ``response``, complex: the target over the base's acceleration, ``gain``, ``phase``
        [rad], ``amplitude`` of the target and ``base``, that of the base's acceleration, ``distortion``,
        the root mean square of what does not follow over that of what does [-].
    """
    data = data_of(run)
    shaken_link(data)
    known = {name: one["shakes"] for name, one in shakes_of(data).items()}
    swept = {name: one["pieces"] for name, one in known.items() if "pieces" in one}
    shake = next(iter(swept), None) if shake is None else shake
    if shake is None or shake not in swept:
        raise UnknownNameError("swept_response", "sine or sweep of the base", str(shake), swept)
    found = quantity(data, target)
    time = sample_times(data, "swept_response")
    pieces = [SweptPiece(*one) for one in swept[shake]]
    base = base_acceleration(data, shake)
    parts: list[dict[str, Array]] = []
    ends = [*(piece.start for piece in pieces[1:]), np.inf]
    for piece, end in zip(pieces, ends, strict=True):
        here = (time >= piece.start) & (time <= end)
        _, phase = sines_of([piece], time[here])
        if phase.size < _LEAST_SAMPLES or phase[-1] - phase[0] < 2.0 * np.pi * periods:
            continue
        answer, cause = (following(time[here], one[here], phase, periods) for one in (found.values, base))
        frequency, _ = sines_of([piece], answer["time"].values)
        response = answer["part"].values / cause["part"].values
        amplitude = np.abs(answer["part"].values)
        with np.errstate(divide="ignore"):
            distortion = np.sqrt(2.0) * answer["rest"].values / amplitude
        parts.append(
            {
                "frequency": frequency,
                "way": np.full(frequency.size, int(np.sign(piece.growth))),
                "time": answer["time"].values,
                "response": response,
                "gain": np.abs(response),
                "phase": np.angle(response),
                "amplitude": amplitude,
                "base": np.abs(cause["part"].values),
                "distortion": distortion,
            }
        )
    if not parts:
        rule = f"so long that {periods:g} periods of a piece of the sweep lie in it"
        raise InvalidParameterError("swept_response", "run", rule, said=f"{time[-1] - time[0]:g} s")
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    about = {"shake": shake, "target": found.name, "periods": periods}
    return dataset_of("swept response", columns, {}, about, units=found.units)
