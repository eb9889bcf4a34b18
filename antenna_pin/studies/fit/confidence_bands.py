"""Confidence intervals of a fit's parameters, and pointwise bands of its curves, in SI units.

Along the Jacobian the variance of a curve is that of the values, to first order, without further runs. By
sampling, the model is run at values drawn about the best ones; each draw is weighted by its likelihood
(importance sampling), so that a band follows a loss that is no parabola, and one-sided ones.

In search coordinates a parameter is over its size, or its logarithm, and the starts of a record's pieces are
unknown beside the parameters: an interval of a parameter includes their uncertainty, and one of a logarithm
is even in the logarithm, not about the value.

References:
    Bates and Watts (1988), section 2.3.2. Robert and Casella (2004), Monte Carlo Statistical Methods, section
    3.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_number
from antenna_pin.base.arrays import Array
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.studies.fit.plan import FitPlan, Unknowns
from antenna_pin.studies.fit.profile_likelihood import Profile
from antenna_pin.studies.fit.uncertainty import Loss, Noise, ResidualFunctions, Residuals, Sure, cost, sure

# --- bands of curves ----------------------------------------------------------------------------------------

# Most degrees of freedom of the t distribution of draws, whose tails must be heavier than the target's.
_TAILS = 6.0
# Most repetitions of draws beyond a bound, per draw.
_TRIES = 200


@dataclass(frozen=True, slots=True, eq=False)
class CurveBands:
    """Pointwise bands of the weighted residuals, in standard deviations of the noise [-]."""

    low: Array  # lower end of the model's curve, (m,)
    high: Array  # upper end, (m,)
    new_low: Array  # lower end for a new measurement, (m,)
    new_high: Array  # upper end, (m,)
    level: float  # probability at each point
    seed: int = -1  # of the draws; -1 without draws
    drawn: int = 0  # draws with a run
    failed: int = 0  # draws without a run
    effective: float = math.nan  # equivalent number of draws of equal weight


def linear_bands(problem: Residuals, uncertainty: Sure) -> CurveBands:
    """Return bands to first order in the standard errors.

    Unidentified directions do not move the curves, and are ignored.
    """
    residuals, jacobian = problem.residuals(uncertainty.values), problem.jacobian(uncertainty.values)
    along = (jacobian * problem.scale) @ uncertainty.rank.identified.T
    spread = np.maximum(np.einsum("ij,jk,ik->i", along, uncertainty.direction_covariance, along), 0.0)
    curve = uncertainty.quantile * np.sqrt(spread)
    new = uncertainty.quantile * np.sqrt(spread + uncertainty.factor)
    return CurveBands(
        residuals - curve, residuals + curve, residuals - new, residuals + new, uncertainty.level
    )


def draws(problem: Residuals, uncertainty: Sure, count: int, seed: int) -> tuple[Array, Array]:
    """Return values drawn about the best ones, (n, p), and their log densities, (n,).

    Draws lie within the bounds, and follow Student's t of six degrees of freedom, or fewer for a record with
    fewer, with the fit's covariance; a draw beyond a bound is repeated.

    Raises:
        InvalidParameterError: A parameter is not identifiable, or hardly a draw is within bounds.
    """
    check_number("fit", "draws", count, "2 or more")
    unclear = [
        name
        for name, error in zip(uncertainty.names, uncertainty.error, strict=True)
        if not math.isfinite(error)
    ]
    if unclear:
        rule = "of parameters that the records determine; hold the others, or give them a prior"
        raise InvalidParameterError("fit", "bands", rule, said=", ".join(unclear))
    free = np.flatnonzero(uncertainty.error > 0.0)
    sizes = uncertainty.error[free]
    correlation = uncertainty.covariance[np.ix_(free, free)] / np.outer(sizes, sizes)
    value, vector = np.linalg.eigh(correlation)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    tails = min(_TAILS, float(uncertainty.freedom))
    random = np.random.default_rng(seed)
    rows: list[Array] = []
    logs: list[float] = []
    for _ in range(_TRIES * count):
        if len(rows) == count:
            break
        normal = random.standard_normal(len(free))
        stretch = math.sqrt(tails / random.chisquare(tails))
        one = uncertainty.values.copy()
        one[free] += sizes * (root @ normal) * stretch
        if np.all((one >= problem.lower) & (one <= problem.upper)):
            rows.append(one)
            distance = float(normal @ normal) * stretch**2
            logs.append(-0.5 * (tails + len(free)) * math.log1p(distance / tails))
    if len(rows) < count:
        rule = (
            f"such that one draw in {_TRIES} lies within them; widen them, or hold the parameter at its bound"
        )
        raise InvalidParameterError("fit", "bounds", rule, said=f"{len(rows)} of {count}")
    return np.stack(rows), np.array(logs)


def sampled_bands(
    problem: Residuals,
    uncertainty: Sure,
    count: int = 200,
    seed: int = 0,
    *,
    loss: Loss = "linear",
    loss_scale: float = 1.0,
    progress: Callable[[int], None] | None = None,
) -> CurveBands:
    """Return bands by runs of the model at values drawn about the best ones.

    Raises:
        InvalidParameterError: Nothing can be drawn, or fewer than half of the draws have a run.
    """
    values, logs = draws(problem, uncertainty, count, seed)
    curves: list[Array] = []
    weights: list[float] = []
    phi = uncertainty.factor * float(np.max(uncertainty.stretch[uncertainty.error > 0.0], initial=1.0))
    for k, one in enumerate(values):
        try:
            residuals = problem.residuals(one)
        except AntennaPinError:  # a run that cannot be made there
            residuals = None
        if residuals is not None and np.isfinite(residuals).all():
            curves.append(residuals)
            grown = cost(residuals, loss, loss_scale)
            weights.append(_log_likelihood(grown, phi, uncertainty) - logs[k])
        if progress is not None:
            progress(k + 1)
    if 2 * len(curves) < count:
        rule = "such that the model runs at half of the draws or more; narrow the bounds"
        raise InvalidParameterError("fit", "draws", rule, said=f"{len(curves)} of {count}")
    share = np.exp(np.array(weights) - max(weights))
    share /= share.sum()
    every = np.stack(curves)
    noise = math.sqrt(uncertainty.factor) * np.random.default_rng([seed, 1]).standard_normal(every.shape)
    ends = (0.5 - 0.5 * uncertainty.level, 0.5 + 0.5 * uncertainty.level)
    low, high = (_quantile(every, share, one) for one in ends)
    new_low, new_high = (_quantile(every + noise, share, one) for one in ends)
    effective = 1.0 / float(share @ share)
    return CurveBands(
        low, high, new_low, new_high, uncertainty.level, seed, len(curves), count - len(curves), effective
    )


def _log_likelihood(grown: float, phi: float, uncertainty: Sure) -> float:
    """Return the log likelihood of a draw: normal, or Student's t of estimated noise."""
    if uncertainty.noise == "given":
        return -0.5 * grown / phi
    # Marginal over the noise's size: (S / S_least)^(-m / 2), of a linear model Student's t.
    count = uncertainty.freedom + len(uncertainty.rank.identified)
    return -0.5 * count * math.log(max(grown, 1e-300) / (uncertainty.freedom * phi))


def _quantile(every: Array, share: Array, at: float) -> Array:
    """Return a quantile of weighted rows, (m,)."""
    order = np.argsort(every, axis=0, kind="stable")
    rising = np.take_along_axis(every, order, axis=0)
    below = np.cumsum(share[order], axis=0) - 0.5 * share[order]
    return np.array([np.interp(at, below[:, k], rising[:, k]) for k in range(every.shape[1])])


# --- search coordinates and SI units ------------------------------------------------------------------------

_Columns = dict[str, tuple[tuple[str, ...], Any, dict[str, str]]]

#: Relative error of a Jacobian's columns [-]: differences of runs at 1e-4 of a size lose four digits of a
#: run's accuracy.
DOUBT = 1e-5

_SIDES = ("below", "above")


def search_residuals(
    unknowns: Unknowns, whole: Array, residuals: Callable[[Array], Array], jacobian: Callable[[Array], Array]
) -> ResidualFunctions:
    """Return residuals over search coordinates, starting at values with states, (p + h,) [SI]."""
    start = unknowns.to_search(whole)
    names = (*unknowns.names, *(f"state {k + 1}" for k in range(unknowns.states)))
    return ResidualFunctions(names, start, *unknowns.bounds(), np.ones(len(start)), residuals, jacobian)


def _parameter_in_si(unknowns: Unknowns, values: Array, place: int) -> Array:
    """Return numbers of one parameter in SI units, without bounds."""
    with np.errstate(over="ignore"):
        found = np.exp(values) if unknowns.logarithmic[place] else values * unknowns.sizes()[place]
    return np.asarray(found)


class _Intervals(NamedTuple):
    """Covariance and intervals of parameters in SI units."""

    covariance: Array  # (p, p), to first order
    low: Array  # lower ends, (p,)
    high: Array  # upper ends, (p,)


def _in_si_units(uncertainty: Sure, unknowns: Unknowns) -> _Intervals:
    """Return covariance and intervals of parameters in SI units."""
    p = unknowns.count
    whole = np.array([_parameter_in_si(unknowns, uncertainty.values[k], k) for k in range(p)])
    values = np.concatenate([whole, uncertainty.values[p:]])
    rates = unknowns.search_slopes(values)[:p]
    low, high = (
        np.array([float(_parameter_in_si(unknowns, ends[k], k)) for k in range(p)])
        for ends in (uncertainty.low, uncertainty.high)
    )
    return _Intervals(uncertainty.covariance[:p, :p] / np.outer(rates, rates), low, high)


def profile_columns(profiles: Sequence[Profile], unknowns: Unknowns) -> _Columns:
    """Return profiles as columns of a fit's dataset, in SI units, or NaN."""
    p, most = unknowns.count, max((len(one.values) for one in profiles), default=0)
    values, roots = np.full((2, p, most), np.nan)
    ends, words = np.full((p, 2), np.nan), np.full((p, 2), "", dtype=object)
    for one in profiles:
        k = unknowns.names.index(one.name)
        values[k, : len(one.values)] = _parameter_in_si(unknowns, one.values, k)
        roots[k, : len(one.root)] = one.root
        ends[k] = _parameter_in_si(unknowns, np.array([one.low, one.high]), k)
        words[k] = one.ends
    steps, sides = ("parameter", "step"), ("parameter", "side")
    return {
        "profile_value": (steps, values, {"long_name": "value at which the parameter was held"}),
        "profile_root": (steps, roots, {"units": "1", "long_name": "signed root of the growth of the loss"}),
        "profile_end": (sides, ends, {"long_name": "end of the profile's interval"}),
        "profile_reach": (
            (),
            profiles[0].threshold if profiles else np.nan,
            {"units": "1", "long_name": "root at an end"},
        ),
        "profile_how": (sides, words, {"long_name": "how it ends: crossed, bounded, open, stopped"}),
    }


def band_columns(bands: CurveBands, predicted: xr.Dataset, weights: Array) -> _Columns:
    """Return curve bands as columns of a fit's dataset, in its rows' units."""
    count, rows = predicted.sizes["row"], ("row",)
    one = predicted["noise"].values / np.asarray(weights)
    return {
        name: (rows, predicted["data"].values + ends[:count] * one, {"long_name": words})
        for name, ends, words in (
            ("band_low", bands.low, "lower end of where the model's curve may be"),
            ("band_high", bands.high, "upper end"),
            ("new_low", bands.new_low, "lower end of where a new measurement may be"),
            ("new_high", bands.new_high, "upper end"),
        )
    }


# --- bands of parameters ------------------------------------------------------------------------------------

#: Probability of a worse record below which a chi2 is beyond chance [-].
BEYOND_CHANCE = 1e-6
#: Chi2 over degrees of freedom from which a fit beyond chance has no bands; below they are widened [-].
WITHHELD = 4.0


class ParameterBands(NamedTuple):
    """Uncertainty of p parameters at 95 %."""

    covariance: Array  # (p, p) [SI], to first order; infinite if unidentified, NaN at a bound
    sd: Array  # (p,) [SI]
    low: Array  # lower ends of the bands, (p,) [SI]
    high: Array  # upper ends, (p,) [SI]
    chi2: float  # sum of the squares of the residuals [-]
    freedoms: int  # residuals less identified directions of the unknowns [-]
    absence: str = ""  # reason for missing bands, or ""
    widening: float = 1.0  # largest factor of their width by correlation in time of the residuals [-]
    chance: float = math.nan  # probability of a worse record by the stated noise [-]; NaN if not stated
    noise: Noise = "given"  # assumption on the noise: ``estimated`` where chi2 is beyond chance

    @property
    def beyond_chance(self) -> bool:
        """Return whether the residuals are too large for the stated noise."""
        return self.chance < BEYOND_CHANCE

    @property
    def excess(self) -> float:
        """Chi2 over degrees of freedom [-]."""
        return self.chi2 / max(self.freedoms, 1)


def parameter_bands(
    plan: FitPlan, unknowns: Unknowns, whole: Array, residuals: Array, slopes: Array, curves: NDArray[np.intp]
) -> ParameterBands:
    """Return the uncertainty of the parameters at 95 %.

    A parameter at one of its bounds has no band, and the others' bands hold it fixed. Where the noise is
    given and chi2 is beyond chance, bands are widened as if the residuals gave the size of the noise; far
    beyond chance (:data:`WITHHELD`) there are none.

    Values with states are (p + h,) [SI], residuals (m,), their slopes by search coordinates (m, p + h).
    """
    end = search_residuals(unknowns, whole, lambda _: residuals, lambda _: slopes)
    p, chi2 = unknowns.count, float(residuals @ residuals)

    def known_of(noise: Noise) -> Sure:
        settings: Any = {"loss": plan.loss, "loss_scale": plan.loss_scale, "curves": curves, "doubt": DOUBT}
        return sure(end, end.start, noise=noise, **settings)

    try:
        found = known_of(plan.noise)
        judged = plan.noise == "given" and plan.loss == "linear" and found.freedom > 0
        chance = found.chance if judged else math.nan
        if chance < BEYOND_CHANCE:
            found = known_of("estimated")
    except InvalidParameterError as error:  # what was found stays, whatever can be said of it
        return _no_bands(p, chi2, len(residuals) - len(whole), str(error))
    if chance < BEYOND_CHANCE and chi2 > WITHHELD * found.freedom:
        said = "residuals are too large for noise, and the model's slopes hold near a fit only"
        return _no_bands(p, chi2, found.freedom, said)._replace(chance=chance, noise=found.noise)
    known = _in_si_units(found, unknowns)
    held = found.held[:p]
    covariance, low, high = known.covariance.copy(), known.low.copy(), known.high.copy()
    covariance[held, :] = covariance[:, held] = np.nan
    low[held] = high[held] = np.nan
    sd = np.sqrt(np.diag(covariance))
    wider = _widening(found, known_of, p)
    return ParameterBands(covariance, sd, low, high, chi2, found.freedom, "", wider, chance, found.noise)


def _no_bands(count: int, chi2: float, freedoms: int, why: str) -> ParameterBands:
    """Return bands that are absent."""
    none = np.full(count, np.nan)
    return ParameterBands(np.full((count, count), np.nan), none, none, none, chi2, freedoms, why)


def _widening(uncertainty: Sure, known_of: Callable[[Noise], Sure], count: int) -> float:
    """Return the largest ratio of intervals with correlated noise to those without."""
    if uncertainty.noise == "correlated" or uncertainty.freedom < 1:
        return 1.0
    told = uncertainty.error[:count]
    there = np.isfinite(told) & (told > 0.0)
    return float(np.max(known_of("correlated").error[:count][there] / told[there], initial=1.0))
