"""Which tests run which drawn places: probes in a copy of the tree, and a plugin of pytest that reads them.

A probe is a line of its own before the statement of a place; it writes the place's number, once for each test
and process, to the file that the environment names. What a fixture runs counts for all tests of the file.
"""

from __future__ import annotations

import ast
import json
import os
import time
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import pytest
from break_sites import Break

#: Of a file of one phase of one test; of the folder with all of them.
FILE, FOLDER = "BREAK_HITS", "BREAK_HITS_IN"
PROBE = """
import os

seen = set()


def hit(number):
    file = os.environ.get("BREAK_HITS")
    if file is None or (file, number) in seen:
        return
    seen.add((file, number))
    with open(file, "a") as out:
        out.write(f"{number}\\n")
"""


def statement_of(text: str, start: int) -> int | None:
    """Return the line, from 1, of the statement in a function that a place is in; None if there is none."""
    lines = text.splitlines(keepends=True)
    place = (text.count("\n", 0, start) + 1, len(text[text.rfind("\n", 0, start) + 1 : start].encode()))
    found = None
    nodes: list[tuple[ast.AST, bool]] = [(ast.parse(text), False)]
    while nodes:
        node, within = nodes.pop()
        for name, value in ast.iter_fields(node):
            # Arguments and decorators are of the statement around; a class's body is run at its import.
            inside = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) or within
            if isinstance(node, ast.ClassDef):
                inside = False
            for one in value if isinstance(value, list) else [value]:
                if not isinstance(one, ast.AST) or not _covers(one, place):
                    continue
                if isinstance(one, ast.stmt) and inside and not _is_elif(node, name, one, lines):
                    found = one.lineno if not _decorators(one) else _decorators(one)[0].lineno
                elif isinstance(one, ast.stmt) and not inside:
                    found = None
                nodes.append((one, inside))
    return found


def _covers(node: ast.AST, place: tuple[int, int]) -> bool:
    if not hasattr(node, "lineno"):
        return True
    first = min([(node.lineno, node.col_offset), *((d.lineno, 0) for d in _decorators(node))])  # type: ignore[attr-defined]
    return bool(first <= place < (node.end_lineno, node.end_col_offset))  # type: ignore[attr-defined]


def _decorators(node: ast.AST) -> list[ast.expr]:
    return list(getattr(node, "decorator_list", ()))


def _is_elif(above: ast.AST, name: str, node: ast.stmt, lines: list[str]) -> bool:
    text = lines[node.lineno - 1].lstrip()
    return isinstance(above, ast.If) and name == "orelse" and text.startswith("elif")


def put_probes(tree: Path, drawn: Iterable[tuple[int, Break]]) -> set[int]:
    """Put probes before the statements of breaks that are in functions of no kernel; return their numbers."""
    (tree / "break_hit.py").write_text(PROBE, encoding="utf-8")
    lines: dict[Path, dict[int, list[int]]] = defaultdict(lambda: defaultdict(list))
    for number, broken in drawn:
        text = (tree / broken.path).read_text(encoding="utf-8")
        line = None if broken.plain else statement_of(text, broken.start)
        if line is not None:
            lines[broken.path][line].append(number)
    for path, places in lines.items():
        rows = (tree / path).read_text(encoding="utf-8").splitlines(keepends=True)
        for line in sorted(places, reverse=True):
            indent = rows[line - 1][: len(rows[line - 1]) - len(rows[line - 1].lstrip())]
            rows[line - 1 : line - 1] = [
                f'{indent}__import__("break_hit").hit({number})\n' for number in places[line]
            ]
        (tree / path).write_text("".join(rows), encoding="utf-8")
    return {number for places in lines.values() for numbers in places.values() for number in numbers}


@dataclass(frozen=True)
class Hits:
    """Tests that run a place, and the seconds that they take."""

    of: dict[int, list[str]]  # names of tests of each number
    seconds: dict[str, float]  # of each test [s]

    @classmethod
    def read(cls, folder: Path, numbers: Iterable[int]) -> Hits:
        """Gather what a run of tests has written."""
        seconds: dict[str, float] = {}
        for file in folder.glob("seconds-*"):
            seconds |= dict(json.loads(line) for line in file.read_text(encoding="utf-8").splitlines())
        in_file: dict[str, list[str]] = defaultdict(list)
        for name in seconds:
            in_file[name.partition("::")[0]].append(name)
        of: dict[int, set[str]] = {number: set() for number in numbers}
        for file in folder.glob("*.name"):
            name, phase = json.loads(file.read_text(encoding="utf-8"))
            hits = file.with_suffix(".hits")
            if hits.exists():
                here = [name] if phase == "call" else in_file[name.partition("::")[0]]
                for number in map(int, hits.read_text(encoding="utf-8").split()):
                    of[number] |= {one for one in here if one in seconds}
        return cls({number: sorted(names) for number, names in of.items()}, seconds)

    def save(self, path: Path) -> None:
        """Write them to a file of JSON."""
        path.write_text(json.dumps(asdict(self)), encoding="utf-8")

    @classmethod
    def load(cls, path: Path) -> Hits:
        """Read them from such a file."""
        read = json.loads(path.read_text(encoding="utf-8"))
        return cls({int(number): names for number, names in read["of"].items()}, read["seconds"])

    def tests(self, number: int, folders: tuple[str, ...]) -> list[str]:
        """Return the tests in some folders that run a place, whole files together, quick files first."""
        files: dict[str, list[str]] = defaultdict(list)
        for name in self.of[number]:
            if name.startswith(folders):
                files[name.partition("::")[0]].append(name)
        cost = {file: sum(self.seconds[name] for name in names) for file, names in files.items()}
        return [name for file in sorted(files, key=cost.__getitem__) for name in files[file]]


# --- plugin of pytest: -p break_hits ---

_count = 0


def _begin(item: pytest.Item, phase: str) -> None:
    global _count
    _count += 1
    stem = Path(os.environ[FOLDER]) / f"{os.getpid()}-{_count}"
    stem.with_suffix(".name").write_text(json.dumps([item.nodeid, phase]), encoding="utf-8")
    os.environ[FILE] = str(stem.with_suffix(".hits"))


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Count what is run from here on as a fixture's."""
    _begin(item, "setup")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_call(item: pytest.Item) -> None:
    """Count what is run from here on as the test's."""
    _begin(item, "call")


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[Any]:
    """Time the test."""
    began = time.perf_counter()
    yield
    with open(Path(os.environ[FOLDER]) / f"seconds-{os.getpid()}", "a", encoding="utf-8") as out:
        out.write(json.dumps([item.nodeid, time.perf_counter() - began]) + "\n")
