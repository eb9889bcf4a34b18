"""Forces in a joint with clearance, as in the Figures 11 to 13 of Bai and Zhao (2020)."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis import is_round_off, round_off_scales
from antenna_pin.base.arguments import takes
from antenna_pin.geometry import LOOKS
from antenna_pin.plot._blows import draw_blow, episodes_of, sharp, strongest_blow
from antenna_pin.plot._kinds import TOUCHING, choose_joint
from antenna_pin.plot._layout import blocks, without_empty
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, long_enough, smooth, too_short
from antenna_pin.plot._style import (
    COLOURS,
    PEAK,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    panel_title,
    prefixed,
    styled,
    three_digits,
)
from antenna_pin.plot._thinned import closer, thinned
from antenna_pin.trajectory import contact_ends, contact_kinds

_SAMPLED = "resultant on the journal"
_PEAKS = "peak normal force of each blow"
_SIGNS = {"-": " \N{MINUS SIGN}", "+": " +", "": ""}


@takes()
@styled
def figure_contact_forces(
    runs: Iterable[Run] | Run, *, joint: str | None = None, width: Width = "page"
) -> Figure:
    """Return the radial and axial forces on the journal, and the strongest blow from near, a column a run.

    The line is the resultant of all contacts, a smooth one through the samples: its size across the bearing's
    axis, and its component along that axis. The peak normal force of every blow is drawn as a stem: a line to
    the peak and a dot on it; an axial peak carries the sign of its flange. The close view has the normal
    forces of all contacts in the strongest blow. What a run has none of, or to round-off only, is said below.

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
    blows = [strongest_blow(run, curve, joint) for run, curve in zip(drawn, curves, strict=True)]
    curves = [
        closer(curve, blow.window if blow else None, lambda part: _resultant(part, joint, kinds).values())
        for curve, blow in zip(curves, blows, strict=True)
    ]
    resultants = [dict(_resultant(curve, joint, kinds)) for curve in curves]
    peaks = [
        {kind: _peaks(run, curve, joint, kind) for kind in kinds}
        for run, curve in zip(drawn, curves, strict=True)
    ]
    sizes = [
        {kind: max(_largest(force[kind]), _largest(peak[kind][1])) for kind in kinds}
        for force, peak in zip(resultants, peaks, strict=True)
    ]
    scales = round_off_scales(*(run.whole.data for run in drawn))
    still = [
        (run.label, kind)
        for run, size in zip(drawn, sizes, strict=True)
        for kind in kinds
        if size[kind] == 0.0 or is_round_off(size[kind], "N", scales)
    ]
    rows = [kind for kind in kinds if any((run.label, kind) not in still for run in drawn)] or list(kinds[:1])
    shared = [_comparable([size[kind] for size in sizes]) for kind in rows]
    near = [False] * any(blows)
    figure, grid, letter = blocks(len(drawn), [*shared, *near], width, 38.0)
    unit = drawn[0].unit("joint_force", "N")
    for row, kind in enumerate(rows):
        factor, printed = prefixed(unit, max(size[kind] for size in sizes))
        for axes, run, curve, resultant, peak in zip(
            grid[row], drawn, curves, resultants, peaks, strict=True
        ):
            axes.set_ylabel(f"{kind} force [{printed}]" if axes.get_subplotspec().is_first_col() else "")  # type: ignore[union-attr]
            if (run.label, kind) in still and len(rows) * len(drawn) > 1:
                continue
            axes.plot(
                curve.time,
                factor * resultant[kind],
                color=COLOURS[0],
                linewidth=0.6,
                label=_SAMPLED,
                zorder=3,
                rasterized=curve.many,
            )
            _stems(axes, *peak[kind], factor)
            few_ticks(axes, 5)
            axes.axhline(0.0, color="#999999", linewidth=0.5, zorder=1.5)
            panel_title(axes, letter[axes] if len(letter) > 1 else "", f"{run.label}, {kind}")
            below = grid[row + 1 : len(rows)]
            if not below or (run.label, rows[row + 1]) in still:
                axes.set_xlabel("time [s]")
    if near:
        names = _names(drawn, joint)
        for axes, run, curve, blow in zip(grid[-1], drawn, curves, blows, strict=True):
            if blow is None:
                continue
            draw_blow(axes, curve, blow, names)
            factor, printed = prefixed(unit, blow.force)
            words = f"{run.label}, strongest blow: {three_digits(factor * blow.force)} {printed}"
            panel_title(axes, letter[axes], words)
            if not axes.get_subplotspec().is_first_col():  # type: ignore[union-attr]
                axes.set_ylabel("")
    without_empty(figure)
    figure.align_ylabels()
    legend_above(figure, figure.axes)
    footnote(figure, _said(drawn, joint, still), too_short(every))
    return figure


def _largest(values: Array) -> float:
    return float(np.nanmax(np.abs(values), initial=0.0))


def _names(runs: list[LabelledRun], joint: str) -> dict[str, str]:
    """Return what the contacts of a joint are called in a legend."""
    found = {}
    for run in runs:
        kinds, ends = contact_kinds(run.data), contact_ends(run.data)
        for name in run.contacts_of(joint):
            kind = kinds[name].replace("_", " ")
            found[name] = f"normal force, {kind}{_SIGNS.get(ends[name], ' ' + ends[name])}"
    return found


def _said(runs: list[LabelledRun], joint: str, still: list[tuple[str, str]]) -> str:
    """Return what runs have none of, in words."""
    if not still:
        return ""
    by_name = {run.label: run for run in runs}
    parts = []
    for label, kind in still:
        can = by_name[label].contacts_of(joint, flanges=True) or kind != "axial"
        parts.append(f"{label}, {kind}{'' if can else ' (no such contact in this joint)'}")
    return f"zero to round-off: {'; '.join(parts)}"


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


def _peaks(run: LabelledRun, curve: LabelledRun, joint: str, kind: str) -> tuple[Array, Array]:
    """Return times [s] and signed peak normal forces [N] of the blows of one kind of contact."""
    if run.data.sizes.get("episode", 0) == 0:
        return np.empty(0), np.empty(0)
    names, ends = run.contacts, contact_ends(run.data)
    mine = run.contacts_of(joint, flanges=None if kind == "contact" else kind == "axial")
    of_kind = episodes_of(run, mine) & sharp(run, curve)
    index = run.values("episode_contact").astype(int)[of_kind]
    # The bearing pushes the journal along its axis at the + end, against it at the - end.
    negative = np.array([kind == "axial" and ends[names[i]] == "-" for i in index], dtype=bool)
    force = run.values("peak_force")[of_kind]
    return run.values("peak_time")[of_kind], np.where(negative, -force, force)


def _stems(axes: Axes, time: Array, force: Array, factor: float) -> None:
    """Draw a line from zero to each peak, and a dot on it."""
    if not time.size:
        return
    many = time.size > 2_000
    # One line with gaps takes a third of the room of as many lines.
    stems = np.stack([np.zeros_like(force), factor * force, np.full_like(force, np.nan)], axis=1)
    looks: dict[str, Any] = {"color": PEAK, "linewidth": 0.35, "alpha": 0.55, "zorder": 2}
    axes.plot(np.repeat(time, 3), stems.ravel(), rasterized=many, **looks)
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
