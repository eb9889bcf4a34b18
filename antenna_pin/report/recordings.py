"""Recordings of the runs as parts of the page, which share one viewer."""

from __future__ import annotations

from collections.abc import Sequence

from antenna_pin.errors import AntennaPinError
from antenna_pin.record import View, bending_magnification, record, shared_head
from antenna_pin.report._page import Embedded, Section
from antenna_pin.report._runs import ReportedRun, ideal_of

__all__ = ["recordings"]

#: What all recordings of a report may take together, the viewer excepted [MB].
MEGABYTES = 9.0
#: Regular key frames per second of a run; impacts have theirs besides [1/s].
RATE = 100.0


def recordings(runs: Sequence[ReportedRun]) -> Section:
    """Return a recording of every run, and one of every clearance joint close up.

    The ideal run is the ghost in the others, and has no recording of its own beside them.
    """
    ideal = ideal_of(runs)
    wanted: list[tuple[ReportedRun, View, str | None, ReportedRun | None]] = []
    for run in runs:
        if run.samples < 2 or (run is ideal and any(other.samples > 1 for other in runs if other is not run)):
            continue
        # The ghost of another mechanism would say nothing.
        same = ideal is not None and ideal is not run and run.names("joint") == ideal.names("joint")
        wanted.append((run, "mechanism", None, ideal if same else None))
        wanted += [(run, "joint", joint, None) for joint in run.names("clearance_joint")]
    if not wanted:
        return Section(key="recordings", title="Recordings")
    share = MEGABYTES / len(wanted) + 1e-6 * len(shared_head().html.encode())
    items, notes = [], []
    for number, (run, view, joint, ghost) in enumerate(wanted):
        what = f"{run.label}, joint {joint} close up" if joint is not None else run.label
        try:
            made = record(
                run.run,
                None if ghost is None else ghost.run,
                view=view,
                joint=joint,
                magnify=bending_magnification(run.run) if view == "mechanism" else None,
                fps=RATE,
                max_megabytes=share,
            )
        except AntennaPinError as error:
            notes.append(f"{what}: {error}.")
            continue
        seen = f"; {ghost.label} as a ghost" if ghost is not None else ""
        items.append(Embedded(html=made.embedded(f"recording-{number}"), caption=f"{what}{seen}"))
    return Section(key="recordings", title="Recordings", items=tuple(items), notes=tuple(notes))
