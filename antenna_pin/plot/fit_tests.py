"""What tests can tell before they are made: errors to expect, directions, experiments side by side."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullFormatter

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.plot._style import (
    COLOURS,
    PEAK,
    SHADE,
    Array,
    Width,
    footnote,
    legend_above,
    literal,
    new_figure,
    panel_title,
    styled,
)

__all__ = ["figure_experiments", "figure_identifiability"]

_MOST = 24  # experiments in a figure
_DECADES = 20.0  # from the narrowest interval to the widest: more is shown by logarithms


@takes()
@styled
def figure_identifiability(found: xr.Dataset, *, width: Width = "page") -> Figure:
    """Return what a test can tell: the error of each parameter to expect, and the directions that it tells.

    On the left half widths of intervals over the parameters' sizes, with all others unknown and with all
    others known: what lies between is what parameters take from one another. On the right the error along
    each direction, and of which parameters it is made.

    Args:
        found: Of :func:`antenna_pin.fit.identifiability_table`.
        width: "column" (88 mm) or "page" (180 mm).
    """
    names = [literal(str(one)) for one in found["title"].values]
    count = len(names)
    size = np.asarray(found["scale"].values, dtype=float)
    half = 100.0 * np.asarray(found["half"].values, dtype=float) / size
    alone = 100.0 * float(found.attrs["quantile"]) * np.asarray(found["alone"].values, dtype=float) / size
    wide = width == "page"
    figure = new_figure(width, (34.0 if wide else 74.0) + (9.0 if wide else 15.0) * count)
    left, right = figure.subplots(1, 2) if wide else figure.subplots(2, 1)
    places = np.arange(count)
    ends = [one[np.isfinite(one) & (one > 0.0)] for one in (half, alone)]
    every = np.concatenate([*ends, [100.0]])
    low, high = 0.5 * float(every.min()), 3.0 * float(every.max())
    left.set_xscale("log")
    left.set_xlim(low, high)
    left.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    left.xaxis.set_minor_formatter(NullFormatter())
    left.axvspan(100.0, high, color=SHADE, linewidth=0.0, zorder=0.4)
    for place in places:
        told = np.isfinite(half[place])
        colour = COLOURS[0] if told else PEAK
        end = half[place] if told else high
        begin = alone[place] if np.isfinite(alone[place]) else high
        left.plot([begin, end], [place, place], color=colour, linewidth=1.4, zorder=2.0)
        if np.isfinite(alone[place]):
            left.plot(begin, place, "o", color="white", markeredgecolor=colour, markersize=4.5, zorder=3.0)
        left.plot(
            end if told else 0.93 * high,
            place,
            "o" if told else ">",
            color=colour,
            markersize=4.5,
            zorder=4.0,
            clip_on=False,
        )
    # Entries of the legend, away from any parameter.
    left.plot([], [], "o", color="white", markeredgecolor=COLOURS[0], markersize=2.3, label="others known")
    left.plot([], [], "o", color=COLOURS[0], markersize=2.3, label="others unknown")
    if not np.isfinite(half).all():
        left.plot([], [], ">", color=PEAK, markersize=2.3, label="cannot be told")
    left.set_yticks(places, names)
    left.set_ylim(count - 0.5, -0.5)
    left.grid(axis="y", visible=False)
    left.set_xlabel("interval to expect, ± [% of the size]")
    panel_title(left, "a", "parameters")
    _directions(right, found, names)
    panel_title(right, "b", "directions")
    legend_above(figure, [left])
    footnote(
        figure,
        f"intervals of {100.0 * float(found.attrs['level']):g} %",
        "grey: as wide as the value itself, or wider",
        "numbers: error along the direction, in sizes",
    )
    return figure


def _directions(axes: Axes, found: xr.Dataset, names: list[str]) -> None:
    """Draw of which parameters each direction is made, with the error along it."""
    parts = np.asarray(found["part"].values, dtype=float)
    singular = np.asarray(found["singular"].values, dtype=float)
    axes.grid(False)
    axes.imshow(parts**2, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in np.argwhere(parts**2 > 0.005):
        share = parts[row, column]
        axes.text(
            column,
            row,
            f"{share:+.2f}".replace("-", "\N{MINUS SIGN}"),
            ha="center",
            va="center",
            fontsize=6.0,
            color="white" if share**2 > 0.5 else "black",
        )
    least = 1e-12 * float(singular.max(initial=0.0))
    words = [number(1.0 / float(one), 2) if one > least else "∞" for one in singular]
    axes.set_xticks(range(len(names)), names, rotation=30, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(len(words)), words)
    axes.set_ylabel("error along it [sizes]")
    axes.tick_params(length=0.0)
    for spine in axes.spines.values():
        spine.set_visible(False)


@takes()
@styled
def figure_experiments(found: xr.Dataset, *, width: Width = "page") -> Figure:
    """Return experiments beside one another: the interval of each parameter to expect after each.

    The best one stands first. A line is what the parameter's interval is before any of them.

    Args:
        found: Of :func:`antenna_pin.fit.experiments_table`.
        width: "column" (88 mm) or "page" (180 mm).
    """
    kept = min(found.sizes["experiment"], _MOST)
    shown = found.isel(experiment=slice(kept))
    names = [literal(str(one)) for one in shown["experiment"].values]
    titles = [literal(str(one)) for one in shown["title"].values]
    size = np.asarray(shown["scale"].values, dtype=float)
    half = 100.0 * np.asarray(shown["half"].values, dtype=float) / size
    before = 100.0 * np.asarray(shown["before"].values, dtype=float) / size
    wanted = str(shown.attrs["wanted"])
    columns = min(len(titles), 4 if width == "page" else 2)
    rows = -(-len(titles) // columns)
    figure = new_figure(width, 20.0 + (14.0 + 6.0 * kept) * rows)
    grid: Any = figure.subplots(rows, columns, sharey=True, squeeze=False)
    panels, rest = grid.ravel()[: len(titles)], grid.ravel()[len(titles) :]
    for axes in rest:
        axes.set_axis_off()
    for k, (axes, title) in enumerate(zip(panels, titles, strict=True)):
        _after(axes, half[:, k], float(before[k]))
        mine = str(shown["parameter"].values[k])
        axes.set_title(title + (" (wanted)" if mine == wanted and len(titles) > 1 else ""))
        axes.set_xlabel("± [%]")
    panels[0].plot([], [], "o", color=COLOURS[0], markersize=2.3, label="after the experiment")
    panels[0].plot([], [], "o", color=COLOURS[1], markersize=2.3, label="best of them")
    panels[0].set_yticks(range(kept), names)
    panels[0].set_ylim(kept - 0.5, -0.5)
    legend_above(figure, panels)
    lacks = found.sizes["experiment"] - kept
    level, criterion = float(found.attrs["level"]), str(found.attrs["criterion"])
    footnote(
        figure,
        f"intervals of {100.0 * level:g} % over the sizes",
        f"in order of {criterion}" + (f" of {wanted}" if criterion == "c" else ""),
        "arrow: cannot be told" if not np.isfinite(half).all() else "",
        f"{lacks} more not drawn" if lacks else "",
    )
    return figure


def _after(axes: Axes, half: Array, before: float) -> None:
    """Draw the interval of one parameter after each experiment [%], and before any."""
    told = np.isfinite(half)
    every = np.append(half[told], [before] if math.isfinite(before) else [])
    high = 1.15 * float(every.max(initial=0.0)) or 100.0
    low = 0.0
    if every.size and high > _DECADES * every.min():
        low = 0.6 * float(every.min())
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
    else:
        axes.xaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    axes.set_xlim(low, high)
    if math.isfinite(before):
        axes.axvline(before, color="#777777", linewidth=0.8, linestyle="--", label="before", zorder=1.0)
    places = np.arange(len(half))
    axes.hlines(places[told], low, half[told], color="#CCCCCC", linewidth=0.8, zorder=1.5)
    best = int(np.argmin(np.where(told, half, np.inf))) if told.any() else -1
    for place in places:
        colour = COLOURS[1] if place == best else COLOURS[0]
        if told[place]:
            axes.plot(half[place], place, "o", color=colour, markersize=4.0, zorder=3.0, clip_on=False)
        else:
            axes.plot(0.96 * high, place, ">", color=PEAK, markersize=4.0, zorder=3.0)
    axes.grid(axis="y", visible=False)
