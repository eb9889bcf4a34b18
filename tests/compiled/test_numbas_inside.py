"""What is used of Numba's inside is what the page on compiled code lists; the installed version has it."""

import ast
import importlib
import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement

import antenna_pin

PACKAGE = Path(antenna_pin.__file__).parent
ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "project" / "compiled-code.md"
DOCUMENTED = {"numba", "numba.types", "numba.extending", "llvmlite.ir"}


def imported():
    """Return the modules of Numba and llvmlite that each file imports from, by module."""
    found = {}
    for path in (*(PACKAGE / "compiled").glob("*.py"), PACKAGE / "elements" / "given_links.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] in (
                "numba",
                "llvmlite",
            ):
                inner = {f"{node.module}.{one.name}" for one in node.names}
                modules = {one for one in inner if is_module(one)} or {node.module}
                for module in modules - DOCUMENTED:
                    found.setdefault(module, set()).add(path.name)
    return found


def is_module(name):
    try:
        importlib.import_module(name)
    except ModuleNotFoundError:
        return False
    return True


def test_the_page_lists_every_module_and_where_it_is_used():
    rows = re.findall(r"^\| `([\w.]+)` \| (.*?) \|", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    listed = {name: set(re.findall(r"`([\w.]+)`", files)) for name, files in rows}
    # What a module of another is imported from counts as that module.
    own = {}
    for name, files in imported().items():
        key = next((one for one in listed if name == one or name.startswith(f"{one}.")), name)
        own.setdefault(key, set()).update(files)
    assert own == listed


def test_the_version_is_one_that_was_looked_into():
    """An upper bound stands in pyproject.toml, in the page, and holds what is installed."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    wanted = project["optional-dependencies"]["compile"]
    by_name = {one.name: one for one in map(Requirement, wanted)}
    for name in ("numba", "llvmlite"):
        assert any(one.operator == "<" for one in by_name[name].specifier), name
        assert by_name[name].specifier.contains(importlib.import_module(name).__version__), name
    stated = re.search(r"`numba(>=[\d.]+,<[\d.]+)`", PAGE.read_text(encoding="utf-8"))[1]
    assert set(stated.split(",")) == set(str(by_name["numba"].specifier).split(","))
