#!/usr/bin/env python3
"""Cost of a whole run: 1 s of case 3 at default settings, from scenario to finished trajectory.

The run's time counts the steps, locating the contacts' changes, and recording; beside it stands that of the
whole call, which also reads the URDF and builds the model. Neither writes the file. Processor time is set
against the simulated time, and against the number of evaluations times one bare ``pin.aba``.
"""

from __future__ import annotations

import cProfile
import pstats
import sys
import time
import timeit
from collections.abc import Callable

import numpy as np
import pinocchio as pin
from bench_tools import Report, scenario

from antenna_pin import build_system, simulate

SPAN = 1.0  # [s]
LIMITS = {"closed-form": (0.5, 4.0), "coal": (None, None)}


def bare_aba(model: pin.Model) -> Callable[[], float]:
    """Return a function that takes the processor time of one ``pin.aba`` of a model [s]."""
    names = {"aba": pin.aba, "model": model, "data": model.createData(), "q": pin.neutral(model)}
    names |= {"v": np.full(model.nv, 0.1), "tau": np.zeros(model.nv)}
    timer = timeit.Timer("aba(model, data, q, v, tau)", timer=time.process_time, globals=names)
    return lambda: timer.timeit(20000) / 20000


def main() -> int:
    """Time both backends."""
    time.perf_counter = time.process_time  # the clock of a run's wall time as well
    report = Report("run", __doc__ or "")
    report.parser.add_argument("--profile", action="store_true", help="show where the time of a run goes")
    arguments = report.parse()
    repeats, span = (1, 0.1) if arguments.quick else (9, SPAN)
    bare = bare_aba(build_system(scenario("case3")).model)
    bare()
    for backend, (speed, over) in LIMITS.items():
        if arguments.quick:  # so short a span has more impacts in it, and a larger share of recording
            speed = over = None
        chosen = scenario("case3", f"clearance.elevation.geometry={backend}")
        run = simulate(chosen, duration=span)  # dropped: compiles, or loads what is compiled
        calls, walls, ratios = [], [], []
        for _ in range(repeats):
            before = bare()
            began = time.perf_counter()
            run = simulate(chosen, duration=span)
            calls.append(time.perf_counter() - began)
            walls.append(run.counts.wall_seconds)
            ratios.append(walls[-1] / (run.counts.evaluations * 0.5 * (before + bare())))
        report.add(f"{backend}, processor time per simulated time", np.median(walls) / span, "s/s", speed)
        report.add(f"{backend}, processor time over evaluations x pin.aba", np.median(ratios), limit=over)
        low, high = np.percentile(ratios, [25, 75])
        report.add(f"{backend}, the same, quartiles apart", high - low)
        report.add(f"{backend}, the whole call per simulated time", np.median(calls) / span, "s/s", speed)
        report.add(f"{backend}, evaluations", run.counts.evaluations)
        report.add(f"{backend}, contact episodes", run.data.sizes["episode"])
        if arguments.profile:
            profile = cProfile.Profile()
            profile.runcall(simulate, chosen, duration=span)
            pstats.Stats(profile).sort_stats("tottime").print_stats(12)
    report.add("pin.aba", 1e6 * bare(), "us")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
