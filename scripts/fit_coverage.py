"""How often are the numbers of a joint within the bands that a fit states? Of records of a known joint.

    python scripts/fit_coverage.py [--count 100] [--seed 0]

A bar hangs from a hinge with play. What its sensors read is made by equations and an integrator that are none
of the package's (tests/reference/planar_joint.py), noise is added, play, stiffness, restitution, friction are
fitted, each time from another noise. Of bands of 95 % some 95 of 100 hold the number that the record was
made with; of so many draws between 90 and 99 are what chance leaves (binomial, 98 %).
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "reference"))

from planar_joint import record  # noqa: E402

from antenna_pin.fit import Fit, load_fit, run_fit  # noqa: E402

TRUTH = {"play": 1.0e-4, "stiffness": 1.0e10, "restitution": 0.8, "friction": 0.1}
TIMES = np.arange(1, 301) * 2e-4  # [s]
PLACE_NOISE, FORCE_NOISE = 0.5e-6, 5.0  # [m], [N]

FIT = """
title = "A hinge with play from two probes and a force cell"
scenario = "pendulum"
case = "planar"
[set]
duration = "0.061 s"
integrator.engine = "compiled"
clearance.hinge.geometry = "closed-form"
initial.joints.hinge.journal_velocity = ["150 mm/s", "0 m/s", "0 m/s"]
clearance.hinge.normal = { replace = true, law = "lankarani-nikravesh", stiffness = 1e10, restitution = 0.7 }
[set.clearance.hinge.friction]
replace = true
law = "tanh"
coefficient_of_friction = 0.1
transition_speed = "10 mm/s"
[parameters.play]
key = "clearance.hinge.radial_clearance"
start = "0.101 mm"
between = ["0.05 mm", "0.2 mm"]
[parameters.stiffness]
key = "clearance.hinge.normal.stiffness"
start = "1.05e10 N/m**1.5"
between = ["1e9 N/m**1.5", "1e11 N/m**1.5"]
scale = "log"
[parameters.restitution]
key = "clearance.hinge.normal.restitution"
start = 0.79
between = [0.3, 1.0]
[parameters.friction]
key = "clearance.hinge.friction.coefficient_of_friction"
start = 0.11
between = [0.0, 0.5]
[records.test]
file = "test.csv"
[records.test.columns.x]
of = "journal_position[hinge].x"
unit = "um"
sd = "0.5 um"
[records.test.columns.y]
of = "journal_position[hinge].y"
unit = "um"
sd = "0.5 um"
[records.test.columns.force]
of = "joint_force[hinge].x"
unit = "N"
sd = "5 N"
"""


def write_record(path: Path, clean: tuple[np.ndarray, np.ndarray, np.ndarray], seed: int) -> None:
    """Write a record with its noise."""
    noise = np.random.default_rng(seed)
    places = clean[0] + PLACE_NOISE * noise.standard_normal(clean[0].shape)
    force = clean[1][:, 0] + FORCE_NOISE * noise.standard_normal(len(TIMES))
    rows = np.column_stack([TIMES, 1e6 * places, force])
    np.savetxt(path, rows, delimiter=",", header="time,x,y,force", comments="", fmt="%.9g")


def fitted(folder: Path, clean: tuple[np.ndarray, np.ndarray, np.ndarray], seed: int) -> Fit:
    """Return the fit to a record with a noise of its own."""
    write_record(folder / "test.csv", clean, seed)
    (folder / "joint.fit.toml").write_text(FIT)
    return run_fit(load_fit(folder / "joint.fit.toml"))


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
    with tempfile.TemporaryDirectory() as name:
        for k in range(asked.count):
            fit = fitted(Path(name), clean, asked.seed + k)
            held += (fit.bands.low <= truth) & (truth <= fit.bands.high)
            ratios.append(fit.bands.chi2 / fit.bands.freedoms)
            print(
                f"{k + 1}: {fit.runs} runs, chi2 / freedoms {ratios[-1]:.3f}, held so far {held.tolist()}",
                flush=True,
            )
    for name, count in zip(TRUTH, held, strict=True):
        print(f"{name}: {count} of {asked.count} bands of 95 % hold the number")
    print(f"chi2 over degrees of freedom: {np.mean(ratios):.4f} on average")


if __name__ == "__main__":
    main()
