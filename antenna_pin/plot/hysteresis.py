"""Torque over angle of springs that have a table, hysteresis or a constant torque."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import TRACED, none_with
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, styles, too_short
from antenna_pin.plot._style import (
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.trajectory import names_along


@takes()
@styled
def figure_hysteresis(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return torque over angle of springs with a table, hysteresis or a constant torque, a panel each.

    The area inside a loop is the heat of a cycle. A dot marks where a run begins.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [run for run in long_enough(every) if TRACED.holds(run)]
    if not drawn:
        raise none_with(TRACED, every)
    names = list(dict.fromkeys(name for run in drawn for name in names_along(run.data, "traced_spring")))
    columns = 2 if width == "page" and len(names) > 1 else 1
    rows = -(-len(names) // columns)
    figure = new_figure(width, 12.0 + 58.0 * rows)
    grid = figure.subplots(rows, columns, squeeze=False).ravel()
    letter = letters()
    for axes, name in zip(grid, names, strict=False):
        _panel(axes, drawn, name)
        panel_title(axes, next(letter), name.replace("_", " "))
    for axes in grid[len(names) :]:
        axes.remove()
    legend_above(figure, grid[: len(names)])
    footnote(
        figure,
        "the area inside a loop is the heat of a cycle",
        too_short(every),
        left_out(every, drawn, f"without {TRACED.words}"),
    )
    return figure


def _panel(axes: Axes, runs: Sequence[LabelledRun], name: str) -> None:
    looks = styles(runs, None)
    mine = [
        (run, look)
        for run, look in zip(runs, looks, strict=True)
        if name in names_along(run.data, "traced_spring")
    ]
    curves = [_torque_over_angle(run, name) for run, _ in mine]
    slides = any(sliding for _, _, sliding in curves)
    far = max(float(np.abs(angle).max(initial=0.0)) for angle, _, _ in curves)
    most = max(float(np.abs(torque).max(initial=0.0)) for _, torque, _ in curves)
    along, along_unit = prefixed("m" if slides else "rad", far)
    across, across_unit = prefixed("N" if slides else "N m", most)
    for (run, look), (angle, torque, _) in zip(mine, curves, strict=True):
        axes.plot(along * angle, across * torque, label=run.legend, rasterized=run.many, **look)
        axes.plot(along * angle[:1], across * torque[:1], ".", color=look.get("color"), markersize=4)
    axes.set_xlabel(f"{'way' if slides else 'angle'} [{along_unit}]")
    axes.set_ylabel(f"{'force' if slides else 'torque'} [{across_unit}]")
    axes.margins(0.03)
    few_ticks(axes, 5)


def _torque_over_angle(run: LabelledRun, name: str) -> tuple[Array, Array, bool]:
    """Return the angle of a spring's joint, its torque, and whether the joint slides."""
    springs = names_along(run.data, "traced_spring")
    joint = names_along(run.data, "traced_joint")[springs.index(name)]
    torque = run.values("spring_torque", traced_spring=name)
    if joint in run.sliding_joints:
        return run.values("slide_position", sliding_joint=joint), torque, True
    return run.values("motion_angle", joint=joint), torque, False


FIGURES = (
    RunFigure(
        name="hysteresis",
        title="Torque of springs over angle",
        function=figure_hysteresis,
        needs=TRACED,
        compares=False,
    ),
)
