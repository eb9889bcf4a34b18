"""The measured pin joint of Liu et al. 2013, for papers: load over displacement, depth over width."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from antenna_pin.base.arguments import takes
from antenna_pin.contact import LiuPinJoint, effective_modulus, make_normal_law
from antenna_pin.law_studies import LIU_2013, LIU_2013_PLAYS, LIU_2013_STEEL, force_within, reproduce_table
from antenna_pin.plot._style import COLOURS, Width, legend_above, new_figure, panel_title, styled
from antenna_pin.plot.contact import DASHES, looks

_Load = Callable[[float, float], float]  # [N] for a radial play [m] and a displacement [m]


@takes()
def figures_of_experiment(
    *, journal_radius: float = 5e-3, length: float = 1e-3, width: Width = "page"
) -> dict[str, Figure]:
    """Return the paper's figures 3, 5 and 6 by the stem of their file, with what this project adds.

    Args:
        journal_radius: Of the pin [m]; the paper gives none.
        length: Of the contact [m]; the paper takes 1 mm.
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


@takes()
@styled
def figure_experiment(
    laws: Mapping[str, Callable[[float, float], float]], *, width: Width = "page"
) -> Figure:
    """Return load over displacement of Liu et al. 2013's joint, measured and by laws: a panel for each play.

    Args:
        laws: By label, what gives the load [N] for a radial play [m] and a displacement [m]; NaN beyond its
            range.
        width: "column" (88 mm) or "page" (180 mm).
    """
    plays = LIU_2013_PLAYS
    columns = len(plays) if width == "page" else 1
    figure = new_figure(width, 66.0 if width == "page" else 150.0)
    deepest = 1.05 * max(point.depth for point in LIU_2013)
    grid = np.linspace(0.0, deepest, 150)[1:]
    top = 1.7 * max(point.load for point in LIU_2013)
    first: Axes | None = None
    for place, play in enumerate(plays):
        axes = figure.add_subplot(len(plays) // columns, columns, place + 1, sharex=first, sharey=first)
        first = first or axes
        for (label, law), (dash, colour) in zip(laws.items(), looks(), strict=False):
            load = np.array([law(play, float(depth)) for depth in grid])
            axes.plot(1e6 * grid, 1e-3 * load, color=colour, linestyle=dash, label=label)
        measured = [point for point in LIU_2013 if point.clearance == play]
        axes.plot(
            [1e6 * point.depth for point in measured],
            [1e-3 * point.load for point in measured],
            "s",
            color="black",
            markersize=3.2,
            label="measured",
            zorder=4,
        )
        axes.set_ylim(0.0, 1e-3 * top)
        axes.set_xlim(0.0, 1e6 * deepest)
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        panel_title(axes, "abc"[place], f"radial play {1e3 * play:.3f} mm")
        outer = place % columns == 0
        axes.tick_params(labelleft=outer)
        if outer:
            axes.set_ylabel("load [kN]")
        last_row = place + columns >= len(plays)
        axes.tick_params(labelbottom=last_row)
        if last_row:
            axes.set_xlabel("displacement [µm]")
    legend_above(figure, figure.axes[:1])
    return figure


@takes()
@styled
def figure_contact_width(law: LiuPinJoint, *, width: Width = "column") -> Figure:
    """Return depth over half-width of the contact, by Liu et al.'s (24) and by (5) and (11) of Hertz's kind.

    Both of the latter are a^2 = R depth with R = R_i R_j / (R_i - R_j): they let the contact grow wider than
    the pin, which (24) does not.

    Args:
        law: The pin joint.
        width: "column" (88 mm) or "page" (180 mm).
    """
    radius = law.bearing_radius * law.journal_radius / law.clearance
    figure = new_figure(width, 62.0)
    axes = figure.add_subplot()
    depths = np.geomspace(1e-4 * law.depth_limit, law.depth_limit, 400)
    share = np.array([law.half_width(float(depth)) for depth in depths]) / law.journal_radius
    axes.plot(share, 1e3 * depths, color=COLOURS[0], label="(24), new model")
    hertz = np.linspace(0.0, 1.0, 200)
    axes.plot(
        hertz,
        1e3 * (hertz * law.journal_radius) ** 2 / radius,
        color=COLOURS[1],
        linestyle=DASHES[1],
        label="(5) and (11), $a^2 = R\\,\\delta$",
    )
    axes.axhspan(
        0.0,
        1e3 * max(point.depth for point in LIU_2013),
        color="#E6E6E6",
        zorder=1.0,
        label="displacements measured",
    )
    axes.set_xlim(0.0, 1.02)
    axes.set_ylim(0.0, 3e3 * law.journal_radius * law.clearance / law.bearing_radius)
    axes.set_xlabel("half-width over radius of the pin [-]")
    axes.set_ylabel("depth [mm]")
    legend_above(figure, [axes], formulas=True)
    return figure
