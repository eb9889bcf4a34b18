"""What a fit knows of its parameters where its search has ended, in SI units.

The rules are :func:`antenna_pin.fit.sureness.sure`'s, in the coordinates of the search: intervals of
logarithms are those of logarithms, so not even about the value.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError
from antenna_pin.fit.plan import FitPlan
from antenna_pin.fit.searched import DOUBT, names_of, natural
from antenna_pin.fit.sureness import Noise, Sure, sure
from antenna_pin.fit.unknowns import Unknowns

__all__ = ["BEYOND_CHANCE", "WITHHELD", "Bands", "bands_of"]

Array = NDArray[np.float64]

#: Share of records of the stated noise below which a chi2 is beyond chance [-].
BEYOND_CHANCE = 1e-6
#: Chi2 over degrees of freedom from which on a fit beyond chance has no bands; below they are widened [-].
WITHHELD = 4.0


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
        wider: How many times as wide they would be at most if what hangs together in time of the residuals
            counted [-].
        chance: Share of records of the stated noise that would be farther from the model [-]; NaN where the
            noise is not given, or the loss not linear.
        noise: What the bands take to be known of the noise: ``estimated`` where chi2 is beyond chance.
    """

    covariance: Array
    sd: Array
    low: Array
    high: Array
    chi2: float
    freedoms: int
    without: str = ""
    wider: float = 1.0
    chance: float = math.nan
    noise: Noise = "given"

    @property
    def beyond_chance(self) -> bool:
        """Whether noise of the stated size does not explain the residuals."""
        return self.chance < BEYOND_CHANCE

    @property
    def excess(self) -> float:
        """Chi2 over degrees of freedom [-]."""
        return self.chi2 / max(self.freedoms, 1)


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


def bands_of(
    plan: FitPlan,
    unknowns: Unknowns,
    whole: Array,
    residuals: Array,
    slopes: Array,
    curves: NDArray[np.intp],
) -> Bands:
    """Return what is known of the parameters at 95 %.

    A parameter at one of its bounds has the others' bands, and none itself: it is where it was kept. Where
    the noise is given and chi2 beyond chance, bands are widened as if the residuals said how large the noise
    is; where they are far beyond (:data:`WITHHELD`) there are none.

    Args:
        plan: Which says whether the noise is known.
        unknowns: Of the fit.
        whole: Values with states, (p + h,) [SI].
        residuals: There, (m,).
        slopes: Their derivatives by what is searched for, (m, p + h).
        curves: The number of the curve that each residual is of, (m,).
    """
    at = unknowns.searched(whole)
    end = _End(names_of(unknowns), at, *unknowns.bounds(), np.ones(len(at)), residuals, slopes)
    p, chi2 = unknowns.count, float(residuals @ residuals)

    def known_of(noise: Noise) -> Sure:
        return sure(
            end,
            at,
            noise=noise,
            loss=plan.loss,
            loss_scale=plan.loss_scale,
            curves=curves,
            doubt=DOUBT,
        )

    try:
        found = known_of(plan.noise)
        judged = plan.noise == "given" and plan.loss == "linear" and found.freedom > 0
        chance = found.chance if judged else math.nan
        if chance < BEYOND_CHANCE:
            found = known_of("estimated")
    except InvalidParameterError as error:  # what was found stays, whatever can be said of it
        return _none(p, chi2, len(residuals) - len(whole), str(error))
    if chance < BEYOND_CHANCE and chi2 > WITHHELD * found.freedom:
        said = "residuals are too large for noise, and the model's slopes hold near a fit only"
        return _none(p, chi2, found.freedom, said)._replace(chance=chance, noise=found.noise)
    known = natural(found, unknowns)
    held = found.held[:p]
    covariance, low, high = known.covariance.copy(), known.low.copy(), known.high.copy()
    covariance[held, :] = covariance[:, held] = np.nan
    low[held] = high[held] = np.nan
    sd = np.sqrt(np.diag(covariance))
    wider = _wider(found, known_of, p)
    return Bands(covariance, sd, low, high, chi2, found.freedom, "", wider, chance, found.noise)


def _none(count: int, chi2: float, freedoms: int, why: str) -> Bands:
    """Return that there are no bands."""
    none = np.full(count, np.nan)
    return Bands(np.full((count, count), np.nan), none, none, none, chi2, freedoms, why)


def _wider(found: Sure, known_of: Callable[[Noise], Sure], count: int) -> float:
    """Return by how much intervals of the first values would be wider at most, as :class:`Bands` has it."""
    if found.noise == "correlated" or found.freedom < 1:
        return 1.0
    told = found.error[:count]
    there = np.isfinite(told) & (told > 0.0)
    return float(np.max(known_of("correlated").error[:count][there] / told[there], initial=1.0))
