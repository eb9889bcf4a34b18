"""Sensitivities as rows for people, and as a dataset with its file."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.base.arguments import takes
from antenna_pin.scenario import Scenario
from antenna_pin.sensitivity.found import Sensitivities
from antenna_pin.trajectory import open_table, table_attributes

__all__ = [
    "Changed",
    "growth_said",
    "open_sensitivities",
    "refused_in",
    "results_of",
    "sensitivity_table",
]

Array = NDArray[np.float64]

# What is told of contacts: of all of them together.
_OF_CONTACTS = {
    "peak_force": "max",
    "peak_depth": "max",
    "impulse": "sum",
    "dissipated": "sum",
    "onset_time": "last",
}
# What is told of events and of elements that meet their joints: of all of one name together. Instants of both
# are the same, and angles and rates are those of the elements.
_OF_EVENTS = {
    "event_time": "last",
    "event_energy": "sum",
    "change_loss": "sum",
    "change_impulse": "max",
    "change_energy": "last",
}
# Series that are kept as curves, each component one.
_CURVES = ("v", "normal_force", "motion_angle", "slide_position", "drive_torque")
# The unit of velocities, whose components turn or slide.
_OF_VELOCITIES = "m/s or rad/s"


class Changed(NamedTuple):
    """A number of a result, and what parameters change of it.

    Attributes:
        result: What it is.
        unit: Its unit.
        value: The number.
        slopes: Its change per scale of each parameter, (parameters,).
        doubts: Of these.
    """

    result: str
    unit: str
    value: float
    slopes: Array
    doubts: Array

    @property
    def most(self) -> float:
        """The largest change over the number itself; 0 of one that is 0 [-]."""
        size = float(np.nanmax(np.abs(self.slopes), initial=0.0))
        return size / abs(self.value) if self.value else 0.0


@takes()
def results_of(found: Sensitivities) -> list[Changed]:
    """Return the numbers of a result that change by more than is in doubt, those that change most first.

    Of contacts it is what they come to together: the largest force and depth, all impulses and losses, when
    the last one begins; of events and changes of mode likewise, of all of one name. Series are none of them.
    """
    rows = [row for row in _rows(found) if bool((np.abs(row.slopes) > row.doubts).any())]
    return sorted(rows, key=lambda row: -row.most)


def _rows(found: Sensitivities) -> Iterator[Changed]:
    scales = np.array([one.scale for one in found.parameters])
    for name in sorted(str(one)[2:] for one in found.data.data_vars if str(one).startswith("d_")):
        here = found.data[name]
        values, slopes, doubts = here.values, found.relative(name), found.doubt(name) * scales
        unit = str(here.attrs.get("units", ""))
        if "time" in here.dims:
            continue
        groups = _together(here)
        if groups is not None:
            way = (_OF_CONTACTS | _OF_EVENTS).get(name, "")
            for label, rows in groups.items() if way else ():
                parts = values[rows], slopes[rows], doubts[rows]
                yield _taken(way, f"{name} {label}".strip(), unit, parts)
            continue
        for index in np.ndindex(values.shape):
            label = f"{name} {_labels(here, index)}".strip()
            yield Changed(label, unit, float(values[index]), slopes[index], doubts[index])


def _together(here: xr.DataArray) -> dict[str, list[int]] | None:
    """Return which of what has happened is told together, by its name; None of what is no such thing."""
    if "episode" in here.dims:
        return {"": list(range(here.size))} if here.size else {}
    dim = next((one for one in ("event", "change") if one in here.dims), None)
    if dim is None:
        return None
    groups: dict[str, list[int]] = {}
    for k, name in enumerate(here[dim].values.tolist()):
        groups.setdefault(str(name), []).append(k)
    return groups


def _taken(way: str, name: str, unit: str, numbers: tuple[Array, Array, Array]) -> Changed:
    """Return what numbers come to together, with their changes and doubts: one alone is itself."""
    values, slopes, doubts = numbers
    said = name if len(values) == 1 and not name.startswith(tuple(_OF_CONTACTS)) else f"{way} {name}"
    if way == "sum":
        return Changed(said, unit, float(values.sum()), slopes.sum(axis=0), doubts.sum(axis=0))
    sizes = np.nan_to_num(np.abs(values))
    at = int(np.argmax(sizes)) if way == "max" else len(values) - 1
    return Changed(said, unit, float(values[at]), slopes[at], doubts[at])


def _labels(here: xr.DataArray, index: tuple[int, ...], without: str = "") -> str:
    """Return what tells a component from the others, in words."""
    dims = [str(dim) for dim in here.dims if dim != without]
    pairs = zip(dims, index, strict=True)
    return " ".join(str(here[dim].values[i]) for dim, i in pairs if dim in here.coords)


@takes()
def sensitivity_table(found: Sensitivities, scenario: Scenario | None = None) -> xr.Dataset:
    """Return sensitivities as a dataset, which :func:`antenna_pin.nonlinear.save_table` writes.

    Args:
        found: The sensitivities.
        scenario: What was run.

    Returns:
        Over ``result``, those of :func:`results_of`: ``value``, ``unit``; over ``result`` and ``parameter``:
        ``change`` per ``scale`` of a parameter and its ``doubt``. Over ``parameter``: ``at``, ``scale``,
        ``parameter_unit``, ``exponent`` [1/s] and ``believed`` [s] (:meth:`Sensitivities.growth`). Over
        ``time``, ``curve`` and ``parameter``: ``curve_change`` and ``curve_doubt``, of motions.
        ``refused``, among the attributes, tells of pieces without derivatives.
    """
    rows, growth, names = results_of(found), found.growth(), [one.key for one in found.parameters]
    nothing = np.zeros((0, len(names)))
    curves, labels, units = _curves(found)
    return xr.Dataset(
        {
            "value": ("result", np.array([row.value for row in rows], dtype=float)),
            "unit": ("result", np.array([row.unit for row in rows], dtype=object)),
            "change": (("result", "parameter"), np.array([row.slopes for row in rows]) if rows else nothing),
            "doubt": (("result", "parameter"), np.array([row.doubts for row in rows]) if rows else nothing),
            "at": ("parameter", np.array([one.value for one in found.parameters])),
            "scale": ("parameter", np.array([one.scale for one in found.parameters])),
            "parameter_unit": ("parameter", np.array([one.unit for one in found.parameters], dtype=object)),
            "exponent": ("parameter", np.array([one.exponent for one in growth])),
            "believed": ("parameter", np.array([one.believed for one in growth])),
            "curve_unit": ("curve", np.array(units, dtype=object)),
            "curve_change": (("time", "curve", "parameter"), curves[0]),
            "curve_doubt": (("time", "curve", "parameter"), curves[1]),
        },
        coords={
            "result": ("result", np.array([row.result for row in rows], dtype=object)),
            "parameter": ("parameter", np.array(names, dtype=object)),
            "curve": ("curve", np.array(labels, dtype=object)),
            "time": ("time", found.data["time"].values, {"units": "s"}),
        },
        attrs={
            **table_attributes("sensitivity", scenario),
            "refused": str(found.data.attrs.get("refused", "[]")),
        },
    )


def _curves(found: Sensitivities) -> tuple[tuple[Array, Array], list[str], list[str]]:
    """Return changes per scale and doubts of curves, (time, curve, parameter), their names and units."""
    scales = np.array([one.scale for one in found.parameters])
    changes, doubts, labels, units = [], [], [], []
    for name in (one for one in _CURVES if f"d_{one}" in found.data):
        here, slopes, rest = found.data[name], found.relative(name), found.doubt(name) * scales
        for index in np.ndindex(here.shape[1:]):
            at = (slice(None), *index)
            if not np.nanmax(np.abs(slopes[at]), initial=0.0) > np.nanmax(rest[at], initial=0.0):
                continue
            changes.append(slopes[at])
            doubts.append(rest[at])
            labels.append(f"{name} {_labels(here, index, 'time')}".strip())
            units.append(_unit(found.run.data, str(here.attrs.get("units", "")), labels[-1]))
    shape = (found.data.sizes["time"], 0, len(scales))
    both = tuple(np.stack(one, axis=1) if one else np.zeros(shape) for one in (changes, doubts))
    return (both[0], both[1]), labels, units


def _unit(run: xr.Dataset, unit: str, label: str) -> str:
    """Return the unit of one component, of a variable whose components have several."""
    if unit != _OF_VELOCITIES:
        return unit
    joint, _, axis = label.split()[-1].partition(".")
    if axis:
        return "rad/s" if axis.startswith("w") else "m/s"
    slides = run["sliding_joint"].values.tolist() if "sliding_joint" in run else []
    return "m/s" if joint in slides else "rad/s"


@takes()
def growth_said(found: Sensitivities, share: float = 0.01) -> str:
    """Return in one line how far derivatives can be believed.

    Args:
        found: The sensitivities.
        share: Of doubt over a derivative, up to which it is believed [-].
    """
    every = [one for one in found.growth(share) if one.largest > 0.0]
    if not every:
        return "no velocity changes with these"
    fastest = max(every, key=lambda one: -math.inf if math.isnan(one.exponent) else one.exponent)
    first = min(every, key=lambda one: one.believed)
    grown = (
        ""
        if math.isnan(fastest.exponent)
        else (f"derivatives of velocities go like exp({fastest.exponent:.3g}/s t) (over {fastest.key}), ")
    )
    if first.believed <= float(found.data["time"].values[0]):
        return f"{grown}not known to {share:.0%} at all (over {first.key}): all may be in doubt"
    if first.believed == math.inf:
        return f"{grown}known to {share:.0%} to the end"
    return f"{grown}known to {share:.0%} up to {first.believed:.6g} s (over {first.key}); then take pieces"


@takes()
def refused_in(found: Sensitivities) -> list[dict[str, float | str]]:
    """Return the pieces that have no derivatives: from when to when, and why."""
    told: list[dict[str, float | str]] = json.loads(str(found.data.attrs.get("refused", "[]")))
    return told


@takes()
def open_sensitivities(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return sensitivities from their file, as ``antenna-pin sensitivity --out`` writes it.

    Returns:
        See :func:`sensitivity_table`.

    Raises:
        FileFormatError: It is none, or damaged.
    """
    return open_table(path, "sensitivity")
