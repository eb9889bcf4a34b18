"""Journal in its bearing: orbit within the clearance, and load around the bore."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Polygon
from matplotlib.path import Path
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from antenna_pin.analysis import LONG, blocks, bore_load, journal_motion, steady_up
from antenna_pin.errors import UnknownNameError
from antenna_pin.show.plot import _style as style
from antenna_pin.show.plot._compared import pick_touching
from antenna_pin.show.plot._kinds import TOUCHING, RunFigure
from antenna_pin.show.plot._runs import LabelledRun, Runs, episodes_of, sharp, smooth
from antenna_pin.show.plot._style import (
    COLOURS,
    MANY,
    SEQUENTIAL,
    WIDTHS,
    Array,
    Width,
    draw_parts,
    draw_pieces,
    few_ticks,
    prefixed,
)
from antenna_pin.show.plot._thinned import thinned
from antenna_pin.show.plot.grammar import Axis, ByHand, Panel, PlotCurve, PlotMark, Sheet, figure, in_rows
from antenna_pin.trajectory import contact_ends, contact_kinds

# --- squares, and axes that have "up" against gravity ---

_MM = 25.4
_ACROSS = 0.1  # sine of the axis' angle to gravity, from which on a cross section has an "up"
_SAME = 1e-6


def _squares(width: Width, count: int, more: float) -> tuple[int, float]:
    """Return columns of square panels, and the figure's height [mm]."""
    most = 4 if width == "page" else 2
    columns = min(count, most)
    if count > columns:  # rows of equal length where that is possible
        columns = next((n for n in range(most, most // 2, -1) if count % n == 0), most)
    # A single panel does not fill the width. Labels take some 14 mm across, and 18 mm with the title along.
    room = WIDTHS.get(width, WIDTHS["page"]) * _MM
    height = room / max(columns, 2.4 if width == "page" else 1.2) + 1.0
    return columns, more + -(-count // columns) * height


@dataclass(frozen=True, slots=True, eq=False)
class _Shown:
    """Axes of a bearing's picture, turned from the bearing's by ``turn`` (3, 3).

    ``up`` is the direction against gravity in bearing axes, (3,) [-], None without it.
    """

    turn: Array
    names: tuple[str, str, str]
    up: Array | None

    @property
    def turned(self) -> bool:
        return bool(np.abs(self.turn - np.eye(3)).max() > _SAME)


def _shown_axes(data: xr.Dataset, joint: str, *, spatial: bool) -> _Shown:
    """Return the axes of a bearing's picture: its own, or one of them against gravity.

    Without a steady gravity the axes are the bearing's own. The third axis points up in space, else the
    second, about the bearing's own third.
    """
    up = steady_up(data, joint)
    if up is not None and not spatial and np.hypot(up[0], up[1]) < _ACROSS:
        up = None
    if up is None:
        return _Shown(np.eye(3), ("x", "y", "z"), None)
    if spatial:
        z = up
        along = np.eye(3)[0 if abs(up[0]) < 0.9 else 1]
        x = along - (along @ z) * z
        x /= np.linalg.norm(x)
        turn = np.stack([x, np.cross(z, x), z])
    else:
        y = np.array([up[0], up[1], 0.0]) / np.hypot(up[0], up[1])
        turn = np.stack([np.array([y[1], -y[0], 0.0]), y, np.array([0.0, 0.0, 1.0])])
    upwards = 2 if spatial else 1
    names = [_name(row) or ("level" if not spatial else f"level {k + 1}") for k, row in enumerate(turn)]
    names[upwards] = f"{_name(turn[upwards])}, up".removeprefix(", ")
    return _Shown(turn, (names[0], names[1], names[2]), up)


def _name(direction: Array) -> str:
    """Return the axis of the bearing along a direction with its sign, or nothing."""
    k = int(np.argmax(np.abs(direction)))
    if 1.0 - abs(direction[k]) > _SAME:
        return ""
    return ("" if direction[k] > 0.0 else "\N{MINUS SIGN}") + "xyz"[k]


def _mark_axes(axes: Axes, shown: _Shown, across: int, up: int) -> None:
    """Draw the bearing's axes in a corner, where others are across and up."""
    if not shown.turned:
        return
    size = 0.075
    for k, name in enumerate("xyz"):
        way = shown.turn[[across, up], k]
        if np.hypot(*way) < 0.2:
            continue  # it points out of the picture
        x, y = (0.16 + size * way).tolist()
        arrow = {"arrowstyle": "->", "linewidth": 0.6, "shrinkA": 0.0, "shrinkB": 0.0}
        axes.annotate("", (x, y), (0.16, 0.16), "axes fraction", arrowprops=arrow)
        x, y = (0.16 + (size + 0.035) * way).tolist()
        axes.text(x, y, name, transform=axes.transAxes, ha="center", va="center", fontsize=6.5)


# --- the path of the journal, of a long run part by part ---


def _farthest(run: LabelledRun, joint: str) -> float:
    """Return the largest eccentricity of the journal in a run [m]."""
    parts = (journal_motion(part, joint)["eccentricity"].values for part in blocks(run.data))
    return float(np.nanmax([np.nanmax(part) for part in parts]))


class _Path:
    """Path of the journal's axis or centre at one place of the bearing.

    ``motion`` is that of the first part of the samples, which is all of a run that is not long; ``turn`` maps
    offsets to the drawn axes and their scale, (3, 3).
    """

    def __init__(self, run: LabelledRun, motion: xr.Dataset, joint: str, place: int, turn: Array) -> None:
        self._run, self._motion, self._joint, self._place, self._turn = run, motion, joint, place, turn
        self.long = run.time.size > LONG

    def parts(self) -> Iterator[tuple[Array, Array]]:
        """Yield offsets (m, 3) and times (m,) [s]; parts share their ends."""
        if not self.long:
            yield self._motion["offset"].values[:, self._place] @ self._turn.T, self._run.time
            return
        for part in blocks(self._run.data, overlap=1):
            offset = journal_motion(part, self._joint)["offset"].values[:, self._place]
            yield offset @ self._turn.T, part["time"].values

    @property
    def whole(self) -> Array:
        """All offsets, (n, 3)."""
        found = [offset for offset, _ in self.parts()]
        return np.concatenate([*(offset[:-1] for offset in found[:-1]), found[-1]])


# --- the orbit ---

Shade = Literal["time", "load"]
_FREE = "#B8B8B8"
_SINCE = SEQUENTIAL.with_extremes(under="#D4D4D4")
# Times that a path crosses its play, by its length away from the outline: so many are a tangle, of which so
# many are in colour.
_TANGLE, _FOLLOWED = 18.0, 6.0
_AWAY = 0.95  # of the outline
# Across, up: which axes of the bearing a panel shows.
_SECTION = ((0, 1),)
_PROJECTIONS = ((0, 1), (0, 2), (1, 2))
_ALIKE = 2.0  # clearances whose ratio is no larger are drawn on one scale [-]
_PLACES = {"+": "end +", "-": "end \N{MINUS SIGN}", "centre": "centre"}


@figure(shade='"time", or "load": the size of the contact force, flight in grey.')
def figure_orbit(
    runs: Runs, *, joint: str | None = None, shade: Shade = "time", width: Width = "page"
) -> Sheet:
    """Return the orbit of the journal inside the clearance circle, in the bearing's plane.

    A revolute joint has two panels: where the journal's axis passes through the plane of each end of the
    bore. Outside the circle the surfaces are pressed into each other, by a hundredth of the clearance or so.
    A ball joint has the three projections of its ball's centre. A slider's axis is drawn at its own two ends,
    inside the rectangle that its guide leaves it. Between samples the path is that of their places and
    velocities. Where the largest clearance is more than twice the smallest, every run is drawn in its own.

    The last part of a journal's path that crosses its play many times is in colour, the part before in grey.

    Under gravity "up" is against it, as far as the bearing keeps still: labels name that axis of the bearing,
    and a triad in the corner shows its axes where others than x and y are across and up.
    """
    if shade not in ("time", "load"):
        raise UnknownNameError("figure", "shade", shade, ("time", "load"))
    picked = pick_touching(runs, joint)
    drawn, name = picked.drawn, picked.joint
    curves = [smooth(run, name) for run in drawn]
    # Of a long run what holds for all of it is that of its first part; its path is made while it is drawn.
    motions = [journal_motion(next(blocks(curve.data)), name) for curve in curves]
    # The whole play is in view, however little the journal has moved.
    sizes = [
        float(max(_farthest(curve, name), np.abs(motion.attrs["outline"]).max()))
        for curve, motion in zip(curves, motions, strict=True)
    ]
    clearances = [float(motion.attrs["radial_clearance"]) for motion in motions]
    if max(clearances) > _ALIKE * min(clearances):  # on one scale the smallest would be a dot
        factors, printed, by = [1.0 / one for one in clearances], "-", " / clearance"
    else:
        factor, printed = prefixed("m", max(sizes))
        factors, by = [factor] * len(drawn), ""
    reach = 1.1 * max(factor * size for factor, size in zip(factors, sizes, strict=True))
    loads = [_bore_forces(curve, name) if shade == "load" else np.zeros((0, 0)) for curve in curves]
    start = min(run.time[0] for run in drawn)
    if shade == "time":
        begun = max([start, *(_last_turns(*one, name) for one in zip(curves, motions, strict=True))])
        norm, colours = Normalize(begun, max(run.time[-1] for run in drawn)), _SINCE
    else:  # late times are light, large loads dark
        largest = max(float(np.nanmax(load, initial=0.0)) for load in loads) or 1.0
        norm, colours = LogNorm(1e-4 * largest, largest), SEQUENTIAL.reversed()
    panels: list[Panel] = []
    for run, curve, motion, load, factor in zip(drawn, curves, motions, loads, factors, strict=True):
        spatial = bool(motion.attrs["spatial"])
        shown = _shown_axes(run.data, name, spatial=spatial)
        outline = factor * motion.attrs["outline"]
        if not spatial:  # else a circle however it is seen
            outline = factor * (np.pad(motion.attrs["outline"], ((0, 0), (0, 1))) @ shown.turn.T)[:, :2]
        for number, place in enumerate(motion["place"].values):
            path = _Path(curve, motion, name, number, factor * shown.turn)
            for across, up in _PROJECTIONS if spatial else _SECTION:

                def draw(
                    axes: Axes,
                    *_: float,
                    path: _Path = path,
                    load: Array | None = load[:, number] if shade == "load" else None,
                    outline: Array = outline,
                    shown: _Shown = shown,
                    ways: list[int] = [across, up],  # noqa: B006
                ) -> None:
                    _line(axes, path, ways, load, {"cmap": colours, "norm": norm})
                    looks: dict[str, Any] = {"edgecolor": "black", "linewidth": 0.6, "zorder": 1.6}
                    axes.add_patch(Polygon(outline, closed=True, fill=False, **looks))
                    axes.set_aspect("equal")
                    _mark_axes(axes, shown, *ways)

                x, y = (
                    Axis(f"{shown.names[k]}{by} [{printed}]", limits=(-reach, reach), ticks=4)
                    for k in (across, up)
                )
                title = f"{run.label}, {'ball' if spatial else _PLACES[str(place)]}"
                panels.append(Panel(title, [ByHand(draw)], y, x))
    none = np.empty(0)
    outlines = " or ".join(dict.fromkeys(motion.attrs["outline_name"] for motion in motions))
    entries: list[PlotMark] = [PlotCurve(outlines, none, none, {"color": "black", "linewidth": 0.7})]
    if shade == "load":
        entries.append(PlotCurve("no contact", none, none, {"color": _FREE, "linewidth": 0.7}))
    panels[0] = Panel(panels[0].title, [*panels[0].marks, *entries], panels[0].y, panels[0].x)
    tangled = shade == "time" and float(norm.vmin or 0.0) > start
    where: dict[str, Any] = {"location": "bottom", "shrink": 0.6, "aspect": 40.0, "pad": 0.02}
    where |= {"extend": "min"} if tangled else {}
    words = "normal force [N]" if shade == "load" else "time [s]"
    before = f"in colour: from {norm.vmin:.4g} s on; grey: before" if tangled else ""
    columns, height = _squares(width, len(panels), 23.0 if any(picked.notes) else 18.0)
    rows = in_rows(panels, columns, alone=False)
    bar = (ScalarMappable(norm, colours), words, where)
    return Sheet(rows, width, height, (before, *picked.notes), every=True, bar=bar)


def _last_turns(run: LabelledRun, motion: xr.Dataset, joint: str) -> float:
    """Return the start of the last part of a path without tangles [s]."""
    outline = motion.attrs["outline"]
    across = float(np.linalg.norm(np.diff(outline, axis=0, append=outline[:1]), axis=1).sum()) / np.pi
    inside = Path(_AWAY * outline)
    begun = [float(run.time[0])]
    for place in range(motion.sizes["place"]):
        lengths, times = [], []
        for offset, time in _Path(run, motion, joint, place, np.eye(3)).parts():
            lengths.append(
                np.where(
                    inside.contains_points(offset[1:, :2]),
                    np.linalg.norm(np.diff(offset[:, :2], axis=0), axis=1),
                    0.0,
                )
            )
            times.append(time[1:])
        crossed = np.cumsum(np.concatenate(lengths)) / (across or 1.0)
        if crossed[-1] > _TANGLE:
            begun.append(float(np.concatenate(times)[np.searchsorted(crossed, crossed[-1] - _FOLLOWED)]))
    return max(begun)


def _bore_forces(run: LabelledRun, joint: str) -> Array:
    """Return the normal forces of the contacts in the bore or socket, (n, places) [N]."""
    names = run.contacts_of(joint, flanges=False)
    return np.stack([run.values("normal_force", contact=name) for name in names], axis=1)


def _line(axes: Axes, path: _Path, ways: list[int], load: Array | None, looks: dict[str, Any]) -> None:
    """Draw a path in the colours of time, or of load, the hardest last."""
    looks = {**looks, "capstyle": "round", "zorder": 2}
    if load is not None:
        points = path.whole[:, ways]
        many = len(points) > MANY // 20
        axes.plot(*points.T, color=_FREE, linewidth=0.4, zorder=1.5, rasterized=many)
        value = np.maximum(load[:-1], load[1:])
        order = np.argsort(value)
        # At a touch's first instant there is round-off only.
        order = order[value[order] > float(looks["norm"].vmin or 0.0)]
        draw_pieces(axes, points, value, order, linewidth=0.9, rasterized=many, **looks)
        return

    def parts() -> Iterator[tuple[Array, Array]]:
        for offset, time in path.parts():
            yield offset[:, ways], 0.5 * (time[:-1] + time[1:])

    if path.long:
        draw_parts(axes, parts, rasterized=True, linewidth=0.5, **looks)
        return
    points, value = next(parts())
    # Thousands of single pieces: as pixels they make a small file.
    draw_pieces(axes, points, value, linewidth=0.5, rasterized=len(points) > MANY // 20, **looks)


# --- the load around the bore ---

_MOST_RINGS = 1000
# Of both ends, dark and light: distinguishable in grey as well.
_LOOKS = {
    ("radial", "+"): ("end +", COLOURS[0]),
    ("radial", "-"): ("end \N{MINUS SIGN}", COLOURS[4]),
    ("radial", ""): ("bore", COLOURS[5]),
    ("spherical", ""): ("socket", COLOURS[5]),
}


@figure(sectors="Number of equal sectors.")
def figure_bore_load(
    runs: Runs, *, joint: str | None = None, sectors: int = 36, width: Width = "page"
) -> Figure:
    """Return the impulse of the normal force in each sector of the bore.

    Bars of the two ends of a bore stand on one another. The angle is that of the bearing's surface, from the
    bearing's x axis towards its y axis; of a single run on a page it stands over time as well. Under gravity
    "up" is against it, as far as the bearing keeps still.
    """
    picked = pick_touching(runs, joint)
    drawn, name = picked.drawn, picked.joint
    round_bore = all(set(_kinds_of(run, name)) <= {"radial", "spherical"} for run in drawn)
    over_time = len(drawn) == 1 and width == "page" and round_bore and "contact_point" in drawn[0].data
    if over_time:
        found = style.new_figure(width, 82.0)
        grid = found.add_gridspec(1, 2, width_ratios=[1.0, 1.35])
        panels = [found.add_subplot(grid[0, 0], projection="polar")]
        beside = found.add_subplot(grid[0, 1])
        _over_time(beside, drawn[0], name)
        style.panel_title(beside, "b", "where it was pressed")
    else:
        columns, height = _squares(width, len(drawn), 14.0)
        found = style.new_figure(width, height)
        grid = found.add_gridspec(-(-len(drawn) // columns), columns)
        places = [grid[k // columns, k % columns] for k in range(len(drawn))]
        panels = [found.add_subplot(place, projection="polar") for place in places]
    upright = False
    for letter, axes, run in zip(style.letters(), panels, drawn, strict=False):
        assert isinstance(axes, PolarAxes)
        words = _bars(axes, run, bore_load(run.data, name, sectors))
        shown = _shown_axes(run.data, name, spatial=False)
        if shown.up is not None:
            axes.set_theta_offset(0.5 * np.pi - np.arctan2(shown.up[1], shown.up[0]))
            upright = True
        style.panel_title(axes, letter if len(found.axes) > 1 else "", words)
    style.legend_above(found, panels)
    style.footnote(
        found,
        f"impulse of the normal force per sector of {360 / sectors:.3g}°",
        "rings: blows, the larger the harder" if over_time else "",
        "up: against gravity" if upright else "",
        *picked.notes,
    )
    return found


def _kinds_of(run: LabelledRun, joint: str) -> list[str]:
    """Return the kinds of the contacts in the bore."""
    kinds = contact_kinds(run.data)
    return [kinds[name] for name in run.contacts_of(joint, flanges=False)]


def _look(kind: str, end: str) -> tuple[str, str]:
    """Return name and colour of a contact; corners have those of their end."""
    key = ("radial", end[-2:-1]) if kind in ("wall", "key") else (kind, end)
    return _LOOKS.get(key, (kind + end, COLOURS[2]))


def _bars(axes: PolarAxes, run: LabelledRun, load: xr.Dataset) -> str:
    """Draw the load of each sector as a bar; return the panel's title."""
    impulse, angle = load["impulse"].values, load["angle"].values
    factor, printed = prefixed("N s", float(impulse.sum(axis=0).max(initial=0.0)))
    kinds, ends = contact_kinds(run.data), contact_ends(run.data)
    stacked: dict[tuple[str, str], Array] = {}
    for contact, taken in zip(load["contact"].values, factor * impulse, strict=True):
        look = _look(kinds[str(contact)], ends[str(contact)])
        stacked[look] = stacked.get(look, 0.0) + taken
    below = np.zeros(angle.size)
    for (name, colour), taken in stacked.items():
        bars: dict[str, Any] = {"color": colour, "edgecolor": "white", "linewidth": 0.25}
        axes.bar(angle, taken, label=name, bottom=below, width=2.0 * np.pi / angle.size, **bars)
        below = below + taken
    if below.any():
        axes.set_ylim(0.0, 1.05 * below.max())
        # Numbers of the rings stand where the load is least.
        around = np.convolve(np.tile(below, 3), np.ones(5), "same")[angle.size : 2 * angle.size]
        ticks = MaxNLocator(3, steps=[1, 2, 5, 10]).tick_values(0.0, below.max())
        rings = [float(tick) for tick in ticks if 0.0 < tick <= below.max()]
        axes.set_rgrids(rings, angle=np.degrees(angle[int(np.argmin(around))]), fontsize=6.5)
    else:
        axes.text(0.5, 0.6, "no contact", transform=axes.transAxes, ha="center")
        axes.set_yticks([])
    names = ["x", "45°", "y", "135°", "180°", "225°", "270°", "315°"]
    axes.set_thetagrids(np.arange(0, 360, 45), names, fontsize=6.5)
    axes.tick_params(axis="x", pad=-1.0)
    total, unit = prefixed("N s", float(impulse.sum()))
    return (
        f"{run.label}\nin all {style.three_digits(total * float(impulse.sum()))} {unit}; rings in {printed}"
    )


def _over_time(axes: Axes, run: LabelledRun, joint: str) -> None:
    """Draw the direction of contacts over time, with rings at blows."""
    kinds, ends = contact_kinds(run.data), contact_ends(run.data)
    blows = sharp(run, run)
    hardest = float(run.values("peak_force")[blows].max(initial=0.0)) if blows.any() else 0.0
    shown = thinned(
        run, lambda part: [_direction(part, name) for name in run.contacts_of(joint, flanges=False)]
    )
    for name in run.contacts_of(joint, flanges=False):
        colour = _look(kinds[name], ends[name])[1]
        looks: dict[str, Any] = {"linestyle": "none", "color": colour, "markeredgewidth": 0.0}
        angle = _direction(shown, name)
        axes.plot(shown.time, angle, marker=".", markersize=1.2, rasterized=True, **looks)
        mine = np.flatnonzero(blows & episodes_of(run, [name]))
        mine = mine[np.argsort(run.values("peak_force")[mine])][-_MOST_RINGS:]
        at = run.values("peak_time")[mine]
        place = np.searchsorted(run.time, at).clip(0, run.time.size - 1)
        size = run.values("peak_force")[mine] / (hardest or 1.0)
        axes.scatter(
            at,
            _direction(run, name)[place],
            s=36.0 * size + 0.5,
            facecolors="none",
            edgecolors=colour,
            linewidths=0.5,
            rasterized=True,
        )
    axes.set_xlim(float(run.time[0]), float(run.time[-1]))
    axes.set_ylim(-180.0, 180.0)
    few_ticks(axes, 5)
    axes.set_yticks(range(-180, 181, 90), ["\N{MINUS SIGN}180°", "\N{MINUS SIGN}y", "x", "y", "180°"])
    axes.set_xlabel("time [s]")
    axes.set_ylabel("direction in the bearing")


def _direction(run: LabelledRun, contact: str) -> Array:
    """Return a contact's direction from the x axis [deg]; NaN without pressure."""
    x, y, _ = run.values("contact_point", contact=contact).T
    pressed = run.values("normal_force", contact=contact) > 0.0
    return np.where(pressed, np.degrees(np.arctan2(y, x)), np.nan)


FIGURES = (
    RunFigure("journal_orbit", "Orbit of the journal in {joint}", figure_orbit, of=TOUCHING, compares=False),
    RunFigure("bore_load", "Load around the bore of {joint}", figure_bore_load, of=TOUCHING, compares=False),
)
