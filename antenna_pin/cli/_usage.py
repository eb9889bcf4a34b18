"""What is wrong with the words of a command, in one line as everything else that is refused."""

from __future__ import annotations

import contextlib
import errno
import functools
import os
import shlex
from collections.abc import Iterator
from typing import Any

import typer
from typer.core import TyperGroup

from antenna_pin.cli._common import REFUSED, complain, told_interruption

_WORDS = "antenna_pin.words"


def command_of(context: typer.Context) -> str:
    """Return the command line that a command was called with, as a shell takes it."""
    return shlex.join(["antenna-pin", *context.meta.get(_WORDS, ())])


class OneLineGroup(TyperGroup):
    """Commands whose wrong options and arguments are refused in one line."""

    def make_context(self, info_name: str | None, args: list[str], *more: Any, **options: Any) -> Any:
        """Read the words that stand before the command; keep all, for results that say how they were made."""
        words = tuple(args)  # reading takes them away
        with _told_in_one_line():
            context = super().make_context(info_name, args, *more, **options)
        context.meta[_WORDS] = words
        return context

    def invoke(self, *arguments: Any, **options: Any) -> Any:
        """Read the command's own words, and run it."""
        with _told_in_one_line():
            return super().invoke(*arguments, **options)


@contextlib.contextmanager
def _told_in_one_line() -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:  # while words are read
        raise typer.Exit(told_interruption()) from None
    except (MemoryError, ImportError) as error:
        if not _is_of_memory(error):
            raise
        complain("the memory has run out; ask for less: a shorter run, a lower rate of samples, fewer files")
        raise typer.Exit(REFUSED) from None
    except Exception as error:
        # Typer brings a Click of its own, or not; NoArgsIsHelpError shows the help, which is many lines.
        if hasattr(error, "format_message") and type(error).__name__ != "NoArgsIsHelpError":
            error.show = functools.partial(_tell, error)  # type: ignore[attr-defined]
        raise


def _is_of_memory(error: BaseException) -> bool:
    """Whether memory is short: for numbers, or for a library that is loaded."""
    short = ("failed to map segment", os.strerror(errno.ENOMEM))
    return isinstance(error, MemoryError) or any(words in str(error) for words in short)


def _tell(error: Any, file: Any = None) -> None:
    context = getattr(error, "ctx", None)
    words = error.format_message().rstrip(".").replace("Value error, ", "")
    way_out = f"; `{context.command_path} --help` tells of all" if context is not None else ""
    complain(f"{words}{way_out}")
