"""The contact scenario of a joint as a time line."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.ticker import MaxNLocator

from antenna_pin.analysis import scenario_spans
from antenna_pin.base.arguments import takes
from antenna_pin.plot._kinds import TOUCHING, choose_joint
from antenna_pin.plot._run_figure import RunFigure
from antenna_pin.plot._runs import (
    Run,
    labelled,
    left_out,
    long_enough,
    too_short,
)
from antenna_pin.plot._style import (
    COLOURS,
    MANY,
    SHADE,
    Array,
    Width,
    footnote,
    letters,
    new_figure,
    panel_title,
    styled,
)

_KINDS = ("radial", "axial")
_COLOURS = ("#9A9A9A", COLOURS[0], COLOURS[1], COLOURS[2])
_Span = tuple[float, float]
_FINEST = 10_000  # parts of the width, far below a pixel, that separate many bars


@takes()
@styled
def figure_scenarios(
    runs: Iterable[Run] | Run,
    *,
    joint: str | None = None,
    zoom: tuple[float, float] | None = None,
    width: Width = "page",
) -> Figure:
    """Return the contact scenario of a joint as a time line: where bore and flanges touch.

    Each scenario has its own line, filled while the joint is in it; on the right its share of the time. The
    close view is the fiftieth of the run with the most changes.

    Args:
        runs: Trajectories, or pairs of a label and a dataset.
        joint: Name of the joint with clearance; the first one if left out.
        zoom: Start and end of the close view [s].
        width: "column" (88 mm) or "page" (180 mm).
    """
    every = labelled(runs)
    joint = choose_joint(TOUCHING, every, joint)
    drawn = [run for run in long_enough(every) if joint in run.clearance_joints]
    spans = [scenario_spans(run.data, joint) for run in drawn]
    # A joint without flanges has no line of axial scenarios.
    flanged = [bool(run.contacts_of(joint, flanges=True)) for run in drawn]
    rows = [(i, kind) for i in range(len(drawn)) for kind in _KINDS[: 1 + flanged[i]]]
    page = width == "page"
    figure = new_figure(width, 14.0 + (27.0 if page else 54.0) * len(rows))
    if page:
        panels = figure.subplots(len(rows), 2, squeeze=False, width_ratios=[1.5, 1.0])
    else:
        panels = figure.subplots(2 * len(rows), 1, squeeze=False).reshape(-1, 2)
    letter = letters()
    for (i, kind), (whole, near) in zip(rows, panels, strict=True):
        run, span = drawn[i], spans[i]
        start, end = float(run.time[0]), float(run.time[-1])
        window = zoom or _busiest(span, start, end)
        shares = _bars(whole, span, kind, (start, end))
        _bars(near, span, kind, window)
        whole.axvspan(*window, facecolor=SHADE, edgecolor="#888888", linewidth=0.5, zorder=0.5)
        names = [name.replace("_", " ") for name in str(span[kind].attrs["flag_meanings"]).split()]
        if not flanged[i]:  # the others take two points that are told apart
            names = [names[0], names[1] if len(run.contacts_of(joint)) == 1 else "contact"]
        for axes in (whole, near):
            axes.set_ylim(len(names) - 0.4, -0.6)  # no contact on top
            axes.set_yticks(range(len(names)), names if axes is whole or not page else [""] * len(names))
            axes.grid(axis="y", visible=False)
            axes.tick_params(axis="y", length=0.0)
            axes.xaxis.set_major_locator(MaxNLocator(6 if axes is whole else 4, steps=[1, 2, 5, 10]))
        right = whole.secondary_yaxis("right")
        right.set_yticks(range(len(names)), [_percent(share) for share in shares[: len(names)]], fontsize=6.5)
        right.tick_params(length=0.0, pad=2.0)
        right.spines["right"].set_visible(False)
        panel_title(whole, next(letter), f"{run.label}, {kind if flanged[i] else 'contact'}")
        panel_title(near, next(letter), "close view of the shaded span")
    for axes in panels[-1] if page else panels.ravel():
        axes.set_xlabel("time [s]")
    footnote(
        figure,
        "right of the line: share of the time",
        too_short(every),
        left_out(every, drawn, "no clearance in this joint"),
    )
    return figure


def _bars(axes: Axes, spans: xr.Dataset, kind: str, window: _Span) -> Array:
    """Fill the lines of a window; return each scenario's share of its time."""
    start = np.clip(spans["start"].values, *window)
    length = np.clip(spans["end"].values, *window) - start
    seen = spans[kind].values
    shares = np.zeros(spans[kind].attrs["flag_values"].size)
    for value in range(shares.size):
        mine = (seen == value) & (length > 0.0)
        shares[value] = length[mine].sum() / (window[1] - window[0])
        many = bool(np.count_nonzero(mine) > MANY // 20)
        bars = start[mine], length[mine]
        if many:
            bars = _joined(*bars, (window[1] - window[0]) / _FINEST)
        # An edge as thin as the finest line, so that an impact of a tenth of a millisecond is still seen.
        axes.add_patch(
            PathPatch(
                _rectangles(*bars, value - 0.38, 0.76),
                facecolor=_COLOURS[value],
                edgecolor=_COLOURS[value],
                linewidth=0.25,
                rasterized=many,
            )
        )
        axes.axhline(value, color="#DDDDDD", linewidth=0.4, zorder=0.4)
    axes.set_xlim(window)
    return shares


def _joined(start: Array, length: Array, gap: float) -> tuple[Array, Array]:
    """Return starts and lengths of ascending bars of which those nearer than a gap are one."""
    end = start + length
    first = np.concatenate([[True], start[1:] - end[:-1] > gap])
    last = np.concatenate([first[1:], [True]])
    return start[first], end[last] - start[first]


def _rectangles(start: Array, length: Array, below: float, height: float) -> Path:
    """Return rectangles as one path, which in a file takes a fraction of the room of as many."""
    x, above = np.stack([start, start + length], axis=1), below + height
    corners = np.empty((start.size, 5, 2))
    corners[:, :, 0] = x[:, [0, 0, 1, 1, 0]]
    corners[:, :, 1] = [below, above, above, below, below]
    codes = [Path.MOVETO, Path.LINETO, Path.LINETO, Path.LINETO, Path.CLOSEPOLY]
    return Path(corners.reshape(-1, 2), np.tile(codes, start.size).astype(Path.code_type))


def _busiest(spans: xr.Dataset, start: float, end: float) -> _Span:
    """Return the fiftieth of the run that holds the most changes."""
    length = (end - start) / 50.0
    changes = spans["start"].values
    held = np.searchsorted(changes, changes + length) - np.arange(changes.size)
    first = float(changes[int(np.argmax(held))]) - 0.05 * length
    first = min(max(first, start), end - length)
    return first, first + length


def _percent(share: float) -> str:
    """Return a share in percent, with one digit unless it is none."""
    if share == 0.0:
        return "\N{EN DASH}"
    return "<0.1 %" if share < 0.0005 else f"{100.0 * share:.1f} %"


FIGURES = (
    RunFigure(
        name="contact_scenarios",
        title="Contact scenarios of {joint}",
        function=figure_scenarios,
        of=TOUCHING,
        compares=False,
    ),
)
