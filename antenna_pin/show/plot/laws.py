"""Contact laws: force over depth, restitution, and Liu et al.'s pin joint (2013)."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis.law_studies import (
    LIU_2013,
    LIU_2013_PLAYS,
    LIU_2013_STEEL,
    RestitutionRow,
    force_within,
    reproduce_table,
)
from antenna_pin.base.arguments import takes
from antenna_pin.contact import LiuPinJoint, NormalLaw, effective_modulus, make_normal_law
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot._style import COLOURS, SHADE, Array, Width, literal, new_figure, panel_title
from antenna_pin.show.plot.files import check_formats, folder_for_figures, save_figure
from antenna_pin.show.plot.grammar import Axis, Ground, Panel, PlotCurve, PlotMark, Rule, Sheet, figure

_DASHES: tuple[Any, ...] = ("-", (0, (4, 1.2)), (0, (1, 1)), (0, (4, 1, 1, 1)))
_LABEL_HEIGHT = 3.0  # of one line of text beside a panel [mm]
_FAR = 0.1  # least deviation of a dissipation in the first panel [-]


@takes()
def save_contact_figures(
    figures: Mapping[str, Figure], folder: str | Path, formats: Sequence[str] = ("png",)
) -> list[Path]:
    """Write figures by name to a folder and return their paths.

    Each file appears whole or not at all.

    Args:
        figures: Figures by the stem of their file's name.
        folder: Folder of the files; made if it is missing.
        formats: Any of "png", "pdf" and "svg".
    """
    check_formats(formats)
    target = folder_for_figures(folder)
    return [path for name, figure in figures.items() for path in save_figure(figure, target / name, formats)]


def _looks() -> Iterator[dict[str, Any]]:
    """Yield the look of one curve after the other; neighbours differ in colour and dash."""
    colours = (*COLOURS, "black")
    for k in itertools.count():
        row, place = divmod(k, len(colours))
        yield {"color": colours[place], "linestyle": _DASHES[(place + row) % len(_DASHES)]}


# --- force over depth ---


@figure(
    laws="The laws by name.",
    depths="Depths that the figure must hold [m], positive; its scale runs from the least to the greatest.",
)
def figure_force_curves(
    laws: Mapping[str, NormalLaw], *, depths: Iterable[float] = (1e-7, 2e-5), width: Width = "page"
) -> Sheet:
    """Return the elastic force of laws over the depth, both on logarithmic scales.

    Laws whose curves coincide share one line and its label. A curve that ends before the right edge has a dot
    where the law's range ends, and its name in a legend.
    """
    held = sorted(depths)
    if not laws:
        raise InvalidParameterError("figure_force_curves", "laws", "at least one law", "none")
    if not held or not held[0] > 0.0:
        raise InvalidParameterError("figure_force_curves", "depths", "positive and at least one [m]", held)
    low, high = (held[0], held[-1]) if held[-1] > held[0] else (0.5 * held[0], 2.0 * held[0])
    grid = np.geomspace(low, high, 300)
    forces = {name: np.array([force_within(law, float(x)) for x in grid]) for name, law in laws.items()}
    curves: list[PlotCurve] = []
    ended: list[bool] = []
    for (label, force), look in zip(_coinciding(forces).items(), _looks(), strict=False):
        known = np.isfinite(force)
        if not known.any():
            continue
        ended.append(bool(np.flatnonzero(known)[-1] < grid.size - 1))
        dot = {"marker": "o" if ended[-1] else None, "markersize": 3.0, "markevery": [-1]}
        curves.append(PlotCurve(label, grid[known], force[known], {**look, **dot}))
    thin = {"color": "#999999", "linewidth": 0.5, "linestyle": ":", "zorder": 1.5}
    rules = [Rule(depth, thin, "x") for depth in held[1:-1]]  # where the table stands

    def finish(axes: Axes) -> None:
        axes.xaxis.set_major_formatter(lambda value, _position: f"{value:g}")
        lines = list(zip(axes.lines, ended, strict=False))
        within = [line for line, ends in lines if ends]
        if within:  # lines to their names would cross the others
            names = [literal(str(line.get_label()).replace("\n", " ")) for line in within]
            looks: dict[str, Any] = {"fontsize": 6.5, "title": "ends at the dot", "title_fontsize": 6.5}
            axes.legend(within, names, loc="lower right", **looks)
        if not all(ended):
            _label_ends(axes, [line for line, ends in lines if not ends])

    x = Axis("depth", "m", high, (low, high), "log")
    panel = Panel(
        "", [*curves, *rules], Axis("force [N]", scale="log", ticks=0), x, named=False, finish=finish
    )
    return Sheet([[panel]], width, max(66.0, 30.0 + 4.0 * len(laws)))


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


def _label_ends(axes: Axes, lines: Sequence[Any]) -> None:
    """Write names of curves beside a panel, each with a line to its curve."""
    assert isinstance(axes.figure, Figure)
    bottom, top = np.log10(axes.get_ylim())
    height = axes.figure.get_figheight() * 25.4 - 14.0  # of the panel, about [mm]
    ordered = sorted(lines, key=lambda line: float(line.get_ydata()[-1]))
    half = [0.5 * _LABEL_HEIGHT * (1 + line.get_label().count("\n")) / height for line in ordered]
    places = [(np.log10(line.get_ydata()[-1]) - bottom) / (top - bottom) for line in ordered]
    for _ in range(400):  # neighbours that are too close push each other apart, and the panel holds them
        places[0] = max(places[0], half[0])
        places[-1] = min(places[-1], 1.0 - half[-1])
        for k in range(len(places) - 1):
            short = half[k] + half[k + 1] - (places[k + 1] - places[k])
            if short > 0.0:
                places[k] -= 0.5 * short
                places[k + 1] += 0.5 * short
    for line, place in zip(ordered, places, strict=True):
        colour = line.get_color()
        arrow = {"arrowstyle": "-", "color": colour, "linewidth": 0.4, "shrinkA": 0.0, "shrinkB": 1.0}
        axes.annotate(
            literal(str(line.get_label())),
            xy=(float(line.get_xdata()[-1]), float(line.get_ydata()[-1])),
            xytext=(1.12, place),
            textcoords="axes fraction",
            va="center",
            fontsize=6.5,
            linespacing=1.0,
            color=colour,
            annotation_clip=False,
            arrowprops={**arrow, "relpos": (0.0, 0.5)},
        )


# --- restitution ---


@figure(
    rows="Of :func:`antenna_pin.contact.restitution_table`.",
    closed_form="More rows of the same dissipations, for smooth lines.",
)
def figure_restitution(
    rows: Iterable[RestitutionRow], *, closed_form: Iterable[RestitutionRow] = (), width: Width = "page"
) -> Figure:
    """Return the delivered restitution of dissipations over the given one.

    Dissipations that deviate by more than 0.1 stand in the first panel; of the others the
    second panel shows the difference. Lines are closed forms, circles integrated impacts.
    """
    points = list(rows)
    lines = [*points, *closed_form]
    names = list(dict.fromkeys(row.dissipation for row in points))
    if not names:
        raise InvalidParameterError("figure_restitution", "rows", "at least one row", "none")
    errors = dict.fromkeys(names, 0.0)
    for row in lines:
        if row.dissipation in errors and np.isfinite(row.closed_form):
            errors[row.dissipation] = max(errors[row.dissipation], abs(row.closed_form - row.asked))
    far = [name for name in names if errors[name] > _FAR]
    near = [name for name in names if errors[name] <= _FAR]
    groups = [group for group in ((far, False), (near, True)) if group[0]]
    side_by_side = width == "page" or len(groups) == 1
    legend = 4.0 * max((len(group) + 1) // 2 for group, _ in groups)
    found = new_figure(width, (62.0 + legend) * (1 if side_by_side else len(groups)))
    shape = (1, len(groups)) if side_by_side else (len(groups), 1)
    for place, (group, difference) in enumerate(groups):
        axes = found.add_subplot(*shape, place + 1)
        less = 1.0 if difference else 0.0
        curves = {name: _delivered(lines, name) for name in group}
        circles: dict[str, Any] = {
            "fillstyle": "none",
            "markersize": 2.6,
            "markeredgewidth": 0.6,
            "clip_on": False,
        }
        for (label, curve), look in zip(_coinciding(curves).items(), _looks(), strict=False):
            asked, delivered = curve.T
            axes.plot(asked, delivered - less * asked, label=label.replace("\n", " "), **look)
            name = label.split(",")[0]
            dots = np.array([(row.asked, row.on_wall) for row in points if row.dissipation == name])
            axes.plot(dots[:, 0], dots[:, 1] - less * dots[:, 0], "o", color=look["color"], **circles)
        axes.plot([0.0, 1.0], [0.0, 1.0 - less], color="#999999", linewidth=0.6, zorder=1.5)
        axes.set_xlim(0.0, 1.0)
        axes.set_xlabel("specified restitution [-]")
        axes.set_ylabel("delivered minus specified [-]" if difference else "restitution delivered [-]")
        if not difference:
            axes.set_ylim(0.0, 1.0)
        text = f"within {_FAR:g} of the specified value" if difference else f"off by more than {_FAR:g}"
        panel_title(axes, "ab"[place] if len(groups) > 1 else "", text)
        axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.22), ncols=2, fontsize=6.5)
    if any(np.isfinite(row.on_wall) for row in points):
        found.suptitle("lines: closed form; circles: integrated impacts on a wall", fontsize=7.0)
    return found


def _delivered(rows: Iterable[RestitutionRow], dissipation: str) -> Array:
    """Return given and delivered restitution by the closed form, (points, 2)."""
    return np.array(sorted((row.asked, row.closed_form) for row in rows if row.dissipation == dissipation))


# --- the experiment of Liu et al. 2013 ---

_Load = Callable[[float, float], float]  # [N] for a radial play [m] and a displacement [m]


@takes()
def figures_of_experiment(
    *, journal_radius: float = 5e-3, length: float = 1e-3, width: Width = "page"
) -> dict[str, Figure]:
    """Return the paper's figures 3, 5 and 6 with further laws, by file stem.

    Args:
        journal_radius: Radius of the pin [m]; the paper gives none.
        length: Length of the contact [m]; the paper takes 1 mm.
        width: "column" (88 mm) or "page" (180 mm); the last figure is a column wide.
    """
    modulus = effective_modulus(LIU_2013_STEEL, LIU_2013_STEEL)

    def load(law: str, contacts: int = 1) -> _Load:
        def at(play: float, depth: float) -> float:
            joint = {"length": length, "journal_radius": journal_radius, "modulus": modulus}
            made = make_normal_law(law, {**joint, "bearing_radius": journal_radius + play})
            return force_within(made, depth / contacts)

        return at

    paper = {
        "(6), Hertz": load("liu-2013-hertz"),
        "(14), radii of the table": reproduce_table().conformal_load,
    }
    new = {
        "(28), Liu et al. 2013": load("liu-2013"),
        "(28), half depth in width": load("liu-2013-corrected"),
        "Johnson, 2 contacts": load("johnson", 2),
        "Liu foundation, 1 contact": load("liu-foundation"),
        "ESDU 78035, 1 contact": load("esdu-78035"),
    }
    joint = LiuPinJoint(
        length=length,
        journal_radius=journal_radius,
        bearing_radius=journal_radius + LIU_2013_PLAYS[0],
        modulus=modulus,
    )
    return {
        "liu2013_figure3": figure_experiment(paper, width=width),
        "liu2013_figure5": figure_experiment({**paper, **new}, width=width),
        "liu2013_figure6": figure_contact_width(joint, width="column"),
    }


@figure(
    laws="By label, what gives the load [N] for a radial play [m] and a displacement [m]; NaN beyond its "
    "range."
)
def figure_experiment(laws: Mapping[str, Callable[[float, float], float]], *, width: Width = "page") -> Sheet:
    """Return load over displacement of Liu et al. 2013's joint, measured and by laws."""
    deepest = 1.05 * max(point.depth for point in LIU_2013)
    grid = np.linspace(0.0, deepest, 150)[1:]
    x = Axis("displacement [µm]", limits=(0.0, 1e6 * deepest), shared="depth")
    y = Axis(
        "load [kN]", limits=(0.0, 1.7e-3 * max(point.load for point in LIU_2013)), ticks=0, shared="load"
    )
    squares = {"linestyle": "none", "marker": "s", "color": "black", "markersize": 3.2, "zorder": 4}
    panels = []
    for play in LIU_2013_PLAYS:
        marks: list[PlotMark] = [
            PlotCurve(label, 1e6 * grid, 1e-3 * np.array([law(play, float(depth)) for depth in grid]), look)
            for (label, law), look in zip(laws.items(), _looks(), strict=False)
        ]
        measured = np.array([(p.depth, p.load) for p in LIU_2013 if p.clearance == play]).T
        marks.append(PlotCurve("measured", 1e6 * measured[0], 1e-3 * measured[1], squares))
        panels.append(Panel(f"radial play {1e3 * play:.3f} mm", marks, y, x))
    if width == "page":
        return Sheet([panels], width, 66.0)
    return Sheet([[one] for one in panels], width, 150.0)


@figure(law="The pin joint.")
def figure_contact_width(law: LiuPinJoint, *, width: Width = "column") -> Sheet:
    """Return depth over half-width of the contact, by Liu et al.'s (24) and by Hertz.

    Equations (5) and (11) of Hertz's kind are a^2 = R depth with R = R_i R_j / (R_i - R_j): they let the
    contact grow wider than the pin, which (24) does not.
    """
    radius = law.bearing_radius * law.journal_radius / law.clearance
    depths = np.geomspace(1e-4 * law.depth_limit, law.depth_limit, 400)
    share = np.array([law.half_width(float(depth)) for depth in depths]) / law.journal_radius
    hertz = np.linspace(0.0, 1.0, 200)
    look = {"color": COLOURS[1], "linestyle": _DASHES[1]}
    words = "(5) and (11), $a^2 = R\\,\\delta$"
    deepest = 1e3 * max(point.depth for point in LIU_2013)
    marks: list[PlotMark] = [
        PlotCurve("(24), new model", share, 1e3 * depths, {"color": COLOURS[0]}),
        PlotCurve(words, hertz, 1e3 * (hertz * law.journal_radius) ** 2 / radius, look),
        Ground(0.0, deepest, {"color": SHADE, "zorder": 1.0, "label": "displacements measured"}, "y"),
    ]
    top = 3e3 * law.journal_radius * law.clearance / law.bearing_radius
    x = Axis("half-width over radius of the pin [-]", limits=(0.0, 1.02), ticks=0)
    panel = Panel("", marks, Axis("depth [mm]", limits=(0.0, top), ticks=0), x)
    return Sheet([[panel]], width, 62.0, formulas=True)
