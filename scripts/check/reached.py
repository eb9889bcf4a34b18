#!/usr/bin/env python3
"""Tests that a change reaches, by the imports of tests and package.

    scripts/check/reached.py            # of what differs from the last commit
    scripts/check/reached.py main       # of what differs from a branch

A test is reached if it imports a changed file, directly or through others; names that a package exports are
imports of the file that holds them, and a test of the command line imports the commands that it names. Of a
changed file that is no module, tests are reached that name it or its folder; all of them are by files that
every test depends on. ``scripts/test --changed [REVISION]`` runs them.
"""

from __future__ import annotations

import ast
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
_OF_ALL = ("pyproject.toml", "constraints.txt", "tests/conftest.py")


def changed_files(root: Path, revision: str) -> set[str]:
    """Return the files of a checkout that differ from a revision, or are new."""
    commands = (("diff", "--name-only", revision), ("ls-files", "--others", "--exclude-standard"))
    answers = [
        subprocess.run(("git", *words), cwd=root, capture_output=True, text=True, check=True)
        for words in commands
    ]
    return {line for answer in answers for line in answer.stdout.splitlines()}


def reached(root: Path, changed: set[str]) -> list[str]:
    """Return the files of tests that a change reaches, sorted."""
    tests = sorted(root.glob("tests/**/test_*.py"))
    if changed.intersection(_OF_ALL):
        return [str(one.relative_to(root)) for one in tests]
    files = [
        one for folder in ("antenna_pin", "tests", "scripts") for one in sorted((root / folder).rglob("*.py"))
    ]
    users: dict[Path, set[Path]] = {}
    for file in files:
        for imported in _imports(root, file):
            users.setdefault(imported, set()).add(file)
    found, left = set(), [root / one for one in changed]
    while left:
        file = left.pop()
        if file not in found:
            found.add(file)
            left += users.get(file, ())
    others = {one for one in changed if not one.endswith((".py", ".pyi"))}
    words = {part for one in others for part in (Path(one).name, Path(one).parent.name) if part}
    named = [one for one in tests if words and any(word in one.read_text(encoding="utf-8") for word in words)]
    return sorted({str(one.relative_to(root)) for one in [*found, *named] if one in set(tests)})


def _imports(root: Path, file: Path) -> Iterator[Path]:
    """Yield the files that a file imports, wherever in it; of a test also its conftest.py and commands."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for one in node.names:
                yield from _files(root, one.name)
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            homes = _homes(root, node.module)
            for one in node.names:
                yield from _files(root, homes.get(one.name, node.module))
                yield from _files(root, f"{node.module}.{one.name}")
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            name = node.value.partition(".")[0]  # of a command, or in a registry: "spring.JointSpring"
            folder = root / "antenna_pin" / "apps" / "cli" if file.name.startswith("test_") else file.parent
            if name.isidentifier() and (named := folder / f"{name}.py").is_file():
                yield named
    if (own := file.with_name("conftest.py")).is_file() and own.parent.name != "tests":
        yield own


@cache
def _files(root: Path, module: str) -> tuple[Path, ...]:
    """Return the file of a module: of the package, or of a folder that tests and scripts import from."""
    path = Path(*module.split("."))
    for folder in (root, root / "tests" / "reference", *sorted(_folders(root))):
        for file in (folder / path.with_suffix(".py"), folder / path / "__init__.py"):
            if file.is_file():
                return (file,)
    return ()


@cache
def _folders(root: Path) -> frozenset[Path]:
    return frozenset(one for one in (root / "scripts").iterdir() if one.is_dir())


@cache
def _homes(root: Path, package: str) -> dict[str, str]:
    """Return the modules that hold the names that a package exports."""
    stub = root / Path(*package.split(".")) / "__init__.pyi"
    lines = [line.split() for line in stub.read_text().splitlines()] if stub.is_file() else []
    return {words[-1]: words[1] for words in lines if words[:1] == ["from"]}


if __name__ == "__main__":
    print("\n".join(reached(ROOT, changed_files(ROOT, *(sys.argv[1:] or ["HEAD"])))))
