"""How sure a fit is: correlations of its parameters, and the profile of each."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from scipy.interpolate import PchipInterpolator

from antenna_pin.base.arguments import takes
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot._style import (
    SHADE,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    literal,
    new_figure,
    panel_title,
    prefixed,
    styled,
)

__all__ = ["correlations", "figure_correlation", "figure_profiles", "has_profiles"]

# Two parameters are hardly told apart from this correlation on.
_STRONG = 0.95
# Of names and colours beside the cells of correlations [inch].
_BESIDE = 0.8
# By what factor a profile must reach for its axis to be logarithmic.
_WIDE = 5.0


@takes()
@styled
def figure_correlation(fit: xr.Dataset, *, width: Width = "column") -> Figure:
    """Return the correlations of the parameters of a fit, of each with each.

    Near 1 or -1 a record tells little more than one combination of two parameters. Those at a bound, and
    those that it does not tell at all, have none.

    Args:
        fit: Of :func:`antenna_pin.fit.open_fit`.
        width: "column" (88 mm) or "page" (180 mm).
    """
    values = correlations(fit)
    names = [literal(str(one)) for one in fit["title"].values]
    count = len(names)
    figure = new_figure(width, 26.0 + max(46.0, 9.0 * count))
    # Cells are square: of a page's width no more is taken than they and what is beside them need.
    figure.set_figwidth(min(figure.get_figwidth(), figure.get_figheight() + _BESIDE))
    axes = figure.add_subplot()
    axes.grid(False)
    shown = axes.imshow(np.ma.masked_invalid(values), cmap="RdBu_r", vmin=-1.0, vmax=1.0)
    axes.set_facecolor(SHADE)
    axes.set_xticks(range(count), names, rotation=30, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(count), names)
    axes.tick_params(length=0.0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    size = 7.0 if count <= 8 else 5.0
    for row in range(count):
        for column in range(count):
            value = values[row, column]
            text = _signed(value, 2) if math.isfinite(value) else "–"
            # A number that rounds to one is none: the digits that tell are those of its distance.
            if row != column and math.isfinite(value) and abs(value) >= 0.995:
                text = _signed(value, 4)
            colour = "white" if math.isfinite(value) and abs(value) > 0.6 else "black"
            bold = "bold" if row != column and math.isfinite(value) and abs(value) >= _STRONG else "normal"
            axes.text(column, row, text, ha="center", va="center", fontsize=size, color=colour, weight=bold)
    bar: Any = figure.colorbar(shown, ax=axes, label="correlation [-]", shrink=0.8, aspect=30.0, pad=0.02)
    bar.outline.set_linewidth(0.4)
    lacks = int(np.count_nonzero(~np.isfinite(np.diag(values))))
    footnote(
        figure,
        f"{lacks} at a bound, or not told" if lacks else "",
        f"bold: {_STRONG:g} or more, hardly told apart" if _hardly(values) else "",
    )
    return figure


def _signed(value: float, digits: int) -> str:
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "\N{MINUS SIGN}")


@takes()
def correlations(fit: xr.Dataset) -> np.ndarray:
    """Return the correlations of the parameters of a fit, (p, p) [-]; NaN of one that has none."""
    covariance = np.asarray(fit["covariance"].values, dtype=float)
    error = np.sqrt(np.diag(covariance))
    error = np.where(np.isfinite(error) & (error > 0.0), error, np.nan)
    found = covariance / np.outer(error, error)
    places = np.flatnonzero(np.isfinite(error))
    found[places, places] = 1.0
    return np.asarray(found)


def _hardly(values: np.ndarray) -> bool:
    apart = values[~np.eye(len(values), dtype=bool)]
    return bool(np.any(np.abs(apart[np.isfinite(apart)]) >= _STRONG))


def has_profiles(fit: xr.Dataset) -> bool:
    """Whether a fit has the profile of any parameter."""
    return "profile_value" in fit and bool(np.isfinite(fit["profile_value"].values).any())


@takes()
@styled
def figure_profiles(fit: xr.Dataset, *, width: Width = "page") -> Figure:
    """Return the profile of each parameter: how the loss grows as it is held elsewhere, the others fitted.

    Dashed is the parabola of its standard error, which a linear model has; where the two part, intervals by
    standard errors are off. Of a parameter that is searched by its logarithm it is one of that, and where the
    interval is wide so is the axis. Shaded is the interval of the profile.

    Args:
        fit: Of :func:`antenna_pin.fit.open_fit`, with profiles.
        width: "column" (88 mm) or "page" (180 mm).

    Raises:
        InvalidParameterError: It has no profiles.
    """
    if not has_profiles(fit):
        raise InvalidParameterError("figure", "fit", "one with profiles; make them by --profile", said="none")
    has = np.isfinite(fit["profile_value"].values).any(axis=1)
    places = [int(k) for k in np.flatnonzero(has)]
    columns = min(len(places), 1 if width == "column" else 3)
    rows = -(-len(places) // columns)
    figure = new_figure(width, 16.0 + 46.0 * rows)
    panels: Any = figure.subplots(rows, columns, squeeze=False)
    reach = float(fit["profile_reach"].item())
    for k, (letter, place) in enumerate(zip(letters(), places, strict=False)):
        axes = panels[k // columns, k % columns]
        _profile(axes, fit.isel(parameter=place), reach)
        panel_title(axes, letter if len(places) > 1 else "", str(fit["title"].values[place]))
        if k % columns == 0:
            axes.set_ylabel("growth of the loss\n[variances of a residual]")
    for k in range(len(places), rows * columns):
        panels[k // columns, k % columns].set_axis_off()
    legend_above(figure, panels.ravel()[: len(places)])
    ends = fit["profile_how"].values[has]
    said = {
        "open": "no end found on a side: the record does not bound the parameter there",
        "bounded": "a side ends at the parameter's bound",
        "stopped": "a side ends where the model cannot be run",
    }
    level = f"shaded: {100.0 * float(fit.attrs.get('level', 0.95)):g} %"
    footnote(figure, level, *(words for how, words in said.items() if (ends == how).any()))
    return figure


def _profile(axes: Axes, one: xr.Dataset, reach: float) -> None:
    values = np.asarray(one["profile_value"].values, dtype=float)
    root = np.asarray(one["profile_root"].values, dtype=float)
    there = np.isfinite(values)
    values, root = values[there], root[there]
    low, high = (float(end) for end in one["profile_end"].values)
    best, error = float(one["value"]), float(one["sd"])
    factor, unit = prefixed(str(one["units"].item()), float(np.abs(values).max()))
    # A logarithm is what is searched, and what is even about the value.
    by_log = "logarithmic" in one and bool(one["logarithmic"].item())
    left, right = _span(values, best, low, high, by_log)
    inside = [max(low, left), min(high, right)]
    axes.axvspan(*(factor * np.array(inside)), color=SHADE, linewidth=0.0, zorder=0.5)
    axes.axhline(reach**2, color="#999999", linewidth=0.6, linestyle=":", zorder=0.8)
    axes.plot(factor * values, root**2, "o", color="C0", markersize=2.4, zorder=3.0)
    coordinate, back = (np.log, np.exp) if by_log else (np.asarray, np.asarray)
    fine = np.linspace(coordinate(values[0]), coordinate(values[-1]), 401)
    between = np.full(401, root[0])
    if len(values) > 1:
        between = PchipInterpolator(coordinate(values), root)(fine)
    axes.plot(factor * back(fine), between**2, color="C0", linewidth=0.9, label="profile", zorder=3.0)
    if math.isfinite(error) and error > 0.0:
        x = np.linspace(coordinate(left), coordinate(right), 201)
        axes.plot(
            factor * back(x),
            ((x - coordinate(best)) / (error / best if by_log else error)) ** 2,
            color="C1",
            linewidth=0.8,
            linestyle=(0, (4, 1.5)),
            label="by the standard error",
            zorder=2.0,
        )
    axes.axvline(factor * best, color="#777777", linewidth=0.6, zorder=0.9)
    axes.set_xlim(factor * left, factor * right)
    axes.set_ylim(0.0, 2.0 * reach**2)
    axes.set_xlabel(literal(f"{one['parameter'].item()} [{unit}]" if unit else str(one["parameter"].item())))
    if by_log and right > _WIDE * left:
        axes.set_xscale("log")
        axes.yaxis.set_major_locator(MaxNLocator(4, steps=[1, 2, 5, 10]))
    else:
        few_ticks(axes, 4, 4)


def _span(
    values: np.ndarray, best: float, low: float, high: float, by_log: bool = False
) -> tuple[float, float]:
    """Return from where to where a profile is shown: beyond its ends, and of an open side some of it."""
    if by_log:
        below, above = (math.log(end) if end > 0.0 else -math.inf for end in (low, high))
        left, right = _span(np.log(values), math.log(best), below, above)
        return math.exp(left), math.exp(right)
    half = max(
        best - low if math.isfinite(low) else 0.0, high - best if math.isfinite(high) else 0.0
    ) or 0.5 * float(np.ptp(values))
    left = low - 0.3 * half if math.isfinite(low) else max(float(values.min()), best - 3.0 * half)
    right = high + 0.3 * half if math.isfinite(high) else min(float(values.max()), best + 3.0 * half)
    return left, right
