r"""How sure a fit is of its numbers, from the slopes of its residuals where it ended.

Of residuals in standard deviations with slopes J the covariance of what is searched for is
:math:`(\mathbf{J}^T \mathbf{W} \mathbf{J})^{-1}`; W is the identity, or with a robust loss the weight with
which each residual counts, the derivative of the loss. It is of first order: right where the residuals are
straight over a band. Bands of logarithms are those of logarithms, so not even about the value.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.fit.losses import weights_of
from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.unknowns import Unknowns

__all__ = ["Bands", "bands_of"]

Array = NDArray[np.float64]

_LEVEL = 0.95
# A direction whose singular value is less than this part of the largest is one that the records do not tell;
# a parameter with more than this part of itself in it has no band.
_FAINT, _IN_IT = 1e-8, 1e-3


class Bands(NamedTuple):
    """What is known of p parameters.

    Attributes:
        covariance: (p, p) [SI], to first order; infinite where the records say nothing.
        sd: (p,) [SI].
        low: Lower ends of the bands, (p,) [SI].
        high: Upper ends.
        chi2: Sum of the squares of the residuals [-].
        freedoms: Residuals less unknowns [-].
    """

    covariance: Array
    sd: Array
    low: Array
    high: Array
    chi2: float
    freedoms: int


def bands_of(plan: FitPlan, unknowns: Unknowns, whole: Array, residuals: Array, slopes: Array) -> Bands:
    """Return what is known of the parameters at 95 %.

    A parameter at one of its bounds has the others' bands, and none itself: it is where it was kept.

    Args:
        plan: Which says whether the noise is known.
        unknowns: Of the fit.
        whole: Values with states, (p + h,) [SI].
        residuals: There, (m,).
        slopes: Their derivatives by what is searched for, (m, p + h).
    """
    from scipy import stats

    p, weights = unknowns.count, weights_of(plan, residuals)
    chi2 = float(np.sum(residuals**2))
    freedoms = len(residuals) - len(whole)
    at_bound = np.zeros(len(whole), dtype=bool)
    at_bound[:p] = (whole[:p] <= unknowns.lower) | (whole[:p] >= unknowns.upper)
    free = np.flatnonzero(~at_bound)
    scaled = np.sqrt(weights)[:, None] * slopes[:, free]
    _, sizes, ways = np.linalg.svd(scaled, full_matrices=False)
    told = sizes > _FAINT * sizes[0] if len(sizes) else np.zeros(0, dtype=bool)
    found = np.full((len(whole), len(whole)), math.nan)
    if len(free):
        inner = (ways[told].T / sizes[told] ** 2) @ ways[told]
        hidden = 1.0 - np.sum(ways[told] ** 2, axis=0) > _IN_IT**2
        inner[hidden] = inner[:, hidden] = math.nan
        inner[np.flatnonzero(hidden), np.flatnonzero(hidden)] = math.inf
        found[np.ix_(free, free)] = inner
    found = found[:p, :p]
    factor = float(stats.norm.ppf(0.5 + 0.5 * _LEVEL))
    if plan.noise == "estimated":
        if freedoms > 0:
            found = found * (np.sum(weights * residuals**2) / freedoms)
            factor = float(stats.t.ppf(0.5 + 0.5 * _LEVEL, freedoms))
        else:
            found = np.full((p, p), math.nan)
    half = factor * np.sqrt(np.diag(found))
    values, log = whole[:p], unknowns.logarithmic
    sizes_of = unknowns.sizes()[:p]
    with np.errstate(over="ignore", invalid="ignore"):
        low = np.where(log, values * np.exp(-half), values - half * sizes_of)
        high = np.where(log, values * np.exp(half), values + half * sizes_of)
        rates = unknowns.rates(whole)[:p]
        covariance = found / np.outer(rates, rates)
    return Bands(covariance, np.sqrt(np.diag(covariance)), low, high, chi2, freedoms)
