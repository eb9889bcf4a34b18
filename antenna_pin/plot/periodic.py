"""Periodic solutions over a parameter, and their Floquet multipliers in the complex plane."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import UnknownNameError
from antenna_pin.plot._style import (
    SEQUENTIAL,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    literal,
    new_figure,
    panel_title,
    parameter_words,
    prefixed,
    styled,
)

_LINES: dict[str, Any] = {"stable": "-", "unstable": (0, (3.0, 1.6)), "neutral": (0, (0.8, 1.2))}
_WORDS = {"stable": "stable", "unstable": "unstable", "neutral": "cannot be told"}
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
    """A branch in one number: pieces of one stability each, and where something happens to it.

    Attributes:
        pieces: Stability, values of the parameter and of the number, (m,) each.
        marks: Kind, value of the parameter and of the number.
    """

    pieces: list[tuple[str, Array, Array]]
    marks: list[tuple[str, float, float]]


def track(branch: xr.Dataset, numbers: Array) -> Track:
    """Return a branch in one number of its orbits, (points,).

    What happens to it lies on the line between the points about it, at its value of the parameter; a fold, or
    what else neither comes to, where the size of the largest multiplier on that line is 1. Stability changes
    there, or, between two points that differ without any of it, where that size is 1: that is marked too.
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
    """Return how far from a point to the next a size is 1, as a share of that way; half if it nowhere is."""
    if k + 1 >= len(sizes) or (sizes[k] - 1.0) * (sizes[k + 1] - 1.0) >= 0.0:
        return 0.5
    return float((1.0 - sizes[k]) / (sizes[k + 1] - sizes[k]))


def _largest(branch: xr.Dataset) -> Array:
    """Return the size of the largest multiplier of each orbit, (points,) [-]."""
    sizes = np.hypot(branch["multiplier_real"].values, branch["multiplier_imaginary"].values)
    return np.asarray(np.nanmax(sizes, axis=1, initial=0.0))


def _numbers(branch: xr.Dataset, coordinate: str | None) -> Iterator[tuple[str, Array]]:
    """Yield labels and numbers of the panels that say where the orbits are."""
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
            yield _labelled(f"amplitude of\n{name}", str(unit)), np.asarray(row, dtype=float)
        return
    chosen = coordinate or next(name for name, (symbol, _, _) in names.items() if symbol == "v")
    symbol, dim, k = names[chosen]
    unit = str(branch[f"{dim}_unit"].values[k])
    yield _labelled(f"{chosen}\nat the start", unit), np.asarray(branch[symbol].values[:, k], dtype=float)


def _labelled(text: str, unit: str) -> str:
    printed = printed_unit(unit)
    return literal(f"{text} [{printed}]" if printed else text)


def _over(branch: xr.Dataset) -> tuple[float, str]:
    """Return what values of the parameter are multiplied with, and the label of their axis."""
    largest = float(np.nanmax(np.abs(branch["value"].values), initial=0.0))
    factor, unit = prefixed(str(branch["value"].attrs.get("units", "")), largest)
    words = parameter_words(str(branch.attrs["parameter"]))
    return factor, literal(f"{words} [{unit}]" if unit else words)


@takes()
@styled
def figure_branch(branch: xr.Dataset, coordinate: str | None = None, *, width: Width = "page") -> Figure:
    """Return a branch of periodic solutions over its parameter, and the size of the largest multiplier.

    Stable orbits are a solid line, unstable ones a dashed one; what happens to the branch is marked by kind.

    Args:
        branch: Of :func:`antenna_pin.nonlinear.branch_table`.
        coordinate: Number of the state that orbits are told by to draw, such as ``v[hinge]``; if left out the
            amplitudes that the branch has, or else the first velocity.
        width: "column" (88 mm) or "page" (180 mm).

    Raises:
        UnknownNameError: There is no such coordinate.
    """
    shown = list(_numbers(branch, coordinate))
    shown.append(("size of the largest\nmultiplier [-]", _largest(branch)))
    figure = new_figure(width, 20.0 + 46.0 * len(shown))
    panels = figure.subplots(len(shown), 1, sharex=True, squeeze=False).ravel()
    across, over = _over(branch)
    for letter, axes, (label, numbers) in zip(letters(), panels, shown, strict=False):
        draw_track(axes, track(branch, numbers), (across, 1.0))
        axes.set_ylabel(label)
        axes.margins(x=0.03, y=0.08)
        panel_title(axes, letter, "")
        few_ticks(axes)
    panels[-1].axhline(1.0, color="#999999", linewidth=0.6, zorder=0.8)
    panels[-1].set_xlabel(over)
    legend_above(figure, panels)
    footnote(
        figure,
        f"{branch.sizes['point']} orbits over {branch.attrs['parameter']}; {branch.attrs['message']}",
    )
    return figure


def draw_track(
    axes: Axes, found: Track, scale: tuple[float, float] = (1.0, 1.0), black: bool = False
) -> None:
    """Draw a branch: stable pieces solid, unstable ones dashed, what happens to it marked by kind.

    Args:
        axes: Where.
        found: Of :func:`track`.
        scale: What values of the parameter and of the number are multiplied with.
        black: Whether lines are black, as over dots that have colours of their own.
    """
    across, factor = scale
    for said, x, y in found.pieces:
        axes.plot(
            across * x,
            factor * y,
            color="black" if black else "C0" if said == "stable" else "#555555",
            linestyle=_LINES[said],
            linewidth=0.9,
            zorder=3.0 if black else 2.0,
            label=f"orbit, {_WORDS[said]}" if black else _WORDS[said],
        )
    for kind, at, level in found.marks:
        shape, colour = _MARKS[kind]
        axes.plot(
            across * at,
            factor * level,
            linestyle="none",
            marker=shape,
            markersize=4.0,
            color=colour,
            markeredgecolor="white",
            markeredgewidth=0.4,
            label=_KINDS.get(kind, kind),
            zorder=4,
        )


@takes()
@styled
def figure_multipliers(found: xr.Dataset, *, width: Width = "column") -> Figure:
    """Return Floquet multipliers in the complex plane, with the unit circle.

    Neighbours come nearer along those within. Of a branch every orbit's are drawn, coloured by the parameter.

    Args:
        found: Of :func:`antenna_pin.nonlinear.orbit_table` or :func:`~antenna_pin.nonlinear.branch_table`.
        width: "column" (88 mm) or "page" (180 mm).
    """
    real = np.asarray(found["multiplier_real"].values, dtype=float)
    imaginary = np.asarray(found["multiplier_imaginary"].values, dtype=float)
    figure = new_figure(width, 84.0 if width == "column" else 110.0)
    axes = figure.add_subplot()
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    axes.plot(np.cos(turn), np.sin(turn), color="#999999", linewidth=0.8, zorder=1.0)
    looks: dict[str, Any] = {"linestyle": "none", "marker": "o", "zorder": 3}
    if real.ndim == 1:
        outside = np.hypot(real, imaginary) > 1.0
        for there, colour, word in ((~outside, "C0", "within the circle"), (outside, "C1", "outside")):
            if there.any():
                axes.plot(real[there], imaginary[there], color=colour, markersize=4.0, label=word, **looks)
        said = f"{found['stability'].item()}; multipliers to {float(found['doubt'].item()):.1g}"
        said += f"; period {float(found['period'].item()):.6g} s"
    else:
        across, words = _over(found)
        over = np.broadcast_to(across * np.asarray(found["value"].values, dtype=float)[:, None], real.shape)
        points = axes.scatter(
            real.ravel(), imaginary.ravel(), c=over.ravel(), cmap=SEQUENTIAL, s=9.0, linewidths=0.0, zorder=3
        )
        bar: Any = figure.colorbar(points, ax=axes, label=words, shrink=0.7, aspect=36.0, pad=0.02)
        bar.outline.set_linewidth(0.4)
        said = f"{found.sizes['point']} orbits"
    farthest = float(np.nanmax([np.abs(real), np.abs(imaginary)], initial=1.0))
    half = 1.12 * max(1.0, farthest)
    axes.set(xlim=(-half, half), ylim=(-half, half), aspect="equal")
    axes.set_xlabel("real part [-]")
    axes.set_ylabel("imaginary part [-]")
    few_ticks(axes, 5, 5)
    footnote(figure, said)
    return figure
