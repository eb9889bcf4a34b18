"""The kernels are plain Python too: the same numbers without the compiler."""

import json
import os
import subprocess
import sys

import pytest

from antenna_pin import load_scenario, simulate

SCRIPT = """
import json
from antenna_pin import load_scenario, simulate
run = simulate(load_scenario("bai2020", case="case3"), duration=0.017)
last = [run.data[name].values[-1].tolist() for name in ("q", "v")]
print(json.dumps([run.counts.evaluations, *last]))
"""


def test_a_run_without_the_compiler_gives_the_same_numbers():
    """No fastmath: what differs is the round-off of a few thousand evaluations."""
    environment = {**os.environ, "NUMBA_DISABLE_JIT": "1"}
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], env=environment, capture_output=True, text=True, check=True
    )
    evaluations, q, v = json.loads(done.stdout)
    run = simulate(load_scenario("bai2020", case="case3"), duration=0.017)
    assert evaluations == run.counts.evaluations
    assert q == pytest.approx(run.data["q"].values[-1], rel=1e-9, abs=1e-13)
    assert v == pytest.approx(run.data["v"].values[-1], rel=1e-9, abs=1e-11)
