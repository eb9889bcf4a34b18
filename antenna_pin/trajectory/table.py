"""What motions come to, as files: labelled datasets beside runs, sealed as these are, told apart by a format.

A portrait, a section, a bifurcation diagram, an orbit, a branch of orbits, Lyapunov exponents, a fit, what
a test can tell, experiments beside one another and sensitivities are a dataset each. Their attributes say
what they are and what they came from: ``format``; ``title``, ``name`` and ``case`` of the scenario, and the
whole of it as JSON; the ``versions`` of what made them; and the ``command`` if it was one.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.files import absence, has_whole_seal, replacing
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory.file import write
from antenna_pin.trajectory.hdf5 import load_dataset, open_hdf5
from antenna_pin.trajectory.result import library_versions
from antenna_pin.trajectory.table_columns import problem_of_table

if TYPE_CHECKING:
    from antenna_pin.scenario import Scenario

__all__ = [
    "FORMATS",
    "KINDS",
    "TableKind",
    "format_of",
    "kind_of",
    "open_table",
    "save_table",
    "table_attributes",
]

TableKind = Literal[
    "portrait",
    "section",
    "bifurcation",
    "orbit",
    "branch",
    "exponents",
    "fit",
    "identifiability",
    "experiments",
    "sensitivity",
]
"""What a dataset is of."""

#: The format of each kind; another version of it is another format.
FORMATS: dict[TableKind, str] = {kind: f"antenna_pin {kind} 1" for kind in get_args(TableKind)}

#: What each kind is, in words.
KINDS: dict[TableKind, str] = {
    "portrait": "a phase portrait",
    "section": "a section",
    "bifurcation": "a bifurcation diagram",
    "orbit": "a periodic solution",
    "branch": "a branch of periodic solutions",
    "exponents": "Lyapunov exponents",
    "fit": "a fit to measured records",
    "identifiability": "what a test can tell",
    "experiments": "experiments beside one another",
    "sensitivity": "sensitivities",
}


def table_attributes(kind: TableKind, scenario: Scenario | None) -> dict[str, Any]:
    """Return the attributes that say what a dataset is, and what it came from.

    Args:
        kind: What it is of.
        scenario: What was run; None for a system built in Python.
    """
    return {
        "format": FORMATS[kind],
        "title": "" if scenario is None else scenario.title or scenario.name,
        "name": "" if scenario is None else scenario.name,
        "case": "" if scenario is None else scenario.case or "",
        "scenario": "" if scenario is None else scenario.model_dump_json(),
        "versions": json.dumps(library_versions()),
    }


def kind_of(data: xr.Dataset) -> TableKind | None:
    """Return what a dataset is of; None for one of another format."""
    found = data.attrs.get("format")
    return next((kind for kind, name in FORMATS.items() if name == found), None)


def format_of(path: str | os.PathLike[str]) -> str | None:
    """Return the format that a file says it has, "" if it says none; None where it cannot be read.

    Raises:
        FileFormatError: It refers to another file.
    """
    try:
        with open_hdf5(path) as file:
            found = file.attrs.get("format")
    except FileFormatError:
        raise
    except Exception:  # HDF5 raises any
        return None
    return found if isinstance(found, str) else ""


@takes()
def save_table(table: xr.Dataset, path: str | os.PathLike[str]) -> None:
    """Write a dataset to a file (NetCDF 4), whole or not at all.

    Raises:
        OutputError: It cannot be written there.
    """
    stored = table.copy()
    stored.attrs["coordinates"] = " ".join(str(name) for name in table.coords if name not in table.dims)
    with replacing(path) as partial:
        write(stored, partial)


def open_table(path: str | os.PathLike[str], kind: TableKind) -> xr.Dataset:
    """Return a dataset from its file.

    Args:
        path: The file, as :func:`save_table` wrote it.
        kind: What it is to be of.

    Raises:
        FileFormatError: It is of something else, or damaged, or not there.
    """
    file = Path(path)
    if not file.is_file():
        raise FileFormatError(f"{file}: {absence(file)}; it must be {KINDS[kind]} that antenna-pin wrote")
    try:
        whole = has_whole_seal(file)
        table = load_dataset(file)
    except FileFormatError:
        raise
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise FileFormatError(f"{file}: must be {KINDS[kind]}, got: {words}") from None
    found = table.attrs.get("format")
    if found != FORMATS[kind]:
        raise FileFormatError(f"{file}: must be {KINDS[kind]}, of format {FORMATS[kind]!r}, got {found!r}")
    if whole is not True:
        raise FileFormatError(
            f"{file}: must be as antenna-pin wrote it, got another checksum, or none: it was damaged, or "
            "edited in place; take another copy of it, or make it again"
        )
    problem = problem_of_table(table, kind)
    if problem is not None:
        raise FileFormatError(
            f"{file}: must be {KINDS[kind]} as antenna-pin writes it, got {problem}; make it again"
        )
    return table
