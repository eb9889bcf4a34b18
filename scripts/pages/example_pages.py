"""The scripts that draw, and those that print with the notebooks beside them, as sources of two galleries."""

from __future__ import annotations

import ast
import shutil
from pathlib import Path

ROOT = Path(__file__).parents[2]

#: What the build makes of a folder of scripts.
GALLERIES = {"scripts/gallery": "docs/gallery", "scripts/examples": "docs/scripts"}
_HEADERS = {
    "scripts/gallery": """Gallery
=======

A picture each, by the lines that draw it. Beside them: :doc:`notebooks and scripts </docs/scripts/index>`.

.. toctree::
   :hidden:

   /docs/scripts/index

""",
    "scripts/examples": """Notebooks and scripts
=====================

Notebooks, with what they show:

.. toctree::
   :maxdepth: 1

   /scripts/examples/look_at_a_run
   /scripts/examples/pointing_budget

Scripts, a subject each:

""",
}


def as_page(text: str) -> str:
    """Return a script whose docstring begins with a heading: what its first line says before a colon."""
    module = ast.parse(text)
    said = ast.get_docstring(module) or ""
    first, _, more = said.partition("\n")
    title = first.split(":")[0].rstrip(".")
    rest = "\n".join(text.splitlines()[module.body[0].end_lineno or 1 :])
    whole = first if not more or first != f"{title}." else ""
    return f'"""{title}\n{"=" * len(title)}\n\n{whole}\n{more}\n"""\n{rest}\n'


def lay_out_examples(folder: Path) -> None:
    """Put the scripts and notebooks into a source of the site."""
    for name in GALLERIES:
        place = folder / name
        shutil.copytree(ROOT / name, place, ignore=shutil.ignore_patterns("__pycache__"))
        (place / "GALLERY_HEADER.rst").write_text(_HEADERS[name])
        for path in place.glob("*.py"):
            path.write_text(as_page(path.read_text()))


def forget_galleries(source: Path) -> None:
    """Take away what the build once made of scripts that are no more."""
    for name, made in GALLERIES.items():
        there = {path.stem for path in (ROOT / name).glob("*.py")} | {"index"}
        for path in (source / made).glob("*"):
            if path.is_file() and path.name.split(".")[0] not in there:
                path.unlink()
