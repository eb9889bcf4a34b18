"""Figures of a parameter study: a response over one parameter and two, its distribution, all against all.

A study is a dataset whose dimensions are the parameters of a grid, and ``sample``; parameters are its
coordinates, responses its variables. Runs without a number, for they failed or are still to be made, are left
out, and a footnote says how many.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number
from antenna_pin.plot._study import broken, cell_edges, label_axis, left_out, names_of, quantity_of
from antenna_pin.plot._style import (
    COLOURS,
    PEAK,
    SEQUENTIAL,
    Width,
    few_ticks,
    footnote,
    legend_above,
    literal,
    new_figure,
    styled,
)

__all__ = [
    "QUANTILES",
    "StudyFigure",
    "study_distribution",
    "study_figures",
    "study_map",
    "study_response",
    "study_scatter",
    "study_sensitivities",
]

#: Quantiles that a distribution is marked with [-].
QUANTILES = (0.05, 0.5, 0.95, 0.997)

_SAMPLE = "sample"
_MOST_LINES = 6
_MOST_SCATTERED = 6

# Of the colours from dark to light the last in which a thin line is seen, on paper and on dark pages.
_LIGHTEST = 0.7


@dataclass(frozen=True, slots=True)
class StudyFigure:
    """A figure that a study allows.

    Attributes:
        name: As its file is called.
        title: What it shows.
        draw: Draws it; takes ``width``.
    """

    name: str
    title: str
    draw: Callable[..., Figure]


@takes()
@styled
def study_response(study: xr.Dataset, response: str, parameter: str, *, width: Width = "column") -> Figure:
    """Draw a response against a parameter: lines over a grid of two parameters at most, else a point a run.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
        response: Name of the response.
        parameter: Name of the parameter.
        width: "column" or "page".
    """
    x, y = quantity_of(study, parameter), quantity_of(study, response)
    there, said = left_out(x, y)
    figure = new_figure(width, 66.0)
    axes = figure.add_subplot()
    others = [dim for dim in study["outcome"].dims if dim != study[parameter].dims[0]]
    lines = _lines(study, [str(dim) for dim in others])
    if lines is None:
        axes.plot(x.values[there], y.values[there], ".", markersize=3.0, alpha=0.7)
        axes.margins(x=0.03)
    else:
        several = len(lines) > 1
        for k, (label, mine) in enumerate(lines):
            chosen = mine & there
            order = np.argsort(x.values[chosen], kind="stable")
            colour = SEQUENTIAL(_LIGHTEST * k / max(len(lines) - 1, 1)) if several else COLOURS[0]
            axes.plot(
                x.values[chosen][order],
                y.values[chosen][order],
                "o-",
                markersize=3.0,
                color=colour,
                label=label if several else None,
            )
        axes.margins(x=0.03)
        legend_above(figure, [axes])
    label_axis(axes, x, "x")
    label_axis(axes, y, "y")
    if not x.texts and not x.ticks:
        few_ticks(axes)
    footnote(figure, said)
    return figure


def _lines(study: xr.Dataset, others: Sequence[str]) -> list[tuple[str, Any]] | None:
    """Return name and runs of each line over a grid; None where runs are to be points."""
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


@takes()
@styled
def study_map(
    study: xr.Dataset, response: str, first: str, second: str, *, width: Width = "column"
) -> Figure:
    """Draw a response over two parameters: a heat map with contours over a grid, else coloured points.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
        response: Name of the response.
        first: Parameter along x.
        second: Parameter along y.
        width: "column" or "page".
    """
    x, y, z = (quantity_of(study, name) for name in (first, second, response))
    there, said = left_out(x, y, z)
    figure = new_figure(width, 70.0)
    axes = figure.add_subplot()
    axes.grid(False)
    dims = (study[second].dims[0], study[first].dims[0])
    shown: Any
    lines: Any = None
    if dims[0] != dims[1] and set(study["outcome"].dims) == set(dims):
        columns, rows = np.unique(x.values), np.unique(y.values)
        field = np.full((rows.size, columns.size), np.nan)
        field[np.searchsorted(rows, y.values), np.searchsorted(columns, x.values)] = z.values
        edges = (cell_edges(columns, x.logarithmic), cell_edges(rows, y.logarithmic))
        shown = axes.pcolormesh(*edges, np.ma.masked_invalid(field), cmap=SEQUENTIAL)
        if min(field.shape) > 1 and np.isfinite(field).all() and np.ptp(field) > 0.0:
            lines = axes.contour(columns, rows, field, levels=6, colors="white", linewidths=0.7)
    else:
        shown = axes.scatter(x.values[there], y.values[there], c=z.values[there], s=8.0, cmap=SEQUENTIAL)
        axes.margins(0.03)
    bar = figure.colorbar(shown, ax=axes, label=broken(z.label))
    bar.outline.set_linewidth(0.4)
    if lines is not None:
        bar.add_lines(lines)  # their values stand there: labels on narrow contours lie over one another
    label_axis(axes, x, "x")
    label_axis(axes, y, "y")
    footnote(figure, said)
    return figure


@takes()
@styled
def study_distribution(study: xr.Dataset, response: str, *, width: Width = "column") -> Figure:
    """Draw how a response is distributed over the runs, with quantiles: a histogram and the share below.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
        response: Name of the response.
        width: "column" or "page".
    """
    x = quantity_of(study, response)
    there, said = left_out(x)
    values = np.sort(x.values[there])
    figure = new_figure(width, 66.0)
    axes = figure.add_subplot()
    if values.size:
        axes.hist(values, bins=min(60, max(5, int(2.0 * math.sqrt(values.size)))), color="#A9CCE3", zorder=2)
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
        axes.set_title(broken("; ".join(marks), 54), fontsize=6.0, color=PEAK)
        axes.margins(x=0.02)
    axes.set_ylabel("Runs")
    axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    label_axis(axes, x, "x")
    footnote(figure, said)
    return figure


@takes()
@styled
def study_scatter(study: xr.Dataset, names: Sequence[str]) -> Figure:
    """Draw parameters and responses all against all, with a histogram of each, as wide as a page.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
        names: Of parameters and responses.
    """
    found = [quantity_of(study, name) for name in names]
    there, said = left_out(*found)
    count = len(found)
    figure = new_figure("page", 22.0 * count + 14.0)
    panels: Any = figure.subplots(count, count, sharex="col", squeeze=False)
    for row, y in enumerate(found):
        for column, x in enumerate(found):
            axes = panels[row, column]
            if row == column:
                axes.hist(x.values[there], bins=20, color="#A9CCE3")
                axes.set_yticks([])
            else:
                axes.plot(x.values[there], y.values[there], ".", markersize=1.8, alpha=0.6)
                axes.yaxis.set_major_locator(MaxNLocator(3))
            axes.margins(0.05)
            axes.xaxis.set_major_locator(MaxNLocator(2))
            axes.tick_params(labelleft=column == 0 and row > 0, labelsize=5.5)
            if row == count - 1:
                axes.set_xlabel(broken(x.label, 15), fontsize=6.0)
            if column == 0:
                axes.set_ylabel(broken(y.label, 15), fontsize=6.0)
    footnote(figure, said)
    return figure


@takes()
@styled
def study_sensitivities(found: xr.Dataset, title: str = "", *, width: Width = "column") -> Figure:
    """Draw which parameters a response depends on, with the intervals of the confidence.

    Args:
        found: What :func:`antenna_pin.sweep.sensitivities` returns.
        title: Of the response.
        width: "column" or "page".
    """
    names = [literal(str(name)) for name in found["factor"].values]
    places = np.arange(len(names))
    figure = new_figure(width, 22.0 + 10.0 * len(names))
    axes = figure.add_subplot()
    bars = (
        (("mu_star", "mean size of the effect"), ("sigma", "its spread"))
        if found.attrs["method"] == "morris"
        else (("first", "by itself"), ("total", "with all interactions"))
    )
    for k, (name, label) in enumerate(bars):
        error = found[f"{name}_conf"].values if f"{name}_conf" in found else None
        axes.barh(
            places + (0.2 if k else -0.2),
            found[name].values,
            0.36,
            xerr=error,
            color=COLOURS[k],
            label=label,
            error_kw={"linewidth": 0.8, "capsize": 2.0},
        )
    axes.set_yticks(places, names)
    axes.invert_yaxis()
    axes.grid(axis="y", visible=False)
    unit = str(found[bars[0][0]].attrs.get("units", ""))
    what = "Effect" if found.attrs["method"] == "morris" else "Share of the variance [-]"
    text = f"{what}{f' [{unit}]' if unit not in ('', '1') else ''}{f': {title}' if title else ''}"
    axes.set_xlabel(broken(text, 50))
    legend_above(figure, [axes])
    footnote(figure, f"bars of error: {100.0 * found.attrs['confidence']:g} % confidence")
    return figure


@takes()
def study_figures(study: xr.Dataset) -> Iterator[StudyFigure]:
    """Yield the figures that a study allows, but sensitivities.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
    """
    parameters, responses = names_of(study, "parameters"), names_of(study, "responses")
    varied = [name for name in parameters if study[name].size > 1]
    sampled = _SAMPLE in study["outcome"].dims
    for response in responses:
        title = str(study[response].attrs.get("long_name", response))
        for name in varied:
            yield StudyFigure(
                f"{response}-over-{name}",
                f"{title}, over {name}",
                lambda r=response, p=name, **more: study_response(study, r, p, **more),
            )
        pairs = [(a, b) for i, a in enumerate(varied) for b in varied[i + 1 :]]
        for a, b in pairs if len(varied) <= 4 else ():
            if study[a].dims != study[b].dims or sampled:
                yield StudyFigure(
                    f"{response}-over-{a}-and-{b}",
                    f"{title}, over {a} and {b}",
                    lambda r=response, a=a, b=b, **more: study_map(study, r, a, b, **more),
                )
        if sampled:
            yield StudyFigure(
                f"{response}-distribution",
                f"{title}: distribution",
                lambda r=response, **more: study_distribution(study, r, **more),
            )
    every = [*varied, *responses][:_MOST_SCATTERED]
    if sampled and len(every) > 1:
        yield StudyFigure(
            "all-against-all",
            "parameters and responses, all against all",
            lambda **_: study_scatter(study, every),
        )
