"""A parameter study in, one HTML file out."""

from __future__ import annotations

import json
from collections.abc import Iterator

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.base.readable import number, prefixed, readable
from antenna_pin.errors import AntennaPinError
from antenna_pin.show import plot
from antenna_pin.show.report._page import Cell, Details, PageTable, Picture, Row, Section, Status, statement
from antenna_pin.show.report.document import Report, page
from antenna_pin.show.report.figures import picture
from antenna_pin.studies.sweep.sensitivity import quantiles, sensitivities

_MOST_FAILURES = 200
_MOST_FIGURES = 40


@takes()
def study_report(study: xr.Dataset, *, title: str | None = None, figures: bool = True) -> Report:
    """Return a report on a parameter study.

    Args:
        study: What :func:`antenna_pin.open_study` returns.
        title: Of the report; the study's if left out.
        figures: Whether to draw figures.
    """
    about = json.loads(study.attrs["study"])
    heading = title or str(study.attrs.get("title") or f"Study {about['name']}")
    sections = [_responses(study), _parameters(study), _failures(study)]
    sampled = study.attrs["method"] in ("morris", "saltelli")
    if sampled:
        sections.insert(1, _sensitivities(study, figures))
    if figures:
        sections.insert(1, _figures(study))
    sections.append(_provenance(study, about))
    return page(heading, [_status(study, about["name"])], sections)


def _status(study: xr.Dataset, name: str) -> Status:
    count, pending = study["outcome"].size, int((study["outcome"].values == "PENDING").sum())
    faults = {words: outcome for (words, outcome), runs in _faults(study).items() if runs.any()}
    outcome = "PENDING" if pending else next(iter(faults.values()), "COMPLETED")
    said = f"{count - pending} of {count} runs made; {_counted(study) or 'all of them reached their end'}"
    return Status(name, not pending and not faults, outcome, said)


def _faults(study: xr.Dataset) -> dict[tuple[str, str], NDArray[np.bool_]]:
    """Return the runs with each fault, by its words and outcome."""
    outcomes = study["outcome"].values
    lacking = np.zeros(outcomes.shape, dtype=bool)
    for response in _names(study, "responses"):
        lacking |= np.isnan(study[response].values.astype(float))
    ended, unbalanced = np.isin(outcomes, ("COMPLETED", "STOPPED")), outcomes == "LEDGER_OPEN"
    return {
        ("did not reach their end", "SOME ENDED EARLY"): ~ended & ~unbalanced & (outcomes != "PENDING"),
        ("do not balance their energy or momentum", "SOME DO NOT BALANCE"): unbalanced,
        ("lack a response", "SOME LACK A RESPONSE"): ended & lacking,
    }


def _counted(study: xr.Dataset) -> str:
    """Return how many runs have each fault; "" if none has any."""
    said = []
    for (words, _), runs in _faults(study).items():
        one = words.replace("do ", "does ").replace("lack ", "lacks ").replace("their", "its")
        if runs.any():
            said.append(f"{runs.sum()} {one if runs.sum() == 1 else words}")
    return ", ".join(said)


def _names(study: xr.Dataset, what: str) -> list[str]:
    return [str(name) for name in json.loads(study.attrs[what])]


def _responses(study: xr.Dataset) -> Section:
    shares = plot.QUANTILES
    levels = (f"{100.0 * share:g} %" for share in shares)
    head = ("", "smallest", *levels, "largest", "mean", "spread", "runs")
    rows = []
    for name in _names(study, "responses"):
        values = np.ravel(study[name].values).astype(float)
        values = values[np.isfinite(values)]
        if not values.size:
            rows.append(Row(name, tuple(Cell("–") for _ in head[1:])))
            continue
        found = quantiles(study, name, shares)
        spread = values.std(ddof=1) if values.size > 1 else np.nan
        numbers = [values.min(), *found["quantile"].values, values.max(), values.mean(), spread]
        factor, unit = prefixed(str(study[name].attrs.get("units", "")), [float(one) for one in numbers])
        cells = [Cell(number(factor * float(one)), float(one)) for one in numbers]
        rows.append(Row(name, (*cells, Cell(str(values.size), float(values.size))), unit))
    table = PageTable(columns=head, rows=tuple(rows), caption="Responses over all runs", key="responses")
    items: list[PageTable | Details] = [table]
    if study.attrs["method"] != "grid":
        items.append(_intervals(study))
    meaning = tuple(
        statement(name, str(study[name].attrs.get("long_name", ""))) for name in _names(study, "responses")
    )
    return Section(key="responses", title="Responses", statements=meaning, items=tuple(items))


def _intervals(study: xr.Dataset) -> PageTable:
    rows = []
    for name in _names(study, "responses"):
        found = quantiles(study, name, plot.QUANTILES)
        ends = [float(v) for v in np.ravel([found["low"].values, found["high"].values])]
        factor, unit = prefixed(found["low"].attrs["units"], ends)
        cells = [
            Cell(f"{number(factor * float(low))} to {number(factor * float(high))}")
            for low, high in zip(found["low"].values, found["high"].values, strict=True)
        ]
        rows.append(Row(name, tuple(cells), unit))
    columns = ("", *(f"{100.0 * share:g} %" for share in plot.QUANTILES))
    caption = "Intervals of these quantiles, 95 % confidence, by order of the runs; a dash: too few runs"
    return PageTable(columns=columns, rows=tuple(rows), caption=caption, key="intervals")


def _figures(study: xr.Dataset) -> Section:
    pictures, notes = [], []
    allowed = list(plot.study_figures(study))
    for figure in allowed[:_MOST_FIGURES]:
        wide = figure.name == "all-against-all"
        try:
            shown = picture(figure.draw(width="page" if wide else "column"), figure.title, figure.name)
        except AntennaPinError as error:
            notes.append(f"{figure.title}: {error}.")
            continue
        pictures.append(shown)
    if len(allowed) > _MOST_FIGURES:
        notes.append(f"{len(allowed) - _MOST_FIGURES} more figures can be drawn by antenna-pin study plot.")
    return Section(key="figures", title="Figures", items=tuple(pictures), notes=tuple(notes))


def _sensitivities(study: xr.Dataset, figures: bool) -> Section:
    items: list[PageTable | Picture] = []
    notes = []
    for name in _names(study, "responses"):
        try:
            found = sensitivities(study, name)
        except AntennaPinError as error:
            notes.append(f"{name}: {error}.")
            continue
        columns = [str(one) for one in found.data_vars]
        rows = []
        for factor in found["factor"].values:
            values = ((float(found[c].sel(factor=factor)), found[c].attrs["units"]) for c in columns)
            rows.append(Row(str(factor), tuple(Cell(readable(*one)) for one in values)))
        words = tuple(f"{c}: {found[c].attrs['long_name']}" for c in columns if not c.endswith("_conf"))
        caption, key = f"{name} ({'; '.join(words)})", f"sensitivity-{name}"
        items.append(PageTable(columns=("", *columns), rows=tuple(rows), caption=caption, key=key))
        if figures:
            shown = plot.study_sensitivities(found, name)
            items.append(picture(shown, f"Sensitivities of {name}", key))
    return Section(key="sensitivities", title="Sensitivities", items=tuple(items), notes=tuple(notes))


def _parameters(study: xr.Dataset) -> Section:
    rows = []
    for name in _names(study, "parameters"):
        found = study[name]
        values = found.values
        if values.dtype.kind in "fi":
            units = str(found.attrs.get("units", ""))
            ends = f"{readable(float(values.min()), units)} to {readable(float(values.max()), units)}"
        else:
            ends = ", ".join(map(str, values))
        key, count = Cell(str(found.attrs.get("key", ""))), Cell(str(values.size), float(values.size))
        rows.append(Row(name, (key, Cell(ends), count)))
    table = PageTable(
        columns=("", "key of the scenario", "values", "number"),
        rows=tuple(rows),
        caption="What was varied",
        key="parameters",
    )
    return Section(key="parameters", title="Parameters", items=(table,))


def _failures(study: xr.Dataset) -> Section:
    rows = list(_failed(study))
    table = PageTable(
        columns=("run", "parameters", "outcome", "why"),
        rows=tuple(rows[:_MOST_FAILURES]),
        caption=f"Runs that are not whole: {_counted(study)}",
        key="failures",
    )
    more = len(rows) - _MOST_FAILURES
    notes = (f"{more} more are in the store.",) if more > 0 else ()
    return Section(key="failures", title="Failures", items=(table,) if rows else (), notes=notes)


def _failed(study: xr.Dataset) -> Iterator[Row]:
    names = _names(study, "parameters")
    for place in np.argwhere(np.any(list(_faults(study).values()), axis=0)):
        one = study.isel(dict(zip(study["outcome"].dims, map(int, place), strict=True)))
        values = ", ".join(
            f"{name} = {readable(float(one[name]), str(one[name].attrs.get('units', '')))}"
            if one[name].dtype.kind in "fi"
            else f"{name} = {one[name].item()}"
            for name in names
        )
        outcome = str(one["outcome"].item()).lower().replace("_", " ")
        cells = (Cell(values), Cell(outcome), Cell(str(one["message"].item())))
        yield Row(str(int(one["run"])), cells)


def _provenance(study: xr.Dataset, about: dict[str, object]) -> Section:
    versions = ", ".join(f"{name} {version}" for name, version in json.loads(study.attrs["versions"]).items())
    wall = np.ravel(study["wall_time"].values) if "wall_time" in study else np.zeros(0)
    wall = wall[np.isfinite(wall)]
    statements = [
        statement("scenario", f"{about['scenario']}, case {about['case'] or 'of its default'}"),
        statement("samples", f"{study.attrs['method']}, seed {about['seed']}"),
        statement("versions", versions),
        statement("digest", str(study.attrs["digest"]), code=True),
    ]
    if wall.size:
        each = readable(float(wall.mean()), "s")
        said = f"{readable(float(wall.sum()), 's')} for {wall.size} runs, {each} each"
        statements.insert(2, statement("time", said))
    text = json.dumps(about, indent=1, ensure_ascii=False)
    return Section(
        key="provenance",
        title="Provenance",
        statements=tuple(statements),
        items=(Details(title="The study, as it was read", text=text, key="study"),),
    )
