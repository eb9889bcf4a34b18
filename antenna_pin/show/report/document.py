"""Runs and what motions come to in, one HTML file out."""

from __future__ import annotations

import dataclasses
import functools
import itertools
import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from antenna_pin.analysis import round_off_scales
from antenna_pin.base.arguments import takes
from antenna_pin.base.files import check_writable, replacing
from antenna_pin.base.rules import Positive
from antenna_pin.base.views import in_frame, policy, script
from antenna_pin.show.report import (
    elements,
    fits,
    head,
    joints,
    motion,
    orbits,
    provenance,
    results,
    words,
)
from antenna_pin.show.report._page import (
    Details,
    Embedded,
    PageTable,
    Picture,
    PicturedTable,
    Section,
    Status,
)
from antenna_pin.show.report._runs import Finding, Reported, ReportedRun, every, origin, parted, reported
from antenna_pin.show.report.figures import DrawnFigure, FigureNumbers, drawn, glance
from antenna_pin.show.report.joints import hardest_joint, joint_key

# --- which section of a page a figure is in, and how many figures there is room for ---

#: What all figures may take in a page; those beyond are left out, and named [MB].
FIGURES = 2.6

# Sections of figures by how the name of one begins; of a joint, its own; others are by themselves.
_SECTIONS = {
    "closure": "loops",
    "coupling": "loops",
    "control": "controllers",
    "applied": "forces",
    "drive": "drives",
    "swept": "drives",
    "shock": "drives",
    "random": "drives",
    "hysteresis": "springs",
    "stops": "stops",
    "gears": "gears",
    "deflection": "elastic",
    "base": "base",
    "body": "base",
    "joints": "joints",
    "pointing": "pointing",
    "energy": "conservation",
    "momentum": "conservation",
}


@dataclass(frozen=True, slots=True)
class Placed:
    """Figures of a page by their sections."""

    sections: dict[str, list[Picture]] = field(default_factory=dict)  # by key
    reasons: dict[str, list[str]] = field(default_factory=dict)  # for missing figures, by key
    notes: tuple[str, ...] = ()  # on figures without room
    megabytes: float = 0.0  # size of the pictures [MB]

    @classmethod
    def of(cls, figures: Iterable[DrawnFigure], runs: Sequence[ReportedRun]) -> Placed:
        """Return figures of the runs in their sections, as many as there is room for."""
        played = {name for run in runs for name in run.names("clearance_joint")}
        sections: dict[str, list[Picture]] = {}
        reasons: dict[str, list[str]] = {}
        left, size = [], 0.0
        for one in figures:
            begins = (key for begin, key in _SECTIONS.items() if one.name.startswith(begin))
            place = next(begins, "figures" if one.joint is None else "joints")
            if one.joint in played and one.name != "hysteresis":
                place = joint_key(str(one.joint))
            if one.reason:
                reasons.setdefault(place, []).append(one.reason)
            for picture in one.pictures:
                own = 1e-6 * len(picture.packed)
                if size + own > FIGURES:
                    left.append(picture.caption)
                    continue
                size += own
                sections.setdefault(place, []).append(picture)
        unseen = f"Not shown, to keep the page small: {', '.join(left)}; antenna-pin plot draws them."
        return cls(sections, reasons, (unseen,) if left else (), size)

    def __getitem__(self, key: str) -> tuple[Picture, ...]:
        """Return the pictures of a section."""
        return tuple(self.sections.get(key, ()))

    def with_reasons(self, section: Section) -> Section:
        """Return a section with the reasons for its missing figures."""
        return replace(section, notes=(*section.notes, *self.reasons.get(section.key, ())))


#: What a page may take, what the numbers of its figures may, what viewer, style and scripts take [MB].
MEGABYTES, DATA, FIXED = 4.8, 1.2, 0.5
#: What recordings are to have at least, for which there are fewer numbers of figures [MB].
MOVING = 1.4
# What an entry of a table takes, and one of a table that is set small [MB].
_CELL, _SMALL = 90e-6, 40e-6

# The page's own script, in the order in which its parts need one another.
_SCRIPTS = ("unpack.js", "zoom.js", "pictures.js", "report.js")


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """A report: a page that needs nothing but itself.

    Attributes:
        title: Its title.
        sections: What is in it, as data: statements, tables, pictures, recordings.
        html: The page.
    """

    title: str
    sections: tuple[Section, ...]
    html: str

    def __repr__(self) -> str:
        """Return one line: title, sections, size."""
        return f"<Report {self.title!r}: {len(self.sections)} sections, {1e-6 * len(self.html):.1f} MB>"

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the page, ``NAME.html``; return its path.

        Raises:
            OutputError: The name ends otherwise, or it cannot be written there.
        """
        target = check_writable(path, ".html")
        with replacing(target) as partial:
            partial.write_text(self.html, encoding="utf-8", errors="backslashreplace")
        return target

    def _repr_html_(self) -> str:
        """Show the report in a notebook, in a frame of its own."""
        return in_frame(self.html, "40rem")


@takes()
def report(
    runs: Iterable[Reported] | Reported,
    *,
    title: str | None = None,
    figures: bool = True,
    recordings: bool = True,
    window: Positive | None = None,
    command: str | None = None,
    quantities: Sequence[str] = (),
    processes: int = 1,
) -> Report:
    """Return a report on runs, which it compares, and on what motions come to.

    A run without contact among them is the ideal one that deviations are from. What a run does not hold (one
    sample, no clearance, an older file) is left out, with the reason in its place. Phase portraits, sections,
    bifurcation diagrams, periodic solutions, branches of these, Lyapunov exponents, fits, what tests can tell
    and experiments have a section each.

    Args:
        runs: Trajectories, files of them, or pairs of a label and a trajectory; datasets of what motions come
            to, or files of these; one, or any number.
        title: Of the report; what the runs are titled if left out.
        figures: Whether to draw figures.
        recordings: Whether to embed 3D recordings.
        window: Length of the windows of pointing indices [s]; a tenth of the shortest run if left out.
        command: The command line that makes this report, for its provenance; found from the files if left
            out.
        quantities: Functions of a run that return a number, as ``FILE.py:NAME``, shown with the key results.
        processes: How many draw figures, at most. More than one are forked from this one
            (:func:`antenna_pin.base.side_by_side.side_by_side`), which no other thread may be at work beside.

    Raises:
        InvalidParameterError: There is nothing to report on, or the window has no length.
        FileFormatError: A file is none of these.
    """
    given, findings = parted(runs)
    found = reported(given) if given or not findings else []
    parts = _Parts()
    if found:
        parts = _of_runs(found, processes if figures else 0, recordings, window, quantities)
    shown = {detail.text for part in parts.closing for detail in part.items if isinstance(detail, Details)}
    told = [_of_finding(k, one, figures, shown) for k, one in enumerate(findings, start=1)]
    origins = provenance.provenance(found, command, [one.file for one in findings])
    sections = (*parts.opening, *(section for section, _ in told), *parts.closing, origins)
    statuses = [*map(results.status, found), *(one for _, one in told)]
    heading = title if title is not None else _title(found, findings)
    warned = results.warnings(found)
    return page(heading, statuses, sections, warnings=warned, moves=parts.moves, data=parts.data)


@dataclass(frozen=True, slots=True)
class _Parts:
    """Contribution of the runs to a page: sections, and room for numbers."""

    opening: tuple[Section, ...] = ()
    closing: tuple[Section, ...] = ()
    moves: bool = False
    data: float = DATA  # what the numbers of figures may take [MB]


def _of_runs(
    runs: list[ReportedRun],
    drawing: int,
    recordings: bool,
    window: float | None,
    quantities: Sequence[str],
) -> _Parts:
    """Return what runs bring; ``drawing``: how many processes draw figures, 0 for no figures."""
    scales = round_off_scales(*(run.data for run in runs))
    placed = Placed.of(drawn(runs, drawing) if drawing else (), runs)
    hardest, played = hardest_joint(runs), every(runs, "clearance_joint")
    sections = [
        *(
            joints.with_play(
                runs, name, scales, placed[joints.joint_key(name)], len(played) > 2 and name != hardest
            )
            for name in played
        ),
        joints.without_play(runs, scales, placed["joints"]),
        elements.loops(runs, scales, placed["loops"]),
        elements.drives(runs, scales, placed["drives"]),
        elements.controllers(runs, placed["controllers"]),
        elements.springs(runs, scales, placed["springs"]),
        elements.stops_and_latches(runs, scales, placed["stops"]),
        elements.gears(runs, placed["gears"]),
        elements.elastic_parts(runs, placed["elastic"]),
        elements.forces(runs, scales, placed["forces"]),
        joints.base(runs, scales, placed["base"]),
        motion.deviations(runs),
        motion.pointing(runs, window, placed["pointing"]),
        Section(key="figures", title="More figures", items=placed["figures"], notes=placed.notes),
    ]
    said = Section(key="what", title="What was run", parts=tuple(words.scenario_sections(runs)), folded=True)
    sections = [placed.with_reasons(section) for section in sections]
    closing = (results.conservation(runs, placed["conservation"]), motion.frequencies(runs), said)
    seen: list[Embedded | Picture] = []
    if drawing and hardest is not None and (small := glance(runs, hardest)) is not None:
        seen.append(small)
    left = MEGABYTES - FIXED - placed.megabytes - sum(map(_megabytes, (*sections, *closing)))
    data = min(DATA, max(left - MOVING, 0.25 * left)) if recordings else DATA
    moves = False
    if recordings:
        from antenna_pin.show.report.figures import recordings as made

        shown = made(runs, left - min(data, placed.megabytes * 3.0))
        moves = bool(shown)
        seen[:0] = shown.whole[:1]
        sections = [joints.with_recordings(section, shown.close) for section in sections]
        others, notes = tuple(shown.whole[1:]), tuple(shown.notes)
        sections.append(Section(key="recordings", title="More recordings", items=others, notes=notes))
    return _Parts((head.key_results(runs, scales, seen, quantities), *sections), closing, moves, data)


def _megabytes(section: Section) -> float:
    """Return about what the tables and texts of a section take in the page [MB]."""
    tables = [item for item in section.items if isinstance(item, PageTable)]
    tables += [item.table for item in section.items if isinstance(item, PicturedTable)]
    folded = [item for item in section.items if isinstance(item, Details)]
    tables += [table for item in folded for table in item.tables]
    cells = sum((_SMALL if one.dense else _CELL) * len(one.rows) * len(one.columns) for one in tables)
    return cells + sum(1e-6 * len(item.text) for item in folded) + sum(map(_megabytes, section.parts))


# The section of every kind of finding.
_TELLS = {
    "portrait": orbits.portrait,
    "section": orbits.section,
    "bifurcation": orbits.diagram,
    "orbit": orbits.orbit,
    "branch": orbits.branch,
    "exponents": orbits.exponents,
    "fit": fits.fit,
    "identifiability": fits.identifiability,
    "experiments": fits.experiments,
    "sensitivity": orbits.sensitivity,
}


def _of_finding(k: int, finding: Finding, figures: bool, shown: set[str]) -> tuple[Section, Status]:
    """Return the section of a finding with its origin, and the verdict."""
    section, judged = _TELLS[finding.kind](finding, f"finding-{k}", figures)
    statements, details = origin(finding, shown)
    whole = dataclasses.replace(
        section, statements=(*section.statements, *statements), items=(*section.items, *details)
    )
    return whole, judged


def page(
    title: str,
    statuses: Iterable[Status],
    sections: Iterable[Section],
    *,
    warnings: Iterable[str] = (),
    moves: bool = False,
    data: float = DATA,
) -> Report:
    """Return the page of the sections that are not empty.

    ``moves``: whether there are recordings in it; ``data``: room for the numbers of its figures [MB].
    """
    kept = tuple(section for section in sections if not section.empty)
    shared = None
    if moves:
        from antenna_pin.show.record import shared_head

        shared = shared_head(packed=True)
    numbers = FigureNumbers(1e6 * data)
    for picture in (one for section in kept for one in section.pictures):
        numbers.add(picture.key, picture.numbers)
    own = script("\n".join(_asset(name) for name in _SCRIPTS))
    made = _environment().get_template("report.html.j2").render(
        title=title,
        statuses=list(statuses),
        warnings=list(warnings),
        sections=kept,
        numbers=Markup(json.dumps(numbers.written()).replace("<", r"\u003c")),  # noqa: S704 - JSON
        style=Markup(_asset("report.css")),  # noqa: S704 - a file of this package
        script=Markup(own),  # noqa: S704 - a file of this package
        viewer=Markup(shared.html if shared else ""),  # noqa: S704 - made by record
        policy=Markup(policy(own, *(shared.scripts if shared else ()))),  # noqa: S704 - digests
    )  # fmt: skip
    return Report(title, kept, made)


def _title(runs: list[ReportedRun], findings: list[Finding]) -> str:
    every = [run.data for run in runs] + [one.table for one in findings]
    titles = dict.fromkeys(str(data.attrs.get("title") or "") for data in every)
    labels = [run.label for run in runs] + [one.label for one in findings]
    return "; ".join(filter(None, titles)) or "Report on " + ", ".join(labels)


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("antenna_pin.show.report"),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["safe_part"] = _safe_part
    environment.filters["in_groups"] = _in_groups
    return environment


def _safe_part(part: Any) -> Markup:
    """Return the markup of a recording, which its room has escaped."""
    assert isinstance(part, Embedded)
    return Markup(part.html)  # noqa: S704


def _in_groups(items: Iterable[Any]) -> list[tuple[str, list[Any]]]:
    """Return neighbours of one kind together, so that pictures stand side by side."""
    return [(kind, list(group)) for kind, group in itertools.groupby(items, key=lambda item: item.kind)]


def _asset(name: str) -> str:
    return files("antenna_pin.show.report").joinpath("templates", name).read_text(encoding="utf-8")
