"""Figures of the runs, as pictures within the page: of a column's width, which a phone shows whole."""

from __future__ import annotations

import base64
import functools
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from antenna_pin import plot
from antenna_pin.errors import AntennaPinError
from antenna_pin.report._parts import Picture, Section
from antenna_pin.report._runs import ReportedRun

__all__ = ["drawn"]

#: Vector figures that take more than this become pictures of pixels [bytes].
LARGEST_VECTOR = 150_000
#: Of those [1/inch].
DPI = 250.0


class _Drawing(NamedTuple):
    """A figure to be drawn: a name, what it shows, and what draws it."""

    key: str
    caption: str
    draw: Callable[[], Any]


def drawn(runs: Sequence[ReportedRun]) -> Section:
    """Return the figures that the runs allow; the reason for one that cannot be drawn is a note."""
    drawable = [run for run in runs if run.samples > 1]
    pictures, notes = [], []
    for key, caption, draw in _drawings(drawable) if drawable else ():
        try:
            figure = draw()
        except AntennaPinError as error:
            notes.append(f"{caption}: {error}.")
            continue
        pictures.append(Picture(source=_address(figure), caption=caption, key=key))
    return Section(key="figures", title="Figures", items=tuple(pictures), notes=tuple(notes))


def _drawings(runs: Sequence[ReportedRun]) -> Iterator[_Drawing]:
    pairs = [(run.label, run.data) for run in runs]
    touched = [run for run in runs if run.names("contact")]
    joints = list(dict.fromkeys(name for run in runs for name in run.names("joint")))
    own = list(dict.fromkeys(name for run in touched for name in run.names("clearance_joint")))
    # The joint with play is what a report is about; the others have their numbers in the tables.
    for joint in [name for name in joints if name in own] or joints[:1]:
        for quantity in plot.QUANTITIES:
            draw = functools.partial(plot.figure_motion, pairs, quantity, joint=joint, width="column")
            yield _Drawing(f"motion-{quantity}-{joint}", f"{quantity.capitalize()} of {joint}", draw)
    for joint in own:
        draw = functools.partial(plot.figure_contact_forces, pairs, joint=joint, width="column")
        yield _Drawing(f"contact-forces-{joint}", f"Contact forces in {joint}", draw)
    yield _Drawing(
        "energy",
        "Energy: work, storage and losses",
        functools.partial(plot.figure_energy, pairs, width="column"),
    )
    if any("base_position" in run.data for run in runs):
        draw = functools.partial(plot.figure_momentum, pairs, width="column")
        yield _Drawing("momentum", "Drift of momentum", draw)


def _address(figure: Any) -> str:
    """Return a figure as a data address: as vectors, or as pixels where vectors take too much."""
    vector = plot.rendered(figure, "svg", DPI)
    if len(vector) <= LARGEST_VECTOR:
        return "data:image/svg+xml;base64," + base64.b64encode(vector).decode()
    return "data:image/png;base64," + base64.b64encode(plot.rendered(figure, "png", DPI)).decode()
