"""The load around the bore: which parts of the bearing's surface took it, and when."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from antenna_pin.analysis import bore_load
from antenna_pin.base.arguments import takes
from antenna_pin.plot._blows import episodes_of, sharp
from antenna_pin.plot._kinds import TOUCHING, choose_joint
from antenna_pin.plot._layout import square_panels
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import LabelledRun, Run, labelled, left_out, long_enough, too_short
from antenna_pin.plot._style import (
    COLOURS,
    Array,
    Width,
    few_ticks,
    footnote,
    legend_above,
    letters,
    new_figure,
    panel_title,
    prefixed,
    styled,
    three_digits,
)
from antenna_pin.plot._thinned import thinned
from antenna_pin.plot._upright import shown_axes
from antenna_pin.trajectory import contact_ends, contact_kinds

_MOST_RINGS = 1000
# Of both ends, dark and light: told apart in grey as well.
_LOOKS = {
    ("radial", "+"): ("end +", COLOURS[0]),
    ("radial", "-"): ("end \N{MINUS SIGN}", COLOURS[4]),
    ("radial", ""): ("bore", COLOURS[5]),
    ("spherical", ""): ("socket", COLOURS[5]),
}


@takes()
@styled
def figure_bore_load(
    runs: Iterable[Run] | Run, *, joint: str | None = None, sectors: int = 36, width: Width = "page"
) -> Figure:
    """Return the load around the bore: the impulse of the normal force that each sector took.

    Bars of the two ends of a bore stand on one another. The angle is that of the bearing's surface, from the
    bearing's x axis towards its y axis; of a single run on a page it stands over time as well. Under gravity
    "up" is against it, as far as the bearing keeps still.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint with clearance; the first one if left out.
        sectors: Number of equal sectors.
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    joint = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if joint in run.clearance_joints]
    round_bore = all(set(_kinds_of(run, joint)) <= {"radial", "spherical"} for run in drawn)
    if len(drawn) == 1 and width == "page" and round_bore and "contact_point" in drawn[0].data:
        figure: Figure = new_figure(width, 82.0)
        grid = figure.add_gridspec(1, 2, width_ratios=[1.0, 1.35])
        panels = [figure.add_subplot(grid[0, 0], projection="polar")]
        over_time = figure.add_subplot(grid[0, 1])
        _over_time(over_time, drawn[0], joint)
        panel_title(over_time, "b", "where it was pressed")
    else:
        figure, panels = square_panels(width, len(drawn), 14.0, projection="polar")
    upright = False
    for letter, axes, run in zip(letters(), panels, drawn, strict=False):
        assert isinstance(axes, PolarAxes)
        load = bore_load(run.data, joint, sectors)
        words = _bars(axes, run, load)
        shown = shown_axes(run.data, joint, spatial=False)
        if shown.up is not None:
            axes.set_theta_offset(0.5 * np.pi - np.arctan2(shown.up[1], shown.up[0]))
            upright = True
        panel_title(axes, letter if len(figure.axes) > 1 else "", words)
    legend_above(figure, panels)
    footnote(
        figure,
        f"impulse of the normal force per sector of {360 / sectors:.3g}°",
        "rings: blows, the larger the harder" if len(figure.axes) > len(panels) else "",
        "up: against gravity" if upright else "",
        too_short(every),
        left_out(every, drawn, "no clearance in this joint"),
    )
    return figure


def _kinds_of(run: LabelledRun, joint: str) -> list[str]:
    """Return the kinds of the contacts in the bore."""
    kinds = contact_kinds(run.data)
    return [kinds[name] for name in run.contacts_of(joint, flanges=False)]


def _look(kind: str, end: str) -> tuple[str, str]:
    """Return name and colour of a contact; of a guide's corner those of its end."""
    key = ("radial", end[-2:-1]) if kind in ("wall", "key") else (kind, end)
    return _LOOKS.get(key, (kind + end, COLOURS[2]))


def _bars(axes: PolarAxes, run: LabelledRun, load: xr.Dataset) -> str:
    """Draw the load of each sector as a bar; return the panel's title."""
    impulse, angle = load["impulse"].values, load["angle"].values
    factor, printed = prefixed("N s", float(impulse.sum(axis=0).max(initial=0.0)))
    kinds, ends = contact_kinds(run.data), contact_ends(run.data)
    stacked: dict[tuple[str, str], Array] = {}
    for contact, taken in zip(load["contact"].values, factor * impulse, strict=True):
        look = _look(kinds[str(contact)], ends[str(contact)])
        stacked[look] = stacked.get(look, 0.0) + taken
    below = np.zeros(angle.size)
    for (name, colour), taken in stacked.items():
        bars: dict[str, Any] = {"color": colour, "edgecolor": "white", "linewidth": 0.25}
        axes.bar(angle, taken, label=name, bottom=below, width=2.0 * np.pi / angle.size, **bars)
        below = below + taken
    if below.any():
        axes.set_ylim(0.0, 1.05 * below.max())
        # Numbers of the rings stand where the load is least.
        around = np.convolve(np.tile(below, 3), np.ones(5), "same")[angle.size : 2 * angle.size]
        ticks = MaxNLocator(3, steps=[1, 2, 5, 10]).tick_values(0.0, below.max())
        rings = [float(tick) for tick in ticks if 0.0 < tick <= below.max()]
        axes.set_rgrids(rings, angle=np.degrees(angle[int(np.argmin(around))]), fontsize=6.5)
    else:
        axes.text(0.5, 0.6, "no contact", transform=axes.transAxes, ha="center")
        axes.set_yticks([])
    names = ["x", "45°", "y", "135°", "180°", "225°", "270°", "315°"]
    axes.set_thetagrids(np.arange(0, 360, 45), names, fontsize=6.5)
    axes.tick_params(axis="x", pad=-1.0)
    total, unit = prefixed("N s", float(impulse.sum()))
    return f"{run.label}\nin all {three_digits(total * float(impulse.sum()))} {unit}; rings in {printed}"


def _over_time(axes: Axes, run: LabelledRun, joint: str) -> None:
    """Draw the direction in which the bore was pressed over time, and rings where it took blows."""
    kinds, ends = contact_kinds(run.data), contact_ends(run.data)
    blows = sharp(run, run)
    hardest = float(run.values("peak_force")[blows].max(initial=0.0)) if blows.any() else 0.0
    shown = thinned(
        run, lambda part: [_direction(part, name) for name in run.contacts_of(joint, flanges=False)]
    )
    for name in run.contacts_of(joint, flanges=False):
        colour = _look(kinds[name], ends[name])[1]
        looks: dict[str, Any] = {"linestyle": "none", "color": colour, "markeredgewidth": 0.0}
        angle = _direction(shown, name)
        axes.plot(shown.time, angle, marker=".", markersize=1.2, rasterized=True, **looks)
        mine = np.flatnonzero(blows & episodes_of(run, [name]))
        mine = mine[np.argsort(run.values("peak_force")[mine])][-_MOST_RINGS:]
        at = run.values("peak_time")[mine]
        place = np.searchsorted(run.time, at).clip(0, run.time.size - 1)
        size = run.values("peak_force")[mine] / (hardest or 1.0)
        axes.scatter(
            at,
            _direction(run, name)[place],
            s=36.0 * size + 0.5,
            facecolors="none",
            edgecolors=colour,
            linewidths=0.5,
            rasterized=True,
        )
    axes.set_xlim(float(run.time[0]), float(run.time[-1]))
    axes.set_ylim(-180.0, 180.0)
    few_ticks(axes, 5)
    axes.set_yticks(range(-180, 181, 90), ["\N{MINUS SIGN}180°", "\N{MINUS SIGN}y", "x", "y", "180°"])
    axes.set_xlabel("time [s]")
    axes.set_ylabel("direction in the bearing")


def _direction(run: LabelledRun, contact: str) -> Array:
    """Return the direction of a contact, from the bearing's x axis [deg]; NaN while it does not press."""
    x, y, _ = run.values("contact_point", contact=contact).T
    pressed = run.values("normal_force", contact=contact) > 0.0
    return np.where(pressed, np.degrees(np.arctan2(y, x)), np.nan)


FIGURES = (
    RunFigure(
        name="bore_load",
        title="Load around the bore of {joint}",
        function=figure_bore_load,
        of=TOUCHING,
        compares=False,
    ),
)
