#!/usr/bin/env python3
"""Many runs at once in one process: 1 s of case 3 with random parameters, on one thread and on two.

The compiled loop runs without the interpreter's lock, and so does the default engine where the shim to
Pinocchio's and coal's machine code is used (``antenna-pin info --versions``), of which a tenth as many runs
are made. Clearance, friction and restitution of each run are drawn at random (a fixed seed); results are
lean. What a run takes besides the loop (its scenario, its system, its record) holds the lock, which is passed
on as in studies, so that the gain of the second thread is less than two; beside it stands that of bare
compiled steps, which hold none, in the same rounds: the machine's own. Runs on both must agree to the last
bit.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from bench_tools import CLOSED_FORM, Report, scenario
from loop import near_limit_of
from run import bare_aba

from antenna_pin import Scenario, Trajectory, build_system, simulate
from antenna_pin.errors import StiffRunWarning
from antenna_pin.studies.sweep.executor import SWITCH_INTERVAL

RUNS = 1000
ROUNDS = 5
STEPS = 20_000  # bare ones
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


def timed(case: Scenario) -> tuple[float, Scenario, Trajectory]:
    """Make a run; return what it took [s], with it."""
    began = time.perf_counter()
    run = one(case)
    return time.perf_counter() - began, case, run


def main() -> int:
    """Make the runs."""
    report = Report("threads", __doc__ or "")
    report.parser.add_argument("--runs", type=int, default=RUNS, help="runs of the first engine")
    arguments = report.parse()
    sys.setswitchinterval(SWITCH_INTERVAL)
    warnings.simplefilter("ignore", StiffRunWarning)  # of the random parameters some are
    for engine, (changes, share, limit) in ENGINES.items():
        count = 4 if arguments.quick else round(share * arguments.runs)
        measure(report, engine, drawn(count, changes), limit if arguments.runs == RUNS else None)
    return report.finish()


def pure_loops() -> Callable[[int], float]:
    """Return what makes bare steps on so many threads, and gives the steps in a second of all."""
    loops = [near_limit_of(scenario("case3", CLOSED_FORM, "integrator.engine=compiled")) for _ in range(2)]

    def run(threads: int) -> float:
        began = time.perf_counter()
        with ThreadPoolExecutor(threads) as pool:
            list(pool.map(lambda loop: loop(STEPS), loops[:threads]))
        return threads * STEPS / (time.perf_counter() - began)

    run(2)
    return run


def measure(report: Report, engine: str, jobs: list[Scenario], limit: float | None) -> None:
    """Make the runs of an engine on one thread and on two, and add what they take.

    In rounds: some on one thread, the same on two, bare steps on one and on two. On two the longest begin
    first, so that no thread waits long for the other's last run.
    """
    one(jobs[0])  # loads what is compiled
    aba, pure = bare_aba(build_system(jobs[0]).model)(), pure_loops()
    size = max(10, len(jobs) // ROUNDS)
    gains, ceilings, alone, both, evaluations = [], [], 0.0, 0.0, 0
    with ThreadPoolExecutor(2) as pool:
        list(pool.map(one, jobs[:2]))  # each thread's first run takes longer
        for first in range(0, len(jobs), size):
            runs = sorted(map(timed, jobs[first : first + size]), key=lambda run: -run[0])
            serial = sum(seconds for seconds, _, _ in runs)
            began = time.perf_counter()
            made = list(pool.map(one, [job for _, job, _ in runs]))
            taken = time.perf_counter() - began
            gains.append(serial / taken)
            ceilings.append(pure(2) / pure(1))
            alone, both = alone + serial, both + taken
            evaluations += sum(run.counts.evaluations for run in made)
            assert all(same(run, again) for (_, _, run), again in zip(runs, made, strict=True)), "differ"
    count = len(jobs)
    report.add(f"{engine}: {count} runs of {SPAN:g} s on 2 threads", both, "s", limit)
    report.add(f"{engine}: a run on 1 thread", 1e3 * alone / count, "ms")
    report.add(f"{engine}: gain of the second thread", np.median(gains))
    report.add(f"{engine}: the same of bare steps, the machine's own", np.median(ceilings))
    report.add(f"{engine}: evaluations of a run", evaluations / count)
    report.add(f"{engine}: all, per evaluation, over pin.aba", both / evaluations / aba)
    report.add(f"{engine}: pin.aba", 1e6 * aba, "us")


def same(a: Trajectory, b: Trajectory) -> bool:
    """Whether two runs agree to the last bit."""
    data: Any = a.data
    numbers = [name for name in data if data[name].dtype.kind != "U"]
    return all(np.array_equal(data[name], b.data[name], equal_nan=True) for name in numbers)


if __name__ == "__main__":
    sys.exit(main())
