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
from antenna_pin.trajectory.schema import VARIABLES

__all__ = ["MEASURES", "Asked", "Measure"]

Array = NDArray[np.float64]


class Asked(Protocol):
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
class Measure:
    """One number of a run.

    Attributes:
        name: Of the measure.
        units: Of the number.
        meaning: In words.
        of: What ``of`` names: ``contact`` (or a joint with play), or another dimension of a result; "" for
            what is of the whole run.
        find: Returns it.
        series: Whether it needs the series that a lean result leaves out.
        compares: Whether it needs the study's reference.
    """

    name: str
    units: str
    meaning: str
    of: str
    find: Found
    series: bool = False
    compares: bool = False


def _of_episodes(name: str, over: Callable[[Array], float]) -> Found:
    def find(run: Trajectory, spec: Asked, _: Trajectory | None) -> float:
        if "contact" not in run.data.sizes:
            raise UnknownNameError(spec.measure or "", "contact", spec.of or "any", ())
        # Without labels, which cost more than the sum: a response is asked of many runs.
        data = run.data.variables
        mine = (
            slice(None) if spec.of is None else np.isin(data["episode_contact"].values, _contacts(run, spec))
        )
        if name == "duration":
            end = float(run.data.attrs["end_time"])
            release = np.nan_to_num(np.asarray(data["release_time"].values, dtype=float), nan=end)
            return over((release - data["onset_time"].values)[mine])
        return over(np.asarray(data[name].values, dtype=float)[mine])

    return find


def _blows(run: Trajectory, spec: Asked, _: Trajectory | None) -> float:
    if "contact" not in run.data.sizes:
        raise UnknownNameError(spec.measure or "", "contact", spec.of or "any", ())
    numbers = blow_numbers(run.data)
    if spec.of is not None:
        numbers = numbers[np.isin(run.data["episode_contact"].values, _contacts(run, spec))]
    return float(len(np.unique(numbers)))


def _contacts(run: Trajectory, spec: Asked) -> list[int]:
    names = names_along(run.data, "contact")
    joints = contact_joints(run.data)
    chosen = [i for i, name in enumerate(names) if spec.of in (name, joints[name])]
    if not chosen:
        known = {*names, *joints.values()}
        raise UnknownNameError(spec.measure or "", "contact or joint with play", spec.of or "any", known)
    return chosen


def _of_labels(name: str, dim: str) -> Found:
    def find(run: Trajectory, spec: Asked, _: Trajectory | None) -> float:
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
    def find(run: Trajectory, spec: Asked, _: Trajectory | None) -> float:
        found: Mapping[str, Any] = json.loads(run.data.attrs["conservation"])
        if found.get(name) is None:
            raise UnknownNameError(spec.measure or "", "ledger", name, found)
        return float(found[name])

    return find


# The last run's error, for indices of it that are asked for one after the other.
_last: list[tuple[Trajectory, Trajectory | None, xr.Dataset]] = []


def _pointing_error(run: Trajectory, reference: Trajectory | None) -> xr.Dataset:
    if not (_last and _last[0][0] is run and _last[0][1] is reference):
        _last[:] = [(run, reference, pointing_error(run, reference))]
    return _last[0][2]


def _pointing(run: Trajectory, spec: Asked, reference: Trajectory | None) -> float:
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
    def find(run: Trajectory, spec: Asked, reference: Trajectory | None) -> float:
        assert reference is not None
        if spec.of is None:
            known = [measures.of for measures in deviation(run, reference).measures]
            raise InvalidParameterError(f"deviation_{which}", "of", f"one of {', '.join(known)}", None)
        found = deviation(run, reference)[spec.of]
        return float({"maximum": found.maximum, "rms": found.rms, "end": found.end}[which])

    return find


def _base_turn(run: Trajectory, spec: Asked, _: Trajectory | None) -> float:
    from scipy.spatial.transform import Rotation

    attitude = Rotation.from_quat(base_motion(run)["attitude"].values)
    return float((attitude[0].inv() * attitude).magnitude().max())


def _largest(values: Array) -> float:
    return float(values.max()) if values.size else 0.0


def _sum(values: Array) -> float:
    return float(values.sum())


def _all() -> dict[str, Measure]:
    found = [
        Measure("peak_force", "N", "largest normal force", "contact", _of_episodes("peak_force", _largest)),
        Measure("peak_depth", "m", "largest depth", "contact", _of_episodes("peak_depth", _largest)),
        Measure(
            "approach_speed",
            "m/s",
            "largest speed at first touch",
            "contact",
            _of_episodes("approach_speed", _largest),
        ),
        Measure("impulse", "N s", "all normal impulses", "contact", _of_episodes("impulse", _sum)),
        Measure("dissipated", "J", "energy lost in contacts", "contact", _of_episodes("dissipated", _sum)),
        Measure(
            "impacts",
            "1",
            "number of contacts",
            "contact",
            _of_episodes("peak_force", lambda values: float(values.size)),
        ),
        Measure("blows", "1", "number of blows, overlapping contacts being one", "contact", _blows),
        Measure(
            "contact_time",
            "s",
            "time in contact, each contact counted",
            "contact",
            _of_episodes("duration", _sum),
        ),
        Measure("energy_error", "J", "largest error of the energy ledger", "", _conserved("energy_error")),
        Measure("gross_work", "J", "integral of the drives' |power|", "", _conserved("gross_work")),
        Measure("base_turn", "rad", "largest turn of the base from its start", "", _base_turn, series=True),
        Measure(
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
            Measure(
                f"deviation_{which}",
                "",
                f"{words} deviation from the reference, of a joint's quantity as 'elevation angle'",
                "quantity",
                _deviation(which),
                series=True,
                compares=True,
            )
        )
    for variable in VARIABLES.values():
        if variable.source == "summary" and len(variable.dims) == 1:
            find = _of_labels(variable.name, variable.dims[0])
            found.append(Measure(variable.name, variable.units, variable.meaning, variable.dims[0], find))
    return {measure.name: measure for measure in found}


#: Every measure, by name.
MEASURES: dict[str, Measure] = _all()
