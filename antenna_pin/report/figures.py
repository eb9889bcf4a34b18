"""Figures of the runs, as pictures within the page: of a column's width, which a phone shows whole."""

from __future__ import annotations

import base64
import functools
from collections.abc import Callable, Iterator, Sequence
from typing import Any, NamedTuple

from antenna_pin import plot
from antenna_pin.errors import AntennaPinError
from antenna_pin.report._parts import Picture, Section
from antenna_pin.report._runs import ReportedRun, ideal_of

__all__ = ["drawn"]

#: Vector figures that take more than this become pictures of pixels [bytes].
LARGEST_VECTOR = 150_000
#: Of those [1/inch].
DPI = 250.0
#: A figure of several runs that is taller is drawn in parts, so that each fits on a page of paper [mm].
TALLEST = 215.0
#: Longer names of runs are cut in figures.
LONGEST_NAME = 20

Pairs = list[tuple[str, Any]]


class _Drawing(NamedTuple):
    """A figure to be drawn: its name, what it shows, what draws it, and of what.

    Attributes:
        compares: Whether all runs stand in it beside the ideal one.
        touching: Whether only runs with contact are in it.
    """

    key: str
    caption: str
    draw: Callable[[Pairs], Any]
    compares: bool = False
    touching: bool = False


def drawn(runs: Sequence[ReportedRun]) -> Section:
    """Return the figures that the runs allow; the reason for one that cannot be drawn is a note."""
    drawable = [run for run in runs if run.samples > 1]
    names = _short_names(drawable)
    ideal = ideal_of(drawable)
    pictures, notes = [], []
    for drawing in _drawings(drawable) if drawable else ():
        try:
            wanted = [run for run in drawable if run.names("contact") or not drawing.touching]
            parts = list(_parts(drawing, wanted, names, ideal))
        except AntennaPinError as error:
            notes.append(f"{drawing.caption}: {error}.")
            continue
        for number, (figure, shown) in enumerate(parts, start=1):
            whole = len(parts) == 1
            pictures.append(
                Picture(
                    source=_address(figure),
                    caption=drawing.caption if whole else f"{drawing.caption}: {', '.join(shown)}",
                    key=drawing.key if whole else f"{drawing.key}-{number}",
                )
            )
    return Section(key="figures", title="Figures", items=tuple(pictures), notes=tuple(notes))


def _short_names(runs: Sequence[ReportedRun]) -> dict[str, str]:
    """Return names of runs that fit into figures, unlike one another."""
    names: dict[str, str] = {}
    for number, run in enumerate(runs, start=1):
        fits = len(run.label) <= LONGEST_NAME
        end = f"… {number}"
        names[run.label] = run.label if fits else run.label[: LONGEST_NAME - len(end)].rstrip() + end
    return names


def _parts(
    drawing: _Drawing, runs: Sequence[ReportedRun], names: dict[str, str], ideal: ReportedRun | None
) -> Iterator[tuple[Any, list[str]]]:
    """Yield the figure of all runs, or of some each where it would be too tall, and which runs it shows."""
    figure = drawing.draw([(names[run.label], run.data) for run in runs])
    others = [run for run in runs if run is not ideal or not drawing.compares]
    if 25.4 * figure.get_figheight() <= TALLEST or len(others) < 2:
        yield figure, [run.label for run in runs]
        return
    beside = [ideal] if ideal is not None and drawing.compares else []
    half = len(others) // 2
    for part in (others[:half], others[half:]):
        yield from _parts(drawing, [*beside, *part], names, ideal)


def _drawings(runs: Sequence[ReportedRun]) -> Iterator[_Drawing]:
    joints = list(dict.fromkeys(name for run in runs for name in run.names("joint")))
    own = list(dict.fromkeys(name for run in runs for name in run.names("clearance_joint")))

    def drawing(caption: str, draw: Callable[..., Any], *, touching: bool = False, **given: Any) -> _Drawing:
        key = "-".join(caption.lower().split())
        return _Drawing(
            key, caption, functools.partial(draw, width="column", **given), not touching, touching
        )

    # The joint with play is what a report is about; the others have their numbers in the tables.
    for joint in [name for name in joints if name in own] or joints[:1]:
        for quantity in plot.QUANTITIES:
            caption = f"{quantity.capitalize()} of {joint}"
            yield drawing(caption, plot.figure_motion, quantity=quantity, joint=joint)
    for joint in own:
        for caption, draw in (
            ("Contact forces in", plot.figure_contact_forces),
            ("Orbit of the journal in", plot.figure_orbit),
            ("Eccentricity and tilt in", plot.figure_eccentricity),
            ("Load around the bore of", plot.figure_bore_load),
            ("Contact scenarios of", plot.figure_scenarios),
        ):
            yield drawing(f"{caption} {joint}", draw, touching=True, joint=joint)
    for joint in own or joints[:1]:
        yield drawing(f"Force through {joint}", plot.figure_joint_load, joint=joint)
        yield drawing(f"Spectra, {joint}", plot.figure_spectra, joint=joint)
    floating = any("base_position" in run.data for run in runs)
    if floating:
        yield drawing("Position of the base", plot.figure_base, quantity="position")
        yield drawing("Attitude of the base", plot.figure_base, quantity="attitude")
    if any(run.run.scenario is not None and run.run.scenario.pointing is not None for run in runs):
        yield drawing("Boresight and pointing error", plot.figure_pointing)
    yield drawing("Energy: work, storage and losses", plot.figure_energy)._replace(compares=False)
    if floating:
        yield drawing("Drift of momentum", plot.figure_momentum)


def _address(figure: Any) -> str:
    """Return a figure as a data address: as vectors, or as pixels where vectors take too much."""
    vector = plot.rendered(figure, "svg", DPI)
    if len(vector) <= LARGEST_VECTOR:
        return "data:image/svg+xml;base64," + base64.b64encode(vector).decode()
    return "data:image/png;base64," + base64.b64encode(plot.rendered(figure, "png", DPI)).decode()
