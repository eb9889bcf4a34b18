"""Runs and findings of a report: labels, origin, rows of their quantities."""

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
from antenna_pin.scenario import Scenario, scenario_toml
from antenna_pin.show.report._page import (
    Details,
    PageTable,
    Row,
    Statement,
    counts,
    quantities,
    shares_row,
    statement,
)
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

Run: TypeAlias = Trajectory | str | os.PathLike[str] | tuple[str, Trajectory]


@dataclass(frozen=True, slots=True, eq=False)
class ReportedRun:
    """Run of a report."""

    label: str  # in tables and figures, unlike those of the others
    run: Trajectory
    file: Path | None = None  # None for a run that was passed as an object

    @property
    def data(self) -> xr.Dataset:
        """The samples."""
        return self.run.data

    @property
    def ideal(self) -> bool:
        """Return whether the run has no contact, so that others are compared with it."""
        return self.data.sizes.get("contact", 0) == 0

    @property
    def samples(self) -> int:
        """Return the number of samples."""
        return int(self.data.sizes["time"])

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return float(self.data["time"].values[-1])

    @property
    def conserved(self) -> dict[str, Any]:
        """Return the errors of energy and momentum."""
        found: dict[str, Any] = json.loads(self.data.attrs.get("conservation", "{}"))
        return found

    def names(self, dimension: str) -> list[str]:
        """Return the labels along a dimension; none if the run does not have it."""
        return names_along(self.data, dimension)

    def values(self, name: str) -> np.ndarray:
        """Return a variable as floats."""
        return np.asarray(self.data[name].values, dtype=float)


def reported(runs: Iterable[Run] | Run) -> list[ReportedRun]:
    """Return runs with distinct labels: the case, the file's name, or a number.

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
        series(run.data, "report")
        result.append(ReportedRun(_free(label, result), run, file))
    return result


def _is_pair(entry: object) -> bool:
    return (
        isinstance(entry, tuple) and len(entry) == 2 and isinstance(entry[0], str)
        and isinstance(entry[1], Trajectory)
    )  # fmt: skip


def ideal_of(runs: Sequence[ReportedRun]) -> ReportedRun | None:
    """Return the reference run: the first without contact, if others have some."""
    ideals = [run for run in runs if run.ideal and run.samples > 1]
    return ideals[0] if ideals and len(runs) > 1 else None


def run_table(runs: Sequence[ReportedRun], rows: Iterable[Row], caption: str, key: str) -> PageTable:
    """Return a table with a column for each run."""
    return PageTable(columns=("", *labels_of(runs)), rows=tuple(rows), caption=caption, key=key)


def labels_of(runs: Sequence[ReportedRun]) -> tuple[str, ...]:
    """Return the labels of runs."""
    return tuple(run.label for run in runs)


Reported: TypeAlias = Run | xr.Dataset
"""Contents of a report: runs, and datasets of findings."""


@dataclass(frozen=True, slots=True, eq=False)
class Finding:
    """Dataset of a motion's analysis or of a fit, in a report."""

    label: str  # unlike those of others
    kind: TableKind
    table: xr.Dataset
    file: Path | None = None  # None for a dataset that was passed as an object


def parted(entries: Iterable[Reported] | Reported) -> tuple[list[Run], list[Finding]]:
    """Return the runs among what is given, not yet read, and the rest.

    Raises:
        FileFormatError: A file is neither that of a run nor one of these datasets.
        InvalidParameterError: A dataset is none of these.
    """
    single = isinstance(entries, Trajectory | xr.Dataset | str | os.PathLike) or _is_pair(entries)
    runs: list[Run] = []
    found: list[Finding] = []
    several: list[Any] = [entries] if single else list(entries)  # type: ignore[arg-type]
    for entry in several:
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
    """Return the kind of a file's dataset; None for a run."""
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


def _free(label: str, others: Sequence[Finding | ReportedRun]) -> str:
    """Return a label that no other has."""
    taken, name, copy = {one.label for one in others}, label, 2
    while name in taken:
        name, copy = f"{label} ({copy})", copy + 1
    return name


def origin(finding: Finding, shown: set[str]) -> tuple[tuple[Statement, ...], tuple[Details, ...]]:
    """Return a finding's scenario, command, file and versions.

    ``shown`` has the texts of scenarios that the page contains already; this one's is added.
    """
    attributes = finding.table.attrs
    scenario = _scenario(attributes)
    said = ""
    if scenario is not None:
        parts = [f"case {scenario.case}" if scenario.case else "", *scenario.overrides]
        said = ", ".join([f"{scenario.name}: {scenario.title}", *filter(None, parts)])
    command = str(attributes.get("command") or "")
    versions = json.loads(str(attributes.get("versions") or "{}"))
    same = versions == library_versions()
    listed = ", ".join(f"{name} {version}" for name, version in versions.items())
    every = (
        statement("scenario", said or "a system built in Python"),
        statement("repeat it", command or "built in Python: run its script again", bool(command)),
        statement("file", "" if finding.file is None else str(finding.file), True),
        statement("versions", "those of this report" if same else listed),
    )
    statements = tuple(one for one in every if one.texts[0][1])
    text = "" if scenario is None else scenario_toml(scenario)
    if not text or text in shown:
        return statements, ()
    shown.add(text)
    return statements, (Details(title=f"Scenario of {finding.label}", text=text, key="scenario"),)


def _scenario(attributes: dict[Any, Any]) -> Scenario | None:
    text = str(attributes.get("scenario") or "")
    return Scenario.model_validate_json(text) if text else None


# --- rows of quantities, by the catalogue ---


def every(runs: Sequence[ReportedRun], dimension: str) -> list[str]:
    """Return the labels along a dimension of any of the runs, each once."""
    return list(dict.fromkeys(name for run in runs for name in run.names(dimension)))


def slides_in(runs: Sequence[ReportedRun], dimension: str, name: str) -> bool:
    """Return whether a label's element slides, by the first run that has it."""
    known = (slides_along(run.data, dimension) for run in runs)
    return next((one[name] for one in known if name in one), False)


def row_of(
    of: Variable,
    values: Sequence[float | None],
    slides: bool = False,
    scales: Mapping[str, float] | None = None,
) -> Row:
    """Return the row of a quantity; arguments as for :func:`antenna_pin.show.report._page.quantities`."""
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

    ``tables`` are the runs' data, or derived from them. Quantities that no table has are reduced from series.
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
    """Yield the rows of all labels along a dimension under their headings (:func:`rows_along`)."""
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
