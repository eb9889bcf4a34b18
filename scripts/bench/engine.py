#!/usr/bin/env python3
"""The compiled engine against Pinocchio's: case 3 of the antenna by accuracy, method and tolerance; loops.

All in closed form; processor time is from the scenario to the result, recording at 1 kHz included. Errors are
those over the first 0.2 s, against a run at a tolerance of 1e-12: the largest deviation of the elevation
angle, over the largest angle, and that of what each contact has passed on in all (a graze more or less does
not count), over the largest of these. Ratios are to one ``pin.aba`` of the same model called from Python, per
evaluation, all included.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

import numpy as np
from bench_tools import CLOSED_FORM, Report, scenario
from run import bare_aba

from antenna_pin import Scenario, Trajectory, build_system, load_scenario, simulate

#: Changes of the scenario.
SETTINGS = (
    ("integrator.accuracy=1e-3",),
    ("integrator.accuracy=1e-6",),
    (),
    ("integrator.method=dormand-prince-54", "integrator.rtol=1e-6"),
    ("integrator.method=bogacki-shampine-32", "integrator.rtol=1e-4"),
)
#: Closed loops with play: model, case, joint, time [s].
LOOPS = (("slider_crank", "planar", "pin", 0.2), ("chen2021", None, "s2", 2.0))
BEGINNING = 0.2  # [s], in which single impacts can be compared


def case3(engine: str, changes: tuple[str, ...]) -> Scenario:
    """Return case 3."""
    return scenario("case3", CLOSED_FORM, f"integrator.engine={engine}", *changes)


def errors(run: Trajectory, fine: Trajectory) -> tuple[float, float]:
    """Return the largest errors of the angle and of the contacts' total impulses, relative."""
    times = np.arange(1, int(1e3 * BEGINNING)) / 1e3
    angles = [
        one.data.motion_angle.sel(joint="elevation").sel(time=times, method="nearest").values
        for one in (run, fine)
    ]
    off = float(np.abs(angles[0] - angles[1]).max() / np.abs(angles[1]).max())
    totals = [
        np.bincount(one.data.episode_contact, one.data.impulse, one.data.sizes["contact"])
        for one in (run, fine)
    ]
    return off, float(np.abs(totals[0] - totals[1]).max() / totals[1].max())


def ratio(run: Trajectory, aba: Callable[[], float]) -> tuple[float, float]:
    """Return the time of a run per evaluation [s], and over one ``pin.aba``."""
    each = run.counts.wall_seconds / run.counts.evaluations
    return each, each / aba()


def main() -> int:
    """Time both engines."""
    time.perf_counter = time.process_time  # the clock of a run's wall time as well
    report = Report("engine", __doc__ or "")
    quick = report.parse().quick
    repeats, span = (1, 0.1) if quick else (5, 1.0)
    aba = bare_aba(build_system(scenario("case3")).model)
    fine = simulate(case3("compiled", ("integrator.rtol=1e-12",)), duration=BEGINNING)
    for changes in SETTINGS:
        cases = {engine: case3(engine, changes) for engine in ("compiled", "pinocchio")}
        walls: dict[str, list[float]] = {"compiled": [], "pinocchio": []}
        ratios = []
        for _ in range(repeats + 1):  # the first compiles, or loads what is compiled, and is dropped
            for engine, taken in walls.items():
                began = time.perf_counter()
                run = simulate(cases[engine], duration=span)
                taken.append(time.perf_counter() - began)
                if engine == "compiled":
                    ratios.append(ratio(run, aba)[1])
                    evaluations = run.counts.evaluations
        name = ", ".join(one.partition("integrator.")[2] for one in changes) or "defaults"
        angle, impulse = errors(simulate(cases["compiled"], duration=BEGINNING), fine)
        ours, theirs = (float(np.median(taken[1:])) for taken in walls.values())
        report.add(f"{name}: processor time per simulated time", ours / span, "s/s")
        report.add(f"{name}: time of Pinocchio's engine over it", theirs / ours)
        report.add(f"{name}: evaluations", evaluations)
        report.add(f"{name}: per evaluation, over pin.aba", float(np.median(ratios[1:])), limit=1.3)
        report.add(f"{name}: error of the angle", angle)
        report.add(f"{name}: error of impulses", impulse)
    report.add("pin.aba of the antenna", 1e6 * aba(), "us")
    for model, case, joint, duration in LOOPS:
        changes = (f"clearance.{joint}.geometry=closed-form", "integrator.engine=compiled")
        more = ("integrator.accuracy=1e-3", "output.rate=1000")
        known = load_scenario(model, case=case, overrides=[*changes, *more])
        aba = bare_aba(build_system(known).model)
        runs = [simulate(known, duration=0.02 if quick else duration) for _ in range(4)][1:]
        each, over = np.min([ratio(run, aba) for run in runs], axis=0)
        report.add(f"{model}: per evaluation", 1e6 * each, "us")
        report.add(f"{model}: per evaluation, over pin.aba", over)
        pace = min(run.counts.wall_seconds for run in runs) / runs[0].data.attrs["end_time"]
        report.add(f"{model}: processor time per simulated time", pace, "s/s")
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
