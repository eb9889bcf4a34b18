"""Runs in threads of one process do not see each other."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate


@pytest.mark.parametrize(
    ("model", "case", "joint"), [("bai2020", "case3", "elevation"), ("slider_crank", "planar", "pin")]
)
def test_runs_in_threads_are_those_on_their_own_bit_for_bit(model, case, joint):
    """The compiled loop holds no lock, so that these really run at once; trees and loops."""
    changes = [f"clearance.{joint}.geometry=closed-form", "integrator.engine=compiled"]
    known = load_scenario(model, case=case, overrides=changes)
    some = [known.with_overrides({f"clearance.{joint}.normal.restitution": e}) for e in (0.6, 0.7, 0.8, 0.9)]

    def run(scenario):
        return simulate(scenario, duration=0.02).data

    alone = [run(scenario) for scenario in some]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(run, some))
    for one, other in zip(alone, together, strict=True):
        for name in ("q", "v", "impulse", "peak_force", "energy_error"):
            assert np.array_equal(one[name], other[name], equal_nan=True), name
    # They are different runs: a mixture would be seen.
    assert len({data["v"].values.tobytes() for data in alone}) == len(alone)
