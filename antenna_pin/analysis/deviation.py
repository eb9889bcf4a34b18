"""How far a run is from the ideal one: of each joint's motion and of the base."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
import xarray as xr

from antenna_pin.analysis._motion import motion_deviation
from antenna_pin.analysis._run import Array, RunLike, choose, data_of, label_of, sample_times, variable
from antenna_pin.analysis.base import base_motion
from antenna_pin.analysis.growth import Growth, growth_of
from antenna_pin.analysis.sampled import resampled, time_rms
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import names_along

_Variable: TypeAlias = "tuple[tuple[str, ...], Array, dict[str, str]]"

__all__ = ["Deviation", "DeviationMeasures", "deviation"]

# By dimension: quantity, what it is called, its variable, that of its derivative.
_JOINTS: dict[str, tuple[tuple[str, str, str, str | None], ...]] = {
    "joint": (
        ("angle", "angle", "motion_angle", "motion_rate"),
        ("rate", "rate", "motion_rate", "motion_acceleration"),
        ("acceleration", "acceleration", "motion_acceleration", None),
    ),
    "sliding_joint": (
        ("slide_position", "position", "slide_position", "slide_rate"),
        ("slide_rate", "rate", "slide_rate", "slide_acceleration"),
        ("slide_acceleration", "acceleration", "slide_acceleration", None),
    ),
}


@dataclass(frozen=True, slots=True, kw_only=True)
class DeviationMeasures:
    """What a deviation comes to; of a vector, its length counts.

    Attributes:
        of: Joint and quantity, "elevation angle", or "base position".
        units: Of all but times and growth.
        maximum: Largest size.
        time_of_maximum: [s].
        rms: Root mean square over time.
        end: Value at the last sample, with its sign if it is a joint's.
        growth: How its envelope grows.
    """

    of: str
    units: str
    maximum: float
    time_of_maximum: float
    rms: float
    end: float
    growth: Growth


@dataclass(frozen=True, slots=True, eq=False)
class Deviation:
    """A run less the ideal one.

    Attributes:
        data: ``angle`` [rad], ``rate`` [rad/s], ``acceleration`` [rad/s^2] over time and joint;
            ``slide_position`` [m], ``slide_rate`` [m/s], ``slide_acceleration`` [m/s^2] over time and sliding
            joint; of a free base, over time and axis in world axes, ``base_position`` [m], ``base_attitude``
            (rotation vector from the ideal to the run's attitude) [rad], ``base_velocity`` [m/s],
            ``base_angular_velocity`` [rad/s], ``base_acceleration`` [m/s^2], ``base_angular_acceleration``
            [rad/s^2]. At the run's samples within the time that both runs cover.
        measures: One per joint and quantity, then per quantity of the base.
    """

    data: xr.Dataset
    measures: tuple[DeviationMeasures, ...]

    def __getitem__(self, of: str) -> DeviationMeasures:
        """Return the measures of "elevation angle" or "base position"."""
        known = [measures.of for measures in self.measures]
        return self.measures[known.index(choose("deviation", "quantity", of, known)[0])]


def deviation(run: RunLike, ideal: RunLike, joint: str | None = None) -> Deviation:
    """Return how far a run is from the ideal one, at the run's own samples.

    The ideal run is smooth and is interpolated: a cubic Hermite spline where the derivative is recorded
    (angle by rate, rate by acceleration, position by velocity), else a cubic spline. At 1 kHz its error is
    below 1e-12 of the amplitude for motion of a few hertz. The run itself is not interpolated. Runs of
    different lengths are compared while both last.

    Args:
        run: The run to judge; usually one with clearance.
        ideal: A run of the same mechanism without any contact.
        joint: Name of a joint; all joints that both runs have if left out.

    Raises:
        InvalidParameterError: If the ideal run has contacts, or the runs share less than two samples' time.
    """
    data, reference = data_of(run), data_of(ideal)
    if reference.sizes.get("contact", 0):
        touching = ", ".join(names_along(reference, "clearance_joint"))
        raise InvalidParameterError(
            "deviation",
            "ideal",
            "a run without contacts (a case whose joints are all ideal)",
            f"{label_of(reference)} with play in {touching}",
        )
    time, own = sample_times(data, "deviation"), sample_times(reference, "deviation")
    if own.size < 2:
        raise InvalidParameterError(
            "deviation", "ideal", "a run of two samples or more", f"{label_of(reference)} with {own.size}"
        )
    common = (time >= own[0]) & (time <= own[-1])
    if np.count_nonzero(common) < 2:
        span = f"{label_of(data)} with {np.count_nonzero(common)} samples from {own[0]:g} to {own[-1]:g} s"
        raise InvalidParameterError("deviation", "run", "of two samples or more while the ideal lasts", span)
    at = time[common]
    shared = {
        dim: [name for name in names_along(data, dim) if name in names_along(reference, dim)]
        for dim in _JOINTS
    }
    every = [name for names in shared.values() for name in names]
    chosen = choose("deviation", "joint", joint, every)
    based = "base_position" in data and "base_position" in reference
    if not chosen and not based:
        raise InvalidParameterError(
            "deviation",
            "ideal",
            "a run of the same mechanism",
            f"{label_of(reference)} with joints {', '.join(names_along(reference, 'joint')) or 'none'}",
        )
    variables: dict[str, _Variable] = {}
    measures: list[DeviationMeasures] = []
    joints = {dim: [name for name in names if name in chosen] for dim, names in shared.items()}
    for dim, names in joints.items():
        for quantity, words, name, derivative in _JOINTS[dim] if names else ():
            wanted = variable(data, name, "deviation")
            values = np.asarray(wanted.sel({dim: names}).values, dtype=float)[common]
            base_line = variable(reference, name, "deviation").sel({dim: names}).values
            slope = None
            if derivative in reference:
                slope = np.asarray(reference[derivative].sel({dim: names}).values, dtype=float)
            variables[quantity] = (
                ("time", dim),
                values - resampled(own, np.asarray(base_line, dtype=float), at, slope),
                _attributes(wanted, f"deviation of the {words}"),
            )
        for k, name in enumerate(names):
            for quantity, words, *_ in _JOINTS[dim]:
                _, values, attributes = variables[quantity]
                measures.append(_measures(f"{name} {words}", attributes["units"], at, values[:, k]))
    if based:
        apart = motion_deviation(base_motion(data.isel(time=common)), base_motion(reference), "base")
        for name, part in apart.items():
            variables[f"base_{name}"] = (("time", "axis"), part.values, part.attrs)
            words = f"base {name.replace('_', ' ')}"
            measures.append(_measures(words, part.attrs["units"], at, np.linalg.norm(part.values, axis=1)))
    coords: dict[str, Any] = {"time": ("time", at, {"units": "s", "long_name": "time"})}
    coords["joint"] = joints["joint"]
    if joints["sliding_joint"]:
        coords["sliding_joint"] = joints["sliding_joint"]
    if based:
        coords["axis"] = data.coords["axis"].values
    described = {"case": str(data.attrs.get("case", "")), "ideal": str(reference.attrs.get("case", ""))}
    return Deviation(xr.Dataset(variables, coords=coords, attrs=described), tuple(measures))


def _attributes(like: xr.DataArray, long_name: str) -> dict[str, str]:
    return {"units": str(like.attrs.get("units", "")), "long_name": long_name}


def _measures(of: str, units: str, time: Array, values: Array) -> DeviationMeasures:
    size = np.abs(values)
    largest = int(np.argmax(np.nan_to_num(size)))
    return DeviationMeasures(
        of=of,
        units=units,
        maximum=float(size[largest]),
        time_of_maximum=float(time[largest]),
        rms=float(time_rms(time, values)),
        end=float(values[-1]),
        growth=growth_of(time, values),
    )
