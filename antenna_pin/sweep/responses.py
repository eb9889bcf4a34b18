"""Responses of a study: numbers of each run, by measures or user functions."""

from __future__ import annotations

import copy
import dataclasses
import importlib
import inspect
import math
import types
from collections.abc import Callable, Mapping
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, model_validator

from antenna_pin.base.answers import check_takes, number_in
from antenna_pin.base.arguments import unknown_type
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.scenario.spec import PositiveTime, Quantity, Spec, refuse, refuse_name
from antenna_pin.sweep.measures import MEASURES

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory

__all__ = ["ResponseSpec", "evaluate", "source_of"]


def _share(value: object) -> float:
    number = Quantity("1").read(value)
    if not 0.0 < number <= 1.0:
        refuse(f"must be above 0 and at most 1, got {value}", value=value)
    return number


class ResponseSpec(Spec):
    """One number of each run: by a measure or a function.

    Attributes:
        measure: Name of a measure.
        function: ``FILE.py:NAME``, from the study file's folder, or ``MODULE:NAME``; called with the run, a
            Trajectory, and if it has an argument ``seed`` with the run's; returns a number.
        of: What the measure is of: a contact, a joint, a drive, a quantity as ``elevation angle``; all if
            left out, where that makes sense.
        index: Of ``pointing``: index of ECSS-E-ST-60-10C.
        component: Of ``pointing``: ``half-cone``, ``boresight``, ``cross`` or ``up``.
        value: Of ``pointing``: the ``largest`` one, or the ``level`` of the confidence.
        window: Of ``pointing``: length of the windows.
        drift_spacing: Of ``pointing``: from one window of the PDE to the other.
        period: Of ``pointing``: length of the observation periods.
        confidence: Of ``pointing``'s level [-].
        units: Of a function's number; of ``peak_effort`` and ``peak_deflection`` where the joint slides.
        title: What it is called in figures; its name if left out.
    """

    measure: str | None = None
    function: str | None = None
    of: str | None = None
    index: Literal["APE", "MPE", "RPE", "PDE", "PRE"] = "APE"
    component: Annotated[
        Literal["half-cone", "boresight", "cross", "up"],
        BeforeValidator(lambda name: name.replace("_", "-") if isinstance(name, str) else name),
    ] = "half-cone"
    value: Literal["largest", "level"] = "largest"
    window: PositiveTime | None = None
    drift_spacing: PositiveTime | None = None
    period: PositiveTime | None = None
    confidence: Annotated[float, BeforeValidator(_share)] = 0.997
    units: str = ""
    title: str = ""

    @model_validator(mode="before")
    @classmethod
    def _read_text(cls, data: Any) -> Any:
        """Let a text stand for a measure, or, with a colon, for a function."""
        if isinstance(data, str):
            return {"function" if ":" in data else "measure": data}
        if isinstance(data, Mapping) and ":" in str(data.get("measure", "")) and "function" not in data:
            return {"function" if key == "measure" else key: value for key, value in data.items()}
        return data

    @property
    def compares(self) -> bool:
        """True for a response that compares with the study's reference."""
        return self.measure is not None and MEASURES[self.measure].compares

    @model_validator(mode="after")
    def _check_choice(self) -> Self:
        if (self.measure is None) == (self.function is None):
            refuse(f"must have either measure or function, got {'both' if self.measure else 'neither'}")
        given = self.model_fields_set - {"measure", "function", "title"}
        if self.function is not None:
            if not all(self.function.rpartition(":")[::2]):
                refuse(f"must be FILE.py:NAME or MODULE:NAME, got {self.function!r}", "function")
            for key in sorted(given - {"units"}):
                refuse("must be left out beside function", key)
            return self
        assert self.measure is not None
        if self.measure not in MEASURES:
            refuse_name("measure", self.measure, MEASURES, "measure")
        allowed = {"of"} if MEASURES[self.measure].of else set()
        if self.measure in ("peak_effort", "peak_deflection"):
            allowed |= {"units"}  # of a joint that slides they are others
        if self.measure == "pointing":
            allowed = {
                "index", "component", "value", "window", "drift_spacing", "period", "confidence",
            }  # fmt: skip
        for key in sorted(given - allowed):
            refuse(f"must be left out: {self.measure} has no {key}", key)
        return self

    @property
    def unit(self) -> str:
        """The unit of the number, as text."""
        if self.measure is None:
            return self.units
        if MEASURES[self.measure].of == "quantity":
            words = (self.of or "").split()
            return _UNITS.get(" ".join(words[-1:]), "")
        return self.units or MEASURES[self.measure].units

    @property
    def meaning(self) -> str:
        """Meaning of the number, in words."""
        if self.title:
            return self.title
        if self.measure is None:
            return str(self.function)
        if self.measure == "pointing":
            which = "largest" if self.value == "largest" else f"{100.0 * self.confidence:g} % level of the"
            return f"{which} {self.index} of the pointing error, {self.component}"
        meaning = MEASURES[self.measure].meaning.split(" (")[0].split(", of a joint's quantity")[0]
        return f"{meaning}, {self.of}" if self.of else meaning


_UNITS = {"angle": "rad", "rate": "rad/s", "acceleration": "rad/s^2"}


def source_of(response: ResponseSpec, folder: Path, name: str) -> str:
    """Return the source of a response's function file; "" for modules and measures.

    Raises:
        ScenarioError: There is no such file or module, or no such function in it.
    """
    if response.function is None:
        return ""
    place, _, function = response.function.rpartition(":")
    if not place.endswith(".py"):
        _imported(place, function, name)
        return ""
    try:
        text = (folder / place).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        words = error.strerror if isinstance(error, OSError) else str(error)
        raise ScenarioError(
            f"responses.{name}: function must name a file that can be read from {folder}, got {place}: "
            f"{words}"
        ) from None
    _made(text, place, function, name)
    return text


def _imported(place: str, function: str, name: str) -> Callable[..., Any]:
    try:
        module = importlib.import_module(place)
    except (Exception, SystemExit) as error:
        raise ScenarioError(f"responses.{name}: module {place} cannot be imported: {error!r}") from None
    return _function(vars(module), function, place, name)


@lru_cache(maxsize=64)
def _made(text: str, place: str, function: str, name: str) -> Callable[..., Any]:
    module = types.ModuleType(Path(place).stem)
    try:
        exec(compile(text, place, "exec"), vars(module))
    except (Exception, SystemExit) as error:
        raise ScenarioError(f"responses.{name}: {place} cannot be run: {error!r}") from None
    return _function(vars(module), function, place, name)


def _function(names: Mapping[str, Any], function: str, place: str, name: str) -> Callable[..., Any]:
    found = names.get(function)
    if not callable(found):
        known = sorted(key for key, value in names.items() if callable(value) and not key.startswith("_"))
        raise ScenarioError(
            f"responses.{name}: {place} must have a function {function!r}, it has "
            f"{', '.join(known) or 'none'}"
        )
    made: Callable[..., Any] = found
    try:
        check_takes(f"responses.{name}", function, made, "run", *_extra_arguments(made))
    except InvalidParameterError as error:
        raise ScenarioError(str(error)) from None
    return made


def _extra_arguments(function: Callable[..., Any]) -> tuple[str, ...]:
    """Return a response function's further arguments: the run's seed, if it takes one."""
    try:
        return tuple(one for one in ("seed",) if one in inspect.signature(function).parameters)
    except (TypeError, ValueError):  # some of those in C do not say
        return ()


def evaluate(
    name: str,
    response: ResponseSpec,
    source: str,
    run: Trajectory,
    reference: Trajectory | None,
    seed: int,
) -> float:
    """Return a response of a run.

    Args:
        name: Of the response.
        response: The response.
        source: The text of its function's file, or "".
        run: The run.
        reference: What it is compared with.
        seed: Of the run.

    Raises:
        AntennaPinError: The measure does not exist for this run.
        Exception: Whatever a function of the user's own raises.
    """
    if response.measure is not None:
        return MEASURES[response.measure].find(run, response, reference if response.compares else None)
    assert response.function is not None
    place, _, function = response.function.rpartition(":")
    called = _made(source, place, function, name) if source else _imported(place, function, name)
    more = dict.fromkeys(_extra_arguments(called), seed)
    try:
        value = called(_for_reading(run), **more)
    except SystemExit as error:  # it would end the process that makes the runs
        raise ScenarioError(f"{response.function} must return a number, got the exit {error}") from None
    except ValueError as error:
        if "ssignment destination" not in str(error):  # as NumPy and xarray begin
            raise
        raise ScenarioError(
            f"{response.function} must leave the run as it is, for other responses are of it too; let it "
            "change a copy, run.data.copy(deep=True)"
        ) from None
    number = number_in(value)
    if number is None or math.isinf(number):
        raise ScenarioError(f"{response.function} must return a number, got {unknown_type(value)}")
    return number


def _for_reading(run: Trajectory) -> Trajectory:
    """Return a read-only view of a run, so that responses cannot change it."""
    data = run.data.copy(deep=False)
    for variable in data.variables.values():
        values = variable._data  # a part of a large file is read anew each time
        if isinstance(values, np.ndarray):
            variable._data = values.view()
            variable._data.flags.writeable = False
    return dataclasses.replace(run, data=data, end=copy.deepcopy(run.end))
