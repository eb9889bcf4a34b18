"""Phase portraits in the plane and in space, and attractors with their sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from antenna_pin.analysis import PhasePortrait, Recurrence, RecurrenceKind, quantity, recurrence
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot._style import (
    PEAK,
    SEQUENTIAL,
    Array,
    Width,
    draw_pieces,
    few_ticks,
    footnote,
    new_figure,
    panel_title,
)
from antenna_pin.show.plot.grammar import Axis, Panel, PlotCurve, Sheet, colour_bar, figure, size_of
from antenna_pin.trajectory import Trajectory

# --- portraits ---

PhaseShade = Literal["time", "density"]
_CELLS = 2000  # across a figure: what lies in one cell is one place to the eye
_BINS, _EVEN = 160, 1_000_000
_SLIVER = 4.0  # sides of an axes with one scale, the longer over the shorter, at most
_MANY = 2500  # pieces beyond which a line is drawn as pixels in a vector file


@figure(
    portrait="Two or three quantities.",
    shade='"time" for a line whose colour is the time; "density", of two quantities, for the share of the '
    "time that was spent in each place.",
)
def figure_phase(portrait: PhasePortrait, *, shade: PhaseShade = "time", width: Width = "page") -> Figure:
    """Return a phase portrait (:func:`antenna_pin.analysis.phase_portrait`), in the plane or in space.

    Two quantities of one unit, as a journal's path has, have axes of one scale, unless one is far smaller. Of
    a long series, points that follow one another in the same two thousandth of the axes are drawn as one.
    """
    if shade not in ("time", "density"):
        raise UnknownNameError("figure", "shade", shade, ("time", "density"))
    spatial = len(portrait.quantities) == 3
    if spatial and shade == "density":
        raise InvalidParameterError("figure", "shade", "time for three quantities", shade)
    alike = len({one.units for one in portrait.quantities}) == 1 and bool(portrait.quantities[0].units)
    sizes = [size_of(one.values) for one in portrait.quantities]
    sizes = [max(sizes)] * len(sizes) if alike else sizes
    scales = [Axis(one.name, one.units, size) for one, size in zip(portrait.quantities, sizes, strict=True)]
    factors, labels = zip(*(one.scaled(0.0) for one in scales), strict=True)
    columns = (f * one.values for f, one in zip(factors, portrait.quantities, strict=True))
    points = np.column_stack([*columns])
    found = new_figure(width, 120.0 if width == "page" else 82.0)
    if shade == "density":
        axes, mappable, words = *_density(found, points, portrait.time), "share of the time [%]"
    else:
        axes, mappable = _line(found, points, portrait.time)
        words = "time [s]"
    axes.set_xlabel(labels[0])
    axes.set_ylabel(labels[1])
    ways = [float(np.ptp(axis)) for axis in (axes.get_xlim(), axes.get_ylim())]
    if alike and not isinstance(axes, Axes3D) and max(ways) < _SLIVER * min(ways):
        axes.set_aspect("equal", adjustable="box")
    if isinstance(axes, Axes3D):
        axes.set_zlabel(labels[2])
    # Beside a portrait in space a bar would cover the label of the third axis.
    where: dict[str, Any] = {"location": "bottom" if spatial else "right", "shrink": 0.7, "aspect": 36.0}
    colour_bar(found, axes, mappable, words, {"pad": 0.02, **where})
    panel_title(axes, "", portrait.run)
    footnote(found, f"{portrait.rule}, to {portrait.time[-1]:.6g} s")
    return found


def thinned(points: Array) -> npt.NDArray[np.intp]:
    """Return indices of points, (n, d), where a line changes its cell."""
    low, span = points.min(axis=0), np.ptp(points, axis=0)
    cell = np.floor((points - low) / np.where(span > 0.0, span, 1.0) * _CELLS)
    moves = np.any(cell[1:] != cell[:-1], axis=1)
    kept = np.ones(len(points), dtype=bool)
    kept[1:-1] = moves[:-1] | moves[1:]
    return np.flatnonzero(kept)


def _line(drawing: Figure, points: Array, time: Array) -> tuple[Axes, ScalarMappable]:
    norm = Normalize(float(time[0]), float(time[-1]))
    finite = np.isfinite(points).all(axis=1)
    points, time = points[finite], time[finite]
    kept = thinned(points)
    line, when = points[kept], time[kept]
    values = 0.5 * (when[:-1] + when[1:])
    looks: dict[str, Any] = {
        "cmap": SEQUENTIAL,
        "norm": norm,
        "linewidth": 0.6 if len(line) < 20_000 else 0.35,
        "capstyle": "round",
        "rasterized": len(line) > _MANY,
    }
    if points.shape[1] == 3:
        pieces = np.stack([line[:-1], line[1:]], axis=1)
        space = drawing.add_subplot(projection="3d")
        assert isinstance(space, Axes3D)
        space.add_collection3d(Line3DCollection(list(pieces), array=values, **looks))
        for name, column in zip("xyz", points.T, strict=True):
            getattr(space, f"set_{name}lim")(*_limits(column))
            axis = getattr(space, f"{name}axis")
            axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
            axis.pane.set(facecolor="white", edgecolor="#BBBBBB")
        space.view_init(elev=24.0, azim=-58.0)
        # Labels stand outside the box, where no layout makes room for them.
        space.set_box_aspect(None, zoom=0.9 if drawing.get_figwidth() > 5.0 else 0.7)
        return space, ScalarMappable(norm, SEQUENTIAL)
    axes = drawing.add_subplot()
    draw_pieces(axes, line, values, **looks)
    axes.set(xlim=_limits(points[:, 0]), ylim=_limits(points[:, 1]))
    few_ticks(axes)
    return axes, ScalarMappable(norm, SEQUENTIAL)


def _density(drawing: Figure, points: Array, time: Array) -> tuple[Axes, ScalarMappable]:
    """Draw the share of the time in each cell, along straight lines between the samples."""
    axes = drawing.add_subplot()
    finite = np.isfinite(points).all(axis=1)
    even = np.linspace(time[finite][0], time[finite][-1], _EVEN)
    dense = [np.interp(even, time[finite], column[finite]) for column in points.T]
    where = np.array([_limits(column) for column in dense])
    share, x, y = np.histogram2d(dense[0], dense[1], bins=_BINS, range=where)
    share = 100.0 * share / _EVEN
    shown = np.ma.masked_less_equal(share.T, 0.0)
    norm = LogNorm(max(float(shown.min()), 1e-5 * float(shown.max())), float(shown.max()))
    mesh = axes.pcolormesh(x, y, shown, cmap=SEQUENTIAL.reversed(), norm=norm, rasterized=True)
    few_ticks(axes)
    return axes, mesh


def _limits(column: Array) -> tuple[float, float]:
    """Return limits with a margin, wide about a constant."""
    low, high = float(column.min()), float(column.max())
    margin = 0.04 * (high - low) or 0.05 * abs(low) or 1.0
    return low - margin, high + margin


# --- attractors ---

#: Share of the range of a motion below which points are the same [-]: far above the noise of runs of an
#: accuracy of 1e-5, which is 3e-8 for the parallel mechanism, and below what anybody would see.
SAME = 1e-6
#: Share of a portrait that one dot in it covers, and the eye takes for one place [-].
SEEN = 5e-3
# Of these the words say more than the kind: the period, and how many bands of chaos there are.
_IN_FULL = (RecurrenceKind.PERIODIC, RecurrenceKind.CHAOTIC)
# Smallest range of a map over the line's: points closer together are one.
_NEAREST = 1e-2


@dataclass(frozen=True, slots=True, eq=False)
class Attractor:
    """A settled motion.

    Attributes:
        label: Name.
        section: Points (:func:`antenna_pin.studies.nonlinear.poincare`).
        run: Stretch of the motion.
    """

    label: str
    section: xr.Dataset
    run: Trajectory | xr.Dataset

    @property
    def settled(self) -> bool:
        """Return whether the points have settled."""
        return bool(self.section["settled"].item())

    def points(self, *names: str) -> Array:
        """Return its points in some quantities, (n, len(names)).

        Raises:
            InvalidParameterError: The section has not all of them.
        """
        missing = [name for name in names if name not in self.section]
        if missing:
            rule = f"one that holds {' and '.join(missing)}"
            raise InvalidParameterError("attractor", "section", rule, ", ".join(map(str, self.section)))
        return np.column_stack([np.asarray(self.section[name].values, dtype=float) for name in names])

    def ranges(self, *names: str) -> Array:
        """Return the extent of the motion in some quantities."""
        lines = [quantity(self.run, name).values for name in names]
        ends = zip(lines, self.points(*names).T, strict=True)
        return np.array([np.ptp(np.concatenate([line, column])) for line, column in ends])

    def recurs(self, *names: str, tolerance: float = SAME) -> Recurrence:
        """Return the recurrence of its points, by the range of the motion in each quantity.

        Points within a share ``tolerance`` of the range are the same [-]: above the error of the run.
        """
        span = self.ranges(*names)
        points, scale = self.points(*names), np.where(span > 0.0, span, 1.0)
        found = recurrence(points, scale=scale, tolerance=tolerance)
        if found.period in (None, 1):
            return found
        # A period among points that are hardly farther apart than the tolerance is none yet.
        return recurrence(points, scale=scale, tolerance=min(tolerance, 1e-2 * self.spread(*names)))

    def spread(self, *names: str) -> float:
        """Return the points' largest extent, as a share of the motion's [-]."""
        span = self.ranges(*names)
        return float((np.ptp(self.points(*names), axis=0) / np.where(span > 0.0, span, 1.0)).max())

    def words(self, *names: str, tolerance: float = SAME) -> str:
        """Describe the recurrence; aperiodic motion also by its points' extent."""
        if not self.settled:
            return "not settled"
        found = self.recurs(*names, tolerance=tolerance)
        said = found.words if found.kind in _IN_FULL else found.kind.value
        return said if found.period is not None else f"{said}, over {self.spread(*names):.1g}"


@figure(
    attractors="One or more.",
    x="Name of the quantity across, as :func:`antenna_pin.analysis.quantity` has it.",
    y="Of the quantity upward.",
    tolerance="Share of the range below which points are the same [-].",
)
def figure_attractors(
    attractors: Sequence[Attractor], x: str, y: str, *, tolerance: float = SAME, width: Width = "page"
) -> Sheet:
    """Return phase trajectories and Poincare maps of settled motions, a row for each.

    A map is drawn as near as its points lie, but no nearer than a hundredth of the trajectory's range.
    """
    if not attractors:
        raise InvalidParameterError("figure", "attractors", "one or more", said="none")
    rows = []
    dots = {"linestyle": "none", "marker": ".", "markersize": 2.5, "markeredgewidth": 0.0, "color": PEAK}
    for one in attractors:
        lines, points = [quantity(one.run, name) for name in (x, y)], one.points(x, y)
        near = np.maximum(one.ranges(x, y) * _NEAREST, 1.1 * np.ptp(points, axis=0))
        middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
        half = 0.5 * np.where(near > 0.0, near, 1.0)
        whole = [
            Axis(name, line.units, size_of(line.values), ticks=ticks)
            for name, line, ticks in zip((x, y), lines, (6, 5), strict=True)
        ]
        ends = zip((middle - half).tolist(), (middle + half).tolist(), strict=True)
        close = [replace(axis, limits=limits) for axis, limits in zip(whole, ends, strict=True)]
        line = PlotCurve("", lines[0].values, lines[1].values, {"linewidth": 0.5})
        words = one.words(x, y, tolerance=tolerance)
        map_ = Panel(words, [PlotCurve("", points[:, 0], points[:, 1], dots)], close[1], close[0])
        rows.append([Panel(one.label, [line], whole[1], whole[0]), map_])
    periods = {float(one.section.attrs["period"]) for one in attractors}
    said = f"{attractors[0].section.attrs['section']}; " if len(periods) == 1 else ""
    note = said + f"points within {tolerance:.0e} of the trajectory's range are the same"
    height = 12.0 + (50.0 if width == "page" else 38.0) * len(attractors)
    return Sheet(rows, width, height, (note,), every=True)
