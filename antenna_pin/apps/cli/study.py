"""``antenna-pin study``: a study's results in tables, figures and a report.

Errors leave here as exceptions; :mod:`antenna_pin.apps.cli` turns them into one line and an exit code.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from antenna_pin.apps.cli import _options as options
from antenna_pin.apps.cli._common import figure_folder, figure_formats, say, writable_file
from antenna_pin.apps.cli._export import csv_target, exported
from antenna_pin.apps.cli._options import argument, flag, option
from antenna_pin.apps.cli._tables import number_text, print_rows
from antenna_pin.apps.cli._usage import command_group
from antenna_pin.base.readable import lasting, number, prefixed
from antenna_pin.errors import UnknownNameError

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.studies.sweep import Design, RunTime


_SHOWN = 12  # runs of a dry run's table
_GRID = 40  # runs of a grid, a row each
_ALIKE = 2.0  # times the least estimate of a time up to which the greatest is no other


def run_rows(design: Design) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of the first runs of a study: number, parameters."""
    head = ["run", *(column.name for column in design.columns)]
    rows = []
    for run in range(min(design.count, _SHOWN)):
        place = design.place(run)
        rows.append([str(run), *(c.settings.values[place[c.dim]].text for c in design.columns)])
    return head, rows


def said_of_time(runs: int, seconds: RunTime, cores: int) -> str:
    """Return a study's duration in words; a range where the runs differ in pace."""
    alike = seconds.most <= _ALIKE * seconds.least
    times = (seconds.mean,) if alike else (seconds.least, seconds.most)
    each = " to ".join(f"{one:.2g}" for one in times)
    whole = " to ".join(lasting(runs * one / min(cores, runs)) for one in times)
    where = "1 core" if cores == 1 else f"{cores} cores"
    return f"some {each} s a run, by trials of three of them; some {whole} on {where}"


def outcome_rows(table: xr.Dataset) -> tuple[list[str], list[list[str]]]:
    """Return head and rows of how runs ended: outcome, number, and the time of one."""
    import numpy as np

    outcomes = np.ravel(table["outcome"].values)
    wall = np.ravel(table["wall_time"].values)
    rows = []
    for outcome, count in Counter(map(str, outcomes)).most_common():
        mine = wall[outcomes == outcome]
        mean = float(mine.mean()) if np.isfinite(mine).all() else float("nan")
        rows.append([outcome, str(count), number_text(mean) if np.isfinite(mean) else ""])
    return ["", "runs", "time of one [s]"], rows


def is_grid(table: xr.Dataset) -> bool:
    """Return whether the runs form a grid, which has no statistics."""
    return str(table.attrs["method"]) == "grid"


def grid_rows(table: xr.Dataset) -> tuple[list[str], list[list[str]], int]:
    """Return head and rows of a grid's runs, and the number of hidden ones.

    A column has one prefix for all of its numbers.
    """
    like = table["outcome"]
    head, columns = ["run"], [list(map(str, range(min(like.size, _GRID))))]
    for name in (*names_of(table, "parameters"), *names_of(table, "responses")):
        values = table[name].broadcast_like(like).transpose(*like.dims).values.ravel()[:_GRID].tolist()
        units, title = str(table[name].attrs.get("units", "")), name
        if table[name].dtype.kind in "fi":
            factor, unit = prefixed(units, values)
            title += f" [{unit}]" if unit else ""
            columns.append([number(float(value) * factor) for value in values])
        else:
            columns.append(list(map(str, values)))
        head.append(title)
    outcomes = like.values.ravel()[:_GRID].tolist()
    if set(outcomes) != {"COMPLETED"}:
        head.append("outcome")
        columns.append(outcomes)
    return head, [list(row) for row in zip(*columns, strict=True)], max(like.size - _GRID, 0)


def print_grid(name: str, table: xr.Dataset) -> None:
    """Print the responses of a grid's runs, a row each."""
    head, rows, more = grid_rows(table)
    print_rows(f"{name}: {table['outcome'].size} runs", head, rows)
    if more:
        say(f"... and {more} more; --csv of antenna-pin study show has all")


def names_of(table: xr.Dataset, part: str) -> list[str]:
    """Return the names of a study's ``parameters`` or ``responses``."""
    return list(json.loads(table.attrs[part]))


def print_outcomes(name: str, table: xr.Dataset) -> None:
    """Print how runs ended: in a line where all came to their end."""
    head, rows = outcome_rows(table)
    if len(rows) == 1 and rows[0][0] == "COMPLETED":
        said = f", {rows[0][2]} s each" if rows[0][2] else ""
        say(f"{name}: {table['outcome'].size} runs completed{said}")
    else:
        print_rows(f"{name}: how {table['outcome'].size} runs ended", head, rows)


def failures(table: xr.Dataset) -> Iterator[tuple[int, str, str, str]]:
    """Yield number, parameters, outcome, message of runs that ended early or do not balance."""
    import numpy as np

    outcomes = table["outcome"].values
    for place in np.argwhere(~np.isin(outcomes, ("COMPLETED", "STOPPED", "PENDING"))):
        index = dict(zip(table["outcome"].dims, map(int, place), strict=True))
        one = table.isel(index)
        values = ", ".join(f"{name} = {value_text(one[name])}" for name in names_of(table, "parameters"))
        yield int(one["run"]), values, str(one["outcome"].item()), str(one["message"].item())


def value_text(value: xr.DataArray) -> str:
    """Return a parameter's value with its unit."""
    if value.dtype.kind not in "fi":
        return str(value.item())
    units = value.attrs.get("units", "")
    return f"{float(value):.6g}{f' {units}' if units not in ('', '1') else ''}"


app = command_group("study", "Results of sweep: tables, figures, a report.")

StoreArgument = Annotated[Path, argument("Folder of a study, NAME.study.", "STORE")]

_SHARES = (0.05, 0.5, 0.95, 0.997)
_FAILURES = 20


def show(
    store: StoreArgument,
    failed: Annotated[bool, flag("--failed", "List all runs that ended early or do not balance.")] = False,
    as_json: options.Json = False,
    csv: options.Csv = None,
) -> None:
    """Print outcomes and responses of the runs; --csv and --json have every run."""
    import numpy as np

    from antenna_pin.studies.sweep import open_study, sensitivities
    from antenna_pin.studies.sweep.sensitivity import quantiles

    target = csv_target(csv)
    table = open_study(store)
    if as_json or target is not None:
        rows = _rows(table)
        about = {name: table.attrs[name] for name in ("title", "digest", "method")}
        exported({"file": str(store), **about, "runs": rows}, rows, as_json, target)
        return
    name = json.loads(table.attrs["study"])["name"]
    print_outcomes(name, table)
    bad = list(failures(table))
    if bad:
        shown = bad if failed else bad[:_FAILURES]
        rows_ = [[str(run), values, outcome, message] for run, values, outcome, message in shown]
        print_rows(
            f"{name}: what did not reach its end, or does not balance",
            ("run", "", "outcome", "why"),
            rows_,
            numbers=False,
        )
        if len(bad) > len(shown):
            typer.echo(f"... and {len(bad) - len(shown)} more; --failed lists all")
    if is_grid(table):
        print_grid(name, table)
        return
    head = ("", "smallest", *(f"{100.0 * share:g} %" for share in _SHARES), "largest", "mean")
    rows_ = []
    for response in names_of(table, "responses"):
        values = np.ravel(table[response].values).astype(float)
        values = values[np.isfinite(values)]
        if values.size:
            middle = quantiles(table, response, _SHARES)["quantile"].values
            numbers = (values.min(), *middle, values.max(), values.mean())
            rows_.append([_with_unit(table[response]), *(number_text(float(one)) for one in numbers)])
    print_rows(f"{name}: responses", head, rows_)
    if table.attrs["method"] in ("morris", "saltelli"):
        for response in names_of(table, "responses"):
            found = sensitivities(table, response)
            columns = list(map(str, found.data_vars))
            lines = [
                [str(factor), *(number_text(float(found[one].sel(factor=factor))) for one in columns)]
                for factor in found["factor"].values
            ]
            print_rows(f"{name}: sensitivities of {_with_unit(table[response])}", ("", *columns), lines)


def plot(
    store: StoreArgument,
    names: Annotated[
        list[str] | None, argument("Names of figures; all that the study allows if left out.", "[FIGURES...]")
    ] = None,
    out: Annotated[Path | None, option("Where to write; STORE/figures if left out.", "FOLDER")] = None,
    formats: options.FigureFormats = "png",
    width: options.FigureWidth = options.Width.COLUMN,
    listed: Annotated[bool, flag("--list", "List the figures, draw none.")] = False,
) -> None:
    """Draw responses over parameters, distributions, all against all, sensitivities."""
    from antenna_pin.show.views import figures_of_study
    from antenna_pin.studies.sweep import open_study

    suffixes = figure_formats(formats)
    table = open_study(store)

    figures = figures_of_study(table)
    if listed:
        for name, (title, _) in figures.items():
            say(f"{name}: {title}")
        return
    for name in names or ():
        if name not in figures:
            raise UnknownNameError(str(store), "figure", name, figures)

    from antenna_pin.show.plot import folder_for_figures, save_figure

    folder = folder_for_figures(figure_folder(out or store / "figures"))
    for name in names or figures:
        for path in save_figure(figures[name][1](width=width.value), folder / name, suffixes):
            typer.echo(path)


def report(
    store: StoreArgument,
    out: Annotated[Path, option("The report, an HTML file.", "FILE")],
    title: Annotated[str | None, option("Title; that of the study if left out.")] = None,
    figures: Annotated[bool, option("Draw figures.")] = True,
) -> None:
    """Write a report on a study: one HTML file for screen, phone and paper."""
    target = writable_file(out, ".html")

    from antenna_pin.show.report import study_report
    from antenna_pin.studies.sweep import open_study

    typer.echo(f"saved {study_report(open_study(store), title=title, figures=figures).save(target)}")


def _with_unit(response: xr.DataArray) -> str:
    units = response.attrs.get("units", "")
    return f"{response.name} [{units}]" if units not in ("", "1") else str(response.name)


def _rows(table: xr.Dataset) -> list[dict[str, Any]]:
    """Return every run in plain numbers."""
    import numpy as np

    like = table["outcome"]
    names = ["run", *names_of(table, "parameters"), *names_of(table, "responses")]
    names += ["outcome", "message", "end_time", "steps", "evaluations", "seed", "wall_time"]
    columns = {
        name: np.ravel(table[name].broadcast_like(like).transpose(*like.dims).values).tolist()
        for name in names
    }
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


for _command in (show, plot, report):
    app.command()(_command)
