"""Loads of closures, couplings and drives."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, data_of, entries_in, floats, sample_times
from antenna_pin.analysis.sampled import time_rms
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.trajectory import names_along
from antenna_pin.trajectory.quantities import TABLES, slides_along, table


@takes()
def closures_of(run: RunLike) -> dict[str, dict[str, Any]]:
    """Return the closures of a run by name: kind, links and placements."""
    return entries_in(run, "closures")


@takes()
def couplings_of(run: RunLike) -> dict[str, dict[str, Any]]:
    """Return the couplings of a run by name: joints, multiplier and offset."""
    return entries_in(run, "couplings")


@takes()
def drives_of(run: RunLike) -> dict[str, dict[str, Any]]:
    """Return the drives of a run by name: ``joint``, ``slides`` and ``motion`` (prescribed).

    Results of versions without closed loops contain none.
    """
    return entries_in(run, "drives")


@takes()
def effort_unit(run: RunLike, drive: str) -> str:
    """Return the unit of a drive's effort: N at a sliding joint, else N m."""
    return "N" if slides_along(data_of(run), "drive").get(drive) else "N m"


@takes()
def closure_loads(run: RunLike) -> xr.Dataset:
    """Return sizes of each closure's force and of its moment about its point.

    Returns:
        Over ``closure``: ``peak_force`` [N], ``time_of_peak_force`` [s], ``rms_force`` [N], ``peak_moment``,
        ``rms_moment`` [N m]; no rows for a run without closures. Where loops have redundant equations, the
        loads are the least that do.
    """
    data = data_of(run)
    time = sample_times(data, "closure_loads")
    rows = []
    for name in names_along(data, "closure"):
        force, moment = (
            np.linalg.norm(floats(data[f"closure_{what}"].sel(closure=name)), axis=1)
            for what in ("force", "moment")
        )
        (peak, at, rms), (largest, _, rms_moment) = (_peak(time, size) for size in (force, moment))
        rows.append([peak, at, rms, largest, rms_moment])
    return _table("closure loads", names_along(data, "closure"), rows)


@takes()
def coupling_loads(run: RunLike) -> xr.Dataset:
    """Return the torque of each coupling on its follower.

    That on its leader is the same times minus the multiplier.

    Returns:
        Over ``coupling``: ``peak_torque`` [N m] ([N] if the follower slides), ``time_of_peak_torque`` [s],
        ``rms_torque``; no rows for a run without couplings.
    """
    data = data_of(run)
    time = sample_times(data, "coupling_loads")
    rows: list[list[float]] = []
    for name in names_along(data, "coupling"):
        torque = floats(data["coupling_torque"].sel(coupling=name))
        rows.append(_peak(time, torque))
    return _table("coupling loads", names_along(data, "coupling"), rows)


@takes()
def drive_loads(run: RunLike) -> xr.Dataset:
    """Return effort, power and work of each drive or prescribed motion.

    Returns:
        Over ``drive``: ``peak_effort`` [N m] ([N] if it slides), ``time_of_peak_effort`` [s],
        ``rms_effort``, ``peak_power`` [W], ``work`` and ``gross_work`` [J]; no rows for a run without drives.
    """
    data = data_of(run)
    time = sample_times(data, "drive_loads")
    measure, dimension = (
        ("peak_drive_effort", "drive") if "peak_drive_effort" in data else ("peak_effort", "motion")
    )
    located = names_along(data, dimension) if f"time_of_{measure}" in data else ()
    rows = []
    for name in names_along(data, "drive"):
        effort = floats(data["drive_torque"].sel(drive=name))
        totals = [float(data[f"total_{what}"].sel(drive=name)) for what in ("work", "gross_work")]
        power = drive_power(data, name)
        most = float("nan") if power is None else float(np.abs(power).max())
        peak, at, rms = _peak(time, effort)
        if name in located:
            peak, at = (float(data[what].sel({dimension: name})) for what in (measure, f"time_of_{measure}"))
        rows.append([peak, at, rms, most, *totals])
    return _table("drive loads", names_along(data, "drive"), rows)


@takes()
def drive_power(run: RunLike, drive: str) -> Array | None:
    """Return the power of a drive at the samples [W]; None without its joint."""
    data = data_of(run)
    about = drives_of(run).get(drive)
    if about is None:
        return None
    dimension, rate = ("sliding_joint", "slide_rate") if about["slides"] else ("joint", "motion_rate")
    if about["joint"] not in names_along(data, dimension):
        return None
    effort = floats(data["drive_torque"].sel(drive=drive))
    return np.asarray(effort * data[rate].sel({dimension: about["joint"]}).values)


def _peak(time: Array, values: Array) -> list[float]:
    """Return the largest size of a series, its time [s], and the root mean square."""
    at = int(np.argmax(np.abs(values)))
    return [abs(float(values[at])), float(time[at]), float(time_rms(time, values))]


def _table(name: str, labels: list[str], rows: list[list[float]]) -> xr.Dataset:
    (dim,) = next(iter(TABLES[name].values())).dims
    values = np.array(rows, dtype=float).reshape(len(labels), len(TABLES[name]))
    return table(name, dict(zip(TABLES[name], values.T, strict=True)), {dim: labels})
