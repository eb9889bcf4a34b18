"""Report sections of fits, of identifiability, and of experiments."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.readable import number, readable
from antenna_pin.show.plot import correlations, table_figures
from antenna_pin.show.report._page import Cell, PageTable, Picture, Row, Section, Status, statement
from antenna_pin.show.report._runs import Finding
from antenna_pin.show.report.figures import picture
from antenna_pin.studies.fit.confidence_bands import BEYOND_CHANCE
from antenna_pin.studies.fit.profile_likelihood import interval_text, profile_interval
from antenna_pin.studies.fit.uncertainty import autocorrelation, is_correlated

# Correlations from which on two parameters are hardly told apart, as the figure marks them.
_STRONG = 0.95
_NOISE = {
    "given": "as stated",
    "estimated": "found from the residuals",
    "correlated": "found from the residuals, with what hangs together in time",
}
# Chances below which the stated noise does not explain the residuals, or explains them too well.
_RARE = 0.001


def _quantity(value: float, unit: str, digits: int = 4) -> Cell:
    return Cell(readable(value, unit or "1", digits), value if math.isfinite(value) else None)


def _error(value: float, unit: str) -> Cell:
    return _quantity(value, unit, 2) if math.isfinite(value) else Cell("not identifiable")


def _pictures(table: xr.Dataset, key: str, figures: bool) -> Iterator[Picture]:
    for one in table_figures(table) if figures else ():
        drawn = one.draw(width="column" if one.name == "correlation" else "page")
        yield picture(drawn, one.title, f"{key}-{one.name}", one.title)


def fit(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of a fit."""
    table = finding.table
    names = [str(one) for one in table["title"].values]
    chi2, freedoms = float(table.attrs["chi2"]), float(table.attrs["freedoms"])
    rows = list(_values(table))
    profile = ("interval of its profile",) if "profile_end" in table else ()
    parameters = PageTable(
        columns=("", "value", "standard error", "interval", *profile, "start"),
        rows=tuple(rows),
        caption=f"Parameters, with intervals of {_percent(table)}",
        key=f"{key}-parameters",
    )
    records = PageTable(
        columns=("", "numbers", "residuals' rms [sd]", "correlation of a residual with the next"),
        rows=tuple(_curves(table)),
        caption="Records",
        key=f"{key}-records",
    )
    statements = (
        statement("noise", _NOISE[table.attrs["noise"]]),
        statement("chi squared", f"{number(chi2)} for {freedoms:g} degrees of freedom"),
        statement("search", f"{table.attrs['message']}; {int(table.attrs['runs'])} runs"),
    )
    error = np.asarray(table["sd"].values, dtype=float)
    said = f"{len(names)} parameter{'s' if len(names) > 1 else ''} from {table.sizes['row']} numbers"
    for which, words in ((np.isinf(error), "not identifiable"), (np.isnan(error), "at a bound")):
        lacks = [name for name, one in zip(names, which, strict=True) if one]
        said += f"; {words}: {', '.join(lacks)}" if lacks else ""
    part = Section(
        key=key,
        title=f"Fit: {finding.label}",
        lead=(f"{said[0].upper()}{said[1:]}.",),
        statements=statements,
        items=(parameters, *_pictures(table, key, figures), records),
        notes=tuple(_notes(table, names)),
        meaning=(
            "Intervals are by standard errors, to first order, for residuals that are uncorrelated noise; "
            "intervals by profiles also hold where the model is nonlinear.",
        ),
    )
    converged = bool(int(table.attrs["converged"])) and not table.attrs.get("verdict")
    values = "; ".join(f"{row.name} {row.cells[0].text}" for row in rows[:4])
    outcome = "fitted" if converged else "not at an end"
    return part, Status(finding.label, converged, outcome, values)


def _percent(table: xr.Dataset) -> str:
    return f"{100.0 * float(table.attrs.get('level', 0.95)):g} %"


def _values(table: xr.Dataset) -> Iterator[Row]:
    for k in range(table.sizes["parameter"]):
        one = table.isel(parameter=k)
        unit = str(one["units"].item())
        names = ("value", "sd", "low", "high", "start")
        value, error, low, high, start = (float(one[name]) for name in names)
        interval = interval_text(value, low, high, unit)
        cells = [
            _quantity(value, unit, 5),
            Cell("at its bound") if math.isnan(error) else _error(error, unit),
            Cell(interval if math.isfinite(high - low) and high > low else "–"),
        ]
        if "profile_end" in table:
            cells.append(Cell(profile_interval(one) or "–"))
        yield Row(str(one["title"].item()), (*cells, _quantity(start, unit)))


def _residuals(table: xr.Dataset) -> Iterator[tuple[str, NDArray[np.float64]]]:
    names = [f"{a}: {b}" for a, b in zip(table["record"].values, table["column"].values, strict=True)]
    residuals = (table["model"].values - table["data"].values) / table["noise"].values
    for name in dict.fromkeys(names):
        yield name, residuals[[one == name for one in names]]


def _curves(table: xr.Dataset) -> Iterator[Row]:
    for name, mine in _residuals(table):
        rms, again = float(np.sqrt(np.mean(mine**2))), autocorrelation(mine)
        cells = (
            Cell(str(len(mine)), float(len(mine))),
            Cell(number(rms, 3), rms),
            Cell(number(again, 2) if len(mine) > 2 else "–", again),
        )
        yield Row(name, cells)


def _notes(table: xr.Dataset, names: list[str]) -> Iterator[str]:
    found = correlations(table)
    for i, j in zip(*np.triu_indices(len(names), 1), strict=True):
        if abs(found[i, j]) >= _STRONG:
            yield (
                f"{names[i]} and {names[j]} are hardly distinguishable: their correlation is "
                f"{number(float(found[i, j]), 5)}."
            )
    counted = "intervals count it"
    if table.attrs["noise"] != "correlated":
        wider = number(float(table.attrs["wider"]), 2)
        counted = f"intervals by standard errors are up to {wider} times too narrow"
    for name, mine in _residuals(table):
        if is_correlated(mine):
            yield (
                f"Residuals of {name} hang together in time: {counted}. "
                "The model lacks something, or the noise is not white."
            )
    yield from str(table.attrs.get("verdict", "")).splitlines()
    if table.attrs["noise"] == "given" and float(table.attrs["freedoms"]) > 0.0:
        from scipy.stats import chi2

        chance = float(chi2.sf(float(table.attrs["chi2"]), float(table.attrs["freedoms"])))
        if BEYOND_CHANCE <= chance < _RARE:
            yield "Residuals are larger than the stated noise: the model lacks something, or sd is too small."
        elif chance > 1.0 - _RARE:
            yield "Residuals are smaller than the stated noise: sd is too large, and intervals are too wide."


def identifiability(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of a test's identifiability."""
    table = finding.table
    rows = []
    for k in range(table.sizes["parameter"]):
        one = table.isel(parameter=k)
        unit = str(one["units"].item())
        half, alone, inflation = (float(one[name]) for name in ("half", "alone", "inflation"))
        quantile = float(table.attrs["quantile"])
        cells = (
            _quantity(float(one["value"]), unit),
            _error(half, unit),
            _error(quantile * alone, unit),
            Cell(number(inflation, 3) if math.isfinite(inflation) else "–"),
        )
        rows.append(Row(str(one["title"].item()), cells))
    numbers = PageTable(
        columns=("", "value", "interval to expect, ±", "if all others were known, ±", "times wider"),
        rows=tuple(rows),
        caption=f"Identifiability, intervals of {_percent(table)}",
        key=f"{key}-parameters",
    )
    said = [str(one) for one in table["said"].values]
    held = ", ".join(str(one) for one in table["hold"].values)
    determined = int(table["determined"].values.sum())
    lead = f"{determined} of {table.sizes['parameter']} parameters are identifiable from this test"
    part = Section(
        key=key,
        title=f"Identifiability: {finding.label}",
        lead=(f"{lead}.",),
        items=(*_pictures(table, key, figures), numbers),
        notes=(
            *(f"{one[0].upper()}{one[1:]}." for one in said),
            *((f"Hold {held}, and the others become identifiable.",) if held else ()),
        ),
        meaning=(
            "Nothing is fitted here: intervals are those that the stated noise lets expect at these values, "
            "to first order.",
        ),
    )
    whole = determined == table.sizes["parameter"]
    return part, Status(finding.label, whole, "all identifiable" if whole else "not all identifiable", lead)


def experiments(finding: Finding, key: str, figures: bool) -> tuple[Section, Status]:
    """Return the section of a comparison of experiments."""
    table = finding.table
    titles = [str(one) for one in table["title"].values]
    units = [str(one) for one in table["units"].values]
    criteria = [name for name in ("D", "c", "A", "E") if name in table]
    plan = "count" in table

    def cells(half: np.ndarray) -> tuple[Cell, ...]:
        return tuple(_error(float(one), unit) for one, unit in zip(half, units, strict=True))

    rows = [
        Row("before", (*cells(table["before"].values), *(Cell("–") for _ in criteria), *([Cell("–")] * plan)))
    ]
    for k in range(table.sizes["experiment"]):
        one = table.isel(experiment=k)
        values = (float(one[name]) for name in criteria)
        worth = (Cell(number(value, 3), value if math.isfinite(value) else None) for value in values)
        count = [Cell(str(int(one["count"])), float(one["count"]))] if plan else []
        rows.append(Row(str(one["experiment"].item()), (*cells(one["half"].values), *worth, *count)))
    wanted, criterion = str(table.attrs["wanted"]), str(table.attrs["criterion"])
    total = int(table.attrs["total"])
    often = (f"of {total} more",) if plan else ()
    numbers = PageTable(
        columns=("", *(f"{title}, ±" for title in titles), *criteria, *often),
        rows=tuple(rows),
        caption=f"Intervals of {_percent(table)} to expect after each experiment, the best first",
        key=f"{key}-experiments",
    )
    best = str(table["experiment"].values[0])
    of = f" for {wanted}" if criterion == "c" else ""
    said = f"{best} determines most{of} of {table.sizes['experiment']} experiments"
    part = Section(
        key=key,
        title=f"Which test next: {finding.label}",
        lead=(f"{said[0].upper()}{said[1:]}.",),
        items=(*_pictures(table, key, figures), numbers),
        statements=tuple(
            statement(str(name), str(what))
            for name, what in zip(table["experiment"].values, table["what"].values, strict=True)
            if str(what)
        ),
        meaning=(
            "Criteria are lengths in sizes of the parameters: D the mean of the axes of the region that "
            "holds all parameters, by its volume; c the wanted one's error; A the root of the sum of all "
            "squared errors; E the longest axis. All at the present values, to first order.",
        ),
    )
    return part, Status(finding.label, True, "ranked", said)
