"""Panels of figures: one column of them for each run, squares in rows, and none that is empty."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.plot._style import WIDTHS, Width, letters, new_figure

__all__ = ["blocks", "square_panels", "without_empty"]

_MM = 25.4


def blocks(
    runs: int, shared: Sequence[bool], width: str, height: float
) -> tuple[Figure, list[list[Axes]], dict[Axes, str]]:
    """Return a figure with one column of panels per run, in blocks of as many columns as the width takes.

    Args:
        runs: Number of runs.
        shared: For each row of panels, whether all runs have the same value axis.
        width: Named width.
        height: Height of one panel with its labels [mm].

    Returns:
        The figure, its panels by row and run, and their letters in reading order.
    """
    columns = min(runs, 3 if width == "page" else 1)
    stacked = -(-runs // columns)
    rows = len(shared)
    figure = new_figure(width, 12.0 + height * rows * stacked)
    grid = figure.add_gridspec(rows * stacked, columns)
    panels: list[list[Axes]] = []
    for row, same in enumerate(shared):
        line: list[Axes] = []
        for run in range(runs):
            place = grid[(run // columns) * rows + row, run % columns]
            line.append(figure.add_subplot(place, sharey=line[0] if line and same else None))
            line[-1].tick_params(labelleft=run % columns == 0 or not same)
        panels.append(line)
    every = [axes for line in panels for axes in line]
    every.sort(key=lambda axes: axes.get_subplotspec().num1)  # type: ignore[union-attr]
    return figure, panels, dict(zip(every, letters(), strict=False))


def square_panels(width: Width, count: int, more: float, **how: Any) -> tuple[Figure, list[Axes]]:
    """Return a figure of square panels in rows, and the panels.

    Args:
        width: Named width.
        count: Number of panels.
        more: Height beside the panels, of legend and colour bar [mm].
        how: What ``add_subplot`` is to know.
    """
    most = 4 if width == "page" else 2
    columns = min(count, most)
    if count > columns:  # rows of equal length where that is possible
        columns = next((n for n in range(most, most // 2, -1) if count % n == 0), most)
    rows = -(-count // columns)
    # A single panel does not fill the width. Labels take some 14 mm across, and 18 mm with the title along.
    room = WIDTHS.get(width, WIDTHS["page"]) * _MM
    figure = new_figure(width, more + rows * (room / max(columns, 2.4 if width == "page" else 1.2) + 1.0))
    grid = figure.add_gridspec(rows, columns)
    return figure, [figure.add_subplot(grid[i // columns, i % columns], **how) for i in range(count)]


def without_empty(figure: Figure) -> None:
    """Take away panels without a title; letters of the others stay in order, and labels pass to the next."""
    named = [axes for axes in figure.axes if axes.get_title("left")]
    for axes in [axes for axes in figure.axes if axes not in named]:
        row = _row(axes)
        heir = next((one for one in named if _row(one) == row), None)
        if axes.get_ylabel() and heir is not None and not heir.get_ylabel():
            heir.set_ylabel(axes.get_ylabel())
            heir.tick_params(labelleft=True)
        axes.remove()
    named.sort(key=lambda axes: axes.get_subplotspec().num1)  # type: ignore[union-attr]
    bold = r"$\bf{("
    for letter, axes in zip(letters(), named, strict=False):
        title = axes.get_title("left")
        if title.startswith(bold):
            words = title.partition(")}$ ")[2]
            axes.set_title(rf"{bold}{letter})}}$ {words}" if len(named) > 1 else words)


def _row(axes: Axes) -> int:
    """Return the row of a figure's grid in which a panel begins."""
    place = axes.get_subplotspec()
    assert place is not None
    return int(place.rowspan.start)
