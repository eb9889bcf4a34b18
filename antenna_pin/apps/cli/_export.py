"""Output other than tables: JSON, CSV, datasets, figures."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from antenna_pin.apps.cli._common import figure_folder, figure_formats, figure_target, writable_file
from antenna_pin.apps.cli._usage import command_of
from antenna_pin.base import tables
from antenna_pin.base.files import replacing

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


def targets_of(out: Path | None, plot: Path | None) -> tuple[Path | None, Path | None]:
    """Return the files of a dataset and a figure, or refuse them."""
    return None if out is None else writable_file(out, ".nc"), figure_target(plot, "figure", "--plot")


def save_both(
    table: xr.Dataset,
    drawn: Callable[[], Figure],
    targets: tuple[Path | None, Path | None],
    context: typer.Context,
    silent: bool = False,
) -> None:
    """Write the requested dataset and figure, and print their paths."""
    out, plot = targets
    table.attrs["command"] = command_of(context)
    if out is not None:
        from antenna_pin.trajectory import save_table

        save_table(table, out)
        if not silent:
            typer.echo(f"saved {out}")
    if plot is not None:
        save_plot(drawn(), plot, silent)


def save_plot(figure: Figure, path: Path, silent: bool = False) -> None:
    """Write a figure and print its path."""
    from antenna_pin.show.plot import save_figure

    save_figure(figure, path.with_suffix(""), [path.suffix[1:]])
    if not silent:
        typer.echo(f"saved {path}")


def csv_target(path: Path | None) -> Path | None:
    """Return the CSV file to write, if any, or refuse it."""
    return None if path is None else writable_file(path, ".csv")


def say_json(facts: Mapping[str, Any]) -> None:
    """Print a JSON object on one line; null stands where there is no number."""
    typer.echo(json.dumps(plain(facts), allow_nan=False))


def write_csv(path: Path, head: Sequence[str], rows: Iterable[Sequence[Any]], silent: bool = False) -> None:
    """Write a CSV file (:func:`antenna_pin.base.tables.write_csv`) and print its path."""
    with replacing(path) as partial, partial.open("w", newline="", encoding="utf-8") as stream:
        tables.write_csv(stream, head, (plain(row) for row in rows))
    if not silent:
        typer.echo(f"saved {path}")


def exported(
    facts: Mapping[str, Any], rows: Sequence[Mapping[str, Any]], as_json: bool, target: Path | None
) -> bool:
    """Write the requested JSON and CSV; return whether there was a request."""
    if target is not None:
        write_csv(target, *rows_of(rows), silent=as_json)
    if as_json:
        say_json(facts)
    return as_json or target is not None


def rows_of(summaries: Sequence[Mapping[str, Any]]) -> tuple[list[str], list[list[Any]]]:
    """Return head and rows of a table with one row for each summary."""
    head = list(dict.fromkeys(name for summary in summaries for name in summary))
    return head, [[summary.get(name) for name in head] for summary in summaries]


def parts_of(facts: Mapping[str, Any], names: Sequence[str]) -> list[dict[str, Any]]:
    """Return part, subject, quantity and value of each number in the named parts.

    A part is a list of tables, each of which says by ``of`` or ``joint`` what it is of.
    """
    rows: list[dict[str, Any]] = []
    for name in names:
        for one in facts.get(name) or ():
            about = one.get("of", one.get("joint", ""))
            for quantity, value in one.items():
                if quantity in ("of", "joint"):
                    continue
                if isinstance(value, (list, tuple)):
                    value = dict(enumerate(value, 1))
                many = value.items() if isinstance(value, Mapping) else [("", value)]
                rows += [
                    {"part": name, "of": about, "quantity": f"{quantity} {key}".rstrip(), "value": each}
                    for key, each in many
                ]
    return rows


def plain(value: Any) -> Any:
    """Return a value as JSON holds it: None for NaN, text for unknown types."""
    if isinstance(value, Mapping):
        return plain_dict(value)
    if isinstance(value, (list, tuple)):
        return [plain(each) for each in value]
    if hasattr(value, "item"):
        value = value.item()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, (bool, int, str)) else str(value)


def plain_dict(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return plain values by name (:func:`plain`)."""
    return {str(name): plain(value) for name, value in values.items()}


def figures_asked(out: Path | None, formats: str) -> list[str]:
    """Return the requested formats of figures, or refuse a folder that is a file."""
    if out is not None:
        figure_folder(out)
    return figure_formats(formats)


def save_figures(figures: Mapping[str, Figure], out: Path, suffixes: Sequence[str]) -> None:
    """Write figures of contact laws and print their paths."""
    from antenna_pin.show.plot import save_contact_figures

    for path in save_contact_figures(figures, out, suffixes):
        typer.echo(path)
