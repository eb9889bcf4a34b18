#!/usr/bin/env python3
"""Error against work: methods and tolerances on impacts and on lasting contact, by the compiled engine.

Errors are relative, against a run of ``dormand-prince-853`` at a tolerance of 1e-13: of the angle and its
rate the root mean square over all output times, over the largest value; of the contacts' impulse, of the
largest force and of the energy lost, those of the whole run. Work is evaluations and wall time over simulated
time, recording at 1 kHz left out. ``--figure FILE.png`` draws them; ``--write`` puts the table into
docs/performance.md.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from bench_tools import Report

from antenna_pin import Trajectory, load_scenario, simulate

PAGE = Path(__file__).parents[2] / "docs" / "performance.md"
REFERENCE = ("dormand-prince-853", 1e-13)
DEFAULT = ("dormand-prince-853", 1e-8)
#: Tolerances by method.
SETTINGS = {
    "bogacki-shampine-32": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7),
    "dormand-prince-54": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9),
    "dormand-prince-853": (1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11),
    "radau5": (1e-4, 1e-5, 1e-6, 1e-7),
}
ERRORS = ("angle", "rate", "impulse", "peak force", "energy lost")


@dataclass(frozen=True, slots=True)
class Problem:
    """What is run: a case of a model with a joint with play, with some entries changed, over a time [s]."""

    title: str
    model: str
    case: str
    joint: str
    duration: float
    changes: tuple[str, ...] = ()


PROBLEMS = (
    Problem("impacts, 0.2 s", "bai2020", "case3", "elevation", 0.2),
    Problem("impacts, 1 s", "bai2020", "case3", "elevation", 1.0),
    Problem(
        "lasting contact, 0.1 s", "pendulum", "rest", "hinge", 0.1, ("initial.joints.hinge.angle=10 deg",)
    ),
)
TABLED = ("impacts, 0.2 s", "lasting contact, 0.1 s")


@dataclass(frozen=True, slots=True)
class Point:
    """One run: its setting, its errors in the order of ``ERRORS``, its work."""

    method: str
    rtol: float
    errors: tuple[float, ...]
    evaluations: int
    rejected: float
    pace: float


def run_of(problem: Problem, method: str, rtol: float) -> tuple[Trajectory, float]:
    """Run a problem; return it and the wall time it took [s]."""
    changes = [
        f"clearance.{problem.joint}.geometry=closed-form",
        "integrator.engine=compiled",
        f"integrator.method={method}",
        f"integrator.rtol={rtol}",
        *problem.changes,
    ]
    scenario = load_scenario(problem.model, case=problem.case, overrides=changes)
    run = simulate(scenario, duration=problem.duration)
    return run, run.counts.wall_seconds


def _motion(run: Trajectory, joint: str, duration: float) -> tuple[np.ndarray, np.ndarray]:
    """Angle and rate at the output times."""
    times = np.arange(1, round(1e3 * duration) + 1) / 1e3
    data = run.data.sel(time=times, method="nearest")
    return (
        data.motion_angle.sel(joint=joint).values,
        data.motion_rate.sel(joint=joint).values,
    )


def _totals(run: Trajectory) -> tuple[float, float, float]:
    """Impulse of all contacts [N s], largest force [N] and energy lost [J] of a run."""
    data = run.data
    lost = data.dissipation_normal + data.dissipation_friction
    return (
        float(data.normal_impulse.values[-1].sum()),
        float(data.peak_force.values.max()),
        float(lost.values[-1].sum()),
    )


def errors_of(run: Trajectory, fine: Trajectory, problem: Problem) -> tuple[float, ...]:
    """Return the errors of a run against a fine one, in the order of ``ERRORS``."""
    found = []
    motions = (_motion(one, problem.joint, problem.duration) for one in (run, fine))
    for now, then in zip(*motions, strict=True):
        found.append(float(np.sqrt(np.mean((now - then) ** 2)) / np.abs(then).max()))
    ours, theirs = (_totals(one) for one in (run, fine))
    found += [abs(one / other - 1.0) for one, other in zip(ours, theirs, strict=True)]
    return tuple(found)


def measure(problem: Problem, repeats: int, thin: bool) -> list[Point]:
    """Run a problem with all settings."""
    fine, _ = run_of(problem, *REFERENCE)
    points = []
    for method, tolerances in SETTINGS.items():
        for rtol in tolerances[:: 2 if thin else 1]:
            runs = [run_of(problem, method, rtol) for _ in range(repeats)]
            run, counts = runs[0][0], runs[0][0].counts
            points.append(
                Point(
                    method,
                    rtol,
                    errors_of(run, fine, problem),
                    counts.evaluations,
                    counts.rejected / (counts.accepted + counts.rejected),
                    min(wall for _, wall in runs) / problem.duration,
                )
            )
    return points


def table(found: dict[str, list[Point]]) -> str:
    """Return what people choose as a table of the page; times over that of the default setting."""
    columns = [k for k, name in enumerate(ERRORS) if name not in ("rate", "impulse")]
    lines: list[str] = []
    for title, points in found.items():
        if title in TABLED:
            names = " | ".join(ERRORS[k] for k in columns)
            lines += ["", f"{title[:1].upper()}{title[1:]}:", ""]
            lines += [f"| method | rtol | {names} | evaluations | time |", "|---" * (len(columns) + 4) + "|"]
        usual = next(p.pace for p in points if (p.method, p.rtol) == DEFAULT)
        for p in points:
            if title not in TABLED or p.rtol not in (1e-4, 1e-8):
                continue
            errors = " | ".join(f"{p.errors[k]:.0e}" for k in columns)
            lines.append(
                f"| {p.method} | {p.rtol:.0e} | {errors} | {p.evaluations:,} | {p.pace / usual:.2g} |"
            )
    return "\n".join(lines[1:])


def write(text: str) -> None:
    """Put the table into the page."""
    page = PAGE.read_text(encoding="utf-8")
    marked = r"(?s)(<!-- measured: work and precision -->\n).*?(\n<!-- end -->)"
    PAGE.write_text(re.sub(marked, lambda m: m[1] + text + m[2], page), encoding="utf-8")


def draw(found: dict[str, list[Point]], path: str) -> None:
    """Draw errors against evaluations: a row for each problem, a column for each error."""
    import matplotlib.pyplot as plt

    shown = (0, 2, 3)
    figure, axes = plt.subplots(
        len(found), len(shown), figsize=(11, 3.1 * len(found)), layout="constrained", squeeze=False
    )
    for row, (title, points) in zip(axes, found.items(), strict=True):
        for ax, which in zip(row, shown, strict=True):
            for method, marker in zip(SETTINGS, "os^d", strict=True):
                own = [p for p in points if p.method == method]
                ax.loglog(
                    [max(p.errors[which], 1e-13) for p in own],
                    [p.evaluations for p in own],
                    marker=marker,
                    markersize=4,
                    label=method,
                )
            ax.invert_xaxis()
            ax.grid(visible=True, which="major", linewidth=0.3)
            ax.set_xlabel(f"error of the {ERRORS[which]}, relative [-]")
            ax.set_ylabel("evaluations [-]")
            ax.set_title(title, fontsize=10)
    axes[0, 0].legend(fontsize=7)
    figure.savefig(path, dpi=110)


def main() -> int:
    """Measure, report, draw."""
    report = Report("work_precision", __doc__ or "")
    report.parser.add_argument("--figure", help="where to draw the errors against evaluations")
    report.parser.add_argument("--write", action="store_true", help="put the table into docs/performance.md")
    arguments = report.parse()
    if arguments.write and arguments.quick:
        report.parser.error("--write needs all of it, without --quick")
    problems = PROBLEMS[:1] if arguments.quick else PROBLEMS
    found = {p.title: measure(p, 1 if arguments.quick else 2, arguments.quick) for p in problems}
    for title, points in found.items():
        for p in points:
            name = f"{title}: {p.method}, {p.rtol:g}"
            for what, error in zip(ERRORS, p.errors, strict=True):
                report.add(f"{name}: error of {what}", error)
            report.add(f"{name}: evaluations", p.evaluations)
            report.add(f"{name}: wall time per simulated time", p.pace, "s/s")
    if arguments.figure:
        draw(found, arguments.figure)
    if arguments.write:
        write(table(found))
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
