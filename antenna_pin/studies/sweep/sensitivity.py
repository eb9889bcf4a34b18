"""Quantiles of responses, and sensitivity: elementary effects of Morris, variance shares of Sobol'.

Both are SALib's, on the unit cube of cumulative probabilities. So an elementary effect of Morris is that of
the whole distribution of a parameter, in the unit of the response.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError, MissingToolError, UnknownNameError


def quantiles(
    study: xr.Dataset,
    response: str,
    shares: Sequence[float] = (0.05, 0.5, 0.95, 0.997),
    confidence: float = 0.95,
) -> xr.Dataset:
    """Return quantiles of a response over the runs that have one.

    An interval is that between two runs in order of size: as many runs lie below the quantile as a binomial
    distribution says, whatever the response's own distribution. It holds for independent samples
    (``random``), and is too wide rather than too narrow for stratified ones.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
        response: Name of the response.
        shares: Of the runs that lie below [-].
        confidence: Of the intervals [-].

    Returns:
        Over ``share``: ``quantile``, ``low`` and ``high``, in the response's unit; an end that so few runs do
        not have is NaN. Attribute ``runs``: how many have a number.

    Raises:
        UnknownNameError: The study has no such response.
    """
    from scipy import stats

    if response not in study.data_vars:
        raise UnknownNameError("quantiles", "response", response, map(str, study.data_vars))
    values = np.ravel(study[response].values).astype(float)
    values = np.sort(values[np.isfinite(values)])
    count = values.size
    ends = np.full((2, len(shares)), np.nan)
    for k, share in enumerate(shares):
        low = int(stats.binom.ppf(0.5 * (1.0 - confidence), count, share)) - 1
        high = int(stats.binom.ppf(0.5 * (1.0 + confidence), count, share))
        if low >= 0:
            ends[0, k] = values[low]
        if high < count:
            ends[1, k] = values[high]
    found = np.quantile(values, shares) if count else np.full(len(shares), np.nan)
    units = {"units": str(study[response].attrs.get("units", ""))}
    return xr.Dataset(
        {
            "quantile": ("share", found, units),
            "low": ("share", ends[0], units),
            "high": ("share", ends[1], units),
        },
        coords={"share": list(shares)},
        attrs={"runs": int(count), "confidence": confidence},
    )


def _salib(name: str) -> Any:
    import importlib

    try:
        return importlib.import_module(f"SALib.{name}")
    except ImportError:
        raise MissingToolError(
            "sensitivities need SALib; install it with pip install 'antenna-pin[studies]'"
        ) from None


def _problem(names: list[str]) -> dict[str, Any]:
    return {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}


def morris_points(names: list[str], count: int, levels: int, seed: int) -> Array:
    """Return Morris's design in the unit cube, (count (factors + 1), factors) [-]."""
    made = _salib("sample.morris").sample(_problem(names), count, num_levels=levels, seed=seed)
    return np.asarray(made, dtype=float)


def saltelli_points(names: list[str], count: int, second_order: bool, seed: int) -> Array:
    """Return Saltelli's design in the unit cube, (count (factors + 2), factors) [-].

    With second order it has count (2 factors + 2) points.
    """
    made = _salib("sample.sobol").sample(
        _problem(names), count, calc_second_order=second_order, scramble=True, seed=seed
    )
    return np.asarray(made, dtype=float)


@takes()
def sensitivities(study: xr.Dataset, response: str, confidence: float = 0.95) -> xr.Dataset:
    """Return the sensitivity of a response to the sampled parameters.

    Args:
        study: Dataset of :func:`antenna_pin.open_study`, of method ``morris`` or ``saltelli``.
        response: Name of the response.
        confidence: Confidence level of the intervals, by bootstrap [-].

    Returns:
        Over ``factor``, of Morris: ``mu``, ``mu_star`` (mean effect, mean size of the effect) and ``sigma``
        (its spread: interactions and curvature), in the response's unit; of Saltelli: ``first`` and
        ``total``, shares of the response's variance by the parameter alone and with all interactions [-].
        With half the width of their intervals: ``mu_star_conf``, ``first_conf``, ``total_conf``.

    Raises:
        InvalidParameterError: The study has another method, or a run of it has no response.
    """
    method = study.attrs.get("method")
    if method not in ("morris", "saltelli"):
        raise InvalidParameterError(
            "sensitivities", "study", 'sampled with method = "morris" or "saltelli"', method
        )
    known = json.loads(study.attrs["responses"])
    if response not in known:
        raise InvalidParameterError("sensitivities", "response", f"one of {', '.join(known)}", response)
    values = np.asarray(study[response].values, dtype=float)
    if values.ndim != 1:
        grid = [str(dim) for dim in study[response].dims if dim != "sample"]
        raise InvalidParameterError("sensitivities", "study", f"at one value of {', '.join(grid)}", "several")
    if not np.isfinite(values).all():
        missing = int(np.count_nonzero(~np.isfinite(values)))
        raise InvalidParameterError(
            "sensitivities", "response", "there for all runs, which the method needs", f"{missing} missing"
        )
    names = [str(name) for name in study["factor"].values]
    points = np.asarray(study["probability"].values, dtype=float)
    about = json.loads(study.attrs["study"])["sampling"]
    units = str(study[response].attrs.get("units", ""))
    if values.std() == 0.0:
        raise InvalidParameterError(
            "sensitivities", "response", "of different values", said=f"{values[0]:g} in all"
        )
    if method == "morris":
        found = _salib("analyze.morris").analyze(
            _problem(names), points, values, conf_level=confidence, num_levels=about["levels"], seed=0
        )
        columns = {
            "mu": ("mu", units, "mean effect"),
            "mu_star": ("mu_star", units, "mean size of the effect"),
            "mu_star_conf": ("mu_star_conf", units, "half its interval"),
            "sigma": ("sigma", units, "spread of the effect"),
        }
    else:
        found = _salib("analyze.sobol").analyze(
            _problem(names), values, calc_second_order=about["second_order"], conf_level=confidence, seed=0
        )
        columns = {
            "first": ("S1", "1", "share of the variance by itself"),
            "first_conf": ("S1_conf", "1", "half its interval"),
            "total": ("ST", "1", "share of the variance with all interactions"),
            "total_conf": ("ST_conf", "1", "half its interval"),
        }
    return xr.Dataset(
        {
            name: ("factor", np.asarray(found[key], dtype=float), {"units": unit, "long_name": words})
            for name, (key, unit, words) in columns.items()
        },
        coords={"factor": names},
        attrs={"method": method, "response": response, "confidence": confidence, "runs": values.size},
    )
