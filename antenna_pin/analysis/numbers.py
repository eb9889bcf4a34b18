"""Load statistics, and rows of plain numbers for ``antenna-pin analyse``, None for missing ones."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, blocks, choose, data_of, floats, sample_times, variable
from antenna_pin.analysis.closures import (
    closure_loads,
    coupling_loads,
    couplings_of,
    drive_loads,
    drives_of,
    effort_unit,
)
from antenna_pin.analysis.deviation import deviation_measures
from antenna_pin.analysis.elastic import elastic_motion, elastic_parts_of
from antenna_pin.analysis.impacts import blow_statistics, impact_statistics, impacts
from antenna_pin.analysis.round_off import is_round_off, round_off_scales
from antenna_pin.analysis.sampled import time_mean, time_percentiles, time_rms
from antenna_pin.analysis.settling import settling, touching_intervals
from antenna_pin.analysis.signals import scales_of, signals
from antenna_pin.analysis.spectrum import dominant_frequencies
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import InvalidParameterError
from antenna_pin.trajectory import Trajectory, contacts_of, names_along
from antenna_pin.trajectory.quantities import TABLES, table


@takes()
def load_statistics(
    run: RunLike, joint: str | None = None, percent: Sequence[float] = (50.0, 90.0, 99.0, 99.9)
) -> xr.Dataset:
    """Return statistics of the load on every contact and every clearance joint.

    Peaks of contacts, impulses, losses and shares of contact are those that the run kept exactly, between
    samples too, and so is the mean normal force, impulse over time. Root mean square, percentiles and the
    force of a joint as a whole are taken of samples, weighted by time: impacts have samples at their onset,
    peak and release, so a root mean square is good to some per cent, no better.

    The force on a journal as a whole may be far below those of its contacts: a tilted journal is pressed
    against opposite sides of its bore, and these forces make a torque.

    Args:
        run: A run, or its data.
        joint: Name of a clearance joint; all of them if left out.
        percent: Percentiles of the time [%].

    Returns:
        Over ``contact``: ``peak_force``, ``mean_force``, ``mean_force_in_contact``, ``rms_force`` [N],
        ``force_percentile`` (contact, percent) [N], ``contact_share`` [-], ``episodes``, ``impulse`` [N s],
        ``dissipated`` [J]. Over ``clearance_joint`` the same of the joint, named ``joint_...``, of the size
        of the whole contact force on the journal, friction included. No rows if the run has no clearance
        joint.
    """
    data = data_of(run)
    joints = choose("load_statistics", "clearance joint", joint, names_along(data, "clearance_joint"))
    contacts = [name for own in joints for name in contacts_of(data, own)]
    time = sample_times(data, "load_statistics")
    shares = np.asarray(percent, dtype=float)
    of_contacts = [_statistics_of_contact(data, name, time, shares) for name in contacts]
    of_joints = [_joint(data, name, time, shares) for name in joints]
    found = xr.Dataset(attrs={"case": str(data.attrs.get("case", ""))})
    for name, dim, labels, rows in (
        ("loads", "contact", contacts, of_contacts),
        ("joint loads", "clearance_joint", joints, of_joints),
    ):
        columns = {
            key: np.array([row[0][k] for row in rows], dtype=int if one.form == "count" else float)
            for k, (key, one) in enumerate(TABLES[name].items())
        }
        found = found.merge(table(name, columns, {dim: labels}))
        values = np.array([row[1] for row in rows], dtype=float).reshape(len(rows), shares.size)
        about = {"units": "N", "long_name": "force that is not exceeded for a percentage of the time"}
        prefix = "joint_" if name == "joint loads" else ""
        found[f"{prefix}force_percentile"] = ((dim, "percent"), values, about)
    return found.assign_coords(percent=shares)


def _statistics_of_contact(
    data: xr.Dataset, contact: str, time: Array, percent: Array
) -> tuple[list[float], Array]:
    """Return the columns of one contact, and its percentiles."""
    span = time[-1] - time[0]
    mine = variable(data, "episode_contact", "load_statistics").values == names_along(data, "contact").index(
        contact
    )
    force = floats(variable(data, "normal_force", "load_statistics").sel(contact=contact))
    impulse = _gained(data, "normal_impulse", [contact])
    touched = _length(touching_intervals(data, [contact]))
    peaks = floats(data["peak_force"])[mine]
    return [
        float(max(peaks.max(initial=-np.inf), force.max())),
        impulse / span if span > 0.0 else float(force[0]),
        impulse / touched if touched > 0.0 else float("nan"),
        float(time_rms(time, force)),
        touched / span if span > 0.0 else float(data["touching"].sel(contact=contact)[0]),
        float(np.count_nonzero(mine)),
        impulse,
        _gained(data, "dissipation_normal", [contact]) + _gained(data, "dissipation_friction", [contact]),
    ], time_percentiles(time, force, percent)


def _joint(data: xr.Dataset, joint: str, time: Array, percent: Array) -> tuple[list[float], Array]:
    """Return the columns of one joint, and its percentiles."""
    span = time[-1] - time[0]
    contacts = contacts_of(data, joint)
    variable(data, "joint_force", "load_statistics")
    vectors = (part["joint_force"].sel(clearance_joint=joint).values for part in blocks(data))
    force = np.concatenate([np.linalg.norm(np.asarray(vector, dtype=float), axis=1) for vector in vectors])
    index = [names_along(data, "contact").index(name) for name in contacts]
    touching = data["touching"].sel(contact=contacts)[0].values.any()
    return [
        float(force.max()),
        float(time_mean(time, force)),
        float(time_rms(time, force)),
        _length(touching_intervals(data, contacts)) / span if span > 0.0 else float(touching),
        float(np.count_nonzero(np.isin(data["episode_contact"].values, index))),
        _gained(data, "normal_impulse", contacts),
        _gained(data, "dissipation_normal", contacts) + _gained(data, "dissipation_friction", contacts),
    ], time_percentiles(time, force, percent)


def _gained(data: xr.Dataset, name: str, contacts: list[str]) -> float:
    """Return the growth of integrals of contacts since the first sample."""
    values = variable(data, name, "load_statistics").sel(contact=contacts)
    first, last = (floats(values[k]) for k in (0, -1))
    return float((last - first).sum())


def _length(intervals: Array) -> float:
    return float((intervals[:, 1] - intervals[:, 0]).sum())


_PEAKS = 3  # of a spectrum
# Fields of a settling, in the order of a row.
_SETTLING = (
    *("joint", "time", "note", "longest_gap", "share_before", "share_after", "decay_rate", "decay_r2"),
    *("decays", "driven"),
)


@takes(longest_gap="s")
def numbers_of(
    run: Trajectory, ideal: Trajectory | None = None, *, longest_gap: float | str = 1e-3
) -> dict[str, Any]:
    """Return deviation, impacts, loads, settling, loops and dominant frequencies of a run.

    Contact counts as lasting up to a ``longest_gap`` apart [s].

    Returns:
        Lists of rows by what they are of, as ``antenna-pin analyse --json`` prints them; ``notes`` tell what
        is not there, and why.

    Raises:
        FileFormatError: The result is a lean one, without series.
    """
    samples = len(sample_times(run.data, "analyse"))
    found: dict[str, Any] = {"case": run.data.attrs.get("case", ""), "outcome": run.outcome.name}
    notes = [] if run.completed else [f"the run {run.outcome.verdict}: {run.message}"]
    if samples < 2:
        notes.append("one sample: no deviation, no frequencies")
    if ideal is not None and samples > 1:
        found["deviation"] = _deviation(run, ideal, notes)
    if run.data.sizes.get("clearance_joint", 0):
        found |= _contact(run, float(longest_gap))
    else:
        notes.append("no joint with clearance: no impacts, loads and settling")
    if run.constraints:
        found |= _loops(run)
    if "elastic_part" in run.data.sizes:
        found["elastic"] = _elastic(run)
    found["frequencies"] = _frequencies(run, notes)
    return {**found, "notes": notes}


def _deviation(run: Trajectory, ideal: Trajectory, notes: list[str]) -> list[dict[str, Any]]:
    ends = [float(one.data["time"].values[-1]) for one in (run, ideal)]
    if ends[0] > ends[1]:
        notes.append(f"compared with the ideal run up to its end at {ends[1]:g} s")
    scales = round_off_scales(run.data, ideal.data)
    return [
        {
            "of": one.of,
            "units": one.units,
            "maximum": _plain(one.maximum),
            "time_of_maximum": one.time_of_maximum,
            "rms": _plain(one.rms),
            "end": _plain(one.end),
            "growth": str(one.growth),
            "round_off": is_round_off(one.maximum, one.units, scales),
        }
        for one in deviation_measures(run, ideal)
    ]


def _contact(run: Trajectory, longest_gap: float) -> dict[str, Any]:
    loads = load_statistics(run)
    joints = loads.drop_dims("contact").rename(
        {str(name): str(name).removeprefix("joint_") for name in loads if str(name).startswith("joint_")}
    )
    return {
        "impacts": _records(impact_statistics(impacts(run)), "contact"),
        "blows": _records(blow_statistics(run), "clearance_joint"),
        "loads": _records(joints, "clearance_joint")
        + _records(loads.drop_dims("clearance_joint"), "contact"),
        "settling": [
            {name: _plain(getattr(one, name)) for name in _SETTLING}
            for one in settling(run, longest_gap=longest_gap)
        ],
    }


def _elastic(run: Trajectory) -> list[dict[str, Any]]:
    about = elastic_parts_of(run)
    return [
        {**one, "units": "m" if about[one["of"]]["slides"] else "rad"}
        for one in _records(elastic_motion(run), "elastic_part")
    ]


def _frequencies(run: Trajectory, notes: list[str]) -> list[dict[str, Any]]:
    result: list[dict[str, Any]] = []
    found = signals(run)
    scales = scales_of(found.values())
    for name, one in found.items():
        try:
            peaks = dominant_frequencies(one.time, one.read, _PEAKS, scale=scales[one.units])
        except InvalidParameterError as error:
            notes.append(f"no frequencies: {error}")
            break
        result.append(
            {
                "of": name,
                "units": one.units,
                "resolution": float(peaks.attrs["resolution"]),
                "round_off": bool(peaks.attrs["round_off"]),
                "frequency": [float(x) for x in peaks["frequency"].values],
                "amplitude": [float(x) for x in peaks["amplitude"].values],
            }
        )
    return result


def _loops(run: Trajectory) -> dict[str, Any]:
    """Return residuals and loads of closures, couplings, motions and drives."""
    about, couplings = drives_of(run), couplings_of(run)
    return {
        "constraints": run.constraints,
        "closures": _records(closure_loads(run), "closure"),
        "couplings": [
            {**one, "units": "N" if couplings[one["of"]]["slides"] else "N m"}
            for one in _records(coupling_loads(run), "coupling")
        ],
        "drives": [
            {**one, "units": effort_unit(run, one["of"]), "motion": about[one["of"]]["motion"]}
            for one in _records(drive_loads(run), "drive")
        ],
    }


def _records(table: xr.Dataset, dim: str) -> list[dict[str, Any]]:
    """Return the rows of a table in plain numbers, None for NaN."""
    return [
        {"of": str(name)}
        | {
            str(column): _plain(table[column].values[k])
            if table[column].ndim == 1
            else {
                f"{p:g}": _plain(x)
                for p, x in zip(table["percent"].values, table[column].values[k], strict=True)
            }
            for column in table.data_vars
        }
        for k, name in enumerate(table[dim].values)
    ]


def _plain(value: Any) -> Any:
    """Return a value of Python's own types; None for NaN."""
    value = value.item() if hasattr(value, "item") else value
    return None if isinstance(value, float) and math.isnan(value) else value
