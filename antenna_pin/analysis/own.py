"""Quantities of a user's own: functions of a run, named ``FILE.py:NAME`` or ``MODULE:NAME``.

A function is called with a run and returns a number of it, which studies, ``info`` and reports show, or one
at each sample, which figures, spectra, phase portraits and fits take. Its attribute ``units``, if it has one,
is the SI unit.
"""

from __future__ import annotations

import copy
import dataclasses
import importlib
import inspect
import math
import re
import types
from collections.abc import Callable, Iterable
from functools import lru_cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike
from antenna_pin.base.arguments import check_takes, number_in, takes, unknown_type
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.trajectory import Trajectory

_NAME = re.compile(r"(?:[^\[\]|]+\.py|[\w.]+):[^\W\d]\w*")


class OwnNumber(NamedTuple):
    """Number of a run by a function of a user's."""

    name: str
    value: float
    units: str

    @property
    def heading(self) -> str:
        """Its name in tables, with the unit."""
        return self.name.replace("_", " ") + (f" [{self.units}]" if self.units != "1" else "")


@takes()
def is_own(name: str) -> bool:
    """Return whether a name is that of a function, ``FILE.py:NAME`` or ``MODULE:NAME``."""
    return _NAME.fullmatch(name) is not None


@takes()
def own_source(name: str, folder: Path, place: str) -> str:
    """Return the text of the file that a function stands in; "" for a module.

    Raises:
        ScenarioError: There is no such file or module, or no such function in it.
    """
    file, _, function = name.rpartition(":")
    if not file.endswith(".py"):
        _imported(file, function, place)
        return ""
    try:
        text = (folder / file).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        words = error.strerror if isinstance(error, OSError) else str(error)
        raise ScenarioError(
            f"{place}: function must name a file that can be read from {folder}, got {file}: {words}"
        ) from None
    _executed(text, file, function, place)
    return text


@takes()
def own_number(name: str, source: str, place: str, run: RunLike, seed: int = 0) -> float:
    """Return a function's number of a run.

    ``source`` is the text of its file, or "" (:func:`own_source`); the seed is for a function with such an
    argument.

    Raises:
        ScenarioError: It returns no number, or changes the run.
        Exception: Whatever the function raises.
    """
    value = _value(name, source, place, run, seed)
    number = number_in(value)
    if number is None or math.isinf(number):
        raise ScenarioError(f"{name} must return a number, got {unknown_type(value)}")
    return number


@takes()
def own_series(name: str, run: RunLike, count: int) -> tuple[Array, str]:
    """Return a function's number at each sample of a run, and its unit.

    Raises:
        ScenarioError: It returns something else.
    """
    source = own_source(name, Path(), "quantity")
    values = np.asarray(_value(name, source, "quantity", run, 0))
    if values.shape != (count,) or values.dtype.kind not in "fiub":
        raise ScenarioError(
            f"{name} must return a number at each of {count} samples, got shape {values.shape}"
        )
    return values.astype(float), _unit(_function_of(name, source, "quantity"))


@takes()
def own_numbers(run: Trajectory, names: Iterable[str]) -> list[OwnNumber]:
    """Return numbers of a run by functions; files are named from the working folder.

    Raises:
        InvalidParameterError: A name is not that of a function.
        ScenarioError: A function does not exist, or returns no number.
    """
    found = []
    for name in names:
        if not is_own(name):
            raise InvalidParameterError("quantity", "name", "FILE.py:NAME or MODULE:NAME", name)
        source = own_source(name, Path(), "quantity")
        unit = _unit(_function_of(name, source, "quantity"))
        found.append(OwnNumber(name.rpartition(":")[2], own_number(name, source, "quantity", run), unit))
    return found


def _unit(function: Callable[..., Any]) -> str:
    return str(getattr(function, "units", "1"))


def _value(name: str, source: str, place: str, run: RunLike, seed: int) -> Any:
    called = _function_of(name, source, place)
    more = dict.fromkeys(_besides(called), seed)
    try:
        return called(_for_reading(run), **more)
    except SystemExit as error:  # it would end the process that makes the runs
        raise ScenarioError(f"{name} must return a number, got the exit {error}") from None
    except ValueError as error:
        if "ssignment destination" not in str(error):  # as NumPy and xarray begin
            raise
        raise ScenarioError(
            f"{name} must not change the run, which other responses read too; change a copy instead, "
            f"run.data.copy(deep=True)"
        ) from None


def _function_of(name: str, source: str, place: str) -> Callable[..., Any]:
    file, _, function = name.rpartition(":")
    return _executed(source, file, function, place) if source else _imported(file, function, place)


def _imported(module: str, function: str, place: str) -> Callable[..., Any]:
    try:
        found = importlib.import_module(module)
    except (Exception, SystemExit) as error:
        raise ScenarioError(f"{place}: module {module} cannot be imported: {error!r}") from None
    return _checked(vars(found), function, module, place)


@lru_cache(maxsize=64)
def _executed(text: str, file: str, function: str, place: str) -> Callable[..., Any]:
    module = types.ModuleType(Path(file).stem)
    try:
        exec(compile(text, file, "exec"), vars(module))
    except (Exception, SystemExit) as error:
        raise ScenarioError(f"{place}: {file} cannot be run: {error!r}") from None
    return _checked(vars(module), function, file, place)


def _checked(names: dict[str, Any], function: str, file: str, place: str) -> Callable[..., Any]:
    found = names.get(function)
    if not callable(found):
        known = sorted(key for key, value in names.items() if callable(value) and not key.startswith("_"))
        raise ScenarioError(
            f"{place}: {file} must have a function {function!r}, it has {', '.join(known) or 'none'}"
        )
    made: Callable[..., Any] = found
    try:
        check_takes(place, function, made, "run", *_besides(made))
    except InvalidParameterError as error:
        raise ScenarioError(str(error)) from None
    return made


def _besides(function: Callable[..., Any]) -> tuple[str, ...]:
    """Return the further arguments of a function: the seed, if it has one."""
    try:
        return tuple(one for one in ("seed",) if one in inspect.signature(function).parameters)
    except (TypeError, ValueError):  # some of those in C do not say
        return ()


def _for_reading(run: RunLike) -> Any:
    """Return a read-only view of a run, which the function cannot change."""
    data = (run.data if isinstance(run, Trajectory) else run).copy(deep=False)
    for variable in data.variables.values():
        values = variable._data  # a part of a large file is read anew each time
        if isinstance(values, np.ndarray):
            variable._data = values.view()
            variable._data.flags.writeable = False
    if isinstance(run, xr.Dataset):
        return types.SimpleNamespace(data=data)
    return dataclasses.replace(run, data=data, end=copy.deepcopy(run.end))
