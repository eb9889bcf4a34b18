"""Options that are numbers: read as files and quantities are, on each version of Typer."""

from __future__ import annotations

import typing
from collections.abc import Callable
from typing import Any, ParamSpec, TypeVar

import typer
from typer.models import ParameterInfo

from antenna_pin.base.numerals import decimal_in, whole_in

P = ParamSpec("P")
R = TypeVar("R")

_READERS: dict[Any, Callable[[str], float | None]] = {float: decimal_in, int: whole_in}


def with_plain_numbers(command: Callable[P, R]) -> Callable[P, R]:
    """Return a command whose options that are numbers take what else is taken for one, and nothing more."""
    # Evaluated here for good: each evaluation makes the options anew.
    command.__annotations__ = typing.get_type_hints(command, include_extras=True)
    for hint in command.__annotations__.values():
        info = next((one for one in typing.get_args(hint) if isinstance(one, ParameterInfo)), None)
        kind = next((one for one in (hint, *_parts(hint)) if one in _READERS), None)
        if info is not None and kind is not None and info.parser is None:
            info.parser, info.min = _reader(kind, info.min), None
    return command


def _parts(hint: Any) -> tuple[Any, ...]:
    inner = typing.get_args(hint)
    return (*inner, *(part for one in inner for part in typing.get_args(one)))


def _reader(kind: type[float], least: float | None) -> Callable[[Any], float]:
    def read(value: Any) -> float:
        number = _READERS[kind](value) if isinstance(value, str) else value
        if number is None:
            raise typer.BadParameter(f"{value!r} is not a valid {kind.__name__}")
        if least is not None and number < least:
            raise typer.BadParameter(f"{value} is not in the range x>={least}")
        return kind(number)

    read.__name__ = kind.__name__  # which the help shows
    return read
