"""Statistics of the forces of contacts and joints over time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, blocks, choose, data_of, floats, sample_times, variable
from antenna_pin.analysis.sampled import time_mean, time_percentiles, time_rms
from antenna_pin.analysis.settling import touching_intervals
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.trajectory import contacts_of, names_along
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
    of_contacts = [_contact(data, name, time, shares) for name in contacts]
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


def _contact(data: xr.Dataset, contact: str, time: Array, percent: Array) -> tuple[list[float], Array]:
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
