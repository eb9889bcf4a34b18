"""Columns of a measured record from its file, of any of some formats. What is no number in it is NaN here."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.files import absence
from antenna_pin.base.units import unit_factor
from antenna_pin.errors import ScenarioError, UnknownNameError
from antenna_pin.fit.layout import LayoutSpec
from antenna_pin.fit.mat_file import BadMatFileError, Mat73Error, read_mat
from antenna_pin.fit.text_record import from_text
from antenna_pin.fit.uff_record import from_universal
from antenna_pin.trajectory.hdf5 import load_dataset, open_hdf5

__all__ = ["SUFFIXES", "Columns", "read_columns"]

Array = NDArray[np.float64]

#: What the names of records may end in: of texts, of others.
_TEXTS, _UNIVERSAL = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm"), (".uff", ".unv", ".uf", ".bunv")
SUFFIXES = (*_TEXTS, ".nc", ".mat", *_UNIVERSAL)
_OF_TEXTS = ("delimiter", "decimal", "encoding", "comment", "skip", "names", "units_row", "time_format")
_SHOWN = 12  # names that a message offers
_NO_NUMBERS = (b"char", b"cell", b"string", b"function_handle")  # what MATLAB's arrays are of


class Columns(NamedTuple):
    """What of a record stands in its file.

    Attributes:
        time: Of the rows, by the file's clock, (rows,) [s].
        values: Of the columns by their names in the file, (rows,), in the file's units.
        units: Those that the file gives of them.
    """

    time: Array
    values: dict[str, Array]
    units: dict[str, str]


def read_columns(path: Path, names: Sequence[str], layout: LayoutSpec, place: str) -> Columns:
    """Return times and columns of a record's file, all of one length.

    Args:
        path: The file.
        names: Of the columns that are wanted beside the times.
        layout: How the file is laid out.
        place: Where the file is named, for messages.

    Raises:
        ScenarioError: It is not there, or cannot be read, or a column holds what is no number.
        UnknownNameError: It has no such column.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise ScenarioError(f"{place}.file must end in {', '.join(SUFFIXES)}, got {path.name!r}")
    if not path.is_file():
        raise ScenarioError(f"{place}.file: {path}: {absence(path)}; paths start at the fit file's folder")
    clock = [] if layout.rate is not None else [layout.time]
    wanted = list(dict.fromkeys([*clock, *names]))
    kind = path.suffix.lower()
    if kind not in _TEXTS:
        for name in _OF_TEXTS:
            if getattr(layout, name) != LayoutSpec.model_fields[name].default:
                raise ScenarioError(f"{place}.{name} must be left out for {path.name}, which is no text")
    if kind == ".nc":
        found, units = _from_netcdf(path, wanted, layout, place)
    elif kind == ".mat":
        found, units = _from_mat(path, wanted, place), {}
    elif kind in _UNIVERSAL:
        found, units = from_universal(path, wanted, layout.time, place)
    else:
        found, units = from_text(path, wanted, layout, place)
    lengths = {name: len(values) for name, values in found.items()}
    first = wanted[0]
    for name, length in lengths.items():
        if length != lengths[first]:
            rule = f"must have as many rows as {first}, {lengths[first]}, got {length}"
            raise ScenarioError(f"{place}: {path.name}: {name} {rule}")
    if lengths[first] < 2:
        raise ScenarioError(f"{place}: {path.name} must have 2 rows at least, got {lengths[first]}")
    if layout.rate is not None:
        time = np.arange(lengths[first]) / layout.rate
    elif layout.time_format is not None:
        time = found[layout.time]
    else:
        unit = layout.time_unit or units.get(layout.time) or "s"
        time = found[layout.time] * unit_factor(unit, "s", f"{place}.time_unit")
    return Columns(time, {name: found[name] for name in names}, units)


def _known(path: Path, name: str, known: Iterable[str], place: str) -> None:
    """Refuse a column that a file does not have."""
    names = [str(one) for one in known]
    if name not in names:
        if name == LayoutSpec.model_fields["time"].default:
            has = ", ".join(names[:_SHOWN]) or "none at all"
            raise ScenarioError(
                f"{place}: {path.name} must have a column of times, got no {name!r} but {has}; give "
                "time, the name of theirs, or rate, how many rows a second has"
            )
        raise UnknownNameError(f"{place}: {path.name}", "column", name, names[:_SHOWN])


def _from_netcdf(
    path: Path, names: Sequence[str], layout: LayoutSpec, place: str
) -> tuple[dict[str, Array], dict[str, str]]:
    """Return columns, and the units that their attributes give; of dates the seconds since the first."""
    try:
        data = load_dataset(path)
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise ScenarioError(f"{place}: {path.name} cannot be read as NetCDF 4: {words}") from None
    found, units = {}, {}
    for name in names:
        _known(path, name, [str(one) for one in data.variables if data[one].ndim == 1], place)
        values = data[name].values
        if name == layout.time and values.dtype.kind in "Mm":
            values = (values - values[:1]) / np.timedelta64(1, "s") if len(values) else np.zeros(0)
            units[name] = "s"
        elif isinstance(data[name].attrs.get("units"), str):
            units[name] = data[name].attrs["units"]
        found[name] = _numbers(path, name, values, place)
    return found, units


def _from_mat(path: Path, names: Sequence[str], place: str) -> dict[str, Array]:
    """Return arrays of a MAT file; of a structure its fields, as ``structure.field``."""
    try:
        content = read_mat(path)
    except Mat73Error:
        arrays = _arrays_of_hdf5(path, place)
    except BadMatFileError as error:
        raise ScenarioError(f"{place}: {path.name} cannot be read as a MAT file: {error}") from None
    else:
        arrays = _arrays(content)
    found = {}
    for name in names:
        _known(path, name, [one for one, array in arrays.items() if array.ndim == 1], place)
        found[name] = _numbers(path, name, arrays[name], place)
    return found


def _arrays(content: dict[str, Any]) -> dict[str, Any]:
    arrays: dict[str, Any] = {}
    for name, value in content.items():
        if name.startswith("__"):
            continue
        array = np.asarray(value)
        if array.dtype.names is None:
            arrays[name] = array
        elif array.ndim == 0:  # a structure; of an array of them no field is a column
            fields = {field: array[field].item() for field in array.dtype.names}
            arrays |= {f"{name}.{one}": inner for one, inner in _arrays(fields).items()}
    return arrays


def _arrays_of_hdf5(path: Path, place: str) -> dict[str, Any]:
    """Return arrays of numbers of a MAT file of version 7.3, in which a vector has two dimensions."""
    arrays: dict[str, Any] = {}
    try:
        with open_hdf5(path) as file:
            for name, one in _leaves(file, set()):
                if one.attrs.get("MATLAB_class", b"double") in _NO_NUMBERS:
                    continue
                array = np.squeeze(np.asarray(one[()]))
                if one.attrs.get("MATLAB_empty", 0) or array.dtype.kind not in "fiub":
                    continue
                arrays[name] = array
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise ScenarioError(f"{place}: {path.name} cannot be read as a MAT file: {words}") from None
    return arrays


def _leaves(group: Any, seen: set[Any]) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of an HDF5 file by their names, with points between those of structures.

    Raises:
        ValueError: A group stands in it twice: in a circle, or so that names double with each level.
    """
    if group.id in seen:  # equal where they are the same object
        raise ValueError(f"group {group.name} stands elsewhere in it, too")
    seen.add(group.id)
    for name, item in group.items():
        if name.startswith("#"):  # what cells refer to
            continue
        if hasattr(item, "items"):
            yield from ((f"{name}.{inner}", one) for inner, one in _leaves(item, seen))
        elif hasattr(item, "dtype"):
            yield name, item


def _numbers(path: Path, name: str, values: Any, place: str) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise ScenarioError(f"{place}: {path.name}: {name} must be numbers, got {array.dtype}")
    return array.astype(float)
