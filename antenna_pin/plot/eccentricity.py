"""How far the journal is from the bearing's centre, how deep it is pressed in, how much it tilts."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.analysis import journal_motion
from antenna_pin.base.arguments import takes
from antenna_pin.plot._blows import episodes_of, sharp
from antenna_pin.plot._kinds import TOUCHING, choose_joint
from antenna_pin.plot._layout import blocks, without_empty
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, smooth, too_short
from antenna_pin.plot._style import (
    COLOURS,
    MANY,
    PEAK,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import thinned

_NAMES = {"+": "end +", "-": "end \N{MINUS SIGN}", "centre": "centre"}
_LOOKS = {"+": (COLOURS[0], "-"), "-": (COLOURS[4], "-"), "centre": (COLOURS[0], "-")}
# Further panels, of a joint in which rigid parts can move so far only: variable, label, title, unit; limit of
# a sign or of a size.
_BOUNDED = (
    ("tilt", "tilt", "tilt", "rad", (1.0,)),
    ("axial", "axial place", "axial place", "m", (-1.0, 1.0)),
    ("twist", "turn", "turn about the axis", "rad", (-1.0, 1.0)),
)
_WORDS = {name: label for name, label, *_ in _BOUNDED}
_LIMIT: dict[str, Any] = {"color": "#666666", "linewidth": 0.6, "linestyle": ":", "zorder": 1.5}


@takes()
@styled
def figure_eccentricity(
    runs: Iterable[Run] | Run, *, joint: str | None = None, width: Width = "page"
) -> Figure:
    """Return eccentricity, penetration depth and further play of the journal over time, a column a run.

    The eccentricity is over the clearance: 1 where the surfaces touch. The depth's dots are the largest of
    every blow in the bore. Tilt, axial place, and turn about the axis are of joints in which they
    have a limit; dotted lines say how far rigid parts could go.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint with clearance; the first one if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    joint = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if joint in run.clearance_joints]
    curves = [thinned(smooth(run, joint), lambda part: _columns(part, joint)) for run in drawn]
    motions = [journal_motion(curve.data, joint) for curve in curves]
    bounded = [
        row for row in _BOUNDED if any(np.isfinite(motion.attrs[f"{row[0]}_limit"]) for motion in motions)
    ]
    figure, grid, letter = blocks(len(drawn), [True] * (2 + len(bounded)), width, 32.0)
    depths = [_depths(run, curve, joint) for run, curve in zip(drawn, curves, strict=True)]
    deepest = max(float(part.max(initial=0.0)) for sampled, _, peaks in depths for part in (sampled, peaks))
    depth, depth_unit = prefixed("m", deepest)
    labels = ["eccentricity /\nclearance [-]", f"depth [{depth_unit}]"]
    factors = []
    for name, label, _, unit, _ in bounded:
        factor, printed = prefixed(unit, _largest(motions, name))
        factors.append(factor)
        labels.append(f"{label} [{printed}]")
    without: dict[str, list[str]] = {}
    titles = ("eccentricity", "penetration", *(title for _, _, title, _, _ in bounded))
    for column, (run, curve, motion) in enumerate(zip(drawn, curves, motions, strict=True)):
        time = curve.time
        many = curve.many
        panels = [row[column] for row in grid]
        for number, place in enumerate(motion["place"].values):
            colour, line = _LOOKS[str(place)]
            ratio = motion["eccentricity_ratio"].values[:, number]
            panels[0].plot(
                time, ratio, line, color=colour, linewidth=0.5, label=_NAMES[str(place)], rasterized=many
            )
        panels[0].axhline(1.0, **_LIMIT)
        sampled, peak_time, peaks = depths[column]
        panels[1].plot(time, depth * sampled, color=COLOURS[0], linewidth=0.5, rasterized=many)
        panels[1].plot(
            peak_time,
            depth * peaks,
            ".",
            color=PEAK,
            markersize=2.4,
            markeredgewidth=0.0,
            label="largest of each blow",
            rasterized=peaks.size > MANY // 20,
        )
        for axes, factor, (name, _, _, _, sides) in zip(panels[2:], factors, bounded, strict=True):
            limit = motion.attrs[f"{name}_limit"]
            if not np.isfinite(limit):
                without.setdefault(name, []).append(run.label)
                continue
            axes.plot(time, factor * motion[name].values, color=COLOURS[0], linewidth=0.5, rasterized=many)
            for side in sides:
                axes.axhline(side * factor * limit, **_LIMIT)
        for axes, title in zip(panels, titles, strict=True):
            if not axes.lines:
                continue
            panel_title(axes, letter[axes], f"{run.label}, {title}")
            axes.set_xlim(run.time[0], run.time[-1])
            few_ticks(axes, 5, 4)
        panels[max(row for row, axes in enumerate(panels) if axes.lines)].set_xlabel("time [s]")
    for row, label in zip(grid, labels, strict=True):
        for axes in row:
            if axes.get_subplotspec().is_first_col():  # type: ignore[union-attr]
                axes.set_ylabel(label)
    without_empty(figure)
    figure.align_ylabels()
    legend_above(figure, figure.axes)
    footnote(
        figure,
        "dotted: what rigid parts allow",
        *(f"without a limit of the {_WORDS[name]}: {', '.join(runs)}" for name, runs in without.items()),
        too_short(every),
        left_out(every, drawn, "no clearance in this joint"),
    )
    return figure


def _columns(run: LabelledRun, joint: str) -> list[Array]:
    """Return all that is drawn of a run's samples."""
    motion = journal_motion(run.data, joint)
    names = ("eccentricity_ratio", *(name for name, *_ in _BOUNDED))
    return [_sampled_depth(run, joint), *(motion[name].values for name in names)]


def _sampled_depth(run: LabelledRun, joint: str) -> Array:
    """Return the largest depth in the bore over time [m]."""
    names = run.contacts_of(joint, flanges=False)
    depths = np.stack([run.values("depth", contact=name) for name in names], axis=1)
    return np.asarray(depths.max(axis=1))


def _largest(motions: list[xr.Dataset], name: str) -> float:
    """Return the largest size of a variable and of its limit, in the joints where it has one."""
    limited = [motion for motion in motions if np.isfinite(motion.attrs[f"{name}_limit"])]
    sizes = [np.append(np.abs(motion[name].values), motion.attrs[f"{name}_limit"]) for motion in limited]
    return float(np.nanmax(np.concatenate(sizes)))


def _depths(run: LabelledRun, curve: LabelledRun, joint: str) -> tuple[Array, Array, Array]:
    """Return the largest depth in the bore over time [m], and times [s] and depths [m] of the peaks."""
    names = run.contacts_of(joint, flanges=False)
    sampled = _sampled_depth(curve, joint)
    if run.data.sizes.get("episode", 0) == 0:
        return sampled, np.empty(0), np.empty(0)
    mine = episodes_of(run, names) & sharp(run, curve)
    return sampled, run.values("peak_time")[mine], run.values("peak_depth")[mine]


FIGURES = (
    RunFigure(
        name="eccentricity",
        title="Eccentricity and tilt in {joint}",
        function=figure_eccentricity,
        of=TOUCHING,
        compares=False,
    ),
)
