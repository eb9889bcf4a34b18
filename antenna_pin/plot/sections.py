"""Sections of a motion as points, and bifurcation diagrams."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from antenna_pin.arguments import takes
from antenna_pin.errors import UnknownNameError
from antenna_pin.plot._style import Width, footnote, legend_above, letters, new_figure, panel_title, styled
from antenna_pin.readable import printed_unit

_COLOURS = {"fresh": "#444444", "forward": "C0", "backward": "C1"}
_WORDS = {"fresh": "from the start", "forward": "forward", "backward": "backward"}
_UNSETTLED = "#CC3311"
# A fixed point is not looked at from nearer than this part of its size: what is seen then is what is left of
# the way to it.
_NEAREST = 0.02


def _axis_label(data: xr.Dataset, name: str) -> str:
    unit = printed_unit(str(data[name].attrs.get("units", "")))
    return f"{name} [{unit}]" if unit else name


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
    diagram: xr.Dataset, *, quantities: Sequence[str] | None = None, width: Width = "page"
) -> Figure:
    """Return a bifurcation diagram (:func:`antenna_pin.nonlinear.bifurcation`), a panel for each quantity.

    Points that had not settled are crosses; values that failed are ticks at the lower edge.

    Args:
        diagram: Quantities over ``branch``, ``value`` and ``point``.
        quantities: Which of them; all if left out.
        width: "column" (88 mm) or "page" (180 mm).

    Raises:
        UnknownNameError: The diagram has no such quantity.
    """
    names = json.loads(diagram.attrs["quantities"])
    for name in quantities or ():
        if name not in names:
            raise UnknownNameError("figure", "quantity", name, names)
    names = list(quantities or names)
    figure = new_figure(width, 24.0 + 52.0 * len(names))
    panels = figure.subplots(len(names), 1, sharex=True, squeeze=False).ravel()
    values = np.asarray(diagram["value"].values, dtype=float)
    settled = np.asarray(diagram["settled"].values, dtype=bool)
    unsettled = failed = False
    for letter, axes, name in zip(letters(), panels, names, strict=False):
        for b, branch in enumerate(str(one) for one in diagram["branch"].values):
            points = np.asarray(diagram[name].values[b], dtype=float)
            x = np.broadcast_to(values[:, None], points.shape)
            # Of two branches the first stands a little larger behind the other, which else would hide it.
            size = {"fresh": 3.0, "forward": 2.6, "backward": 1.4}[branch]
            there = settled[b]
            colour = _COLOURS[branch]
            axes.plot(
                x[there].ravel(),
                points[there].ravel(),
                linestyle="none",
                marker=".",
                markersize=size,
                markeredgewidth=0.0,
                color=colour,
                rasterized=points.size > 20000,
            )
            axes.plot([], [], linestyle="none", marker=".", color=colour, label=_WORDS[branch])
            rest = ~there & np.isfinite(points).any(axis=1)
            if rest.any():
                unsettled = True
                axes.plot(
                    x[rest].ravel(),
                    points[rest].ravel(),
                    linestyle="none",
                    marker="x",
                    markersize=2.2,
                    markeredgewidth=0.4,
                    color=_UNSETTLED,
                )
            nothing = ~np.isfinite(points).any(axis=1)
            if nothing.any():
                failed = True
                axes.plot(
                    values[nothing],
                    np.zeros(int(nothing.sum())),
                    linestyle="none",
                    marker="|",
                    color=_UNSETTLED,
                    transform=axes.get_xaxis_transform(),
                    clip_on=False,
                )
        axes.set_ylabel(_axis_label(diagram, name))
        axes.margins(x=0.01)
        axes.set_xlim(auto=True)
        if len(names) > 1:
            panel_title(axes, letter, "")
    unit = printed_unit(str(diagram["value"].attrs.get("units", "")))
    panels[-1].set_xlabel(diagram.attrs["parameter"] + (f" [{unit}]" if unit else ""))
    if diagram.sizes["branch"] > 1:
        legend_above(figure, panels)
    said = [str(diagram.attrs["section"])]
    said += ["crosses: had not settled"] if unsettled else []
    said += ["ticks below: failed"] if failed else []
    footnote(figure, "; ".join(said))
    return figure
