"""One small picture of what runs came to: a joint's motion, and the blows that it took."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import SLIDING, TOUCHING, TURNING, choose_joint, none_with
from antenna_pin.plot._runs import LabelledRun, Run, long_enough, styles, with_reference
from antenna_pin.plot._style import (
    MANY,
    Array,
    few_ticks,
    legend_above,
    literal,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import thinned_beside

__all__ = ["figure_glance"]


@takes()
@styled
def figure_glance(runs: Iterable[Run], *, joint: str | None = None) -> Figure:
    """Return the position of a joint in all runs and, where it has play, the peak force of every contact.

    It is of a column's width (88 mm), for the head of a page. A ball joint has no position, but peaks.

    Args:
        runs: Trajectories, or pairs of a label and a dataset; of any lengths.
        joint: Name of the joint; the first one with clearance if left out.
    """
    every, reference = with_reference(runs, None)
    if joint is not None and not any(joint in (*run.joints, *run.sliding_joints) for run in every):
        return _of_peaks(every, reference, joint)
    slides = not any(run.joints for run in every) if joint is None else _slides(every, joint)
    kind, variable, dimension, word, unit = (
        (SLIDING, "slide_position", "sliding_joint", "position", "m")
        if slides
        else (TURNING, "motion_angle", "joint", "angle", "rad")
    )
    name = choose_joint(kind, every, joint)
    drawn, reference = thinned_beside(
        [run for run in long_enough(every) if name in kind.names(run)],
        reference,
        lambda run: [run.values(variable, **{dimension: name})],
    )
    struck = [run for run in drawn if _peaks(run, name)[0].size]
    figure = new_figure("column", 58.0 if struck else 44.0)
    panels = figure.subplots(2 if struck else 1, 1, squeeze=False, sharex=True)[:, 0]
    looks = styles(drawn, reference)
    _positions(panels[0], drawn, looks, (variable, dimension, name), unit)
    panels[0].set_ylabel(f"{word} [{unit}]" if not slides else panels[0].get_ylabel())
    panel_title(panels[0], "", f"{name}, {word}")
    if struck:
        _blows(panels[1], drawn, looks, name)
    panels[-1].set_xlabel("time [s]")
    legend_above(figure, [panels[0]])
    return figure


def _of_peaks(every: list[LabelledRun], reference: LabelledRun | None, joint: str) -> Figure:
    """Return the peaks of every contact in a joint that has no position."""
    name = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if _peaks(run, name)[0].size]
    if not drawn:
        raise none_with(TOUCHING, every)
    figure = new_figure("column", 44.0)
    axes = figure.subplots()
    _blows(axes, drawn, styles(drawn, reference), name)
    axes.set_xlim(min(run.time[0] for run in drawn), max(run.time[-1] for run in drawn))
    axes.set_xlabel("time [s]")
    legend_above(figure, [axes])
    return figure


def _blows(axes: Axes, runs: list[LabelledRun], looks: list[dict[str, Any]], joint: str) -> None:
    """Draw the peak of every contact in a joint as a line from zero."""
    peaks = [_peaks(run, joint) for run in runs]
    factor, printed = prefixed("N", max(float(force.max(initial=0.0)) for _, force in peaks))
    for run, (time, force), look in zip(runs, peaks, looks, strict=True):
        many = time.size > MANY
        axes.vlines(
            time,
            0.0,
            factor * force,
            colors=look["color"],
            linewidth=0.6,
            rasterized=many,
            label=run.legend,
        )
    axes.set_ylim(bottom=0.0)
    axes.set_ylabel(f"force [{printed}]")
    panel_title(axes, "", f"{joint}, peak of every contact")
    few_ticks(axes, 6, 3)


def _slides(runs: list[LabelledRun], joint: str) -> bool:
    return any(joint in run.sliding_joints for run in runs)


def _positions(
    axes: Axes, runs: list[LabelledRun], looks: list[dict[str, Any]], where: tuple[str, str, str], unit: str
) -> None:
    """Draw a joint's position in every run."""
    variable, dimension, name = where
    values = [run.values(variable, **{dimension: name}) for run in runs]
    largest = max(float(np.nanmax(np.abs(one), initial=0.0)) for one in values)
    factor, printed = prefixed(unit, largest) if unit == "m" else (1.0, unit)
    for run, value, look in zip(runs, values, looks, strict=True):
        axes.plot(run.time, factor * value, label=run.legend, rasterized=run.many, **look)
    axes.set_ylabel(literal(f"position [{printed}]"))
    few_ticks(axes, 6, 3)


def _peaks(run: LabelledRun, joint: str) -> tuple[Array, Array]:
    """Return times [s] and sizes [N] of the peaks of the contacts in a joint."""
    if joint not in run.clearance_joints or run.whole.data.sizes.get("episode", 0) == 0:
        return np.empty(0), np.empty(0)
    mine = [run.contacts.index(name) for name in run.contacts_of(joint)]
    its = np.isin(run.values("episode_contact").astype(int), mine)
    time, force = run.values("peak_time")[its], run.values("peak_force")[its]
    known = np.isfinite(time) & np.isfinite(force)
    return time[known], force[known]
