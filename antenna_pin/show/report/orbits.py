"""Periodic solutions, branches of them and Lyapunov exponents in a report."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable

import numpy as np
import xarray as xr

from antenna_pin.analysis import portrait_of, recurrence, stability_spans, unexplained_changes
from antenna_pin.base.readable import number, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.show.plot import (
    figure_bifurcation,
    figure_branch,
    figure_exponents,
    figure_multipliers,
    figure_phase,
    figure_section,
    figure_sensitivity,
)
from antenna_pin.show.report._page import (
    Cell,
    PageTable,
    Picture,
    Row,
    Section,
    Status,
    quantities,
    statement,
)
from antenna_pin.show.report._runs import Finding
from antenna_pin.show.report.figures import picture

_NEUTRAL = "neutral within the error estimate"


def _plain(value: float, digits: int = 4) -> Cell:
    return Cell(number(value, digits), value) if np.isfinite(value) else Cell("unknown")


def _multiplier(one: complex) -> Cell:
    if one.imag == 0.0:
        return Cell(number(one.real), one.real)
    angle = number(float(np.rad2deg(np.angle(one))))
    return Cell(f"{number(abs(one))} at {angle}°", abs(one))


def _picture(draw: Callable[[], object], caption: str, key: str, figures: bool) -> tuple[Picture, ...]:
    return (picture(draw(), caption, f"{key}-figure"),) if figures else ()


def orbit(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of a periodic solution."""
    table = finding.table
    stability = str(table["stability"].item())
    words = _NEUTRAL if stability == "neutral" else stability
    period, doubt = float(table["period"].item()), float(table["doubt"].item())
    real, imaginary = table["multiplier_real"].values, table["multiplier_imaginary"].values
    sizes = np.hypot(real, imaginary)
    rows = []
    for k, pair in enumerate(zip(real, imaginary, strict=True)):
        numbers = (_plain(float(one[k])) for one in (sizes, table["exponent"].values))
        rows.append(Row(str(k + 1), (_multiplier(complex(*pair)), *numbers)))
    multipliers = PageTable(
        columns=("", "multiplier", "size", "exponent [1/s]"),
        rows=tuple(rows),
        caption=f"Floquet multipliers, known to {number(doubt, 1)}",
        key=f"{key}-multipliers",
    )
    onsets, events = int(table["onsets"].item()), int(table["events"].item())
    residual = float(table["residual"].item())
    statements = [
        statement("in a period", f"{onsets} contacts that begin, {events} events"),
        statement("ends of a period", f"{number(residual, 2)} error scales apart"),
    ]
    caption = "Floquet multipliers and the unit circle"
    found = " (found too)" if int(table.attrs["free_period"]) else ""
    said = f"orbit of {readable(period, 's', 9)}{found}, {words}"
    part = Section(
        key=key,
        title=f"Periodic solution: {finding.label}",
        lead=(f"An {said}.",),
        statements=tuple(statements),
        items=(*_picture(lambda: figure_multipliers(table), caption, key, figures), multipliers),
    )
    return part, Status(finding.label, True, stability, said)


def branch(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of a branch of periodic solutions."""
    table = finding.table
    parameter, unit = str(table.attrs["parameter"]), str(table["value"].attrs.get("units", "")) or "1"
    spans = stability_spans(table)
    rows = []
    for one in spans:
        ends = (Cell(readable(end, unit, 6), end) for end in (one.first, one.last))
        count = Cell(str(one.orbits), float(one.orbits))
        rows.append(Row(one.stability, (*ends, count, *map(_multiplier, one.largest))))
    columns = ("", "from", "to", "orbits", "largest multiplier, of least size", "of greatest")
    items: list[PageTable | Picture] = [
        PageTable(
            columns=columns, rows=tuple(rows), caption=f"Orbits over {parameter}", key=f"{key}-stability"
        )
    ]
    bifurcations = []
    for kind, at, doubt in zip(*(table[name].values for name in ("kind", "at", "at_doubt")), strict=True):
        cells = (Cell(readable(float(x), unit, n), float(x)) for x, n in ((at, 9), (doubt, 2)))
        bifurcations.append(Row(str(kind), tuple(cells)))
    if bifurcations:
        items.append(
            PageTable(
                columns=("", f"at {parameter}", "known to"),
                rows=tuple(bifurcations),
                caption="What happens to them",
                key=f"{key}-bifurcations",
            )
        )
    if figures:
        drawn = (
            (figure_branch(table, width="column"), f"Periodic solutions over {parameter}"),
            (figure_multipliers(table), "Their Floquet multipliers and the unit circle"),
        )
        items[:0] = [picture(*one, f"{key}-figure-{k}") for k, one in enumerate(drawn, start=1)]
    kinds = [str(one) for one in table["kind"].values]
    what = ", ".join(f"{kinds.count(kind)} {kind}" for kind in dict.fromkeys(kinds)) or "no bifurcation found"
    said = f"{table.sizes['point']} orbits over {parameter}: {table.attrs['message']}; {what}"
    notes = [
        f"Between {readable(one, unit, 6)} and {readable(other, unit, 6)} a multiplier passes 1 without a "
        "fold: another branch may cross this one there."
        for one, other in unexplained_changes(table)
    ]
    part = Section(
        key=key,
        title=f"Branch of periodic solutions: {finding.label}",
        lead=(f"{said}.",),
        items=tuple(items),
        notes=tuple(notes),
    )
    every = ", ".join(dict.fromkeys(one.stability for one in spans))
    return part, Status(finding.label, True, every, said)


def exponents(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of Lyapunov exponents."""
    table = finding.table
    interval, verdict = float(table.attrs["interval"]), str(table.attrs["verdict"])
    values, errors = (np.asarray(table[name].values, dtype=float) for name in ("value", "error"))
    rows = tuple(
        Row(str(k + 1), (_plain(value), _plain(error, 2), _plain(value * interval)))
        for k, (value, error) in enumerate(zip(values.tolist(), errors.tolist(), strict=True))
    )
    numbers = PageTable(
        columns=("", "exponent [1/s]", "standard error [1/s]", f"per {readable(interval, 's', 6)}"),
        rows=rows,
        caption="Lyapunov exponents",
        key=f"{key}-exponents",
    )
    caption = "Convergence of the exponents, with one standard error"
    pictures = _picture(lambda: figure_exponents(table, width="column"), caption, key, figures)
    said = f"{verdict}, over {table.sizes['interval']} intervals of {readable(interval, 's', 6)}"
    part = Section(
        key=key,
        title=f"Lyapunov exponents: {finding.label}",
        lead=(f"Verdict: {said}.",),
        items=(*pictures, numbers),
        notes=("The verdict is that of the largest exponent, at three standard errors.",),
    )
    error = f" ± {number(float(errors[0]), 2)}" if np.isfinite(errors[0]) else ", error unknown"
    text = f"largest exponent {number(float(values[0]))}{error} 1/s"
    return part, Status(finding.label, verdict != "too short to decide", verdict, text)


_MOST = 20  # results in the table


def sensitivity(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of sensitivities."""
    table = finding.table
    names = [str(one) for one in table["parameter"].values]
    rows = []
    for k in range(min(table.sizes["result"], _MOST)):
        one, unit = table.isel(result=k), str(table["unit"].values[k])
        pairs = zip(one["change"].values.tolist(), one["doubt"].values.tolist(), strict=True)
        cells = (_change(0.01 * change, 0.01 * doubt) for change, doubt in pairs)
        value = float(one["value"])
        rows.append(Row(str(one["result"].item()), (Cell(readable(value, unit or "1"), value), *cells)))
    numbers = PageTable(
        columns=("", "is", *(f"per 1 % of {name}" for name in names)),
        rows=tuple(rows),
        caption="What changes most, per 1 % of each number, in SI units",
        key=f"{key}-changes",
    )
    caption = "What moves what: change of results per 1 % of each number, and of a motion over time"
    pictures = _picture(lambda: figure_sensitivity(table), caption, key, figures)
    believed = np.asarray(table["believed"].values, dtype=float)
    first = int(np.argmin(believed))
    throughout = bool(np.isinf(believed[first]))
    until = f"up to {readable(float(believed[first]), 's', 6)}, over {names[first]}"
    said = "to the end" if throughout else until
    refused = json.loads(str(table.attrs["refused"]))
    part = Section(
        key=key,
        title=f"Sensitivities: {finding.label}",
        lead=(f"Derivatives of velocities are accurate to 1 % {said}.",),
        items=(*pictures, *((numbers,) if rows else ())),
        notes=tuple(
            f"No derivatives from {readable(one['begin'], 's', 6)} to {readable(one['end'], 's', 6)}: "
            f"{one['why']}."
            for one in refused
        ),
    )
    judged = "known" if throughout else "in doubt"
    return part, Status(finding.label, throughout, judged, f"velocities accurate to 1 % {said}")


def _change(change: float, doubt: float) -> Cell:
    """Return a change; a dash where it is in doubt."""
    known = np.isfinite(change) and abs(change) > doubt
    return Cell(number(change, 3), change) if known else Cell("\N{EN DASH}")


_DENSE = 24  # rows of a table above which it is set small


def _statistics(name: str, values: np.ndarray, unit: str) -> Row:
    last = float(values[-1])
    return quantities(
        name, [float(values.min()), float(values.max()), float(values.mean()), last], unit, digits=6
    )


def _ranges(rows: list[Row], key: str, of: str) -> PageTable:
    columns = ("", "least", "largest", "mean", "last")
    return PageTable(columns=columns, rows=tuple(rows), caption=f"Range of the {of}", key=f"{key}-range")


def portrait(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of a phase portrait."""
    found = portrait_of(finding.table)
    rows = [_statistics(one.name, one.values, one.units) for one in found.quantities]
    every = [one.name for one in found.quantities]
    names = ", ".join(every) if len(every) > 2 else f"{every[1]} over {every[0]}"
    end = readable(float(found.time[-1]), "s")
    said = f"{names}, of {found.run} {found.rule}: {len(found.time)} samples to {end}"
    items: tuple[PageTable | Picture, ...] = (
        *_picture(lambda: figure_phase(found, width="column"), f"Phase portrait: {names}", key, figures),
        _ranges(rows, key, "quantities"),
    )
    part = Section(key=key, title=f"Phase portrait: {finding.label}", lead=(f"{said}.",), items=items)
    return part, Status(finding.label, True, "phase portrait", said)


def section(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
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
    items: tuple[PageTable | Picture, ...] = (
        *_picture(
            lambda: figure_section(table, width="column"), f"Section, {table.attrs['section']}", key, figures
        ),
        _ranges(rows, key, "points"),
    )
    notes = (
        f"Rule of settling: {table.attrs['rule']}; tolerance {number(float(table.attrs['tolerance']))}.",
    )
    part = Section(key=key, title=f"Section: {finding.label}", lead=tuple(lead), items=items, notes=notes)
    return part, Status(finding.label, whether, "settled" if whether else "not settled", f"section: {words}")


def _recurs(points: np.ndarray, deep: bool = False) -> str:
    """Return how points, (n, d), recur, in words."""
    try:
        found = recurrence(points)
    except AntennaPinError as error:
        return f"not determined ({error})"
    if not deep or not found.confidence:
        return found.words
    return f"{found.words}, confidence {number(found.confidence, 2)}"


def diagram(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
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
    items: tuple[PageTable | Picture, ...] = (
        *_picture(
            lambda: figure_bifurcation(table, width="column"),
            f"Bifurcation diagram over {parameter}",
            key,
            figures,
        ),
        PageTable(
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
    return part, Status(
        finding.label, not bad, "settled" if not bad else "not all settled", f"{said}: {tally}"
    )


def _come_to(table: xr.Dataset, names: list[str], b: int, k: int) -> tuple[str, str]:
    """Return the recurrence of a value's points, briefly and in a line."""
    count = int(table["points"].values[b, k])
    if not count:
        return "failed", f"failed: {table['message'].values[b, k]}"
    if not bool(table["settled"].values[b, k]):
        return "not settled", f"not settled, drift {number(float(table['drift'].values[b, k]), 2)}"
    words = _recurs(np.column_stack([table[name].values[b, k, :count] for name in names]))
    return words.partition(" (")[0], words
