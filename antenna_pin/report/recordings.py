"""Recordings of the runs as parts of the page, which share one viewer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.record import View, bending_magnification, record, viewer_megabytes
from antenna_pin.report._page import Embedded
from antenna_pin.report._runs import ReportedRun, ideal_of
from antenna_pin.report.joints import every, hardness

__all__ = ["Recordings", "recordings"]

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
    """The recordings of a page.

    Attributes:
        whole: Of every run but the ideal one, the first in the page's head.
        close: Of every joint with play, close up.
        notes: What is missing, and why.
    """

    whole: list[Embedded] = field(default_factory=list)
    close: dict[str, list[Embedded]] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.whole or self.close)


def recordings(runs: Sequence[ReportedRun], megabytes: float) -> Recordings:
    """Return a recording of every run, and of clearance joints close up, the hardest hit first.

    The ideal run is the ghost in the others, and has no recording of its own beside them.

    Args:
        runs: What is reported.
        megabytes: What all of them may take in the page, the viewer excepted [MB].
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
            html = _made(run, joint, ghost, share, f"recording-{number}")
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
    """Yield runs, with the joint that is to be close up, and the run that is a ghost beside."""
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


def _made(run: ReportedRun, joint: str | None, ghost: ReportedRun | None, share: float, identity: str) -> str:
    """Return the part of the page that one recording is, of a size that is kept."""
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
