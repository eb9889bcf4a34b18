"""Phase portraits: a line in two or three quantities, coloured by time, or the time spent in each place."""

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d import Axes3D
from mpl_toolkits.mplot3d.art3d import Line3DCollection

from antenna_pin.analysis import PhasePortrait, Quantity
from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.plot._lines import draw_pieces
from antenna_pin.plot._style import (
    SEQUENTIAL,
    Array,
    Width,
    few_ticks,
    footnote,
    literal,
    new_figure,
    panel_title,
    prefixed,
    styled,
)

PhaseShade = Literal["time", "density"]
_CELLS = 2000  # across a figure: what lies in one cell is one place to the eye
_BINS, _EVEN = 160, 1_000_000
_SLIVER = 4.0  # sides of an axes with one scale, the longer over the shorter, at most
_MANY = 2500  # pieces beyond which a line is drawn as pixels in a vector file


@takes()
@styled
def figure_phase(portrait: PhasePortrait, *, shade: PhaseShade = "time", width: Width = "page") -> Figure:
    """Return a phase portrait (:func:`antenna_pin.analysis.phase_portrait`), in the plane or in space.

    Two quantities of one unit, as a journal's path has, have axes of one scale, unless one is far smaller. Of
    a long series, points that follow one another in the same two thousandth of the axes are drawn as one.

    Args:
        portrait: Two or three quantities.
        shade: "time" for a line whose colour is the time; "density", of two quantities, for the share of
            the time that was spent in each place.
        width: "column" (88 mm) or "page" (180 mm).
    """
    if shade not in ("time", "density"):
        raise UnknownNameError("figure", "shade", shade, ("time", "density"))
    spatial = len(portrait.quantities) == 3
    if spatial and shade == "density":
        raise InvalidParameterError("figure", "shade", "time for three quantities", shade)
    alike = len({one.units for one in portrait.quantities}) == 1 and bool(portrait.quantities[0].units)
    sizes = [float(np.nanmax(np.abs(one.values), initial=0.0)) for one in portrait.quantities]
    sizes = [max(sizes)] * len(sizes) if alike else sizes
    columns, labels = zip(*map(_scaled, portrait.quantities, sizes), strict=True)
    points = np.column_stack(columns)
    figure = new_figure(width, 120.0 if width == "page" else 82.0)
    if shade == "density":
        axes, mappable, words = *_density(figure, points, portrait.time), "share of the time [%]"
    else:
        axes, mappable = _line(figure, points, portrait.time)
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
    bar: Any = figure.colorbar(mappable, ax=axes, label=words, pad=0.02, **where)
    bar.outline.set_linewidth(0.4)
    panel_title(axes, "", portrait.run)
    footnote(figure, f"{portrait.rule}, to {portrait.time[-1]:.6g} s")
    return figure


def _scaled(one: Quantity, largest: float) -> tuple[Array, str]:
    """Return values up to some size in a readable unit, and the label of their axis."""
    factor, unit = prefixed(one.units, largest)
    return factor * one.values, literal(f"{one.name} [{unit}]" if unit else one.name)


def thinned(points: Array) -> npt.NDArray[np.intp]:
    """Return the indices of the points, (n, d), at which a line enters or leaves a cell of the picture."""
    low, span = points.min(axis=0), np.ptp(points, axis=0)
    cell = np.floor((points - low) / np.where(span > 0.0, span, 1.0) * _CELLS)
    moves = np.any(cell[1:] != cell[:-1], axis=1)
    kept = np.ones(len(points), dtype=bool)
    kept[1:-1] = moves[:-1] | moves[1:]
    return np.flatnonzero(kept)


def _line(figure: Figure, points: Array, time: Array) -> tuple[Axes, ScalarMappable]:
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
        space = figure.add_subplot(projection="3d")
        assert isinstance(space, Axes3D)
        space.add_collection3d(Line3DCollection(list(pieces), array=values, **looks))
        for name, column in zip("xyz", points.T, strict=True):
            getattr(space, f"set_{name}lim")(*_limits(column))
            axis = getattr(space, f"{name}axis")
            axis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
            axis.pane.set(facecolor="white", edgecolor="#BBBBBB")
        space.view_init(elev=24.0, azim=-58.0)
        # Labels stand outside the box, where no layout makes room for them.
        space.set_box_aspect(None, zoom=0.9 if figure.get_figwidth() > 5.0 else 0.7)
        return space, ScalarMappable(norm, SEQUENTIAL)
    axes = figure.add_subplot()
    draw_pieces(axes, line, values, **looks)
    axes.set(xlim=_limits(points[:, 0]), ylim=_limits(points[:, 1]))
    few_ticks(axes)
    return axes, ScalarMappable(norm, SEQUENTIAL)


def _density(figure: Figure, points: Array, time: Array) -> tuple[Axes, ScalarMappable]:
    """Draw the share of the time in each cell, along straight lines between the samples."""
    axes = figure.add_subplot()
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
    """Return limits with a margin; about a constant, wide enough to show that it is one."""
    low, high = float(column.min()), float(column.max())
    margin = 0.04 * (high - low) or 0.05 * abs(low) or 1.0
    return low - margin, high + margin
