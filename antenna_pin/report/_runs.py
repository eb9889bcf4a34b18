"""The runs that a report is about: what they are called, which of them is the ideal one."""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import xarray as xr

from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import Trajectory, names_along, series

__all__ = ["ReportedRun", "Run", "ideal_of", "labels_of", "reported"]

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
