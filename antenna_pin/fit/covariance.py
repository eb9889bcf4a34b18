"""What a fit knows of its parameters where its search has ended, in SI units.

The rules are :func:`antenna_pin.fit.sureness.sure`'s, in the coordinates of the search: intervals of
logarithms are those of logarithms, so not even about the value.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError
from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.searched import DOUBT, names_of, natural
from antenna_pin.fit.sureness import sure
from antenna_pin.fit.unknowns import Unknowns

__all__ = ["Bands", "bands_of"]

Array = NDArray[np.float64]


class Bands(NamedTuple):
    """What is known of p parameters at 95 %.

    Attributes:
        covariance: (p, p) [SI], to first order; infinite where the records say nothing, NaN where a bound
            holds a parameter.
        sd: (p,) [SI].
        low: Lower ends of the bands, (p,) [SI].
        high: Upper ends.
        chi2: Sum of the squares of the residuals [-].
        freedoms: Residuals less directions of the unknowns that they tell [-].
        without: Why there are no bands, in words; "" if there are.
    """

    covariance: Array
    sd: Array
    low: Array
    high: Array
    chi2: float
    freedoms: int
    without: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class _End:
    """The end of a search as what is made small there, in its coordinates."""

    names: tuple[str, ...]
    start: Array
    lower: Array
    upper: Array
    scale: Array
    left: Array
    slopes: Array

    def residuals(self, values: Array) -> Array:
        return self.left

    def jacobian(self, values: Array) -> Array:
        return self.slopes


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
    at = unknowns.searched(whole)
    end = _End(names_of(unknowns), at, *unknowns.bounds(), np.ones(len(at)), residuals, slopes)
    p, chi2 = unknowns.count, float(residuals @ residuals)
    try:
        found = sure(
            end,
            at,
            noise=plan.noise,
            loss=plan.loss,
            loss_scale=plan.loss_scale,
            doubt=DOUBT,
        )
    except InvalidParameterError as error:  # what was found stays, whatever can be said of it
        none = np.full(p, np.nan)
        return Bands(np.full((p, p), np.nan), none, none, none, chi2, len(residuals) - len(whole), str(error))
    known = natural(found, unknowns)
    held = found.held[:p]
    covariance, low, high = known.covariance.copy(), known.low.copy(), known.high.copy()
    covariance[held, :] = covariance[:, held] = np.nan
    low[held] = high[held] = np.nan
    return Bands(covariance, np.sqrt(np.diag(covariance)), low, high, chi2, found.freedom)
