"""The signals of a run whose spectra tell something: accelerations and joint forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from antenna_pin.analysis._run import Array, RunLike, data_of, sample_times
from antenna_pin.analysis.base import base_motion
from antenna_pin.analysis.elastic import elastic_parts_of
from antenna_pin.trajectory import names_along

__all__ = ["RunSignal", "scales_of", "signals"]

_AXES = ("x", "y", "z")


class RunSignal(NamedTuple):
    """A sampled quantity of a run."""

    time: Array  # (n,) [s], uneven
    values: Array  # (n,)
    units: str


def scales_of(signals: Iterable[RunSignal]) -> dict[str, float]:
    """Return the largest size of the signals of each unit: what round-off in any of them is judged by."""
    found: dict[str, float] = {}
    for one in signals:
        sizes = np.abs(one.values[np.isfinite(one.values)])
        found[one.units] = max(found.get(one.units, 0.0), float(sizes.max(initial=0.0)))
    return found


def signals(run: RunLike) -> dict[str, RunSignal]:
    """Return accelerations of a run's joints and base, deflections, and forces in clearance joints, by name.

    Args:
        run: A run, or its data.

    Returns:
        "JOINT acceleration" about the joint's axis, "PART deflection" of elastic parts, "base acceleration x"
        and "base angular acceleration x" (y, z) in world axes if the base is free, and "JOINT force x" (y, z)
        on the journal in bearing axes. A signal that is zero throughout is left out.
    """
    data = data_of(run)
    time = sample_times(data, "signals")
    found: dict[str, RunSignal] = {}
    for name in names_along(data, "joint"):
        values = np.asarray(data["motion_acceleration"].sel(joint=name).values, dtype=float)
        found[f"{name} acceleration"] = RunSignal(time, values, "rad/s^2")
    for name, part in elastic_parts_of(data).items():
        values = np.asarray(data["deflection"].sel(elastic_part=name).values, dtype=float)
        found[f"{name} deflection"] = RunSignal(time, values, "m" if part["slides"] else "rad")
    vectors = []
    if "base_position" in data:
        motion = base_motion(data)
        vectors += [
            ("base acceleration", motion["acceleration"].values, "m/s^2"),
            ("base angular acceleration", motion["angular_acceleration"].values, "rad/s^2"),
        ]
    for name in names_along(data, "clearance_joint"):
        vectors.append((f"{name} force", data["joint_force"].sel(clearance_joint=name).values, "N"))
    for name, values, units in vectors:
        for k, axis in enumerate(_AXES):
            found[f"{name} {axis}"] = RunSignal(time, np.asarray(values[:, k], dtype=float), units)
    return {name: one for name, one in found.items() if np.any(one.values)}
