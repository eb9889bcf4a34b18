"""Tables of a study: what would be run, how runs ended, which failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import TYPE_CHECKING

from antenna_pin.base.readable import lasting, number, prefixed
from antenna_pin.cli._common import say
from antenna_pin.cli._tables import number_text, print_rows

if TYPE_CHECKING:
    import xarray as xr

    from antenna_pin.sweep import Design, RunTime

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
    """Return what a study takes, in words: a range where the pace of runs changes on their way."""
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
    """Whether all combinations of chosen values were run; statistics say something of drawn ones only."""
    return str(table.attrs["method"]) == "grid"


def grid_rows(table: xr.Dataset) -> tuple[list[str], list[list[str]], int]:
    """Return head and rows of a grid's runs, values against responses, and how many are not shown.

    A column has one prefix for all of its numbers.
    """
    like = table["outcome"]
    head, columns = ["run"], [list(map(str, range(min(like.size, _GRID))))]
    for name in (*parameters_of(table), *responses_of(table)):
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
    """Print what the runs of a grid came to, a row each."""
    head, rows, more = grid_rows(table)
    print_rows(f"{name}: {table['outcome'].size} runs", head, rows)
    if more:
        say(f"... and {more} more; --csv of antenna-pin study show has all")


def responses_of(table: xr.Dataset) -> list[str]:
    """Return the names of a study's responses."""
    import json

    return list(json.loads(table.attrs["responses"]))


def print_outcomes(name: str, table: xr.Dataset) -> None:
    """Print how runs ended: in a line where all came to their end."""
    head, rows = outcome_rows(table)
    if len(rows) == 1 and rows[0][0] == "COMPLETED":
        said = f", {rows[0][2]} s each" if rows[0][2] else ""
        say(f"{name}: {table['outcome'].size} runs completed{said}")
    else:
        print_rows(f"{name}: how {table['outcome'].size} runs ended", head, rows)


def failures(table: xr.Dataset) -> Iterator[tuple[int, str, str, str]]:
    """Yield runs that ended early or do not balance: number, values of the parameters, outcome, message."""
    import numpy as np

    outcomes = table["outcome"].values
    for place in np.argwhere(~np.isin(outcomes, ("COMPLETED", "STOPPED", "PENDING"))):
        index = dict(zip(table["outcome"].dims, map(int, place), strict=True))
        one = table.isel(index)
        values = ", ".join(f"{name} = {value_text(one[name])}" for name in parameters_of(table))
        yield int(one["run"]), values, str(one["outcome"].item()), str(one["message"].item())


def parameters_of(table: xr.Dataset) -> list[str]:
    """Return the names of a study's parameters."""
    import json

    return list(json.loads(table.attrs["parameters"]))


def value_text(value: xr.DataArray) -> str:
    """Return a parameter's value with its unit."""
    if value.dtype.kind not in "fi":
        return str(value.item())
    units = value.attrs.get("units", "")
    return f"{float(value):.6g}{f' {units}' if units not in ('', '1') else ''}"
