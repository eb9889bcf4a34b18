"""Grammar of figures: marks in panels, panels on sheets, and their renderer.

A figure is a function that returns a :class:`Sheet`, under :func:`figure`, which draws it. Numbers of marks
are in SI units: the renderer scales them by the axes' prefixes, labels, letters the panels, and puts one
legend above and the notes below. Other drawings are functions (:class:`ByHand`).
"""

from __future__ import annotations

import functools
import inspect
import textwrap
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple, ParamSpec, Protocol

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis as DrawnAxis
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, NullLocator

from antenna_pin.base.arguments import takes
from antenna_pin.show.plot import _style as style
from antenna_pin.show.plot._style import IDEAL, MANY, SHADE, Array, Width, prefixed
from antenna_pin.show.plot._thinned import between_spikes

P = ParamSpec("P")
Look = Mapping[str, Any]
#: Linear, or logarithmic with powers of ten, or logarithmic with plain numbers.
Scale = Literal["linear", "log", "plain"]

# --- marks ---


class PlotMark(Protocol):
    """Mark in a panel."""

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw on axes, numbers multiplied by the factors of the axes' prefixes."""
        ...


@dataclass(frozen=True, slots=True, eq=False)
class PlotCurve:
    """Line, or dots, through points (n,)."""

    label: str  # name in the legend; none if empty
    x: Array
    y: Array
    look: Look = field(default_factory=dict)  # arguments of ``Axes.plot``
    smooth: bool = False  # whether it is the ideal run's: its size must stay legible beside spikes
    many: bool = False  # whether it is drawn as pixels in a vector file

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw the line."""
        many = self.many or len(self.x) > MANY
        axes.plot(across * self.x, up * self.y, label=self.label or None, rasterized=many, **self.look)


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """Marks of events at points, (n, 2)."""

    points: Array
    look: Look = field(default_factory=dict)

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw the points."""
        looks = {"s": 14.0, "linewidths": 0.8, "zorder": 6, **self.look}
        axes.scatter(across * self.points[:, 0], up * self.points[:, 1], **looks)


@dataclass(frozen=True, slots=True, eq=False)
class Rule:
    """Line across a panel at a value of an axis, such as a limit."""

    at: float
    look: Look = field(default_factory=lambda: {"color": "#999999", "linewidth": 0.6, "zorder": 0.8})
    along: Literal["x", "y"] = "y"

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw the line."""
        if self.along == "y":
            axes.axhline(up * self.at, **self.look)
        else:
            axes.axvline(across * self.at, **self.look)


@dataclass(frozen=True, slots=True, eq=False)
class Ground:
    """Coloured ground between two values of an axis."""

    low: float
    high: float
    look: Look = field(default_factory=lambda: {"facecolor": SHADE, "linewidth": 0.0, "zorder": 0.5})
    along: Literal["x", "y"] = "x"

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw the ground."""
        if self.along == "y":
            axes.axhspan(up * self.low, up * self.high, **self.look)
        else:
            axes.axvspan(across * self.low, across * self.high, **self.look)


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """Area between two lines."""

    x: Array
    low: Array
    high: Array
    look: Look = field(default_factory=dict)

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw the area."""
        axes.fill_between(across * self.x, up * self.low, up * self.high, **{"linewidth": 0.0, **self.look})


@dataclass(frozen=True, slots=True, eq=False)
class ByHand:
    """Mark that a function draws on axes, given both prefixes' factors."""

    function: Callable[[Axes, float, float], object]

    def draw(self, axes: Axes, across: float, up: float) -> None:
        """Draw the mark by the function."""
        self.function(axes, across, up)


def close_view(window: tuple[float, float]) -> Ground:
    """Return the shade of the span of a close view, with visible edges."""
    return Ground(*window, {"facecolor": SHADE, "edgecolor": "#888888", "linewidth": 0.5, "zorder": 0.5})


# --- axes, panels, sheets ---


@dataclass(frozen=True, slots=True, eq=False)
class Axis:
    """Axis of a panel."""

    label: str = ""  # label without the unit, if there is one
    unit: str | None = None  # SI unit of the values; without it values are drawn as they are
    largest: float | None = None  # size that determines the prefix; of the panel's curves if left out
    # Ends [unit]; None where they follow from the marks.
    limits: tuple[float | None, float | None] | None = None
    scale: Scale = "linear"  # linear or logarithmic
    ticks: int = 5  # number of ticks, at most; Matplotlib's own if 0
    named: Mapping[float, str] | Mapping[int, str] | None = None  # places of ticks with their names
    shared: str | None = None  # key of the panels that have this axis in common
    # Whether the label is drawn; if left out, where no panel below or to the left has it.
    labelled: bool | None = None
    wrap: int = 0  # letters of a line of the label; one line if 0

    def scaled(self, largest: float) -> tuple[float, str]:
        """Return factor and full label for values up to a size."""
        size = largest if self.largest is None else self.largest
        factor, printed = (1.0, "") if self.unit is None else prefixed(self.unit, size)
        text = f"{self.label} [{printed}]".lstrip() if printed else self.label
        return factor, style.literal(textwrap.fill(text, self.wrap) if self.wrap else text)


TIME = Axis("time [s]")


@dataclass(frozen=True, slots=True, eq=False)
class Panel:
    """Panel of a sheet."""

    title: str
    marks: Sequence[PlotMark]
    y: Axis = field(default_factory=Axis)
    x: Axis = TIME
    apart: bool = False  # whether it has a deviation, with a scale of its own
    spiky: bool = False  # whether the scale is linear as far as smooth curves reach, and logarithmic beyond
    # Size of smooth curves and of spikes, where several panels have one scale.
    span: tuple[float, float] | None = None
    # Free shares of the axes beyond the marks, across and up; the style's if left out.
    margins: tuple[float, float] | None = None
    named: bool = True  # whether its curves are in the legend
    lettered: bool = True  # whether it has a letter, where panels have
    finish: Callable[[Axes], object] | None = None  # called with the drawn axes

    @property
    def curves(self) -> list[PlotCurve]:
        """Its lines."""
        return [mark for mark in self.marks if isinstance(mark, PlotCurve)]

    @property
    def largest(self) -> float:
        """Largest size of all values."""
        return max(map(size_of, (curve.y for curve in self.curves)), default=0.0)

    @property
    def core(self) -> float:
        """Largest size of smooth curves, and of others between their spikes."""
        return max(
            (size_of(one.y) if one.smooth else between_spikes(one.x, one.y) for one in self.curves),
            default=0.0,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Sheet:
    """Figure as data."""

    # Panels; one alone in a row takes all of it, None is an empty place.
    rows: Sequence[Sequence[Panel | None]]
    width: Width  # named width
    height: float  # height [mm]
    notes: Sequence[str] = ()  # notes below the panels; empty ones are left out
    widths: Sequence[float] | None = None  # relative widths of columns
    heights: Sequence[float] | None = None  # relative heights of rows
    every: bool = False  # whether every panel has the label of its x axis, though one below has the same
    letters: bool | None = None  # whether panels have letters; where there are several if left out
    label: str = ""  # label of the y axes of all panels together
    # Colour bar: its mappable, its label, and arguments of ``Figure.colorbar``.
    bar: tuple[ScalarMappable, str, Mapping[str, Any]] | None = None
    formulas: bool = False  # whether dollars in names of the legend enclose formulas
    finish: Callable[[list[Axes]], object] | None = None  # called with the drawn panels in their order


COLUMN_OR_PAGE = {"column": 1, "page": 2}


def size_of(values: Array) -> float:
    """Return the largest size of values, zero of none; NaN does not count."""
    return float(np.nanmax(np.abs(values), initial=0.0))


def largest_of(values: Sequence[Array]) -> float:
    """Return the largest size among several arrays."""
    return max(map(size_of, values), default=0.0)


def in_rows(panels: Sequence[Panel], columns: int, *, alone: bool = True) -> list[list[Panel | None]]:
    """Return panels in rows; a single last one alone, if ``alone``."""
    rows: list[list[Panel | None]] = [
        list(panels[k : k + columns]) for k in range(0, len(panels), max(columns, 1))
    ]
    if rows and not (alone and len(rows[-1]) == 1):
        rows[-1] += [None] * (columns - len(rows[-1]))
    return rows


def in_pairs(pairs: Sequence[tuple[Panel, Panel]], width: Width) -> list[list[Panel | None]]:
    """Return pairs of panels: a page has two columns, a column one."""
    return in_rows([panel for pair in pairs for panel in pair], COLUMN_OR_PAGE[width])


def in_blocks(kinds: Sequence[Sequence[Panel | None]], width: Width) -> list[list[Panel | None]]:
    """Return panels by kind and run in rows, a column for each run."""
    count = max(map(len, kinds))
    columns = min(count, 3 if width == "page" else 1)
    rows: list[list[Panel | None]] = []
    for first in range(0, count, columns):
        block = [list(kind[first : first + columns]) for kind in kinds]
        for n, row in enumerate(block):
            there = [k for k, panel in enumerate(row) if panel is not None]
            for k in there:
                panel = row[k]
                assert panel is not None
                below = block[n + 1][k] if n + 1 < len(block) else None
                lowest = below is None or below.x.label != panel.x.label
                y = replace(panel.y, labelled=k == there[0])
                row[k] = replace(panel, x=replace(panel.x, labelled=lowest), y=y)
            rows.append(row + [None] * (columns - len(row)))
    return rows


# --- the renderer ---


@style.styled
def render(sheet: Sheet) -> Figure:
    """Return a sheet as a figure: place, scale and label its panels."""
    found = style.new_figure(sheet.width, sheet.height)
    columns = max(map(len, sheet.rows))
    ratios = {"width_ratios": sheet.widths, "height_ratios": sheet.heights}
    grid = found.add_gridspec(len(sheet.rows), columns, **ratios)
    several = sum(panel is not None for row in sheet.rows for panel in row) > 1
    letter = style.letters()
    shared: dict[tuple[str, str], Axes] = {}
    drawn: dict[Axes, Panel] = {}
    linear = False
    for i, row in enumerate(sheet.rows):
        first = next((k for k, panel in enumerate(row) if panel is not None), 0)
        for k, panel in enumerate(row):
            if panel is None:
                continue
            with_ = {
                f"share{n}": shared.get((n, a.shared or "")) for n, a in (("x", panel.x), ("y", panel.y))
            }
            axes = found.add_subplot(grid[i, :] if len(row) == 1 else grid[i, k], **with_)
            for n, axis in (("x", panel.x), ("y", panel.y)):
                if axis.shared:
                    shared.setdefault((n, axis.shared), axes)
            drawn[axes] = panel
            linear |= _draw(axes, panel, _is_lowest(sheet, i, k), k == first)
            lettered = panel.lettered and (several if sheet.letters is None else sheet.letters)
            style.panel_title(axes, next(letter) if lettered else "", panel.title)
    every = list(drawn)
    if sheet.label:
        found.supylabel(style.literal(sheet.label), fontsize=7.5)
    found.align_ylabels()
    style.legend_above(found, [axes for axes, panel in drawn.items() if panel.named], sheet.formulas)
    if sheet.bar is not None:
        colour_bar(found, every, *sheet.bar)
    if linear:
        style.explain_linear(found)
    style.footnote(found, *sheet.notes)
    if sheet.finish is not None:
        sheet.finish(every)
    return found


def colour_bar(
    drawing: Figure,
    panels: Sequence[Axes] | Axes,
    shown: ScalarMappable,
    label: str,
    where: Mapping[str, Any],
) -> Any:
    """Draw a bar of colours beside panels, and return it."""
    bar = drawing.colorbar(shown, ax=panels, label=label, **where)
    bar.outline.set_linewidth(0.4)
    return bar


def _is_lowest(sheet: Sheet, i: int, k: int) -> bool:
    """Return whether no panel below has the same x axis."""
    panel, below = sheet.rows[i][k], sheet.rows[i + 1] if i + 1 < len(sheet.rows) else ()
    assert panel is not None
    if sheet.every or len(below) != len(sheet.rows[i]):
        return True
    other = below[k]
    return other is None or other.x.label != panel.x.label


def _draw(axes: Axes, panel: Panel, lowest: bool, leftmost: bool) -> bool:
    """Draw a panel; return whether dotted lines mark its linear scale."""
    across, along = panel.x.scaled(largest_of([one.x for one in panel.curves]))
    up, upward = panel.y.scaled(panel.largest)
    for mark in panel.marks:
        mark.draw(axes, across, up)
    core, largest = panel.span or ((panel.core, panel.largest) if panel.spiky else (0.0, 0.0))
    limit = style.linear_then_log([axes], up * core, up * largest)
    if limit is not None and panel.span is None and all(_is_positive(one.y) for one in panel.curves):
        axes.set_ylim(bottom=0.0)
    if panel.margins is not None:
        axes.margins(*panel.margins)
    _scale(axes, axes.xaxis, panel.x, across)
    _scale(axes, axes.yaxis, panel.y, up)
    x_shown = lowest if panel.x.labelled is None else panel.x.labelled
    y_shown = leftmost or not panel.y.shared if panel.y.labelled is None else panel.y.labelled
    axes.set_xlabel(along if x_shown else "")
    axes.set_ylabel(upward if y_shown else "")
    if panel.x.shared:
        axes.tick_params(labelbottom=x_shown)
    if panel.y.shared:
        axes.tick_params(labelleft=leftmost)
    if panel.finish is not None:
        panel.finish(axes)
    return limit is not None


def _is_positive(values: Array) -> bool:
    return bool(np.nanmin(values, initial=0.0) >= 0.0)


def _scale(axes: Axes, drawn: DrawnAxis, axis: Axis, factor: float) -> None:
    """Set scale, limits and ticks of an axis."""
    name = "x" if drawn is axes.xaxis else "y"
    if axis.scale != "linear":
        getattr(axes, f"set_{name}scale")("log")
    if axis.limits is not None:
        low, high = (None if end is None else factor * end for end in axis.limits)
        getattr(axes, f"set_{name}lim")(low, high)
    if axis.named is not None:
        drawn.set_ticks(list(axis.named), list(axis.named.values()))
    elif axis.scale == "plain":
        plain_numbers(drawn)
    elif axis.ticks == 0:
        return
    elif axis.scale == "log" and name == "y":
        drawn.set_major_locator(LogLocator(numticks=axis.ticks))
        drawn.set_minor_locator(NullLocator())
    elif axis.scale == "log":
        drawn.set_minor_formatter(NullFormatter())
    elif drawn.get_scale() == "linear":
        drawn.set_major_locator(MaxNLocator(axis.ticks, steps=[1, 2, 5, 10]))


def plain_numbers(drawn: DrawnAxis) -> None:
    """Set plain numbers as ticks of a logarithmic axis."""
    low, high = drawn.get_view_interval()
    decade = high > 10.0 * low > 0.0
    drawn.set_major_locator(
        LogLocator(subs=(1.0, 2.0, 5.0)) if decade else MaxNLocator(7, steps=[1, 2, 5, 10])
    )
    drawn.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    drawn.set_minor_locator(NullLocator())


# --- functions of figures ---

_ARGUMENTS = {
    "runs": "Trajectories, or pairs of a label and a dataset or trajectory; of any lengths.",
    "joint": "Name of the joint; the first one with clearance if left out.",
    "ideal": "The run to compare with; the first run without any contact if left out.",
    "zoom": "Start and end of the close view [s].",
    "width": '"column" (88 mm) or "page" (180 mm).',
}


def figure(**own: str) -> Callable[[Callable[P, Sheet | Figure]], Callable[P, Figure]]:
    """Return a decorator that draws the sheet of a function and documents its arguments.

    Args:
        **own: Descriptions of the function's own arguments; common ones have theirs here.
    """

    def decorated(function: Callable[P, Sheet | Figure]) -> Callable[P, Figure]:
        names = inspect.signature(function).parameters
        words = [f"    {name}: {own.get(name) or _ARGUMENTS[name]}" for name in names]
        said, _, rest = inspect.cleandoc(function.__doc__ or "").partition("\n\nRaises:")
        more = f"\n\nRaises:{rest}" if rest else ""
        function.__doc__ = "\n".join([said, "", "Args:", *words]) + more

        @functools.wraps(function)
        def draw(*arguments: P.args, **keywords: P.kwargs) -> Figure:
            found = function(*arguments, **keywords)
            return render(found) if isinstance(found, Sheet) else found

        return takes()(style.styled(draw))

    return decorated


#: Line at zero of deviations.
ZERO = Rule(0.0, {**IDEAL, "linewidth": 0.6})


class DatasetFigure(NamedTuple):
    """Figure that a dataset, such as a study, allows."""

    name: str  # name of its file
    title: str  # title
    draw: Callable[..., Figure]  # draws it; takes ``width``
