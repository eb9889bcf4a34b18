#!/usr/bin/env python3
"""What the satellite of You, Pan and Zhao (2010) does, in numbers, against the words of that paper.

Parts: ``impact``, the first impact against its closed form; ``peaks``, the force through joint 2 over that of
the ideal joint; ``words``, the paper's other statements; ``friction``, what the deviation comes from;
``space``, the same joint with six degrees of freedom; ``causes``, what moves the peak force and how much;
``chance``, how much of that repeats. docs/you2010.md shows them.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from bench_tools import Report
from first_impact import first_impact
from frictional_hinge import FrictionalHinge
from matplotlib.figure import Figure
from you2010_causes import causes_part, chance_part
from you2010_runs import EXTERNAL, LAYOUTS, NO_FRICTION, Load, run, scenario, settled

from antenna_pin import Trajectory, build_system
from antenna_pin.analysis import base_motion, deviation, impacts, resampled


def impact_part(report: Report, span: float) -> None:
    """Set the first impact against its closed form."""
    for case in ("planar", "planar-external", "gimbal"):
        system = build_system(scenario(case))
        (joint,) = system.clearances
        spec = scenario(case).clearance["joint2"]
        expected = first_impact(system, spec.radial_play, joint.radial.stiffness, joint.radial.restitution)
        found = impacts(run(case, span=0.1)).isel(impact=0)
        force = float(np.linalg.norm(expected.ideal_force))
        report.add(f"{case}, ideal joint's force across the axis at the start", force, "N")
        report.add(f"{case}, acceleration of the open joint", expected.acceleration, "m/s2")
        report.add(f"{case}, effective mass that way", expected.mass, "kg")
        report.add(f"{case}, approach speed, expected", 1e3 * expected.approach_speed, "mm/s")
        report.add(f"{case}, approach speed, found", 1e3 * float(found["approach_speed"]), "mm/s")
        report.add(f"{case}, peak force, expected", expected.peak_force, "N")
        report.add(f"{case}, peak force, found", float(found["peak_force"]), "N")
        off = abs(float(found["peak_force"]) / expected.peak_force - 1.0)
        report.add(f"{case}, peak force, error of the expected", off, limit=5e-3)
        report.add(f"{case}, peak force over the ideal joint's at the start", found["peak_force"] / force)


def peaks_part(report: Report, span: float) -> None:
    """Set the largest force against that of the ideal joint, over spans from the start."""
    for case, ideal in LAYOUTS.items():
        held = Load.of(run(ideal, span=span))
        for label, overrides in (("", ()), (", stiffness as printed", (EXTERNAL,))):
            found = Load.of(run(case, *overrides, span=span))
            for end in (1.0, 2.0, 4.0, 5.0):
                if end > span:
                    continue
                largest, own = found.largest(0.0, end), held.largest(0.0, end)
                if not overrides:
                    report.add(f"{case}, {end:g} s: ideal joint, largest force", own, "N")
                report.add(f"{case}, {end:g} s: joint with play{label}, largest force", largest, "N")
                report.add(f"{case}, {end:g} s:   over the ideal joint's{label}", largest / own)


def words_part(report: Report, span: float) -> None:
    """Put numbers to the paper's other statements."""
    for case, ideal in LAYOUTS.items():
        play, held = run(case, span=span), run(ideal, span=span)
        table, end = impacts(play), settled(play)
        report.add(f"{case}, impacts before lasting contact", int(table["ended"].sum()))
        report.add(f"{case}, lasting contact from", end, "s")
        report.add(f"{case}, longest impact", 1e3 * float(table["duration"][table["ended"]].max()), "ms")
        loads, ideals = Load.of(play), Load.of(held)
        thirds = np.linspace(0.0, end, 4)
        for k in range(3):
            largest = loads.largest(thirds[k], thirds[k + 1])
            report.add(f"{case}, largest force, {k + 1}. third of the impacts' time", largest, "N")
        after = (loads.time >= end + 0.05) & (loads.time <= 2.0)
        if after.any():
            smooth = resampled(ideals.time, ideals.force, loads.time[after])
            off = np.abs(loads.force[after] / smooth - 1.0).max()
            report.add(f"{case}, lasting contact to 2 s, force off the ideal joint's, most", off)
        hardest = table.isel(impact=int(np.argmax(table["peak_force"].values * table["ended"].values)))
        report.add(f"{case}, hardest impact, impulse", float(hardest["impulse"]), "N s")
        report.add(f"{case}, hardest impact, impulse on 1000 kg", float(hardest["impulse"]), "mm/s")
        for until in (2.0, 4.0, 5.0):
            if until <= span:
                _motion(report, case, ideal, until)


def _motion(report: Report, case: str, ideal: str, until: float) -> None:
    """Add how far base and shafts are from the ideal run up to a time."""
    play, held = run(case), run(ideal)
    cut = slice(0.0, until)
    apart = deviation(play, held).data.sel(time=cut)
    motion = base_motion(held).sel(time=cut)
    sizes = {"position": "position", "attitude": "rotation", "velocity": "velocity"}
    sizes |= {"angular_velocity": "angular_velocity"}
    for name, reference in sizes.items():
        off = np.linalg.norm(apart[f"base_{name}"], axis=1).max()
        whole = np.linalg.norm(motion[reference] - motion[reference][0], axis=1).max()
        report.add(f"{case}, {until:g} s: base {name.replace('_', ' ')}, off ideal, share", off / whole)
    own = base_motion(play).sel(time=cut)
    for name in ("acceleration", "angular_acceleration"):
        ratio = np.linalg.norm(own[name], axis=1).max() / np.linalg.norm(motion[name], axis=1).max()
        report.add(f"{case}, {until:g} s: base {name.replace('_', ' ')}, largest over ideal", ratio)
    for joint in ("joint1", "joint2"):
        for name in ("angle", "rate"):
            off = float(np.abs(apart[name].sel(joint=joint)).max())
            whole = float(np.abs(held.data[f"motion_{name}"].sel(joint=joint, time=cut)).max())
            report.add(f"{case}, {until:g} s: {joint} {name}, off ideal, share", off / whole)
        name = "motion_acceleration"
        sizes_of = [float(np.abs(r.data[name].sel(joint=joint, time=cut)).max()) for r in (play, held)]
        report.add(
            f"{case}, {until:g} s: {joint} acceleration, largest over ideal", sizes_of[0] / sizes_of[1]
        )


def friction_part(report: Report, span: float) -> None:
    """Say what the deviation comes from: the play, or the friction that comes with it."""
    times = np.arange(round(500 * span) + 1) / 500
    held = run("ideal", span=span).data["motion_angle"].sel(joint="joint2", time=times).values
    (joint,) = build_system(scenario("3d")).clearances
    rubbed = FrictionalHinge(build_system(scenario("ideal")), joint).angles(times)
    for label, overrides in (("0.25", ()), ("0", (NO_FRICTION,))):
        found = run("planar", *overrides, span=span).data
        angle = np.interp(times, found["time"].values, found["motion_angle"].sel(joint="joint2").values)
        for until in (1.0, 2.0, 4.0, 5.0):
            part = times <= until
            if until > span:
                continue
            off = np.abs(angle - held)[part].max()
            report.add(f"friction {label}, {until:g} s: joint2 off the ideal joint", 1e3 * off, "mrad")
            if not overrides:
                off = np.abs(angle - rubbed)[part].max()
                report.add(f"  off the ideal joint with friction {label}", 1e3 * off, "mrad")


def space_part(report: Report, span: float) -> None:
    """Set the joint with six degrees of freedom beside the planar one."""
    half = "clearance.joint2.normal.stiffness=2.709e10"
    cases = {"planar": (), "3d": (), "3d, half the stiffness": (half,), "3d-offset": ()}
    end = min(2.0, span)
    for label, overrides in (cases | {"gimbal": (), "gimbal-3d": ()}).items():
        ideal = run("gimbal-ideal" if label.startswith("gimbal") else "ideal", span=span)
        found = run(label.partition(",")[0], *overrides, span=end)
        largest = Load.of(found).largest(0.0, end)
        report.add(f"{label}, {end:g} s: largest force", largest, "N")
        report.add(
            f"{label}, {end:g} s:   over the ideal joint's", largest / Load.of(ideal).largest(0.0, end)
        )
        off = deviation(found, ideal)["joint2 angle"]
        report.add(f"{label}, {end:g} s: joint2 off the ideal joint", 1e3 * off.maximum, "mrad")
        report.add(f"{label}, {end:g} s: last time without contact", _last_apart(found), "s")
        if label == "gimbal-3d":
            report.add(f"{label}, {end:g} s: largest tilt", 1e3 * found.data["journal_tilt"].max(), "mrad")
            flange = ["axial" in str(name) for name in impacts(found)["contact"].values]
            report.add(f"{label}, {end:g} s: contacts of a flange", sum(flange))


def _last_apart(trajectory: Trajectory) -> float:
    """Return the last sample at which the journal touched nothing [s]."""
    apart = ~(trajectory.data["touching"].values != 0).any(axis=1)
    return float(trajectory.data["time"].values[apart].max())


def draw(folder: Path) -> Path:
    """Draw the force through joint 2 in both layouts and return the figure's path."""
    figure = Figure(figsize=(7.1, 2.9), layout="constrained", dpi=200)
    panels = figure.subplots(1, 2, sharey=True)
    for axes, (case, ideal) in zip(panels, LAYOUTS.items(), strict=True):
        loads, held, table = Load.of(run(case)), Load.of(run(ideal)), impacts(run(case))
        hits = table.isel(impact=np.flatnonzero(table["ended"]))
        resting = loads.time >= settled(run(case)) + 0.02
        axes.semilogy(
            hits["peak_time"], hits["peak_force"], "o", ms=3, color="#D55E00", label="peak of an impact"
        )
        axes.semilogy(
            loads.time[resting], loads.force[resting], color="#0072B2", lw=1.0, label="lasting contact"
        )
        axes.semilogy(held.time, held.force, "--", color="black", lw=0.9, label="ideal joint")
        axes.set_title(f"{case} layout", loc="left", fontsize="medium")
        axes.set_xlabel("time [s]")
        axes.set_xlim(0.0, 5.0)
        axes.grid(alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
    panels[0].set_ylabel("force through joint 2 [N]")
    panels[1].legend(fontsize="small")
    path = folder / "you2010.png"
    figure.savefig(path)
    return path


PARTS = {
    "impact": impact_part,
    "peaks": peaks_part,
    "words": words_part,
    "friction": friction_part,
    "space": space_part,
}
_TABLES = {"causes": causes_part, "chance": chance_part}


def main() -> int:
    """Print the numbers of one part, or draw."""
    report = Report("you2010", __doc__ or "")
    report.parser.add_argument("part", choices=[*PARTS, *_TABLES], help="which numbers")
    report.parser.add_argument("--out", type=Path, metavar="FOLDER", help="draw a figure in this folder")
    arguments = report.parse()
    if arguments.out is not None:
        arguments.out.mkdir(parents=True, exist_ok=True)
        print(draw(arguments.out))
    if arguments.part in _TABLES:
        _TABLES[arguments.part](arguments.quick)
        return 0
    report.name = f"you2010 {arguments.part}"
    PARTS[arguments.part](report, 0.5 if arguments.quick else 5.0)
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
