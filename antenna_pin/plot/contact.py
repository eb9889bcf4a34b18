"""Contact laws, for papers: force over depth, and the restitution delivered over the one asked for."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from antenna_pin.base.arguments import takes
from antenna_pin.contact import NormalLaw
from antenna_pin.errors import InvalidParameterError
from antenna_pin.law_studies import RestitutionRow, force_within
from antenna_pin.plot._style import (
    COLOURS,
    Array,
    Width,
    literal,
    new_figure,
    panel_title,
    prefixed,
    styled,
)
from antenna_pin.plot.files import check_formats, folder_for_figures, save_figure

DASHES: tuple[Any, ...] = ("-", (0, (4, 1.2)), (0, (1, 1)), (0, (4, 1, 1, 1)))
_LABEL_HEIGHT = 3.0  # of one line of text beside a panel [mm]
_FAR = 0.1  # a dissipation further than this from what it is asked for has its place in the first panel [-]


@takes()
def save_contact_figures(
    figures: Mapping[str, Figure], folder: str | Path, formats: Sequence[str] = ("png",)
) -> list[Path]:
    """Write figures by name to a folder and return their paths. Each appears whole or not at all.

    Args:
        figures: Figures by the stem of their file's name.
        folder: Where to write; made if it is missing.
        formats: Any of "png", "pdf" and "svg".
    """
    check_formats(formats)
    target = folder_for_figures(folder)
    return [path for name, figure in figures.items() for path in save_figure(figure, target / name, formats)]


# --- force over depth ---


@takes()
@styled
def figure_force_curves(
    laws: Mapping[str, NormalLaw], *, depths: Iterable[float] = (1e-7, 2e-5), width: Width = "page"
) -> Figure:
    """Return the elastic force of laws over the depth, both on logarithmic scales.

    Laws whose curves coincide share one line and its label. A curve that ends before the right edge has a dot
    where the law's range ends, and its name in a legend.

    Args:
        laws: The laws by name.
        depths: Depths that the figure must hold [m], positive; its scale runs from the least to the greatest.
        width: "column" (88 mm) or "page" (180 mm).
    """
    held = sorted(depths)
    if not laws:
        raise InvalidParameterError("figure_force_curves", "laws", "at least one law", "none")
    if not held or not held[0] > 0.0:
        raise InvalidParameterError("figure_force_curves", "depths", "positive and at least one [m]", held)
    low, high = (held[0], held[-1]) if held[-1] > held[0] else (0.5 * held[0], 2.0 * held[0])
    grid = np.geomspace(low, high, 300)
    curves = _coinciding({name: _forces(law, grid) for name, law in laws.items()})
    factor, unit = prefixed("m", high)
    figure = new_figure(width, max(66.0, 30.0 + 4.0 * len(laws)))
    axes = figure.add_subplot()
    ends = []
    for (label, force), (dash, colour) in zip(curves.items(), looks(), strict=False):
        known = np.isfinite(force)
        if not known.any():
            continue
        last = int(np.flatnonzero(known)[-1])
        ended = last < grid.size - 1
        axes.plot(
            factor * grid[known],
            force[known],
            color=colour,
            linestyle=dash,
            label=label,
            marker="o" if ended else None,
            markersize=3.0,
            markevery=[-1],
        )
        if not ended:
            ends.append((label, colour, factor * grid[last], float(force[last])))
    axes.set(xscale="log", yscale="log", xlabel=f"depth [{unit}]", ylabel="force [N]")
    axes.set_xlim(factor * low, factor * high)
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.xaxis.set_major_formatter(lambda value, _position: f"{value:g}")
    for depth in held[1:-1]:  # where the table stands
        axes.axvline(factor * depth, color="#999999", linewidth=0.5, linestyle=":", zorder=1.5)
    named = {label for label, *_ in ends}
    within = [entry for entry in axes.lines if entry.get_label() in set(curves) - named]
    if within:  # lines to their names would cross the others
        names = [literal(str(entry.get_label()).replace("\n", " ")) for entry in within]
        axes.legend(
            within, names, loc="lower right", fontsize=6.5, title="ends at the dot", title_fontsize=6.5
        )
    if ends:
        _label_ends(figure, axes, ends)
    return figure


def _forces(law: NormalLaw, depths: Array) -> Array:
    return np.array([force_within(law, float(depth)) for depth in depths])


def _coinciding(curves: Mapping[str, Array]) -> dict[str, Array]:
    """Return curves with those that coincide under one label, a name to a line."""
    groups: list[tuple[list[str], Array]] = []
    for name, curve in curves.items():
        for names, other in groups:
            if curve.shape == other.shape and np.allclose(curve, other, rtol=1e-9, atol=0.0, equal_nan=True):
                names.append(name)
                break
        else:
            groups.append(([name], curve))
    return {",\n".join(names): curve for names, curve in groups}


def looks() -> Iterator[tuple[Any, str]]:
    """Yield dash and colour of one curve after the other; neighbours differ in both."""
    colours = (*COLOURS, "black")
    for k in itertools.count():
        row, place = divmod(k, len(colours))
        yield DASHES[(place + row) % len(DASHES)], colours[place]


def _label_ends(figure: Figure, axes: Axes, ends: Sequence[tuple[str, str, float, float]]) -> None:
    """Name curves to the right of a panel, in the order of their ends, with a line from each to its name."""
    bottom, top = np.log10(axes.get_ylim())
    height = figure.get_figheight() * 25.4 - 14.0  # of the panel, about [mm]
    ordered = sorted(ends, key=lambda end: end[3])
    half = [0.5 * _LABEL_HEIGHT * (1 + label.count("\n")) / height for label, *_ in ordered]
    places = [(np.log10(force) - bottom) / (top - bottom) for *_, force in ordered]
    for _ in range(400):  # neighbours that are too close push each other apart, and the panel holds them
        places[0] = max(places[0], half[0])
        places[-1] = min(places[-1], 1.0 - half[-1])
        for k in range(len(places) - 1):
            short = half[k] + half[k + 1] - (places[k + 1] - places[k])
            if short > 0.0:
                places[k] -= 0.5 * short
                places[k + 1] += 0.5 * short
    for (label, colour, x, y), place in zip(ordered, places, strict=True):
        axes.annotate(
            literal(label),
            xy=(x, y),
            xytext=(1.12, place),
            textcoords="axes fraction",
            va="center",
            fontsize=6.5,
            linespacing=1.0,
            color=colour,
            annotation_clip=False,
            arrowprops={
                "arrowstyle": "-",
                "color": colour,
                "linewidth": 0.4,
                "shrinkA": 0.0,
                "shrinkB": 1.0,
                "relpos": (0.0, 0.5),
            },
        )


# --- restitution ---


@takes()
@styled
def figure_restitution(
    rows: Iterable[RestitutionRow], *, closed_form: Iterable[RestitutionRow] = (), width: Width = "page"
) -> Figure:
    """Return the restitution that dissipations deliver over the one asked for.

    Dissipations that deliver something else by more than 0.1 stand in the first panel; of the others the
    second panel shows the difference. Lines are closed forms, circles impacts that were integrated.

    Args:
        rows: Of :func:`antenna_pin.contact.restitution_table`.
        closed_form: More rows of the same dissipations, for smooth lines.
        width: "column" (88 mm) or "page" (180 mm).
    """
    points = list(rows)
    lines = [*points, *closed_form]
    names = list(dict.fromkeys(row.dissipation for row in points))
    if not names:
        raise InvalidParameterError("figure_restitution", "rows", "at least one row", "none")
    errors = {
        name: max(
            (
                abs(row.closed_form - row.asked)
                for row in lines
                if row.dissipation == name and np.isfinite(row.closed_form)
            ),
            default=0.0,
        )
        for name in names
    }
    groups = [
        ([name for name in names if errors[name] > _FAR], False),
        ([name for name in names if errors[name] <= _FAR], True),
    ]
    groups = [group for group in groups if group[0]]
    side_by_side = width == "page" or len(groups) == 1
    legend = 4.0 * max((len(group) + 1) // 2 for group, _ in groups)
    figure = new_figure(width, (62.0 + legend) * (1 if side_by_side else len(groups)))
    shape = (1, len(groups)) if side_by_side else (len(groups), 1)
    simulated = any(np.isfinite(row.on_wall) for row in points)
    for place, (group, difference) in enumerate(groups):
        axes = figure.add_subplot(*shape, place + 1)
        curves = {name: _delivered(lines, name) for name in group}
        for (label, curve), (dash, colour) in zip(_coinciding(curves).items(), looks(), strict=False):
            name = label.split(",")[0]
            dots = np.array([(row.asked, row.on_wall) for row in points if row.dissipation == name])
            less = 1.0 if difference else 0.0
            axes.plot(
                curve[:, 0],
                curve[:, 1] - less * curve[:, 0],
                color=colour,
                linestyle=dash,
                label=label.replace("\n", " "),
            )
            axes.plot(
                dots[:, 0],
                dots[:, 1] - less * dots[:, 0],
                "o",
                color=colour,
                markersize=2.6,
                fillstyle="none",
                markeredgewidth=0.6,
                clip_on=False,
            )
        exact = [0.0, 0.0] if difference else [0.0, 1.0]
        axes.plot([0.0, 1.0], exact, color="#999999", linewidth=0.6, zorder=1.5)
        axes.set_xlim(0.0, 1.0)
        axes.set_xlabel("restitution asked for [-]")
        axes.set_ylabel("delivered minus asked [-]" if difference else "restitution delivered [-]")
        if not difference:
            axes.set_ylim(0.0, 1.0)
        text = f"within {_FAR:g} of what is asked" if difference else f"off by more than {_FAR:g}"
        panel_title(axes, "ab"[place] if len(groups) > 1 else "", text)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize=6.5)
    if simulated:
        figure.suptitle("lines: closed form; circles: integrated impacts on a wall", fontsize=7.0)
    return figure


def _delivered(rows: Iterable[RestitutionRow], dissipation: str) -> Array:
    """Return the restitution asked for and the one delivered by the closed form, shape (points, 2)."""
    return np.array(sorted((row.asked, row.closed_form) for row in rows if row.dissipation == dissipation))
