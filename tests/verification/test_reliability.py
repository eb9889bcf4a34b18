"""Probabilities of failure against closed forms: linear limit states, parabolas, exact binomial intervals."""

import math

import numpy as np
import pytest
from scipy import integrate, stats

from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.verification import (
    clopper_pearson,
    importance_sampling,
    plain_sampling,
    subset_simulation,
)

REPEATS = 20


def linear(variables, probability):
    """Return a plane at the distance that gives a probability, P = Phi(-beta)."""
    beta = stats.norm.isf(probability)
    normal = np.linspace(1.0, 2.0, variables)
    normal /= np.linalg.norm(normal)
    return lambda u: beta - u @ normal


def parabola(variables, beta, bend):
    """Return beta - u_n + bend |u_others|^2, and its probability by one integral."""

    def limit(u):
        return beta - u[:, -1] + bend * (u[:, :-1] ** 2).sum(axis=1)

    def density(c):
        return stats.chi2.pdf(c, variables - 1) * stats.norm.sf(beta + bend * c)

    return limit, integrate.quad(density, 0.0, np.inf, epsabs=0.0, epsrel=1e-9, limit=400)[0]


CASES = {f"linear in {n}": (n, linear(n, 1e-5), 1e-5) for n in (1, 2, 10)}
CASES |= {"parabola in 5": (5, *parabola(5, 3.94, 0.1))}


@pytest.mark.parametrize("case", CASES)
def test_rare_failures_lie_within_the_stated_interval(case):
    """Of 20 repeats at 95 % confidence 19 hold the probability, each with fewer than 3,000 runs."""
    variables, limit, exact = CASES[case]
    assert 3e-6 < exact < 3e-5
    found = [subset_simulation(limit, variables, samples=500, seed=k) for k in range(REPEATS)]
    assert max(one.runs for one in found) < 3000
    assert sum(one.low <= exact <= one.high for one in found) >= 19
    # A stated interval that held everything would say nothing: it is one of a factor 5 either way.
    assert np.median([one.high / one.low for one in found]) < 30.0
    mean = np.mean([one.probability for one in found])
    # Twenty estimates of a coefficient of variation of 0.6 average to within 3 * 0.6 / sqrt(20).
    assert mean == pytest.approx(exact, rel=0.4)


@pytest.mark.parametrize("case", CASES)
def test_importance_sampling_is_sharp_about_one_failure(case):
    """It is within a factor of two; an exact 95 % one holds in 17 or more of 20 with a chance of 98 %."""
    variables, limit, exact = CASES[case]
    found = [importance_sampling(limit, variables, samples=1000, seed=k) for k in range(REPEATS)]
    assert max(one.runs for one in found) < 3000
    assert sum(one.low <= exact <= one.high for one in found) >= 17
    assert np.median([one.high / one.low for one in found]) < 2.0
    assert np.mean([one.probability for one in found]) == pytest.approx(exact, rel=0.1)


def test_interval_of_importance_sampling_holds_as_often_as_it_says():
    """Few samples in ten variables, whose weights have long tails: 95 % of 2,000 repeats, within 0.5 %."""
    limit = linear(10, 1e-5)
    found = [importance_sampling(limit, 10, samples=200, seed=k) for k in range(2000)]
    held = np.mean([one.low <= 1e-5 <= one.high for one in found])
    # Its standard error is 0.0049. With n - 1 degrees of freedom, whatever the tails, 0.93 of them hold.
    assert held == pytest.approx(0.95, abs=0.01)


def test_two_failures_far_apart_are_both_counted_by_subsets():
    """Of |u| beyond 4.2645 subset simulation finds both sides; importance sampling takes one."""
    exact = 2.0 * stats.norm.sf(4.2645)

    def limit(u):
        return 4.2645 - np.abs(u[:, 0])

    found = [subset_simulation(limit, 1, seed=k) for k in range(REPEATS)]
    assert sum(one.low <= exact <= one.high for one in found) >= 19


@pytest.mark.parametrize("failures, runs, confidence", [(0, 60, 0.95), (3, 100, 0.9), (100, 100, 0.95)])
def test_interval_of_a_binomial_probability_is_exact(failures, runs, confidence):
    """At each end the tail of the binomial distribution is half of what confidence leaves."""
    low, high = clopper_pearson(failures, runs, confidence)
    tail = 0.5 * (1.0 - confidence)
    if failures:
        assert stats.binom.sf(failures - 1, runs, low) == pytest.approx(tail, rel=1e-9)
    else:
        assert low == 0.0
    if failures < runs:
        assert stats.binom.cdf(failures, runs, high) == pytest.approx(tail, rel=1e-9)
    else:
        assert high == 1.0


def test_plain_sampling_counts_and_covers():
    """A probability of 0.1 lies within the interval of 500 runs in 19 of 20 repeats."""
    found = [plain_sampling(linear(3, 0.1), 3, runs=500, seed=k) for k in range(REPEATS)]
    assert all(one.failures == round(one.probability * 500) for one in found)
    assert sum(one.low <= 0.1 <= one.high for one in found) >= 18


@pytest.mark.parametrize(
    "call, said",
    [
        (lambda: clopper_pearson(3, 2), "failures must be from 0 to runs, 2, got 3"),
        (lambda: clopper_pearson(1, 2, 1.0), "confidence must be between 0 and 1, got 1.0"),
        (lambda: subset_simulation(linear(1, 0.1), 1, samples=5), "samples must be 20 or more, got 5"),
        (lambda: importance_sampling(linear(11, 0.1), 11), "variables must be at most 10"),
        (lambda: plain_sampling(lambda u: u, 2, runs=3), "limit must be 3 numbers, one for each point"),
        (lambda: plain_sampling(lambda u: math.nan * u[:, 0], 2, runs=3), "limit must be 3 numbers"),
    ],
)
def test_wrong_numbers_are_refused(call, said):
    """One line with rule and value."""
    with pytest.raises(InvalidParameterError, match=said):
        call()
