"""Forces in a joint with clearance, as in the Figures 11 to 13 of Bai and Zhao (2020)."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis import is_round_off, round_off_scales
from antenna_pin.arguments import takes
from antenna_pin.geometry import LOOKS
from antenna_pin.plot._kinds import TOUCHING, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import (
    LabelledRun,
    Run,
    labelled,
    long_enough,
    smooth,
    too_short,
)
from antenna_pin.plot._style import (
    COLOURS,
    PEAK,
    Array,
    Width,
    blocks,
    few_ticks,
    footnote,
    legend_above,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import thinned
from antenna_pin.trajectory import contact_ends, contact_kinds

_SAMPLED = "resultant on the journal"
_PEAKS = "peak normal force of each contact episode"


@takes()
@styled
def figure_contact_forces(
    runs: Iterable[Run] | Run, *, joint: str | None = None, width: Width = "page"
) -> Figure:
    """Return the radial and axial forces on the journal over time, one column per run that has contact.

    The line is the resultant of all contacts, a smooth one through the samples: its size across the bearing's
    axis, and its component along that axis. The peak normal force of every contact episode is drawn as a
    stem: a line to the peak and a dot on it. An axial peak carries the sign of its flange.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint with clearance; the first one if left out.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    joint = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if joint in run.clearance_joints]
    kinds = _kinds(drawn, joint)
    curves = [
        thinned(smooth(run, joint), lambda part: _resultant(part, joint, kinds).values()) for run in drawn
    ]
    resultants = [dict(_resultant(curve, joint, kinds)) for curve in curves]
    peaks = [{kind: _peaks(run, joint, kind) for kind in kinds} for run in drawn]
    scales = round_off_scales(*(run.whole.data for run in drawn))
    still: dict[str, None] = {}
    for run, resultant, peak in zip(drawn, resultants, peaks, strict=True):
        for kind in kinds:
            size = max(float(np.nanmax(np.abs(one), initial=0.0)) for one in (resultant[kind], peak[kind][1]))
            if is_round_off(size, "N", scales):
                still[f"{run.label}, {kind}"] = None
                resultant[kind] = np.zeros_like(resultant[kind])
                peak[kind] = np.empty(0), np.empty(0)
    sizes = {
        kind: [
            max(float(np.nanmax(np.abs(part), initial=0.0)) for part in (resultant[kind], peak[kind][1]))
            for resultant, peak in zip(resultants, peaks, strict=True)
        ]
        for kind in kinds
    }
    figure, grid, letter = blocks(len(drawn), [_comparable(sizes[kind]) for kind in kinds], width, 42.0)
    unit = drawn[0].unit("joint_force", "N")
    for row, kind in enumerate(kinds):
        factor, printed = prefixed(unit, max(sizes[kind]))
        for column, (axes, run) in enumerate(zip(grid[row], drawn, strict=True)):
            axes.plot(
                curves[column].time,
                factor * resultants[column][kind],
                color=COLOURS[0],
                linewidth=0.6,
                label=_SAMPLED,
                zorder=3,
                rasterized=curves[column].many,
            )
            _stems(axes, *peaks[column][kind], factor)
            few_ticks(axes, 5)
            if kind == "axial" and not run.contacts_of(joint, flanges=True):
                if axes.get_shared_y_axes().get_siblings(axes) == [axes]:
                    axes.set_yticks([0.0])
                axes.text(
                    0.5,
                    0.7,
                    f"no {kind} contact in this joint",
                    transform=axes.transAxes,
                    ha="center",
                    va="center",
                    bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8},
                )
            title = f"{run.label}, {kind}"
            panel_title(axes, letter[axes] if len(letter) > 1 else "", title)
            if row == len(kinds) - 1:
                axes.set_xlabel("time [s]")
            if axes.get_subplotspec().is_first_col():  # type: ignore[union-attr]
                axes.set_ylabel(f"{kind} force [{printed}]")
            axes.axhline(0.0, color="#999999", linewidth=0.5, zorder=1.5)
    figure.align_ylabels()
    legend_above(figure, figure.axes)
    footnote(figure, f"zero to round-off: {'; '.join(still)}" if still else "", too_short(every))
    return figure


def _comparable(sizes: list[float]) -> bool:
    """True where one scale shows all runs; on the scale of a far harder run the others would be flat."""
    touched = [size for size in sizes if size > 0.0]
    return not touched or min(touched) > 0.15 * max(touched)


def _kinds(runs: list[LabelledRun], joint: str) -> tuple[str, ...]:
    """Return the rows for the contacts that the joint has in any run."""
    found = {contact_kinds(run.data)[name] for run in runs for name in run.contacts_of(joint)}
    return next((look.rows for look in LOOKS.values() if look.contacts <= found), ("radial",))


def _resultant(run: LabelledRun, joint: str, kinds: tuple[str, ...]) -> dict[str, Array]:
    """Return the force on the journal: its size across the bearing's axis, its component along it [N].

    With a ball among the runs, the size of the whole.
    """
    force = run.values("joint_force", clearance_joint=joint)
    if kinds == ("contact",):
        return {"contact": np.linalg.norm(force, axis=1)}
    across = np.hypot(force[:, 0], force[:, 1])
    return {"radial": across, "transverse": across, "axial": force[:, 2]}


def _peaks(run: LabelledRun, joint: str, kind: str) -> tuple[Array, Array]:
    """Return times [s] and signed peak normal forces [N] of the episodes of one kind of contact."""
    if run.data.sizes.get("episode", 0) == 0:
        return np.empty(0), np.empty(0)
    names, ends = run.contacts, contact_ends(run.data)
    index = run.values("episode_contact").astype(int)
    mine = run.contacts_of(joint, flanges=None if kind == "contact" else kind == "axial")
    of_kind = np.isin(index, [names.index(name) for name in mine])
    # The bearing pushes the journal along its axis at the + end, against it at the - end.
    negative = np.array([kind == "axial" and ends[names[i]] == "-" for i in index[of_kind]], dtype=bool)
    force = run.values("peak_force")[of_kind]
    time = run.values("peak_time")[of_kind]
    known = np.isfinite(force) & np.isfinite(time)
    return time[known], np.where(negative, -force, force)[known]


def _stems(axes: Axes, time: Array, force: Array, factor: float) -> None:
    """Draw a line from zero to each peak, and a dot on it."""
    if not time.size:
        return
    many = time.size > 2_000
    axes.vlines(time, 0.0, factor * force, colors=PEAK, linewidth=0.35, alpha=0.55, zorder=2, rasterized=many)
    axes.plot(
        time,
        factor * force,
        linestyle="none",
        marker=".",
        markersize=2.4,
        markeredgewidth=0.0,
        color=PEAK,
        label=_PEAKS,
        zorder=2.5,
        rasterized=many,
    )


FIGURES = (
    RunFigure(
        name="contact_forces",
        title="Contact forces in {joint}",
        function=figure_contact_forces,
        of=TOUCHING,
        compares=False,
    ),
)
