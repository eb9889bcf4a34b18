#!/usr/bin/env python3
"""A fit in pieces over one run of its record: play, stiffness, restitution, friction, 54 states of a hinge.

The record is that of scripts/fit_coverage.py, 60 ms, made by equations and an integrator that are none of the
package's; 10 pieces of 6 ms. Beside it what one Jacobian takes, by differences.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_tools import Report

sys.path.insert(0, str(Path(__file__).resolve().parent.parent))
from fit_coverage import FIT, TIMES, TRUTH, record, write_record  # noqa: E402

from antenna_pin import simulate  # noqa: E402
from antenna_pin.fit import Problem, load_fit, run_fit  # noqa: E402


def seconds(make: Callable[[], object]) -> float:
    """Return the time of one call [s]."""
    began = time.perf_counter()
    make()
    return time.perf_counter() - began


def main() -> int:
    """Measure."""
    report = Report("fit", __doc__ or "")
    quick = report.parse().quick
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_record(folder / "test.csv", record(*TRUTH.values(), TIMES), 0)
        (folder / "joint.fit.toml").write_text(FIT)
        plan = load_fit(folder / "joint.fit.toml", [f"records.test.pieces.length={20 if quick else 6} ms"])
        problem = Problem(plan)
        scenario = problem.scenario("test", problem.start)
        simulate(scenario)
        once = min(seconds(lambda: simulate(scenario)) for _ in range(3))
        at = problem.unknowns.searched(np.concatenate([problem.start, problem.states]))
        report.add("one run of the record", once, "s")
        report.add("one Jacobian, over one run", seconds(lambda: problem.slopes(at)) / once)
        report.add(
            f"the fit, {len(problem.states)} states, over one run", seconds(lambda: run_fit(plan)) / once
        )
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
