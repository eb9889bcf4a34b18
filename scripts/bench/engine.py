#!/usr/bin/env python3
"""The compiled engine against Pinocchio's: case 3 of the antenna, closed form, by method and tolerance.

Wall time includes recording at 1 kHz. Errors are those over the first 0.2 s, against a run at a tolerance of
1e-12: the largest deviation of the elevation angle, over the largest angle, and of the contacts' impulses,
over the largest impulse. The ratio is to one ``pin.aba`` called from Python, per evaluation, all included.
"""

from __future__ import annotations

import sys
import time

import numpy as np
from bench_tools import Report, scenario
from run import bare_aba

from antenna_pin import Trajectory, simulate

#: Method, tolerance.
SETTINGS = (
    ("dormand-prince-853", 1e-8),
    ("dormand-prince-853", 1e-6),
    ("dormand-prince-54", 1e-6),
    ("dormand-prince-54", 1e-4),
    ("bogacki-shampine-32", 1e-4),
)
BEGINNING = 0.2  # [s], in which single impacts can be compared


def case3(engine: str, method: str, rtol: float, duration: float) -> Trajectory:
    """Run case 3."""
    changes = ("clearance.elevation.geometry=closed-form", f"integrator.engine={engine}")
    return simulate(
        scenario("case3", *changes, f"integrator.method={method}", f"integrator.rtol={rtol}"),
        duration=duration,
    )


def errors(run: Trajectory, fine: Trajectory) -> tuple[float, float]:
    """Return the largest errors of angle and of impulses, relative; not a number where impacts are others."""
    times = np.arange(1, int(1e3 * BEGINNING)) / 1e3
    angles = [
        one.data.motion_angle.sel(joint="elevation").sel(time=times, method="nearest").values
        for one in (run, fine)
    ]
    off = float(np.abs(angles[0] - angles[1]).max() / np.abs(angles[1]).max())
    if run.data.episode_contact.values.tolist() != fine.data.episode_contact.values.tolist():
        return off, float("nan")
    impulses = [one.data.impulse.values for one in (run, fine)]
    return off, float(np.abs(impulses[0] - impulses[1]).max() / impulses[1].max())


def main() -> int:
    """Time both engines."""
    report = Report("engine", __doc__ or "")
    arguments = report.parse()
    repeats, span = (1, 0.1) if arguments.quick else (5, 1.0)
    aba = bare_aba()
    fine = case3("compiled", "dormand-prince-853", 1e-12, BEGINNING)
    for method, rtol in SETTINGS:
        walls: dict[str, list[float]] = {"compiled": [], "pinocchio": []}
        ratios = []
        for _ in range(repeats + 1):  # the first compiles, or loads what is compiled, and is dropped
            for engine, taken in walls.items():
                before = aba()
                began = time.perf_counter()
                run = case3(engine, method, rtol, span)
                taken.append(time.perf_counter() - began)
                if engine == "compiled":
                    ratios.append(run.counts.wall_seconds / (run.counts.evaluations * 0.5 * (before + aba())))
        name = f"{method}, {rtol:g}"
        angle, impulse = errors(case3("compiled", method, rtol, BEGINNING), fine)
        ours, theirs = (float(np.median(taken[1:])) for taken in walls.values())
        report.add(f"{name}: compiled, wall time per simulated time", ours / span, "s/s")
        report.add(f"{name}: time of Pinocchio's engine over it", theirs / ours)
        report.add(f"{name}: per evaluation, over pin.aba", float(np.median(ratios[1:])))
        report.add(f"{name}: error of the angle", angle)
        report.add(f"{name}: error of impulses", impulse)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
