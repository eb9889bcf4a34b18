"""``antenna-pin plot`` of datasets beside runs: fits, orbits, diagrams and their like."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from antenna_pin.cli._common import refuse

if TYPE_CHECKING:
    from typing import Literal

    from antenna_pin.trajectory import TableKind

__all__ = ["draw_tables", "kinds_of"]


def kinds_of(files: Sequence[Path]) -> dict[Path, TableKind]:
    """Return which files hold a dataset that is no run, and of what."""
    from antenna_pin.trajectory import FORMATS, format_of

    kinds = {name: kind for kind, name in FORMATS.items()}
    said = {path: format_of(path) for path in files if path.is_file()}
    return {path: kinds[one] for path, one in said.items() if one in kinds}


def draw_tables(
    kinds: dict[Path, TableKind],
    out: Path,
    suffixes: Sequence[str],
    names: Sequence[str] | None,
    width: Literal["column", "page"],
) -> None:
    """Draw the figures of datasets, each called after its file, and print where they are."""
    from antenna_pin.plot import folder_for_figures, save_figure, table_figures
    from antenna_pin.trajectory import open_table

    wanted = [(path, one) for path, kind in kinds.items() for one in table_figures(open_table(path, kind))]
    known = list(dict.fromkeys(one.name for _, one in wanted))
    for name in names or ():
        if name not in known:
            refuse(f"plot: --figure must be one of {', '.join(known)}, got {name}")
    folder = folder_for_figures(out)
    for path, one in wanted:
        if names is None or one.name in names:
            for file in save_figure(one.draw(width=width), folder / f"{path.stem}-{one.name}", suffixes):
                typer.echo(file)
