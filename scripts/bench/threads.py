#!/usr/bin/env python3
"""Many runs at once in one process: 1 s of case 3 with random parameters, on one thread and on two.

The compiled loop runs without the interpreter's lock, and so does the default engine where the shim to
Pinocchio's and coal's machine code is used (``antenna-pin info --versions``), of which a tenth as many runs
are made. Clearance, friction and restitution of each run are
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
COMMON = ("integrator.accuracy=1e-3", "output.form=lean")
#: Engines: changes, share of the runs, and limit of all [s].
ENGINES: dict[str, tuple[tuple[str, ...], float, float | None]] = {
    "compiled": ((CLOSED_FORM, "integrator.engine=compiled"), 1.0, 30.0),
    "Pinocchio and coal": ((), 0.1, None),
}


def drawn(count: int, changes: tuple[str, ...]) -> list[Scenario]:
    """Return the scenarios of the runs."""
    rng = np.random.default_rng(7)
    case = scenario("case3", *COMMON, *changes)
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
    for engine, (changes, share, limit) in ENGINES.items():
        count = 4 if quick else round(share * RUNS)
        measure(report, engine, drawn(count, changes), None if quick else limit)
    return report.finish()


def measure(report: Report, engine: str, jobs: list[Scenario], limit: float | None) -> None:
    """Make the runs of an engine on one thread and on two, and add what they take."""
    count = len(jobs)
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
    report.add(f"{engine}: {count} runs of {SPAN:g} s on 2 threads", taken, "s", limit)
    report.add(f"{engine}: a run on 1 thread", 1e3 * alone, "ms")
    report.add(f"{engine}: gain of the second thread", alone * count / taken)
    report.add(f"{engine}: evaluations of a run", evaluations / count)
    report.add(f"{engine}: all, per evaluation, over pin.aba", taken / evaluations / aba)
    report.add(f"{engine}: pin.aba", 1e6 * aba, "us")


def same(a: Trajectory, b: Trajectory) -> bool:
    """Whether two runs agree to the last bit."""
    data: Any = a.data
    numbers = [name for name in data if data[name].dtype.kind != "U"]
    return all(np.array_equal(data[name], b.data[name], equal_nan=True) for name in numbers)


if __name__ == "__main__":
    sys.exit(main())
