"""Where Python can be broken by one small change, and random draws of these.

Left out is what only people or type checkers read: docstrings, annotations, messages of errors, texts with
fields, lists of public names, and whether zip is strict.
"""

from __future__ import annotations

import ast
import random
import re
import subprocess
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from itertools import accumulate
from pathlib import Path

#: First and last character of a place, and what it becomes.
Change = tuple[int, int, str]
PACKAGE = "antenna_pin"
TOP = "package"  # the room of the modules that are in none
# Each for another of its kind.
COMPARED: dict[type[ast.cmpop], str] = {
    ast.Lt: ">=",
    ast.LtE: ">",
    ast.Gt: "<=",
    ast.GtE: "<",
    ast.Eq: "!=",
    ast.NotEq: "==",
    ast.Is: "is not",
    ast.IsNot: "is",
    ast.In: "not in",
    ast.NotIn: "in",
}
UNITS = {
    "s": "1/s",
    "m": "rad",
    "rad": "m",
    "N": "N m",
    "N m": "N",
    "J": "W",
    "kg": "N",
    "Hz": "rad/s",
    "m/s": "rad/s",
    "rad/s": "m/s",
    "m/s^2": "m/s",
}


_TIED = """
from pathlib import Path
from antenna_pin.compiled import jit
own = Path(jit.__file__)
print(*(path.relative_to(own.parents[2]) for path in (own, *jit.stamped_files())))
"""


@cache
def _compiled() -> frozenset[Path]:
    """Return the files that machine code is tied to, from the root of a tree."""
    # In a process of its own: this one starts the tests, which import the package of another tree.
    done = subprocess.run([sys.executable, "-c", _TIED], capture_output=True, text=True, check=True)
    return frozenset(map(Path, done.stdout.split()))


@dataclass(frozen=True, slots=True)
class Break:
    """One wrong change of one place."""

    room: str  # folder of the package
    path: Path  # of the file, from the root of the tree
    line: int  # of the place, from 1
    start: int  # first character in the text
    old: str  # what is there
    new: str  # what it becomes
    before: str  # rest of the first line before it
    after: str  # rest of the last line behind it
    names: frozenset[str]  # public names of the module

    @property
    def plain(self) -> bool:
        """Whether kernels have to run as plain Python, for theirs would be compiled anew."""
        return self.path in _compiled()

    @property
    def key(self) -> tuple[str, str, str]:
        """File, line as it is and as it becomes, by which the list of equivalent ones knows it."""
        line, changed = (f"{self.before}{text}{self.after}".strip() for text in (self.old, self.new))
        return str(self.path.relative_to(PACKAGE)), line, changed

    def kept(self, root: Path) -> dict[str, str]:
        """Return what finds it again in a tree that has changed (:func:`found_again`)."""
        text = (root / self.path).read_text(encoding="utf-8")
        line = f"\n{self.before}{self.old}{self.after}\n"
        return {
            "number": str(f"\n{text[: self.start]}".count(line)),
            "path": str(self.path),
            "before": self.before,
            "old": self.old,
            "after": self.after,
            "new": self.new,
        }

    def made(self, text: str) -> str:
        """Return the text of the file with the change."""
        return text[: self.start] + self.new + text[self.start + len(self.old) :]

    def __str__(self) -> str:
        _, old, new = self.key
        return f"{self.path}:{self.line}: {old!r} -> {new!r}"


@cache
def folders(root: Path) -> dict[str, Path]:
    """Return the packages that have tests of their own, by their names."""
    below = [one for one in sorted((root / PACKAGE).rglob("*")) if any(one.glob("*.py"))]
    return {one.name: one for one in below if (root / "tests" / one.name).is_dir()}


def rooms(root: Path) -> list[str]:
    """Return the names of the packages that have tests of their own, and of the top."""
    return [*sorted(folders(root)), TOP]


def room_of(root: Path, file: Path) -> str:
    """Return the innermost package with tests that holds a file, by its path in the checkout."""
    homes = folders(root)
    return next((one for one in reversed(file.parts[:-1]) if one in homes), TOP)


def draw(root: Path, count: int, seed: int, room: str | None = None) -> list[Break]:
    """Return random breaks: rooms take turns, and a longer draw begins as a shorter one of the same seed."""
    names = [room] if room else rooms(root)
    turns = {name: _shuffled(root, name, seed) for name in names}
    found: list[Break] = []
    while len(found) < count and turns:
        for name in list(turns):
            one = next(turns[name], None)
            if one is None:
                del turns[name]
            elif len(found) < count:
                found.append(one)
    return found


def _shuffled(root: Path, room: str, seed: int) -> Iterator[Break]:
    every = list(_places(root, room))
    random.Random(f"{seed} {room}").shuffle(every)
    for file, change in every:
        yield _made(file.read_text(encoding="utf-8"), change, room, file.relative_to(root))


@cache
def _places(root: Path, room: str) -> tuple[tuple[Path, Change], ...]:
    every = sorted((root / PACKAGE).rglob("*.py"))
    files = [one for one in every if room_of(root, one.relative_to(root)) == room]
    return tuple((file, one) for file in files for one in _changes(file.read_text(encoding="utf-8")))


def found_again(root: Path, kept: Mapping[str, str]) -> Break | None:
    """Return a break that was drawn before where its line is now; None if the line is gone.

    Args:
        root: Of the tree.
        kept: Its file, old and new text, rest of the line before and behind it, number of equal lines above.
    """
    before, old, after = kept["before"], kept["old"], kept["after"]
    text, path = f"\n{before}{old}{after}\n", root / kept["path"]
    room = path.parent
    near = sorted(room.rglob("*.py")) if room.is_dir() else []
    for file in [path, *near, *sorted((root / PACKAGE).rglob("*.py"))]:
        if file.exists() and text in (content := "\n" + file.read_text(encoding="utf-8")):
            starts = [one.start() + len(before) for one in re.finditer(re.escape(text), content)]
            start = starts[min(int(kept["number"]), len(starts) - 1)]
            place = file.relative_to(root)
            change = (start, start + len(old), kept["new"])
            return _made(content[1:], change, room_of(root, place), place)
    return None


def sites(text: str, room: str, path: Path) -> list[Break]:
    """Return all breaks of a file's text."""
    return [_made(text, change, room, path) for change in _changes(text)]


def _made(text: str, change: Change, room: str, path: Path) -> Break:
    begin, end, new = change
    first, last = text.rfind("\n", 0, begin) + 1, text.find("\n", end)
    before, after = text[first:begin], text[end : last if last >= 0 else len(text)]
    public = frozenset(
        node.name
        for node in ast.parse(text).body
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and not node.name.startswith("_")
    )
    line = text.count("\n", 0, begin) + 1
    return Break(room, path, line, begin, text[begin:end], new, before, after, public)


def _changes(text: str) -> Iterator[Change]:
    """Yield first and last character of what is changed, and what it becomes."""
    lines = text.splitlines(keepends=True)
    starts = [0, *accumulate(map(len, lines))]

    def at(line: int, column: int) -> int:
        row = lines[line - 1]
        return starts[line - 1] + (column if row.isascii() else len(row.encode()[:column].decode()))

    def span(node: ast.AST) -> tuple[int, int]:
        return at(node.lineno, node.col_offset), at(node.end_lineno, node.end_col_offset)  # type: ignore[attr-defined]

    def source(node: ast.AST) -> str:
        begin, end = span(node)
        return text[begin:end]

    def within(node: ast.expr) -> str:
        # A part of a line may lean on brackets of what it stands in.
        return f"({source(node)})"

    for node in _read(ast.parse(text)):
        if isinstance(node, ast.Constant):
            new = _constant(node.value)
            if new is not None:
                yield (*span(node), new)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            yield (*span(node), within(node.operand))
        elif isinstance(node, ast.BinOp):
            yield from _operation(node, span, within)
        elif isinstance(node, ast.BoolOp):
            word = " or " if isinstance(node.op, ast.And) else " and "
            yield (*span(node), f"({word.join(within(one) for one in node.values)})")
            yield (*span(node), within(node.values[0]))
        elif isinstance(node, ast.Compare) and len(node.ops) == 1:
            word = COMPARED[type(node.ops[0])]
            yield (*span(node), f"({within(node.left)} {word} {within(node.comparators[0])})")
        elif isinstance(node, ast.Call) and len(node.args) >= 2:
            one, other = node.args[:2]
            apart = source(one) != source(other)
            if apart and not any(isinstance(arg, ast.Starred | ast.GeneratorExp) for arg in (one, other)):
                begin, end = span(one)[0], span(other)[1]
                between = text[span(one)[1] : span(other)[0]]
                yield begin, end, f"{source(other)}{between}{source(one)}"


def _operation(
    node: ast.BinOp, span: Callable[[ast.AST], tuple[int, int]], within: Callable[[ast.expr], str]
) -> Iterator[Change]:
    left, right = within(node.left), within(node.right)
    if _is_text(node.left) or _is_text(node.right):
        return  # of texts
    pairs = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*"}
    word = pairs.get(type(node.op))
    if word is not None:
        yield (*span(node), f"({left} {word} {right})")
    if isinstance(node.op, ast.Mult | ast.Div):  # without a factor
        yield (*span(node), left)
    if isinstance(node.op, ast.MatMult | ast.Sub):  # turned round
        sign = "@" if isinstance(node.op, ast.MatMult) else "-"
        yield (*span(node), f"({right} {sign} {left})")


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.JoinedStr) or (
        isinstance(node, ast.Constant) and not isinstance(node.value, int | float)
    )


def _constant(value: object) -> str | None:
    """Return another constant of its kind; None where there is none."""
    if isinstance(value, bool):
        return str(not value)
    if isinstance(value, int):
        return str(value + 1)
    if isinstance(value, float):
        return repr(1.5 * value) if value else "1.0"
    if isinstance(value, str) and value in UNITS:
        return repr(UNITS[value])
    return None


def _read(tree: ast.Module) -> Iterator[ast.AST]:
    """Yield the nodes of what is run, but for what the module's docstring leaves out."""
    nodes: list[ast.AST] = [tree]
    while nodes:
        node = nodes.pop()
        yield node
        below: list[ast.AST] = []
        for name, value in ast.iter_fields(node):
            if name not in ("annotation", "returns", "type_params"):
                children = value if isinstance(value, list) else [value]
                below += [one for one in children if isinstance(one, ast.AST) and not _is_left_out(one)]
        nodes += reversed(below)


def _is_left_out(node: ast.AST) -> bool:
    if isinstance(node, ast.Raise | ast.JoinedStr | ast.Import | ast.ImportFrom):
        return True
    if isinstance(node, ast.keyword):  # of zip: an assertion
        return node.arg == "strict"
    if isinstance(node, ast.Assign):
        return any(isinstance(one, ast.Name) and one.id == "__all__" for one in node.targets)
    if isinstance(node, ast.If):
        return isinstance(node.test, ast.Name) and node.test.id == "TYPE_CHECKING"
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
