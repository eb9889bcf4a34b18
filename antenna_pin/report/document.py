"""Runs in, one HTML file out."""

from __future__ import annotations

import functools
import itertools
import math
import os
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup

from antenna_pin.card import in_frame
from antenna_pin.errors import InvalidParameterError
from antenna_pin.files import check_writable, replacing
from antenna_pin.report import contacts, elastic, loops, motion, pointing, provenance, results, words
from antenna_pin.report._parts import Embedded, Section
from antenna_pin.report._runs import ReportedRun, Run, reported

__all__ = ["Report", "page", "report"]


@dataclass(frozen=True, slots=True, eq=False)
class Report:
    """A report on runs: a page that needs nothing but itself.

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
        """Write the page; return its path.

        Raises:
            OutputError: It cannot be written there.
        """
        target = check_writable(path)
        with replacing(target) as partial:
            partial.write_text(self.html, encoding="utf-8")
        return target

    def _repr_html_(self) -> str:
        """Show the report in a notebook, in a frame of its own."""
        return in_frame(self.html, "40rem")


def report(
    runs: Iterable[Run] | Run,
    *,
    title: str | None = None,
    figures: bool = True,
    recordings: bool = True,
    window: float | None = None,
    command: str | None = None,
) -> Report:
    """Return a report on runs, which it compares.

    A run without contact among them is the ideal one that deviations are from. What a run does not hold (one
    sample, no clearance, an older file) is left out, with the reason in its place.

    Args:
        runs: Trajectories, files of them, or pairs of a label and a trajectory; one, or any number.
        title: Of the report; what the runs are titled if left out.
        figures: Whether to draw figures.
        recordings: Whether to embed 3D recordings.
        window: Length of the windows of pointing indices [s]; a tenth of the shortest run if left out.
        command: The command line that makes this report, for its provenance; found from the files if left
            out.

    Raises:
        InvalidParameterError: There is no run, or the window has no length.
        FileFormatError: A file is not one of a run.
    """
    if window is not None and not 0.0 < window < math.inf:
        raise InvalidParameterError("report", "window", "positive and finite [s]", window)
    found = reported(runs)
    heading = title if title is not None else _title(found)
    sections = [
        results.key_results(found),
        loops.loops(found),
        elastic.elastic_parts(found),
        motion.deviations(found),
        contacts.impact_tables(found),
        contacts.loads(found),
        contacts.settlings(found),
        motion.frequencies(found),
        pointing.pointing(found, window),
    ]
    head = ""
    if recordings:
        from antenna_pin.report import recordings as embedding

        shown = embedding.recordings(found)
        sections.insert(1, shown)
        head = embedding.viewer() if any(isinstance(item, Embedded) for item in shown.items) else ""
    if figures:
        from antenna_pin.report.figures import drawn

        sections.insert(1, drawn(found))
    sections += [
        Section(key="what", title="What was run"),
        *words.scenario_sections(found),
        results.conservation(found),
        provenance.provenance(found, command),
    ]
    kept = tuple(section for section in sections if not section.empty or section.key == "what")
    labels, warnings = [run.label for run in found], results.warnings(found)
    return page(heading, labels, results.statuses(found), kept, warnings=warnings, viewer=head)


def page(
    title: str,
    labels: Iterable[str],
    statuses: Iterable[Any],
    sections: Iterable[Section],
    *,
    warnings: Iterable[str] = (),
    viewer: str = "",
) -> Report:
    """Return the page of some sections.

    Args:
        title: Its heading.
        labels: Names of what it is about.
        statuses: How each ended: ``label``, ``outcome``, ``text``, ``completed``.
        sections: What is in it.
        warnings: What is to be minded.
        viewer: Markup for the page's head, made by record.
    """
    kept = tuple(sections)
    made = _environment().get_template("report.html.j2").render(
        title=title,
        labels=list(labels),
        statuses=list(statuses),
        warnings=list(warnings),
        sections=kept,
        style=Markup(_asset("report.css")),  # noqa: S704 - a file of this package
        script=Markup(_asset("report.js")),  # noqa: S704 - a file of this package
        viewer=Markup(viewer),  # noqa: S704 - made by record
    )  # fmt: skip
    return Report(title, kept, made)


def _title(runs: list[ReportedRun]) -> str:
    titles = dict.fromkeys(str(run.data.attrs.get("title") or "") for run in runs)
    return "; ".join(filter(None, titles)) or "Report on " + ", ".join(run.label for run in runs)


@functools.cache
def _environment() -> jinja2.Environment:
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("antenna_pin.report"),
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
    return files("antenna_pin.report").joinpath("templates", name).read_text(encoding="utf-8")
