"""Phase portraits, sections and bifurcation diagrams in a report: what they show and what was judged."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable

import numpy as np
import xarray as xr

from antenna_pin.analysis import portrait_of, recurrence
from antenna_pin.base.readable import number, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.plot import figure_bifurcation, figure_phase, figure_section
from antenna_pin.report._findings import Finding, Judged
from antenna_pin.report._page import Cell, Picture, Row, Section, Table, quantities
from antenna_pin.report.figures import picture

__all__ = ["diagram", "portrait", "section"]

_DENSE = 24  # rows of a table above which it is set small


def _statistics(name: str, values: np.ndarray, unit: str) -> Row:
    last = float(values[-1])
    return quantities(
        name, [float(values.min()), float(values.max()), float(values.mean()), last], unit, digits=6
    )


def _ranges(rows: list[Row], key: str, of: str) -> Table:
    columns = ("", "least", "largest", "mean", "last")
    return Table(columns=columns, rows=tuple(rows), caption=f"Range of the {of}", key=f"{key}-range")


def _picture(draw: Callable[[], object], caption: str, key: str, figures: bool) -> tuple[Picture, ...]:
    return (picture(draw(), caption, f"{key}-figure"),) if figures else ()


def portrait(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
    """Return the section of a phase portrait."""
    found = portrait_of(finding.table)
    rows = [_statistics(one.name, one.values, one.units) for one in found.quantities]
    every = [one.name for one in found.quantities]
    names = ", ".join(every) if len(every) > 2 else f"{every[1]} over {every[0]}"
    end = readable(float(found.time[-1]), "s")
    said = f"{names}, of {found.run} {found.rule}: {len(found.time)} samples to {end}"
    items: tuple[Table | Picture, ...] = (
        *_picture(lambda: figure_phase(found, width="column"), f"Phase portrait: {names}", key, figures),
        _ranges(rows, key, "quantities"),
    )
    part = Section(key=key, title=f"Phase portrait: {finding.label}", lead=(f"{said}.",), items=items)
    return part, Judged(finding.label, True, "phase portrait", said)


def section(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
    """Return the section of the points of a Poincare section."""
    table = finding.table
    names = json.loads(table.attrs["quantities"])
    points = np.column_stack([table[name].values for name in names])
    whether = bool(table["settled"].item())
    said = (
        f"{len(points)} points of {' and '.join(names)}, {table.attrs['section']}, behind "
        f"{int(table['transient'].item())}: {'settled' if whether else 'NOT settled'}, drift "
        f"{number(float(table['drift'].item()), 2)}"
    )
    words = _recurs(points, deep=True)
    lead = [f"{said}.", f"How the points recur: {words}."]
    if table.attrs["outcome"] != "COMPLETED":
        lead.append(f"The run ended early: {table.attrs['message']}.")
    rows = [_statistics(name, table[name].values, str(table[name].attrs["units"])) for name in names]
    items: tuple[Table | Picture, ...] = (
        *_picture(
            lambda: figure_section(table, width="column"), f"Section, {table.attrs['section']}", key, figures
        ),
        _ranges(rows, key, "points"),
    )
    notes = (
        f"Rule of settling: {table.attrs['rule']}; tolerance {number(float(table.attrs['tolerance']))}.",
    )
    part = Section(key=key, title=f"Section: {finding.label}", lead=tuple(lead), items=items, notes=notes)
    return part, Judged(finding.label, whether, "settled" if whether else "not settled", f"section: {words}")


def _recurs(points: np.ndarray, deep: bool = False) -> str:
    """Return how points, (n, d), recur, in words."""
    try:
        found = recurrence(points)
    except AntennaPinError as error:
        return f"cannot be told ({error})"
    if not deep or not found.confidence:
        return found.words
    return f"{found.words}, confidence {number(found.confidence, 2)}"


def diagram(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
    """Return the section of a bifurcation diagram."""
    table = finding.table
    parameter, branches = str(table.attrs["parameter"]), [str(one) for one in table["branch"].values]
    unit = str(table["value"].attrs.get("units", ""))
    values = [float(one) for one in table["value"].values]
    names = json.loads(table.attrs["quantities"])
    cells = [[_come_to(table, names, b, k) for b in range(len(branches))] for k in range(len(values))]
    counted = Counter(short for row in cells for short, _ in row)
    rows = tuple(
        Row(readable(value, unit or "1", 6), tuple(Cell(text) for _, text in row))
        for value, row in zip(values, cells, strict=True)
    )
    bad = counted["failed"] + counted["not settled"]
    ends = f"{readable(values[0], unit or '1')} to {readable(values[-1], unit or '1')}"
    said = f"{parameter}, {len(values)} values from {ends}, {' and '.join(branches)}"
    tally = ", ".join(f"{short} at {count}" for short, count in counted.most_common())
    items: tuple[Table | Picture, ...] = (
        *_picture(
            lambda: figure_bifurcation(table, width="column"),
            f"Bifurcation diagram over {parameter}",
            key,
            figures,
        ),
        Table(
            columns=(parameter, *branches),
            rows=rows,
            caption="What the points of each value come to",
            key=f"{key}-values",
            dense=len(rows) > _DENSE,
        ),
    )
    part = Section(
        key=key,
        title=f"Bifurcation diagram: {finding.label}",
        lead=(
            f"{said}; points of {' and '.join(names)}, {table.attrs['section']}.",
            f"What the points come to: {tally}.",
        ),
        items=items,
        notes=(
            f"Rule of settling: {table.attrs['rule']}; tolerance {number(float(table.attrs['tolerance']))}.",
        ),
    )
    return part, Judged(
        finding.label, not bad, "settled" if not bad else "not all settled", f"{said}: {tally}"
    )


def _come_to(table: xr.Dataset, names: list[str], b: int, k: int) -> tuple[str, str]:
    """Return what the points of a value of a branch come to, in a word or two and in a line."""
    count = int(table["points"].values[b, k])
    if not count:
        return "failed", f"failed: {table['message'].values[b, k]}"
    if not bool(table["settled"].values[b, k]):
        return "not settled", f"not settled, drift {number(float(table['drift'].values[b, k]), 2)}"
    words = _recurs(np.column_stack([table[name].values[b, k, :count] for name in names]))
    return words.partition(" (")[0], words
