"""End stops and latches: where the joint is between them, what they exert, and when."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import STOPPED, none_with
from antenna_pin.plot._pairs import paired_panels
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, styles, too_short
from antenna_pin.plot._style import (
    PEAK,
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
from antenna_pin.trajectory import elements_of, mode_changes, names_along

# What is marked of changes, and how.
_MARKS = {"latched": "s", "refused": "x", "let go": "v", "bounces": "o", "rests": "s", "on": "o"}
_WINDOW = "#BBD7EA"
_BEYOND = 0.06  # of the way that is drawn, beyond it


@takes()
@styled
def figure_stops(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return the angle of each joint with stops or latches, and what these exert, in all runs.

    What lies beyond a stop is grey, a latch's window blue. Marks tell where a stop was touched or struck and
    where a latch captured, refused or let go.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [run for run in long_enough(every) if STOPPED.holds(run)]
    if not drawn:
        raise none_with(STOPPED, every)
    reference = next((run for run in drawn if run.ideal), None)
    drawn.sort(key=lambda run: run is reference)
    joints = list(dict.fromkeys(one["joint"] for run in drawn for one in _own(run).values()))
    drawn, reference = thinned_beside(
        drawn, reference, lambda run: [one for joint in joints for one in _columns(run, joint)]
    )
    figure, pairs = paired_panels(width, len(joints))
    letter = letters()
    looks = styles(drawn, reference)
    for (motion, effort), joint in zip(pairs, joints, strict=True):
        mine = [(run, look) for run, look in zip(drawn, looks, strict=True) if _of(run, joint)]
        _motion(motion, mine, joint)
        _effort(effort, mine, joint)
        panel_title(motion, next(letter), joint.replace("_", " "))
        panel_title(effort, next(letter), "what its stops and latches exert")
    legend_above(figure, [axes for axes, _ in pairs])
    footnote(
        figure,
        "grey: beyond a stop",
        "blue: window of a latch",
        *_said_of_marks(drawn),
        too_short(every),
        left_out(every, drawn, "without a stop or a latch"),
    )
    return figure


def _own(run: LabelledRun) -> dict[str, dict[str, Any]]:
    """Return the stops and latches of a run by place."""
    return {
        place: one for place, one in elements_of(run.data).items() if place.startswith(("stops.", "latches."))
    }


def _of(run: LabelledRun, joint: str) -> dict[str, dict[str, Any]]:
    return {place: one for place, one in _own(run).items() if one["joint"] == joint}


def _position(run: LabelledRun, joint: str) -> Array:
    if joint in names_along(run.data, "sliding_joint"):
        return run.values("slide_position", sliding_joint=joint)
    return run.values("motion_angle", joint=joint)


def _columns(run: LabelledRun, joint: str) -> list[Array]:
    efforts = [run.values("element_effort", element=place) for place in _of(run, joint)]
    return [_position(run, joint), *efforts] if efforts else []


def _motion(axes: Axes, runs: Sequence[tuple[LabelledRun, dict[str, Any]]], joint: str) -> None:
    """Draw the way of a joint, what bounds it, and what happened."""
    places = [one for run, _ in runs for one in _of(run, joint).items()]
    values = [_position(run, joint) for run, _ in runs]
    numbers = [number for _, one in places for number in one["numbers"].values()]
    low, high = (float(pick([*(pick(one) for one in values), *numbers])) for pick in (np.min, np.max))
    room = _BEYOND * ((high - low) or 1.0)
    low, high = low - room, high + room
    factor, printed = prefixed("m" if places[0][1]["slides"] else "rad", max(abs(low), abs(high)))
    for place, one in dict(places).items():
        lower, upper = (one["numbers"].get(side) for side in ("lower", "upper"))
        if place.startswith("latches."):
            axes.axhspan(factor * lower, factor * upper, color=_WINDOW, linewidth=0.0, zorder=0)
            continue
        for begin, end in ((low, lower), (upper, high)):
            if begin is not None and end is not None:
                axes.axhspan(factor * begin, factor * end, color=SHADE, linewidth=0.0, zorder=0)
    for (run, look), value in zip(runs, values, strict=True):
        axes.plot(run.time, factor * value, label=run.legend, rasterized=run.many, **look)
        for mark, (time, angle) in _happened(run, joint).items():
            colour = look.get("color", "black")
            looks: dict[str, Any] = {"edgecolors": colour, "facecolors": "none"}
            if mark == "x":
                looks = {"color": PEAK}
            axes.scatter(time, factor * angle, s=14.0, marker=mark, linewidths=0.8, zorder=6, **looks)
    axes.set_ylim(factor * low, factor * high)
    slides = bool(places[0][1]["slides"])
    axes.set_ylabel(f"{'position' if slides else 'angle'} [{printed}]")
    few_ticks(axes, 5)


def _happened(run: LabelledRun, joint: str) -> dict[str, tuple[Array, Array]]:
    """Return times and angles of what is marked of a joint, by mark."""
    found: dict[str, list[tuple[float, float]]] = {}
    for family in ("stops", "latches"):
        for change in mode_changes(run.whole.data, family):
            mark = _MARKS.get(change.what.rpartition(": ")[2])
            if mark is not None and change.element in _of(run, joint):
                found.setdefault(mark, []).append((change.time, change.angle))
    return {
        mark: (np.array([t for t, _ in pairs]), np.array([angle for _, angle in pairs]))
        for mark, pairs in found.items()
    }


def _said_of_marks(runs: Sequence[LabelledRun]) -> tuple[str, ...]:
    """Return what the marks that are there mean."""
    seen = {
        change.what.rpartition(": ")[2]
        for run in runs
        for family in ("stops", "latches")
        for change in mode_changes(run.whole.data, family)
    }
    words = (
        ("circles: touches", {"on", "bounces"}),
        ("squares: captures, at rest", {"latched", "rests"}),
        ("crosses: refusals", {"refused"}),
        ("triangles: let go", {"let go"}),
    )
    return tuple(text for text, what in words if what & seen)


def _effort(axes: Axes, runs: Sequence[tuple[LabelledRun, dict[str, Any]]], joint: str) -> None:
    """Draw what the stops and latches of a joint exert in all."""
    sums = [
        np.sum([run.values("element_effort", element=place) for place in _of(run, joint)], axis=0)
        for run, _ in runs
    ]
    slides = next(one["slides"] for one in _of(runs[0][0], joint).values())
    largest = max(float(np.abs(one).max()) for one in sums)
    factor, printed = prefixed("N" if slides else "N m", largest)
    for (run, look), total in zip(runs, sums, strict=True):
        axes.plot(run.time, factor * total, rasterized=run.many, **look)
    axes.set_ylabel(f"{'force' if slides else 'torque'} [{printed}]")
    few_ticks(axes, 5)


FIGURES = (
    RunFigure(
        name="stops",
        title="End stops and latches",
        function=figure_stops,
        needs=STOPPED,
    ),
)
