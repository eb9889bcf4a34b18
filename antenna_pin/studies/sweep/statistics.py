"""Statistics of a response over a study: quantiles with distribution-free confidence intervals."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr


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
    """
    from scipy import stats

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
