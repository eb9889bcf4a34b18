r"""Uncertainty of least-squares estimates: losses, rank of the Jacobian, covariance, confidence intervals.

A fit minimizes :math:`\tfrac12 \sum_i s^2 \rho(r_i^2 / s^2)`, with the scale s at which a residual begins to
count less. Its slope in a residual is :math:`\psi(r) = \rho'(z)\, r` with :math:`z = r^2 / s^2`, and its
curvature :math:`\psi'(r) = \rho'(z) + 2 z \rho''(z)`.

Parameters have units of their own, so that the columns of a Jacobian cannot be compared by size. Columns are
scaled to length 1 first: what is left between them is how similar two changes of the record are.

About the best values the weighted residuals are :math:`r + J \Delta`, and the values have the covariance
:math:`\phi\,(J^T J)^{-1}`, with :math:`\phi = 1` where the noise of the record is known and the residuals are
in units of it, and :math:`\phi = r^T r / (m - p)` where it is estimated from the residuals. Of a robust loss,
and of residuals correlated in time, it is the sandwich :math:`H^{-1} M H^{-1}` with the curvature :math:`H =
J^T \mathrm{diag}(\psi') J` and the variance M of the slope :math:`J^T \psi`.

References:
    Bates and Watts (1988), Nonlinear Regression Analysis and Its Applications, chapter 2.
    Huber (1981), Robust Statistics, sections 7.5 and 7.6.
    Newey and West (1987), Econometrica 55(3), 703-708; Andrews (1991), Econometrica 59(3), 817-858.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, get_args

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.rules import BetweenZeroAndOne
from antenna_pin.errors import InvalidParameterError, UnknownNameError

# --- losses -------------------------------------------------------------------------------------------------

Loss = Literal["linear", "soft_l1", "huber", "cauchy", "arctan"]
"""What scipy.optimize.least_squares calls them."""

LOSSES: tuple[Loss, ...] = get_args(Loss)


def _terms(residuals: Array, loss: Loss, scale: float) -> tuple[Array, Array, Array, Array]:
    """Return z, and rho with its two derivatives there, (m,) each."""
    if loss not in LOSSES:
        raise UnknownNameError("fit", "loss", loss, LOSSES)
    check_number("fit", "loss_scale", scale, "positive")
    z = (residuals / scale) ** 2
    one = np.ones_like(z)
    if loss == "linear":
        return z, z, one, 0.0 * z
    if loss == "soft_l1":
        root = np.sqrt(1.0 + z)
        return z, 2.0 * (root - 1.0), 1.0 / root, -0.5 / root**3
    if loss == "huber":
        far = z > 1.0
        size = np.sqrt(np.where(far, z, 1.0))
        return z, np.where(far, 2.0 * size - 1.0, z), 1.0 / size, np.where(far, -0.5 / size**3, 0.0)
    if loss == "cauchy":
        return z, np.log1p(z), 1.0 / (1.0 + z), -1.0 / (1.0 + z) ** 2
    return z, np.arctan(z), 1.0 / (1.0 + z**2), -2.0 * z / (1.0 + z**2) ** 2


def cost(residuals: Array, loss: Loss = "linear", scale: float = 1.0) -> float:
    """Return twice the minimized loss: of the linear loss the sum of squares [-]."""
    _, rho, _, _ = _terms(residuals, loss, scale)
    return float(scale**2 * rho.sum())


def influence(residuals: Array, loss: Loss = "linear", scale: float = 1.0) -> Array:
    """Return the slope psi of the loss in each residual, (m,) [-]."""
    _, _, slope, _ = _terms(residuals, loss, scale)
    return np.asarray(slope * residuals)


def curvature(residuals: Array, loss: Loss = "linear", scale: float = 1.0) -> Array:
    """Return the curvature psi' of the loss in each residual, (m,) [-].

    It may be negative far out.
    """
    z, _, slope, bend = _terms(residuals, loss, scale)
    return np.asarray(slope + 2.0 * z * bend)


# --- rank of a Jacobian -------------------------------------------------------------------------------------

DOUBT = 1e-7
"""Relative error that a column of a Jacobian is taken to have: that of good differences of runs [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Rank:
    """Rank of a Jacobian."""

    influential: NDArray[np.bool_]  # parameters with any effect on the record, (p,)
    determined: NDArray[np.bool_]  # parameters identifiable with all others free, (p,)
    lengths: Array  # of the columns, each times its parameter's scale, (p,) [-]
    singular: Array  # singular values of unit columns, falling, influential ones only, (felt,) [-]
    identified: Array  # identifiable directions of the scaled parameters, a row each, (rank, p)
    null: Array  # null directions in scales, reduced to as few parameters as possible, (p - rank, p)

    @property
    def full(self) -> bool:
        """Return whether every parameter is identifiable."""
        return bool(self.determined.all())


def rank_of(jacobian: Array, scale: Array, doubt: float = DOUBT) -> Rank:
    """Return the rank of a Jacobian, with its identifiable directions.

    A direction is unidentifiable if its effect on the record is within the error of the Jacobian itself: a
    singular value below ``doubt`` times the root of the number of parameters, of columns of length 1. A
    parameter has no influence if one scale of it has less than ``doubt`` squared of the largest effect.

    Raises:
        InvalidParameterError: The Jacobian is not finite, or has another shape.
    """
    count = len(scale)
    if jacobian.ndim != 2 or jacobian.shape[1] != count or not len(jacobian):
        raise InvalidParameterError(
            "fit", "jacobian", f"of {count} columns, one a parameter", said=f"shape {jacobian.shape}"
        )
    if not np.isfinite(jacobian).all():
        row, column = np.argwhere(~np.isfinite(jacobian))[0].tolist()
        raise InvalidParameterError(
            "fit", "jacobian", "finite", said=f"{jacobian[row, column]} in row {row}, column {column}"
        )
    scaled = jacobian * scale
    lengths = np.linalg.norm(scaled, axis=0)
    felt = lengths > doubt**2 * lengths.max(initial=0.0)
    places = np.flatnonzero(felt)
    unit = scaled[:, places] / lengths[places]
    _, singular, right = np.linalg.svd(unit, full_matrices=len(unit) < len(places))
    kept = int(np.count_nonzero(singular > doubt * np.sqrt(max(len(places), 1))))
    told, null = np.zeros((kept, count)), np.zeros((count - kept, count))
    told[:, places] = right[:kept] / lengths[places]  # scaled @ told.T has orthogonal columns
    determined = felt.copy()
    # The error of singular vectors is that of the columns over the gap of singular values.
    determined[places] = np.linalg.norm(right[kept:], axis=0) <= 100.0 * doubt * np.sqrt(len(places))
    null[: len(places) - kept, places] = right[kept:] / lengths[places]
    null[len(places) - kept :, ~felt] = np.eye(count - len(places))
    null[:, determined] = 0.0
    null = _echelon(null)
    null = null[np.argsort(np.abs(null).argmax(axis=1), kind="stable")] if len(null) else null
    return Rank(felt, determined, lengths, singular, told, null)


def _echelon(rows: Array) -> Array:
    """Return rows of the same span in reduced echelon form, largest entries first."""
    found = rows.copy()
    free = np.ones(found.shape[1], dtype=bool)
    for k in range(len(found)):
        sizes = np.where(free, np.abs(found[k:]), 0.0)
        row, column = np.unravel_index(int(sizes.argmax()), sizes.shape)
        found[[k, k + int(row)]] = found[[k + int(row), k]]
        found[k] /= found[k, column]
        free[column] = False
        others = np.arange(len(found)) != k
        found[others] -= np.outer(found[others, column], found[k])
    return found


# --- covariance and confidence intervals --------------------------------------------------------------------

Noise = Literal["given", "estimated", "correlated"]
"""What is known of the noise: its size; that residuals are it; that they are correlated in time as well."""

_NOISES: tuple[Noise, ...] = get_args(Noise)

# Relative distance of a value at its bound, over the bounds' distance or its scale.
_AT_BOUND = 1e-9


class Residuals(Protocol):
    """Residuals that a fit minimizes, over its free parameters."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, p of them."""

    @property
    def start(self) -> Array:
        """Values to start from, (p,)."""

    @property
    def lower(self) -> Array:
        """Least values, (p,); minus infinity where there is none."""

    @property
    def upper(self) -> Array:
        """Largest values, (p,)."""

    @property
    def scale(self) -> Array:
        """Typical sizes, (p,), positive."""

    def residuals(self, values: Array) -> Array:
        """Return model less record, over the noise's standard deviation, (m,) [-]."""

    def jacobian(self, values: Array) -> Array:
        """Return the derivatives of the residuals, (m, p)."""


@dataclass(frozen=True, slots=True, eq=False)
class ResidualFunctions:
    """Residuals and their derivatives as functions, with the members of :class:`Residuals`."""

    names: tuple[str, ...]
    start: Array
    lower: Array
    upper: Array
    scale: Array
    residuals: Callable[[Array], Array]
    jacobian: Callable[[Array], Array]


@dataclass(frozen=True, slots=True, eq=False)
class Sure:
    """Uncertainty of a fit's values."""

    names: tuple[str, ...]  # names of the parameters
    values: Array  # values, (p,)
    # covariance of the values, (p, p); infinite on the diagonal if unidentifiable, NaN beside it, and zero at
    # a bound
    covariance: Array
    error: Array  # standard errors, (p,)
    correlation: Array  # (p, p) [-]; NaN if unidentifiable or at a bound
    low: Array  # lower ends of the intervals, (p,)
    high: Array  # upper ends, (p,)
    level: float  # confidence level of the intervals [-]
    # true for a value held by a bound, (p,); the others' uncertainty takes it as known
    held: NDArray[np.bool_]
    rank: Rank  # rank of the Jacobian of the others
    direction_covariance: Array  # covariance along ``rank.identified``, (rank, rank)
    freedom: int  # residuals less parameters [-]
    factor: float  # variance phi of a weighted residual [-]
    # ratio of a variance to that by phi and the curvature of the loss alone, (p,) [-]: 1 for independent
    # residuals and a linear loss
    stretch: Array
    chi_squared: float  # sum of the squares of the weighted residuals [-]
    noise: Noise  # assumption on the noise

    @property
    def quantile(self) -> float:
        """Half width of an interval in standard errors [-]."""
        return student_quantile(self.level, math.inf if self.noise == "given" else self.freedom)

    @property
    def chance(self) -> float:
        """Probability of a worse record by the stated noise [-]."""
        from scipy.stats import chi2

        return float(chi2.sf(self.chi_squared, self.freedom))


def student_quantile(level: float, freedom: float) -> float:
    """Return the half width of an interval in standard errors [-], by Student's t."""
    from scipy import stats

    share = 0.5 + 0.5 * level
    return float(stats.norm.ppf(share) if math.isinf(freedom) else stats.t.ppf(share, freedom))


@takes()
def sure(
    problem: Residuals,
    values: Array,
    *,
    noise: Noise = "estimated",
    loss: Loss = "linear",
    loss_scale: float = 1.0,
    level: BetweenZeroAndOne = 0.95,
    curves: NDArray[np.intp] | None = None,
    doubt: float = DOUBT,
) -> Sure:
    """Return the uncertainty of the values at the end of a fit.

    Args:
        problem: Problem of the fit.
        values: The best values, (p,).
        noise: ``given``, residuals are in units of it; ``estimated``, its size follows from the residuals;
            ``correlated``, as estimated, with correlation in time.
        loss: Loss of the fit.
        loss_scale: Residual from which the loss grows more slowly [-].
        level: Confidence level of the intervals [-].
        curves: Index of each residual's curve, (m,), those of one curve in order of time; one curve by
            default. For ``correlated`` only.
        doubt: Relative error of the Jacobian's columns [-].

    Raises:
        InvalidParameterError: The residuals are no more than the parameters, or the curvature of a loss that
            falls far out is not positive at the best values.
    """
    if noise not in _NOISES:
        raise UnknownNameError("fit", "noise", noise, _NOISES)
    found = np.asarray(values, dtype=float)
    residuals, jacobian = problem.residuals(found), problem.jacobian(found)
    rank = rank_of(jacobian, problem.scale, doubt)
    slope = influence(residuals, loss, loss_scale)
    held = _at_bound(problem, found, jacobian.T @ slope)
    if held.any():
        rank = rank_of(np.where(held, 0.0, jacobian), problem.scale, doubt)
    freedom = len(residuals) - len(rank.identified)
    if freedom < 1 and not (noise == "given" and loss == "linear"):
        rule = f"more than the identifiable parameters, {len(rank.identified)}"
        raise InvalidParameterError("fit", "residuals", rule, len(residuals))
    bend = curvature(residuals, loss, loss_scale)
    factor = 1.0 if noise == "given" and loss == "linear" else _variance_factor(slope, bend, freedom)
    along = (jacobian * problem.scale) @ rank.identified.T
    if loss == "linear" and noise != "correlated":
        inner = np.diag(factor / rank.singular[: len(rank.identified)] ** 2)
        stretch = np.ones(len(found))
    else:
        whole = _curvature(along, bend, loss)
        spread = _score_variance(along, slope, residuals, noise, curves) * (len(residuals) / freedom)
        inner = np.linalg.solve(whole, np.linalg.solve(whole, spread).T)
        naive = np.einsum("ki,kl,li->i", rank.identified, factor * np.linalg.inv(whole), rank.identified)
        real = np.einsum("ki,kl,li->i", rank.identified, inner, rank.identified)
        stretch = np.divide(real, naive, out=np.ones(len(found)), where=naive > 0.0)
    scaled = rank.identified.T @ inner @ rank.identified
    covariance = scaled * np.outer(problem.scale, problem.scale)
    unclear = ~rank.determined & ~held
    covariance[unclear, :] = covariance[:, unclear] = np.nan
    covariance[unclear, unclear] = np.inf
    covariance[held, :] = covariance[:, held] = 0.0
    error = np.sqrt(np.diag(covariance))
    sizes = np.where((error > 0.0) & np.isfinite(error), error, np.nan)
    correlation = covariance / np.outer(sizes, sizes)
    known = np.isfinite(sizes)
    correlation[known, known] = 1.0
    reach = student_quantile(level, math.inf if noise == "given" else freedom)
    return Sure(
        tuple(problem.names),
        found,
        covariance,
        error,
        correlation,
        found - reach * error,
        found + reach * error,
        level,
        held,
        rank,
        inner,
        freedom,
        factor,
        stretch,
        float(residuals @ residuals),
        noise,
    )


def _variance_factor(slope: Array, bend: Array, freedom: int) -> float:
    """Return phi, which scales the growth of a loss to a chi squared [-].

    Of the linear loss the variance of the residuals; of others E(psi^2) / E(psi').
    """
    return float(slope @ slope / freedom / max(float(bend.mean()), 1e-300))


def _at_bound(problem: Residuals, values: Array, slope: Array) -> NDArray[np.bool_]:
    """Return whether values are at a bound, with the loss falling beyond it."""
    room = np.where(np.isfinite(problem.upper - problem.lower), problem.upper - problem.lower, problem.scale)
    low = (values - problem.lower <= _AT_BOUND * room) & (slope >= 0.0)
    high = (problem.upper - values <= _AT_BOUND * room) & (slope <= 0.0)
    return np.asarray(low | high)


def _curvature(along: Array, bend: Array, loss: Loss) -> Array:
    whole = along.T @ (along * bend[:, None])
    if len(whole) and not np.linalg.eigvalsh(whole)[0] > 0.0:  # there is none where nothing is told
        raise InvalidParameterError(
            "fit",
            "loss",
            "one whose curvature is positive where the fit has ended; take soft_l1, or a larger loss_scale",
            loss,
        )
    return np.asarray(whole)


def _score_variance(
    along: Array, slope: Array, residuals: Array, noise: Noise, curves: NDArray[np.intp] | None
) -> Array:
    """Return the variance of the loss's slope, (rank, rank), within curves if correlated."""
    scores = along * slope[:, None]
    total = scores.T @ scores
    if noise != "correlated":
        return np.asarray(total)
    numbers = np.zeros(len(residuals), dtype=int) if curves is None else curves
    for part in (np.flatnonzero(numbers == one) for one in np.unique(numbers)):
        mine = scores[part]
        lags = _lag_count(autocorrelation(residuals[part]), len(mine))
        for lag in range(1, lags + 1):
            one = mine[lag:].T @ mine[:-lag]
            total = total + (1.0 - lag / (lags + 1.0)) * (one + one.T)
    return np.asarray(total)


def autocorrelation(residuals: Array) -> float:
    """Return the correlation of residuals with the next ones [-]."""
    if len(residuals) < 3:
        return 0.0
    apart = residuals - residuals.mean()
    total = float(apart @ apart)
    return float(apart[1:] @ apart[:-1]) / total if total > 0.0 else 0.0


def is_correlated(residuals: Array) -> bool:
    """Return whether residuals are correlated by more than three standard errors."""
    return len(residuals) > 10 and autocorrelation(residuals) > 3.0 / math.sqrt(len(residuals))


def _lag_count(rho: float, count: int) -> int:
    """Return the number of lags of correlation: Andrews (1991), (6.2), (6.4), of AR(1)."""
    rho = min(abs(rho), 0.99)
    strength = 4.0 * rho**2 / (1.0 - rho**2) ** 2
    return min(int(math.ceil(1.1447 * float(strength * count) ** (1.0 / 3.0))), count // 4)
