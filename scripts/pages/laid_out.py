"""The source of the site: pages of the checkout where they stand there, and pages that are made."""

from __future__ import annotations

import filecmp
import importlib.metadata
import os
import shutil
import tempfile
from pathlib import Path

from command_pages import commands_page
from example_pages import GALLERIES, forget_galleries, lay_out_examples
from first_recording import add_recording
from model_pages import models_page
from name_pages import name_pages

ROOT = Path(__file__).parents[2]

_FILES = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "CITATION.cff", "LICENSE")
_FOLDERS = ("docs", "models", "antenna_pin")
_INDEX = (
    '<!doctype html><title>antenna_pin</title><meta http-equiv="refresh" content="0; url=docs/index.html">\n'
)


def lay_out(source: Path) -> None:
    """Make a folder the site's source; what has not changed keeps its time, so that it is not built again."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for name in _FILES:
            shutil.copy2(ROOT / name, folder / name)
        for name in _FOLDERS:
            shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__", ".*"))
        reference = folder / "docs" / "reference"
        (reference / "commands.md").write_text(commands_page())
        (reference / "models.md").write_text(models_page())
        (reference / "python").mkdir()
        for name, text in name_pages().items():
            (reference / "python" / f"{name}.rst").write_text(text)
        lay_out_examples(folder)
        (folder / "docs" / "extra").mkdir()
        (folder / "docs" / "extra" / "index.html").write_text(_INDEX)
        add_recording(folder / "docs")
        shutil.copy2(mathjax(), folder / "docs" / "_static" / "mathjax.js")
        _bring_over(folder, source)
        forget_galleries(source)


def mathjax() -> Path:
    """Return the script that draws formulas, with all it needs in one file.

    Raises:
        SystemExit: It is not installed.
    """
    try:
        files = importlib.metadata.files("sphinx-mathjax-offline") or []
    except importlib.metadata.PackageNotFoundError:
        files = []
    for file in files:
        if file.name == "tex-svg-full.js":
            return Path(str(file.locate()))
    raise SystemExit("docs: sphinx-mathjax-offline is not installed: pip install -e '.[docs]'")


def _bring_over(new: Path, old: Path) -> None:
    """Have a folder hold what another holds; files that are equal stay untouched."""
    wanted = {path.relative_to(new) for path in new.rglob("*") if path.is_file()}
    for path in sorted(old.rglob("*"), reverse=True):
        if any(path.is_relative_to(old / made) for made in GALLERIES.values()):
            continue  # the build's own: examples that have not changed are not run again
        if path.is_file() and path.relative_to(old) not in wanted:
            path.unlink()
        elif path.is_dir() and not any(path.iterdir()):
            path.rmdir()
    for name in wanted:
        there = old / name
        if not there.is_file() or not filecmp.cmp(new / name, there, shallow=False):
            there.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(new / name, there)
            os.utime(there)
