"""Sensitivities in a report: which number moves which result."""

from __future__ import annotations

import json

import numpy as np

from antenna_pin.base.readable import number, readable
from antenna_pin.plot import figure_sensitivity
from antenna_pin.report._findings import Finding, Judged
from antenna_pin.report._page import Cell, Row, Section, Table
from antenna_pin.report.figures import picture

__all__ = ["sensitivity"]

_MOST = 20  # results in the table


def sensitivity(finding: Finding, key: str, figures: bool) -> tuple[Section, Judged]:
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
    numbers = Table(
        columns=("", "is", *(f"per 1 % of {name}" for name in names)),
        rows=tuple(rows),
        caption="What changes most, per 1 % of each number, in SI units",
        key=f"{key}-changes",
    )
    caption = "What moves what: change of results per 1 % of each number, and of a motion over time"
    drawn = figure_sensitivity(table) if figures else None
    pictures = (picture(drawn, caption, f"{key}-figure"),) if drawn else ()
    believed = np.asarray(table["believed"].values, dtype=float)
    first = int(np.argmin(believed))
    throughout = bool(np.isinf(believed[first]))
    until = f"up to {readable(float(believed[first]), 's', 6)}, over {names[first]}"
    said = "to the end" if throughout else until
    refused = json.loads(str(table.attrs["refused"]))
    spans = [
        f"{readable(one['begin'], 's', 6)} to {readable(one['end'], 's', 6)}: {one['why']}" for one in refused
    ]
    part = Section(
        key=key,
        title=f"Sensitivities: {finding.label}",
        lead=(f"Derivatives of velocities are known to 1 % {said}.",),
        items=(*pictures, *((numbers,) if rows else ())),
        notes=tuple(
            f"No derivatives from {at}: {one['why']}." for at, one in zip(spans, refused, strict=True)
        ),
    )
    judged = "known" if throughout else "in doubt"
    return part, Judged(finding.label, throughout, judged, f"velocities known to 1 % {said}")


def _change(change: float, doubt: float) -> Cell:
    """Return a change; a dash where it is in doubt."""
    known = np.isfinite(change) and abs(change) > doubt
    return Cell(number(change, 3), change) if known else Cell("\N{EN DASH}")
