#!/usr/bin/env python3
"""A fit in pieces over one run of its record: play, stiffness, restitution, friction, 54 states of a hinge.

The record is that of fit_coverage.py, 60 ms, made by equations and an integrator that are none of the
package's; 10 pieces of 6 ms. Beside it what one Jacobian takes, by differences; and one evaluation of a
record behind a filter, that of the deployment, over its run.
"""

from __future__ import annotations

import dataclasses
import functools
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from bench_tools import Report
from fit_coverage import FIT, TIMES, TRUTH, record, write_record

from antenna_pin import Scenario, simulate
from antenna_pin.run.simulation.inputs import settings_of
from antenna_pin.studies.fit import Problem, load_fit, run_fit
from antenna_pin.studies.fit.sensors import sample_times

EXAMPLES = Path(__file__).resolve().parent.parent / "examples"


def seconds(make: Callable[[], object]) -> float:
    """Return the time of one call [s]."""
    began = time.perf_counter()
    make()
    return time.perf_counter() - began


def over_its_run(path: Path) -> tuple[float, float]:
    """Return the time of one evaluation of a fit of one record over those of its run.

    Returns:
        Over a run that is sampled at the times that the fit asks for, and over one as the scenario has it.
    """
    problem = Problem(load_fit(path))
    (name, record), rig = next(iter(problem.plan.records.items())), problem._prepared.record_tests[0]
    wanted = [sample_times(column, rig.time + record.clock_shift) for column in rig.columns.values()]
    at = np.unique(np.concatenate(wanted))
    first = problem.scenario(name, problem.start)
    own = settings_of(first)
    sampled = dataclasses.replace(own, output_rate=1.0 / first.duration, output_times=tuple(at[at >= 0.0]))

    def build(k: int) -> Scenario:  # each time of other numbers, as in a search
        return problem.scenario(name, problem.start * (1.0 + 1e-6 * k))

    times = []
    for k in range(1, 6):
        calls = (
            functools.partial(problem.residuals, problem.start * (1.0 + 1e-6 * k)),
            lambda k=k: simulate(build(k), settings=sampled),
            lambda k=k: simulate(build(k), settings=own),
        )
        times.append([seconds(call) for call in calls])
    fit, same, plain = np.min(times, axis=0)
    return float(fit / same), float(fit / plain)


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
        at = problem.unknowns.to_search(np.concatenate([problem.start, problem.states]))
        report.add("one run of the record", once, "s")
        report.add("one Jacobian, over one run", seconds(lambda: problem.slopes(at)) / once)
        report.add(
            f"the fit, {len(problem.states)} states, over one run", seconds(lambda: run_fit(plan)) / once
        )
    same, plain = over_its_run(EXAMPLES / "deployment.fit.toml")
    report.add("a filtered record, over a run with its samples", same, limit=2.0)
    report.add("a filtered record, over a run", plain)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
