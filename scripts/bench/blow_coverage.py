"""How often do bands of a fit hold the true numbers, where a filter smears blows shorter than its samples?

    python scripts/bench/blow_coverage.py [--count 40] [--seed 0]

A mass falls onto a rigid floor; a filtered accelerometer reads a blow without duration. The record is the
closed form (tests/reference/falling_ball.py) with noise; height and restitution are fitted from a start that
is 0.3 % and 4 % off. Of bands of 95 % so many hold the number that the record was made with; the count is
binomial, and its bounds of 98 % are printed beside. The mean square of errors over stated standard errors is
1, give or take the root of 2 over the number of records.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.stats import binom

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "reference"))

from falling_ball import HEIGHT, NOISE, RESTITUTION, TIME, reading, write  # noqa: E402

from antenna_pin.studies.fit import Fit, load_fit, run_fit  # noqa: E402

TRUTH = np.array([HEIGHT, RESTITUTION])
NAMES, SHARE = ("height", "restitution"), 0.98


def fitted(folder: Path, seed: int) -> Fit:
    """Return the fit to a record with a noise of its own."""
    noise = NOISE * np.random.default_rng(seed).standard_normal(len(TIME))
    return run_fit(load_fit(write(folder, reading(HEIGHT, RESTITUTION, 4)[0] + noise, start=1.003)))


def bounds(count: int) -> tuple[int, int]:
    """Return between which counts of bands of 95 % chance leaves 98 % of samples of so many."""
    low, high = binom.interval(SHARE, count, 0.95)
    return int(low), int(high)


def coverage(count: int, seed: int = 0, *, tell: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Return how many bands hold each number, (2,), and errors over standard errors, (count, 2)."""
    held, errors = np.zeros(2, int), []
    with tempfile.TemporaryDirectory() as name:
        for k in range(count):
            fit = fitted(Path(name), seed + k)
            held += (fit.bands.low <= TRUTH) & (TRUTH <= fit.bands.high)
            errors.append((fit.values - TRUTH) / fit.bands.sd)
            if tell:
                ratio = fit.bands.chi2 / fit.bands.freedoms
                print(f"{k + 1}: {fit.runs} runs, chi2 / freedoms {ratio:.3f}, held so far {held.tolist()}")
    return held, np.array(errors)


def main() -> None:
    """Print how many bands hold."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    held, errors = coverage(asked.count, asked.seed, tell=True)
    low, high = bounds(asked.count)
    for k, name in enumerate(NAMES):
        print(
            f"{name}: {held[k]} of {asked.count} bands of 95 % hold the number, where chance leaves {low} to "
            f"{high}; mean square error {np.mean(errors[:, k] ** 2):.3f} of what is stated"
        )


if __name__ == "__main__":
    main()
