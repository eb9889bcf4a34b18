"""Figures of a parameter study: responses over parameters, distributions, all against all.

A study is a dataset whose dimensions are the parameters of a grid, and ``sample``; parameters are its
coordinates, responses its variables. Runs without a number, failed or still to be made, are left
out, and a footnote gives their number.
"""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import combinations
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.errors import UnknownNameError
from antenna_pin.show.plot._style import COLOURS, PEAK, SEQUENTIAL, Array, Width, literal, prefixed
from antenna_pin.show.plot.grammar import (
    Axis,
    ByHand,
    DatasetFigure,
    Panel,
    PlotCurve,
    PlotMark,
    Scale,
    Sheet,
    colour_bar,
    figure,
)

#: Quantiles that a distribution is marked with [-].
QUANTILES = (0.05, 0.5, 0.95, 0.997)

_SAMPLE = "sample"
_MOST_LINES = 6
_MOST_SCATTERED = 6

# Of the colours from dark to light the last in which a thin line is seen, on paper and on dark pages.
_LIGHTEST = 0.7


StudyFigure = DatasetFigure


# --- parameters and responses: a value for each run, in a unit that suits it ---

# Values of a parameter that its axis has room for.
_MOST_TICKS = 7


@dataclass(frozen=True, slots=True)
class StudyQuantity:
    """Parameter or response of all runs, in a unit that suits it."""

    name: str
    label: str  # label of its axis, with the unit
    values: Array  # values of all runs, (runs,)
    texts: tuple[str, ...] = ()  # values of a parameter of words
    ticks: tuple[float, ...] = ()  # values of a parameter that has few
    logarithmic: bool = False  # whether it is a parameter whose values are spaced by factors


def names_of(study: xr.Dataset, what: str) -> list[str]:
    """Return the names of a study's ``parameters`` or ``responses``."""
    return [str(name) for name in json.loads(study.attrs[what])]


def quantity_of(study: xr.Dataset, name: str) -> StudyQuantity:
    """Return a parameter or response, one value for each run, (runs,)."""
    known = [*names_of(study, "parameters"), *names_of(study, "responses")]
    if name not in known:
        raise UnknownNameError("study", "parameter or response", name, known)
    found = study[name]
    like = study["outcome"]
    text = str(found.attrs.get("long_name", name))
    text = text[:1].upper() + text[1:]
    if found.dtype.kind not in "fi":
        words = [str(value) for value in found.values]
        numbers = xr.DataArray(np.arange(len(words), dtype=float), dims=found.dims)
        return StudyQuantity(name, text, _of_runs(numbers, like), tuple(words))
    values = _of_runs(found, like).astype(float)
    sizes = np.abs(values[np.isfinite(values)])
    chosen = name in names_of(study, "parameters")
    by_factors = chosen and is_spaced_by_factors(values)
    # On a logarithmic axis the middle is what is read, on another its end.
    size = float(np.median(sizes) if by_factors else sizes.max()) if sizes.size else 0.0
    factor, unit = prefixed(str(found.attrs.get("units", "")), size)
    label = f"{text} [{unit}]" if unit not in ("", "-", "1") else text
    own = np.unique(factor * values[np.isfinite(values)])
    ticks = tuple(own.tolist()) if chosen and own.size <= _MOST_TICKS else ()
    return StudyQuantity(name, label, factor * values, ticks=ticks, logarithmic=by_factors)


def _of_runs(values: xr.DataArray, like: xr.DataArray) -> Array:
    return np.ravel(values.broadcast_like(like).transpose(*like.dims).values)


def is_spaced_by_factors(values: Array) -> bool:
    """Return whether logarithms of values are more even, over about a decade."""
    own = np.unique(values[np.isfinite(values)])
    if own.size < 3 or own[0] <= 0.0 or own[-1] < 8.0 * own[0]:
        return False
    steps, factors = np.diff(own), np.diff(np.log(own))
    return bool(np.std(factors) / np.mean(factors) < np.std(steps) / np.mean(steps))


def cell_edges(values: Array, logarithmic: bool) -> Array:
    """Return the edges of cells around ascending values, halfway, by factors or not."""
    own = np.log(values) if logarithmic else values
    middles = 0.5 * (own[1:] + own[:-1])
    if not middles.size:
        edges = own[0] + max(0.5 * abs(own[0]), 0.5) * np.array([-1.0, 1.0])
    else:
        edges = np.concatenate([[2.0 * own[0] - middles[0]], middles, [2.0 * own[-1] - middles[-1]]])
    found: Array = np.exp(edges) if logarithmic else edges
    return found


def left_out(*quantities: StudyQuantity) -> tuple[Any, str]:
    """Return a mask of runs with all numbers, and a note on the others."""
    there = np.logical_and.reduce([np.isfinite(one.values) for one in quantities])
    missing = int(np.count_nonzero(~there))
    return there, f"{missing} of {there.size} runs without a result are not drawn" if missing else ""


# --- figures ---

_STUDY = "As :func:`antenna_pin.open_study` returns it."
_RESPONSE = "Name of the response."


def _broken(label: str, length: int = 32) -> str:
    """Return a label in lines; a title may be a sentence."""
    return "\n".join(textwrap.wrap(label, length))


def _axis(quantity: StudyQuantity, ticks: int = 0) -> Axis:
    """Return the axis of a quantity, with words or few values as ticks."""
    named = {value: f"{value:.4g}" for value in quantity.ticks}
    named |= {float(k): literal(text) for k, text in enumerate(quantity.texts)}
    scale: Scale = "log" if quantity.logarithmic else "linear"
    return Axis(_broken(quantity.label), scale=scale, ticks=ticks, named=named or None)


@figure(study=_STUDY, response=_RESPONSE, parameter="Name of the parameter.")
def study_response(study: xr.Dataset, response: str, parameter: str, *, width: Width = "column") -> Sheet:
    """Draw a response over a parameter: lines over a grid, else points."""
    x, y = quantity_of(study, parameter), quantity_of(study, response)
    there, said = left_out(x, y)
    others = [dim for dim in study["outcome"].dims if dim != study[parameter].dims[0]]
    lines = _lines(study, [str(dim) for dim in others])
    if lines is None:
        dots = {"linestyle": "none", "marker": ".", "markersize": 3.0, "alpha": 0.7}
        marks = [PlotCurve("", x.values[there], y.values[there], dots)]
    else:
        marks = []
        for k, (label, mine) in enumerate(lines):
            chosen = mine & there
            order = np.argsort(x.values[chosen], kind="stable")
            several = len(lines) > 1
            colour = SEQUENTIAL(_LIGHTEST * k / max(len(lines) - 1, 1)) if several else COLOURS[0]
            look = {"marker": "o", "markersize": 3.0, "color": colour}
            points = x.values[chosen][order], y.values[chosen][order]
            marks.append(PlotCurve(label if several else "", *points, look))
    few = not x.texts and not x.ticks
    panel = Panel("", marks, _axis(y, 5 if few else 0), _axis(x, 6 if few else 0), margins=(0.03, 0.05))
    return Sheet([[panel]], width, 66.0, (said,))


def _lines(study: xr.Dataset, others: Sequence[str]) -> list[tuple[str, Any]] | None:
    """Return name and runs of each line over a grid; None for points."""
    shape, dims = study["outcome"].shape, list(study["outcome"].dims)
    if not others:
        return None if _SAMPLE in dims else [("", np.ones(int(np.prod(shape)), dtype=bool))]
    if len(others) > 1 or _SAMPLE in dims or study.sizes[others[0]] > _MOST_LINES:
        return None
    (other,) = others
    named = [name for name in names_of(study, "parameters") if study[name].dims == (other,)]
    second = quantity_of(study, named[0])
    found = []
    for value in np.unique(second.values):
        text = second.texts[int(value)] if second.texts else f"{value:.4g}"
        name, _, unit = second.label.rpartition(" [")
        label = f"{name or second.label} {text} {unit.rstrip(']') if name else ''}".strip()
        found.append((label, second.values == value))
    return found


@figure(study=_STUDY, response=_RESPONSE, first="Parameter along x.", second="Parameter along y.")
def study_map(study: xr.Dataset, response: str, first: str, second: str, *, width: Width = "column") -> Sheet:
    """Draw a response over two parameters: a heat map with contours, else points."""
    x, y, z = (quantity_of(study, name) for name in (first, second, response))
    there, said = left_out(x, y, z)
    dims = (study[second].dims[0], study[first].dims[0])
    grid = dims[0] != dims[1] and set(study["outcome"].dims) == set(dims)

    def field(axes: Axes, *_: float) -> None:
        lines = None
        axes.grid(False)
        shown: Any
        if grid:
            columns, rows = np.unique(x.values), np.unique(y.values)
            values = np.full((rows.size, columns.size), np.nan)
            values[np.searchsorted(rows, y.values), np.searchsorted(columns, x.values)] = z.values
            edges = (cell_edges(columns, x.logarithmic), cell_edges(rows, y.logarithmic))
            shown = axes.pcolormesh(*edges, np.ma.masked_invalid(values), cmap=SEQUENTIAL)
            if min(values.shape) > 1 and np.isfinite(values).all() and np.ptp(values) > 0.0:
                lines = axes.contour(columns, rows, values, levels=6, colors="white", linewidths=0.7)
        else:
            looks: dict[str, Any] = {"s": 8.0, "cmap": SEQUENTIAL}
            shown = axes.scatter(x.values[there], y.values[there], c=z.values[there], **looks)
            axes.margins(0.03)
        assert isinstance(axes.figure, Figure)
        bar = colour_bar(axes.figure, axes, shown, literal(_broken(z.label)), {})
        if lines is not None:
            bar.add_lines(lines)  # their values stand there: labels on narrow contours lie over one another

    return Sheet([[Panel("", [ByHand(field)], _axis(y), _axis(x))]], width, 70.0, (said,))


@figure(study=_STUDY, response=_RESPONSE)
def study_distribution(study: xr.Dataset, response: str, *, width: Width = "column") -> Sheet:
    """Draw a response's histogram, the share of runs below, and quantiles."""
    x = quantity_of(study, response)
    there, said = left_out(x)
    values = np.sort(x.values[there])
    bins = min(60, max(5, int(2.0 * math.sqrt(values.size))))
    bars = ByHand(lambda axes, *_: axes.hist(values, bins=bins, color="#A9CCE3", zorder=2))
    finish = _with_shares(values) if values.size else None
    panel = Panel("", [bars] if values.size else [], Axis("Runs", ticks=0), _axis(x), finish=finish)
    return Sheet([[panel]], width, 66.0, (said,))


def _with_shares(values: Array) -> Callable[[Axes], None]:
    """Return a function that draws shares below and quantiles over a histogram."""

    def finish(axes: Axes) -> None:
        above = axes.twinx()
        above.grid(False)
        above.spines["right"].set_visible(True)
        above.step(values, np.arange(1, values.size + 1) / values.size, color=COLOURS[0], where="post")
        above.set_ylim(0.0, 1.02)
        above.set_ylabel("Share of runs below [-]")
        # As many digits as tell the runs apart.
        spread = max(float(np.ptp(values)), 1e-300)
        digits = min(9, max(4, math.ceil(math.log10(max(float(np.abs(values).max()) / spread, 1.0))) + 2))
        marks = []
        for share in QUANTILES:
            if share * values.size > values.size - 0.5:
                continue  # beyond the last run
            at = float(np.quantile(values, share))
            above.axvline(at, color=PEAK, linewidth=0.7, linestyle=":")
            # What may be broken is what lies between two.
            marks.append(f"{100.0 * share:g} %: {number(at, digits)}".replace(" ", "\N{NO-BREAK SPACE}"))
        # Above all: quantiles of a narrow distribution lie so near one another that no text fits beside them.
        axes.set_title(_broken("; ".join(marks), 54), fontsize=6.0, color=PEAK)
        axes.margins(x=0.02)
        axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))

    return finish


@figure(study=_STUDY, names="Of parameters and responses.")
def study_scatter(study: xr.Dataset, names: Sequence[str]) -> Sheet:
    """Draw parameters and responses all against all, with histograms, page-wide."""
    found = [quantity_of(study, name) for name in names]
    there, said = left_out(*found)
    dots = {"linestyle": "none", "marker": ".", "markersize": 1.8, "alpha": 0.6}
    rows = []
    for row, y in enumerate(found):
        rows.append([_against(x, y, there, dots, (row, k, len(found))) for k, x in enumerate(found)])
    return Sheet(rows, "page", 22.0 * len(found) + 14.0, (said,), letters=False)


def _against(
    x: StudyQuantity, y: StudyQuantity, there: Any, dots: dict[str, Any], place: tuple[int, int, int]
) -> Panel:
    """Return a quantity against another, of one alone its histogram."""
    row, column, count = place

    def finish(axes: Axes) -> None:
        if row == column:
            axes.set_yticks([])
        axes.tick_params(labelleft=column == 0 and row > 0, labelbottom=row == count - 1, labelsize=5.5)
        for axis, ticks in ((axes.xaxis, 2), (axes.yaxis, 3)):
            if axis is axes.xaxis or row != column:
                axis.set_major_locator(MaxNLocator(ticks))
            axis.label.set_fontsize(6.0)

    mark: PlotMark = PlotCurve("", x.values[there], y.values[there], dots)
    if row == column:
        mark = ByHand(lambda axes, *_: axes.hist(x.values[there], bins=20, color="#A9CCE3"))
    across = Axis(_broken(x.label, 15), labelled=row == count - 1, ticks=0, shared=f"{column}")
    up = Axis(_broken(y.label, 15), labelled=column == 0, ticks=0)
    return Panel("", [mark], up, across, margins=(0.05, 0.05), finish=finish)


@figure(found="As :func:`antenna_pin.studies.sweep.sensitivities` returns it.", title="Of the response.")
def study_sensitivities(found: xr.Dataset, title: str = "", *, width: Width = "column") -> Sheet:
    """Draw the sensitivities of a response to parameters, with confidence intervals."""
    names = [literal(str(name)) for name in found["factor"].values]
    morris = found.attrs["method"] == "morris"
    bars = (
        (("mu_star", "mean size of the effect"), ("sigma", "its spread"))
        if morris
        else (("first", "by itself"), ("total", "with all interactions"))
    )

    def draw(axes: Axes, *_: float) -> None:
        for k, (name, label) in enumerate(bars):
            error = found[f"{name}_conf"].values if f"{name}_conf" in found else None
            looks: dict[str, Any] = {"color": COLOURS[k], "error_kw": {"linewidth": 0.8, "capsize": 2.0}}
            places = np.arange(len(names)) + (0.2 if k else -0.2)
            axes.barh(places, found[name].values, 0.36, xerr=error, label=label, **looks)

    def finish(axes: Axes) -> None:
        axes.invert_yaxis()
        axes.grid(axis="y", visible=False)

    unit = str(found[bars[0][0]].attrs.get("units", ""))
    what = "Effect" if morris else "Share of the variance [-]"
    text = f"{what}{f' [{unit}]' if unit not in ('', '1') else ''}{f': {title}' if title else ''}"
    y = Axis(named={float(k): name for k, name in enumerate(names)})
    panel = Panel("", [ByHand(draw)], y, Axis(_broken(text, 50), ticks=0), finish=finish)
    note = f"bars of error: {100.0 * found.attrs['confidence']:g} % confidence"
    return Sheet([[panel]], width, 22.0 + 10.0 * len(names), (note,))


@takes()
def study_figures(study: xr.Dataset) -> Iterator[StudyFigure]:
    """Yield the figures that a study allows, but sensitivities.

    Args:
        study: Of :func:`antenna_pin.open_study`.
    """
    parameters, responses = names_of(study, "parameters"), names_of(study, "responses")
    varied = [name for name in parameters if study[name].size > 1]
    sampled = _SAMPLE in study["outcome"].dims
    draw: Callable[..., Figure]
    for response in responses:
        title = str(study[response].attrs.get("long_name", response))
        for name in varied:
            draw = partial(study_response, study, response, name)
            yield StudyFigure(f"{response}-over-{name}", f"{title}, over {name}", draw)
        for a, b in combinations(varied, 2) if len(varied) <= 4 else ():
            if study[a].dims != study[b].dims or sampled:
                draw = partial(study_map, study, response, a, b)
                yield StudyFigure(f"{response}-over-{a}-and-{b}", f"{title}, over {a} and {b}", draw)
        if sampled:
            draw = partial(study_distribution, study, response)
            yield StudyFigure(f"{response}-distribution", f"{title}: distribution", draw)
    every = [*varied, *responses][:_MOST_SCATTERED]
    if sampled and len(every) > 1:
        title = "parameters and responses, all against all"
        yield StudyFigure("all-against-all", title, lambda **_: study_scatter(study, every))
