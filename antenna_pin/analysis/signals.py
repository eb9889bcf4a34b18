"""Signals of a run for spectra: accelerations, deflections and joint forces."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import AXES, RunLike, blocks, data_of, floats, sample_times
from antenna_pin.analysis.body_motion import base_motion
from antenna_pin.analysis.elastic import elastic_parts_of
from antenna_pin.analysis.even import Read
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.trajectory import names_along

_BASE = {f"base {kind}acceleration {axis}" for kind in ("", "angular ") for axis in AXES}


@dataclass(frozen=True, slots=True, eq=False)
class RunSignal:
    """A sampled quantity of a run."""

    time: Array  # of the samples, uneven, (n,) [s]
    units: str  # of the values
    read: Read  # returns the samples from one number up to another, (m,)
    largest: float  # largest size of those that are finite

    @property
    def values(self) -> Array:
        """All samples, (n,)."""
        return self.read(0, self.time.size)


@takes()
def scales_of(signals: Iterable[RunSignal]) -> dict[str, float]:
    """Return the largest size of signals in each unit, as scale of round-off."""
    found: dict[str, float] = {}
    for one in signals:
        found[one.units] = max(found.get(one.units, 0.0), one.largest)
    return found


@takes()
def signals(run: RunLike) -> dict[str, RunSignal]:
    """Return accelerations, deflections and forces in clearance joints, by name.

    Returns:
        "JOINT acceleration" about the joint's axis, "PART deflection" of elastic parts, "base acceleration x"
        and "base angular acceleration x" (y, z) in world axes if the base is free, and "JOINT force x" (y, z)
        on the journal in bearing axes. A signal that is zero throughout is left out.
    """
    data = data_of(run)
    time = sample_times(data, "signals")
    units, shown = _units(data), dict.fromkeys(_units(data), False)
    largest = dict.fromkeys(units, 0.0)
    held: dict[str, Array] = {}
    for part in blocks(data):
        columns = _columns(part)
        held = columns if part is data else {}
        for name, values in columns.items():
            shown[name] = shown[name] or bool(np.any(values))
            sizes = np.abs(values[np.isfinite(values)])
            largest[name] = max(largest[name], float(sizes.max(initial=0.0)))
    return {
        name: RunSignal(time, units[name], _reader(data, name, held), largest[name])
        for name in units
        if shown[name]
    }


def _reader(data: xr.Dataset, name: str, columns: dict[str, Array]) -> Read:
    if name in columns:
        return lambda begin, end: columns[name][begin:end]
    return lambda begin, end: _columns(data.isel(time=slice(begin, end)), name)[name]


def _units(data: xr.Dataset) -> dict[str, str]:
    """Return the units of all signals that a run has, by their names."""
    found = {f"{name} acceleration": "rad/s^2" for name in names_along(data, "joint")}
    parts = elastic_parts_of(data).items()
    found |= {f"{name} deflection": "m" if part["slides"] else "rad" for name, part in parts}
    if "base_position" in data:
        for name, unit in (("acceleration", "m/s^2"), ("angular acceleration", "rad/s^2")):
            found |= {f"base {name} {axis}": unit for axis in AXES}
    for name in names_along(data, "clearance_joint"):
        found |= {f"{name} force {axis}": "N" for axis in AXES}
    return found


def _columns(data: xr.Dataset, only: str = "") -> dict[str, Array]:
    """Return all signals of a part of a run, (m,) each, or one of them."""
    found: dict[str, Array] = {}
    for name in names_along(data, "joint"):
        if only in ("", key := f"{name} acceleration"):
            found[key] = floats(data["motion_acceleration"].sel(joint=name))
    for name in elastic_parts_of(data):
        if only in ("", key := f"{name} deflection"):
            found[key] = floats(data["deflection"].sel(elastic_part=name))
    if "base_position" in data and (not only or only in _BASE):
        motion = base_motion(data)
        for kind in ("acceleration", "angular_acceleration"):
            values = floats(motion[kind])
            found |= {f"base {kind.replace('_', ' ')} {axis}": values[:, k] for k, axis in enumerate(AXES)}
    for name in names_along(data, "clearance_joint"):
        for k, axis in enumerate(AXES):
            if only in ("", key := f"{name} force {axis}"):
                force = data["joint_force"].sel(clearance_joint=name)
                found[key] = floats(force[:, k])
    return found
