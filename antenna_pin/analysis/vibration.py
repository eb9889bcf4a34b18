r"""Random vibration: power spectral densities with confidence, mean squares of bands with their error.

A spectral density that is estimated from a record of length T is uncertain. Welch's method averages K
windows; with Hann windows that overlap by half its estimate has about

.. math:: \nu = \frac{2 K}{1 + \frac{2}{36} (1 - \frac1K)}

degrees of freedom, and :math:`\nu \hat S / S` is distributed as chi-square (Welch 1967, Bendat and Piersol
2010, 8.5). The mean square of a band, an integral of the density, has the variance

.. math:: \operatorname{Var} \hat\sigma^2 = \frac1T \int S^2 df

of a Gaussian signal, whatever the windows.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy
import xarray as xr
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import floats
from antenna_pin.analysis.even import uniform
from antenna_pin.analysis.spectrum import spectrum, window_length
from antenna_pin.base.arguments import takes
from antenna_pin.base.rules import BetweenZeroAndOne
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory.quantities import TABLES, dataset_of

_OVERLAP = 1.0 / 36.0  # squared correlation of neighbours, Hann windows that overlap by half
_WINDOWS = 8  # on the length of a record, if none is given


@takes(rate="Hz", segment="s")
def power_density(
    time: ArrayLike,
    values: ArrayLike,
    *,
    segment: float | None = None,
    rate: float | None = None,
    confidence: BetweenZeroAndOne = 0.95,
    units: str = "",
) -> xr.Dataset:
    """Return the one-sided power spectral density of a signal, with its interval of confidence.

    Args:
        time: Sample times, not decreasing, uneven if need be, (n,) [s].
        values: Samples, (n,).
        segment: Length of a window [s]; an eighth of the signal if left out.
        rate: Of the even grid [Hz]; see :func:`antenna_pin.analysis.uniform`.
        confidence: Probability that the interval holds the density, of a Gaussian signal [-].
        units: Of the values.

    Returns:
        Over ``frequency`` [Hz]: ``power``, ``lower`` and ``upper`` [units^2/Hz]. Attributes:
        ``degrees_of_freedom``, ``confidence``, ``resolution`` [Hz], ``segments``, ``span`` of the signal [s].
    """
    t = np.asarray(time, dtype=float)
    span = float(t[-1] - t[0]) if t.size else 0.0
    found = spectrum(
        t, values, segment=span / _WINDOWS if segment is None else segment, rate=rate, units=units
    )
    windows = int(found.attrs["segments"])
    freedom = _degrees_of_freedom(windows)
    power = found["power"]
    columns = {"power": power}
    for name, side in (("lower", 1.0), ("upper", -1.0)):
        factor = freedom / scipy.stats.chi2.ppf(0.5 + side * 0.5 * confidence, freedom)
        about = power.attrs | {"long_name": f"{name} bound of the density"}
        columns[name] = xr.DataArray(factor * power.values, power.coords, power.dims, attrs=about)
    return xr.Dataset(
        columns, attrs=found.attrs | {"degrees_of_freedom": freedom, "confidence": confidence, "span": span}
    )


@takes()
def band_rms(found: xr.Dataset, bands: Sequence[Sequence[float]] | None = None) -> xr.Dataset:
    """Return root mean squares in frequency bands, with standard errors.

    Args:
        found: What :func:`power_density` returned for the signal.
        bands: Lowest and highest frequency of each [Hz]; the whole spectrum if left out.

    Returns:
        Over ``band``: ``low``, ``high`` [Hz], ``rms`` and ``standard_error`` [units].
    """
    frequency = floats(found["frequency"])
    power = floats(found["power"])
    wanted = [(0.0, float(frequency[-1]))] if bands is None else [tuple(map(float, band)) for band in bands]
    step = float(frequency[1] - frequency[0])
    rows = []
    for band in wanted:
        if len(band) != 2 or not 0.0 <= band[0] < band[1]:
            raise InvalidParameterError("band_rms", "bands", "pairs of a lower and a higher frequency", band)
        if band[0] >= frequency[-1]:
            rule = f"below half of the rate, {frequency[-1]:g} Hz"
            raise InvalidParameterError("band_rms", "bands", rule, band)
        # Each line stands for its cell, cut at the band's ends.
        low, high = np.maximum(frequency - 0.5 * step, band[0]), np.minimum(frequency + 0.5 * step, band[1])
        width = np.maximum(high - low, 0.0)
        # The mean square of an estimate is larger than that of the density by its variance.
        own = 1.0 + 2.0 / float(found.attrs["degrees_of_freedom"])
        square, spread = float(power @ width), float(power**2 @ width) / own / float(found.attrs["span"])
        rms = math.sqrt(square)
        rows.append((*band, rms, 0.5 * math.sqrt(spread) / rms if rms > 0.0 else 0.0))
    units = str(found["power"].attrs["units"]).removesuffix("/Hz").removesuffix(")^2").removeprefix("(")
    columns = dict(zip(TABLES["bands"], np.array(rows, dtype=float).T, strict=True))
    return dataset_of("bands", columns, {"band": np.arange(len(rows))}, units=units)


@takes(rate="Hz", segment="s")
def transfer(
    time: ArrayLike,
    source: ArrayLike,
    target: ArrayLike,
    *,
    segment: float | None = None,
    rate: float | None = None,
) -> xr.Dataset:
    r"""Return the frequency response from one signal to another, with its coherence and its error.

    .. math:: H_1 = \frac{S_{xy}}{S_{xx}}, \qquad \gamma^2 = \frac{|S_{xy}|^2}{S_{xx} S_{yy}}, \qquad
              \varepsilon = \sqrt{\frac{1 - \gamma^2}{\gamma^2 \, \nu}}

    Noise in the target does no harm to :math:`H_1`; what is not linear takes from the coherence.

    Args:
        time: Sample times, not decreasing, uneven if need be, (n,) [s].
        source: Samples of the input, (n,).
        target: Of the output, (n,).
        segment: Length of a window [s]; an eighth of the signal if left out.
        rate: Of the even grid [Hz].

    Returns:
        Over ``frequency`` [Hz]: ``response``, complex, ``gain``, ``phase`` [rad], ``coherence`` and
        ``error``, the standard error of the gain over the gain [-]. Attributes ``resolution`` [Hz],
        ``segments``, ``degrees_of_freedom``.
    """
    both = np.column_stack([np.asarray(source, dtype=float), np.asarray(target, dtype=float)])
    even = uniform(time, both, rate)
    n = even.time.size
    length = window_length(even, (n // _WINDOWS) / even.rate if segment is None else segment)
    options: Any = {"fs": even.rate, "window": "hann", "nperseg": length, "noverlap": length // 2}
    x, y = even.values.T
    frequency, sxx = scipy.signal.welch(x, **options)
    _, syy = scipy.signal.welch(y, **options)
    _, sxy = scipy.signal.csd(x, y, **options)
    windows = 1 + (n - length) // (length - length // 2)
    freedom = _degrees_of_freedom(windows)
    with np.errstate(divide="ignore", invalid="ignore"):
        response = sxy / sxx
        coherence = np.clip(np.abs(sxy) ** 2 / (sxx * syy), 0.0, 1.0)
        error = np.sqrt((1.0 - coherence) / (coherence * freedom))
    columns = {
        "response": (response, "output over input"),
        "gain": (np.abs(response), "magnitude of the response"),
        "phase": (np.angle(response), "phase of the response"),
        "coherence": (coherence, "coherence"),
        "error": (error, "standard error of the gain, over it"),
    }
    found = xr.Dataset(
        {name: ("frequency", values, {"long_name": words}) for name, (values, words) in columns.items()},
        coords={"frequency": ("frequency", frequency, {"units": "Hz", "long_name": "frequency"})},
        attrs={"resolution": 1.5 * even.rate / length, "segments": windows, "degrees_of_freedom": freedom},
    )
    found["phase"].attrs["units"] = "rad"
    return found


def _degrees_of_freedom(windows: int) -> float:
    return 2.0 * windows / (1.0 + 2.0 * _OVERLAP * (1.0 - 1.0 / windows))
