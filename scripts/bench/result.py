#!/usr/bin/env python3
"""Cost of a result beside the integration: recording, saving and loading it, and what a run costs at least.

Case 3 of the antenna, sampled at 1 kHz. Times are CPU time, the least of several; below each stands what it
was when the record was a loop over samples in Python and the file was written by a general writer.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from bench_tools import CLOSED_FORM, Report, scenario

from antenna_pin import Trajectory, build_system, simulate
from antenna_pin.run.simulation.inputs import settings_of
from antenna_pin.run.simulation.loop import Run
from antenna_pin.run.simulation.recorder import result_data
from antenna_pin.scenario.assemble import initial_angles, initial_state

SPAN = 5.0  # [s]
BEFORE = "the same, before"


def least(function: Callable[[], Any], repeats: int) -> float:
    """Return the least CPU time of several calls [ms]."""
    times = []
    for _ in range(repeats):
        began = time.process_time()
        function()
        times.append(time.process_time() - began)
    return 1e3 * min(times)


def finished(backend: str, span: float) -> Run:
    """Return a run of case 3 whose samples are not recorded yet."""
    chosen = scenario("case3", f"clearance.elevation.geometry={backend}")
    system = build_system(chosen)
    start = system.state(*initial_state(chosen, system), initial_angles(chosen, system))
    run = Run(system, start, span, settings_of(chosen))
    run.advance()
    return run


def main() -> int:
    """Measure all of it."""
    report = Report("result", __doc__ or "")
    quick = report.parse().quick
    span, repeats = (0.2, 2) if quick else (SPAN, 15)
    limits = [None, None, None, None] if quick else [5.0, 60.0, 60.0, 8.0]
    recording, saving, loading, least_cost = limits
    for backend, limit, before in (("closed-form", recording, 47.0), ("coal", None, None)):
        run = finished(backend, span)

        def record(run: Run = run) -> Any:
            return result_data(run, "", "", {})

        record()
        taken = least(record, repeats)
        report.add(f"recording, {backend}, per simulated second", taken / span, "ms", limit)
        if before is not None:
            report.add(BEFORE, before, "ms")
    chosen = scenario("case3", CLOSED_FORM)
    full = simulate(chosen, duration=span)
    with tempfile.TemporaryDirectory() as name:
        path = full.save(Path(name) / "full.nc")
        report.add("saving 5 s", least(lambda: full.save(path), repeats), "ms", saving)
        report.add(BEFORE, 280.0, "ms")
        report.add("loading 5 s", least(lambda: Trajectory.load(path), repeats), "ms", loading)
        report.add(BEFORE, 250.0, "ms")
        report.add("size of the file", 1e-6 * path.stat().st_size, "MB")
        lean = simulate(scenario("case3", CLOSED_FORM, "output.form=lean"), duration=span)
        path = lean.save(Path(name) / "lean.nc")
        report.add("lean: size of the file", 1e-6 * path.stat().st_size, "MB")
        report.add("lean: saving", least(lambda: lean.save(path), repeats), "ms")
    # Nothing moves in a nanosecond: reading, building, one sample, and the result.
    report.add(
        "a run at least", least(lambda: simulate(chosen, duration=1e-9), 4 * repeats), "ms", least_cost
    )
    report.add(BEFORE, 22.0, "ms")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
