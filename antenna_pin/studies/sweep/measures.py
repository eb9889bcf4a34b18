"""Measures of a run, by name: from its summary, and from analyses."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.analysis import base_motion, deviation, error_components, pointing_error, pointing_indices
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.trajectory import Trajectory, blow_numbers, contact_joints, names_along
from antenna_pin.trajectory.columns import Variable
from antenna_pin.trajectory.quantities import CONTACTS, RUN, SUMMARIES, reduced


class MeasureArguments(Protocol):
    """Arguments of a response's measure; a table of a study file."""

    measure: str | None
    of: str | None
    index: str
    component: str
    value: str
    window: float | None
    drift_spacing: float | None
    period: float | None
    confidence: float


Found = Callable[[Trajectory, Any, Trajectory | None], float]


@dataclass(frozen=True, slots=True)
class MeasureDefinition:
    """Definition of a number of a run."""

    name: str
    units: str
    meaning: str  # as text
    of: str  # dimension of ``of``: ``contact`` (or a joint with play), or another; "" for the whole run
    find: Found
    series: bool = False  # needs series, which a lean result leaves out
    compares: bool = False  # needs the study's reference
    sliding: bool = False  # has another unit for sliding joints


def _of_episodes(of: Variable) -> Found:
    def find(run: Trajectory, spec: MeasureArguments, _: Trajectory | None) -> float:
        mine = _episodes(run, spec)
        # Without labels, which cost more than the sum: a response is asked of many runs.
        data = run.data.variables
        return float(reduced(of, data, mine, float(run.data.attrs["end_time"])))

    return find


def _blows(run: Trajectory, spec: MeasureArguments, _: Trajectory | None) -> float:
    return float(len(np.unique(blow_numbers(run.data)[_episodes(run, spec)])))


def _episodes(run: Trajectory, spec: MeasureArguments) -> slice | NDArray[np.bool_]:
    """Return the selection of a response's contact episodes."""
    if "contact" not in run.data.sizes:
        raise UnknownNameError(spec.measure or "", "contact", spec.of or "any", ())
    if spec.of is None:
        return slice(None)
    names = names_along(run.data, "contact")
    joints = contact_joints(run.data)
    chosen = [i for i, name in enumerate(names) if spec.of in (name, joints[name])]
    if not chosen:
        known = {*names, *joints.values()}
        raise UnknownNameError(spec.measure or "", "contact or joint with play", spec.of or "any", known)
    return np.isin(run.data.variables["episode_contact"].values, chosen)


def _of_labels(name: str, dim: str) -> Found:
    def find(run: Trajectory, spec: MeasureArguments, _: Trajectory | None) -> float:
        names = names_along(run.data, dim)
        values = (
            dict(zip(names, np.asarray(run.data[name].values, dtype=float), strict=True)) if names else {}
        )
        if spec.of is not None or not values:
            if spec.of not in values:
                raise UnknownNameError(name, dim.replace("_", " "), spec.of or "any", names)
            return float(values[spec.of])
        numbers = np.array(list(values.values()))
        if name.startswith("total_"):
            return float(numbers.sum())
        if name.startswith("peak_"):
            return float(numbers.max())
        if len(values) > 1:
            raise InvalidParameterError(name, "of", f"given, one of {', '.join(names)}", None)
        return float(numbers[0])

    return find


def _conserved(name: str) -> Found:
    def find(run: Trajectory, spec: MeasureArguments, _: Trajectory | None) -> float:
        found: Mapping[str, Any] = json.loads(run.data.attrs["conservation"])
        if found.get(name) is None:
            raise UnknownNameError(spec.measure or "", "ledger", name, found)
        return float(found[name])

    return find


# The last run's error, for indices of it that are asked for one after the other.
_last: list[tuple[Trajectory, Trajectory | None, xr.Dataset]] = []


def _pointing_error(run: Trajectory, reference: Trajectory | None) -> xr.Dataset:
    for of, beside, found in tuple(_last):  # of another thread's, perhaps
        if of is run and beside is reference:
            return found
    errors = pointing_error(run, reference)
    _last[:] = [(run, reference, errors)]
    return errors


def _pointing(run: Trajectory, spec: MeasureArguments, reference: Trajectory | None) -> float:
    errors = _pointing_error(run, reference)
    components = error_components(errors)
    if spec.component not in components:
        raise UnknownNameError("pointing", "component", spec.component, components)
    found = pointing_indices(
        errors["time"].values,
        {spec.component: components[spec.component]},
        window=spec.window,
        drift_spacing=spec.drift_spacing,
        periods=spec.period,
        confidence=spec.confidence,
    )
    known = [str(name) for name in found["index"].values]
    if spec.index not in known:
        raise UnknownNameError("pointing", "index with these windows", spec.index, known)
    one = found.sel(index=spec.index, component=spec.component)
    if spec.value == "largest":
        return float(one["extreme"])
    return float(one["level"].sel(interpretation="temporal"))


def _deviation(which: str) -> Found:
    def find(run: Trajectory, spec: MeasureArguments, reference: Trajectory | None) -> float:
        assert reference is not None
        if spec.of is None:
            known = [measures.of for measures in deviation(run, reference).measures]
            raise InvalidParameterError(f"deviation_{which}", "of", f"one of {', '.join(known)}", None)
        found = deviation(run, reference)[spec.of]
        return float({"maximum": found.maximum, "rms": found.rms, "end": found.end}[which])

    return find


def _base_turn(run: Trajectory, spec: MeasureArguments, _: Trajectory | None) -> float:
    from scipy.spatial.transform import Rotation

    attitude = Rotation.from_quat(base_motion(run)["attitude"].values)
    return float((attitude[0].inv() * attitude).magnitude().max())


def _all() -> dict[str, MeasureDefinition]:
    found = [
        MeasureDefinition(one.name, one.units, one.meaning, "contact", _of_episodes(one)) for one in CONTACTS
    ]
    found += [
        MeasureDefinition(one.name, one.units, one.meaning, "", _conserved(one.name))
        for one in RUN.values()
        if one.source == "conservation"
    ]
    found += [
        MeasureDefinition("blows", "1", "number of blows, overlapping contacts being one", "contact", _blows),
        MeasureDefinition(
            "base_turn", "rad", "largest turn of the base from its start", "", _base_turn, series=True
        ),
        MeasureDefinition(
            "pointing",
            "rad",
            "index of the pointing error (index, component, value, window, ...)",
            "",
            _pointing,
            series=True,
            compares=True,
        ),
    ]
    for which, words in (("maximum", "largest"), ("rms", "root mean square"), ("end", "last")):
        found.append(
            MeasureDefinition(
                f"deviation_{which}",
                "",
                f"{words} deviation from the reference, of a joint's quantity as 'elevation angle'",
                "quantity",
                _deviation(which),
                series=True,
                compares=True,
            )
        )
    for one in SUMMARIES:
        if len(one.dims) == 1:
            (dim,) = one.dims
            find = _of_labels(one.name, dim)
            found.append(
                MeasureDefinition(one.name, one.units, one.meaning, dim, find, sliding=bool(one.sliding))
            )
    return {measure.name: measure for measure in found}


#: Every measure, by name.
MEASURES: dict[str, MeasureDefinition] = _all()
