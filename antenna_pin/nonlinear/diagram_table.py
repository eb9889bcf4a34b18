"""The dataset of a bifurcation diagram, from the entries of its values; and its file."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis.transients import RULE
from antenna_pin.base.arguments import takes
from antenna_pin.base.units import any_quantity
from antenna_pin.nonlinear.branches import Asked, Entry
from antenna_pin.trajectory import open_table, table_attributes

__all__ = ["diagram_table", "open_diagram", "open_section"]


def diagram_table(
    asked: Asked, values: Sequence[Any], branches: Sequence[str], entries: Mapping[int, Entry]
) -> xr.Dataset:
    """Return the dataset of a diagram.

    Args:
        asked: What was asked at every value.
        values: Of the parameter.
        branches: In the order of the entries' numbers.
        entries: Of every value of every branch, by number.
    """
    b, n, most = len(branches), len(values), max((len(one["times"]) for one in entries.values()), default=0)
    times = np.full((b, n, most), np.nan)
    points = np.full((b, n, most, len(asked.quantities)), np.nan)
    found: dict[str, np.ndarray] = {
        "settled": np.zeros((b, n), dtype=bool),
        "drift": np.full((b, n), np.nan),
        "points": np.zeros((b, n), dtype=np.int64),
        "transient": np.zeros((b, n), dtype=np.int64),
        "period": np.full((b, n), np.nan),
        "outcome": np.full((b, n), "", dtype=object),
        "message": np.full((b, n), "", dtype=object),
    }
    units, titles = [""] * len(asked.quantities), [""] * len(asked.quantities)
    for number, entry in entries.items():
        place = np.unravel_index(number, (b, n))
        here = len(entry["times"])
        if here:
            times[place][:here] = entry["times"]
            points[place][:here] = entry["values"]
            units, titles = entry["units"], entry["titles"]
        found["points"][place] = here
        for name in ("settled", "transient", "outcome", "message"):
            found[name][place] = entry[name]
        for name in ("drift", "period"):
            found[name][place] = np.nan if entry[name] is None else entry[name]
    numbers = [any_quantity(value) for value in values]
    unit = next((one[1] for one in numbers if one is not None and one[1]), "")
    said = {"long_name": asked.parameter, "units": unit, "key": asked.parameter}
    over = ("branch", "value")
    about = {
        "settled": {"long_name": "whether the points have settled"},
        "drift": {
            "units": "1",
            "long_name": "largest drift of a statistic of the points",
        },
        "points": {"units": "1", "long_name": "points kept"},
        "transient": {"units": "1", "long_name": "points cut before these"},
        "period": {"units": "s", "long_name": "period of the stroboscope"},
        "outcome": {"long_name": "why the run ended"},
        "message": {"long_name": "that in words"},
    }
    variables: dict[str, Any] = {
        name: ((*over, "point"), points[..., k], {"units": units[k], "long_name": titles[k]})
        for k, name in enumerate(asked.quantities)
    }
    variables["time"] = ((*over, "point"), times, {"units": "s", "long_name": "when the section is passed"})
    variables |= {name: (over, found[name], about[name]) for name in found}
    return xr.Dataset(
        variables,
        coords={
            "branch": ("branch", np.array(branches, dtype=str), {"long_name": "how a value is come to"}),
            "value": ("value", np.array([one[0] for one in numbers if one is not None]), said),
        },
        attrs={
            **table_attributes("bifurcation", asked.scenario),
            "parameter": asked.parameter,
            "quantities": json.dumps(asked.quantities),
            "section": asked.section.words,
            "rule": RULE,
            "tolerance": asked.tolerance,
        },
    )


@takes()
def open_diagram(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return a bifurcation diagram from its file.

    Args:
        path: The file, as :func:`antenna_pin.nonlinear.bifurcation` wrote it.

    Returns:
        Over ``branch`` (fresh, forward, backward), ``value`` of the parameter, SI, and ``point``: ``time``
        [s] and each quantity, NaN where a run had fewer points. Over ``branch`` and ``value``: ``settled``,
        ``drift`` [-], ``points`` and ``transient`` [-], the points kept and those cut before them, ``period``
        [s] of the stroboscope, ``outcome`` and ``message``.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    table = open_table(path, "bifurcation")
    for name in ("outcome", "message"):
        table[name] = table[name].astype(object)
    table["settled"] = table["settled"].astype(bool)
    return table


@takes()
def open_section(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return the points of a section from their file.

    Args:
        path: The file, as :func:`save_table` wrote it.

    Returns:
        As :func:`antenna_pin.nonlinear.poincare` does.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    table = open_table(path, "section")
    table["settled"] = table["settled"].astype(bool)
    return table
