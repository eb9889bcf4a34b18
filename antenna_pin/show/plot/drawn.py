"""Numbers of a drawn figure: lines, points, pieces and bars."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import Collection, LineCollection, PathCollection, PolyCollection, QuadMesh
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path

from antenna_pin.base.arguments import takes
from antenna_pin.show.plot._style import Array

_LETTER = re.compile(r"\$\\bf\{(\([a-z]+\))\}\$")
# Cells of a coloured field that are numbers still; of a larger one the picture has to do.
_CELLS = 20_000


@dataclass(frozen=True, slots=True, eq=False)
class Drawn:
    """Numbers of one line, cloud of points or set of bars.

    Attributes:
        panel: Title of its panel.
        label: Name in the legend; empty if it has none.
        names: Names of its columns, with the units of the axes.
        columns: Numbers, each (n,), in those units.
    """

    panel: str
    label: str
    names: tuple[str, ...]
    columns: tuple[Array, ...]


@takes()
def drawn_numbers(figure: Figure) -> list[Drawn]:
    """Return the numbers of a figure panel by panel, in the units of its axes.

    Rules across a panel (zero, a limit) are left out. A close view of a line that another panel has whole is
    not repeated.

    Args:
        figure: Figure drawn by a function of this room.
    """
    found: list[Drawn] = []
    for axes in figure.axes:
        if axes.get_label() == "<colorbar>":
            continue
        for one in _of_panel(figure, axes):
            if one.columns[0].size and not any(_is_part(one, other) for other in found):
                found.append(one)
    return found


def _of_panel(figure: Figure, axes: Axes) -> Iterator[Drawn]:
    panel = _plain(axes.get_title(loc="left") or axes.get_title())
    if axes.name == "polar":  # whose labels are not those of the panels beside it
        x, y = "angle [rad]", _plain(axes.get_ylabel()) or "radius"
    else:
        x = _plain(axes.get_xlabel() or _time_below(figure, axes)) or "x"
        y = _plain(axes.get_ylabel() or figure.get_supylabel() or _label_beside(figure, axes)) or "y"
    for line in axes.lines:
        if line.get_transform().contains_branch_seperately(axes.transData) == (True, True):
            columns = (_numbers(line.get_xdata(orig=False)), _numbers(line.get_ydata(orig=False)))
            yield Drawn(panel, _label(line), (x, y), columns)
    for many in axes.collections:
        yield from _of_collection(panel, (x, y), many)
    for bars in axes.containers:
        boxes = [one for one in bars.get_children() if isinstance(one, Rectangle)]
        if boxes:
            middle = np.array([one.get_x() + 0.5 * one.get_width() for one in boxes])
            ends = np.array([one.get_y() + one.get_height() for one in boxes])
            yield Drawn(panel, _label(bars), (x, y), (middle, ends))
    for patch in axes.patches:
        if isinstance(patch, PathPatch):
            yield from _of_boxes(panel, (x, y), _label(patch), _pieces(patch.get_path()))


def _of_collection(panel: str, names: tuple[str, str], many: Collection) -> Iterator[Drawn]:
    x, y = names
    values = many.get_array()
    if isinstance(many, PathCollection):
        points = _numbers(many.get_offsets())
        more = () if values is None or values.size != len(points) else (_numbers(values),)
        kinds = (x, y, "colour")[: 2 + len(more)]
        yield Drawn(panel, _label(many), kinds, (points[:, 0], points[:, 1], *more))
    elif isinstance(many, LineCollection):
        lines = (np.asarray(path.vertices, dtype=float) for path in many.get_paths())
        pieces = [line for line in lines if len(line) == 2]
        if not pieces:
            return
        ends = np.asarray(pieces, dtype=float)
        if np.array_equal(ends[1:, 0], ends[:-1, 1]) and len(ends) > 1:  # a line in pieces of many colours
            line = np.concatenate([ends[:1, 0], ends[:, 1]])
            yield Drawn(panel, _label(many), (x, y), (line[:, 0], line[:, 1]))
        else:
            yield Drawn(panel, _label(many), (x, y), (ends[:, 1, 0], ends[:, 1, 1]))
    elif isinstance(many, QuadMesh) and values is not None and values.size <= _CELLS:
        corners = np.asarray(many.get_coordinates(), dtype=float)
        middles = 0.25 * (corners[1:, 1:] + corners[1:, :-1] + corners[:-1, 1:] + corners[:-1, :-1])
        yield Drawn(
            panel, _label(many), (x, y, "colour"), (*middles.reshape(-1, 2).T, _numbers(values).ravel())
        )
    elif isinstance(many, PolyCollection):
        every = [np.asarray(path.vertices, dtype=float) for path in many.get_paths()]
        yield from _of_boxes(panel, names, _label(many), every)


def _pieces(path: Path) -> list[Array]:
    """Return the corners of each piece of a path that is drawn in several."""
    corners, codes = np.asarray(path.vertices, dtype=float), path.codes
    if codes is None:
        return [corners]
    return np.split(corners, np.flatnonzero(codes == Path.MOVETO)[1:])


def _of_boxes(panel: str, names: tuple[str, str], label: str, every: list[Array]) -> Iterator[Drawn]:
    """Yield the numbers of areas that all have four corners."""
    x, y = names
    if every and all(len(one) in (4, 5) for one in every):
        least, most = (np.array([pick(box, axis=0) for box in every]) for pick in (np.min, np.max))
        said = (f"{x}, from", f"{x}, to", f"{y}, from", f"{y}, to")
        yield Drawn(panel, label, said, (least[:, 0], most[:, 0], least[:, 1], most[:, 1]))


def _is_part(one: Drawn, whole: Drawn) -> bool:
    """Return whether a line is part of another panel's line."""
    if one.label != whole.label or len(one.columns) != 2 or len(whole.columns) != 2:
        return False
    x, count = one.columns[0], one.columns[0].size
    # Of several samples at an instant the first may be outside a close view.
    for first in np.flatnonzero(whole.columns[0] == x[0])[:3]:
        stretch = slice(int(first), int(first) + count)
        if all(
            np.array_equal(mine, its[stretch], equal_nan=True)
            for mine, its in zip(one.columns, whole.columns, strict=True)
        ):
            return True
    return False


def _time_below(figure: Figure, axes: Axes) -> str:
    """Return the x label of the next panel that has one."""
    later = figure.axes[figure.axes.index(axes) :]
    return next((label for one in later if (label := one.get_xlabel())), "")


def _label_beside(figure: Figure, axes: Axes) -> str:
    """Return the y label of another panel in the row."""
    place = axes.get_subplotspec()
    for one in figure.axes:
        other = one.get_subplotspec()
        if place is None or other is None or one is axes or not one.get_ylabel():
            continue
        if other.get_gridspec() is place.get_gridspec() and other.rowspan == place.rowspan:
            return one.get_ylabel()
    return ""


def _label(artist: Any) -> str:
    label = str(artist.get_label())
    return "" if label.startswith("_") else _plain(label)


def _plain(text: str) -> str:
    """Return a text without Matplotlib's markup."""
    return " ".join(_LETTER.sub(r"\1", text).replace(r"\$", "$").split())


def _numbers(values: Any) -> Array:
    return np.ma.filled(np.ma.asarray(values, dtype=float), np.nan)
