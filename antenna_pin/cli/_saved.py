"""What commands that end in a dataset and a figure of it share."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from antenna_pin.cli._common import figure_target, writable_file
from antenna_pin.cli._usage import command_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

__all__ = ["PlotOption", "TableOption", "save_both", "targets_of"]

TableOption = Annotated[
    Path | None, typer.Option("--out", metavar="FILE", help="Dataset of the result, NAME.nc.")
]
PlotOption = Annotated[
    Path | None, typer.Option("--plot", metavar="FILE", help="Figure of the result: png, pdf or svg.")
]


def targets_of(out: Path | None, plot: Path | None) -> tuple[Path | None, Path | None]:
    """Return the files of a dataset and a figure, or say what keeps them from being some."""
    return None if out is None else writable_file(out, ".nc"), figure_target(plot, "figure", "--plot")


def save_both(
    table: xr.Dataset,
    drawn: Callable[[], Figure],
    targets: tuple[Path | None, Path | None],
    context: typer.Context,
    silent: bool = False,
) -> None:
    """Write a dataset, with the command that made it, and a figure of it, what is asked for, and say so."""
    out, plot = targets
    table.attrs["command"] = command_of(context)
    if out is not None:
        from antenna_pin.trajectory import save_table

        save_table(table, out)
    if plot is not None:
        from antenna_pin.plot import save_figure

        save_figure(drawn(), plot.with_suffix(""), [plot.suffix[1:]])
    for target in targets if not silent else ():
        if target is not None:
            typer.echo(f"saved {target}")
