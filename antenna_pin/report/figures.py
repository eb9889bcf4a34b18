"""Figures of the runs, as pictures within the page: of a column's width, which a phone shows whole."""

from __future__ import annotations

import base64
from collections.abc import Iterator, Sequence
from typing import Any

from antenna_pin import plot
from antenna_pin.errors import AntennaPinError
from antenna_pin.report._page import Picture, Section
from antenna_pin.report._runs import ReportedRun, ideal_of
from antenna_pin.side_by_side import side_by_side

__all__ = ["address", "drawn"]

#: Vector figures that take more than this become pictures of pixels [bytes].
LARGEST_VECTOR = 150_000
#: Of those [1/inch].
DPI = 250.0
#: A figure of several runs that is taller is drawn in parts, so that each fits on a page of paper [mm].
TALLEST = 215.0
#: Longer names of runs are cut in figures.
LONGEST_NAME = 20


def drawn(runs: Sequence[ReportedRun], processes: int = 1) -> Section:
    """Return the figures that the runs allow; the reason for one that cannot be drawn is a note.

    Args:
        runs: What the report is about.
        processes: How many draw, at most, forked from this one.
    """
    drawable = [run for run in runs if run.samples > 1]
    names = _short_names(drawable)
    ideal = ideal_of(drawable)

    def pictures(each: plot.Allowed) -> list[Picture] | str:
        """Return a figure as one picture or some, or why there is none."""
        wanted = [run for run in drawable if run.names("contact") or not each.figure.touching]
        try:
            parts = [(address(figure), shown) for figure, shown in _parts(each, wanted, names, ideal)]
        except AntennaPinError as error:
            return f"{each.title}: {error}."
        key = "-".join(each.title.lower().split())
        if len(parts) == 1:
            return [Picture(source=parts[0][0], caption=each.title, key=key)]
        return [
            Picture(source=source, caption=f"{each.title}: {', '.join(shown)}", key=f"{key}-{number}")
            for number, (source, shown) in enumerate(parts, start=1)
        ]

    allowed = plot.allowed_figures([(run.label, run.run) for run in drawable]) if drawable else ()
    wanted = [each for each in allowed if each.figure.reported]
    made = list(side_by_side(pictures, wanted, processes))
    return Section(
        key="figures",
        title="Figures",
        items=tuple(picture for found in made if not isinstance(found, str) for picture in found),
        notes=tuple(found for found in made if isinstance(found, str)),
    )


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
    figure = drawing.draw([(names[run.label], run.run) for run in runs], width="column")
    compares = drawing.figure.compares
    others = [run for run in runs if run is not ideal or not compares]
    if 25.4 * figure.get_figheight() <= TALLEST or len(others) < 2:
        yield figure, [run.label for run in runs]
        return
    beside = [ideal] if ideal is not None and compares else []
    half = len(others) // 2
    for part in (others[:half], others[half:]):
        yield from _parts(drawing, [*beside, *part], names, ideal)


def address(figure: Any) -> str:
    """Return a figure as a data address: as vectors, or as pixels where vectors take too much."""
    vector = plot.rendered(figure, "svg", DPI)
    if len(vector) <= LARGEST_VECTOR:
        return "data:image/svg+xml;base64," + base64.b64encode(vector).decode()
    return "data:image/png;base64," + base64.b64encode(plot.rendered(figure, "png", DPI)).decode()
