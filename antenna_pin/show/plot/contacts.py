"""Contact in a joint: forces, eccentricity and depth, scenarios; a column a run."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any, get_args

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path

from antenna_pin.analysis import is_round_off, journal_motion, round_off_scales, scenario_spans
from antenna_pin.joints.geometry import LOOKS
from antenna_pin.joints.geometry.look import Row
from antenna_pin.show.plot._compared import pick_touching
from antenna_pin.show.plot._kinds import TOUCHING, RunFigure
from antenna_pin.show.plot._runs import Blow, LabelledRun, Runs, episodes_of, sharp, smooth, strongest_blow
from antenna_pin.show.plot._style import COLOURS, MANY, PEAK, Array, Width, distinct, prefixed, three_digits
from antenna_pin.show.plot._thinned import closer, thinned
from antenna_pin.show.plot.grammar import (
    TIME,
    Axis,
    ByHand,
    Panel,
    PlotCurve,
    PlotMark,
    Rule,
    Sheet,
    close_view,
    figure,
    in_blocks,
    in_pairs,
    largest_of,
)
from antenna_pin.trajectory import contact_ends, contact_kinds

# How dots of blows look; of many they are pixels.
_DOT: dict[str, Any] = {
    "linestyle": "none",
    "marker": ".",
    "markersize": 2.4,
    "markeredgewidth": 0.0,
    "color": PEAK,
}

# --- forces ---

_SIGNS = {"-": " \N{MINUS SIGN}", "+": " +", "": ""}


@figure()
def figure_contact_forces(runs: Runs, *, joint: str | None = None, width: Width = "page") -> Sheet:
    """Return radial and axial forces on the journal and the strongest blow.

    As in the Figures 11 to 13 of Bai and Zhao (2020), a column a run. The line is the resultant of all
    contacts, a smooth one through the samples: its size across the bearing's axis, and its component along
    that axis. The peak normal force of every blow is drawn as a stem: a line to the peak and a dot on it; an
    axial peak carries the sign of its flange. The close view has the normal forces of all contacts in the
    strongest blow. Forces that are zero to round-off are named below.
    """
    picked = pick_touching(runs, joint)
    drawn, name = picked.drawn, picked.joint
    kinds = _kinds(drawn, name)

    def columns(part: LabelledRun) -> Iterable[Array]:
        return _resultant(part, name, kinds).values()

    curves = [thinned(smooth(run, name), columns) for run in drawn]
    blows = list(map(strongest_blow, drawn, curves, itertools.repeat(name)))
    curves = [
        closer(curve, blow.window if blow else None, columns)
        for curve, blow in zip(curves, blows, strict=True)
    ]
    forces = [_resultant(curve, name, kinds) for curve in curves]
    both = list(zip(drawn, curves, strict=True))
    peaks = [{kind: _peaks(run, curve, name, kind) for kind in kinds} for run, curve in both]
    sizes = [
        {kind: largest_of([force[kind], peak[kind][1]]) for kind in kinds}
        for force, peak in zip(forces, peaks, strict=True)
    ]
    scales = round_off_scales(*(run.whole.data for run in drawn))
    still = [
        (run, kind)
        for run, size in zip(drawn, sizes, strict=True)
        for kind in kinds
        if size[kind] == 0.0 or is_round_off(size[kind], "N", scales)
    ]
    shown = [kind for kind in kinds if any((run, kind) not in still for run in drawn)] or list(kinds[:1])
    unit = drawn[0].unit("joint_force")
    rows: list[list[Panel | None]] = []
    for kind in shown:
        every = [size[kind] for size in sizes]
        y = Axis(f"{kind} force", unit, max(every), shared=kind if _comparable(every) else None)
        rows.append([])
        for run, curve, force, peak in zip(drawn, curves, forces, peaks, strict=True):
            if (run, kind) in still and len(shown) * len(drawn) > 1:
                rows[-1].append(None)
                continue
            look = {"color": COLOURS[0], "linewidth": 0.6, "zorder": 3}
            marks: list[PlotMark] = [
                PlotCurve("resultant on the journal", curve.time, force[kind], look, many=curve.many),
                *_stems(*peak[kind]),
                Rule(0.0, {"color": "#999999", "linewidth": 0.5, "zorder": 1.5}),
            ]
            rows[-1].append(Panel(f"{run.label}, {kind}", marks, y))
    if any(blows):
        names = _names(drawn, name)
        rows.append(
            [
                None if blow is None else _blow(*one, blow, names, unit)
                for one, blow in zip(both, blows, strict=True)
            ]
        )
    sheet = in_blocks(rows, width)
    return Sheet(sheet, width, 12.0 + 38.0 * len(sheet), (_zero(still, name), *picked.notes[:1]))


def _names(runs: list[LabelledRun], joint: str) -> dict[str, str]:
    """Return the legend entries of a joint's contacts."""
    found = {}
    for run in runs:
        kinds, ends = contact_kinds(run.data), contact_ends(run.data)
        for name in run.contacts_of(joint):
            kind = kinds[name].replace("_", " ")
            found[name] = f"normal force, {kind}{_SIGNS.get(ends[name], ' ' + ends[name])}"
    return found


def _zero(still: list[tuple[LabelledRun, str]], joint: str) -> str:
    """Return a note on forces that are zero to round-off."""
    parts = []
    for run, kind in still:
        can = run.contacts_of(joint, flanges=True) or kind != "axial"
        parts.append(f"{run.label}, {kind}{'' if can else ' (no such contact in this joint)'}")
    return f"zero to round-off: {'; '.join(parts)}" if parts else ""


def _comparable(sizes: list[float]) -> bool:
    """Return whether one scale shows all runs, none of them flat."""
    touched = [size for size in sizes if size > 0.0]
    return not touched or min(touched) > 0.15 * max(touched)


def _kinds(runs: list[LabelledRun], joint: str) -> tuple[str, ...]:
    """Return the rows for the contacts that the joint has in any run."""
    found = {contact_kinds(run.data)[name] for run in runs for name in run.contacts_of(joint)}
    rows = [look.rows for look in LOOKS.values() if look.contacts <= found]
    return min(rows, key=lambda row: (get_args(Row).index(row[0]), -len(row)), default=("radial",))


def _resultant(run: LabelledRun, joint: str, kinds: tuple[str, ...]) -> dict[str, Array]:
    """Return the sizes of the force on the journal across and along the axis [N]."""
    force = run.values("joint_force", clearance_joint=joint)
    if kinds == ("contact",):
        return {"contact": np.linalg.norm(force, axis=1)}
    across = np.hypot(force[:, 0], force[:, 1])
    return {"radial": across, "transverse": across, "axial": force[:, 2]}


def _peaks(run: LabelledRun, curve: LabelledRun, joint: str, kind: str) -> tuple[Array, Array]:
    """Return times [s] and signed peak normal forces [N] of a kind's blows."""
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


def _stems(time: Array, force: Array) -> list[PlotCurve]:
    """Return a line from zero to each peak, and a dot on it."""
    if not time.size:
        return []
    many = time.size > 2_000
    # One line with gaps takes a third of the room of as many lines.
    stems = np.stack([np.zeros_like(force), force, np.full_like(force, np.nan)], axis=1)
    look = {"color": PEAK, "linewidth": 0.35, "alpha": 0.55, "zorder": 2}
    dots = {**_DOT, "zorder": 2.5}
    return [
        PlotCurve("", np.repeat(time, 3), stems.ravel(), look, many=many),
        PlotCurve("peak normal force of each blow", time, force, dots, many=many),
    ]


def _blow(run: LabelledRun, curve: LabelledRun, blow: Blow, names: dict[str, str], unit: str) -> Panel:
    """Return normal forces in a blow over the time from its peak on."""
    seen = np.flatnonzero((curve.time >= blow.window[0]) & (curve.time <= blow.window[1]))
    seen = np.arange(max(seen[0] - 1, 0), min(seen[-1] + 2, curve.time.size))
    lines = [
        PlotCurve(
            names[name],
            curve.time[seen] - blow.time,
            curve.values("normal_force", contact=name)[seen],
            {**distinct(number), "linewidth": 1.0},
        )
        for number, name in enumerate(names)
        if name in blow.touching
    ]
    dot = {**_DOT, "markersize": 4.0, "zorder": 4}
    peak = PlotCurve("", np.zeros(1), np.array([blow.force]), dot)
    start, end = blow.window
    limits = start - blow.time, end - blow.time
    x = Axis(f"time from {blow.time:.6g} s on", "s", end - start, limits)
    y = Axis("normal force", "N", blow.force, (0.0, None))
    factor, printed = prefixed(unit, blow.force)
    title = f"{run.label}, strongest blow: {three_digits(factor * blow.force)} {printed}"
    return Panel(title, [*lines, peak], y, x)


# --- eccentricity, depth, tilt ---

_ENDS = {
    "+": ("end +", COLOURS[0]),
    "-": ("end \N{MINUS SIGN}", COLOURS[4]),
    "centre": ("centre", COLOURS[0]),
}
# Further panels, of a joint in which rigid parts can move so far only: variable, label, title, unit; limit of
# a sign or of a size.
_BOUNDED = (
    ("tilt", "tilt", "tilt", "rad", (1.0,)),
    ("axial", "axial place", "axial place", "m", (-1.0, 1.0)),
    ("twist", "turn", "turn about the axis", "rad", (-1.0, 1.0)),
)
_LIMIT: dict[str, Any] = {"color": "#666666", "linewidth": 0.6, "linestyle": ":", "zorder": 1.5}


@figure()
def figure_eccentricity(runs: Runs, *, joint: str | None = None, width: Width = "page") -> Sheet:
    """Return eccentricity, penetration depth and further play of the journal over time.

    The eccentricity is over the clearance: 1 where the surfaces touch. The depth's dots are the largest of
    every blow in the bore. Tilt, axial place, and turn about the axis are of joints in which they
    have a limit; dotted lines are the limits of rigid parts. Each run has a column.
    """
    picked = pick_touching(runs, joint)
    name = picked.joint
    curves = [thinned(smooth(run, name), lambda part: _columns(part, name)) for run in picked.drawn]
    motions = [journal_motion(curve.data, name) for curve in curves]
    depths = [_depths(run, curve, name) for run, curve in zip(picked.drawn, curves, strict=True)]
    deepest = max(float(part.max(initial=0.0)) for sampled, _, peaks in depths for part in (sampled, peaks))
    look = {"color": COLOURS[0], "linewidth": 0.5}
    every = list(zip(picked.drawn, curves, motions, depths, strict=True))

    def panel(run: LabelledRun, title: str, marks: Sequence[PlotMark], y: Axis) -> Panel:
        limits = float(run.time[0]), float(run.time[-1])
        y = replace(y, ticks=4, shared=title)
        return Panel(f"{run.label}, {title}", marks, y, replace(TIME, limits=limits))

    rows: list[list[Panel | None]] = [[], []]
    for run, curve, motion, (sampled, at, peaks) in every:
        ratios = zip(motion["place"].values, motion["eccentricity_ratio"].values.T, strict=True)
        ends = [(*_ENDS[str(place)], ratio) for place, ratio in ratios]
        lines = [
            PlotCurve(end, curve.time, ratio, {**look, "color": colour}, many=curve.many)
            for end, colour, ratio in ends
        ]
        y = Axis("eccentricity /\nclearance [-]")
        rows[0].append(panel(run, "eccentricity", [*lines, Rule(1.0, _LIMIT)], y))
        marks = [
            PlotCurve("", curve.time, sampled, look, many=curve.many),
            PlotCurve("largest of each blow", at, peaks, _DOT, many=peaks.size > MANY // 20),
        ]
        rows[1].append(panel(run, "penetration", marks, Axis("depth", "m", deepest)))
    notes = []
    for variable, label, title, unit, sides in _BOUNDED:
        limits = [float(motion.attrs[f"{variable}_limit"]) for motion in motions]
        bounded = [k for k, limit in enumerate(limits) if np.isfinite(limit)]
        if not bounded:
            continue
        y = Axis(
            label, unit, largest_of([np.append(motions[k][variable].values, limits[k]) for k in bounded])
        )
        rows.append([])
        for (run, curve, motion, _), limit in zip(every, limits, strict=True):
            line = PlotCurve("", curve.time, motion[variable].values, look, many=curve.many)
            rules = [Rule(side * limit, _LIMIT) for side in sides]
            rows[-1].append(panel(run, title, [line, *rules], y) if np.isfinite(limit) else None)
        without = [
            run.label for run, limit in zip(picked.drawn, limits, strict=True) if not np.isfinite(limit)
        ]
        notes += [f"without a limit of the {label}: {', '.join(without)}"] if without else []
    sheet = in_blocks(rows, width)
    height = 12.0 + 32.0 * len(sheet)
    return Sheet(sheet, width, height, ("dotted: what rigid parts allow", *notes, *picked.notes))


def _columns(run: LabelledRun, joint: str) -> list[Array]:
    """Return all drawn columns of a run's samples."""
    motion = journal_motion(run.data, joint)
    names = ("eccentricity_ratio", *(name for name, *_ in _BOUNDED))
    return [_sampled_depth(run, joint), *(motion[name].values for name in names)]


def _sampled_depth(run: LabelledRun, joint: str) -> Array:
    """Return the largest depth in the bore over time [m]."""
    names = run.contacts_of(joint, flanges=False)
    depths = np.stack([run.values("depth", contact=name) for name in names], axis=1)
    return np.asarray(depths.max(axis=1))


def _depths(run: LabelledRun, curve: LabelledRun, joint: str) -> tuple[Array, Array, Array]:
    """Return depths in the bore [m], and times [s] and depths of peaks."""
    names = run.contacts_of(joint, flanges=False)
    sampled = _sampled_depth(curve, joint)
    if run.data.sizes.get("episode", 0) == 0:
        return sampled, np.empty(0), np.empty(0)
    mine = episodes_of(run, names) & sharp(run, curve)
    return sampled, run.values("peak_time")[mine], run.values("peak_depth")[mine]


# --- scenarios ---

_COLOURS = ("#9A9A9A", COLOURS[0], COLOURS[1], COLOURS[2])
_Span = tuple[float, float]
_FINEST = 10_000  # parts of the width, far below a pixel, that separate many bars


@figure()
def figure_scenarios(
    runs: Runs, *, joint: str | None = None, zoom: _Span | None = None, width: Width = "page"
) -> Sheet:
    """Return the contact scenario of a joint as a time line of bore and flanges.

    Each scenario has its own line, filled while the joint is in it; on the right its share of the time. The
    close view is the fiftieth of the run with the most changes.
    """
    picked = pick_touching(runs, joint)
    pairs = []
    for run in picked.drawn:
        span = scenario_spans(run.data, picked.joint)
        start, end = float(run.time[0]), float(run.time[-1])
        window = zoom or _busiest(span, start, end)
        # A joint without flanges has no line of axial scenarios.
        flanged = bool(run.contacts_of(picked.joint, flanges=True))
        for kind in ("radial", "axial")[: 1 + flanged]:
            names = [name.replace("_", " ") for name in str(span[kind].attrs["flag_meanings"]).split()]
            if not flanged:  # the others distinguish two points
                one = len(run.contacts_of(picked.joint)) == 1
                names = [names[0], names[1] if one else "contact"]
            hidden = dict.fromkeys(range(len(names)), "") if width == "page" else None
            whole = _time_line(span, kind, (start, end), names, 6)
            near = _time_line(span, kind, window, names, 4)
            whole = replace(
                whole,
                title=f"{run.label}, {kind if flanged else 'contact'}",
                marks=[*whole.marks, close_view(window)],
                finish=_with_shares(_shares(span, kind, (start, end))[: len(names)]),
            )
            if hidden is not None:
                near = replace(near, y=replace(near.y, named=hidden))
            pairs.append((whole, near))
    rows, page = in_pairs(pairs, width), width == "page"
    height = 14.0 + (27.0 if page else 54.0) * len(pairs)
    notes = ("right of the line: share of the time", *picked.notes)
    return Sheet(rows, width, height, notes, [1.5, 1.0] if page else None, every=not page)


def _time_line(spans: xr.Dataset, kind: str, window: _Span, names: list[str], ticks: int) -> Panel:
    """Return the lines of scenarios in a window, no contact on top."""
    start = np.clip(spans["start"].values, *window)
    length = np.clip(spans["end"].values, *window) - start

    def bars(axes: Axes, *_: float) -> None:
        for value in range(spans[kind].attrs["flag_values"].size):
            mine = (spans[kind].values == value) & (length > 0.0)
            many = bool(np.count_nonzero(mine) > MANY // 20)
            spread = start[mine], length[mine]
            if many:
                spread = _joined(*spread, (window[1] - window[0]) / _FINEST)
            # An edge as thin as the finest line, so that an impact of a tenth of a millisecond is still seen.
            axes.add_patch(
                PathPatch(
                    _rectangles(*spread, value - 0.38, 0.76),
                    facecolor=_COLOURS[value],
                    edgecolor=_COLOURS[value],
                    linewidth=0.25,
                    rasterized=many,
                )
            )
            axes.axhline(value, color="#DDDDDD", linewidth=0.4, zorder=0.4)

    y = Axis(limits=(len(names) - 0.4, -0.6), named=dict(enumerate(names)))
    x = replace(TIME, limits=window, ticks=ticks)
    return Panel("close view of the shaded span", [ByHand(bars)], y, x, finish=_bare)


def _bare(axes: Axes) -> None:
    axes.grid(axis="y", visible=False)
    axes.tick_params(axis="y", length=0.0)


def _with_shares(shares: Array) -> Any:
    """Return a function that writes shares of scenarios beside their lines."""

    def finish(axes: Axes) -> None:
        _bare(axes)
        right = axes.secondary_yaxis("right")
        right.set_yticks(range(len(shares)), [_percent(share) for share in shares], fontsize=6.5)
        right.tick_params(length=0.0, pad=2.0)
        right.spines["right"].set_visible(False)

    return finish


def _shares(spans: xr.Dataset, kind: str, window: _Span) -> Array:
    """Return each scenario's share of the time of a window."""
    start = np.clip(spans["start"].values, *window)
    length = np.clip(spans["end"].values, *window) - start
    count = spans[kind].attrs["flag_values"].size
    held = [length[(spans[kind].values == value) & (length > 0.0)].sum() for value in range(count)]
    return np.array(held) / (window[1] - window[0])


def _joined(start: Array, length: Array, gap: float) -> tuple[Array, Array]:
    """Return starts and lengths of ascending bars, those nearer than a gap joined."""
    end = start + length
    first = np.concatenate([[True], start[1:] - end[:-1] > gap])
    last = np.concatenate([first[1:], [True]])
    return start[first], end[last] - start[first]


def _rectangles(start: Array, length: Array, below: float, height: float) -> Path:
    """Return rectangles as one path, a fraction of the size of as many patches."""
    x, above = np.stack([start, start + length], axis=1), below + height
    corners = np.empty((start.size, 5, 2))
    corners[:, :, 0] = x[:, [0, 0, 1, 1, 0]]
    corners[:, :, 1] = [below, above, above, below, below]
    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    return Path(corners.reshape(-1, 2), np.tile(codes, start.size).astype(Path.code_type))


def _busiest(spans: xr.Dataset, start: float, end: float) -> _Span:
    """Return the fiftieth of the run that holds the most changes."""
    length = (end - start) / 50.0
    changes = spans["start"].values
    held = np.searchsorted(changes, changes + length) - np.arange(changes.size)
    first = float(changes[int(np.argmax(held))]) - 0.05 * length
    first = min(max(first, start), end - length)
    return first, first + length


def _percent(share: float) -> str:
    """Return a share in percent, with one digit unless it is none."""
    if share == 0.0:
        return "\N{EN DASH}"
    return "<0.1 %" if share < 0.0005 else f"{100.0 * share:.1f} %"


def _of(name: str, title: str, function: Any) -> RunFigure:
    return RunFigure(name, title, function, of=TOUCHING, compares=False)


FORCE_FIGURES = (_of("contact_forces", "Contact forces in {joint}", figure_contact_forces),)
FIGURES = (
    _of("eccentricity", "Eccentricity and tilt in {joint}", figure_eccentricity),
    _of("contact_scenarios", "Contact scenarios of {joint}", figure_scenarios),
)
