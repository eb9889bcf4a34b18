"""What ``mutants.py`` breaks: the tables ``[[break]]`` of ``mutants/<room>.toml``, room by room.

A break is five lines::

    [[break]]
    note = "a damper loses with the wrong sign"
    file = "elements/spring.py"
    old = ".damping * rate * rate"
    new = ".damping * -rate * rate"
    tests = "tests/dynamics/test_elements.py -k damper"
"""

from __future__ import annotations

import shlex
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_PACKAGE = "antenna_pin"
_FOLDER = Path(__file__).with_name("mutants")


@dataclass(frozen=True, slots=True)
class Mutant:
    """One wrong change."""

    note: str  # what is wrong then
    file: str  # where, from the root of the tree; in the list, from the package on
    old: str  # text that stands there exactly once
    new: str  # what it becomes
    # What pytest is given: files, node ids, options; in the list one text, as in a shell.
    tests: tuple[str, ...] = ()
    equivalent: str = ""  # why nothing can notice it, if nothing can; it has no tests then, and is not run
    compiled: bool = False  # whether kernels are compiled, which takes up to a minute, or run as Python
    room: str = ""  # file of the list that it stands in

    @classmethod
    def of(cls, table: dict[str, Any], room: str) -> Mutant:
        """Return what a table of the list describes."""
        tests = tuple(shlex.split(table.get("tests", "")))
        return cls(**{**table, "file": f"{_PACKAGE}/{table['file']}", "tests": tests, "room": room})


MUTANTS = tuple(
    Mutant.of(table, path.stem)
    for path in sorted(_FOLDER.glob("*.toml"))
    for table in tomllib.loads(path.read_text(encoding="utf-8"))["break"]
)
