"""The runs that a report is about: what they are called, which of them is the ideal one."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import xarray as xr

from antenna_pin.analysis import blocks
from antenna_pin.errors import FileFormatError, InvalidParameterError
from antenna_pin.report._page import Details, Row, Statement, counts, quantities, shares_row
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
    names_along,
    open_table,
    series,
)
from antenna_pin.trajectory.columns import Variable
from antenna_pin.trajectory.quantities import slides_along

__all__ = [
    "Finding",
    "Judged",
    "Reported",
    "ReportedRun",
    "Run",
    "along",
    "every",
    "ideal_of",
    "labels_of",
    "origin",
    "parted",
    "reported",
    "row_of",
    "rows_along",
    "slides_in",
]


Run: TypeAlias = Trajectory | str | os.PathLike[str] | tuple[str, Trajectory]


@dataclass(frozen=True, slots=True, eq=False)
class ReportedRun:
    """A run as the report sees it.

    Attributes:
        label: Its name in tables and figures, unlike those of the others.
        run: What it is.
        file: Where it was read from; None for one that was given as an object.
    """

    label: str
    run: Trajectory
    file: Path | None = None

    @property
    def data(self) -> xr.Dataset:
        """The samples."""
        return self.run.data

    @property
    def ideal(self) -> bool:
        """Whether it has no contact, so that others are compared with it."""
        return self.data.sizes.get("contact", 0) == 0

    @property
    def samples(self) -> int:
        """How many samples it has."""
        return int(self.data.sizes["time"])

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return float(self.data["time"].values[-1])

    @property
    def conserved(self) -> dict[str, Any]:
        """How well it kept what is conserved."""
        found: dict[str, Any] = json.loads(self.data.attrs.get("conservation", "{}"))
        return found

    def names(self, dimension: str) -> list[str]:
        """Return the labels along a dimension; none if the run does not have it."""
        return names_along(self.data, dimension)

    def values(self, name: str) -> np.ndarray:
        """Return a variable as floats."""
        return np.asarray(self.data[name].values, dtype=float)


def reported(runs: Iterable[Run] | Run) -> list[ReportedRun]:
    """Return runs with labels that tell them apart: the case, or the file's name, or a number.

    Raises:
        InvalidParameterError: There is no run.
        FileFormatError: A file is not one of a run.
    """
    # A pair of a label and a run is one run, no list.
    one = isinstance(runs, Trajectory | str | os.PathLike) or _is_pair(runs)
    found: list[tuple[str, str, Trajectory, Path | None]] = []
    for number, entry in enumerate([runs] if one else runs, start=1):  # type: ignore[arg-type]
        if _is_pair(entry):
            found.append((str(entry[0]), "", entry[1], None))  # type: ignore[index, arg-type]
        elif isinstance(entry, Trajectory):
            found.append((str(entry.data.attrs.get("case") or f"run {number}"), "", entry, None))
        elif isinstance(entry, str | os.PathLike):
            path = Path(entry)
            run = Trajectory.load(path)
            found.append((str(run.data.attrs.get("case") or path.stem), path.stem, run, path))
        else:
            raise InvalidParameterError(
                "report", "runs", "trajectories or files of them", type(entry).__name__
            )
    if not found:
        raise InvalidParameterError("report", "runs", "at least one run", "none")
    first = [label for label, _, _, _ in found]
    if len(set(first)) < len(first):  # the same case twice: the files tell them apart
        first = [stem or label for label, stem, _, _ in found]
    result: list[ReportedRun] = []
    for (_, _, run, file), label in zip(found, first, strict=True):
        taken = {other.label for other in result}
        name, copy = label, 2
        while name in taken:
            name, copy = f"{label} ({copy})", copy + 1
        series(run.data, "report")
        result.append(ReportedRun(name, run, file))
    return result


def _is_pair(entry: object) -> bool:
    return (
        isinstance(entry, tuple) and len(entry) == 2 and isinstance(entry[0], str)
        and isinstance(entry[1], Trajectory)
    )  # fmt: skip


def ideal_of(runs: Sequence[ReportedRun]) -> ReportedRun | None:
    """Return the run that the others are compared with: the first without contact, if others have some."""
    ideals = [run for run in runs if run.ideal and run.samples > 1]
    return ideals[0] if ideals and len(runs) > 1 else None


def labels_of(runs: Sequence[ReportedRun]) -> tuple[str, ...]:
    """Return the labels of runs."""
    return tuple(run.label for run in runs)


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


# --- rows of quantities, by the catalogue ---


def every(runs: Sequence[ReportedRun], dimension: str) -> list[str]:
    """Return the labels along a dimension of any of the runs, each once."""
    return list(dict.fromkeys(name for run in runs for name in run.names(dimension)))


def slides_in(runs: Sequence[ReportedRun], dimension: str, name: str) -> bool:
    """Return whether what a label stands for slides, by the first of the runs that has it."""
    known = (slides_along(run.data, dimension) for run in runs)
    return next((one[name] for one in known if name in one), False)


def row_of(
    of: Variable,
    values: Sequence[float | None],
    slides: bool = False,
    scales: Mapping[str, float] | None = None,
) -> Row:
    """Return the row of a quantity.

    Args:
        of: The quantity.
        values: One per column, in the SI unit; what is None or not finite is a dash.
        slides: Whether what it belongs to slides.
        scales: Of the runs, by which numbers may be zero to round-off; none is if not given.
    """
    known = [None if value is None or not np.isfinite(value) else value for value in values]
    if of.form == "count":
        return counts(of.words(slides), (None if value is None else int(value) for value in known))
    if of.form == "share":
        return shares_row(of.words(slides), known)
    return quantities(of.words(slides), known, of.unit(slides), of.digits, None if of.exact else scales)


def rows_along(
    runs: Sequence[ReportedRun],
    dimension: str,
    name: str,
    tables: Sequence[xr.Dataset],
    variables: Iterable[Variable],
    scales: Mapping[str, float] | None,
) -> Iterator[Row]:
    """Yield a row for each quantity of one label along a dimension.

    Args:
        runs: The runs, columns of the table.
        dimension: The dimension.
        name: The label.
        tables: Of each run the data, or a table that follows from them.
        variables: The quantities; those that no table has are reduced from series of the data.
        scales: As for :func:`row_of`.
    """
    slides = slides_in(runs, dimension, name)
    for one in variables:
        yield row_of(one, [_value(table, dimension, name, one) for table in tables], slides, scales)


def along(
    runs: Sequence[ReportedRun],
    dimension: str,
    tables: Sequence[xr.Dataset],
    variables: Iterable[Variable],
    scales: Mapping[str, float] | None,
    heading: Callable[[str], str],
) -> Iterator[Row]:
    """Yield the rows of all labels along a dimension, each group under its heading (:func:`rows_along`)."""
    known = list(variables)
    for name in every(runs, dimension):
        yield Row(heading(name))
        yield from rows_along(runs, dimension, name, tables, known, scales)


def _value(table: xr.Dataset, dimension: str, name: str, of: Variable) -> float | None:
    """Return the size of a vector or a number; None where there is none."""
    if name not in names_along(table, dimension):
        return None
    if of.name in table:
        values = np.asarray(table[of.name].sel({dimension: name}).values, dtype=float)
        return float(np.linalg.norm(values)) if values.ndim else float(values)
    if of.reduced is None or of.reduced.of not in table:
        return None
    if of.reduced.by == "end":
        return float(table[of.reduced.of].sel({dimension: name})[-1])
    parts = (part[of.reduced.of].sel({dimension: name}).values for part in blocks(table))
    return max(float(np.nanmax(np.abs(part), initial=0.0)) for part in parts)
