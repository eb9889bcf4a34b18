"""Figures of fits and tests: records beside predictions, uncertainty, sensitivities."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot._style import COLOURS, PEAK, SHADE, Array, Width, footnote, literal, new_figure
from antenna_pin.show.plot.grammar import (
    Axis,
    Band,
    ByHand,
    Ground,
    Panel,
    PlotCurve,
    PlotMark,
    Rule,
    Sheet,
    colour_bar,
    figure,
    in_rows,
    largest_of,
    size_of,
)

_FIT = "Of :func:`antenna_pin.studies.fit.open_fit`."
_ZERO = Rule(0.0)


def _values(data: xr.Dataset, *names: str) -> list[Array]:
    """Return variables as floats."""
    return [np.asarray(data[name].values, dtype=float) for name in names]


def _minus(text: str) -> str:
    return text.replace("-", "\N{MINUS SIGN}")


# --- records ---

_DATA, _NEW, _CURVE = "#555555", "#DCEAF3", "#9CC5DF"
# Rows from which on a record is a line, as dots would cover one another.
_DOTS = 400
#: Curves in one figure at most.
MOST = 4


@takes()
def curves_of_fit(fit: xr.Dataset) -> list[str]:
    """Return the names of a fit's curves, ``record: column``, in order."""
    parts = zip(fit["record"].values, fit["column"].values, strict=True)
    return list(dict.fromkeys(f"{record}: {column}" for record, column in parts))


@figure(
    fit=_FIT,
    curves="Of which records and columns, ``record: column``; the first four if left out.",
    bands="Whether to draw bands, where the fit has them.",
)
def figure_fit(
    fit: xr.Dataset, curves: list[str] | None = None, *, bands: bool = True, width: Width = "page"
) -> Sheet:
    """Return records against their fit, with residuals in standard deviations of the noise.

    Dark bands are where the model's curve may be, light ones where a new measurement may be.

    Raises:
        UnknownNameError: There is no such curve.
    """
    every = curves_of_fit(fit)
    for name in curves or ():
        if name not in every:
            raise UnknownNameError("figure", "curve", name, every)
    chosen = every[:MOST] if curves is None else curves
    names = np.array([f"{a}: {b}" for a, b in zip(fit["record"].values, fit["column"].values, strict=True)])
    bands = bands and "band_low" in fit
    rows: list[list[Panel | None]] = []
    for name in chosen:
        rows += [[one] for one in _record(fit.isel(row=np.flatnonzero(names == name)), name, bands)]
    left = len(every) - len(chosen)
    level = 100.0 * float(fit.attrs.get("level", 0.95))
    notes = (
        f"bands: {level:g} %, point by point" if bands else "",
        f"{left} more curve{'s' if left > 1 else ''} not drawn" if left > 0 and curves is None else "",
    )
    heights = [3.0, 1.2] * len(chosen)
    return Sheet(rows, width, 14.0 + 58.0 * len(chosen), notes, heights=heights)


def _record(rows: xr.Dataset, name: str, bands: bool) -> tuple[Panel, Panel]:
    """Return a record with its model, and the residuals beneath."""
    at, data, model, noise = _values(rows, "at", "data", "model", "noise")
    measure, unit = (str(rows[one].values[0]) for one in ("measure", "unit"))
    label = {"reading": "time [s]", "rms": "time [s]", "ln power": "frequency [Hz]"}
    linear = measure in ("reading", "rms")
    x = Axis(
        label.get(measure, "middle of the bin [SI]"),
        scale="linear" if linear else "log",
        ticks=6 if linear else 0,
        shared=name,
    )
    y = Axis(measure, unit, largest_of([data, model])) if linear else Axis(f"{measure} [-]")
    marks: list[PlotMark] = []
    for low, high, colour, words in (
        ("new_low", "new_high", _NEW, "where a new measurement may be"),
        ("band_low", "band_high", _CURVE, "where the model may be"),
    ):
        if bands:
            look = {"color": colour, "label": words, "zorder": 1.0}
            ends = _values(rows, low, high)
            marks.append(Band(at, ends[0], ends[1], look))
    marks.append(_measurements("measured", at, data))
    alone = {"marker": "D" if len(at) == 1 else "", "markersize": 3.0}
    marks.append(
        PlotCurve("fitted model", at, model, {"color": "C0", "linewidth": 0.9, "zorder": 3.0, **alone})
    )
    residual = (model - data) / noise
    half = 1.1 * max(2.5, size_of(residual))
    beneath: list[PlotMark] = [
        Ground(-1.96, 1.96, {"color": "#EEEEEE", "linewidth": 0.0, "zorder": 0.5}, "y"),
        _ZERO,
        _measurements("", at, residual),
    ]
    rms = f"residuals' rms {number(float(np.sqrt(np.mean(residual**2))), 3)} sd"

    def finish(axes: Axes) -> None:
        axes.set_title(rms, loc="right", fontsize=6.5)

    margins = 0.02, 0.06
    above = replace(x, labelled=False)
    y_below = Axis("residual\n[sd]", limits=(-half, half), ticks=3)
    return (
        Panel(
            name.replace("_", " "),
            marks,
            y if linear else replace(y, ticks=0),
            above,
            margins=margins,
            finish=finish,
        ),
        Panel(
            "",
            beneath,
            y_below if linear else replace(y_below, ticks=0),
            replace(x, labelled=True),
            margins=(0.02, 0.05),
            lettered=False,
        ),
    )


def _measurements(label: str, at: Array, values: Array) -> PlotCurve:
    """Return measured values as dots, or many as a line."""
    look: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 2.6}
    line = {"linewidth": 0.5, "alpha": 0.8}
    return PlotCurve(
        label, at, values, {"color": _DATA, "zorder": 2.0, **(look if len(at) <= _DOTS else line)}
    )


# --- how sure a fit is ---

# Correlation from which on two parameters are hardly distinguishable.
_STRONG = 0.95
# Of names and colours beside the cells of correlations [inch].
_BESIDE = 0.8
# By what factor a profile must reach for its axis to be logarithmic.
_WIDE = 5.0


def _cells(axes: Axes, rows: Sequence[str], columns: Sequence[str]) -> None:
    """Name the rows and columns of cells."""
    axes.grid(False)
    axes.set_xticks(range(len(columns)), columns, rotation=30, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(len(rows)), rows)
    axes.tick_params(length=0.0)
    for spine in axes.spines.values():
        spine.set_visible(False)


@figure(fit=_FIT)
def figure_correlation(fit: xr.Dataset, *, width: Width = "column") -> Figure:
    """Return the correlations of the parameters of a fit, of each with each.

    Near 1 or -1 a record determines little more than one combination of two parameters. Parameters at a
    bound, or undetermined, have none.
    """
    values = correlations(fit)
    names = [literal(str(one)) for one in fit["title"].values]
    count = len(names)
    found = new_figure(width, 26.0 + max(46.0, 9.0 * count))
    # Cells are square: of a page's width no more is taken than they and what is beside them need.
    found.set_figwidth(min(found.get_figwidth(), found.get_figheight() + _BESIDE))
    axes = found.add_subplot()
    shown = axes.imshow(np.ma.masked_invalid(values), cmap="RdBu_r", vmin=-1.0, vmax=1.0)
    axes.set_facecolor(SHADE)
    _cells(axes, names, names)
    size = 7.0 if count <= 8 else 5.0
    for (row, column), value in np.ndenumerate(values):
        known = math.isfinite(value)
        # A number that rounds to one needs the digits of its distance from one.
        digits = 4 if row != column and abs(value) >= 0.995 else 2
        text = _minus(f"{round(value, digits) + 0.0:.{digits}f}") if known else "–"
        colour = "white" if known and abs(value) > 0.6 else "black"
        bold = "bold" if row != column and abs(value) >= _STRONG else "normal"
        axes.text(column, row, text, ha="center", va="center", fontsize=size, color=colour, weight=bold)
    colour_bar(found, axes, shown, "correlation [-]", {"shrink": 0.8, "aspect": 30.0, "pad": 0.02})
    lacks = int(np.count_nonzero(~np.isfinite(np.diag(values))))
    apart = values[~np.eye(count, dtype=bool)]
    footnote(
        found,
        f"{lacks} at a bound, or not identifiable" if lacks else "",
        f"bold: {_STRONG:g} or more, hardly distinguishable" if np.any(np.abs(apart) >= _STRONG) else "",
    )
    return found


@takes()
def correlations(fit: xr.Dataset) -> np.ndarray:
    """Return correlations of a fit's parameters, (p, p) [-]; NaN if undetermined."""
    covariance = np.asarray(fit["covariance"].values, dtype=float)
    error = np.sqrt(np.diag(covariance))
    error = np.where(np.isfinite(error) & (error > 0.0), error, np.nan)
    found = covariance / np.outer(error, error)
    places = np.flatnonzero(np.isfinite(error))
    found[places, places] = 1.0
    return np.asarray(found)


def has_profiles(fit: xr.Dataset) -> bool:
    """Return whether a fit has the profile of any parameter."""
    return "profile_value" in fit and bool(np.isfinite(fit["profile_value"].values).any())


@figure(fit="Of :func:`antenna_pin.studies.fit.open_fit`, with profiles.")
def figure_profiles(fit: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return the profile of each parameter: growth of the loss, the others fitted.

    Dashed is the parabola of its standard error, which a linear model has; where the two part, intervals by
    standard errors are off. Of a parameter that is searched by its logarithm it is one of that, and where the
    interval is wide so is the axis. Shaded is the interval of the profile.

    Raises:
        InvalidParameterError: It has no profiles.
    """
    if not has_profiles(fit):
        raise InvalidParameterError("figure", "fit", "one with profiles; make them by --profile", said="none")
    has = np.isfinite(fit["profile_value"].values).any(axis=1)
    places = [int(k) for k in np.flatnonzero(has)]
    columns = min(len(places), 1 if width == "column" else 3)
    reach = float(fit["profile_reach"].item())
    panels = [_profile(fit.isel(parameter=place), reach, k % columns == 0) for k, place in enumerate(places)]
    rows = in_rows(panels, columns, alone=False)
    ends = fit["profile_how"].values[has]
    said = {
        "open": "no end found on a side: the record does not bound the parameter there",
        "bounded": "a side ends at the parameter's bound",
        "stopped": "a side ends where the model cannot be run",
    }
    level = f"shaded: {100.0 * float(fit.attrs.get('level', 0.95)):g} %"
    notes = (level, *(words for how, words in said.items() if (ends == how).any()))
    return Sheet(rows, width, 16.0 + 46.0 * len(rows), notes, every=True)


def _profile(one: xr.Dataset, reach: float, labelled: bool) -> Panel:
    values, root = _values(one, "profile_value", "profile_root")
    there = np.isfinite(values)
    values, root = values[there], root[there]
    low, high = (float(end) for end in one["profile_end"].values)
    best, error = float(one["value"]), float(one["sd"])
    # A logarithm is what is searched, and what is even about the value.
    by_log = "logarithmic" in one and bool(one["logarithmic"].item())
    left, right = _span(values, best, low, high, by_log)
    coordinate, back = (np.log, np.exp) if by_log else (np.asarray, np.asarray)
    fine = np.linspace(coordinate(values[0]), coordinate(values[-1]), 401)
    between = np.full(401, root[0])
    if len(values) > 1:
        between = PchipInterpolator(coordinate(values), root)(fine)
    dots = {"linestyle": "none", "marker": "o", "color": "C0", "markersize": 2.4, "zorder": 3.0}
    line = {"color": "C0", "linewidth": 0.9, "zorder": 3.0}
    marks: list[PlotMark] = [
        Ground(max(low, left), min(high, right)),
        Rule(reach**2, {"color": "#999999", "linewidth": 0.6, "linestyle": ":", "zorder": 0.8}),
        PlotCurve("", values, root**2, dots),
        PlotCurve("profile", back(fine), between**2, line),
    ]
    if math.isfinite(error) and error > 0.0:
        x = np.linspace(coordinate(left), coordinate(right), 201)
        parabola = ((x - coordinate(best)) / (error / best if by_log else error)) ** 2
        dashed = {"color": "C1", "linewidth": 0.8, "linestyle": (0, (4, 1.5)), "zorder": 2.0}
        marks.append(PlotCurve("by the standard error", back(x), parabola, dashed))
    marks.append(Rule(best, {"color": "#777777", "linewidth": 0.6, "zorder": 0.9}, "x"))
    wide = by_log and right > _WIDE * left
    across = Axis(
        str(one["parameter"].item()),
        str(one["units"].item()),
        size_of(values),
        (left, right),
        "log" if wide else "linear",
        0 if wide else 4,
    )
    label = "growth of the loss\n[variances of a residual]" if labelled else ""
    return Panel(str(one["title"].item()), marks, Axis(label, limits=(0.0, 2.0 * reach**2), ticks=4), across)


def _span(
    values: np.ndarray, best: float, low: float, high: float, by_log: bool = False
) -> tuple[float, float]:
    """Return the displayed range of a profile."""
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


# --- what tests can tell ---

_MOST = 24  # experiments in a figure
_SPREAD = 20.0  # from the narrowest interval to the widest: more is shown by logarithms
_DOT: dict[str, Any] = {"linestyle": "none", "marker": "o", "clip_on": False}


def _entry(label: str, marker: str, colour: str, **looks: Any) -> PlotCurve:
    """Return an entry of the legend alone."""
    look = {"linestyle": "none", "marker": marker, "color": colour, "markersize": 2.3, **looks}
    return PlotCurve(label, np.empty(0), np.empty(0), look)


def _listed(names: Sequence[str]) -> Axis:
    """Return an axis with a name at each place, from above."""
    return Axis(limits=(len(names) - 0.5, -0.5), named=dict(enumerate(names)))


def _no_rows(axes: Axes) -> None:
    axes.grid(axis="y", visible=False)


@figure(found="Of :func:`antenna_pin.studies.fit.identifiability_table`.")
def figure_identifiability(found: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return the information of a test: expected errors of parameters, and determined directions.

    On the left half widths of intervals over the parameters' sizes, with all others unknown and with all
    others known. On the right the error along each direction, and its parts of parameters.
    """
    names = [literal(str(one)) for one in found["title"].values]
    size, half, alone = _values(found, "scale", "half", "alone")
    half, alone = 100.0 * half / size, 100.0 * float(found.attrs["quantile"]) * alone / size
    ends = [one[np.isfinite(one) & (one > 0.0)] for one in (half, alone)]
    every = np.concatenate([*ends, [100.0]])
    low, high = 0.5 * float(every.min()), 3.0 * float(every.max())
    marks: list[PlotMark] = [Ground(100.0, high, {"color": SHADE, "linewidth": 0.0, "zorder": 0.4})]
    for place, (end, begin) in enumerate(zip(half, alone, strict=True)):
        told, known = np.isfinite(end), np.isfinite(begin)
        colour = COLOURS[0] if told else PEAK
        at = np.array([place])
        span = np.array([begin if known else high, end if told else high])
        marks.append(
            PlotCurve("", span, np.array([place, place]), {"color": colour, "linewidth": 1.4, "zorder": 2.0})
        )
        look = {"linestyle": "none", "markersize": 4.5, "color": colour, "zorder": 4.0, "clip_on": False}
        if known:
            hollow = {
                "color": "white",
                "markeredgecolor": colour,
                "zorder": 3.0,
                "clip_on": True,
                "marker": "o",
            }
            marks.append(PlotCurve("", np.array([begin]), at, {**look, **hollow}))
        tip = np.array([end if told else 0.93 * high])
        marks.append(PlotCurve("", tip, at, {**look, "marker": "o" if told else ">"}))
    marks.append(_entry("others known", "o", "white", markeredgecolor=COLOURS[0]))
    marks.append(_entry("others unknown", "o", COLOURS[0]))
    marks += [] if np.isfinite(half).all() else [_entry("not identifiable", ">", PEAK)]
    x = Axis("interval to expect, ± [% of the size]", limits=(low, high), scale="log")
    left = Panel("parameters", marks, _listed(names), x, finish=_with_plain_numbers)
    right = Panel(
        "directions",
        [ByHand(lambda axes, *_: _directions(axes, found, names))],
        Axis("error along it [sizes]", ticks=0),
        Axis(ticks=0),
    )
    notes = (
        f"intervals of {100.0 * float(found.attrs['level']):g} %",
        "grey: as wide as the value itself, or wider",
        "numbers: error along the direction, in sizes",
    )
    wide = width == "page"
    height = (34.0 if wide else 74.0) + (9.0 if wide else 15.0) * len(names)
    return Sheet([[left, right]] if wide else [[left], [right]], width, height, notes, every=True)


def _with_plain_numbers(axes: Axes) -> None:
    axes.xaxis.set_major_formatter(lambda value, _: f"{value:g}")
    _no_rows(axes)


def _directions(axes: Axes, information: xr.Dataset, names: list[str]) -> None:
    """Draw the parameters of each direction, with the error along it."""
    parts, singular = _values(information, "part", "singular")
    axes.imshow(parts**2, cmap="Blues", vmin=0.0, vmax=1.0, aspect="auto")
    for row, column in np.argwhere(parts**2 > 0.005):
        share = parts[row, column]
        colour = "white" if share**2 > 0.5 else "black"
        looks: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 6.0, "color": colour}
        axes.text(column, row, _minus(f"{share:+.2f}"), **looks)
    least = 1e-12 * float(singular.max(initial=0.0))
    _cells(axes, [number(1.0 / float(one), 2) if one > least else "∞" for one in singular], names)


@figure(found="Of :func:`antenna_pin.studies.fit.experiments_table`.")
def figure_experiments(found: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return experiments side by side: the interval of each parameter after each.

    The best one stands first. A line is the parameter's interval before any of them.
    """
    kept = min(found.sizes["experiment"], _MOST)
    shown = found.isel(experiment=slice(kept))
    names = [literal(str(one)) for one in shown["experiment"].values]
    size, half, before = _values(shown, "scale", "half", "before")
    half, before = 100.0 * half / size, 100.0 * before / size
    titles, wanted = [str(one) for one in shown["title"].values], str(shown.attrs["wanted"])
    columns = min(len(titles), 4 if width == "page" else 2)
    panels: list[Panel] = []
    for k, title in enumerate(titles):
        mine = str(shown["parameter"].values[k]) == wanted and len(titles) > 1
        x, marks = _after(half[:, k], float(before[k]))
        if not panels:
            marks.append(_entry("after the experiment", "o", COLOURS[0]))
            marks.append(_entry("best of them", "o", COLOURS[1]))
        y = replace(_listed(names), shared="experiments")
        finish = _with_plain_numbers if x.scale == "log" else _no_rows
        panels.append(Panel(title + " (wanted)" * mine, marks, y, x, finish=finish))
    rows = in_rows(panels, columns, alone=False)
    lacks = found.sizes["experiment"] - kept
    level, criterion = float(found.attrs["level"]), str(found.attrs["criterion"])
    notes = (
        f"intervals of {100.0 * level:g} % over the sizes",
        f"in order of {criterion}" + (f" of {wanted}" if criterion == "c" else ""),
        "arrow: not identifiable" if not np.isfinite(half).all() else "",
        f"{lacks} more not drawn" if lacks else "",
    )
    return Sheet(rows, width, 20.0 + (14.0 + 6.0 * kept) * len(rows), notes, every=True, letters=False)


def _after(half: Array, before: float) -> tuple[Axis, list[PlotMark]]:
    """Return the interval of one parameter after each experiment [%], and before any."""
    told = np.isfinite(half)
    every = np.append(half[told], [before] if math.isfinite(before) else [])
    high = 1.15 * float(every.max(initial=0.0)) or 100.0
    by_log = bool(every.size) and high > _SPREAD * every.min()
    low = 0.6 * float(every.min()) if by_log else 0.0
    marks: list[PlotMark] = []
    if math.isfinite(before):
        look = {"color": "#777777", "linewidth": 0.8, "linestyle": "--", "label": "before", "zorder": 1.0}
        marks.append(Rule(before, look, "x"))
    places = np.arange(len(half))
    line: dict[str, Any] = {"color": "#CCCCCC", "linewidth": 0.8, "zorder": 1.5}
    marks.append(ByHand(lambda axes, *_: axes.hlines(places[told], low, half[told], **line)))
    best = int(np.argmin(np.where(told, half, np.inf))) if told.any() else -1
    for place, value in enumerate(half):
        colour = PEAK if not told[place] else COLOURS[1] if place == best else COLOURS[0]
        look = {**_DOT, "color": colour, "markersize": 4.0, "zorder": 3.0}
        look |= {} if told[place] else {"marker": ">", "clip_on": True}
        marks.append(
            PlotCurve("", np.array([value if told[place] else 0.96 * high]), np.array([place]), look)
        )
    return Axis("± [%]", limits=(low, high), scale="log" if by_log else "linear", ticks=4), marks


# --- sensitivities ---

_RESULTS = 8  # and as many parameters as have a colour of their own


@figure(sensitivity="Of :func:`antenna_pin.studies.sensitivity.sensitivity_table`.")
def figure_sensitivity(sensitivity: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return changes of results with parameters, and of the most sensitive curve.

    On the left bars, of the results that change most: the change per 1 % of each parameter (of its scale) in
    per cent of the result, the parameters that matter most first; a line at their ends is the error estimate.
    On the right the change of one motion per 1 % of each, its error estimate as a band, where there are
    samples.
    """
    size, change, doubt = _values(sensitivity, "value", "change", "doubt")
    size = np.abs(size)
    rows = [k for k in range(len(size)) if size[k] > 0.0][:_RESULTS]
    share, rest = (np.nan_to_num(one[rows] / size[rows, None]) for one in (change, doubt))
    weight = np.abs(share).max(axis=0, initial=0.0) if rows else np.zeros(change.shape[1])
    curve, sizes = _most(sensitivity)
    order = np.argsort(-(weight if weight.any() else sizes), kind="stable")[: len(COLOURS)]
    names = [str(one) for one in sensitivity["parameter"].values]
    panels = []
    if rows:
        labels = [literal(str(sensitivity["result"].values[k])) for k in rows]
        bars = ByHand(lambda axes, *_: _bars(axes, share, rest, order, names))
        panels.append(
            Panel(
                "per 1 % of each",
                [bars],
                Axis(named={float(k): label for k, label in enumerate(labels)}),
                Axis("change of the result [%]", ticks=0),
                margins=(0.05, 0.05),
                finish=lambda axes: axes.invert_yaxis(),
            )
        )
    wide, curves = width == "page", sensitivity.sizes["time"] > 1 and sensitivity.sizes["curve"] > 0
    if curves:
        panels.append(_over_time(sensitivity, curve, order, names, in_legend=not rows))
    left = sensitivity.sizes["parameter"] - len(order)
    note = f"{left} parameters that matter less are not shown" if left else ""
    height = 34.0 + max(len(rows), 1) * (3.0 + 2.6 * len(order)) + (0.0 if wide or not curves else 62.0)
    return Sheet([panels] if wide else [[one] for one in panels], width, height, (note,), every=True)


def _most(sensitivity: xr.Dataset) -> tuple[int, Array]:
    """Return the most sensitive curve, and its change with each parameter."""
    changes = np.nan_to_num(np.asarray(sensitivity["curve_change"].values, dtype=float))
    if not changes.size:
        return 0, np.zeros(changes.shape[2])
    velocities = [str(one).startswith("v ") for one in sensitivity["curve"].values]
    most = np.abs(changes).max(axis=(0, 2)) * (np.array(velocities) if any(velocities) else 1.0)
    best = int(np.argmax(most))
    return best, np.abs(changes[:, best]).max(axis=0)


def _bars(axes: Axes, share: Array, doubt: Array, order: NDArray[np.intp], names: list[str]) -> None:
    """Draw bars, a group for each result."""
    tall = 0.8 / len(order)
    places = np.arange(len(share), dtype=float)
    for j, k in enumerate(order.tolist()):
        at = places + (j - 0.5 * (len(order) - 1)) * tall
        axes.barh(at, share[:, k], height=0.9 * tall, color=COLOURS[j], label=names[k])
        axes.errorbar(share[:, k], at, xerr=doubt[:, k], fmt="none", ecolor="black", elinewidth=0.5)
    axes.axvline(0.0, color="#999999", linewidth=0.6)


def _over_time(
    sensitivity: xr.Dataset, curve: int, order: NDArray[np.intp], names: list[str], *, in_legend: bool
) -> Panel:
    """Return the change of one curve with each parameter."""
    (time,) = _values(sensitivity, "time")
    change, doubt = (0.01 * one[:, curve] for one in _values(sensitivity, "curve_change", "curve_doubt"))
    marks: list[PlotMark] = []
    for j, k in enumerate(order.tolist()):
        mine, apart = change[:, k], doubt[:, k]
        marks.append(PlotCurve(names[k], time, mine, {"color": COLOURS[j], "linewidth": 0.9}))
        marks.append(Band(time, mine - apart, mine + apart, {"color": COLOURS[j], "alpha": 0.25}))
    y = Axis(f"change per 1 % [{sensitivity['curve_unit'].values[curve]}]")
    x = Axis("time [s]", ticks=3)  # beside long names of results little room is left
    return Panel(str(sensitivity["curve"].values[curve]), [*marks, _ZERO], y, x, named=in_legend)
