"""What is said of a run when it ends, and of its file when it is asked for."""

from __future__ import annotations

import shutil
import sys
import textwrap
from typing import TYPE_CHECKING

from antenna_pin.cli._common import say

if TYPE_CHECKING:
    from antenna_pin.trajectory import Trajectory

__all__ = ["say_answer"]

_PAGE = 130  # of a pipe, which has no width to keep to
_ROWS = 11  # in all; a line on where the file is comes after them


def say_answer(trajectory: Trajectory, label: str = "") -> None:
    """Print a run at a glance, in eleven rows of a screen of any usual width.

    Where they do not do, the lines that take most lose what matters least of what they say.

    Args:
        trajectory: The run.
        label: What to call it first; nothing if it is the only one.
    """
    from antenna_pin.analysis import answer

    found = answer(trajectory)
    told = found.title if not label or found.title.endswith(f"case {label}") else f"{label}: {found.title}"
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else _PAGE
    widest = max(len(line.about) for line in found.lines)
    head = _wrapped(f"{told}: {found.ended}", width, " " * 4)
    parts = [line.text.split("; ") for line in found.lines]
    room = max(width - widest - 4, 30)
    rows = [_wrapped("; ".join(part), room) for part in parts]
    while sum(map(len, rows)) + len(head) > _ROWS:
        longest = max((len(row), len(part)) for row, part in zip(rows, parts, strict=True))
        if longest[1] < 2:
            break
        for k, (row, part) in enumerate(zip(rows, parts, strict=True)):
            if (len(row), len(part)) == longest:
                part.pop()
                rows[k] = _wrapped("; ".join(part), room)
    for text in head:
        say(text)
    for line, (first, *more) in zip(found.lines, rows, strict=True):
        about = f"  {line.about:<{widest}}  "
        say(about + first)
        for text in more:
            say(" " * len(about) + text)


def _wrapped(text: str, width: int, further: str = "") -> list[str]:
    """Return a text in rows; ``further``: what all but the first begin with."""
    return textwrap.wrap(
        text, width, subsequent_indent=further, break_long_words=False, break_on_hyphens=False
    )
