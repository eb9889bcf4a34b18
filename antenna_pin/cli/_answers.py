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


def say_answer(trajectory: Trajectory, label: str = "") -> None:
    """Print a run at a glance.

    Args:
        trajectory: The run.
        label: What to call it first; nothing if it is the only one.
    """
    from antenna_pin.analysis import answer

    found = answer(trajectory)
    told = found.title if not label or found.title.endswith(f"case {label}") else f"{label}: {found.title}"
    say(f"{told}: {found.ended}")
    widest = max(len(line.about) for line in found.lines)
    width = shutil.get_terminal_size().columns if sys.stdout.isatty() else _PAGE
    for line in found.lines:
        about, room = f"  {line.about:<{widest}}  ", max(width - widest - 4, 30)
        first, *more = textwrap.wrap(line.text, room, break_long_words=False, break_on_hyphens=False)
        say(about + first)
        for part in more:
            say(" " * len(about) + part)
