#!/usr/bin/env python3
"""The limit of small clearance: a joint with play tends to the ideal joint, or to the one with friction.

Case 3 over 0.2 s, radial and axial clearance equal; the largest deviation of the motion angle from that of
the ideal joint. Without friction it falls with the clearance to a floor that the contacts' compliance sets,
and the floor falls as the stiffness rises (depth goes with stiffness to the power -2/3). With friction it
falls against an ideal joint whose friction torque follows from its own constraint wrench (see
frictional_hinge.py), and does not against the frictionless one.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from bench_tools import CLOSED_FORM, Array, Report, scenario
from frictional_hinge import FrictionalHinge
from matplotlib.figure import Figure

from antenna_pin import build_system, simulate

SPAN = 0.2  # [s]
CLEARANCES = (100e-6, 10e-6, 1e-6)  # [m]
NEAR_ZERO = 0.1e-6  # [m]: the floor
STIFFNESSES = (1e10, 1e11, 1e12)  # [N/m^1.5]
FRICTION_STIFFNESS = 1e12  # depths stay below the clearances, so that the flanges take no tilting moment
NO_FRICTION = ("clearance.elevation.friction={replace = true, law = 'none'}",)
# At the paper's critical speeds friction is nearly absent; at a hundredth of them it is not.
FRICTION = (
    "clearance.elevation.friction.static_speed=1 mm/s",
    "clearance.elevation.friction.dynamic_speed=10 mm/s",
)


def times(rate: float = 1000.0) -> Array:
    """Return sampling times [s]."""
    return np.arange(round(SPAN * rate) + 1) / rate


def changes(clearance: float, stiffness: float) -> tuple[str, ...]:
    """Return what differs from case 3."""
    joint = "clearance.elevation"
    return (
        CLOSED_FORM,
        f"{joint}.radial_clearance={clearance}",
        f"{joint}.axial_clearance={clearance}",
        f"{joint}.normal.stiffness={stiffness}",
    )


def angles(case: str, *overrides: str) -> Array:
    """Return the elevation's motion angle over a run [rad]."""
    run = simulate(scenario(case, *overrides), duration=SPAN)
    if not run.completed:
        raise SystemExit(f"a run ended early: {run.message}")
    return np.asarray(run.data["motion_angle"].sel(joint="elevation", time=times()).values)


def frictional_limit(rate: float) -> Array:
    """Return the angle of the ideal joint with friction, integrated at so many steps per second [rad]."""
    with_play = scenario("case3", *changes(CLEARANCES[-1], FRICTION_STIFFNESS), *FRICTION)
    (joint,) = build_system(with_play).clearances
    return FrictionalHinge(build_system(scenario("case1")), joint).angles(times(rate))


def _slowest(values: list[float]) -> float:
    """Return the largest ratio of a value to the one before it."""
    return max(later / earlier for earlier, later in zip(values, values[1:], strict=False))


def draw(folder: Path, floors: dict[float, list[float]], friction: dict[str, list[float]]) -> Path:
    """Draw deviations over clearance and return the figure's path."""
    figure = Figure(figsize=(7.1, 2.9), layout="constrained", dpi=200)
    left, right = figure.subplots(1, 2)
    all_clearances = 1e6 * np.array([*CLEARANCES, NEAR_ZERO])
    for marker, (stiffness, values) in zip("osd", floors.items(), strict=True):
        power = round(np.log10(stiffness))
        left.loglog(all_clearances, values, marker + "-", label=rf"$10^{{{power}}}$ N/m$^{{1.5}}$")
    left.set_title("without friction", loc="left", fontsize="medium")
    for marker, (label, values) in zip("so", friction.items(), strict=True):
        right.loglog(all_clearances[:-1], values, marker + "-", label=label)
    right.set_title("with friction", loc="left", fontsize="medium")
    for axes in (left, right):
        axes.set_xlabel("clearance [µm]")
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    left.set_ylabel("largest deviation of the angle [rad]")
    left.legend(title="stiffness", fontsize="small", title_fontsize="small")
    right.legend(title="from the ideal joint", fontsize="small", title_fontsize="small")
    path = folder / "limits.png"
    figure.savefig(path)
    return path


def main() -> int:
    """Measure the deviations."""
    report = Report("limits", __doc__ or "")
    report.parser.add_argument("--out", type=Path, metavar="FOLDER", help="draw a figure in this folder")
    arguments = report.parse()
    ideal = angles("case1")

    floors: dict[float, list[float]] = {}
    for stiffness in STIFFNESSES:
        floors[stiffness] = [
            np.abs(angles("case3", *changes(clearance, stiffness), *NO_FRICTION) - ideal).max()
            for clearance in (*CLEARANCES, NEAR_ZERO)
        ]
        for clearance, deviation in zip((*CLEARANCES, NEAR_ZERO), floors[stiffness], strict=True):
            report.add(f"no friction, {stiffness:.0e} N/m^1.5, {1e6 * clearance:g} um", deviation, "rad")
        report.add("  each over the one before, largest", _slowest(floors[stiffness]), limit=1.0)
    for softer, stiffer in zip(STIFFNESSES, STIFFNESSES[1:], strict=False):
        ratio = floors[stiffer][-1] / floors[softer][-1]
        report.add(f"floor, {stiffer:.0e} over {softer:.0e} N/m^1.5", ratio, limit=0.5)

    limit = frictional_limit(1000.0)
    halved = frictional_limit(2000.0)[::2]
    report.add("ideal joint with friction, from the frictionless", np.abs(limit - ideal).max(), "rad")
    report.add("ideal joint with friction, step halved", np.abs(limit - halved).max(), "rad")
    friction: dict[str, list[float]] = {"without friction": [], "with friction": []}
    for clearance in CLEARANCES:
        found = angles("case3", *changes(clearance, FRICTION_STIFFNESS), *FRICTION)
        for label, right in (("without friction", ideal), ("with friction", limit)):
            deviation = np.abs(found - right).max()
            friction[label].append(deviation)
            report.add(f"friction, {1e6 * clearance:g} um, from the ideal joint {label}", deviation, "rad")
    report.add(
        "  with friction: each over the one before, largest", _slowest(friction["with friction"]), limit=0.5
    )
    report.add(
        "  at the end, with over without",
        friction["with friction"][-1] / friction["without friction"][-1],
        limit=0.01,
    )

    code = report.finish()
    if arguments.out is not None:
        arguments.out.mkdir(parents=True, exist_ok=True)
        print(draw(arguments.out, floors, friction))
    return code


if __name__ == "__main__":
    sys.exit(main())
