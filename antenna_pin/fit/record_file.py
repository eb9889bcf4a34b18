"""Columns of a measured record from its file: CSV, NetCDF or MAT. What is no number in it is NaN here."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.files import absence
from antenna_pin.numerals import decimal_in
from antenna_pin.trajectory.hdf5 import load_dataset
from antenna_pin.units import shown

__all__ = ["SUFFIXES", "read_columns"]

Array = NDArray[np.float64]

#: What the names of records may end in.
SUFFIXES = (".csv", ".txt", ".nc", ".mat")
# Cells that say that there is no number, as spreadsheets and recorders write them.
_NO_NUMBER = frozenset({"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-", "#n/a"})
_SHOWN = 12  # names that a message offers


def read_columns(path: Path, names: Sequence[str], delimiter: str, place: str) -> dict[str, Array]:
    """Return columns of a record's file by name, all of one length.

    Args:
        path: The file.
        names: Of the columns that are wanted.
        delimiter: Between columns of a text.
        place: Where the file is named, for messages.

    Raises:
        ScenarioError: It is not there, or cannot be read, or a column holds what is no number.
        UnknownNameError: It has no such column.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise ScenarioError(f"{place}.file must end in {', '.join(SUFFIXES)}, got {path.name!r}")
    if not path.is_file():
        raise ScenarioError(f"{place}.file: {path}: {absence(path)}; paths start at the fit file's folder")
    readers = {".nc": _from_netcdf, ".mat": _from_mat}
    reader = readers.get(path.suffix.lower())
    found = _from_text(path, names, delimiter, place) if reader is None else reader(path, names, place)
    lengths = {name: len(values) for name, values in found.items()}
    first = names[0]
    for name, length in lengths.items():
        if length != lengths[first]:
            rule = f"must have as many rows as {first}, {lengths[first]}, got {length}"
            raise ScenarioError(f"{place}: {path.name}: {name} {rule}")
    if lengths[first] < 2:
        raise ScenarioError(f"{place}: {path.name} must have 2 rows at least, got {lengths[first]}")
    return found


def _known(path: Path, name: str, known: Iterable[str], place: str) -> None:
    """Refuse a column that a file does not have."""
    names = [str(one) for one in known]
    if name not in names:
        raise UnknownNameError(f"{place}: {path.name}", "column", name, names[:_SHOWN])


def _from_text(path: Path, names: Sequence[str], delimiter: str, place: str) -> dict[str, Array]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise ScenarioError(f"{place}: {path.name} is not UTF-8 text (byte {error.start})") from None
    except OSError as error:
        raise ScenarioError(f"{place}: {path.name} cannot be read: {error.strerror}") from None
    rows = csv.reader(text.splitlines(), delimiter=delimiter, skipinitialspace=True)
    header: list[str] | None = None
    columns: dict[str, list[float]] = {name: [] for name in names}
    places: list[int] = []
    try:
        for row in rows:
            if not row or row[0].lstrip().startswith("#"):
                continue
            if header is None:
                header = [cell.strip() for cell in row]
                for name in names:
                    _known(path, name, header, place)
                places = [header.index(name) for name in names]
                continue
            line = f"{place}: {path.name}: line {rows.line_num}"
            if len(row) != len(header):
                raise ScenarioError(f"{line} must have {len(header)} values, got {len(row)}")
            for name, at in zip(names, places, strict=True):
                columns[name].append(_cell(row[at], name, line))
    except csv.Error as error:
        raise ScenarioError(f"{place}: {path.name}: line {rows.line_num}: {error}") from None
    if header is None:
        raise ScenarioError(f"{place}: {path.name} must have a header with {', '.join(names)}, got nothing")
    return {name: np.array(values) for name, values in columns.items()}


def _cell(cell: str, name: str, line: str) -> float:
    number = decimal_in(cell)
    if number is not None:
        return number
    if cell.strip().lower() in _NO_NUMBER:
        return float("nan")
    hint = "; write a decimal point" if cell.count(",") == 1 else ""
    raise ScenarioError(f"{line}: {name} must be a number, got {shown(cell.strip())}{hint}")


def _from_netcdf(path: Path, names: Sequence[str], place: str) -> dict[str, Array]:
    try:
        data = load_dataset(path)
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise ScenarioError(f"{place}: {path.name} cannot be read as NetCDF 4: {words}") from None
    found = {}
    for name in names:
        _known(path, name, [str(one) for one in data.variables if data[one].ndim == 1], place)
        found[name] = _numbers(path, name, data[name].values, place)
    return found


def _from_mat(path: Path, names: Sequence[str], place: str) -> dict[str, Array]:
    """Return arrays of a MAT file up to version 7.2; of a structure its fields, as ``structure.field``."""
    from scipy.io import loadmat

    try:
        content = loadmat(path, squeeze_me=True, struct_as_record=True)
    except NotImplementedError:
        raise ScenarioError(
            f"{place}: {path.name} must be a MAT file up to version 7.2, got 7.3 (HDF5); save it with -v7"
        ) from None
    except Exception as error:  # the reader raises any on a damaged file
        words = " ".join(str(error).split())
        raise ScenarioError(f"{place}: {path.name} cannot be read as a MAT file: {words}") from None
    arrays: dict[str, Any] = {}
    for name, value in content.items():
        if name.startswith("__"):
            continue
        array = np.asarray(value)
        if array.dtype.names:
            arrays |= {f"{name}.{field}": np.asarray(array[field].item()) for field in array.dtype.names}
        else:
            arrays[name] = array
    found = {}
    for name in names:
        _known(path, name, [one for one, array in arrays.items() if array.ndim == 1], place)
        found[name] = _numbers(path, name, arrays[name], place)
    return found


def _numbers(path: Path, name: str, values: Any, place: str) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise ScenarioError(f"{place}: {path.name}: {name} must be numbers, got {array.dtype}")
    return array.astype(float)
