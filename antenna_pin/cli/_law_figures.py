"""Figures of contact laws beside what a command prints: where they go, and in which formats."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from antenna_pin.cli._common import figure_folder, figure_formats

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["figures_asked", "save_figures"]


def figures_asked(out: Path | None, formats: str) -> list[str]:
    """Return the formats of figures that may be asked for, and refuse a folder for them that is a file."""
    if out is not None:
        figure_folder(out)
    return figure_formats(formats)


def save_figures(figures: Mapping[str, Figure], out: Path, suffixes: Sequence[str]) -> None:
    """Write figures of contact laws and say where."""
    from antenna_pin.plot import save_contact_figures

    for path in save_contact_figures(figures, out, suffixes):
        typer.echo(path)
