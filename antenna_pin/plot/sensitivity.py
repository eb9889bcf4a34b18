"""Sensitivities: which number moves which result, and how motions differ over time."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.plot._style import (
    COLOURS,
    Width,
    few_ticks,
    footnote,
    legend_above,
    literal,
    new_figure,
    panel_title,
    styled,
)

__all__ = ["figure_sensitivity"]

_MOST = 8  # results, and as many parameters as have a colour of their own
_PARAMETERS = len(COLOURS)


@takes()
@styled
def figure_sensitivity(sensitivity: xr.Dataset, *, width: Width = "page") -> Figure:
    """Return by how much results change with each parameter, and the curve that changes most, over time.

    On the left bars, of the results that change most: the change per 1 % of each parameter (of its scale) in
    per cent of the result, the parameters that matter most first; a line at their ends is what is in doubt.
    On the right the change of one motion per 1 % of each, doubt as a band, where there are samples.

    Args:
        sensitivity: Of :func:`antenna_pin.sensitivity.sensitivity_table`.
        width: "column" (88 mm) or "page" (180 mm).
    """
    size = np.abs(np.asarray(sensitivity["value"].values, dtype=float))
    change, doubt = (np.asarray(sensitivity[name].values, dtype=float) for name in ("change", "doubt"))
    rows = [k for k in range(len(size)) if size[k] > 0.0][:_MOST]
    share = np.nan_to_num(change[rows] / size[rows, None])
    weight = np.abs(share).max(axis=0, initial=0.0) if rows else np.zeros(change.shape[1])
    curve, sizes = _curve(sensitivity)
    order = np.argsort(-(weight if weight.any() else sizes), kind="stable")[:_PARAMETERS]
    wide, curves = width == "page", sensitivity.sizes["time"] > 1 and sensitivity.sizes["curve"] > 0
    height = 34.0 + max(len(rows), 1) * (3.0 + 2.6 * len(order))
    figure = new_figure(width, height if wide or not curves else height + 62.0)
    count = 2 if curves and rows else 1
    panels = np.atleast_1d(figure.subplots(1, count) if wide else figure.subplots(count, 1))
    names = [str(one) for one in sensitivity["parameter"].values]
    if rows:
        rest = np.nan_to_num(doubt[rows] / size[rows, None])
        labels = [literal(str(sensitivity["result"].values[k])) for k in rows]
        _bars(panels[0], labels, share, rest, order, names)
        panel_title(panels[0], "a" if count > 1 else "", "per 1 % of each")
    if curves:
        _over_time(panels[-1], sensitivity, curve, order, names)
        panel_title(panels[-1], "b" if count > 1 else "", f"{sensitivity['curve'].values[curve]}")
    legend_above(figure, panels[:1])
    left = sensitivity.sizes["parameter"] - len(order)
    footnote(figure, f"{left} parameters that matter less are not shown" if left else "")
    return figure


def _curve(sensitivity: xr.Dataset) -> tuple[int, np.ndarray]:
    """Return the curve that changes most, over its doubt, and what each parameter makes of it."""
    changes = np.nan_to_num(np.asarray(sensitivity["curve_change"].values, dtype=float))
    if not changes.size:
        return 0, np.zeros(changes.shape[2])
    velocities = [str(one).startswith("v ") for one in sensitivity["curve"].values]
    most = np.abs(changes).max(axis=(0, 2)) * (np.array(velocities) if any(velocities) else 1.0)
    best = int(np.argmax(most))
    return best, np.abs(changes[:, best]).max(axis=0)


def _bars(
    axes: Axes, labels: list[str], share: np.ndarray, doubt: np.ndarray, order: np.ndarray, names: list[str]
) -> None:
    """Draw bars, a group for each result."""
    tall = 0.8 / len(order)
    places = np.arange(len(labels), dtype=float)
    for j, k in enumerate(order.tolist()):
        at = places + (j - 0.5 * (len(order) - 1)) * tall
        axes.barh(at, share[:, k], height=0.9 * tall, color=COLOURS[j], label=names[k])
        axes.errorbar(share[:, k], at, xerr=doubt[:, k], fmt="none", ecolor="black", elinewidth=0.5)
    axes.axvline(0.0, color="#999999", linewidth=0.6)
    axes.set_yticks(places, labels)
    axes.invert_yaxis()
    axes.margins(x=0.05)
    axes.set_xlabel("change of the result [%]")


def _over_time(axes: Axes, sensitivity: xr.Dataset, curve: int, order: np.ndarray, names: list[str]) -> None:
    """Draw the change of one curve with each parameter."""
    time = np.asarray(sensitivity["time"].values, dtype=float)
    change, doubt = (
        0.01 * np.asarray(sensitivity[name].values, dtype=float)[:, curve]
        for name in ("curve_change", "curve_doubt")
    )
    for j, k in enumerate(order.tolist()):
        axes.plot(time, change[:, k], color=COLOURS[j], linewidth=0.9, label=names[k])
        low, high = change[:, k] - doubt[:, k], change[:, k] + doubt[:, k]
        axes.fill_between(time, low, high, color=COLOURS[j], alpha=0.25, linewidth=0.0)
    axes.axhline(0.0, color="#999999", linewidth=0.6, zorder=0.8)
    axes.set_xlabel("time [s]")
    axes.set_ylabel(f"change per 1 % [{sensitivity['curve_unit'].values[curve]}]")
    few_ticks(axes, x=3)  # beside long names of results little room is left
