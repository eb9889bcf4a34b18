"""Style of every figure: widths, type sizes, colours, scales, units.

Sizes are final: a figure is drawn at the width it is printed at, so its type is 7 to 8 points on paper.
Colours are those of Okabe and Ito, suitable for all common kinds of colour blindness;
the ideal joint is always black and dashed.
"""

from __future__ import annotations

import contextlib
import functools
import io
import itertools
import logging
import math
import string
import textwrap
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Literal, ParamSpec, TypeVar

import matplotlib
import numpy as np
import numpy.typing as npt
from cycler import cycler
from matplotlib.artist import Artist, allow_rasterization
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from matplotlib.mathtext import MathTextParser
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import UnknownNameError

Width = Literal["column", "page"]
Array = npt.NDArray[np.float64]

_MILLIMETRE = 1.0 / 25.4  # [inch]
WIDTHS: dict[str, float] = {"column": 88.0 * _MILLIMETRE, "page": 180.0 * _MILLIMETRE}

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9")
IDEAL: dict[str, Any] = {"color": "black", "linestyle": (0, (4, 1.5)), "linewidth": 0.9, "zorder": 5}
SHADE = "#E6E6E6"
PEAK = "#D55E00"
#: Dark to light, monotone in grey as well; its lightest tenth is left out, which is lost on white paper.
SEQUENTIAL = LinearSegmentedColormap.from_list(
    "antenna_pin", matplotlib.colormaps["cividis"](np.linspace(0.0, 0.9, 64))
)

# More samples than this are drawn as pixels in a vector file: the file stays small, and prints alike.
MANY = 50_000

RC: Any = {  # Any: the stubs want one literal type for every setting
    "font.size": 7.5,
    "font.family": "DejaVu Sans",  # comes with Matplotlib, so figures look alike everywhere
    "axes.titlesize": 7.5,
    "axes.labelsize": 7.5,
    "xtick.labelsize": 7.0,
    "ytick.labelsize": 7.0,
    "legend.fontsize": 7.0,
    "figure.titlesize": 8.0,
    "legend.frameon": False,
    "legend.handlelength": 1.8,
    "legend.columnspacing": 1.4,
    "axes.linewidth": 0.6,
    "axes.titlelocation": "left",
    "axes.titlepad": 4.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.xmargin": 0.0,
    "axes.formatter.useoffset": False,
    "axes.prop_cycle": cycler(color=COLOURS),
    "grid.color": "#DDDDDD",
    "grid.linewidth": 0.4,
    "axes.grid": True,
    "axes.axisbelow": True,
    "lines.linewidth": 0.9,
    "lines.solid_joinstyle": "round",
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "xtick.direction": "out",
    "savefig.dpi": 300,
    "figure.dpi": 150,
    "pdf.fonttype": 42,  # text stays text
    "svg.fonttype": "none",
    "svg.hashsalt": "antenna_pin",  # the same figure gives the same file
    "path.simplify": True,
    "path.simplify_threshold": 0.3,  # in vector files points: a tenth of a millimetre
    "agg.path.chunksize": 20000,
}

P = ParamSpec("P")
R = TypeVar("R")

# Every sixth line has a colour that there is already: dashes tell it apart. Even ones are the ideal run's.
_DASHES: tuple[Any, ...] = ("-", (0, (6, 1, 1, 1)), (0, (1, 1)), (0, (5, 1, 1, 1, 1, 1)))


def distinct(number: int) -> dict[str, Any]:
    """Return colour and dashes of line ``number``; 24 lines are distinct."""
    turn, place = divmod(number, len(COLOURS))
    return {"color": COLOURS[place], "linestyle": _DASHES[turn % len(_DASHES)]}


def styled(function: Callable[P, R]) -> Callable[P, R]:
    """Draw with this style, and leave the caller's Matplotlib settings as they were."""

    @functools.wraps(function)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        with matplotlib.rc_context(RC), _any_script():
            return function(*args, **kwargs)

    return wrapper


@contextlib.contextmanager
def _any_script() -> Iterator[None]:
    """Silence warnings of letters that the font lacks; they become boxes."""
    formulas = logging.getLogger("matplotlib.mathtext")  # titles with a bold letter go through it
    before = formulas.level
    formulas.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message=r"Glyph .* missing from font", category=UserWarning)
            yield
    finally:
        formulas.setLevel(before)


def literal(text: str) -> str:
    """Return a user's text with its dollars escaped."""
    return text.replace("$", r"\$")


class NotebookFigure(Figure):
    """Figure that displays itself in a notebook, with or without a backend."""

    # Whether it is being saved: Matplotlib then draws it twice, once without ink, to have its panels placed.
    _saving = False

    def savefig(self, *args: Any, **kwargs: Any) -> None:
        """Save the figure; panels are placed without drawing their content."""
        self._saving = True
        try:
            with _fixed_titles(self.axes):
                super().savefig(*args, **kwargs)
        finally:
            self._saving = False

    def draw(self, renderer: Any) -> None:
        """Draw the figure, or place its panels only."""
        _share_formulas(renderer)
        engine = self.get_layout_engine()
        if self._saving and isinstance(engine, ConstrainedLayoutEngine):
            engine.execute(self)  # the drawing that counts has a stand-in for it
        else:
            super().draw(renderer)

    def _repr_png_(self) -> bytes:
        buffer = io.BytesIO()
        with matplotlib.rc_context(RC), _any_script():
            self.savefig(buffer, format="png", dpi=RC["figure.dpi"])
        return buffer.getvalue()


_FORMULAS = MathTextParser("path")


def _share_formulas(renderer: Any) -> None:
    """Have a renderer of vectors use formulas that others have parsed."""
    outlines: Any = getattr(renderer, "_text2path", None)
    if hasattr(outlines, "mathtext_parser"):
        outlines.mathtext_parser = _FORMULAS


@contextlib.contextmanager
def _fixed_titles(panels: Iterable[Axes]) -> Iterator[None]:
    """Keep titles on their panels' upper edges, except above ticks or a factor.

    Matplotlib would measure all ticks again for each title.
    """
    fixed = [axes for axes in panels if axes.name == "rectilinear" and not _has_text_above(axes)]
    before = [getattr(axes, "_autotitlepos", None) for axes in fixed]
    try:
        for axes in fixed:
            setattr(axes, "_autotitlepos", False)  # noqa: B010 - what ``set_title(y=...)`` sets
        yield
    finally:
        for axes, position in zip(fixed, before, strict=True):
            setattr(axes, "_autotitlepos", position)  # noqa: B010


def _has_text_above(axes: Axes) -> bool:
    """Return whether labels of ticks, or a common factor of them, stand above a panel."""
    twins = [one for one in axes.figure.axes if one.get_subplotspec() == axes.get_subplotspec()]
    for one in {axes, *twins, *axes.child_axes}:
        labels = one.yaxis.get_major_formatter()
        labels.format_ticks(list(one.yaxis.get_majorticklocs()))
        above = one.xaxis.get_tick_params().get("labeltop") or one.xaxis.get_label_position() == "top"
        if above or labels.get_offset():
            return True
    return False


def new_figure(width: str, height: float) -> NotebookFigure:
    """Return an empty figure of a named width and a height [mm]."""
    if width not in WIDTHS:
        raise UnknownNameError("figure", "width", width, WIDTHS)
    figure = NotebookFigure(figsize=(WIDTHS[width], height * _MILLIMETRE), layout="constrained")
    # Neighbours' outermost tick labels must not run into each other.
    figure.set_layout_engine("constrained", w_pad=1.4 * _MILLIMETRE, h_pad=1.0 * _MILLIMETRE, wspace=0.02)
    return figure


def letters() -> Iterator[str]:
    """Yield the letters of panels: a to z, then aa, ab, and so on."""
    for size in itertools.count(1):
        yield from ("".join(parts) for parts in itertools.product(string.ascii_lowercase, repeat=size))


def legend_above(figure: Figure, panels: Iterable[Axes], formulas: bool = False) -> None:
    """Draw one legend of some panels above the figure, the ideal joint first.

    Dollars in names enclose formulas where ``formulas`` is true.
    """
    entries: dict[str, Any] = {}
    for axes in panels:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    if not entries:
        return
    entries = dict(sorted(entries.items(), key=lambda entry: "ideal" not in entry[0]))
    # A column takes its line (some 9 mm with the gaps) and at most 1.4 mm a letter.
    room = figure.get_figwidth() / _MILLIMETRE
    columns = max(1, int(room / (9.0 + 1.4 * max(map(len, entries)))))
    rows = -(-len(entries) // columns)
    figure.legend(
        list(entries.values()),
        list(entries) if formulas else [literal(label) for label in entries],
        loc="outside upper center",
        ncols=-(-len(entries) // rows),  # rows of equal length
        markerscale=2.0,  # dots in panels are small
    )


def footnote(figure: Figure, *parts: str) -> None:
    """Append notes, those that are not empty, below the panels."""
    said = " ".join(figure.get_supxlabel().split())
    text = "; ".join(part for part in (said, *parts) if part)
    if text != said:
        # A line takes 1.25 mm a letter.
        letters_a_line = int(figure.get_figwidth() / _MILLIMETRE / 1.25)
        lines = textwrap.fill(text, letters_a_line)
        figure.supxlabel(literal(lines), fontsize=6.5, x=0.99, ha="right", multialignment="right")


def panel_title(axes: Axes, letter: str, text: str) -> None:
    """Set a panel's title of letter and text, if there are any."""
    plain = literal(text)
    if letter or plain:
        axes.set_title(rf"$\bf{{({letter})}}$ {plain}" if letter else plain)


# --- units and names ---


def parameter_words(key: str) -> str:
    """Return the readable name of a scenario key, as "radial clearance of pin"."""
    table, *rest = key.split(".")
    if not rest:
        return table.replace("_", " ")
    last = rest[-1].replace("_", " ")
    return f"{last} of {rest[0].replace('_', ' ')}" if len(rest) > 1 else last


_PREFIXES = (
    (1e6, "M"),
    (1e3, "k"),
    (1.0, ""),
    (1e-3, "m"),
    (1e-6, "µ"),
    (1e-9, "n"),
    (1e-12, "p"),
    (1e-15, "f"),
    (1e-18, "a"),
)


def prefixed(unit: str, largest: float) -> tuple[float, str]:
    """Return factor and unit that make values up to ``largest`` [unit] readable."""
    printed = printed_unit(unit)
    if not (math.isfinite(largest) and largest > 0.0) or printed in ("", "-"):
        return 1.0, printed
    for size, prefix in _PREFIXES:
        # 1500 N reads better than 1.5 kN, and 0.25 rad than 250 mrad.
        if largest >= (10.0 * size if size > 1.0 else 0.1 * size):
            return 1.0 / size, prefix + printed
    return 1.0, printed


def three_digits(value: float) -> str:
    """Return a number with three digits, and all of those before the point."""
    return f"{value:.0f}" if 100.0 <= abs(value) < 1e6 else f"{value:.3g}"


# --- scales ---


def few_ticks(axes: Axes, x: int = 6, y: int = 5) -> None:
    """Keep the number of ticks to what fits."""
    steps = [1, 2, 5, 10]
    axes.xaxis.set_major_locator(MaxNLocator(x, steps=steps))
    if axes.get_yscale() == "linear":
        axes.yaxis.set_major_locator(MaxNLocator(y, steps=steps))


def _nice_above(value: float) -> float:
    """Return the next 1, 2 or 5 times a power of ten, not below ``value``."""
    decade = 10.0 ** math.floor(math.log10(value))
    return float(next(m * decade for m in (1.0, 2.0, 5.0, 10.0) if m * decade >= value * (1.0 - 1e-12)))


#: What the dotted lines of :func:`linear_then_log` mean, for a footnote.
LINEAR_BETWEEN = "scale linear between the dotted lines, logarithmic beyond"


_LINE = 6.0 * _MILLIMETRE  # two lines of a footnote, of which panels must not lose the height


def explain_linear(figure: Figure) -> None:
    """Explain the dotted lines of :func:`linear_then_log` below the panels."""
    figure.set_figheight(figure.get_figheight() + _LINE)
    footnote(figure, LINEAR_BETWEEN)


def linear_then_log(axes: Sequence[Axes], core: float, largest: float) -> float | None:
    """Set a scale linear up to a limit, and logarithmic beyond for spikes.

    Nothing changes where ``largest``, the size of the spikes, is less than 10 times ``core``, the size of the
    values that must stay legible (one unit).

    Returns:
        Limit between the two parts, or None if the scale stays linear.
    """
    if not (core > 0.0 and math.isfinite(largest)) or largest < 10.0 * core:
        return None
    limit = _nice_above(1.2 * max(core, 1e-5 * largest))  # more than five decades are not distinguishable
    top = 10.0 ** math.ceil(math.log10(largest))
    decades = math.log10(top / limit)
    # Ticks keep their distance in a panel of some 28 mm, where a decade takes 8 / decades mm.
    first = math.ceil(math.log10(limit) + max(math.log10(3.0), 0.41 * decades) - 1e-9)
    powers = range(first, round(math.log10(top)) + 1, 1 if decades <= 2.6 else 2)
    beyond = [10.0**k for k in powers]
    ticks = [-t for t in reversed(beyond)] + [-limit, 0.0, limit] + beyond
    for panel in axes:
        panel.set_yscale("symlog", linthresh=limit, linscale=max(0.8 * decades, 0.8))
        panel.yaxis.set_major_locator(FixedLocator(ticks))
        panel.yaxis.set_minor_locator(NullLocator())
        panel.yaxis.set_major_formatter(FuncFormatter(_plain_number))
        for edge in (-limit, limit):
            panel.axhline(edge, color="#999999", linewidth=0.6, linestyle=":", zorder=1.5)
    return limit


def _plain_number(value: float, _position: int | None = None) -> str:
    """Return a tick label: plain up to a thousand, a power of ten beyond."""
    size = abs(value)
    if size >= 1e4 or (0.0 < size < 1e-2):
        exponent = math.floor(math.log10(size) + 1e-9)
        mantissa = size / 10.0**exponent
        times = "" if abs(mantissa - 1.0) < 1e-9 else rf"{mantissa:g}\cdot"
        return rf"${'-' if value < 0 else ''}{times}10^{{{exponent}}}$"
    return f"{value:g}".replace("-", "\N{MINUS SIGN}")


# --- lines whose colour tells a number, of any length ---

# Pieces from which on a line is drawn part by part, and those of a part: as a path of its own each takes a
# hundred times the room of its numbers.
_LONG_LINE = 20_000
_PIECES = 2_000

#: Points (m, 2) and values of the pieces between them (m - 1,), part by part, each from the last point on.
Parts = Callable[[], Iterable[tuple[Array, Array]]]


def draw_pieces(axes: Axes, points: Array, values: Array, order: Any = slice(None), **looks: Any) -> None:
    """Draw a line's pieces one after another, each in the colour of its value.

    Long lines are made into paths part by part while they are drawn.

    Args:
        axes: Axes, whose limits are set elsewhere.
        points: (n, 2), in their units.
        values: Values of the pieces between them, (n - 1,).
        order: Indices of pieces in their order; all if left out.
        looks: Arguments of ``LineCollection``.
    """
    pieces = np.stack([points[:-1], points[1:]], axis=1)[order]
    if len(pieces) > _LONG_LINE:
        axes.add_artist(_InParts(axes, lambda: [(pieces, values[order])], looks))
    else:
        axes.add_collection(LineCollection(list(pieces), array=values[order], **looks))


def draw_parts(axes: Axes, parts: Parts, **looks: Any) -> None:
    """Draw a line that is too long for memory as :func:`draw_pieces` does."""

    def pieces() -> Iterable[tuple[Array, Array]]:
        for points, values in parts():
            yield np.stack([points[:-1], points[1:]], axis=1), values

    axes.add_artist(_InParts(axes, pieces, looks))


class _InParts(Artist):
    """Pieces of a line that become paths while they are drawn."""

    def __init__(self, axes: Axes, parts: Parts, looks: dict[str, Any]) -> None:
        super().__init__()
        self._on, self._parts, self._looks = axes, parts, looks
        self.set_zorder(looks.get("zorder", 2))
        self.set_rasterized(bool(looks.get("rasterized", False)))
        self.set_in_layout(False)  # the axes' limits are what counts

    @allow_rasterization
    def draw(self, renderer: RendererBase) -> None:
        figure = self._on.figure
        assert figure is not None
        for pieces, values in self._parts():
            for first in range(0, len(pieces), _PIECES):
                part = slice(first, first + _PIECES)
                lines = LineCollection(list(pieces[part]), array=values[part], **self._looks)
                lines.set_rasterized(False)  # the whole of them is
                lines.set_transform(self._on.transData)
                lines.axes = self._on
                lines.set_figure(figure)
                lines.set_clip_path(self._on.patch)
                lines.draw(renderer)
        self.stale = False
