"""How often do bands hold that are of the statistics of a chaotic record? Of records of a known joint.

    python scripts/bench/fit_statistics.py [--count 20] [--seed 1]

A bar on a hinge with play is shaken until neighbours have nothing in common after a tenth of a second. Each
record, of 1.2 s and 200 blows, is a run from another angle and speed, with noise; a fit that has nothing
of the start finds play and restitution from the rms of the journal's ways, a histogram of blows and two bands
of the force's spectrum, by surfaces (``docs/fit.md``). A record whose start presses the journal too deep, so
that it is none, is left out.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from antenna_pin import Scenario, simulate
from antenna_pin.studies.fit import load_fit, run_fit
from antenna_pin.studies.sweep import Here

TRUTH = np.array([1e-4, 0.7])  # play [m], restitution [-]
PLACE_NOISE, FORCE_NOISE = 0.1e-6, 1.0  # [m], [N]
RATE, LENGTH = 2000.0, 1.4  # of the rows [1/s], of the run [s]

FIT = """
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


def write_record(path: Path, scenario: Scenario, seed: int) -> bool:
    """Write the record of a run from another start, with noise; return whether it came to its end."""
    random, noise = (np.random.default_rng(one) for one in (seed, 1000 + seed))
    angle, velocity = 8.0 + 4.0 * random.random(), 0.1 * random.standard_normal(2)
    started = scenario.with_overrides(
        {
            "initial.joints.hinge.angle": f"{angle} deg",
            "initial.joints.hinge.journal_velocity": [*velocity.tolist(), 0.0],
            "clearance.hinge.radial_clearance": f"{TRUTH[0]} m",
            "clearance.hinge.normal.restitution": TRUTH[1],
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


def main() -> None:
    """Print how many bands hold."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    hands, held, errors = Remembering(), np.zeros(2, int), []
    with tempfile.TemporaryDirectory() as name:
        file, record = Path(name) / "shaken.fit.toml", Path(name) / "test.csv"
        file.write_text(FIT)
        for seed in range(asked.seed, asked.seed + asked.count):
            if not write_record(record, load_fit(file).scenario_of("test"), seed):
                continue
            fit = run_fit(load_fit(file), executor=hands)
            held += (fit.bands.low <= TRUTH) & (TRUTH <= fit.bands.high)
            errors.append((fit.values - TRUTH) / fit.bands.sd)
            print(
                f"{seed}: play {1e3 * fit.values[0]:.5f} mm, restitution {fit.values[1]:.4f}, off by "
                f"{errors[-1].round(2).tolist()} standard errors; chi2 {fit.bands.chi2:.1f} for "
                f"{fit.bands.freedoms}; held {held.tolist()} of {len(errors)}",
                flush=True,
            )
    print(
        f"mean squares of errors over stated errors: {np.mean(np.square(errors), axis=0).round(3).tolist()}"
    )


if __name__ == "__main__":
    main()
