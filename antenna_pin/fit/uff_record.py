"""Columns of a record from a universal file, by which programs for vibration tests exchange measurements.

Its sets of number 58 are functions at degrees of freedom of nodes. Those of time are columns, each called by
its node and direction, as ``12X+`` and ``12RZ-``; 0 is a scalar, ``12``.
"""

from __future__ import annotations

import importlib
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import MissingToolError, ScenarioError, UnknownNameError

__all__ = ["from_universal"]

Array = NDArray[np.float64]

_AXES = ("", "X", "Y", "Z", "RX", "RY", "RZ")
_FUNCTION, _UNITS, _OF_TIME = 58, 164, 1  # kinds of sets; of functions the kind that goes over time
_OF_SI = 1  # code of units, of sets of these
_SHOWN = 12  # names that a message offers


def from_universal(
    path: Path, names: Sequence[str], time: str, place: str
) -> tuple[dict[str, Array], dict[str, str]]:
    """Return columns by name, (rows,) each, and the units that the file gives of them.

    Args:
        path: The file.
        names: Of the columns that are wanted; those of one file must have the same times.
        time: How that of their times is called among these.
        place: Where the file is named, for messages.

    Raises:
        ScenarioError: It cannot be read, has a column twice, or columns of other times.
        UnknownNameError: It has no such column.
        MissingToolError: pyuff is not installed.
    """
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
                "record of its own"
            )
        if time in names:
            found[time], units[time] = times, _unit(one, "abscissa")
    return found, {name: unit for name, unit in units.items() if unit}


def _sets(path: Path, place: str) -> tuple[dict[int, Any], str]:
    """Return the functions of time by their numbers in the file, and what units are in that give none."""
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
    """Return what a function is called by."""
    node, way = int(function["rsp_node"]), int(function["rsp_dir"])
    sign = "" if way == 0 else "+" if way > 0 else "-"
    return f"{node}{_AXES[abs(way)]}{sign}"


def _unit(function: Any, axis: str) -> str:
    """Return the unit that a function's label gives of an axis, or nothing."""
    label = str(function.get(f"{axis}_axis_units_lab", "")).strip()
    return "" if label.upper() in ("NONE", "") else label
