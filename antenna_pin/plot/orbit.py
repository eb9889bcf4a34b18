"""The journal in its bearing: its orbit inside the clearance circle."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, Literal

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Colormap, LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.path import Path

from antenna_pin.analysis import LONG, blocks, journal_motion
from antenna_pin.base.arguments import takes
from antenna_pin.errors import UnknownNameError
from antenna_pin.plot._kinds import TOUCHING, choose_joint
from antenna_pin.plot._layout import square_panels
from antenna_pin.plot._lines import draw_parts, draw_pieces
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, smooth, too_short
from antenna_pin.plot._style import (
    MANY,
    SEQUENTIAL,
    Array,
    Width,
    few_ticks,
    footnote,
    letters,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot._upright import mark_axes, shown_axes

# --- where the journal passes in its bearing, of a long run part by part ---


def farthest(run: LabelledRun, joint: str) -> float:
    """Return the largest eccentricity of the journal in a run [m]."""
    parts = (journal_motion(part, joint)["eccentricity"].values for part in blocks(run.data))
    return float(np.nanmax([np.nanmax(part) for part in parts]))


class JournalPath:
    """Where the journal's axis or centre passes, at one place.

    Args:
        run: Its samples.
        motion: Of the journal in the first part of them, which is all of a run that is not long.
        joint: The joint with clearance.
        place: Number of the place.
        turn: Turns offsets to the axes that are shown, and scales them, (3, 3).
    """

    def __init__(self, run: LabelledRun, motion: xr.Dataset, joint: str, place: int, turn: Array) -> None:
        """Look at how long it is."""
        self._run, self._motion, self._joint, self._place, self._turn = run, motion, joint, place, turn
        self.long = run.time.size > LONG

    def parts(self) -> Iterator[tuple[Array, Array]]:
        """Yield offsets (m, 3) and times (m,) [s], each part from the last sample of the one before on."""
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


Shade = Literal["time", "load"]
_FREE = "#B8B8B8"
_SINCE = SEQUENTIAL.with_extremes(under="#D4D4D4")
# Times that a path crosses its play, by its length away from the outline: so many are a tangle, of which so
# many are in colour.
_TANGLE, _FOLLOWED = 18.0, 6.0
_AWAY = 0.95  # of the outline
# Across, up: which axes of the bearing a panel shows.
_ACROSS = ((0, 1),)
_PROJECTIONS = ((0, 1), (0, 2), (1, 2))
_ALIKE = 2.0  # clearances whose ratio is no larger are drawn on one scale [-]
_PLACES = {"+": "end +", "-": "end \N{MINUS SIGN}", "centre": "centre"}


@takes()
@styled
def figure_orbit(
    runs: Iterable[Run] | Run, *, joint: str | None = None, shade: Shade = "time", width: Width = "page"
) -> Figure:
    """Return the orbit of the journal inside the clearance circle, in the bearing's plane.

    A revolute joint has two panels: where the journal's axis passes through the plane of each end of the
    bore. Outside the circle the surfaces are pressed into each other, by a hundredth of the clearance or so.
    A ball joint has the three projections of its ball's centre. A slider's axis is seen at its own two ends,
    inside the rectangle that its guide leaves it. Between samples the path is that of their places and
    velocities. Where the largest clearance is more than twice the smallest, every run is drawn in its own.

    Of a journal that crosses its play many times the last of it is in colour, what was before in grey.

    Under gravity "up" is against it, as far as the bearing keeps still: the labels say which axis of the
    bearing that is, and a triad in the corner shows its axes where others than x and y are across and up.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint with clearance; the first one if left out.
        shade: "time", or "load": the size of the contact force, flight in grey.
        width: "column" (88 mm) or "page" (180 mm).
    """
    if shade not in ("time", "load"):
        raise UnknownNameError("figure", "shade", shade, ("time", "load"))
    every = labelled(runs)
    joint = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if joint in run.clearance_joints]
    curves = [smooth(run, joint) for run in drawn]
    # Of a long run what holds for all of it is that of its first part; its path is made while it is drawn.
    motions = [journal_motion(next(blocks(curve.data)), joint) for curve in curves]
    planes = [_PROJECTIONS if motion.attrs["spatial"] else _ACROSS for motion in motions]
    count = sum(motion.sizes["place"] * len(plane) for motion, plane in zip(motions, planes, strict=True))
    note = left_out(every, drawn, "no clearance in this joint")
    figure, panels = square_panels(width, count, 23.0 if note or too_short(every) else 18.0)
    # The whole play is in view, however little the journal has moved.
    sizes = [
        float(max(farthest(curve, joint), np.abs(motion.attrs["outline"]).max()))
        for curve, motion in zip(curves, motions, strict=True)
    ]
    clearances = [float(motion.attrs["radial_clearance"]) for motion in motions]
    if max(clearances) > _ALIKE * min(clearances):  # on one scale the smallest would be a dot
        factors, printed, by = [1.0 / one for one in clearances], "-", " / clearance"
    else:
        factor, printed = prefixed("m", max(sizes))
        factors, by = [factor] * len(drawn), ""
    reach = 1.1 * max(factor * size for factor, size in zip(factors, sizes, strict=True))
    loads = [_bore_forces(curve, joint) if shade == "load" else np.zeros((0, 0)) for curve in curves]
    begun = [min(run.time[0] for run in drawn)]
    if shade == "time":
        begun += [_last_turns(*one, joint) for one in zip(curves, motions, strict=True)]
    norm = _norm(shade, drawn, loads, max(begun))
    letter = letters()
    panel = iter(panels)
    for run, curve, motion, plane, load, factor in zip(
        drawn, curves, motions, planes, loads, factors, strict=True
    ):
        shown = shown_axes(run.data, joint, spatial=len(plane) > 1)
        outline = motion.attrs["outline"]
        outline = factor * (np.pad(outline, ((0, 0), (0, 1))) @ shown.turn.T)[:, :2]
        if len(plane) > 1:
            outline = factor * motion.attrs["outline"]  # a circle however it is seen
        for number, place in enumerate(motion["place"].values):
            path = JournalPath(curve, motion, joint, number, factor * shown.turn)
            for across, up in plane:
                axes = next(panel)
                if shade == "time":
                    _line(axes, path, [across, up], norm)
                else:
                    offset = path.whole
                    _loaded_line(axes, offset[:, across], offset[:, up], load[:, number], norm)
                axes.add_patch(
                    Polygon(outline, closed=True, fill=False, edgecolor="black", linewidth=0.6, zorder=1.6)
                )
                axes.set(xlim=(-reach, reach), ylim=(-reach, reach))
                axes.set_aspect("equal")
                few_ticks(axes, 4, 4)
                axes.set_xlabel(f"{shown.names[across]}{by} [{printed}]")
                axes.set_ylabel(f"{shown.names[up]}{by} [{printed}]")
                mark_axes(axes, shown, across, up)
                seen = "ball" if len(plane) > 1 else _PLACES[str(place)]
                panel_title(axes, next(letter) if count > 1 else "", f"{run.label}, {seen}")
    words = "normal force [N]" if shade == "load" else "time [s]"
    where: dict[str, Any] = {"location": "bottom", "shrink": 0.6, "aspect": 40.0, "pad": 0.02}
    tangled = shade == "time" and float(norm.vmin or 0.0) > min(run.time[0] for run in drawn)
    if tangled:
        where["extend"] = "min"
    bar = figure.colorbar(ScalarMappable(norm, _colours(shade)), ax=panels, label=words, **where)
    bar.outline.set_linewidth(0.4)
    handles = [Line2D([], [], color="black", linewidth=0.7)]
    names = [" or ".join(dict.fromkeys(motion.attrs["outline_name"] for motion in motions))]
    if shade == "load":
        handles.append(Line2D([], [], color=_FREE, linewidth=0.7))
        names.append("no contact")
    figure.legend(handles, names, loc="outside upper center", ncols=2)
    before = f"in colour: from {norm.vmin:.4g} s on; grey: before" if tangled else ""
    footnote(figure, before, too_short(every), note)
    return figure


def _last_turns(run: LabelledRun, motion: xr.Dataset, joint: str) -> float:
    """Return from when on the path is so long that it can be followed, its start if all of it can be [s]."""
    outline = motion.attrs["outline"]
    across = float(np.linalg.norm(np.diff(outline, axis=0, append=outline[:1]), axis=1).sum()) / np.pi
    inside = Path(_AWAY * outline)
    begun = [float(run.time[0])]
    for place in range(motion.sizes["place"]):
        lengths, times = [], []
        for offset, time in JournalPath(run, motion, joint, place, np.eye(3)).parts():
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


def _norm(shade: Shade, runs: list[LabelledRun], loads: list[Array], begun: float) -> Normalize:
    if shade == "time":
        return Normalize(begun, max(run.time[-1] for run in runs))
    largest = max(float(np.nanmax(load, initial=0.0)) for load in loads) or 1.0
    return LogNorm(1e-4 * largest, largest)


def _colours(shade: Shade) -> Colormap:
    """Return late times light, large loads dark."""
    return SEQUENTIAL.reversed() if shade == "load" else _SINCE


def _bore_forces(run: LabelledRun, joint: str) -> Array:
    """Return the normal forces of the contacts in the bore or socket, (n, places) [N]."""
    names = run.contacts_of(joint, flanges=False)
    return np.stack([run.values("normal_force", contact=name) for name in names], axis=1)


def _line(axes: Axes, path: JournalPath, shown: list[int], norm: Normalize) -> None:
    """Draw a line whose colour is the mean time of each piece's ends."""
    looks: dict[str, Any] = {
        "cmap": _SINCE,
        "norm": norm,
        "linewidth": 0.5,
        "capstyle": "round",
        "zorder": 2,
    }

    def parts() -> Iterator[tuple[Array, Array]]:
        for offset, time in path.parts():
            yield offset[:, shown], 0.5 * (time[:-1] + time[1:])

    if path.long:
        draw_parts(axes, parts, rasterized=True, **looks)
        return
    points, value = next(parts())
    # Thousands of single pieces: as pixels they make a small file.
    draw_pieces(axes, points, value, rasterized=len(points) > MANY // 20, **looks)


def _loaded_line(axes: Axes, x: Array, y: Array, load: Array, norm: Normalize) -> None:
    """Draw flight in grey, and the pieces with load above it, the hardest last."""
    many = x.size > MANY // 20
    axes.plot(x, y, color=_FREE, linewidth=0.4, zorder=1.5, rasterized=many)
    value = np.maximum(load[:-1], load[1:])
    order = np.argsort(value)
    # At a touch's first instant there is round-off only.
    order = order[value[order] > float(norm.vmin or 0.0)]
    draw_pieces(
        axes,
        np.stack([x, y], axis=1),
        value,
        order,
        cmap=_colours("load"),
        norm=norm,
        linewidth=0.9,
        capstyle="round",
        zorder=2,
        rasterized=many,
    )


FIGURES = (
    RunFigure(
        name="journal_orbit",
        title="Orbit of the journal in {joint}",
        function=figure_orbit,
        of=TOUCHING,
        compares=False,
    ),
)
