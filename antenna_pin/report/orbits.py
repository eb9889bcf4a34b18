"""Periodic solutions, branches of them and Lyapunov exponents in a report."""

from __future__ import annotations

import numpy as np
import xarray as xr

from antenna_pin.analysis import stability_spans, unexplained_changes
from antenna_pin.base.readable import number, readable
from antenna_pin.plot import figure_branch, figure_exponents, figure_multipliers
from antenna_pin.report._findings import Finding, Judged
from antenna_pin.report._page import Cell, Picture, Row, Section, Statement, Table
from antenna_pin.report.figures import picture

__all__ = ["branch", "exponents", "orbit"]

_NEUTRAL = "neutral, as far as can be told"


def _plain(value: float, digits: int = 4) -> Cell:
    return Cell(number(value, digits), value) if np.isfinite(value) else Cell("unknown")


def _multiplier(one: complex) -> Cell:
    if one.imag == 0.0:
        return Cell(number(one.real), one.real)
    angle = number(float(np.rad2deg(np.angle(one))))
    return Cell(f"{number(abs(one))} at {angle}°", abs(one))


def _said(label: str, text: str) -> Statement:
    return Statement(label=label, texts=(((), text),))


def orbit(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
    """Return the section of a periodic solution."""
    table = finding.table
    stability = str(table["stability"].item())
    words = _NEUTRAL if stability == "neutral" else stability
    period, doubt = float(table["period"].item()), float(table["doubt"].item())
    real, imaginary = table["multiplier_real"].values, table["multiplier_imaginary"].values
    sizes = np.hypot(real, imaginary)
    rows = tuple(
        Row(
            str(k + 1),
            (
                _multiplier(complex(real[k], imaginary[k])),
                *(_plain(float(one[k])) for one in (sizes, table["exponent"].values)),
            ),
        )
        for k in range(len(real))
    )
    multipliers = Table(
        columns=("", "multiplier", "size", "exponent [1/s]"),
        rows=rows,
        caption=f"Floquet multipliers, known to {number(doubt, 1)}",
        key=f"{key}-multipliers",
    )
    onsets, events = int(table["onsets"].item()), int(table["events"].item())
    residual = float(table["residual"].item())
    statements = [
        _said("in a period", f"{onsets} contacts that begin, {events} events"),
        _said("ends of a period", f"{number(residual, 2)} error scales apart"),
    ]
    caption = "Floquet multipliers and the unit circle"
    shown = picture(figure_multipliers(table), caption, f"{key}-figure") if figures else None
    found = " (found too)" if int(table.attrs["free_period"]) else ""
    said = f"orbit of {readable(period, 's', 9)}{found}, {words}"
    part = Section(
        key=key,
        title=f"Periodic solution: {finding.label}",
        lead=(f"An {said}.",),
        statements=tuple(statements),
        items=(*((shown,) if shown else ()), multipliers),
    )
    return part, Judged(finding.label, True, stability, said)


def branch(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
    """Return the section of a branch of periodic solutions."""
    table = finding.table
    parameter, unit = str(table.attrs["parameter"]), str(table["value"].attrs.get("units", "")) or "1"
    spans = stability_spans(table)
    rows = tuple(
        Row(
            one.stability,
            (
                Cell(readable(one.first, unit, 6), one.first),
                Cell(readable(one.last, unit, 6), one.last),
                Cell(str(one.orbits), float(one.orbits)),
                *map(_multiplier, one.largest),
            ),
        )
        for one in spans
    )
    columns = ("", "from", "to", "orbits", "largest multiplier, of least size", "of greatest")
    items: list[Table | Picture] = [
        Table(columns=columns, rows=rows, caption=f"Orbits over {parameter}", key=f"{key}-stability")
    ]
    happened = _happened(table, unit)
    if happened:
        items.append(
            Table(
                columns=("", f"at {parameter}", "known to"),
                rows=tuple(happened),
                caption="What happens to them",
                key=f"{key}-bifurcations",
            )
        )
    if figures:
        drawn = (figure_branch(table, width="column"), f"Periodic solutions over {parameter}")
        others = (figure_multipliers(table), "Their Floquet multipliers and the unit circle")
        items[:0] = [
            picture(figure, caption, f"{key}-figure-{k}")
            for k, (figure, caption) in enumerate((drawn, others), start=1)
        ]
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
    return part, Judged(finding.label, True, every, said)


def _happened(table: xr.Dataset, unit: str) -> list[Row]:
    parts = [table[name].values for name in ("kind", "at", "at_doubt")]
    return [
        Row(
            str(kind),
            (
                Cell(readable(float(at), unit, 9), float(at)),
                Cell(readable(float(doubt), unit, 2), float(doubt)),
            ),
        )
        for kind, at, doubt in zip(*parts, strict=True)
    ]


def exponents(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
    """Return the section of Lyapunov exponents."""
    table = finding.table
    interval, verdict = float(table.attrs["interval"]), str(table.attrs["verdict"])
    values, errors = (np.asarray(table[name].values, dtype=float) for name in ("value", "error"))
    rows = tuple(
        Row(str(k + 1), (_plain(value), _plain(error, 2), _plain(value * interval)))
        for k, (value, error) in enumerate(zip(values.tolist(), errors.tolist(), strict=True))
    )
    numbers = Table(
        columns=("", "exponent [1/s]", "standard error [1/s]", f"per {readable(interval, 's', 6)}"),
        rows=rows,
        caption="Lyapunov exponents",
        key=f"{key}-exponents",
    )
    caption = "Convergence of the exponents, with one standard error"
    drawn = figure_exponents(table, width="column") if figures else None
    pictures = (picture(drawn, caption, f"{key}-figure"),) if drawn else ()
    said = f"{verdict}, over {table.sizes['interval']} intervals of {readable(interval, 's', 6)}"
    part = Section(
        key=key,
        title=f"Lyapunov exponents: {finding.label}",
        lead=(f"Verdict: {said}.",),
        items=(*pictures, numbers),
        notes=("The verdict is that of the largest exponent, at three standard errors.",),
    )
    return part, Judged(
        finding.label, verdict != "too short to say", verdict, f"largest exponent {_told(values, errors)}"
    )


def _told(values: np.ndarray, errors: np.ndarray) -> str:
    error = f" ± {number(float(errors[0]), 2)}" if np.isfinite(errors[0]) else ", error unknown"
    return f"{number(float(values[0]))}{error} 1/s"
