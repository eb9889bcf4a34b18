"""Sensitivities as results: derivatives with their growth, tables, dataset and file."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import check_number, takes
from antenna_pin.base.arrays import Array
from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.base.readable import brief
from antenna_pin.errors import UnknownNameError
from antenna_pin.scenario import Scenario
from antenna_pin.studies.sensitivity.parameters import Parameter
from antenna_pin.trajectory import Trajectory, open_table, table_attributes

# --- growth of derivatives ----------------------------------------------------------------------------------

# Fewest samples for a growth rate.
_FEWEST = 5


class DerivativeGrowth(NamedTuple):
    """Growth of the velocities' derivative over one parameter along a run."""

    key: str  # key of the parameter
    largest: float  # largest change of velocities per scale of it [m/s] ([rad/s])
    when: float  # time of the largest change [s]
    # rate of growth as exp(exponent t), by a straight line through the logarithm over all samples: the
    # exponent of this motion over this span, not of an attractor [1/s]. NaN for fewer than five samples
    exponent: float
    # time from which on, to the end, the error estimate exceeds the given share of the largest derivative so
    # far; infinity if it does not at the end [s]
    believed: float


def _growth(
    times: Array, slopes: Array, doubts: Array, keys: tuple[str, ...], share: float
) -> tuple[DerivativeGrowth, ...]:
    """Return the growth of the velocities' derivatives."""
    found = []
    for k, key in enumerate(keys):
        sizes, rest = (np.linalg.norm(one[..., k], axis=1) for one in (slopes, doubts))
        known = np.isfinite(sizes) & (sizes > 0.0)
        if not known.any():
            found.append(DerivativeGrowth(key, 0.0, math.nan, math.nan, math.inf))
            continue
        top = int(np.argmax(np.where(known, sizes, -1.0)))
        told = known & (rest < sizes)
        exponent = math.nan
        if np.count_nonzero(told) >= _FEWEST:
            exponent = float(np.polyfit(times[told], np.log(sizes[told]), 1)[0])
        # A derivative that returns to zero is known if its error is small beside its past values.
        been = np.maximum.accumulate(np.where(known, sizes, 0.0))
        sure = np.flatnonzero(known & (rest <= share * been))
        last = int(sure[-1]) if len(sure) else 0
        believed = math.inf if known[last + 1 :].sum() == 0 and len(sure) else float(times[last])
        found.append(DerivativeGrowth(key, float(sizes[top]), float(times[top]), exponent, believed))
    return tuple(found)


# --- sensitivities ------------------------------------------------------------------------------------------

# Step along derivatives of functions of samples, in a parameter's scale.
_STEP = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class Sensitivities:
    """Derivatives of all results of a run, over numbers of its scenario."""

    run: Trajectory  # the run itself
    parameters: tuple[Parameter, ...]  # the numbers, in the order of ``parameter``
    # by the names of the result's variables, at the requested times: ``NAME``, its derivatives ``d_NAME``
    # over (..., parameter), and their error estimates ``doubt_NAME``
    data: xr.Dataset

    __repr__ = brief

    def derivative(self, variable: str) -> Array:
        """Return the derivatives of a variable of the result, (time, ..., parameter), in SI units.

        Raises:
            UnknownNameError: The result has no such number.
        """
        return self._of("d_", variable)

    def doubt(self, variable: str) -> Array:
        """Return the error estimate of :meth:`derivative`, likewise."""
        return self._of("doubt_", variable)

    def relative(self, variable: str) -> Array:
        """Return the derivative of a variable per scale of each parameter, (time, ..., parameter).

        A hundredth of it is the change per 1 %, where scales are the parameters' values.
        """
        return np.asarray(self.derivative(variable) * np.array([one.scale for one in self.parameters]))

    def growth(self, share: float = 0.01) -> tuple[DerivativeGrowth, ...]:
        """Return the growth of velocities' derivatives over the samples, up to a relative error [-].

        Raises:
            InvalidParameterError: The share is out of range.
        """
        check_number("sensitivities", "share", share, "between 0 and 1")
        scales = np.array([one.scale for one in self.parameters])
        slopes, doubts = self.derivative("v") * scales, self.doubt("v") * scales
        keys = tuple(one.key for one in self.parameters)
        return _growth(self.data["time"].values, slopes, doubts, keys, share)

    def of(self, quantity: Callable[[xr.Dataset], Any]) -> tuple[Array, Array]:
        """Return the derivatives of a function of samples, such as a pointing index, with errors.

        Samples are perturbed by their derivatives, from any method, and the quantity is differentiated along
        them: it must be smooth, except for switches that stay where they are, as those of a largest value.

        Args:
            quantity: Function of a dataset like the result's, at the requested times: numbers, (...).

        Returns:
            (..., parameter) each; error estimates are those of the samples, all on one side.
        """
        names = [str(one)[2:] for one in self.data.data_vars if str(one).startswith("d_")]
        here = self.data[names]

        def displaced(k: int, s: float, kind: str) -> Array:
            slopes = {name: self.data[f"{kind}{name}"].isel(parameter=k, drop=True) for name in names}
            parts = {name: here[name] + s * slope for name, slope in slopes.items()}
            return np.asarray(quantity(here.assign(parts)), dtype=float)

        slopes, doubts = [], []
        for k, one in enumerate(self.parameters):
            step = _STEP * one.scale
            ahead, behind = (
                np.array([displaced(k, side * j * step, "d_") for j in (1, 2, 3)]) for side in (1, -1)
            )
            sixth, fourth = np.tensordot(WEIGHTS, ahead - behind, 1) / step
            carried = np.abs(displaced(k, step, "doubt_") - displaced(k, -step, "doubt_")) / (2.0 * step)
            slopes.append(sixth)
            doubts.append(np.abs(sixth - fourth) + carried)
        return np.stack(slopes, axis=-1), np.stack(doubts, axis=-1)

    def _of(self, kind: str, variable: str) -> Array:
        if f"d_{variable}" not in self.data:
            known = [str(name)[2:] for name in self.data if str(name).startswith("d_")]
            raise UnknownNameError("sensitivities", "variable with derivatives", variable, known)
        return np.asarray(self.data[f"{kind}{variable}"].values)


def dataset_of(
    here: xr.Dataset, slopes: dict[str, Array], doubts: dict[str, Array], parameters: tuple[Parameter, ...]
) -> xr.Dataset:
    """Return variables with their derivatives and error estimates, (..., parameter) each."""
    found: dict[str, tuple[tuple[str, ...], Array, dict[str, str]]] = {}
    for name, slope in slopes.items():
        dims = (*map(str, here[name].dims), "parameter")
        unit, words = (str(here[name].attrs.get(one, "")) for one in ("units", "long_name"))
        about = {"units": f"{unit} per unit of the parameter", "long_name": f"derivative of {words or name}"}
        found[f"d_{name}"] = dims, slope, about
        found[f"doubt_{name}"] = (
            dims,
            doubts[name],
            about | {"long_name": f"doubt of the {about['long_name']}"},
        )
    labels = {
        "parameter": [one.key for one in parameters],
        "parameter_value": ("parameter", [one.value for one in parameters]),
        "parameter_scale": ("parameter", [one.scale for one in parameters]),
        "parameter_unit": ("parameter", [one.unit for one in parameters]),
    }
    return here.assign(found).assign_coords(labels)


# --- rows, dataset and file ---------------------------------------------------------------------------------

# Combination of each variable over all contacts.
_OF_CONTACTS = {
    "peak_force": "max",
    "peak_depth": "max",
    "impulse": "sum",
    "dissipated": "sum",
    "onset_time": "last",
}
# Combination of each variable over events and transitions of one name, whose times are the same, and whose
# angles and rates belong to the elements.
_OF_EVENTS = {
    "event_time": "last",
    "event_energy": "sum",
    "change_loss": "sum",
    "change_impulse": "max",
    "change_energy": "last",
}
# Series in the dataset's curves, one for each component.
_CURVES = ("v", "normal_force", "motion_angle", "slide_position", "drive_torque")
# Unit of velocities, whose components turn or slide.
_OF_VELOCITIES = "m/s or rad/s"


class Changed(NamedTuple):
    """Number of a result, with its changes over parameters."""

    result: str  # name of the number
    unit: str  # its unit
    value: float  # the number
    slopes: Array  # its change per scale of each parameter, (parameters,)
    doubts: Array  # error estimates of the changes

    @property
    def most(self) -> float:
        """The largest change over the number itself; 0 where that is 0 [-]."""
        size = float(np.nanmax(np.abs(self.slopes), initial=0.0))
        return size / abs(self.value) if self.value else 0.0


@takes()
def results_of(sensitivities: Sensitivities) -> list[Changed]:
    """Return the numbers of a result that change significantly, the largest changes first.

    Contacts are combined: the largest force and depth, all impulses and losses, the last onset; events and
    changes of mode likewise, of all of one name. Series are left out.
    """
    rows = [row for row in _rows(sensitivities) if bool((np.abs(row.slopes) > row.doubts).any())]
    return sorted(rows, key=lambda row: -row.most)


def _rows(result: Sensitivities) -> Iterator[Changed]:
    scales = np.array([one.scale for one in result.parameters])
    for name in sorted(str(one)[2:] for one in result.data.data_vars if str(one).startswith("d_")):
        here = result.data[name]
        values, slopes, doubts = here.values, result.relative(name), result.doubt(name) * scales
        unit = str(here.attrs.get("units", ""))
        if "time" in here.dims:
            continue
        groups = _groups(here)
        if groups is not None:
            way = (_OF_CONTACTS | _OF_EVENTS).get(name, "")
            for label, rows in groups.items() if way else ():
                parts = values[rows], slopes[rows], doubts[rows]
                yield _combined(way, f"{name} {label}".strip(), unit, parts)
            continue
        for index in np.ndindex(values.shape):
            label = f"{name} {_labels(here, index)}".strip()
            yield Changed(label, unit, float(values[index]), slopes[index], doubts[index])


def _groups(here: xr.DataArray) -> dict[str, list[int]] | None:
    """Return events and contacts that are combined, by name; None for other variables."""
    if "episode" in here.dims:
        return {"": list(range(here.size))} if here.size else {}
    dim = next((one for one in ("event", "change") if one in here.dims), None)
    if dim is None:
        return None
    groups: dict[str, list[int]] = {}
    for k, name in enumerate(here[dim].values.tolist()):
        groups.setdefault(str(name), []).append(k)
    return groups


def _combined(way: str, name: str, unit: str, numbers: tuple[Array, Array, Array]) -> Changed:
    """Return a sum, maximum or last value of numbers, with changes and errors."""
    values, slopes, doubts = numbers
    said = name if len(values) == 1 and not name.startswith(tuple(_OF_CONTACTS)) else f"{way} {name}"
    if way == "sum":
        return Changed(said, unit, float(values.sum()), slopes.sum(axis=0), doubts.sum(axis=0))
    sizes = np.nan_to_num(np.abs(values))
    at = int(np.argmax(sizes)) if way == "max" else len(values) - 1
    return Changed(said, unit, float(values[at]), slopes[at], doubts[at])


def _labels(here: xr.DataArray, index: tuple[int, ...], without: str = "") -> str:
    """Return the label of a component, as text."""
    dims = [str(dim) for dim in here.dims if dim != without]
    pairs = zip(dims, index, strict=True)
    return " ".join(str(here[dim].values[i]) for dim, i in pairs if dim in here.coords)


@takes()
def sensitivity_table(sensitivities: Sensitivities, scenario: Scenario | None = None) -> xr.Dataset:
    """Return sensitivities as a dataset, which :func:`antenna_pin.studies.nonlinear.save_table` writes.

    Returns:
        Over ``result``, those of :func:`results_of`: ``value``, ``unit``; over ``result`` and ``parameter``:
        ``change`` per ``scale`` of a parameter and its ``doubt``. Over ``parameter``: ``at``, ``scale``,
        ``parameter_unit``, ``exponent`` [1/s] and ``believed`` [s] (:meth:`Sensitivities.growth`). Over
        ``time``, ``curve`` and ``parameter``: ``curve_change`` and ``curve_doubt``, of motions.
        The attribute ``refused`` lists pieces without derivatives.
    """
    rows, growth, names = (
        results_of(sensitivities),
        sensitivities.growth(),
        [one.key for one in sensitivities.parameters],
    )
    nothing = np.zeros((0, len(names)))
    curves, labels, units = _curves(sensitivities)
    return xr.Dataset(
        {
            "value": ("result", np.array([row.value for row in rows], dtype=float)),
            "unit": ("result", np.array([row.unit for row in rows], dtype=object)),
            "change": (("result", "parameter"), np.array([row.slopes for row in rows]) if rows else nothing),
            "doubt": (("result", "parameter"), np.array([row.doubts for row in rows]) if rows else nothing),
            "at": ("parameter", np.array([one.value for one in sensitivities.parameters])),
            "scale": ("parameter", np.array([one.scale for one in sensitivities.parameters])),
            "parameter_unit": (
                "parameter",
                np.array([one.unit for one in sensitivities.parameters], dtype=object),
            ),
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
            "time": ("time", sensitivities.data["time"].values, {"units": "s"}),
        },
        attrs={
            **table_attributes("sensitivity", scenario),
            "refused": str(sensitivities.data.attrs.get("refused", "[]")),
        },
    )


def _curves(result: Sensitivities) -> tuple[tuple[Array, Array], list[str], list[str]]:
    """Return scaled changes and errors of curves, (time, curve, parameter), with names and units."""
    scales = np.array([one.scale for one in result.parameters])
    changes, doubts, labels, units = [], [], [], []
    for name in (one for one in _CURVES if f"d_{one}" in result.data):
        here, slopes, rest = result.data[name], result.relative(name), result.doubt(name) * scales
        for index in np.ndindex(here.shape[1:]):
            at = (slice(None), *index)
            if not np.nanmax(np.abs(slopes[at]), initial=0.0) > np.nanmax(rest[at], initial=0.0):
                continue
            changes.append(slopes[at])
            doubts.append(rest[at])
            labels.append(f"{name} {_labels(here, index, 'time')}".strip())
            units.append(_unit(result.run.data, str(here.attrs.get("units", "")), labels[-1]))
    shape = (result.data.sizes["time"], 0, len(scales))
    both = tuple(np.stack(one, axis=1) if one else np.zeros(shape) for one in (changes, doubts))
    return (both[0], both[1]), labels, units


def _unit(run: xr.Dataset, unit: str, label: str) -> str:
    """Return the unit of one component of a variable of several units."""
    if unit != _OF_VELOCITIES:
        return unit
    joint, _, axis = label.split()[-1].partition(".")
    if axis:
        return "rad/s" if axis.startswith("w") else "m/s"
    slides = run["sliding_joint"].values.tolist() if "sliding_joint" in run else []
    return "m/s" if joint in slides else "rad/s"


@takes()
def growth_said(sensitivities: Sensitivities, share: float = 0.01) -> str:
    """Return one line on the validity of derivatives, up to a relative error [-]."""
    every = [one for one in sensitivities.growth(share) if one.largest > 0.0]
    if not every:
        return "no velocity changes with these"
    fastest = max(every, key=lambda one: -math.inf if math.isnan(one.exponent) else one.exponent)
    first = min(every, key=lambda one: one.believed)
    grown = (
        ""
        if math.isnan(fastest.exponent)
        else (f"derivatives of velocities go like exp({fastest.exponent:.3g}/s t) (over {fastest.key}), ")
    )
    if first.believed <= float(sensitivities.data["time"].values[0]):
        return f"{grown}not known to {share:.0%} at all (over {first.key}): all may be in doubt"
    if first.believed == math.inf:
        return f"{grown}known to {share:.0%} to the end"
    return f"{grown}known to {share:.0%} up to {first.believed:.6g} s (over {first.key}); then take pieces"


@takes()
def refused_in(sensitivities: Sensitivities) -> list[dict[str, float | str]]:
    """Return the pieces without derivatives: begin, end and reason."""
    told: list[dict[str, float | str]] = json.loads(str(sensitivities.data.attrs.get("refused", "[]")))
    return told


@takes()
def open_sensitivities(path: str | os.PathLike[str]) -> xr.Dataset:
    """Return a :func:`sensitivity_table` from a file of ``antenna-pin sensitivity --out``."""
    return open_table(path, "sensitivity")
