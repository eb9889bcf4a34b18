"""The tutorials that are notebooks in text: their imports are public, and their form is what the site runs.

The site's build runs them, and ends where a cell of one raises (``nb_execution_raise_on_error``).
"""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
CELL = re.compile(r"^```\{code-cell\} ipython3\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NOTEBOOKS = sorted(
    path
    for path in (ROOT / "docs" / "tutorials").glob("*.md")
    if "\nfile_format: mystnb\n" in path.read_text()
)


def notebooks(test):
    return pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)(test)


def test_there_are_notebooks():
    names = {path.stem for path in NOTEBOOKS}
    assert names >= {"first_run", "own_mechanism", "sweep", "orbit", "shaken_hinge", "deployment"}


@notebooks
def test_what_it_imports_is_public(path):
    """A name that has gone fails here within a second, not in a minute of the site's build."""
    cells = [cell for cell in CELL.findall(path.read_text()) if not cell.startswith("%%")]
    for node in ast.walk(ast.parse("\n".join(cells))):
        if isinstance(node, ast.ImportFrom) and str(node.module).startswith("antenna_pin"):
            module = importlib.import_module(str(node.module))
            for alias in node.names:
                assert not alias.name.startswith("_")
                assert hasattr(module, alias.name), f"{node.module}.{alias.name}"


@notebooks
def test_its_files_are_sound(path, tmp_path):
    """Scenarios and studies that it writes are read as it reads them, before anything is run."""
    from antenna_pin import load_scenario, load_study

    names = []
    for cell in CELL.findall(path.read_text()):
        if cell.startswith("%%writefile "):
            head, _, text = cell.partition("\n")
            names.append(head.removeprefix("%%writefile "))
            (tmp_path / names[-1]).write_text(text)
    for name in names:
        if name.endswith(".study.toml"):
            load_study(tmp_path / name)
        elif name.endswith(".toml"):
            load_scenario(tmp_path / name)


@notebooks
def test_its_lines_of_code_are_seen_whole(path):
    """The site's column holds 88 letters beside the navigation; what is longer has to be scrolled."""
    assert [
        line for cell in CELL.findall(path.read_text()) for line in cell.splitlines() if len(line) > 88
    ] == []
