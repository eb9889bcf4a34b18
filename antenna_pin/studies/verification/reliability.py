r"""Probabilities of failure, with intervals: plain sampling, subset simulation, importance sampling.

A limit state :math:`g(u)` of independent standard normal variables :math:`u` fails where :math:`g \le 0`.
Numbers in, numbers out: all points of a batch are passed at once, so that a caller may evaluate them side by
side.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.rules import AtLeastOne, BetweenZeroAndOne, NumberRule
from antenna_pin.errors import InvalidParameterError

Array = NDArray[np.float64]

#: Values of a limit state, (points,), at points in standard normal space, (points, variables) [-].
LimitState = Callable[[Array], Array]

# Share of the samples of a level that start the chains of the next one, and the levels at most: 1e-12.
_SHARE, _LEVELS = 0.1, 12
# Points of an adaptive search for the region of failure, share of the best, and rounds at most.
_SEARCH, _ELITE, _ROUNDS = 200, 0.1, 12
# Rounds in the region of failure that improve the centre, and variables up to which such a search finds it.
_REFINED, _MOST_VARIABLES = 2, 10


@dataclass(frozen=True, slots=True)
class FailureProbability:
    """Probability of failure with its interval.

    Attributes:
        probability: Estimate [-].
        low: Lower end of the interval [-].
        high: Upper end of the interval [-].
        confidence: Confidence level of the interval [-].
        runs: Number of evaluations [-].
        failures: Number of failures among the samples that the estimate is made of [-].
        method: Name of the method.
        variation: Coefficient of variation of the estimate; NaN for plain sampling [-].
        message: Note on the estimate, or "".
    """

    probability: float
    low: float
    high: float
    confidence: float
    runs: int
    failures: int
    method: str
    variation: float = math.nan
    message: str = ""


@takes()
def clopper_pearson(
    failures: int, runs: AtLeastOne, confidence: BetweenZeroAndOne = 0.95
) -> tuple[float, float]:
    r"""Return the exact two-sided interval of a binomial probability [-].

    .. math:: p_l = B(\tfrac{\alpha}{2};\, k,\, n - k + 1), \qquad
              p_h = B(1 - \tfrac{\alpha}{2};\, k + 1,\, n - k)

    with the quantiles B of beta distributions; an end without failures (or successes) is 0 (or 1).

    Args:
        failures: k, number of failures.
        runs: n, number of independent runs.
        confidence: Level, 1 - alpha [-].

    Raises:
        InvalidParameterError: A number is out of range.

    References:
        Clopper and Pearson (1934), Biometrika 26(4), 404-413.
    """
    from scipy.stats import beta

    if not 0 <= failures <= runs:
        raise InvalidParameterError("clopper_pearson", "failures", f"from 0 to runs, {runs}", failures)
    tail = 0.5 * (1.0 - confidence)
    low = 0.0 if failures == 0 else float(beta.ppf(tail, failures, runs - failures + 1))
    high = 1.0 if failures == runs else float(beta.ppf(1.0 - tail, failures + 1, runs - failures))
    return low, high


@takes()
def plain_sampling(
    limit: LimitState,
    variables: AtLeastOne,
    *,
    runs: AtLeastOne,
    seed: int = 0,
    confidence: BetweenZeroAndOne = 0.95,
) -> FailureProbability:
    """Return the probability of failure by independent samples, with Clopper and Pearson's interval.

    Args:
        limit: Limit state.
        variables: Number of variables.
        runs: Number of samples.
        seed: Seed of the samples.
        confidence: Level of the interval [-].

    Raises:
        InvalidParameterError: A number is out of range, or a value of the limit state is NaN.
    """
    values = _values(limit, np.random.default_rng(seed).standard_normal((runs, variables)))
    failures = int((values <= 0.0).sum())
    low, high = clopper_pearson(failures, runs, confidence)
    return FailureProbability(failures / runs, low, high, confidence, runs, failures, "plain sampling")


def _values(limit: LimitState, points: Array) -> Array:
    values = np.asarray(limit(points), dtype=float)
    if values.shape != (len(points),) or np.isnan(values).any():
        rule = f"{len(points)} numbers, one for each point"
        raise InvalidParameterError("reliability", "limit", rule, said=f"shape {values.shape}, NaN or not")
    return values


def _around(probability: float, variation: float, confidence: float, freedom: float) -> tuple[float, float]:
    """Return the interval of a positive estimate, Student's in its logarithm."""
    from scipy.stats import t

    if not (probability > 0.0 and math.isfinite(variation)):
        return 0.0, 1.0
    half = float(t.ppf(0.5 * (1.0 + confidence), max(freedom, 1.0)))
    half *= math.sqrt(math.log1p(variation**2))
    return probability * math.exp(-half), min(probability * math.exp(half), 1.0)


def _freedom(terms: Array) -> float:
    """Return the degrees of freedom of a variance: fewer of terms with long tails.

    Satterthwaite's, of the variance of the variance: 2 n / (kurtosis - 1).
    """
    off = terms - terms.mean()
    square = float(np.mean(off**2))
    kurtosis = float(np.mean(off**4)) / square**2 if square > 0.0 else 3.0
    return min(2.0 * len(terms) / max(kurtosis - 1.0, 1e-9), len(terms) - 1.0)


# --- subset simulation --------------------------------------------------------------------------------------


@takes()
def subset_simulation(
    limit: LimitState,
    variables: AtLeastOne,
    *,
    samples: Annotated[int, NumberRule("20 or more")] = 500,
    seed: int = 0,
    confidence: BetweenZeroAndOne = 0.95,
    most_runs: AtLeastOne = 100_000,
) -> FailureProbability:
    r"""Return a small probability of failure as a product of larger ones.

    .. math:: P = \prod_j P(g \le b_j \mid g \le b_{j-1}), \qquad b_0 = \infty

    with levels :math:`b_j` that a tenth of the samples reach. Samples beyond a level are made from those that
    reach it by chains whose stationary distribution is the conditional one, with a step that adapts to an
    acceptance of 0.44. The coefficient of variation adds the levels' own,
    :math:`\delta_j^2 = (1 - P_j)(1 + \gamma_j)/(N P_j)`, with the correlation :math:`\gamma_j` along chains,
    and counts the dependence of successive levels, which share their samples, as the square of half of their
    sum. Its square is the mean of that for independent and for fully dependent levels.

    Args:
        limit: Limit state.
        variables: Number of variables.
        samples: N, number of samples of a level.
        seed: Seed of the samples.
        confidence: Level of the interval [-].
        most_runs: Largest number of evaluations; the estimate is an upper bound where it does not suffice.

    Raises:
        InvalidParameterError: A number is out of range, or a value of the limit state is NaN.

    References:
        Au and Beck (2001), Probab. Eng. Mech. 16(4), 263-277; Papaioannou, Betz, Zwirglmaier and Straub
        (2015), Probab. Eng. Mech. 41, 89-103 (conditional sampling, adaptive step).
    """
    generator = np.random.default_rng(seed)
    points = generator.standard_normal((samples, variables))
    values = _values(limit, points)
    runs, probability, spread = samples, 1.0, 1.0
    chains = np.arange(samples).reshape(1, samples)  # rows: steps of a chain; columns: chains
    variations: list[float] = []
    message = ""
    while True:
        seeds = max(int(round(_SHARE * samples)), 2)
        order = np.argsort(values, kind="stable")
        threshold = float(0.5 * (values[order[seeds - 1]] + values[order[min(seeds, samples - 1)]]))
        final = threshold <= 0.0 or len(variations) == _LEVELS
        threshold = 0.0 if final else threshold
        reached = values <= threshold
        share = float(reached.mean())
        variations.append(_level_variation(reached, chains, share))
        probability *= share
        if final:
            break
        if runs + samples - seeds > most_runs:
            message = f"{most_runs} runs end at a level above failure: the probability is at most this"
            break
        start, start_values = points[reached], values[reached]
        chains, points, values, spread = _conditional(
            limit, start, start_values, threshold, samples, spread, generator
        )
        runs += samples - len(start)
    squares, total = sum(one**2 for one in variations), sum(variations)
    # Between independent levels (Au and Beck's lower estimate) and fully dependent ones (their upper).
    variation = math.sqrt(0.5 * (squares + total**2)) if probability > 0.0 else math.nan
    low, high = _around(probability, variation, confidence, samples - 1)
    failures = int((values <= 0.0).sum())
    if message:
        low, failures = 0.0, 0
    elif failures == 0:
        low, high, message = 0.0, 10.0**-_LEVELS, "no failure down to this probability"
    return FailureProbability(
        probability, low, high, confidence, runs, failures, "subset simulation", variation, message
    )


def _level_variation(reached: NDArray[np.bool_], chains: NDArray[np.int64], share: float) -> float:
    """Return the coefficient of variation of a level's share, with the correlation along chains."""
    if not 0.0 < share < 1.0:
        return 0.0 if share == 1.0 else math.nan
    indicator = reached[chains].astype(float) - share  # (steps, chains)
    length, count = indicator.shape
    variance = share * (1.0 - share)
    gamma = 0.0
    for lag in range(1, length):
        covariance = float((indicator[:-lag] * indicator[lag:]).sum()) / (count * (length - lag))
        gamma += 2.0 * (1.0 - lag / length) * covariance / variance
    return math.sqrt((1.0 - share) / (share * reached.size) * max(1.0 + gamma, 0.1))


def _conditional(
    limit: LimitState,
    start: Array,
    start_values: Array,
    threshold: float,
    samples: int,
    spread: float,
    generator: np.random.Generator,
) -> tuple[NDArray[np.int64], Array, Array, float]:
    """Return chains of samples below a threshold: their indices, points, values, and the adapted step."""
    count, variables = start.shape
    length = -(-samples // count)
    order = generator.permutation(count)
    now, value = start[order], start_values[order]
    points, values = [now], [value]
    for step in range(1, length):
        sigma = min(spread, 1.0)
        candidate = math.sqrt(1.0 - sigma**2) * now + sigma * generator.standard_normal((count, variables))
        # The last row is cut, so that no evaluation is made in vain.
        used = count if step < length - 1 else samples - count * (length - 1)
        found = np.full(count, np.inf)
        found[:used] = _values(limit, candidate[:used])
        accepted = found <= threshold
        now = np.where(accepted[:, None], candidate, now)
        value = np.where(accepted, found, value)
        points.append(now[:used])
        values.append(value[:used])
        spread = math.exp(math.log(spread) + (float(accepted[:used].mean()) - 0.44) / math.sqrt(step))
    whole = len(points) if len(points[-1]) == count else len(points) - 1
    chains = np.arange(whole * count).reshape(whole, count)
    return chains, np.concatenate(points), np.concatenate(values), spread


# --- importance sampling ------------------------------------------------------------------------------------


@takes()
def importance_sampling(
    limit: LimitState,
    variables: AtLeastOne,
    *,
    samples: Annotated[int, NumberRule("20 or more")] = 1000,
    seed: int = 0,
    confidence: BetweenZeroAndOne = 0.95,
) -> FailureProbability:
    r"""Return a small probability of failure by samples about the likeliest failure.

    The centre c of the samples' density is found by cross-entropy: of each round of samples the tenth nearest
    to failure, weighted by likelihood, is the next centre. Then

    .. math:: P = \frac1N \sum_k 1[g(u_k) \le 0]\,
              \exp\left(-c \cdot u_k + \tfrac12 |c|^2\right)

    with Student's interval of its logarithm, of as many degrees of freedom as the kurtosis of the terms
    leaves of N (Satterthwaite 1946): long tails make their variance uncertain. The estimate is unbiased for
    any centre; a second region of failure far from the centre makes its interval too narrow, and
    :func:`subset_simulation` finds it.

    Args:
        limit: Limit state.
        variables: Number of variables.
        samples: N, number of samples of the estimate; the search takes 200 for each round besides.
        seed: Seed of the samples.
        confidence: Level of the interval [-].

    Raises:
        InvalidParameterError: A number is out of range, or a value of the limit state is NaN.

    References:
        Rubinstein and Kroese (2004), The Cross-Entropy Method, Springer, section 3; Satterthwaite (1946),
        Biometrics Bulletin 2(6), 110-114.
    """
    if variables > _MOST_VARIABLES:
        rule = (
            f"at most {_MOST_VARIABLES}, in whose space the search finds its centre; take subset simulation"
        )
        raise InvalidParameterError("importance_sampling", "variables", rule, variables)
    generator = np.random.default_rng(seed)
    centre, runs, reached = np.zeros(variables), 0, 0
    for _ in range(_ROUNDS):
        points = centre + generator.standard_normal((_SEARCH, variables))
        values = _values(limit, points)
        runs += _SEARCH
        threshold = max(float(np.quantile(values, _ELITE)), 0.0)
        elite = points[values <= threshold]
        logs = 0.5 * centre @ centre - elite @ centre
        weights = np.exp(logs - logs.max())
        centre = weights @ elite / weights.sum()
        reached += threshold <= 0.0
        if reached == _REFINED:
            break
    points = centre + generator.standard_normal((samples, variables))
    failed = _values(limit, points) <= 0.0
    runs += samples
    terms = np.where(failed, np.exp(0.5 * centre @ centre - points @ centre), 0.0)
    probability = float(terms.mean())
    failures = int(failed.sum())
    message = ""
    if failures == 0:
        low, high = clopper_pearson(0, samples, confidence)
        variation, message = math.nan, "no failure among the samples: the interval is that of plain sampling"
    else:
        variation = float(terms.std(ddof=1)) / (probability * math.sqrt(samples))
        low, high = _around(probability, variation, confidence, _freedom(terms))
    return FailureProbability(
        probability, low, high, confidence, runs, failures, "importance sampling", variation, message
    )
