#!/usr/bin/env python3
"""What play does to a flexible reflector, and the reflector to the joint: the antenna of bai2020, 5 s.

Rigid, with two modes, and with petals, each with an ideal elevation joint and with play; then one mode from 5
to 50 Hz. Single impacts are sensitive, so each case with play is run several times with the journal put off
centre by some micrometres at the start; figures are medians.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from bench_tools import Array, off_centre, print_table
from matplotlib.figure import Figure

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.analysis import (
    base_motion,
    deviation,
    elastic_motion,
    elastic_parts_of,
    load_statistics,
    pointing_error,
    settling,
    spectrum,
    time_rms,
    uniform,
)
from antenna_pin.base.files import replacing

JOINT = "elevation"
PAIRS = {
    "rigid": ("case1", "case3"),
    "modes": ("flexible-ideal", "flexible"),
    "petals": ("petals-ideal", "petals"),
}
SWEEP = (5, 10, 20, 35, 50)
ROWS = (
    "largest deflection, turning [mrad]",
    "ringing of it, rms [mrad]",
    "largest deflection, sliding [um]",
    "ringing of it, rms [um]",
    "energy lost in the reflector [mJ]",
    "contacts [-]",
    "largest force [N]",
    "rms force [N]",
    "energy lost in contact [mJ]",
    "share of time in contact [-]",
    "settled after [s]",
    "largest deviation of the angle [mrad]",
    "largest deviation of the rate [mrad/s]",
    "rms acceleration of elevation [rad/s2]",
    "rms angular acceleration, base [mrad/s2]",
    "largest pointing error [mrad]",
)


def run(case: str, duration: float, start: Sequence[str] = (), *overrides: str) -> Trajectory:
    """Return a run of a case of bai2020, by the compiled engine."""
    changes = ["integrator.engine=compiled", *start, *overrides]
    if start:
        changes.append(f"clearance.{JOINT}.geometry=closed-form")
    found = simulate(load_scenario("bai2020", case=case, overrides=changes), duration=duration)
    if not found.completed:
        raise SystemExit(f"{case} ended early: {found.message}")
    return found


def ringing(found: Trajectory, part: str) -> float:
    """Return the rms of a deflection above half the part's own frequency, below which the drives act."""
    deflection = found.data["deflection"].sel(elastic_part=part).values
    signal = uniform(found.data["time"].values, deflection, rate=1000.0)
    lines = np.fft.rfft(np.asarray(signal.values) - np.mean(signal.values))
    frequencies = np.fft.rfftfreq(len(signal.values), 1.0 / signal.rate)
    lines[frequencies < 0.5 * elastic_parts_of(found)[part]["frequency"]] = 0.0
    return float(np.sqrt(np.mean(np.fft.irfft(lines, len(signal.values)) ** 2)))


def look(found: Trajectory, ideal: Trajectory) -> list[float]:
    """Return what a run shows, a number per row; NaN where there is none."""
    numbers = dict.fromkeys(ROWS, np.nan)
    data, time = found.data, found.data["time"].values
    about = elastic_parts_of(found)
    for slides, what, unit, size in ((False, "turning", "mrad", 1e3), (True, "sliding", "um", 1e6)):
        parts = [name for name, one in about.items() if one["slides"] == slides]
        if parts:
            peaks = elastic_motion(found)["peak_deflection"].sel(elastic_part=parts).values
            numbers[f"largest deflection, {what} [{unit}]"] = size * peaks.max()
            numbers[f"ringing of it, rms [{unit}]"] = size * max(ringing(found, part) for part in parts)
    if about:
        numbers["energy lost in the reflector [mJ]"] = 1e3 * float(data["total_elastic_loss"].sum())
    if "contact" in data.dims:
        loads = load_statistics(found)
        for row, name, size in (
            ("contacts [-]", "episodes", 1.0),
            ("rms force [N]", "rms_force", 1.0),
            ("energy lost in contact [mJ]", "dissipated", 1e3),
            ("share of time in contact [-]", "contact_share", 1.0),
        ):
            numbers[row] = size * float(loads[f"joint_{name}"].values[0])
        numbers["largest force [N]"] = float(data["peak_force"].values.max(initial=0.0))
        (settled,) = settling(found)
        numbers["settled after [s]"] = np.nan if settled.time is None else settled.time
        apart = deviation(found, ideal, JOINT)
        numbers["largest deviation of the angle [mrad]"] = 1e3 * apart[f"{JOINT} angle"].maximum
        numbers["largest deviation of the rate [mrad/s]"] = 1e3 * apart[f"{JOINT} rate"].maximum
        numbers["largest pointing error [mrad]"] = 1e3 * float(
            pointing_error(found, ideal)["half_cone"].max()
        )
    acceleration = data["motion_acceleration"].sel(joint=JOINT).values
    numbers["rms acceleration of elevation [rad/s2]"] = float(time_rms(time, acceleration))
    turning = np.linalg.norm(base_motion(found)["angular_acceleration"].values, axis=1)
    numbers["rms angular acceleration, base [mrad/s2]"] = 1e3 * float(time_rms(time, turning))
    return [float(number) for number in numbers.values()]


@dataclass
class Seen:
    """The runs of a pair of cases: the ideal one, and the numbers and the first of those with play."""

    ideal: Trajectory
    play: Trajectory
    columns: dict[str, Array]


def seen(name: str, count: int, duration: float) -> Seen:
    """Run a pair of cases."""
    ideal = run(PAIRS[name][0], duration)
    runs = [run(PAIRS[name][1], duration, [start]) for start in off_centre(JOINT, count)]
    found = np.array([look(one, ideal) for one in runs])
    columns = {f"{name}, ideal": np.array(look(ideal, ideal)), f"{name}, play": np.median(found, axis=0)}
    return Seen(ideal, runs[0], columns)


def swept(count: int, duration: float) -> dict[int, tuple[float, float]]:
    """Return the ringing of the mode that nods by frequency, ideal and with play [rad]."""
    ideal_joint = f"clearance.{JOINT}={{replace = true, model = 'ideal'}}"
    found = {}
    for frequency in SWEEP:
        case = f"nod-{frequency}hz"
        ideal = ringing(run(case, duration, (), ideal_joint), "reflector_nod")
        play = [ringing(run(case, duration, [start]), "reflector_nod") for start in off_centre(JOINT, count)]
        found[frequency] = ideal, float(np.median(play))
    return found


def draw(modes: Seen, sweep: dict[int, tuple[float, float]], path: Path) -> None:
    """Draw the mode that bends over time and its density, ideal and with play, and the sweep."""
    matplotlib.rcParams.update({"font.size": 8.0, "axes.spines.top": False, "axes.spines.right": False})
    figure = Figure(figsize=(7.2, 2.5), dpi=160, layout="constrained")
    left, middle, right = figure.subplots(1, 3)
    for label, one, style in (
        ("play", modes.play, {"color": "#D55E00", "linewidth": 0.6}),
        ("ideal", modes.ideal, {"color": "black", "linewidth": 0.8, "linestyle": (0, (4, 1.5))}),
    ):
        time, values = (
            one.data["time"].values,
            one.data["deflection"].sel(elastic_part="reflector_bend").values,
        )
        left.plot(time, 1e6 * values, label=label, **style)
        found = spectrum(time, values, segment=0.5 * float(time[-1]))
        middle.loglog(found["frequency"], found["density"], label=label, **style)
    left.set(xlabel="time [s]", ylabel="the mode that bends [µm]", title="deflection")
    middle.axvline(25.0, color="#666666", linewidth=0.7, linestyle=":")
    middle.set(xlabel="frequency [Hz]", ylabel="[m/√Hz]", title="its amplitude density", xlim=(1.0, 250.0))
    top = middle.get_ylim()[1]
    middle.set_ylim(top / 1e8, top)
    frequencies = np.array(list(sweep))
    for k, (label, colour, marker) in enumerate((("ideal", "black", "o"), ("play", "#D55E00", "s"))):
        right.loglog(
            frequencies,
            [1e3 * sweep[f][k] for f in sweep],
            color=colour,
            marker=marker,
            markersize=3.5,
            label=label,
        )
    right.set_xticks(frequencies, [str(f) for f in frequencies])
    right.minorticks_off()
    right.set(xlabel="frequency, hub held [Hz]", ylabel="ringing, rms [mrad]", title="the mode that nods")
    right.legend(frameon=False)
    for axes in (left, middle, right):
        axes.title.set_fontsize(8.5)
    with replacing(path) as partial:
        figure.savefig(partial, format="png")


def main() -> int:
    """Run the cases, print the tables, draw the figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one run of 0.2 s a case, to see that it works")
    parser.add_argument("--out", type=Path, help="folder for the figure, flexible.png")
    arguments = parser.parse_args()
    count, duration = (1, 0.2) if arguments.quick else (3, 5.0)
    found = {name: seen(name, count, duration) for name in PAIRS}
    print(f"medians of {count} run{'s' * (count > 1)} of {duration:g} s with play")
    print_table(ROWS, {label: column for one in found.values() for label, column in one.columns.items()}, 13)
    sweep = swept(count, duration)
    print("\nringing of a mode that nods, rms [mrad], by its frequency with the hub held [Hz]")
    print(" " * 8, *(f"{frequency:>9}" for frequency in sweep))
    for k, name in enumerate(("ideal", "play")):
        print(f"{name:<8}", *(f"{1e3 * pair[k]:>9.3g}" for pair in sweep.values()))
    if arguments.out is not None:
        draw(found["modes"], sweep, arguments.out / "flexible.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
