"""Figures of the runs, as vectors within the page, with the numbers that they show."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

from antenna_pin import plot
from antenna_pin.base.side_by_side import side_by_side
from antenna_pin.errors import AntennaPinError
from antenna_pin.report._packed import packed
from antenna_pin.report._page import Picture
from antenna_pin.report._runs import ReportedRun, ideal_of

__all__ = ["DrawnFigure", "drawn", "glance", "picture"]

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
    """A figure of the catalogue as the report has it: its pictures, or why there is none."""

    name: str
    joint: str | None
    pictures: tuple[Picture, ...] = ()
    reason: str = ""


def drawn(runs: Sequence[ReportedRun], processes: int = 1) -> list[DrawnFigure]:
    """Return the figures that the runs allow; the reason for one that cannot be drawn is with it.

    Args:
        runs: What the report is about.
        processes: How many draw, at most, forked from this one.
    """
    drawable = [run for run in runs if run.samples > 1]
    names = _short_names(drawable)
    ideal = ideal_of(drawable)

    def made(each: plot.Allowed) -> DrawnFigure:
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
    return list(side_by_side(made, [each for each in allowed if each.figure.reported], processes))


def _within_its_section(title: str, joint: str | None) -> str:
    """Return a figure's title where its joint, if it is of one, need not be named again."""
    if joint is None:
        return title
    named = re.escape(joint)
    return re.sub(rf"\b{named}\b", "it", re.sub(rf"(,| (of|in|at)) {named}\b", "", title))


def glance(runs: Sequence[ReportedRun], joint: str) -> Picture | None:
    """Return the one picture of the page's head, of a joint; none where it cannot be drawn."""
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
    """Yield the figure of all runs, or of some each where it would be too tall, and which runs it shows."""
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
    """Return a figure as a page has it: vectors, and the numbers behind them.

    Args:
        figure: One that the room of figures drew.
        caption: What it shows.
        key: Name by which it is found in the page.
        name: Its short name, beside others of a section.
        plain: Whether it is to be seen where no script runs.
    """
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
    """Return a figure's file with the places of its lines to a hundredth of a point, 4 µm."""
    return _PATH.sub(lambda path: _DIGITS.sub(rb"\1", path[0]), svg)
