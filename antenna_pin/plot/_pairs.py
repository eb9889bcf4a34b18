"""Figures of pairs of panels: how something moves, and beside it (on a column: below it) what it exerts."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from antenna_pin.plot._style import Width, new_figure

__all__ = ["paired_panels"]

_HEIGHT = 44.0  # of a row [mm]


def paired_panels(width: Width, count: int) -> tuple[Figure, Any]:
    """Return a figure with so many pairs of panels over time, and these, (count, 2); the lowest name it.

    Args:
        width: Of a "page" the two of a pair stand side by side, of a "column" one below the other.
        count: How many pairs.
    """
    beside = 2 if width == "page" else 1
    rows = count * 2 // beside
    figure = new_figure(width, 12.0 + _HEIGHT * rows)
    pairs = figure.subplots(rows, beside, squeeze=False).reshape(count, 2)
    for axes in pairs[-1] if width == "page" else pairs.ravel():
        axes.set_xlabel("time [s]")
    return figure, pairs
