"""The dataset of a study: its responses and how its runs ended, labelled by its parameters."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.sweep.design import SAMPLE, Design
from antenna_pin.sweep.study import Study

__all__ = ["FORMAT", "PENDING", "add_entries", "empty_table", "table_of"]

#: Identifies the format of a study's dataset.
FORMAT = "antenna_pin study 1"

#: Outcome of a run that is still to be made.
PENDING = "PENDING"

# What is kept of each run beside its responses: units, meaning, type.
_COLUMNS: dict[str, tuple[str, str, type]] = {
    "end_time": ("s", "simulated time", float),
    "steps": ("1", "steps accepted", int),
    "rejected": ("1", "trial steps rejected by their error", int),
    "relocated": ("1", "trial steps cut back to end at a change of contact", int),
    "evaluations": ("1", "evaluations of the equations of motion", int),
}


def empty_table(study: Study, design: Design, about: Mapping[str, str]) -> xr.Dataset:
    """Return the dataset of a study of which no run has been made.

    Args:
        study: The study.
        design: Its runs.
        about: Further attributes.
    """
    dims = tuple(design.sizes)
    coordinates: dict[str, Any] = {}
    for column in design.columns:
        values = column.settings.values
        numeric = not any(math.isnan(value.number) for value in values)
        attributes = {"long_name": column.title, "key": ", ".join(column.keys)}
        if numeric:
            attributes["units"] = column.settings.unit
        labels = [value.number if numeric else value.text for value in values]
        coordinates[column.name] = (column.dim, np.array(labels, dtype=float if numeric else str), attributes)
    found: dict[str, Any] = {
        name: (
            dims,
            np.full(design.shape, np.nan),
            {"units": response.unit, "long_name": response.meaning},
        )
        for name, response in study.responses.items()
    }
    found["outcome"] = (dims, np.full(design.shape, PENDING, dtype=object), {"long_name": "why it ended"})
    found["message"] = (dims, np.full(design.shape, "", dtype=object), {"long_name": "that in words"})
    for name, (units, meaning, kind) in _COLUMNS.items():
        fill = np.full(design.shape, np.nan) if kind is float else np.zeros(design.shape, dtype=np.int64)
        found[name] = (dims, fill, {"units": units, "long_name": meaning})
    found["seed"] = (dims, design.seeds.reshape(design.shape), {"long_name": "seed of the run"})
    if design.probability is not None:
        coordinates["factor"] = ("factor", np.array(design.factors, dtype=str))
        found["probability"] = (
            (SAMPLE, "factor"),
            design.probability,
            {"units": "1", "long_name": "where a sample stands in its distribution"},
        )
    attributes = {
        "format": FORMAT,
        "title": study.title,
        "study": study.model_dump_json(exclude={"folder"}),
        "parameters": json.dumps([column.name for column in design.columns]),
        "responses": json.dumps(list(study.responses)),
        "method": study.sampling.method if study.sampling is not None else "grid",
        **about,
    }
    return xr.Dataset(found, coords=coordinates, attrs=attributes)


def add_entries(table: xr.Dataset, entries: Iterable[Mapping[str, Any]]) -> None:
    """Write finished runs into a study's dataset."""
    shape = table["outcome"].shape
    names = json.loads(table.attrs["responses"])
    arrays = {name: table[name].values for name in (*names, "outcome", "message", *_COLUMNS)}
    for entry in entries:
        place = np.unravel_index(entry["run"], shape)
        for name in names:
            arrays[name][place] = entry["values"].get(name, np.nan)
        for name in ("outcome", "message", *_COLUMNS):
            arrays[name][place] = entry[name]


def table_of(
    study: Study, design: Design, about: Mapping[str, str], entries: Iterable[Mapping[str, Any]]
) -> xr.Dataset:
    """Return the dataset of a study with the runs that have been made, in whatever order."""
    table = empty_table(study, design, about)
    add_entries(table, entries)
    return table
