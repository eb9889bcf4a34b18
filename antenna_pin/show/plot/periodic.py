"""Periodic solutions and their multipliers, sections and bifurcation diagrams, Lyapunov exponents."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot._style import SEQUENTIAL, Array, Width, parameter_words
from antenna_pin.show.plot.grammar import (
    Axis,
    ByHand,
    Panel,
    PlotCurve,
    PlotMark,
    Rule,
    Sheet,
    figure,
    size_of,
)
from antenna_pin.show.plot.study import is_spaced_by_factors

# --- branches of periodic solutions ---

_LINES: dict[str, Any] = {"stable": "-", "unstable": (0, (3.0, 1.6)), "neutral": (0, (0.8, 1.2))}
_WORDS = {"stable": "stable", "unstable": "unstable", "neutral": "undetermined"}
# Of every kind a shape and a colour of its own.
_OTHER = "stability changes"
_MARKS = {
    "fold": ("^", "C1"),
    "flip": ("D", "C2"),
    "neimark-sacker": ("o", "C3"),
    "branch-point": ("P", "C5"),
    "grazing": ("s", "C4"),
    _OTHER: ("X", "#777777"),
}
_KINDS = {
    "branch-point": "branch point",
    "neimark-sacker": "torus (Neimark-Sacker)",
    _OTHER: "stability changes, between orbits",
}


class Track(NamedTuple):
    """Branch in one number: pieces of one stability, and marks by kind."""

    pieces: list[tuple[str, Array, Array]]
    marks: list[tuple[str, float, float]]


def track(branch: xr.Dataset, numbers: Array) -> Track:
    """Return a branch in one number of its orbits, (points,).

    An event lies on the line between the points about it, at its value of the parameter; a fold, or another
    event that neither point reaches, where the size of the largest multiplier on that line is 1. Stability
    changes there, or, between two points that differ without an event, where that size is 1: that is marked
    too.
    """
    values = np.asarray(branch["value"].values, dtype=float)
    said = [str(one) for one in branch["stability"].values]
    sizes = _largest(branch)
    happened = [branch[name].values for name in ("kind", "at", "after")]
    between: dict[int, list[tuple[float, str, float]]] = {}
    for kind, at, after in zip(*happened, strict=True):
        one, other = values[[after, min(after + 1, len(values) - 1)]]
        share = math.nan if kind == "fold" or one == other else (at - one) / (other - one)
        share = share if 0.0 <= share <= 1.0 else _to_one(sizes, after)
        between.setdefault(int(after), []).append((float(share), str(kind), float(at)))
    pieces: list[tuple[str, Array, Array]] = []
    marks: list[tuple[str, float, float]] = []
    x: list[float] = []
    y: list[float] = []
    for k, (value, number) in enumerate(zip(values, numbers, strict=True)):
        x.append(float(value))
        y.append(float(number))
        last = k + 1 == len(values)
        changes = not last and said[k] != said[k + 1]
        places = sorted(between.get(k, []))
        if changes and not places:
            share = _to_one(sizes, k)
            places = [(share, _OTHER, float(value + share * (values[k + 1] - value)))]
        for share, kind, at in places:
            level = float(number if last else (1.0 - share) * number + share * numbers[k + 1])
            marks.append((kind, at, level))
            x.append(at)
            y.append(level)
        if changes:
            pieces.append((said[k], np.array(x), np.array(y)))
            x, y = x[-1:], y[-1:]
    pieces.append((said[-1], np.array(x), np.array(y)))
    return Track(pieces, marks)


def _to_one(sizes: Array, k: int) -> float:
    """Return the share of an interval where a size is 1, by default half."""
    if k + 1 >= len(sizes) or (sizes[k] - 1.0) * (sizes[k + 1] - 1.0) >= 0.0:
        return 0.5
    return float((1.0 - sizes[k]) / (sizes[k + 1] - sizes[k]))


def _largest(branch: xr.Dataset) -> Array:
    """Return the size of the largest multiplier of each orbit, (points,) [-]."""
    sizes = np.hypot(branch["multiplier_real"].values, branch["multiplier_imaginary"].values)
    return np.asarray(np.nanmax(sizes, axis=1, initial=0.0))


def _numbers(branch: xr.Dataset, coordinate: str | None) -> Iterator[tuple[str, Array]]:
    """Yield labels and numbers of the orbits' panels."""
    dims = {"q": "configuration", "v": "coordinate"}
    names = {
        f"{symbol}[{name}]": (symbol, dim, k)
        for symbol, dim in dims.items()
        for k, name in enumerate(branch[dim].values)
    }
    if coordinate is not None and coordinate not in names:
        raise UnknownNameError("figure", "coordinate", coordinate, names)
    if "amplitude" in branch and coordinate is None:
        parts = [branch[name].values for name in ("quantity", "amplitude_unit", "amplitude")]
        for name, unit, row in zip(*parts, strict=True):
            yield _with_unit(f"amplitude of\n{name}", str(unit)), np.asarray(row, dtype=float)
        return
    chosen = coordinate or next(name for name, (symbol, _, _) in names.items() if symbol == "v")
    symbol, dim, k = names[chosen]
    unit = str(branch[f"{dim}_unit"].values[k])
    yield _with_unit(f"{chosen}\nat the start", unit), np.asarray(branch[symbol].values[:, k], dtype=float)


def _with_unit(text: str, unit: str) -> str:
    printed = printed_unit(unit)
    return f"{text} [{printed}]" if printed else text


def _parameter(data: xr.Dataset, **more: Any) -> Axis:
    """Return the axis of the parameter of a branch or a diagram."""
    words = parameter_words(str(data.attrs["parameter"]))
    values = np.asarray(data["value"].values, dtype=float)
    return Axis(words, str(data["value"].attrs.get("units", "")), size_of(values), **more)


@figure(
    branch="Of :func:`antenna_pin.studies.nonlinear.branch_table`.",
    coordinate="Number of the state that is drawn, such as ``v[hinge]``; if left out the "
    "amplitudes that the branch has, or else the first velocity.",
)
def figure_branch(branch: xr.Dataset, coordinate: str | None = None, *, width: Width = "page") -> Sheet:
    """Return periodic solutions over their parameter, and the size of the largest multiplier.

    Stable orbits are a solid line, unstable ones a dashed one; events of the branch are marked by kind.

    Raises:
        UnknownNameError: There is no such coordinate.
    """
    shown = [*_numbers(branch, coordinate), ("size of the largest\nmultiplier [-]", _largest(branch))]
    x = _parameter(branch, ticks=6, shared="parameter")
    panels: list[Panel] = []
    for label, numbers in shown:
        marks: list[PlotMark] = [*_track_curves(track(branch, numbers))]
        marks += [Rule(1.0)] if len(panels) + 1 == len(shown) else []
        panels.append(Panel("", marks, Axis(label), x, margins=(0.03, 0.08)))
    note = f"{branch.sizes['point']} orbits over {branch.attrs['parameter']}; {branch.attrs['message']}"
    return Sheet([[one] for one in panels], width, 20.0 + 46.0 * len(shown), (note,))


def _track_curves(branch: Track, black: bool = False) -> list[PlotCurve]:
    """Return a branch's pieces by stability, and its events, black over coloured dots."""
    curves = []
    for said, x, y in branch.pieces:
        colour = "black" if black else "C0" if said == "stable" else "#555555"
        look = {"linestyle": _LINES[said], "linewidth": 0.9, "zorder": 3.0 if black else 2.0}
        words = f"orbit, {_WORDS[said]}" if black else _WORDS[said]
        curves.append(PlotCurve(words, x, y, {**look, "color": colour}))
    looks = {"linestyle": "none", "markersize": 4.0, "markeredgecolor": "white", "markeredgewidth": 0.4}
    for kind, at, level in branch.marks:
        shape, colour = _MARKS[kind]
        look = {**looks, "marker": shape, "color": colour, "zorder": 4}
        curves.append(PlotCurve(_KINDS.get(kind, kind), np.array([at]), np.array([level]), look))
    return curves


@figure(
    found="Of :func:`~antenna_pin.studies.nonlinear.orbit_table` or "
    ":func:`~antenna_pin.studies.nonlinear.branch_table`."
)
def figure_multipliers(found: xr.Dataset, *, width: Width = "column") -> Sheet:
    """Return Floquet multipliers in the complex plane, with the unit circle.

    Neighbours come nearer along those within. Of a branch every orbit's are drawn, coloured by the parameter.
    """
    real, imaginary = (
        np.asarray(found[f"multiplier_{part}"].values, float) for part in ("real", "imaginary")
    )
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    circle = PlotCurve("", np.cos(turn), np.sin(turn), {"color": "#999999", "linewidth": 0.8, "zorder": 1.0})
    marks: list[PlotMark] = [circle]
    bar = None
    if real.ndim == 1:
        outside = np.hypot(real, imaginary) > 1.0
        look = {"linestyle": "none", "marker": "o", "zorder": 3, "markersize": 4.0}
        for there, colour, word in ((~outside, "C0", "within the circle"), (outside, "C1", "outside")):
            if there.any():
                marks.append(PlotCurve(word, real[there], imaginary[there], {**look, "color": colour}))
        said = f"{found['stability'].item()}; multipliers to {float(found['doubt'].item()):.1g}"
        said += f"; period {float(found['period'].item()):.6g} s"
    else:
        x = _parameter(found)
        across, words = x.scaled(0.0)
        values = across * np.asarray(found["value"].values, dtype=float)
        over = np.broadcast_to(values[:, None], real.shape).ravel()
        norm = Normalize(values.min(), values.max())
        looks: dict[str, Any] = {"cmap": SEQUENTIAL, "norm": norm, "s": 9.0, "linewidths": 0.0, "zorder": 3}
        marks.append(ByHand(lambda axes, *_: axes.scatter(real.ravel(), imaginary.ravel(), c=over, **looks)))
        bar = (ScalarMappable(norm, SEQUENTIAL), words, {"shrink": 0.7, "aspect": 36.0, "pad": 0.02})
        said = f"{found.sizes['point']} orbits"
    half = 1.12 * max(1.0, float(np.nanmax([np.abs(real), np.abs(imaginary)], initial=1.0)))
    x, y = (Axis(f"{part} part [-]", limits=(-half, half)) for part in ("real", "imaginary"))
    panel = Panel("", marks, y, x, named=False, finish=lambda axes: axes.set_aspect("equal"))
    return Sheet([[panel]], width, 84.0 if width == "column" else 110.0, (said,), bar=bar)


# --- sections and diagrams ---

_COLOURS = {"fresh": "#7F7F7F", "forward": "C0", "backward": "C1"}
_BRANCHES = {"fresh": "from the start", "forward": "forward", "backward": "backward"}
_UNSETTLED = "#CC3311"
# Smallest range about a fixed point over its size: below it only the rest of the approach is visible.
_NEAREST = 0.02


def _section_axis(data: xr.Dataset, name: str, limited: bool = True) -> Axis:
    """Return the axis of a section's quantity, a little beyond its values."""
    label = _with_unit(name, str(data[name].attrs.get("units", "")))
    if not limited:
        return Axis(label, ticks=0, shared="across")
    low, high = float(np.nanmin(data[name].values)), float(np.nanmax(data[name].values))
    size = max(abs(low), abs(high))
    half = max(0.55 * (high - low), _NEAREST * size, 1e-12 if size == 0.0 else 0.0)
    middle = 0.5 * (low + high)
    return Axis(label, limits=(middle - half, middle + half), ticks=0)


@figure(section="``time`` and its quantities over ``point``, and whether they have settled.")
def figure_section(section: xr.Dataset, *, width: Width = "column") -> Sheet:
    """Return the points of a section (:func:`antenna_pin.studies.nonlinear.poincare`).

    The first quantity is the abscissa of all the others, a panel each; a single one stands over time.
    """
    names = json.loads(section.attrs["quantities"])
    across, others = (names[0], names[1:]) if len(names) > 1 else ("time", names)
    settled = bool(section["settled"].item())
    look = {"linestyle": "none", "markersize": 3.0, "markeredgewidth": 0.5} | (
        {"marker": ".", "color": "C0"} if settled else {"marker": "x", "color": _UNSETTLED}
    )
    x = replace(_section_axis(section, across, len(names) > 1), shared="across")
    panels = [
        Panel(
            "",
            [PlotCurve("", section[across].values, section[name].values, look)],
            _section_axis(section, name),
            x,
        )
        for name in others
    ]
    rows = [[replace(panel, margins=(0.05, 0.05))] for panel in panels]
    said = f"{section.attrs['section']}; {section.sizes['point']} points"
    said += f" behind {int(section['transient'].item())}" + ("" if settled else "; they had not settled")
    return Sheet(rows, width, 18.0 + 62.0 * len(others), (said,))


@figure(
    diagram="Quantities over ``branch``, ``value`` and ``point``.",
    quantities="Which of them; all if left out.",
    orbits="Branches of periodic solutions of the same scenario over the same parameter "
    "(:func:`antenna_pin.studies.nonlinear.orbits_in_section`).",
)
def figure_bifurcation(
    diagram: xr.Dataset,
    *,
    quantities: Sequence[str] | None = None,
    orbits: Sequence[xr.Dataset] | xr.Dataset = (),
    width: Width = "page",
) -> Sheet:
    """Return a bifurcation diagram (:func:`~antenna_pin.studies.nonlinear.bifurcation`), a panel a quantity.

    Points that had not settled are crosses; values that failed are ticks at the lower edge. Over them lie
    periodic solutions where they pass the section: stable ones as a solid line, unstable ones, which no
    motion approaches, as a dashed one, and their events marked by kind.

    Raises:
        UnknownNameError: The diagram has no such quantity.
        InvalidParameterError: A branch is over another parameter, or has not all quantities.
    """
    names = json.loads(diagram.attrs["quantities"])
    for name in quantities or ():
        if name not in names:
            raise UnknownNameError("figure", "quantity", name, names)
    names = list(quantities or names)
    tracks = [orbits] if isinstance(orbits, xr.Dataset) else list(orbits)
    _check_over_the_same(diagram, tracks, names)
    spaced = is_spaced_by_factors(np.asarray(diagram["value"].values, dtype=float))
    x = _parameter(diagram, scale="log" if spaced else "linear", ticks=0, shared="parameter")
    said = {str(diagram.attrs["section"]): None}
    rows = []
    for name in names:
        marks, meant = _points(diagram, name)
        said |= dict.fromkeys(meant)
        for branch in tracks:  # where its orbits pass the section, with their stability
            for passed in np.asarray(branch[name].values, dtype=float).T:
                marks += _track_curves(track(branch, passed), black=True)
        about = diagram[name].attrs
        words = textwrap.fill(str(about.get("long_name") or name), 30)
        y = Axis(words, str(about.get("units", "")), size_of(diagram[name].values), ticks=0)
        named = diagram.sizes["branch"] > 1 or bool(tracks)
        rows.append([Panel(name, marks, y, x, margins=(0.01, 0.05), named=named)])
    notes = (*said, f"over {diagram.attrs['parameter']}")
    return Sheet(rows, width, 24.0 + 52.0 * len(names), notes)


def _check_over_the_same(diagram: xr.Dataset, branches: Sequence[xr.Dataset], names: Sequence[str]) -> None:
    """Raise if a branch has another parameter, or lacks quantities."""
    over = str(diagram.attrs["parameter"])
    for branch in branches:
        if branch.attrs["parameter"] != over:
            rule, got = f"over {over} as the diagram", str(branch.attrs["parameter"])
            raise InvalidParameterError("figure", "orbits", rule, said=f"one over {got}")
        missing = [name for name in names if name not in branch]
        if missing:
            rule = "a branch with its points in the section (nonlinear.orbits_in_section)"
            raise InvalidParameterError("figure", "orbits", rule, said=f"one without {', '.join(missing)}")


def _points(diagram: xr.Dataset, name: str) -> tuple[list[PlotMark], list[str]]:
    """Return the points of a diagram, and the meaning of its marks."""
    values = np.asarray(diagram["value"].values, dtype=float)
    settled = np.asarray(diagram["settled"].values, dtype=bool)
    said: dict[str, None] = {}
    marks: list[PlotMark] = []
    lost: dict[str, Any] = {"linestyle": "none", "color": _UNSETTLED, "markeredgewidth": 0.4}
    for b, branch in enumerate(str(one) for one in diagram["branch"].values):
        points = np.asarray(diagram[name].values[b], dtype=float)
        x = np.broadcast_to(values[:, None], points.shape)
        dots = {"linestyle": "none", "marker": ".", "color": _COLOURS[branch]}
        # Of two branches the first stands a little larger behind the other, which else would hide it.
        size = {"fresh": 3.0, "forward": 2.6, "backward": 1.4}[branch]
        look = {**dots, "markersize": size, "markeredgewidth": 0.0}
        there, known = settled[b], np.isfinite(points).any(axis=1)
        many = points.size > 20000
        marks.append(PlotCurve("", x[there].ravel(), points[there].ravel(), look, many=many))
        marks.append(PlotCurve(_BRANCHES[branch], np.empty(0), np.empty(0), dots))
        rest = ~there & known
        if rest.any():
            said["crosses: had not settled"] = None
            look = {**lost, "marker": "x", "markersize": 2.2}
            marks.append(PlotCurve("", x[rest].ravel(), points[rest].ravel(), look))
        if not known.all():
            said["ticks below: failed"] = None

            def ticks(axes: Axes, across: float, _: float, at: Array = values[~known]) -> None:
                look = {**lost, "marker": "|", "markersize": 6.0, "clip_on": False}
                axes.plot(across * at, np.zeros(at.size), transform=axes.get_xaxis_transform(), **look)

            marks.append(ByHand(ticks))
    return marks, list(said)


# --- Lyapunov exponents ---

_NAMED = 6  # exponents that have a colour and an entry of their own


@figure(exponents="Of :func:`antenna_pin.studies.nonlinear.exponents_table`.")
def figure_exponents(exponents: xr.Dataset, *, width: Width = "page") -> Sheet:
    """Return Lyapunov exponents after each interval, and finally with a standard error."""
    time, running, values, errors = (
        np.asarray(exponents[name].values, dtype=float) for name in ("time", "running", "value", "error")
    )
    end = float(time[-1])
    marks: list[PlotMark] = [Rule(0.0)]
    looks: dict[str, Any] = {"marker": "o", "markersize": 2.6, "capsize": 2.0, "elinewidth": 0.8, "zorder": 4}
    for k, (value, error) in enumerate(zip(values, errors, strict=True)):
        known = np.isfinite(error)
        spread = f" ± {error:.2g}" if known else ", error unknown"
        label = f"{value:.4g}{spread} 1/s" if k < _NAMED else "others"
        colour = f"C{k}" if k < _NAMED else "#999999"
        marks.append(PlotCurve(label, time, running[:, k], {"color": colour, "linewidth": 0.8}))
        # Side by side, as errors of exponents that are alike would cover one another.
        bar = {"yerr": [[error], [error]] if known else None, "color": colour, **looks}
        at = [end * (1.015 + 0.012 * k)], [value]
        marks.append(ByHand(lambda axes, *_, at=at, bar=bar: axes.errorbar(*at, **bar)))
    limits = _range(running, values, np.where(np.isfinite(errors), errors, 0.0))
    x = Axis("time behind the transient [s]", limits=(0.0, end * (1.03 + 0.012 * len(values))), ticks=6)
    intervals = f"{len(time)} intervals of {float(exponents.attrs['interval']):.6g} s"
    notes = (str(exponents.attrs["verdict"]), intervals, "bars: one standard error")
    return Sheet([[Panel("", marks, Axis("Lyapunov exponent [1/s]", limits=limits), x)]], width, 78.0, notes)


def _range(running: np.ndarray, values: np.ndarray, errors: np.ndarray) -> tuple[float, float]:
    """Return limits around final exponents; their first tenth may exceed them."""
    later = running[len(running) // 10 :]
    low = min(float(later.min()), float((values - errors).min()), 0.0)
    high = max(float(later.max()), float((values + errors).max()), 0.0)
    margin = 0.08 * (high - low) or 1.0
    return low - margin, high + margin
