"""How often do the bands of a fit hold the numbers that a record was made with?

    python scripts/bench/fit_coverage.py hinge --count 100
    python scripts/bench/fit_coverage.py filtered --count 40
    python scripts/bench/fit_coverage.py shaken --count 20

``hinge``: a bar on a hinge with play, made by equations and an integrator that are none of the package's
(tests/reference/planar_joint.py), with noise; play, stiffness, restitution, friction. ``filtered``: a mass
falls onto a rigid floor, in closed form (tests/reference/falling_ball.py), and a filtered accelerometer reads
a blow shorter than its samples; height, restitution. ``shaken``: a bar on a hinge with play is shaken until
neighbours have nothing in common after a tenth of a second; each record, of 1.2 s and 200 blows, is a run
from another angle and speed, and play and restitution are found from its statistics, by surfaces
(``docs/fit.md``). A record whose start presses the journal too deep, so that it is none, is left out.

Of bands of 95 % so many hold the number; chance leaves what is printed beside (binomial, 98 %). The mean
square of errors over stated standard errors is 1, give or take the root of 2 over the number of records.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import binom

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tests" / "reference"))

import falling_ball as ball  # noqa: E402
import hinge_record as hinge  # noqa: E402
from planar_joint import record  # noqa: E402

from antenna_pin import Scenario, simulate  # noqa: E402
from antenna_pin.studies.fit import Fit, load_fit, run_fit  # noqa: E402
from antenna_pin.studies.sweep import Here  # noqa: E402

#: Returns the fit to the record of a seed, made in a folder; None if there is no record.
Fitted = Callable[[Path, int], Fit | None]


def of_hinge() -> Fitted:
    """Return what fits a hinge with a noise of its own."""
    clean = record(*hinge.TRUTH.values(), hinge.TIMES)

    def fitted(folder: Path, seed: int) -> Fit:
        hinge.write_record(folder / "test.csv", clean, seed)
        (folder / "joint.fit.toml").write_text(hinge.FIT)
        return run_fit(load_fit(folder / "joint.fit.toml"))

    return fitted


def of_filtered() -> Fitted:
    """Return what fits a filtered fall, from a start that is 0.3 % and 4 % off."""
    clean = ball.reading(ball.HEIGHT, ball.RESTITUTION, 4)[0]

    def fitted(folder: Path, seed: int) -> Fit:
        noise = ball.NOISE * np.random.default_rng(seed).standard_normal(len(ball.TIME))
        return run_fit(load_fit(ball.write(folder, clean + noise, start=1.003)))

    return fitted


# --- the shaken hinge ---

PLAY, RESTITUTION = 1e-4, 0.7  # [m], [-]
PLACE_NOISE, FORCE_NOISE = 0.1e-6, 1.0  # [m], [N]
RATE, LENGTH = 2000.0, 1.4  # of the rows [1/s], of the run [s]

_SHAKEN = """
title = "A shaken hinge with play"
scenario = "pendulum"
case = "planar"
[set]
duration = "1.4 s"
integrator.engine = "compiled"
integrator.rtol = 1e-7
clearance.hinge.geometry = "closed-form"
clearance.hinge.normal = { replace = true, law = "lankarani-nikravesh", stiffness = 1e9, restitution = 0.7 }
mechanism.links.stand = { mass = "1 kg", inertia = [1.0, 1.0, 1.0] }
springs.hinge = { replace = true, damping = 0.1 }
[set.clearance.hinge.friction]
replace = true
law = "tanh"
coefficient_of_friction = 0.1
transition_speed = "10 mm/s"
[set.shake.x]
kind = "sine"
direction = [1, 0, 1]
frequency = "40 Hz"
acceleration = "30 m/s^2"
[surface]
runs = 32
rounds = 3
[parameters.play]
key = "clearance.hinge.radial_clearance"
start = "0.12 mm"
between = ["0.03 mm", "0.3 mm"]
[parameters.restitution]
key = "clearance.hinge.normal.restitution"
start = 0.6
between = [0.2, 1]
[records.test]
file = "test.csv"
window = ["0.2 s", "1.4 s"]
[records.test.columns.x]
of = "journal_position[hinge].x"
compare = "rms"
sd = "0.1 um"
[records.test.columns.y]
of = "journal_position[hinge].y"
compare = "rms"
sd = "0.1 um"
[records.test.columns.blows]
column = "force"
of = "joint_force[hinge].y"
compare = "blows"
blows = { level = "40 N", edges = ["40 N", "110 N", "200 N", "450 N"] }
[records.test.columns.spectrum]
column = "force"
of = "joint_force[hinge].y"
compare = "spectrum"
spectrum = { segment = "0.1 s", edges = ["20 Hz", "100 Hz", "400 Hz"] }
"""


class Remembering(Here):
    """This process, which makes a run of one fit not again for another: first boxes are all the same."""

    def __init__(self) -> None:
        """Begin with nothing."""
        self._known: dict[Any, Any] = {}

    def each(self, call: Any, shared: Any, batches: Iterator[list[Any]]) -> Iterator[tuple[list[Any], Any]]:
        """Yield each batch with its answer."""
        for batch in batches:
            if batch[0] not in self._known:
                self._known[batch[0]] = call(shared, batch)
            yield batch, self._known[batch[0]]


def write_shaken(path: Path, scenario: Scenario, seed: int) -> bool:
    """Write the record of a run from another start, with noise; return whether it came to its end."""
    random, noise = (np.random.default_rng(one) for one in (seed, 1000 + seed))
    angle, velocity = 8.0 + 4.0 * random.random(), 0.1 * random.standard_normal(2)
    started = scenario.with_overrides(
        {
            "initial.joints.hinge.angle": f"{angle} deg",
            "initial.joints.hinge.journal_velocity": [*velocity.tolist(), 0.0],
            "clearance.hinge.radial_clearance": f"{PLAY} m",
            "clearance.hinge.normal.restitution": RESTITUTION,
            "output.rate": f"{RATE} Hz",
        }
    )
    data = simulate(started).data
    rows = np.unique(np.searchsorted(data["time"].values, np.arange(int(LENGTH * RATE) + 1) / RATE - 1e-9))
    rows = rows[rows < data.sizes["time"]]
    places = data["journal_position"].values[rows, 0, :2]
    force = data["joint_force"].values[rows, 0, 1]
    columns = [
        data["time"].values[rows],
        *(one + PLACE_NOISE * noise.standard_normal(len(rows)) for one in places.T),
        force + FORCE_NOISE * noise.standard_normal(len(rows)),
    ]
    header = "time,x,y,force"
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=header, comments="", fmt="%.9g")
    return bool(columns[0][-1] > LENGTH - 1.0 / RATE)


def of_shaken() -> Fitted:
    """Return what fits the statistics of a shaken hinge."""
    executor = Remembering()

    def fitted(folder: Path, seed: int) -> Fit | None:
        file = folder / "shaken.fit.toml"
        file.write_text(_SHAKEN)
        if not write_shaken(folder / "test.csv", load_fit(file).scenario_of("test"), seed):
            return None
        return run_fit(load_fit(file), executor=executor)

    return fitted


#: What makes and fits the records of each kind, and the numbers that they are made with.
KINDS: dict[str, tuple[Callable[[], Fitted], dict[str, float]]] = {
    "hinge": (of_hinge, hinge.TRUTH),
    "filtered": (of_filtered, {"height": ball.HEIGHT, "restitution": ball.RESTITUTION}),
    "shaken": (of_shaken, {"play": PLAY, "restitution": RESTITUTION}),
}


def main() -> None:
    """Print how many bands hold."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("kind", choices=KINDS, help="of records")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    make, numbers = KINDS[asked.kind]
    fitted, truth = make(), np.array([*numbers.values()])
    held, errors = np.zeros(len(truth), int), []
    with tempfile.TemporaryDirectory() as name:
        for seed in range(asked.seed, asked.seed + asked.count):
            fit = fitted(Path(name), seed)
            if fit is None:
                continue
            held += (fit.bands.low <= truth) & (truth <= fit.bands.high)
            errors.append((fit.values - truth) / fit.bands.sd)
            print(
                f"{seed}: {fit.runs} runs, off by {errors[-1].round(2).tolist()} standard errors; chi2 "
                f"{fit.bands.chi2:.1f} for {fit.bands.freedoms}; held {held.tolist()} of {len(errors)}",
                flush=True,
            )
    low, high = map(int, binom.interval(0.98, len(errors), 0.95))
    for k, square in enumerate(np.mean(np.square(errors), axis=0)):
        print(
            f"{[*numbers][k]}: {held[k]} of {len(errors)} bands of 95 % hold the number, where chance leaves "
            f"{low} to {high}; mean square error {square:.3f} of what is stated"
        )


if __name__ == "__main__":
    main()
