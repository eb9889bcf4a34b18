"""Controllers: what they measure and follow, and what they command, step by step as they are asked."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from antenna_pin.analysis import drives_of, effort_unit
from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import CONTROLLED, none_with
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, styles, too_short
from antenna_pin.plot._style import (
    MANY,
    SHADE,
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

__all__ = ["FIGURES", "figure_control"]

_REFERENCE: dict[str, Any] = {"color": "black", "linestyle": (0, (1.0, 1.0)), "linewidth": 0.9, "zorder": 4}
_SEEN = ("measured", "reference")
_MEASURES = {"angle": "rad", "rate": "rad/s", "base-rotation": "rad", "base-rate": "rad/s", "force": "N"}


@dataclass(frozen=True, slots=True, eq=False)
class _Line:
    """One signal of a run over time; of a sampled one each value holds until the next."""

    name: str
    time: Array  # [s]
    value: Array
    steps: bool


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """What one panel has of one run: its lines, their unit, and when limits held the command."""

    lines: Sequence[_Line]
    unit: str
    held: Sequence[tuple[float, float]] = ()


@takes()
@styled
def figure_control(runs: Iterable[Run] | Run, *, width: Width = "page") -> Figure:
    """Return what the controllers of all runs measure and follow, and beside it what they command.

    A sampled controller's numbers are those of its instants, each held until the next; commands are drawn
    from where they were given, before any delay. A drive that follows a reference all the time has smooth
    lines. References are dotted; the ground is grey while limits held a command.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    drawn = [run for run in long_enough(every) if CONTROLLED.holds(run)]
    if not drawn:
        raise none_with(CONTROLLED, every)
    panels: dict[str, dict[str, _Shown]] = {}
    for run in drawn:
        for title, shown in (*_sampled(run), *_continuous(run)):
            panels.setdefault(title, {})[run.label] = shown
    columns = 2 if width == "page" and len(panels) > 1 else 1
    rows = -(-len(panels) // columns)
    figure = new_figure(width, 12.0 + 42.0 * rows)
    grid = figure.add_gridspec(rows, columns)
    looks = dict(zip([run.label for run in drawn], styles(drawn, None), strict=True))
    for number, (letter, (title, by_run)) in enumerate(zip(letters(), panels.items(), strict=False)):
        alone = number == len(panels) - 1 and number % columns == 0
        axes = figure.add_subplot(grid[number // columns, :] if alone else grid[divmod(number, columns)])
        _draw(axes, by_run, looks, len(drawn) > 1)
        panel_title(axes, letter if len(panels) > 1 else "", title)
        if number + columns >= len(panels):
            axes.set_xlabel("time [s]")
    figure.align_ylabels()
    legend_above(figure, figure.axes)
    held = any(shown.held for by_run in panels.values() for shown in by_run.values())
    footnote(
        figure,
        "commands as they were given, before any delay" if any(_sampled(run) for run in drawn) else "",
        "grey: limits held the command" if held else "",
        too_short(every),
        left_out(every, drawn, f"without {CONTROLLED.words}"),
    )
    return figure


def _draw(axes: Axes, by_run: dict[str, _Shown], looks: dict[str, dict[str, Any]], several: bool) -> None:
    """Draw the lines of a panel; of several runs a colour is a run's, of one a line's."""
    values = [line.value for shown in by_run.values() for line in shown.lines]
    largest = max((float(np.nanmax(np.abs(one), initial=0.0)) for one in values), default=0.0)
    unit = next(shown.unit for shown in by_run.values())
    factor, printed = prefixed(unit, largest)
    palette = iter(looks[name] for name in looks) if several else None
    dashes = ("-", (0, (5.0, 1.5)), (0, (5.0, 1.0, 1.0, 1.0)))
    for label, shown in by_run.items():
        numbers = iter(range(len(shown.lines)))
        for line in shown.lines:
            if line.name == "reference":
                look, name = _REFERENCE, "reference"
            elif palette is not None:
                look = {**looks[label], "linestyle": dashes[next(numbers) % len(dashes)]}
                name = label
            else:
                look, name = {"color": f"C{next(numbers)}", "linewidth": 0.8}, line.name
            axes.plot(
                line.time,
                factor * line.value,
                label=name,
                drawstyle="steps-post" if line.steps else "default",
                rasterized=line.time.size > MANY,
                **look,
            )
        for begin, end in shown.held:
            axes.axvspan(begin, end, facecolor=SHADE, edgecolor="none", zorder=0.5)
    axes.set_ylabel(f"[{printed}]" if printed else "[SI]")
    few_ticks(axes, 6)


def _sampled(run: LabelledRun) -> list[tuple[str, _Shown]]:
    """Return titles of panels of a run's sampled controllers, and what is in them."""
    if "tick_signal" not in run.data:
        return []
    found = []
    which = run.values("tick_controller").astype(int)
    for number, name in enumerate(names_along(run.data, "sampled")):
        rows = which == number
        time = np.append(run.values("tick_time")[rows], run.time[-1])
        own = {
            signal.removeprefix(f"{name}."): np.append(values, values[-1:])
            for signal in names_along(run.data, "signal")
            if signal.startswith(f"{name}.")
            for values in [run.values("tick_signal", signal=signal)[rows]]
            if values.size
        }
        saturated = own.pop("saturated", np.zeros(time.size))
        for title, signals in _grouped(own):
            unit = _unit(run, name, signals[0])
            lines = [_Line(signal.removeprefix("command "), time, own[signal], True) for signal in signals]
            held = _spans(time, saturated > 0.0) if title == "command" else []
            found.append((f"{name}: {title}", _Shown(lines, unit, held)))
    return found


def _grouped(own: dict[str, Array]) -> Iterator[tuple[str, list[str]]]:
    """Yield what stands in one panel each: measured and reference, components of a vector, the commands."""
    seen = [name for name in _SEEN if name in own]
    if seen:
        yield " and ".join(seen), seen
    groups: dict[str, list[str]] = {}
    commands = [name for name in own if name.startswith("command ")]
    for name in own:
        if name not in seen and name not in commands:
            stem, _, axis = name.rpartition("_")
            groups.setdefault(stem if axis in ("x", "y", "z") else name, []).append(name)
    yield from groups.items()
    if commands:
        yield "command", commands


def _spans(time: Array, on: NDArray[np.bool_]) -> list[tuple[float, float]]:
    """Return from when to when something was on, from instant to instant."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], on[:-1].astype(int), [0]])))
    return [(float(time[a]), float(time[b])) for a, b in edges.reshape(-1, 2)]


def _unit(run: LabelledRun, controller: str, signal: str) -> str:
    """Return the unit of a signal, as far as the run's scenario tells; "" where it does not."""
    try:
        scenario = json.loads(run.data.attrs["scenario"])
        one = scenario["controllers"][controller]
    except (KeyError, TypeError, ValueError):
        return ""
    drives = scenario.get("drives", {})
    if signal.startswith("command "):
        return _unit_of_command(run, drives, signal.removeprefix("command "))
    if signal in _SEEN:
        measures = one.get("measures") or f"angle {_joint(drives, one.get('acts_on'))}"
    else:
        measures = {"error": "base-rotation x"}.get(signal, signal)
    what, _, joint = str(measures).partition(" ")
    slides = joint in run.sliding_joints
    return _MEASURES.get(what, "").replace("rad", "m" if slides else "rad")


def _joint(drives: dict[str, Any], name: Any) -> str:
    return str(drives.get(name, {}).get("joint", ""))


def _unit_of_command(run: LabelledRun, drives: dict[str, Any], name: str) -> str:
    """Return the unit of what is commanded: a torque or force, a voltage or current."""
    about = drives.get(name, {})
    if about.get("kind") == "motor":
        return "A" if about.get("mode") == "current" else "V"
    return effort_unit(run.data, name) if name in names_along(run.data, "drive") else ""


def _continuous(run: LabelledRun) -> list[tuple[str, _Shown]]:
    """Return panels of the drives that follow a reference all the time."""
    found = []
    for name in names_along(run.data, "controller"):
        if "control_reference" not in run.data:
            continue
        reference = run.values("control_reference", controller=name)
        measured = reference - run.values("control_error", controller=name)
        slides = bool(drives_of(run.data).get(name, {}).get("slides"))
        lines = [_Line("measured", run.time, measured, False), _Line("reference", run.time, reference, False)]
        found.append((f"{name}: measured and reference", _Shown(lines, "m" if slides else "rad")))
        if name in names_along(run.data, "drive"):
            effort = _Line("what it exerts", run.time, run.values("drive_torque", drive=name), False)
            words = f"{name}: what it exerts"
            found.append((words, _Shown([effort], effort_unit(run.data, name))))
    return found


FIGURES = (
    RunFigure(
        name="control",
        title="What controllers measure and command",
        function=figure_control,
        needs=CONTROLLED,
        compares=False,
    ),
)
