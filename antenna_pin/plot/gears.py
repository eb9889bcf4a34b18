"""Gears, belts and cables: how the deflection goes through the play, and what flanks and strands exert."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import GEARED, none_with
from antenna_pin.plot._pairs import paired_panels
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, styles, too_short
from antenna_pin.plot._style import (
    SHADE,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._thinned import thinned_beside
from antenna_pin.trajectory import elements_of, mesh_touches

_TAUT = "#BBD7EA"
_ROOM = 0.06  # of what is drawn, beyond it
_MOST_MARKS = 200  # more would be a band


@takes()
@styled
def figure_gears(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return the deflection of each gear, belt and cable, and what it exerts, in all runs.

    Within the play, where nothing is in contact, the ground is grey; where both strands of a belt are taut it
    is blue. Circles tell where a flank came into contact, or a strand became taut.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [run for run in long_enough(every) if GEARED.holds(run)]
    if not drawn:
        raise none_with(GEARED, every)
    places = list(dict.fromkeys(place for run in drawn for place in _own(run)))
    drawn, _ = thinned_beside(
        drawn, None, lambda run: [one for place in _own(run) for one in _curves(run, place)]
    )
    figure, pairs = paired_panels(width, len(places))
    letter = letters()
    looks = styles(drawn, None)
    for (motion, effort), place in zip(pairs, places, strict=True):
        mine = [(run, look) for run, look in zip(drawn, looks, strict=True) if place in _own(run)]
        _deflection(motion, mine, place)
        _effort(effort, mine, place)
        panel_title(motion, next(letter), place.partition(".")[2].replace("_", " "))
        panel_title(effort, next(letter), "what it exerts along the deflection")
    legend_above(figure, [axes for axes, _ in pairs])
    grounds = [_grounds(run, place) for run in drawn for place in _own(run)]
    marks = sum(len(_onsets(run, place)) for run in drawn for place in _own(run))
    footnote(
        figure,
        "grey: nothing in contact" if any(low < high for low, high, taut in grounds if not taut) else "",
        "blue: both strands taut" if any(low < high for low, high, taut in grounds if taut) else "",
        "circles: touches" if 0 < marks else "",
        too_short(every),
        left_out(every, drawn, f"without {GEARED.words}"),
    )
    return figure


def _own(run: LabelledRun) -> dict[str, dict[str, Any]]:
    """Return the gears, belts and cables of a run by place."""
    return {place: one for place, one in elements_of(run.data).items() if place.startswith("gears.")}


def _curves(run: LabelledRun, place: str) -> list[Array]:
    return [run.values(f"element_{name}", element=place) for name in ("deflection", "effort")]


def _grounds(run: LabelledRun, place: str) -> tuple[float, float, bool]:
    """Return between which deflections nothing is in contact, or (True) both strands are taut."""
    numbers = _own(run)[place]["numbers"]
    if "plus" not in numbers:
        return 0.0, 0.0, False
    plus, minus = numbers["plus"], numbers.get("minus", -np.inf)
    return (plus, minus, True) if plus < minus else (minus, plus, False)


def _onsets(run: LabelledRun, place: str) -> list[tuple[float, float]]:
    """Return time and deflection of the touches; none where they would be a band."""
    numbers = _own(run)[place]["numbers"]
    found = [(one.onset, numbers[one.side]) for one in mesh_touches(run.whole.data) if one.stop == place]
    return found if len(found) <= _MOST_MARKS else []


def _deflection(axes: Axes, runs: Sequence[tuple[LabelledRun, dict[str, Any]]], place: str) -> None:
    """Draw the way through the play."""
    values = [_curves(run, place)[0] for run, _ in runs]
    grounds = {_grounds(run, place) for run, _ in runs}
    edges = [edge for low, high, _ in grounds for edge in (low, high) if np.isfinite(edge)]
    low, high = (float(pick([*(pick(one) for one in values), *edges])) for pick in (np.min, np.max))
    room = _ROOM * ((high - low) or 1.0)
    low, high = low - room, high + room
    slides = bool(_own(runs[0][0])[place]["slides"])
    factor, printed = prefixed("m" if slides else "rad", max(abs(low), abs(high)))
    for begin, end, taut in grounds:
        if begin < end:
            colour = _TAUT if taut else SHADE
            begin, end = factor * max(begin, low), factor * min(end, high)
            axes.axhspan(begin, end, color=colour, linewidth=0.0, zorder=0)
    for (run, look), value in zip(runs, values, strict=True):
        axes.plot(run.time, factor * value, label=run.label, rasterized=run.many, **look)
        onsets = np.array(_onsets(run, place)).reshape(-1, 2)
        axes.scatter(
            onsets[:, 0],
            factor * onsets[:, 1],
            s=14.0,
            marker="o",
            linewidths=0.8,
            zorder=6,
            edgecolors=look.get("color", "black"),
            facecolors="none",
        )
    axes.set_ylim(factor * low, factor * high)
    axes.set_ylabel(f"deflection [{printed}]")
    few_ticks(axes, 5)


def _effort(axes: Axes, runs: Sequence[tuple[LabelledRun, dict[str, Any]]], place: str) -> None:
    """Draw what it exerts."""
    efforts = [_curves(run, place)[1] for run, _ in runs]
    slides = bool(_own(runs[0][0])[place]["slides"])
    factor, printed = prefixed("N" if slides else "N m", max(float(np.abs(one).max()) for one in efforts))
    for (run, look), effort in zip(runs, efforts, strict=True):
        axes.plot(run.time, factor * effort, rasterized=run.many, **look)
    axes.set_ylabel(f"{'force' if slides else 'torque'} [{printed}]")
    few_ticks(axes, 5)


FIGURES = (
    RunFigure(
        name="gears",
        title="Gears, belts and cables",
        function=figure_gears,
        needs=GEARED,
    ),
)
