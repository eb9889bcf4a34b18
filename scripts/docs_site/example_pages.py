"""The scripts and notebooks of ``scripts/examples`` as the gallery's source."""

from __future__ import annotations

import shutil
from pathlib import Path

ROOT = Path(__file__).parents[2]
__all__ = ["lay_out_examples"]

_HEADER = """Gallery
=======

Notebooks, with what they show:

.. toctree::
   :maxdepth: 1

   /scripts/examples/look_at_a_run
   /scripts/examples/pointing_budget

Scripts, a subject each:

"""


def lay_out_examples(folder: Path) -> None:
    """Put the examples into a source of the site."""
    place = folder / "scripts" / "examples"
    shutil.copytree(ROOT / "scripts" / "examples", place, ignore=shutil.ignore_patterns("__pycache__"))
    (place / "GALLERY_HEADER.rst").write_text(_HEADER)
    for path in place.glob("*.py"):
        text = path.read_text()
        first, rest = text.split("\n", 1)
        title = first.strip('"').split(":")[0].rstrip(".")
        path.write_text(f'"""{title}\n{"=" * len(title)}\n\n{first.strip(chr(34))}\n"""\n{rest}')
