#!/usr/bin/env python3
"""Many runs at once in one process: 1 s of case 3 with random parameters, on one thread and on two.

The compiled loop runs without the interpreter's lock. Clearance, friction and restitution of each run are
drawn at random (a fixed seed); results are lean. What a run takes besides the loop (its scenario, its system,
its record) holds the lock, so that the gain of the second thread is less than two. The same runs on both must
agree to the last bit.
"""

from __future__ import annotations

import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from bench_tools import CLOSED_FORM, Report, scenario
from run import bare_aba

from antenna_pin import Scenario, Trajectory, build_system, simulate

RUNS = 1000
SPAN = 1.0  # [s]
CHANGES = (CLOSED_FORM, "integrator.engine=compiled", "integrator.accuracy=1e-3", "output.form=lean")


def drawn(count: int) -> list[Scenario]:
    """Return the scenarios of the runs."""
    rng = np.random.default_rng(7)
    case = scenario("case3", *CHANGES)
    joint = "clearance.elevation"
    changed = []
    for _ in range(count):
        play, restitution, friction = rng.uniform((5e-5, 0.6, 0.01), (2e-4, 0.95, 0.15))
        changes = {f"{joint}.radial_clearance": play, f"{joint}.normal.restitution": restitution}
        changes |= {f"{joint}.friction.dynamic": friction, f"{joint}.friction.static": 1.5 * friction}
        changed.append(case.with_overrides(changes))
    return changed


def one(case: Scenario) -> Trajectory:
    """Make a run."""
    return simulate(case, duration=SPAN)


def main() -> int:
    """Make the runs."""
    report = Report("threads", __doc__ or "")
    quick = report.parse().quick
    count = 4 if quick else RUNS
    began = time.perf_counter()
    jobs = drawn(count)
    reading = time.perf_counter() - began
    one(jobs[0])  # loads what is compiled
    aba = bare_aba(build_system(jobs[0]).model)()
    some = jobs[: max(4, count // 10)]
    began = time.perf_counter()
    serial = [one(job) for job in some]
    alone = (time.perf_counter() - began) / len(some)
    began = time.perf_counter()
    with ThreadPoolExecutor(2) as pool:
        both = list(pool.map(one, jobs))
    taken = time.perf_counter() - began
    assert all(same(*pair) for pair in zip(serial, both, strict=False)), "threads change results"
    evaluations = sum(run.counts.evaluations for run in both)
    limit = None if quick else 30.0
    report.add(f"{count} runs of {SPAN:g} s on 2 threads", taken, "s", limit)
    report.add("making their scenarios, before that", reading, "s")
    report.add("a run on 1 thread", 1e3 * alone, "ms")
    report.add("gain of the second thread", alone * count / taken)
    report.add("evaluations of a run", evaluations / count)
    report.add("all, per evaluation, over pin.aba", taken / evaluations / aba)
    report.add("pin.aba", 1e6 * aba, "us")
    return report.finish()


def same(a: Trajectory, b: Trajectory) -> bool:
    """Whether two runs agree to the last bit."""
    data: Any = a.data
    numbers = [name for name in data if data[name].dtype.kind != "U"]
    return all(np.array_equal(data[name], b.data[name], equal_nan=True) for name in numbers)


if __name__ == "__main__":
    sys.exit(main())
