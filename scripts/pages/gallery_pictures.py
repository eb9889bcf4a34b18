"""Figures of a script of the gallery: they belong to no window, in which the gallery would look for them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

_DPI = 130


def figures_of_example(block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Save the figures that a block of a script has made, and return how they stand in its page.

    Args:
        block: The block; what it has made is among the variables.
        variables: Of the script so far, and where its pictures go.
        settings: Of the gallery.
    """
    shown = variables.setdefault("shown", [])
    made: list[str] = []
    for one in variables["example_globals"].values():
        if isinstance(one, Figure) and not any(one is other for other in shown):
            shown.append(one)
            made.append(str(next(variables["image_path_iterator"])))
            Path(made[-1]).parent.mkdir(parents=True, exist_ok=True)
            one.savefig(made[-1], dpi=_DPI)
    return figure_rst(made, settings["src_dir"])
