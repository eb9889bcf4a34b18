"""Figures of the runs, as vectors within the page, with the numbers that they show."""

from __future__ import annotations

import base64
import re
import zlib
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.side_by_side import side_by_side
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.show import plot
from antenna_pin.show.plot import Drawn
from antenna_pin.show.record import View, bending_magnification, record, viewer_megabytes
from antenna_pin.show.report._page import Embedded, Picture
from antenna_pin.show.report._runs import ReportedRun, every, ideal_of
from antenna_pin.show.report.joints import hardness

_Array = NDArray[np.float64]
# Samples of a line, of which the page has fewer where all would take too much, at least.
_FEWEST = 64


def packed(content: bytes) -> str:
    """Return bytes as a page holds them."""
    return base64.b64encode(zlib.compress(content, 9)).decode()


class FigureNumbers:
    """Numbers of all figures of a page, each column once, to seven digits.

    Args:
        most: What they may take [bytes]; longer lines are thinned to keep to it.
    """

    def __init__(self, most: float) -> None:
        """Begin with none."""
        self._most = most
        self._figures: dict[str, Sequence[Drawn]] = {}

    def add(self, key: str, drawn: Sequence[Drawn]) -> None:
        """Add what a figure shows, by the figure's name in the page."""
        if drawn:
            self._figures[key] = drawn

    def written(self) -> dict[str, Any]:
        """Return the columns for the page's script, and each figure's references to them."""
        samples = max((one.columns[0].size for drawn in self._figures.values() for one in drawn), default=0)
        made, size = self._packed(samples)
        while size > self._most and samples > _FEWEST:
            samples = max(int(0.9 * samples * self._most / size), _FEWEST)
            made, size = self._packed(samples)
        return made

    def _packed(self, most: int) -> tuple[dict[str, Any], int]:
        columns: dict[tuple[int, bytes], int] = {}
        texts: list[list[Any]] = []
        figures: dict[str, list[dict[str, Any]]] = {}
        for key, drawn in self._figures.items():
            figures[key] = []
            for one in drawn:
                places = []
                for number, values in enumerate(thinned(one.columns, most)):
                    exact = number == 0 and bool((np.diff(values) >= 0.0).all())
                    raw = _bytes(values, 8 if exact else 4)
                    name = (8 if exact else 4, raw)
                    if name not in columns:
                        columns[name] = len(texts)
                        texts.append([values.size, name[0], packed(raw)])
                    places.append(columns[name])
                about = {"panel": one.panel, "label": one.label, "names": one.names, "columns": places}
                figures[key].append(about | {"of": int(one.columns[0].size)})
        return {"columns": texts, "figures": figures}, sum(len(text) for _, _, text in texts)


def thinned(columns: Sequence[_Array], most: int) -> Iterable[_Array]:
    """Return thinned columns: first, least and greatest sample of each part."""
    count = columns[0].size
    if count <= most:
        return columns
    values = np.asarray(columns[1], dtype=float)
    low, high = np.nan_to_num(values, nan=np.inf), np.nan_to_num(values, nan=-np.inf)
    # The first parts are a sample longer where the parts do not divide the samples.
    parts = max(most // 3, 1)
    length, longer = divmod(count, parts)
    split = longer * (length + 1)
    kept = [np.array([0, count - 1])]
    for begin, end, width in ((0, split, length + 1), (split, count, length)):
        first = np.arange(begin, end, width)
        kept.append(first)
        kept += [first + low[begin:end].reshape(-1, width).argmin(axis=1)]
        kept += [first + high[begin:end].reshape(-1, width).argmax(axis=1)]
    chosen = np.unique(np.concatenate(kept))
    return [np.asarray(column)[chosen] for column in columns]


def _bytes(values: _Array, width: int) -> bytes:
    whole = np.ascontiguousarray(values, dtype=f"<f{width}")
    return np.frombuffer(whole.tobytes(), dtype=np.uint8).reshape(-1, width).T.tobytes()


#: What a recording is to have of the page, at least; joints beyond are not shown close up [MB].
LEAST = 0.3
#: Regular key frames per second of a run; impacts have theirs besides [1/s].
RATE = 100.0
# What key frames take packed, of what they take by themselves [-], and what shapes do besides [MB]; a
# recording that takes too much is made again with fewer.
_PACKED, _SHAPES = 0.65, 0.35
_TRIALS = 3
# Of a mechanism there is so many times as much to show as of one of its joints.
_MORE = 3


@dataclass(frozen=True, slots=True)
class Recordings:
    """Recordings of a page."""

    whole: list[Embedded] = field(default_factory=list)  # of every run but the ideal one
    close: dict[str, list[Embedded]] = field(default_factory=dict)  # close-ups by joint with play
    notes: list[str] = field(default_factory=list)  # missing recordings and the reasons

    def __bool__(self) -> bool:
        """Return whether there is any."""
        return bool(self.whole or self.close)


def recordings(runs: Sequence[ReportedRun], megabytes: float) -> Recordings:
    """Return a recording of every run, and close-ups of joints, hardest hit first.

    The ideal run is the ghost in the others, and has no recording of its own beside them. ``megabytes``: size
    of all recordings in the page, without the viewer [MB].
    """
    found = Recordings()
    wanted = list(_wanted(runs))
    whole = sum(joint is None for _, joint, _ in wanted)
    most = whole + max(int(megabytes / LEAST) - _MORE * whole, 1)
    left = [f"{run.label}, joint {joint}" for run, joint, _ in wanted[most:]]
    if left:
        found.notes.append(
            f"Not close up, to keep the page small: {', '.join(left)}; see antenna-pin record."
        )
    shares = [_MORE if joint is None else 1 for _, joint, _ in wanted[:most]]
    for number, (run, joint, ghost) in enumerate(wanted[:most]):
        what = f"{run.label}, joint {joint} close up" if joint is not None else run.label
        share = megabytes * shares[number] / sum(shares)
        try:
            html = _markup(run, joint, ghost, share, f"recording-{number}")
        except AntennaPinError as error:
            found.notes.append(f"{what}: {error}.")
            continue
        seen = f"; {ghost.label} as a ghost" if ghost is not None else ""
        part = Embedded(html=html, caption=f"{what}{seen}")
        if joint is None:
            found.whole.append(part)
        else:
            found.close.setdefault(joint, []).append(part)
    return found


def _wanted(runs: Sequence[ReportedRun]) -> Iterator[tuple[ReportedRun, str | None, ReportedRun | None]]:
    """Yield run, joint of the close-up, and ghost of each recording."""
    ideal = ideal_of(runs)
    moving = [
        run
        for run in runs
        if run.samples > 1
        and not (run is ideal and any(other.samples > 1 for other in runs if other is not run))
    ]
    for run in moving:
        # The ghost of another mechanism would say nothing.
        same = ideal is not None and ideal is not run and run.names("joint") == ideal.names("joint")
        yield run, None, ideal if same else None
    for joint in sorted(every(moving, "clearance_joint"), key=lambda name: -hardness(moving, name)):
        for run in moving:
            if joint in run.names("clearance_joint"):
                yield run, joint, None


def _markup(
    run: ReportedRun, joint: str | None, ghost: ReportedRun | None, share: float, identity: str
) -> str:
    """Return the markup of one recording within its size."""
    view: View = "mechanism" if joint is None else "joint"
    limit, html = share / _PACKED + _SHAPES, ""
    for _ in range(_TRIALS):
        try:
            made = record(
                run.run,
                None if ghost is None else ghost.run,
                view=view,
                joint=joint,
                magnify=bending_magnification(run.run) if view == "mechanism" else None,
                fps=RATE,
                max_megabytes=limit + viewer_megabytes(),
            )
        except InvalidParameterError:
            if html:  # its shapes leave no room for fewer key frames
                break
            limit *= 2.0
            continue
        html = made.embedded(identity, "24rem", packed=True)
        size = 1e-6 * len(html)
        if size <= share:
            break
        limit = min(limit, 1e-6 * len(made.embedded(identity))) - 1.05 * (size - share) / _PACKED
    if not html:
        raise InvalidParameterError(
            "recording", "size", f"within {limit:.2g} MB", "more for its shapes alone"
        )
    return html


#: Of what is pixels within a figure, as very long lines are [1/inch].
DPI = 160.0
#: A figure of several runs that is taller is drawn in parts, so that each fits on a page of paper [mm].
TALLEST = 240.0
#: Longer names of runs are cut in figures.
LONGEST_NAME = 20

_MILLIMETRES = 25.4  # of an inch
_PATH = re.compile(rb' d="[^"]+"')
_DIGITS = re.compile(rb"(\.\d\d)\d+")


class DrawnFigure(NamedTuple):
    """Figure of the catalogue: its pictures, or the reason for none."""

    name: str
    joint: str | None
    pictures: tuple[Picture, ...] = ()
    reason: str = ""


def drawn(runs: Sequence[ReportedRun], processes: int = 1) -> list[DrawnFigure]:
    """Return the figures that the runs allow, drawn by forked processes."""
    drawable = [run for run in runs if run.samples > 1]
    names = _short_names(drawable)
    ideal = ideal_of(drawable)

    def draw(each: plot.Allowed) -> DrawnFigure:
        """Return a figure as one picture or some, or why there is none."""
        wanted = [run for run in drawable if run.names("contact") or not each.figure.touching]
        key = "-".join(re.sub(r"[^\w.+-]", " ", each.title.lower()).split())
        short = _within_its_section(each.title, each.joint)
        try:
            parts = list(_parts(each, wanted, names, ideal))
            pictures = []
            for number, (figure, shown) in enumerate(parts, start=1):
                beside = f": {', '.join(shown)}" if len(parts) > 1 else ""
                own = f"{key}-{number}" if len(parts) > 1 else key
                pictures.append(picture(figure, each.title + beside, own, f"{short}{beside}"))
        except AntennaPinError as error:
            return DrawnFigure(each.figure.name, each.joint, reason=f"{each.title}: {error}.")
        return DrawnFigure(each.figure.name, each.joint, tuple(pictures))

    allowed = plot.allowed_figures([(run.label, run.run) for run in drawable]) if drawable else ()
    return list(side_by_side(draw, [each for each in allowed if each.figure.reported], processes))


def _within_its_section(title: str, joint: str | None) -> str:
    """Return a figure's title for the section of its joint, without the joint's name."""
    if joint is None:
        return title
    named = re.escape(joint)
    short, found = re.subn(rf"(,| (of|in|at)) {named}\b", "", title)
    return short if found else re.sub(rf"\b{named}\b", "the joint", title)


def glance(runs: Sequence[ReportedRun], joint: str) -> Picture | None:
    """Return the picture of the page's head; None where it cannot be drawn."""
    drawable = [run for run in runs if run.samples > 1]
    names = _short_names(drawable)
    try:
        figure = plot.figure_glance([(names[run.label], run.run) for run in drawable], joint=joint)
    except AntennaPinError:
        return None
    caption = f"{joint} over time"
    return picture(figure, caption, "glance", plain=True)


def _short_names(runs: Sequence[ReportedRun]) -> dict[str, str]:
    """Return names of runs that fit into figures, unlike one another."""
    names: dict[str, str] = {}
    for number, run in enumerate(runs, start=1):
        fits = len(run.label) <= LONGEST_NAME
        end = f"… {number}"
        names[run.label] = run.label if fits else run.label[: LONGEST_NAME - len(end)].rstrip() + end
    return names


def _parts(
    drawing: plot.Allowed, runs: Sequence[ReportedRun], names: dict[str, str], ideal: ReportedRun | None
) -> Iterator[tuple[Any, list[str]]]:
    """Yield the figure and its runs, split where it would be too tall."""
    figure = drawing.draw([(names[run.label], run.run) for run in runs], width="page")
    compares = drawing.figure.compares
    others = [run for run in runs if run is not ideal or not compares]
    if _MILLIMETRES * figure.get_figheight() <= TALLEST or len(others) < 2:
        yield figure, [run.label for run in runs]
        return
    beside = [ideal] if ideal is not None and compares else []
    half = len(others) // 2
    for part in (others[:half], others[half:]):
        yield from _parts(drawing, [*beside, *part], names, ideal)


def picture(figure: Any, caption: str, key: str, name: str = "", *, plain: bool = False) -> Picture:
    """Return a figure for a page: vectors, and the numbers behind them."""
    size = tuple(_MILLIMETRES * float(one) for one in figure.get_size_inches())
    svg = _shortened(plot.rendered(figure, "svg", DPI))
    return Picture(
        svg=svg,
        packed=packed(svg),
        caption=caption,
        size=(size[0], size[1]),
        key=key,
        name=name,
        numbers=plot.drawn_numbers(figure),
        plain=plain,
    )


def _shortened(svg: bytes) -> bytes:
    """Return a figure's file with coordinates to a hundredth of a point, 4 µm."""
    return _PATH.sub(lambda path: _DIGITS.sub(rb"\1", path[0]), svg)
