"""Where curves of a fitted model may lie, and where new measurements may: pointwise bands.

Two ways to the same thing. Along the Jacobian a curve's variance is that of the values, to first order, and
costs nothing. By sampling, the model is run at values drawn about the best ones; each draw counts by how well
it does with the record (importance sampling), so that a band follows a loss that is no parabola, and
one-sided ones.

References:
    Bates and Watts (1988), section 2.3.2. Robert and Casella (2004), Monte Carlo Statistical Methods, section
    3.3.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.fit.losses import Loss, cost
from antenna_pin.fit.sureness import Residuals, Sure

__all__ = ["CurveBands", "along_jacobian", "by_sampling", "draws"]

Array = NDArray[np.float64]

# Freedom of the t distribution that draws are from at most: its tails are to be heavier than what is sought.
_TAILS = 6.0
# How often a draw beyond a bound is drawn again, per draw that is wanted.
_TRIES = 200


@dataclass(frozen=True, slots=True, eq=False)
class CurveBands:
    """Pointwise bands of the weighted residuals: model less record, over the standard deviation of the noise.

    Attributes:
        low: Lower end of the model's curve, (m,) [-].
        high: Upper end, (m,).
        new_low: Lower end of where a new measurement may be, (m,).
        new_high: Upper end, (m,).
        level: Of each point [-].
        seed: Of the draws; -1 where there were none.
        drawn: Draws that the model could be run at [-].
        failed: Draws that it could not be run at [-].
        effective: How many draws of equal weight they are worth [-].
    """

    low: Array
    high: Array
    new_low: Array
    new_high: Array
    level: float
    seed: int = -1
    drawn: int = 0
    failed: int = 0
    effective: float = math.nan


def along_jacobian(problem: Residuals, found: Sure) -> CurveBands:
    """Return bands to first order in the standard errors.

    Directions that the record does not tell do not move its curves, and count for nothing.

    Args:
        problem: What was fitted.
        found: How sure its values are.
    """
    residuals, jacobian = problem.residuals(found.values), problem.jacobian(found.values)
    along = (jacobian * problem.scale) @ found.rank.told.T
    spread = np.maximum(np.einsum("ij,jk,ik->i", along, found.along, along), 0.0)
    curve = found.quantile * np.sqrt(spread)
    new = found.quantile * np.sqrt(spread + found.factor)
    return CurveBands(residuals - curve, residuals + curve, residuals - new, residuals + new, found.level)


def draws(problem: Residuals, found: Sure, count: int, seed: int) -> tuple[Array, Array]:
    """Return values drawn about the best ones, (n, p), and the logarithms of their densities, (n,).

    They lie within their bounds, and are from Student's t of six degrees of freedom, or fewer where the
    record has fewer, with the fit's covariance; what lies beyond a bound is drawn again.

    Args:
        problem: What was fitted.
        found: How sure its values are.
        count: How many.
        seed: Of the draws.

    Raises:
        InvalidParameterError: A parameter cannot be told, so that nothing says from where to draw it, or
            hardly a draw is within bounds.
    """
    if count < 2:
        raise InvalidParameterError("fit", "draws", "2 or more [-]", count)
    unclear = [name for name, error in zip(found.names, found.error, strict=True) if not math.isfinite(error)]
    if unclear:
        rule = "of parameters that the record tells; hold, or bound by a prior record, those that it does not"
        raise InvalidParameterError("fit", "bands", rule, said=", ".join(unclear))
    free = np.flatnonzero(found.error > 0.0)
    sizes = found.error[free]
    correlation = found.covariance[np.ix_(free, free)] / np.outer(sizes, sizes)
    value, vector = np.linalg.eigh(correlation)
    root = vector * np.sqrt(np.maximum(value, 0.0))
    tails = min(_TAILS, float(found.freedom))
    random = np.random.default_rng(seed)
    rows: list[Array] = []
    logs: list[float] = []
    for _ in range(_TRIES * count):
        if len(rows) == count:
            break
        normal = random.standard_normal(len(free))
        stretch = math.sqrt(tails / random.chisquare(tails))
        one = found.values.copy()
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


def by_sampling(
    problem: Residuals,
    found: Sure,
    count: int = 200,
    seed: int = 0,
    *,
    loss: Loss = "linear",
    loss_scale: float = 1.0,
    progress: Callable[[int], None] | None = None,
) -> CurveBands:
    """Return bands by runs of the model at values drawn about the best ones.

    Args:
        problem: What was fitted.
        found: How sure its values are.
        count: Draws, each a run of the model [-].
        seed: Of the draws, and of the noise of new measurements.
        loss: That the fit used.
        loss_scale: The residual at which it begins to count less [-].
        progress: Is told how many draws are done.

    Raises:
        InvalidParameterError: Nothing can be drawn, or the model runs at fewer than half of the draws.
    """
    values, logs = draws(problem, found, count, seed)
    curves: list[Array] = []
    weights: list[float] = []
    phi = found.factor * float(np.max(found.stretch[found.error > 0.0], initial=1.0))
    for k, one in enumerate(values):
        try:
            residuals = problem.residuals(one)
        except AntennaPinError:  # a run that cannot be made there
            residuals = None
        if residuals is not None and np.isfinite(residuals).all():
            curves.append(residuals)
            grown = cost(residuals, loss, loss_scale)
            weights.append(_log_likelihood(grown, phi, found) - logs[k])
        if progress is not None:
            progress(k + 1)
    if 2 * len(curves) < count:
        rule = "such that the model runs at half of the draws or more; narrow the bounds"
        raise InvalidParameterError("fit", "draws", rule, said=f"{len(curves)} of {count}")
    share = np.exp(np.array(weights) - max(weights))
    share /= share.sum()
    every = np.stack(curves)
    noise = math.sqrt(found.factor) * np.random.default_rng([seed, 1]).standard_normal(every.shape)
    ends = (0.5 - 0.5 * found.level, 0.5 + 0.5 * found.level)
    low, high = (_quantile(every, share, one) for one in ends)
    new_low, new_high = (_quantile(every + noise, share, one) for one in ends)
    effective = 1.0 / float(share @ share)
    return CurveBands(
        low, high, new_low, new_high, found.level, seed, len(curves), count - len(curves), effective
    )


def _log_likelihood(grown: float, phi: float, found: Sure) -> float:
    """Return the logarithm of how well a draw does: of known noise a normal one's, else Student's t."""
    if found.noise == "given":
        return -0.5 * grown / phi
    # With the noise's size integrated out: (S / S_least)^(-m / 2), which of a linear model is Student's t.
    count = found.freedom + len(found.rank.told)
    return -0.5 * count * math.log(max(grown, 1e-300) / (found.freedom * phi))


def _quantile(every: Array, share: Array, at: float) -> Array:
    """Return a quantile of weighted rows, (m,)."""
    order = np.argsort(every, axis=0, kind="stable")
    rising = np.take_along_axis(every, order, axis=0)
    below = np.cumsum(share[order], axis=0) - 0.5 * share[order]
    return np.array([np.interp(at, below[:, k], rising[:, k]) for k in range(every.shape[1])])
