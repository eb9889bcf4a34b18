"""How often are the numbers of a joint within the bands that a fit states? Of records of a known joint.

    python scripts/bench/fit_coverage.py [--count 100] [--seed 0]

A bar hangs from a hinge with play. What its sensors read is made by equations and an integrator that are none
of the package's (tests/reference/planar_joint.py), noise is added, play, stiffness, restitution, friction are
fitted, each time from another noise. Of bands of 95 % some 95 of 100 hold the number that the record was
made with; of so many draws between 90 and 99 are what chance leaves (binomial, 98 %).

Whether a count that is off is chance or a wrong band is told by a second answer to the same noise, that of
the model's tangent at the true numbers, for which the bands are right by construction: it is held by as many
bands, if the fit's are right and it is at its least. The mean square of the errors over the
stated standard errors is 1, give or take the root of 2 over the number of records.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "reference"))

from hinge_record import FIT, TIMES, TRUTH, noise_of, write_record  # noqa: E402
from planar_joint import record  # noqa: E402

from antenna_pin.studies.fit import Fit, Problem, load_fit, run_fit  # noqa: E402

QUANTILE = 1.959964  # of the normal distribution, 95 % [-]


def fitted(folder: Path, clean: tuple[np.ndarray, np.ndarray, np.ndarray], seed: int) -> Fit:
    """Return the fit to a record with a noise of its own."""
    write_record(folder / "test.csv", clean, seed)
    (folder / "joint.fit.toml").write_text(FIT)
    return run_fit(load_fit(folder / "joint.fit.toml"))


def tangent(folder: Path, clean: tuple[np.ndarray, np.ndarray, np.ndarray]) -> np.ndarray:
    """Return what takes noise, (m,), to the error of the tangent's answer in standard errors, (p, m)."""
    write_record(folder / "test.csv", clean, 0)
    (folder / "joint.fit.toml").write_text(FIT)
    slopes = Problem(load_fit(folder / "joint.fit.toml")).jacobian(np.array([*TRUTH.values()]))
    covariance = np.linalg.inv(slopes.T @ slopes)
    return covariance @ slopes.T / np.sqrt(np.diag(covariance))[:, None]


def main() -> None:
    """Print how many bands hold."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    clean = record(*TRUTH.values(), TIMES)
    truth, held, ratios = np.array([*TRUTH.values()]), np.zeros(len(TRUTH), int), []
    errors, of_tangent = [], []
    with tempfile.TemporaryDirectory() as name:
        along = tangent(Path(name), clean)
        for k in range(asked.count):
            fit = fitted(Path(name), clean, asked.seed + k)
            held += (fit.bands.low <= truth) & (truth <= fit.bands.high)
            ratios.append(fit.bands.chi2 / fit.bands.freedoms)
            errors.append((fit.values - truth) / fit.bands.sd)
            places, force = noise_of(asked.seed + k)
            of_tangent.append(along @ np.concatenate([places[:, 0], places[:, 1], force]))
            print(
                f"{k + 1}: {fit.runs} runs, chi2 / freedoms {ratios[-1]:.3f}, held so far {held.tolist()}",
                flush=True,
            )
    straight = np.count_nonzero(np.abs(of_tangent) <= QUANTILE, axis=0)
    squares = np.mean(np.square(errors), axis=0)
    apart = np.max(np.abs(np.subtract(errors, of_tangent)), axis=0)
    for k, name in enumerate(TRUTH):
        print(
            f"{name}: {held[k]} of {asked.count} bands of 95 % hold the number, {straight[k]} of the "
            f"tangent's; mean square error {squares[k]:.3f} of what is stated; from the tangent's answer by "
            f"at most {apart[k]:.3f} standard errors"
        )
    print(f"chi2 over degrees of freedom: {np.mean(ratios):.4f} on average")


if __name__ == "__main__":
    main()
