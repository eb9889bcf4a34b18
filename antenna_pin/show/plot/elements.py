"""Motion and efforts of stops, latches, gears, flexible links, springs and controllers."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis import drives_of, effort_unit, elastic_parts_of
from antenna_pin.errors import AntennaPinError
from antenna_pin.show.plot._compared import Picked, pick
from antenna_pin.show.plot._kinds import CONTROLLED, FLEXIBLE, GEARED, STOPPED, TRACED, RunFigure
from antenna_pin.show.plot._runs import LabelledRun, Runs, spectrum_of, unit_of
from antenna_pin.show.plot._style import PEAK, SHADE, Array, Width
from antenna_pin.show.plot.grammar import (
    COLUMN_OR_PAGE,
    Axis,
    ByHand,
    Ground,
    Panel,
    PlotCurve,
    PlotMark,
    Points,
    Rule,
    Sheet,
    figure,
    in_pairs,
    in_rows,
    largest_of,
)
from antenna_pin.trajectory import elements_of, mesh_touches, mode_changes, names_along

_BLUE = "#BBD7EA"
_BEYOND = 0.06  # of what is drawn, beyond it
_About = dict[str, dict[str, Any]]


def _own(run: LabelledRun, *families: str, joint: str | None = None) -> _About:
    """Return the elements of some families, or of one joint, by place."""
    every = elements_of(run.data).items()
    mine = ((place, one) for place, one in every if place.partition(".")[0] in families)
    return {place: one for place, one in mine if joint in (None, one["joint"])}


def _first_ideal_last(picked: Picked) -> Picked:
    """Return runs with the first ideal one as the reference."""
    reference = next((run for run in picked.drawn if run.ideal), None)
    drawn = sorted(picked.drawn, key=lambda run: run is reference)
    return replace(picked, drawn=drawn, reference=reference)


def _paired(pairs: Sequence[tuple[Panel, Panel]], width: Width, notes: Sequence[str]) -> Sheet:
    """Return pairs of panels: a motion, and beside it the effort."""
    rows = in_pairs(pairs, width)
    return Sheet(rows, width, 12.0 + 44.0 * len(rows), notes, every=width == "column")


def _within_bounds(
    title: str,
    curves: list[PlotCurve],
    grounds: Iterable[tuple[float, float, str]],
    edges: list[float],
    y: Axis,
) -> Panel:
    """Return curves on coloured grounds, with a margin around all that is drawn."""
    values = [one.y for one in curves]
    low, high = (float(pick([*(pick(one) for one in values), *edges])) for pick in (np.min, np.max))
    room = _BEYOND * ((high - low) or 1.0)
    low, high = low - room, high + room
    marks: list[PlotMark] = [
        Ground(max(begin, low), min(end, high), {"color": colour, "linewidth": 0.0, "zorder": 0}, "y")
        for begin, end, colour in grounds
    ]
    return Panel(title, [*marks, *curves], replace(y, largest=max(abs(low), abs(high)), limits=(low, high)))


def _with_efforts(
    motion: Panel, points: Iterable[Points], title: str, efforts: Iterable[PlotCurve], slides: bool
) -> tuple[Panel, Panel]:
    """Return a panel with marks of events, and a panel of efforts."""
    exerted = Panel(title, [replace(one, label="") for one in efforts], _effort_axis(slides))
    return replace(motion, marks=[*motion.marks, *points]), exerted


def _effort_axis(slides: bool) -> Axis:
    return Axis("force" if slides else "torque", unit_of("element_effort", slides))


# --- stops and latches ---

# What is marked of changes, and how.
_MARKS = {"latched": "s", "refused": "x", "let go": "v", "bounces": "o", "rests": "s", "on": "o"}
_MEANINGS = {"o": "circles: touches", "s": "squares: captures, at rest"}
_MEANINGS |= {"x": "crosses: refusals", "v": "triangles: let go"}


@figure()
def figure_stops(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return the angle of each joint with stops or latches, and their efforts.

    The ground beyond a stop is grey, a latch's window blue. Marks stand where a stop was touched or struck
    and where a latch captured, refused or released.
    """
    picked = _first_ideal_last(pick(runs, STOPPED, compared=False))
    families = ("stops", "latches")
    places = [one for run in picked.drawn for one in _own(run, *families).values()]
    slides = {one["joint"]: bool(one["slides"]) for one in reversed(places)}
    joints = list(dict.fromkeys(one["joint"] for one in places))

    def efforts(run: LabelledRun, joint: str) -> list[Array]:
        return [run.values("element_effort", element=place) for place in _own(run, *families, joint=joint)]

    def position(run: LabelledRun, joint: str) -> Array | None:
        return _position(run, joint) if _own(run, *families, joint=joint) else None

    def columns(run: LabelledRun) -> list[Array]:
        return [one for j in joints if (found := efforts(run, j)) for one in (_position(run, j), *found)]

    picked = picked.thinned(columns)
    pairs, meant = [], set()
    for joint in joints:
        mine = [own for run in picked.drawn for own in _own(run, *families, joint=joint).items()]
        numbers = [number for _, one in mine for number in one["numbers"].values()]
        grounds = []
        for place, one in dict(mine).items():
            lower, upper = (one["numbers"].get(side) for side in ("lower", "upper"))
            if place.startswith("latches."):
                grounds.append((lower, upper, _BLUE))
                continue
            grounds += [(-np.inf, lower, SHADE)] if lower is not None else []
            grounds += [(upper, np.inf, SHADE)] if upper is not None else []
        word, unit = ("position", "m") if slides[joint] else ("angle", "rad")
        curves = picked.curves(lambda run, j=joint: position(run, j))  # type: ignore[misc]
        panel = _within_bounds(joint.replace("_", " "), curves, grounds, numbers, Axis(word, unit))
        points = [one for run, look in picked.styled for one in _changes(run, joint, look)]
        meant |= {mark for mark, _ in points}

        def total(run: LabelledRun, joint: str = joint) -> Array | None:
            found = efforts(run, joint)
            return np.sum(found, axis=0) if found else None

        marks = [one for _, one in points]
        exerted = "what its stops and latches exert", picked.curves(total), slides[joint]
        pairs.append(_with_efforts(panel, marks, *exerted))
    words = [text for mark, text in _MEANINGS.items() if mark in meant]
    return _paired(pairs, width, ("grey: beyond a stop", "blue: window of a latch", *words, *picked.notes))


def _position(run: LabelledRun, joint: str) -> Array:
    if joint in names_along(run.data, "sliding_joint"):
        return run.values("slide_position", sliding_joint=joint)
    return run.values("motion_angle", joint=joint)


def _changes(run: LabelledRun, joint: str, look: dict[str, Any]) -> list[tuple[str, Points]]:
    """Return marks of changes of a joint's stops and latches."""
    mine = _own(run, "stops", "latches", joint=joint)
    found: dict[str, list[tuple[float, float]]] = {}
    for change in (one for family in ("stops", "latches") for one in mode_changes(run.whole.data, family)):
        mark = _MARKS.get(change.what.rpartition(": ")[2])
        if mark is not None and change.element in mine:
            found.setdefault(mark, []).append((change.time, change.angle))
    hollow = {"edgecolors": look.get("color", "black"), "facecolors": "none"}
    return [
        (mark, Points(np.array(pairs), {"marker": mark, **({"color": PEAK} if mark == "x" else hollow)}))
        for mark, pairs in found.items()
    ]


# --- gears ---

_MOST_MARKS = 200  # more would be a band


@figure()
def figure_gears(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return the deflection of each gear, belt and cable, and its effort.

    Within the play, where nothing is in contact, the ground is grey; where both strands of a belt are taut it
    is blue. Circles stand where a flank came into contact, or a strand became taut.
    """
    picked = pick(runs, GEARED, compared=False).thinned(
        lambda run: [
            run.values(f"element_{what}", element=place)
            for place in _own(run, "gears")
            for what in ("deflection", "effort")
        ]
    )
    pairs, grounds, marks = [], set(), 0
    for place in dict.fromkeys(place for run in picked.drawn for place in _own(run, "gears")):
        has = [(run, look) for run, look in picked.styled if place in _own(run, "gears")]
        slides = bool(_own(has[0][0], "gears")[place]["slides"])
        mine = {_free(_own(run, "gears")[place]["numbers"]) for run, _ in has}
        edges = [edge for low, high, _ in mine for edge in (low, high) if np.isfinite(edge)]
        mine = {one for one in mine if one[0] < one[1]}

        def value(run: LabelledRun, what: str, place: str = place) -> Array | None:
            has = place in _own(run, "gears")
            return run.values(f"element_{what}", element=place) if has else None

        deflections, efforts = (picked.curves(partial(value, what=what)) for what in ("deflection", "effort"))
        deflections = [replace(one, label=run.label) for one, (run, _) in zip(deflections, has, strict=True)]
        title = place.partition(".")[2].replace("_", " ")
        panel = _within_bounds(title, deflections, mine, edges, Axis("deflection", "m" if slides else "rad"))
        touches = [(_onsets(run, place), look) for run, look in has]
        circles = [
            Points(one, {"marker": "o", "edgecolors": look.get("color", "black"), "facecolors": "none"})
            for one, look in touches
        ]
        exerted = "effort over deflection", efforts, slides
        pairs.append(_with_efforts(panel, circles, *exerted))
        grounds |= {colour for _, _, colour in mine}
        marks += sum(len(one) for one, _ in touches)
    notes = (
        "grey: nothing in contact" if SHADE in grounds else "",
        "blue: both strands taut" if _BLUE in grounds else "",
        "circles: touches" if marks else "",
    )
    return _paired(pairs, width, (*notes, *picked.notes))


def _free(numbers: dict[str, float]) -> tuple[float, float, str]:
    """Return the deflections without contact (grey), or with both strands taut (blue)."""
    if "plus" not in numbers:
        return 0.0, 0.0, SHADE
    plus, minus = numbers["plus"], numbers.get("minus", -np.inf)
    return (plus, minus, _BLUE) if plus < minus else (minus, plus, SHADE)


def _onsets(run: LabelledRun, place: str) -> Array:
    """Return times and deflections of touches, (n, 2); none of very many."""
    numbers = _own(run, "gears")[place]["numbers"]
    found = [(one.onset, numbers[one.side]) for one in mesh_touches(run.whole.data) if one.stop == place]
    return np.array(found if len(found) <= _MOST_MARKS else []).reshape(-1, 2)


# --- flexible links ---

# Parts that a figure shows, those with the largest deflections of their unit; decades of a spectrum.
_MOST = {"page": 4, "column": 3}
_DECADES = 6


@figure()
def figure_deflection(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return deflections of elastic parts, and their amplitude densities.

    Where there are many parts, those with the largest deflections. A dotted line marks the natural frequency
    with the hub held. The densities are means over three windows, half of the run each, of a short run one.
    """
    picked = _first_ideal_last(pick(runs, FLEXIBLE, compared=False))
    parts, count = _largest(picked.drawn, _MOST[width])

    def deflection(run: LabelledRun, part: str) -> Array | None:
        has = part in elastic_parts_of(run.data)
        return run.values("deflection", elastic_part=part) if has else None

    picked = picked.thinned(lambda run: [one for part in parts if (one := deflection(run, part)) is not None])
    pairs = []
    for part in parts:
        mine = [(run, look) for run, look in picked.styled if part in elastic_parts_of(run.data)]
        unit = unit_of("deflection", elastic_parts_of(mine[0][0].data)[part]["slides"])
        curves = picked.curves(lambda run, part=part: deflection(run, part))  # type: ignore[misc]
        motion = Panel(part.replace("_", " "), curves, Axis("deflection", unit))
        pairs.append((motion, _spectrum_panel(mine, part, unit)))
    notes = (
        "dotted: natural frequency with the hub held",
        f"the {len(parts)} of {count} elastic parts that deflect most" if count > len(parts) else "",
    )
    return _paired(pairs, width, (*notes, *picked.notes))


def _largest(runs: Sequence[LabelledRun], most: int) -> tuple[list[str], int]:
    """Return the parts with the largest deflections, and the number of all."""
    peaks: dict[bool, dict[str, float]] = {True: {}, False: {}}
    for run in runs:
        found = np.asarray(run.data["peak_deflection"].values, dtype=float)
        for (name, one), peak in zip(elastic_parts_of(run.data).items(), found, strict=True):
            kind = peaks[bool(one["slides"])]
            kind[name] = max(kind.get(name, 0.0), float(peak))
    ranked = [sorted(kind, key=lambda name, kind=kind: -kind[name]) for kind in peaks.values()]  # type: ignore[misc]
    chosen: list[str] = []
    for place in range(max(map(len, ranked))):
        chosen += [kind[place] for kind in ranked if place < len(kind)]
    order = list(dict.fromkeys(name for run in runs for name in elastic_parts_of(run.data)))
    return sorted(chosen[:most], key=order.index), len(order)


def _spectrum_panel(runs: Sequence[tuple[LabelledRun, dict[str, Any]]], part: str, unit: str) -> Panel:
    """Return amplitude densities of a part's deflections, and natural frequencies."""
    found = [(_density(run, part), look) for run, look in runs]
    curves = [PlotCurve("", *one, look) for one, look in found if one is not None]
    own = sorted({elastic_parts_of(run.data)[part]["frequency"] for run, _ in runs})
    look = {"color": "#666666", "linewidth": 0.7, "linestyle": ":"}
    marks: list[PlotMark] = [*curves, *(Rule(one, look, "x") for one in own)]
    x, y = Axis("frequency [Hz]", scale="log"), Axis(f"density [{unit}/√Hz]", scale="log")
    top = largest_of([one.y for one in curves])
    if top > 0.0:
        high = 10.0 ** np.ceil(np.log10(1.2 * top))
        # Up to ten times the frequency: what is above moves the part no more.
        start = min(float(one.x[0]) for one in curves)
        last = min(max(float(one.x[-1]) for one in curves), 10.0 * max(own))
        y = replace(y, limits=(high / 10.0**_DECADES, high))
        x = replace(x, limits=(start, max(last, 2.0 * start)))
    else:
        none = "no motion, or fewer than 16 samples"
        marks.append(
            ByHand(lambda axes, *_: axes.text(0.5, 0.5, none, transform=axes.transAxes, ha="center"))
        )
    return Panel("its amplitude density", marks, y, x)


def _density(run: LabelledRun, part: str) -> tuple[Array, Array] | None:
    """Return frequencies [Hz] and amplitude densities of a deflection, or None."""
    run = run.whole
    try:
        found = spectrum_of(run, run.values("deflection", elastic_part=part))
    except AntennaPinError:  # too few samples
        return None
    frequency = np.asarray(found["frequency"].values, dtype=float)
    density = np.asarray(found["density"].values, dtype=float)
    return frequency[frequency > 0.0], density[frequency > 0.0]


# --- springs ---


@figure()
def figure_hysteresis(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return torque over angle of springs with a table, hysteresis or constant torque.

    The area inside a loop is the heat of a cycle. A dot marks the start of a run.
    """
    picked = pick(runs, TRACED, compared=False)
    panels = []
    for name in picked.names("traced_spring"):
        marks: list[PlotCurve] = []
        slides = False
        for run, look in picked.styled:
            springs = names_along(run.data, "traced_spring")
            if name not in springs:
                continue
            joint = names_along(run.data, "traced_joint")[springs.index(name)]
            slides |= joint in run.sliding_joints
            angle, torque = _position(run, joint), run.values("spring_torque", traced_spring=name)
            dot = {"linestyle": "none", "marker": ".", "color": look.get("color"), "markersize": 4}
            marks.append(PlotCurve(run.legend, angle, torque, look, many=run.many))
            marks.append(PlotCurve("", angle[:1], torque[:1], dot))
        x = Axis("way", "m") if slides else Axis("angle", "rad")
        y = _effort_axis(slides)
        panels.append(Panel(name.replace("_", " "), marks, y, x, margins=(0.03, 0.03)))
    rows = in_rows(panels, COLUMN_OR_PAGE[width] if len(panels) > 1 else 1, alone=False)
    notes = ("the area inside a loop is the heat of a cycle", *picked.notes)
    return Sheet(rows, width, 12.0 + 58.0 * len(rows), notes, every=True)


# --- controllers ---

_REFERENCE: dict[str, Any] = {"color": "black", "linestyle": (0, (1.0, 1.0)), "linewidth": 0.9, "zorder": 4}
_SEEN = ("measured", "reference")
_MEASURES = {"angle": "rad", "rate": "rad/s", "base-rotation": "rad", "base-rate": "rad/s", "force": "N"}
_DASHES: tuple[Any, ...] = ("-", (0, (5.0, 1.5)), (0, (5.0, 1.0, 1.0, 1.0)))


@dataclass(frozen=True, slots=True, eq=False)
class _Signals:
    """Signals of a run in one panel.

    Values of a sampled signal hold until the next (``steps``); ``held`` are spans in which limits held the
    command.
    """

    unit: str
    time: Array  # [s]
    lines: dict[str, Array]
    steps: bool = False
    held: Sequence[tuple[float, float]] = ()


@figure()
def figure_control(runs: Runs, *, width: Width = "page") -> Sheet:
    """Return measured values, references and commands of the controllers of all runs.

    A sampled controller's numbers are those of its instants, each held until the next; commands are drawn
    from where they were given, before any delay. A drive that follows a reference all the time has smooth
    lines. References are dotted; the ground is grey while limits held a command.
    """
    picked = pick(runs, CONTROLLED, compared=False)
    panels: dict[str, dict[str, _Signals]] = {}
    for run in picked.drawn:
        for title, one in (*_sampled(run), *_continuous(run)):
            panels.setdefault(title, {})[run.label] = one
    looks = {run.label: look for run, look in picked.styled} if len(picked.drawn) > 1 else {}
    shown = []
    for title, by_run in panels.items():
        marks: list[PlotMark] = [mark for label, one in by_run.items() for mark in _marks(one, label, looks)]
        unit = next(iter(by_run.values())).unit
        y = Axis("", unit) if unit else Axis("[SI]")
        shown.append(Panel(title, marks, y, Axis("time [s]", ticks=6)))
    rows = in_rows(shown, COLUMN_OR_PAGE[width] if len(shown) > 1 else 1)
    notes = (
        "commands as they were given, before any delay" if any(map(_sampled, picked.drawn)) else "",
        "grey: limits held the command" if any(o.held for p in panels.values() for o in p.values()) else "",
    )
    return Sheet(rows, width, 12.0 + 42.0 * len(rows), (*notes, *picked.notes))


def _marks(signals: _Signals, label: str, looks: dict[str, dict[str, Any]]) -> Iterator[PlotMark]:
    """Yield the lines of a run in a panel."""
    number = 0
    for name, values in signals.lines.items():
        if name == "reference":
            look, words = _REFERENCE, name
        else:
            own = {"color": f"C{number}", "linewidth": 0.8}
            look = {**looks[label], "linestyle": _DASHES[number % len(_DASHES)]} if looks else own
            words = label if looks else name
            number += 1
        style = {"drawstyle": "steps-post" if signals.steps else "default", **look}
        yield PlotCurve(words, signals.time, values, style)
    for span in signals.held:
        yield Ground(*span, {"facecolor": SHADE, "edgecolor": "none", "zorder": 0.5})


def _sampled(run: LabelledRun) -> list[tuple[str, _Signals]]:
    """Return panels of a run's sampled controllers."""
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
            lines = {signal.removeprefix("command "): own[signal] for signal in signals}
            held = _spans(time, saturated > 0.0) if title == "command" else []
            unit = _unit(run, name, signals[0])
            found.append((f"{name}: {title}", _Signals(unit, time, lines, True, held)))
    return found


def _grouped(own: dict[str, Array]) -> Iterator[tuple[str, list[str]]]:
    """Yield the signals of each panel: measured and reference, vectors, commands."""
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
    """Return the spans between samples in which a signal was on."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], on[:-1].astype(int), [0]])))
    return [(float(time[a]), float(time[b])) for a, b in edges.reshape(-1, 2)]


def _unit(run: LabelledRun, controller: str, signal: str) -> str:
    """Return the unit of a signal by the run's scenario; "" where it is unknown."""
    try:
        scenario = json.loads(run.data.attrs["scenario"])
        one = scenario["controllers"][controller]
    except (KeyError, TypeError, ValueError):
        return ""
    drives = scenario.get("drives", {})
    if signal.startswith("command "):  # a torque or force, a voltage or current
        name = signal.removeprefix("command ")
        about = drives.get(name, {})
        if about.get("kind") == "motor":
            return "A" if about.get("mode") == "current" else "V"
        return effort_unit(run.data, name) if name in names_along(run.data, "drive") else ""
    if signal in _SEEN:
        joint = drives.get(one.get("acts_on"), {}).get("joint", "")
        measures = one.get("measures") or f"angle {joint}"
    else:
        measures = {"error": "base-rotation x"}.get(signal, signal)
    what, _, joint = str(measures).partition(" ")
    return _MEASURES.get(what, "").replace("rad", "m" if joint in run.sliding_joints else "rad")


def _continuous(run: LabelledRun) -> Iterator[tuple[str, _Signals]]:
    """Yield panels of the drives that follow a reference all the time."""
    for name in names_along(run.data, "controller") if "control_reference" in run.data else ():
        reference = run.values("control_reference", controller=name)
        measured = reference - run.values("control_error", controller=name)
        unit = "m" if drives_of(run.data).get(name, {}).get("slides") else "rad"
        lines = {"measured": measured, "reference": reference}
        yield f"{name}: measured and reference", _Signals(unit, run.time, lines)
        if name in names_along(run.data, "drive"):
            effort = {"what it exerts": run.values("drive_torque", drive=name)}
            yield f"{name}: effort over deflection", _Signals(effort_unit(run.data, name), run.time, effort)


FIGURES = (
    RunFigure(
        "control", "What controllers measure and command", figure_control, needs=CONTROLLED, compares=False
    ),
    RunFigure("stops", "End stops and latches", figure_stops, needs=STOPPED),
    RunFigure("gears", "Gears, belts and cables", figure_gears, needs=GEARED),
    RunFigure("deflection", "Deflections of flexible links", figure_deflection, needs=FLEXIBLE),
    RunFigure("hysteresis", "Torque of springs over angle", figure_hysteresis, needs=TRACED, compares=False),
)
