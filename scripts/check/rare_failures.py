"""How often intervals of rare failures hold: subset simulation and importance sampling on closed forms.

    python scripts/check/rare_failures.py [REPEATS]

Limit states in standard normal space with a probability near 1e-5: planes in 1 to 50 variables, parabolas. Of
each method: share of the repeats whose 95 % interval holds the probability, share of blocks of twenty with 19
or more that hold, mean of the estimates over it, their coefficient of variation, and the evaluations at most.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np
from scipy import integrate, optimize, stats

from antenna_pin.studies.verification import importance_sampling, subset_simulation

PROBABILITY, SAMPLES, IMPORTANCE = 1e-5, 500, 1000


def plane(variables: int) -> Callable[[np.ndarray], np.ndarray]:
    """Return beta - u.n, whose probability is Phi(-beta)."""
    normal = np.ones(variables) / np.sqrt(variables)
    return lambda u: stats.norm.isf(PROBABILITY) - u @ normal


def probability_of(variables: int, beta: float, bend: float) -> float:
    """Return the probability of beta - u_n + bend |u_others|^2 <= 0 by one integral."""

    def density(c: float) -> float:
        return float(stats.chi2.pdf(c, variables - 1) * stats.norm.sf(beta + bend * c))

    return float(integrate.quad(density, 0.0, np.inf, epsabs=0.0, epsrel=1e-9, limit=400)[0])


def parabola(variables: int, bend: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return a parabola with the wanted probability."""
    beta = optimize.brentq(lambda b: np.log(probability_of(variables, b, bend) / PROBABILITY), 1.0, 6.0)
    return lambda u: beta - u[:, -1] + bend * (u[:, :-1] ** 2).sum(axis=1)


def main() -> None:
    """Print a line for each case and method."""
    repeats = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    cases = {f"plane, {n}": (n, plane(n)) for n in (1, 2, 10, 50)}
    cases |= {f"parabola, {n}": (n, parabola(n, bend)) for n, bend in ((2, 0.3), (5, 0.1), (10, 0.05))}
    print("case, variables   method       within  19 of 20  mean/P  variation  runs")
    for name, (variables, limit) in cases.items():
        for method in ("subset", "importance"):
            if method == "importance" and variables > 10:
                continue
            take = subset_simulation if method == "subset" else importance_sampling
            count = SAMPLES if method == "subset" else IMPORTANCE
            found = [take(limit, variables, samples=count, seed=seed) for seed in range(repeats)]
            holds = np.array([one.low <= PROBABILITY <= one.high for one in found])
            blocks = holds[: repeats // 20 * 20].reshape(-1, 20).sum(axis=1)
            estimates = np.array([one.probability for one in found])
            print(
                f"{name:<17} {method:<12} {holds.mean():6.1%} {(blocks >= 19).mean():9.1%} "
                f"{estimates.mean() / PROBABILITY:7.3f} {estimates.std() / PROBABILITY:10.3f} "
                f"{max(one.runs for one in found):5d}"
            )
    law = stats.binom.sf(18, 20, 0.95)
    print(f"an exact 95 % interval holds in 19 or more of 20 in {law:.1%} of all blocks, by the binomial law")


if __name__ == "__main__":
    main()
