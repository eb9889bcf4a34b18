"""Parsing of options, and refusal of wrong ones in one line."""

from __future__ import annotations

import contextlib
import errno
import functools
import os
import re
import shlex
import typing
from collections.abc import Callable, Iterator
from typing import Any, ParamSpec, TypeVar

import typer
from typer.core import TyperGroup
from typer.models import ParameterInfo

from antenna_pin.apps.cli._common import REFUSED, complain, report_interruption
from antenna_pin.apps.cli._tables import length_text
from antenna_pin.base.readable import DECIMAL, bare, decimal_in, whole_in
from antenna_pin.base.rules import NumberRule, obeys
from antenna_pin.errors import InvalidParameterError

P = ParamSpec("P")
R = TypeVar("R")

_READERS: dict[Any, Callable[[str], float | None]] = {float: decimal_in, int: whole_in}


def with_plain_numbers(command: Callable[P, R]) -> Callable[P, R]:
    """Return a command that reads numeric options as strictly as scenario files, by their rules."""
    # Evaluated here for good: each evaluation makes the options anew.
    command.__annotations__ = typing.get_type_hints(command, include_extras=True)
    for hint in command.__annotations__.values():
        info = next((one for one in typing.get_args(hint) if isinstance(one, ParameterInfo)), None)
        kind = next((one for one in (hint, *_parts(hint)) if one in _READERS), None)
        if info is not None and kind is not None and info.parser is None:
            info.parser = _reader(
                kind, [one.text for one in typing.get_args(hint) if isinstance(one, NumberRule)]
            )
    return command


def _parts(hint: Any) -> tuple[Any, ...]:
    inner = typing.get_args(hint)
    return (*inner, *(part for one in inner for part in typing.get_args(one)))


def _reader(kind: type[float], rules: list[str]) -> Callable[[Any], float]:
    def read(value: Any) -> float:
        number = _READERS[kind](value) if isinstance(value, str) else value
        if number is None:
            raise typer.BadParameter(f"{value!r} is not a valid {kind.__name__}")
        for rule in rules:
            if not obeys(number, rule):
                raise typer.BadParameter(f"must be {rule}, got {value}")
        return kind(number)

    read.__name__ = kind.__name__  # which the help shows
    return read


def positive_quantity(text: str, unit: str, option: str, place: str = "contact") -> float:
    """Return an option in SI units, or refuse a value that is not positive."""
    from antenna_pin.base.arguments import check_number
    from antenna_pin.base.units import quantity

    value = quantity(bare(text), unit, option)
    check_number(place, option, value, "positive", text=repr(text))
    return value


def clearance_of(text: str, bearing_radius: float, place: str) -> float:
    """Return the radial clearance [m], or refuse one outside (0, bearing radius)."""
    value = positive_quantity(text, "m", "--radial-clearance")
    if not value < bearing_radius:
        raise InvalidParameterError(
            place, "--radial-clearance", f"below the bearing's radius, {length_text(bearing_radius)}", text
        )
    return value


def seconds_in(text: str | None, option: str) -> float | None:
    """Return the time of an option [s]; None if it is left out."""
    from antenna_pin.base.units import quantity

    return None if text is None else quantity(bare(text), "s", option)


def direction_of(text: str, command: str, option: str) -> tuple[float, float, float]:
    """Return the three numbers of an option, or refuse another text."""
    vector = vector_in(text)
    if vector is None:
        raise InvalidParameterError(command, option, "three numbers such as 1,0,0", text)
    return vector


def vector_in(text: str) -> tuple[float, float, float] | None:
    """Return the three numbers of ``X,Y,Z``; None if the text is something else."""
    numbers = [decimal_in(part) for part in text.split(",")]
    x, y, z = numbers if len(numbers) == 3 else (None, None, None)
    return None if x is None or y is None or z is None else (x, y, z)


def list_of(text: str, unit: str, option: str, positive: bool = True) -> tuple[float, ...]:
    """Return the quantities of a list; one unit at its end applies to all."""
    from antenna_pin.base.units import quantity

    parts = [part.strip() for part in text.split(",") if part.strip()]
    if not parts:
        raise InvalidParameterError("contact", option, "one value or more, separated by commas", text)
    shared = re.fullmatch(rf"{DECIMAL}\s*([a-zA-Zµμ].*)", parts[-1])
    if (
        shared
        and isinstance(bare(parts[-1]), str)
        and all(isinstance(bare(part), float) for part in parts[:-1])
    ):
        parts[:-1] = [f"{part} {shared.group(1)}" for part in parts[:-1]]
    if positive:
        return tuple(positive_quantity(part, unit, option) for part in parts)
    return tuple(quantity(bare(part), unit, option) for part in parts)


def command_group(name: str, about: str) -> typer.Typer:
    """Return a group of commands with its help."""
    return typer.Typer(
        name=name,
        help=about,
        no_args_is_help=True,
        context_settings={"help_option_names": ["-h", "--help"]},
        rich_markup_mode=None,
    )


_WORDS = "antenna_pin.words"


def command_of(context: typer.Context) -> str:
    """Return the command line that a command was called with, as a shell takes it."""
    return shlex.join(["antenna-pin", *context.meta.get(_WORDS, ())])


class OneLineGroup(TyperGroup):
    """Commands whose wrong options and arguments are refused in one line."""

    def make_context(self, info_name: str | None, args: list[str], *more: Any, **options: Any) -> Any:
        """Read the options before the command; store all words for the provenance of results."""
        words = tuple(args)  # reading takes them away
        with _refused_in_one_line():
            context = super().make_context(info_name, args, *more, **options)
        context.meta[_WORDS] = words
        return context

    def invoke(self, *arguments: Any, **options: Any) -> Any:
        """Read the command's own words, and run it."""
        with _refused_in_one_line():
            return super().invoke(*arguments, **options)


@contextlib.contextmanager
def _refused_in_one_line() -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:  # while words are read
        raise typer.Exit(report_interruption()) from None
    except (MemoryError, ImportError) as error:
        if not _is_of_memory(error):
            raise
        complain("out of memory; use a shorter run, a lower sample rate or fewer files")
        raise typer.Exit(REFUSED) from None
    except Exception as error:
        # Typer brings a Click of its own, or not; NoArgsIsHelpError shows the help, which is many lines.
        if hasattr(error, "format_message") and type(error).__name__ != "NoArgsIsHelpError":
            error.show = functools.partial(_tell, error)  # type: ignore[attr-defined]
        raise


def _is_of_memory(error: BaseException) -> bool:
    """Return whether memory has run out, for numbers or for a loaded library."""
    short = ("failed to map segment", os.strerror(errno.ENOMEM))
    return isinstance(error, MemoryError) or any(words in str(error) for words in short)


def _tell(error: Any, file: Any = None) -> None:
    context = getattr(error, "ctx", None)
    words = error.format_message().rstrip(".").replace("Value error, ", "")
    way_out = f"; see `{context.command_path} --help`" if context is not None else ""
    complain(f"{words}{way_out}")
