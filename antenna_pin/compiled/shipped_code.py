"""Kernels of a wheel's shared library, called without Numba.

A wheel may contain the machine code of all kernels in one shared library (``shared_library.py``), with an
index in plain data: for each kernel and types of its arguments an entry, a function of C. An entry takes a
row of 8-byte words: the numbers of a call, and the addresses of its arrays and records in Python; it reads
shapes, strides and addresses of data from these objects.

The library is used if it is unchanged since it was written, belongs to a trusted user, was built from the
present sources, and runs on the processor. Otherwise, and for other types of arguments, Numba compiles.
"""

from __future__ import annotations

import ctypes
import hashlib
import json
import os
import struct
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from antenna_pin.compiled.ownership import open_to, stranger_of
from antenna_pin.compiled.target import BASELINE, baseline_runs

LIBRARY, INDEX = "kernels.so", "kernels.json"
FORMAT = 1  # format of the index

#: Offsets of the addresses of data, shape and strides in NumPy's arrays, and of data in its records [bytes].
DATA, SHAPE, STRIDES, RECORD = 16, 32, 40, 24

_C_ORDER, _FORTRAN_ORDER, _WRITEABLE = 0x1, 0x2, 0x400
_FLAGS = _C_ORDER | _FORTRAN_ORDER | _WRITEABLE
#: Codes of numbers, as in ``struct``.
_NUMBERS: dict[type, str] = {float: "d", np.float64: "d", int: "q", np.int64: "q", bool: "?", np.bool_: "?"}

_FOLDER = Path(__file__).parent

#: Codes of an entry's return value: nothing, a number, a tuple.
Result = str | list[Any]


class _MisfitError(Exception):
    """Reason not to use the library."""


def shipped(
    name: str, released: bool, otherwise: Callable[[], Callable[..., Any]]
) -> Callable[..., Any] | None:
    """Return a kernel of the library; None without one.

    Args:
        name: Module and name of the kernel.
        released: Whether other threads run during a call.
        otherwise: Returns the function for other types of arguments.
    """
    opened = _opened()
    if isinstance(opened, str) or name not in opened[0]:
        return None
    entries, library = opened[0][name], opened[1 if released else 2]
    calls: dict[tuple[Any, ...], Callable[[list[Any]], Any]] = {}

    def call(*arguments: Any) -> Any:
        row: list[Any] = []
        types = _types(arguments, row)
        own = calls.get(types)
        if own is None:
            entry = _entry_for(entries, [_text(one) for one in arguments])
            if entry is None:
                return otherwise()(*arguments)
            own = calls[types] = _entry(name, library, *entry)
        return own(row)

    return call


def misfit() -> str:
    """Return why the library is not used; empty where it is."""
    opened = _opened()
    return opened if isinstance(opened, str) else ""


def _entry_for(entries: dict[str, Any], types: list[str]) -> Any:
    """Return the entry for types of arguments, integers taken as floats if need be."""
    numbers = [("q", "d") if one == "q" else (one,) for one in types]
    return next((entries[key] for one in product(*numbers) if (key := key_of(one)) in entries), None)


def _entry(name: str, library: Any, symbol: str, codes: str, result: Result) -> Callable[[list[Any]], Any]:
    """Return an entry as a function of a row.

    Args:
        name: Name of the kernel.
        library: The library.
        symbol: Symbol of the entry.
        codes: Codes of the row.
        result: Codes of the return value.
    """
    function = library[symbol]
    function.argtypes, function.restype = (ctypes.c_char_p, ctypes.c_void_p), ctypes.c_int32
    pack, flat = struct.Struct(codes).pack, _flat(result)
    unpack = struct.Struct("".join(f"{code}7x" if code == "?" else code for code in flat)).unpack
    room: Any = ctypes.c_char * (8 * len(flat))

    def call(row: list[Any]) -> Any:
        answer = room()
        if function(pack(*row), answer):
            raise RuntimeError(f"kernel {name} has failed")
        return unpack(answer) if is_row else _nested(result, iter(unpack(answer)))

    def call_for_nothing(row: list[Any]) -> None:
        if function(pack(*row), None):
            raise RuntimeError(f"kernel {name} has failed")

    is_row = not isinstance(result, str) and len(flat) == len(result)
    return call if result else call_for_nothing


def _flat(result: Result) -> str:
    return result if isinstance(result, str) else "".join(map(_flat, result))


def _nested(result: Result, numbers: Iterator[Any]) -> Any:
    return next(numbers) if isinstance(result, str) else tuple(_nested(one, numbers) for one in result)


# --- types of arguments ---


def _types(values: Iterable[Any], row: list[Any]) -> tuple[Any, ...]:
    """Return a key of the values' types; append the values to a row."""
    found: list[Any] = []
    for value in values:
        kind = type(value)
        if kind is np.ndarray:
            row.append(id(value))
            found += value.dtype, value.ndim, value.flags.num & _FLAGS
        elif kind in _NUMBERS:
            row.append(value if kind is not np.bool_ else bool(value))
            found.append(kind)
        elif isinstance(value, tuple):
            found.append((kind, _types(value, row)))
        else:
            row.append(id(value))
            found.append((kind, _text(value)))
    return tuple(found)


def _text(value: Any) -> str:
    """Return the type of an argument as text, equal in every process."""
    if isinstance(value, np.ndarray):
        order = "C" if value.flags.c_contiguous else "F" if value.flags.f_contiguous else "A"
        return f"{dtype_text(value.dtype)}:{value.ndim}{order}{'' if value.flags.writeable else ' constant'}"
    if isinstance(value, tuple):
        inner, kind = ",".join(map(_text, value)), type(value)
        return (
            f"{kind.__module__}.{kind.__qualname__}({inner})" if hasattr(value, "_fields") else f"({inner})"
        )
    if isinstance(value, np.void):
        return dtype_text(value.dtype)
    return _NUMBERS.get(type(value), f"{type(value)}")


@cache
def dtype_text(dtype: np.dtype[Any]) -> str:
    """Return the type of an array's items as text, equal in every process."""
    if dtype.subdtype is not None:
        return f"{dtype_text(dtype.subdtype[0])}{list(dtype.subdtype[1])}"
    if dtype.fields is None:
        return dtype.str
    fields = (f"{name}={dtype_text(one[0])}@{one[1]}" for name, one in dtype.fields.items())
    return f"{{{';'.join(fields)}}}{dtype.itemsize}"


def key_of(types: Iterable[str]) -> str:
    """Return the key of an entry in the index, from its arguments' types."""
    return hashlib.sha256(",".join(types).encode()).hexdigest()[:32]


# --- the library ---


@cache
def _opened() -> tuple[dict[str, dict[str, Any]], ctypes.CDLL, ctypes.PyDLL] | str:
    """Return the index and two handles of the library; else the reason against its use.

    A call by the second handle holds the interpreter's lock.
    """
    try:
        _check_processor()
        index = json.loads(_read(_FOLDER / INDEX))
        if index["format"] != FORMAT:
            raise _MisfitError("that of another version is installed")
        _check_objects()
        if digest_of([_FOLDER.parent / name for name in index["sources"]]) != index["of_sources"]:
            raise _MisfitError("kernels have been changed since it was made")
        path = _FOLDER / LIBRARY
        if hashlib.sha256(_read(path)).hexdigest() != index["of_library"]:
            raise _MisfitError(f"{path} does not hold what was written")
        return index["kernels"], ctypes.CDLL(str(path)), ctypes.PyDLL(str(path))
    except _MisfitError as error:
        return str(error)
    except FileNotFoundError:
        return "none is installed"
    except (OSError, ValueError, KeyError, TypeError) as error:
        return f"that which is installed cannot be read ({error})"


def _check_processor() -> None:
    named = os.environ.get("NUMBA_CPU_NAME")
    if named:
        raise _MisfitError(f"NUMBA_CPU_NAME requires {named}")
    if not baseline_runs():
        raise _MisfitError(f"that which is installed is for Linux on {BASELINE}")


def _check_objects() -> None:
    """Check that NumPy's objects store their data at the offsets that entries read."""
    array = np.zeros((3, 2), np.dtype([("field", "f8")]))
    record, number = array[1, 1], ctypes.c_int64.from_address
    told = array.__array_interface__["data"][0]
    shape, strides = (number(id(array) + at).value for at in (SHAPE, STRIDES))
    if (
        number(id(array) + DATA).value != told
        or number(id(record) + RECORD).value != told + 3 * 8
        or [number(shape + 8 * k).value for k in range(2)] != [3, 2]
        or [number(strides + 8 * k).value for k in range(2)] != [16, 8]
    ):
        raise _MisfitError("that which is installed is for objects of another Python or NumPy")


def _read(path: Path) -> bytes:
    """Return a file's content; only users trusted with the sources may write to it."""
    owner = os.stat(__file__).st_uid
    with open(path, "rb") as file:
        found = stranger_of(_FOLDER, owner) or open_to(os.fstat(file.fileno()), owner)
        if found:
            raise _MisfitError(f"{path} is not safe, for {found}")
        return file.read()


def digest_of(paths: Iterable[Path]) -> str:
    """Return a digest of files' contents."""
    whole = hashlib.sha256()
    for path in paths:
        whole.update(hashlib.sha256(path.read_bytes()).digest())
    return whole.hexdigest()
