"""Tests of residuals: whiteness by their correlation, randomness by runs of sign, normality by moments.

References:
    Wald and Wolfowitz (1940), Ann. Math. Stat. 11, 147-162: runs.
    D'Agostino and Pearson (1973), Biometrika 60, 613-622: normality.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.readable import number
from antenna_pin.fit.sureness import hang_together, persistence

__all__ = ["ResidualTests", "notes_on_residuals", "tests_of"]

Array = NDArray[np.float64]

# Fewest residuals of which tests tell something; chance below which they are said to fail; and the excess
# kurtosis from which on tails matter to a least squares fit.
_FEWEST, _RARE, _TAILS = 20, 1e-4, 1.0


class ResidualTests(NamedTuple):
    """Tests of the residuals of one column, chances being those that noise does as badly.

    Attributes:
        correlation: Of each residual with the next [-].
        runs: Stretches of one sign, about the mean.
        runs_chance: That independent residuals have a number as far from the expected one [-].
        excess_kurtosis: Fourth moment over the squared variance, less 3 [-].
        normal_chance: That normal residuals have skewness and kurtosis as far from theirs [-].
    """

    correlation: float
    runs: int
    runs_chance: float
    excess_kurtosis: float
    normal_chance: float


def tests_of(residuals: Array) -> ResidualTests | None:
    """Return the tests of residuals in the order of time, (n,); None of fewer than 20, or all the same."""
    from scipy import stats

    if len(residuals) < _FEWEST or not np.ptp(residuals) > 0.0:
        return None
    above = residuals > residuals.mean()
    runs, (a, b) = 1 + int(np.count_nonzero(np.diff(above))), (int(above.sum()), int((~above).sum()))
    expected = 1.0 + 2.0 * a * b / (a + b)
    variance = (expected - 1.0) * (expected - 2.0) / (a + b - 1.0)
    apart = abs(runs - expected) / math.sqrt(variance)
    return ResidualTests(
        persistence(residuals),
        runs,
        float(2.0 * stats.norm.sf(apart)),
        float(stats.kurtosis(residuals)),
        float(stats.normaltest(residuals).pvalue),
    )


def notes_on_residuals(curves: Mapping[str, Array]) -> Iterator[str]:
    """Yield a line for each column whose residuals are no noise, though their correlation is that of noise.

    Args:
        curves: Residuals of each column that is compared row by row, in the order of time.
    """
    for name, residuals in curves.items():
        found = None if hang_together(residuals) else tests_of(residuals)
        if found is not None and found.runs_chance < _RARE:
            yield (
                f"note: residuals of {name} have {found.runs} stretches of one sign, as by chance "
                f"{number(found.runs_chance, 1)} of records would: the model lacks something"
            )
        if found is not None and found.normal_chance < _RARE and found.excess_kurtosis > _TAILS:
            yield (
                f"note: residuals of {name} have tails that normal noise has not, an excess kurtosis of "
                f'{number(found.excess_kurtosis, 2)}: outliers count less by loss = "soft_l1"'
            )
