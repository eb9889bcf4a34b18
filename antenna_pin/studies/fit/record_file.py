"""Columns of a measured record from files of several formats; NaN for missing numbers."""

from __future__ import annotations

import contextlib
import datetime
import faulthandler
import importlib
import json
import multiprocessing
import os
import re
import resource
import signal
import sys
import warnings
from collections.abc import Iterable, Iterator, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from antenna_pin.base.arrays import Array
from antenna_pin.base.capacity import free_memory
from antenna_pin.base.files import absence, marked_encoding
from antenna_pin.base.readable import decimal_in
from antenna_pin.base.tables import BadTableError, TextLayout, UnknownColumnError, hint, read_cells
from antenna_pin.base.units import shown, unit_factor
from antenna_pin.errors import MissingToolError, ScenarioError, UnknownNameError
from antenna_pin.studies.fit.specs import LayoutSpec
from antenna_pin.trajectory.file import load_dataset, open_hdf5

# --- text files ---------------------------------------------------------------------------------------------

# Cells without a number, as spreadsheets and recorders write them.
_NO_NUMBER = frozenset({"", "nan", "na", "n/a", "null", "none", "inf", "-inf", "+inf", "-", "#n/a"})
_OF_TEXT = ("delimiter", "decimal", "comment", "skip", "names", "units_row")
_SHOWN = 12  # names that a message offers
_LOOKED_AT = 200  # lines in which column names are looked for, to say where they are
# Seconds of a stamp and their decimals: Python's own parser stops at microseconds.
_STAMP_SECONDS = re.compile(r"(:[0-9]{2})[.,]([0-9]+)")


def _from_text(
    path: Path, names: Sequence[str], layout: LayoutSpec, place: str
) -> tuple[dict[str, Array], dict[str, str]]:
    """Return columns of a text by name, (rows,) each, and their units."""
    text, where = _text(path, layout, place), f"{place}: {path.name}"
    known = {name: getattr(layout, name) for name in _OF_TEXT}
    try:
        cells = read_cells(text, names, TextLayout(holes=True, **known), headless=False)
    except UnknownColumnError as error:
        if not error.known:
            raise ScenarioError(f"{where} must have a header with {', '.join(names)}, got nothing") from None
        if layout.names is None:
            _refuse_misplaced_header(names, error.line, text.splitlines(), layout, where)
        shown_names = [one for one in error.known if one][:_SHOWN]
        raise UnknownNameError(where, "column", error.name, shown_names) from None
    except BadTableError as error:
        raise ScenarioError(f"{where}: {error}") from None
    columns: dict[str, list[float]] = {name: [] for name in names}
    first: tuple[datetime.datetime, float] | None = None
    for name, column in columns.items():
        for line, cell in zip(cells.lines, cells.text[name], strict=True):
            at = f"{where}: line {line}"
            if layout.time_format is not None and name == layout.time:
                stamp = _stamp(cell, name, layout.time_format, at)
                first = first or stamp
                column.append(_seconds_after(stamp, first, at))
            else:
                column.append(_number(cell, name, not column, at))
    return {name: np.array(values, dtype=float) for name, values in columns.items()}, cells.units


def _text(path: Path, layout: LayoutSpec, place: str) -> str:
    is_utf_8 = layout.encoding.lower().replace("_", "-") in ("utf-8", "utf8")
    try:
        data = path.read_bytes()
        return data.decode((marked_encoding(data) if is_utf_8 else None) or layout.encoding)
    except UnicodeError as error:
        said = "UTF-8" if is_utf_8 else layout.encoding
        byte = f" (byte {error.start})" if isinstance(error, UnicodeDecodeError) else ""
        way = 'give encoding = "latin-1", "utf-16" or what it is in'
        raise ScenarioError(f"{place}: {path.name} is not {said} text{byte}; {way}") from None
    except OSError as error:
        raise ScenarioError(f"{place}: {path.name} cannot be read: {error.strerror}") from None


def _refuse_misplaced_header(
    names: Sequence[str], head: int, lines: list[str], layout: LayoutSpec, where: str
) -> None:
    """Refuse a text whose column names are in another line, with its number."""
    for k, line in enumerate(lines[:_LOOKED_AT], 1):
        bare = line.strip().removeprefix(layout.comment)
        for delimiter in dict.fromkeys((*([layout.delimiter] if layout.delimiter else []), ";", "\t", ",")):
            cells = [cell.strip().strip('"') for cell in bare.split(delimiter)]
            if not set(cells).issuperset(names):
                continue
            ways = [] if delimiter == layout.delimiter else [f"delimiter = {json.dumps(delimiter)}"]
            if bare != line.strip():
                ways.append(f"names = {json.dumps(cells, ensure_ascii=False)}")
            elif k != head:
                ways.append(f"skip = {k - 1}")
            rule = "the names of columns must be in the first line that counts"
            raise ScenarioError(
                f"{where}: {rule}, got {', '.join(names)} in line {k}; give {' and '.join(ways)}"
            )


def _number(cell: str, name: str, is_first: bool, line: str) -> float:
    number = decimal_in(cell)
    if number is not None:
        return number
    if cell.strip().lower() in _NO_NUMBER:
        return float("nan")
    way = hint(cell) or ("; if it is a unit, give units_row = true" if is_first else "")
    raise ScenarioError(f"{line}: {name} must be a number, got {shown(cell)}{way}")


def _stamp(cell: str, name: str, pattern: str, line: str) -> tuple[datetime.datetime, float]:
    """Return a stamp to the second, and the rest [s]."""
    word, rest = cell.strip(), 0.0
    found = _STAMP_SECONDS.search(word)
    if found is not None:
        rest = float(f"0.{found[2]}")
        word = word[: found.end(1)] + word[found.end() :]
    plain = re.sub(r"[.,]%f", "", pattern)
    try:
        if pattern == "iso":
            return datetime.datetime.fromisoformat(word), rest
        return datetime.datetime.strptime(word, plain), rest
    except ValueError:
        rule = "ISO 8601" if pattern == "iso" else pattern
        said = f"{name} must be a time stamp of the time_format {rule}"
        raise ScenarioError(f"{line}: {said}, got {shown(cell.strip())}") from None


def _seconds_after(
    stamp: tuple[datetime.datetime, float], origin: tuple[datetime.datetime, float], line: str
) -> float:
    if (stamp[0].tzinfo is None) != (origin[0].tzinfo is None):
        raise ScenarioError(f"{line}: time stamps must all have a time zone, or none, got both")
    return (stamp[0] - origin[0]).total_seconds() + (stamp[1] - origin[1])


# --- universal files, an exchange format of vibration tests -------------------------------------------------
#
# Its sets of number 58 are functions at degrees of freedom of nodes. Those of time are columns, each called
# by its node and direction, as ``12X+`` and ``12RZ-``; 0 is a scalar, ``12``.

_AXES = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_FUNCTION, _UNITS, _OF_TIME = 58, 164, 1  # kinds of sets; of functions the kind that goes over time
_OF_SI = 1  # code of units, of sets of these


def _from_universal(
    path: Path, names: Sequence[str], time: str, place: str
) -> tuple[dict[str, Array], dict[str, str]]:
    """Return columns of a universal file by name, (rows,) each, and their units."""
    sets, foreign = _sets(path, place)
    where = f"{place}: {path.name}"
    found: dict[str, Array] = {}
    units: dict[str, str] = {}
    known: dict[str, list[int]] = {}
    for number, one in sets.items():
        known.setdefault(_name(one), []).append(number)
    first = None
    for name in (one for one in names if one != time):
        if name not in known:
            raise UnknownNameError(where, "column", name, list(known)[:_SHOWN])
        if len(known[name]) > 1:
            numbers = " and ".join(map(str, known[name]))
            raise ScenarioError(
                f"{where}: {name} must be one function of time, got sets {numbers}; give a file "
                "with one of them"
            )
        (number,) = known[name]
        one = sets[number]
        values = np.asarray(one["data"])
        if np.iscomplexobj(values):
            raise ScenarioError(f"{where}: {name} must be real numbers, got complex ones in set {number}")
        found[name] = values.astype(float)
        units[name] = _unit(one, "ordinate") or foreign
        times = np.asarray(one["x"], dtype=float)
        first = first or (name, times)
        if not np.array_equal(times, first[1]):
            raise ScenarioError(
                f"{where}: {name} must have the times of {first[0]}, got others in set {number}; make it a "
                f"separate record"
            )
        if time in names:
            found[time], units[time] = times, _unit(one, "abscissa")
    return found, {name: unit for name, unit in units.items() if unit}


def _sets(path: Path, place: str) -> tuple[dict[int, Any], str]:
    """Return the functions of time by their numbers, and the file's default unit."""
    try:
        pyuff = importlib.import_module("pyuff")
    except ImportError:
        raise MissingToolError(
            f"{place}: {path.name}: a universal file needs pyuff; install it with pip install "
            "'antenna-pin[fit]'"
        ) from None
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of fields it does not know, which are none of these
            file = pyuff.UFF(str(path))
            kinds = [int(one) for one in file.get_set_types()]
            wanted = [k for k, kind in enumerate(kinds) if kind in (_FUNCTION, _UNITS)]
            read = {k + 1: file.read_sets(k) for k in wanted}
    except Exception as error:  # the reader raises any on a damaged file
        words = " ".join(str(error).split())
        raise ScenarioError(f"{place}: {path.name} cannot be read as a universal file: {words}") from None
    codes = [int(one["units_code"]) for one in read.values() if int(one["type"]) == _UNITS]
    foreign = "" if set(codes) <= {_OF_SI} else f"of code {codes[-1]}"
    functions = {
        number: one
        for number, one in read.items()
        if int(one["type"]) == _FUNCTION and int(one["func_type"]) == _OF_TIME
    }
    if not functions:
        rule = "must hold a function of time (58, time response)"
        raise ScenarioError(
            f"{place}: {path.name} {rule}, got sets of {', '.join(map(str, sorted(set(kinds)))) or 'none'}"
        )
    return functions, foreign


def _name(function: Any) -> str:
    """Return the name of a function."""
    node, way = int(function["rsp_node"]), int(function["rsp_dir"])
    sign = "" if way == 0 else "+" if way > 0 else "-"
    return f"{node}{_AXES[abs(way)]}{sign}"


def _unit(function: Any, axis: str) -> str:
    """Return the unit of an axis by a function's label, or ""."""
    label = str(function.get(f"{axis}_axis_units_lab", "")).strip()
    return "" if label.upper() in ("NONE", "") else label


# --- MAT files up to version 7, read in their own process: SciPy's reader may crash -------------------------

_SHARE = 0.4  # of the free memory: what is read is there twice while it is sent
_SECONDS = 600  # of processor time that a damaged file is read for at most


class BadMatFileError(ValueError):
    """Damaged or unreadable MAT file."""


class Mat73Error(ValueError):
    """MAT file of version 7.3, which is an HDF5 file."""


def read_mat(path: Path) -> dict[str, Any]:
    """Return the variables of a file, as :func:`scipy.io.loadmat` does.

    Raises:
        Mat73Error: The file is of version 7.3.
        BadMatFileError: The file cannot be read.
    """
    import scipy.io  # noqa: F401 - in this process, so that the other has it

    if sys.platform != "linux":
        return _loaded(path)
    ours, theirs = multiprocessing.Pipe(duplex=False)
    number = os.fork()  # multiprocessing starts none from a process that is to end with another, as of a pool
    if number == 0:
        try:
            _serve(path, theirs)
        finally:
            os._exit(1)
    theirs.close()
    ended: int | None = None
    try:
        with contextlib.closing(ours):
            content = ours.recv()
    except EOFError:
        _, ended = os.waitpid(number, 0)
        cause = signal.Signals(os.WTERMSIG(ended)).name if os.WIFSIGNALED(ended) else "no answer"
        raise BadMatFileError(
            f"its reader ended with {cause}: the file is damaged; export it again"
        ) from None
    finally:
        if ended is None:
            os.kill(number, signal.SIGKILL)
            os.waitpid(number, 0)
    if isinstance(content, Exception):
        raise content
    return dict(content)


def _serve(path: Path, pipe: Connection) -> None:
    """Send the variables of a file, or the error of its reader."""
    faulthandler.disable()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the process that waits acts on it
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    with contextlib.suppress(OSError, ValueError):
        resource.setrlimit(resource.RLIMIT_CPU, (_SECONDS, _SECONDS))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        free = free_memory()
        if free is not None:
            pages = int(Path("/proc/self/statm").read_text().split()[0])
            most = pages * resource.getpagesize() + int(_SHARE * free)
            resource.setrlimit(resource.RLIMIT_AS, (most, most))
    code = 0
    try:
        pipe.send(_loaded(path))
    except (BadMatFileError, Mat73Error) as error:
        pipe.send(error)
    except BaseException:
        code = 1
    os._exit(code)


def _loaded(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    try:
        return dict(loadmat(path, squeeze_me=True, struct_as_record=True))
    except NotImplementedError:
        raise Mat73Error from None
    except MemoryError:
        raise BadMatFileError("it needs more memory than this machine has; export fewer variables") from None
    except Exception as error:  # the reader raises any on a damaged file
        raise BadMatFileError(" ".join(str(error).split())) from None


#: Suffixes of record files: of texts, of others.
_TEXTS, _UNIVERSAL = (".csv", ".txt", ".tsv", ".dat", ".asc", ".lvm"), (".uff", ".unv", ".uf", ".bunv")
_SUFFIXES = (*_TEXTS, ".nc", ".mat", *_UNIVERSAL)
_OF_TEXTS = ("delimiter", "decimal", "encoding", "comment", "skip", "names", "units_row", "time_format")
_NO_NUMBERS = (b"char", b"cell", b"string", b"function_handle")  # what MATLAB's arrays are of


class _Columns(NamedTuple):
    """Columns of a record's file."""

    time: Array  # of the rows, by the file's clock, (rows,) [s]
    values: dict[str, Array]  # by names in the file, (rows,), in the file's units
    units: dict[str, str]  # units given in the file


def read_columns(path: Path, names: Sequence[str], layout: LayoutSpec, place: str) -> _Columns:
    """Return times and columns of a record's file, all of one length.

    Raises:
        ScenarioError: The file is missing or unreadable, or a column holds other than numbers.
        UnknownNameError: The file lacks a column.
    """
    if path.suffix.lower() not in _SUFFIXES:
        raise ScenarioError(f"{place}.file must end in {', '.join(_SUFFIXES)}, got {path.name!r}")
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
        found, units = _from_universal(path, wanted, layout.time, place)
    else:
        found, units = _from_text(path, wanted, layout, place)
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
    return _Columns(time, {name: found[name] for name in names}, units)


def _check_column(path: Path, name: str, known: Iterable[str], place: str) -> None:
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
    """Return columns and their units; of dates the seconds since the first."""
    try:
        data = load_dataset(path)
    except Exception as error:  # HDF5 raises any
        words = " ".join(str(error).split())
        raise ScenarioError(f"{place}: {path.name} cannot be read as NetCDF 4: {words}") from None
    found, units = {}, {}
    for name in names:
        _check_column(path, name, [str(one) for one in data.variables if data[one].ndim == 1], place)
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
        _check_column(path, name, [one for one, array in arrays.items() if array.ndim == 1], place)
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
    """Return vectors of numbers of a MAT file of version 7.3."""
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


def _leaves(group: Any, visited: set[Any]) -> Iterator[tuple[str, Any]]:
    """Yield the arrays of an HDF5 file by name, with points between levels."""
    if group.id in visited:  # equal where they are the same object
        raise ValueError(f"group {group.name} stands elsewhere in it, too")
    visited.add(group.id)
    for name, item in group.items():
        if name.startswith("#"):  # what cells refer to
            continue
        if hasattr(item, "items"):
            yield from ((f"{name}.{inner}", one) for inner, one in _leaves(item, visited))
        elif hasattr(item, "dtype"):
            yield name, item


def _numbers(path: Path, name: str, values: Any, place: str) -> Array:
    array = np.asarray(values)
    if array.dtype.kind not in "fiub":
        raise ScenarioError(f"{place}: {path.name}: {name} must be numbers, got {array.dtype}")
    return array.astype(float)
