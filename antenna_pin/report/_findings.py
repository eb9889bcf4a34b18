"""What a report is about beside runs: portraits, sections, diagrams, orbits, exponents, fits, tests."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import xarray as xr

from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.report._page import Details, Statement
from antenna_pin.report._runs import Run
from antenna_pin.scenario import Scenario, scenario_toml
from antenna_pin.trajectory import (
    FORMAT,
    FORMATS,
    KINDS,
    TableKind,
    Trajectory,
    format_of,
    kind_of,
    library_versions,
    open_table,
)

__all__ = ["Finding", "Judged", "Reported", "origin", "parted"]

Reported: TypeAlias = Run | xr.Dataset
"""What a report takes: runs, and the datasets of what motions come to."""


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """A dataset of what a motion comes to, as the report sees it.

    Attributes:
        label: Its name, unlike those of others.
        kind: What it is of.
        table: The dataset.
        file: Where it was read from; None for one that was given as an object.
    """

    label: str
    kind: TableKind
    table: xr.Dataset
    file: Path | None = None


@dataclass(frozen=True, slots=True)
class Judged:
    """What a finding comes to, for the page's head.

    Attributes:
        label: Of the finding.
        completed: Whether it says what it was made for.
        outcome: In a word or two.
        text: In a line.
    """

    label: str
    completed: bool
    outcome: str
    text: str


def parted(given: Iterable[Reported] | Reported) -> tuple[list[Run], list[Finding]]:
    """Return the runs among what is given, not yet read, and the rest.

    Raises:
        FileFormatError: A file is neither that of a run nor one of these datasets.
        InvalidParameterError: A dataset is none of these.
    """
    single = isinstance(given, Trajectory | xr.Dataset | str | os.PathLike) or (
        isinstance(given, tuple) and len(given) == 2 and isinstance(given[1], Trajectory)
    )
    runs: list[Run] = []
    found: list[Finding] = []
    entries: list[Any] = [given] if single else list(given)  # type: ignore[arg-type]
    for entry in entries:
        if isinstance(entry, xr.Dataset):
            kind = kind_of(entry)
            if kind is None:
                rule = f"datasets of {_either()}, or runs"
                raise InvalidParameterError("report", "runs", rule, said=repr(entry.attrs.get("format")))
            found.append(Finding(_free(str(entry.attrs.get("case") or kind), found), kind, entry))
        elif isinstance(entry, str | os.PathLike):
            path = Path(entry)
            kind = _kind_in(path)
            if kind is None:
                runs.append(entry)
            else:
                found.append(Finding(_free(path.stem, found), kind, open_table(path, kind), path))
        else:
            runs.append(entry)
    return runs, found


def _kind_in(path: Path) -> TableKind | None:
    """Return what a file is of; None for one of a run, and for one whose reader will say what is wrong."""
    said = format_of(path)
    if said is None or said.startswith(FORMAT.rpartition(" ")[0]):
        return None
    kind = next((kind for kind, name in FORMATS.items() if name == said), None)
    if kind is None:
        raise FileFormatError(
            f"{path}: must be a run, {_either()}, as antenna-pin of this version writes them, got "
            + (f"format {said!r}" if said else "a file without a format")
        )
    return kind


def _either() -> str:
    *most, last = KINDS.values()
    return f"{', '.join(most)} or {last}"


def _free(label: str, others: Sequence[Finding]) -> str:
    taken, name, copy = {one.label for one in others}, label, 2
    while name in taken:
        name, copy = f"{label} ({copy})", copy + 1
    return name


def origin(finding: Finding, shown: set[str]) -> tuple[tuple[Statement, ...], tuple[Details, ...]]:
    """Return where a finding comes from: its command, file, versions, and its scenario in full.

    Args:
        finding: The finding.
        shown: Scenarios that the page has already, as their files would be; this one's is added.
    """
    attributes = finding.table.attrs
    statements = []

    def say(label: str, text: str, code: bool = False) -> None:
        if text:
            statements.append(Statement(label=label, texts=(((), text),), code=code))

    scenario = _scenario(attributes)
    said = ""
    if scenario is not None:
        parts = [f"case {scenario.case}" if scenario.case else "", *scenario.overrides]
        said = ", ".join([f"{scenario.name}: {scenario.title}", *filter(None, parts)])
    say("scenario", said or "a system built in Python")
    command = str(attributes.get("command") or "")
    say("repeat it", command or "made in Python: run its script again", code=bool(command))
    say("file", "" if finding.file is None else str(finding.file), code=True)
    versions = json.loads(str(attributes.get("versions") or "{}"))
    same = versions == library_versions()
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    say("versions", "those of this report" if same else listed)
    text = "" if scenario is None else scenario_toml(scenario)
    if not text or text in shown:
        return tuple(statements), ()
    shown.add(text)
    return tuple(statements), (Details(title=f"Scenario of {finding.label}", text=text, key="scenario"),)


def _scenario(attributes: dict[Any, Any]) -> Scenario | None:
    text = str(attributes.get("scenario") or "")
    return Scenario.model_validate_json(text) if text else None
