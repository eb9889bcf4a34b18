"""Several components of a vector, or several joints, each in its own panel, runs against the ideal one."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from antenna_pin.analysis import is_round_off, round_off_scales
from antenna_pin.plot._runs import LabelledRun
from antenna_pin.plot._style import (
    MANY,
    Array,
    explain_linear,
    few_ticks,
    legend_above,
    letters,
    linear_then_log,
    literal,
    new_figure,
    panel_title,
    prefixed,
)

#: Share of a panel's height within which lines cannot be told apart [-].
COINCIDE = 0.01
# More rows than these are folded into half as many: panels that are lower, and twice as many in a row.
_TALL = 4
# Windows between whose spikes a size is looked for, and samples in each.
_WINDOWS, _IN_WINDOW = 50, 41


@dataclass(frozen=True, slots=True, eq=False)
class Curve:
    """One line of a panel.

    Attributes:
        label: Name in the legend.
        time: [s], (n,).
        value: (n,).
        style: How it is drawn.
        smooth: Whether it is the ideal run's: its size is what must stay legible beside spikes.
        many: Whether it is of so many samples that it is drawn as pixels in a vector file.
    """

    label: str
    time: Array
    value: Array
    style: dict[str, Any]
    smooth: bool = False
    many: bool = False


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """One panel: its title, its value axis, its lines, the ideal run's last.

    Attributes:
        title: What it shows.
        label: Of the value axis, without a unit.
        unit: Of the values, SI.
        curves: Its lines.
        apart: Whether it shows a deviation, with a scale of its own.
    """

    title: str
    label: str
    unit: str
    curves: Sequence[Curve]
    apart: bool = False

    @property
    def largest(self) -> float:
        """Largest size of all values."""
        return max((_largest(curve) for curve in self.curves), default=0.0)

    @property
    def core(self) -> float:
        """Size of what is smooth: of the ideal run, and of every other between its spikes."""
        return max(
            (
                _largest(curve) if curve.smooth else between_spikes(curve.time, curve.value)
                for curve in self.curves
            ),
            default=0.0,
        )


def between_spikes(time: Array, value: Array) -> float:
    """Return the size that a quantity comes to where it has no spikes.

    The largest, over fifty windows of equal length, of the size that it is below for half of the window: what
    lasts shorter is a spike. So a slow oscillation counts whole, whatever impacts stand on it.

    Args:
        time: Of samples, (n,) [s]; they may stand closer around impacts.
        value: (n,).
    """
    known = np.isfinite(value)
    time, size = time[known], np.abs(value[known])
    if time.size < 2 or not time[-1] > time[0]:
        return float(size.max(initial=0.0))
    even = even_instants(time)
    return float(np.median(np.interp(even, time, size).reshape(_WINDOWS, _IN_WINDOW), axis=1).max())


def even_instants(time: Array) -> Array:
    """Return the instants at which :func:`between_spikes` looks at samples at some times, (n,) [s]."""
    return np.linspace(time[0], time[-1], _WINDOWS * _IN_WINDOW)


def above_round_off(panels: Sequence[Panel], runs: Iterable[LabelledRun]) -> tuple[list[Panel], str]:
    """Return the panels that show more than round-off by the runs' own scales, and the others in words.

    Where there would be none left, all are.
    """
    scales = round_off_scales(*(run.whole.data for run in runs))
    shown = [
        panel
        for panel in panels
        if panel.largest != 0.0 and not is_round_off(panel.largest, panel.unit, scales)
    ]
    if not shown:
        return list(panels), "all of it is zero to round-off"
    left = dict.fromkeys(panel.title for panel in panels if panel not in shown)
    return shown, f"zero to round-off: {', '.join(left)}" if left else ""


def with_differences(panels: Sequence[Panel]) -> list[Panel]:
    """Return panels, each whose lines all coincide followed by one of what the others are less the first.

    Lines coincide that a line's width covers: a hundredth of the height. Between its samples the first is
    straight, for across impacts no curve is better.
    """
    found: list[Panel] = []
    for panel in panels:
        found.append(panel)
        apart = _less_the_first(panel)
        if apart is not None:
            found.append(apart)
    return found


def _less_the_first(panel: Panel) -> Panel | None:
    """Return what the lines of a panel are less its first one; None where they can be told apart."""
    if panel.apart or len(panel.curves) < 2:
        return None
    first, *others = panel.curves
    less = [replace(one, value=less_another(one, first)) for one in others]
    values = np.concatenate([one.value[np.isfinite(one.value)] for one in panel.curves])
    seen = COINCIDE * float(np.ptp(values)) if values.size else 0.0
    sizes = [_largest(one) for one in less]
    if not 0.0 < max(sizes) < seen:
        return None
    title = f"{panel.title}: less that of {first.label}"
    return Panel(title, "difference", panel.unit, less, True)


def less_another(one: Curve, first: Curve) -> Array:
    """Return a line less another, at its own instants; NaN while the other does not last."""
    own, index = np.unique(first.time, return_index=True)
    return np.asarray(one.value - np.interp(one.time, own, first.value[index], left=np.nan, right=np.nan))


def _largest(curve: Curve) -> float:
    return float(np.nanmax(np.abs(curve.value), initial=0.0))


def panels_figure(panels: Sequence[Panel], width: str, columns: int, *, spikes: bool = False) -> Figure:
    """Return a figure of the panels, row by row.

    Args:
        panels: What to draw.
        width: Named width.
        columns: Panels in a row of a page; a column of print has one. Of more than four rows twice as many.
        spikes: Whether scales are linear as far as the smooth lines reach, and logarithmic beyond.
    """
    columns = columns if width == "page" else 1
    small = -(-len(panels) // columns) > _TALL
    columns = 2 * columns if small else columns
    rows = -(-len(panels) // columns)
    figure = new_figure(width, 12.0 + (34.0 if small else 42.0) * rows)
    grid = figure.add_gridspec(rows, columns)
    overall = max((panel.largest for panel in panels if not panel.apart), default=0.0)
    # A last panel across its row has a time axis of its own scale: those above it need their label, too.
    labelled_rows = rows - 1 - (columns > 1 and len(panels) % columns == 1)
    drawn: list[Axes] = []
    marked = False
    for number, (letter, panel) in enumerate(zip(letters(), panels, strict=False)):
        # The last of an odd number has its row to itself.
        alone = number == len(panels) - 1 and number % columns == 0
        axes = figure.add_subplot(grid[number // columns, :] if alone else grid[divmod(number, columns)])
        drawn.append(axes)
        marked |= _draw(axes, panel, overall, spikes, small)
        title = textwrap.fill(panel.title, 19, initial_indent="(a) ")[4:] if small else panel.title
        panel_title(axes, letter if len(panels) > 1 else "", title)
        if number // columns >= labelled_rows or number + columns >= len(panels):
            axes.set_xlabel("time [s]")
    figure.align_ylabels()
    legend_above(figure, drawn)
    if marked:
        explain_linear(figure)
    return figure


def _draw(axes: Axes, panel: Panel, overall: float, spikes: bool, small: bool) -> bool:
    """Draw a panel; those of one vector share their unit where their sizes are comparable.

    Returns:
        Whether dotted lines mark where its scale is linear.
    """
    alone = panel.apart or panel.largest < 1e-2 * overall
    factor, printed = prefixed(panel.unit, panel.largest if alone else overall)
    for curve in panel.curves:
        many = curve.many or curve.time.size > MANY
        axes.plot(curve.time, factor * curve.value, label=curve.label, rasterized=many, **curve.style)
    # As long as a panel is high; of many small ones the titles say what they show.
    label = f"[{printed}]" if small else literal(textwrap.fill(f"{panel.label} [{printed}]", 22))
    limit = linear_then_log([axes], factor * panel.core, factor * panel.largest) if spikes else None
    if limit is not None and all(np.nanmin(curve.value, initial=0.0) >= 0.0 for curve in panel.curves):
        axes.set_ylim(bottom=0.0)
    axes.set_ylabel(label)
    few_ticks(axes, 4 if small else 6, 4 if small else 5)
    return limit is not None
