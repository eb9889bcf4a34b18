"""Sections of a motion as points, and bifurcation diagrams."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.plot._study import is_spaced_by_factors
from antenna_pin.plot._style import (
    Width,
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
from antenna_pin.plot.periodic import draw_track, track

_COLOURS = {"fresh": "#7F7F7F", "forward": "C0", "backward": "C1"}
_WORDS = {"fresh": "from the start", "forward": "forward", "backward": "backward"}
_UNSETTLED = "#CC3311"
# A fixed point is not looked at from nearer than this part of its size: what is seen then is what is left of
# the way to it.
_NEAREST = 0.02


def _axis_label(data: xr.Dataset, name: str) -> str:
    unit = printed_unit(str(data[name].attrs.get("units", "")))
    return literal(f"{name} [{unit}]" if unit else name)


def _range(values: np.ndarray) -> tuple[float, float]:
    """Return where an axis of these values begins and ends."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    size = max(abs(low), abs(high))
    half = max(0.55 * (high - low), _NEAREST * size, 1e-12 if size == 0.0 else 0.0)
    middle = 0.5 * (low + high)
    return middle - half, middle + half


@takes()
@styled
def figure_section(section: xr.Dataset, *, width: Width = "column") -> Figure:
    """Return the points of a section (:func:`antenna_pin.nonlinear.poincare`).

    The first quantity is the abscissa of all the others, a panel each; a single one stands over time.

    Args:
        section: ``time`` and its quantities over ``point``, and whether they have settled.
        width: "column" (88 mm) or "page" (180 mm).
    """
    names = json.loads(section.attrs["quantities"])
    across, others = (names[0], names[1:]) if len(names) > 1 else ("time", names)
    figure = new_figure(width, 18.0 + 62.0 * len(others))
    panels = figure.subplots(len(others), 1, sharex=True, squeeze=False).ravel()
    settled = bool(section["settled"].item())
    for letter, axes, name in zip(letters(), panels, others, strict=False):
        axes.plot(
            section[across].values,
            section[name].values,
            linestyle="none",
            marker="." if settled else "x",
            markersize=3.0,
            color="C0" if settled else _UNSETTLED,
            markeredgewidth=0.5,
        )
        axes.set_ylabel(_axis_label(section, name))
        axes.margins(0.05)
        axes.set_ylim(*_range(section[name].values))
        if len(names) > 1:
            axes.set_xlim(*_range(section[across].values))
        if len(others) > 1:
            panel_title(axes, letter, "")
    panels[-1].set_xlabel(_axis_label(section, across))
    said = f"{section.attrs['section']}; {section.sizes['point']} points"
    said += f" behind {int(section['transient'].item())}"
    footnote(figure, said + ("" if settled else "; they had not settled"))
    return figure


@takes()
@styled
def figure_bifurcation(
    diagram: xr.Dataset,
    *,
    quantities: Sequence[str] | None = None,
    orbits: Sequence[xr.Dataset] | xr.Dataset = (),
    width: Width = "page",
) -> Figure:
    """Return a bifurcation diagram (:func:`antenna_pin.nonlinear.bifurcation`), a panel for each quantity.

    Points that had not settled are crosses; values that failed are ticks at the lower edge. Over them lie
    periodic solutions where they pass the section: stable ones as a solid line, unstable ones, which no
    motion comes to, as a dashed one, and what happens to them marked by kind.

    Args:
        diagram: Quantities over ``branch``, ``value`` and ``point``.
        quantities: Which of them; all if left out.
        orbits: Branches of periodic solutions of the same scenario over the same parameter
            (:func:`antenna_pin.nonlinear.orbits_in_section`).
        width: "column" (88 mm) or "page" (180 mm).

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
    figure = new_figure(width, 24.0 + 52.0 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False).ravel()
    values = np.asarray(diagram["value"].values, dtype=float)
    across, unit = prefixed(
        str(diagram["value"].attrs.get("units", "")), float(np.abs(values).max(initial=0.0))
    )
    spaced = is_spaced_by_factors(values)
    said = {str(diagram.attrs["section"]): None}
    for letter, axes, name in zip(letters(), panels, names, strict=False):
        largest = float(np.nanmax(np.abs(diagram[name].values), initial=0.0))
        factor, printed = prefixed(str(diagram[name].attrs.get("units", "")), largest)
        said |= dict.fromkeys(_points(axes, diagram, name, across, factor))
        for branch in tracks:
            _orbits(axes, branch, name, across, factor)
        words = textwrap.fill(str(diagram[name].attrs.get("long_name") or name), 30)
        axes.set_ylabel(literal(f"{words} [{printed}]" if printed else words))
        axes.margins(x=0.01)
        if spaced:
            axes.set_xscale("log")
        else:
            axes.set_xlim(auto=True)
        panel_title(axes, letter if len(names) > 1 else "", name)
    words = parameter_words(str(diagram.attrs["parameter"]))
    panels[-1].set_xlabel(literal(f"{words} [{unit}]" if unit else words))
    if diagram.sizes["branch"] > 1 or tracks:
        legend_above(figure, panels)
    footnote(figure, *said, f"over {diagram.attrs['parameter']}")
    return figure


def _check_over_the_same(diagram: xr.Dataset, branches: Sequence[xr.Dataset], names: Sequence[str]) -> None:
    """Raise if a branch is not of the diagram's parameter, or lacks its quantities in the section."""
    over = str(diagram.attrs["parameter"])
    for branch in branches:
        if branch.attrs["parameter"] != over:
            rule, got = f"over {over} as the diagram", str(branch.attrs["parameter"])
            raise InvalidParameterError("figure", "orbits", rule, said=f"one over {got}")
        missing = [name for name in names if name not in branch]
        if missing:
            rule = "a branch with its points in the section (nonlinear.orbits_in_section)"
            raise InvalidParameterError("figure", "orbits", rule, said=f"one without {', '.join(missing)}")


def _points(axes: Axes, diagram: xr.Dataset, name: str, across: float, factor: float) -> list[str]:
    """Draw the points of a diagram; return what its marks mean."""
    values = across * np.asarray(diagram["value"].values, dtype=float)
    settled = np.asarray(diagram["settled"].values, dtype=bool)
    said: dict[str, None] = {}
    dots: dict[str, Any] = {"linestyle": "none", "marker": "."}
    for b, branch in enumerate(str(one) for one in diagram["branch"].values):
        points = factor * np.asarray(diagram[name].values[b], dtype=float)
        x = np.broadcast_to(values[:, None], points.shape)
        # Of two branches the first stands a little larger behind the other, which else would hide it.
        size = {"fresh": 3.0, "forward": 2.6, "backward": 1.4}[branch]
        there = settled[b]
        axes.plot(
            x[there].ravel(),
            points[there].ravel(),
            markersize=size,
            markeredgewidth=0.0,
            color=_COLOURS[branch],
            rasterized=points.size > 20000,
            **dots,
        )
        axes.plot([], [], color=_COLOURS[branch], label=_WORDS[branch], **dots)
        marks: dict[str, Any] = {"linestyle": "none", "color": _UNSETTLED, "markeredgewidth": 0.4}
        rest = ~there & np.isfinite(points).any(axis=1)
        if rest.any():
            said["crosses: had not settled"] = None
            axes.plot(
                x[rest].ravel(),
                points[rest].ravel(),
                marker="x",
                markersize=2.2,
                **marks,
            )
        nothing = ~np.isfinite(points).any(axis=1)
        if nothing.any():
            said["ticks below: failed"] = None
            axes.plot(
                values[nothing],
                np.zeros(int(nothing.sum())),
                marker="|",
                markersize=6.0,
                transform=axes.get_xaxis_transform(),
                clip_on=False,
                **marks,
            )
    return list(said)


def _orbits(axes: Axes, branch: xr.Dataset, name: str, across: float, factor: float) -> None:
    """Draw periodic solutions where they pass the section, with their stability."""
    for passed in np.asarray(branch[name].values, dtype=float).T:
        draw_track(axes, track(branch, passed), scale=(across, factor), black=True)
