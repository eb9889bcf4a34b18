"""The impacts of a run: one row per contact episode, from first touch to release."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import RunLike, choose, data_of, floats, sample_times, variable
from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import FileFormatError
from antenna_pin.trajectory import blow_counts, blow_numbers, contact_joints, contact_kinds, names_along
from antenna_pin.trajectory.quantities import TABLES
from antenna_pin.trajectory.quantities import table as table_of


@takes()
def impacts(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the table of impacts of a run, in order of their onset.

    Approach and separation speed are the rates of depth at the very instants of first touch and release,
    which a run samples. A contact law sees no approach speed below its floor (``approach_speed_floor`` of a
    scenario); such an episode is ``floored``, and since the law was not asked what it returns at its speed,
    its restitution is NaN. Restitution delivered is the law's own only for an impact by itself: two contacts
    at once push each other (a value above 1 is possible), and a contact that a load keeps closed for long
    leaves at a speed that the load decides.

    Returns:
        Over ``impact``: ``onset`` [s], ``duration`` [s], ``approach_speed`` [m/s], ``separation_speed``
        [m/s], ``restitution`` [-], ``peak_force`` [N], ``peak_time`` [s], ``peak_depth`` [m], ``impulse``
        [N s], ``dissipated`` [J]; whether it ``ended`` (else durations, impulses and losses are those up to
        the end of the run) and was ``floored``; the number of the joint's ``blow`` that it belongs to
        (:func:`antenna_pin.analysis.impacts`); labelled by ``contact``, ``surface`` (the contact's kind) and
        ``clearance_joint``. No rows if the run has no clearance joint.
    """
    data = data_of(run)
    joints = choose("impacts", "clearance joint", joint, names_along(data, "clearance_joint"))
    if not joints:
        nothing = {name: np.zeros(0) for name in TABLES["impacts"]}
        flags = dict.fromkeys(("ended", "floored"), np.zeros(0, bool))
        return _table(nothing | flags | {"blow": np.zeros(0, np.int64)}, [], data)
    time = sample_times(data, "impacts")
    contacts = names_along(data, "contact")
    index = np.asarray(variable(data, "episode_contact", "impacts").values, dtype=int)
    of_contact = contact_joints(data)
    mine = np.array([of_contact[name] in joints for name in contacts], dtype=bool)
    rows = np.flatnonzero(mine[index])
    rows = rows[np.argsort(data["onset_time"].values[rows], kind="stable")]
    index = index[rows]
    column = {
        name: floats(variable(data, name, "impacts"))[rows]
        for name in ("onset_time", "release_time", "approach_speed", "peak_force", "peak_time", "peak_depth")
    } | {name: floats(data[name])[rows] for name in ("impulse", "dissipated")}
    onset, release = column["onset_time"], column["release_time"]
    ended = np.isfinite(release)
    approach = _rates(data, _sample_at(time, onset), index) + 0.0
    separation = np.full(onset.size, np.nan)
    separation[ended] = -_rates(data, _sample_at(time, release[ended]), index[ended])
    # The memory holds the larger of rate and floor; the two rates differ by round-off otherwise.
    floored = column["approach_speed"] > approach + 1e-9 * np.abs(column["approach_speed"])
    with np.errstate(divide="ignore", invalid="ignore"):
        restitution = np.where(floored, np.nan, separation / approach)
    values = {
        "onset": onset,
        "duration": np.where(ended, release, time[-1]) - onset,
        "approach_speed": approach,
        "separation_speed": separation,
        "restitution": restitution,
        **{name: column[name] for name in ("peak_force", "peak_time", "peak_depth", "impulse", "dissipated")},
    }
    values |= {"ended": ended, "floored": floored, "blow": blow_numbers(data)[rows]}
    return _table(values, [contacts[k] for k in index], data)


def _rates(data: xr.Dataset, samples: np.ndarray, contacts: np.ndarray) -> Array:
    """Return the depth rate of one contact at one sample each [m/s]."""
    rate = variable(data, "depth_rate", "impacts")
    own, place = np.unique(samples, return_inverse=True)
    # By numbers of samples, each once: the variable may lie in a file.
    found: Array = floats(rate.isel(time=own))[place, contacts]
    return found


def _sample_at(time: Array, moments: Array) -> np.ndarray:
    """Return the last sample at each of some times: the state after the event."""
    if not moments.size:
        return np.zeros(0, dtype=int)
    tolerance = 1e-12 * max(1.0, max(abs(float(time[0])), abs(float(time[-1]))))
    found = np.clip(np.searchsorted(time, moments + tolerance, side="right") - 1, 0, time.size - 1)
    # A first touch in the last step before an interruption may lie past the last sample by round-off only.
    if np.any(np.abs(time[found] - moments) > tolerance):
        raise FileFormatError("impacts: the run has no samples at its contact events; run the scenario again")
    return found


def _table(values: dict[str, Array], contacts: list[str], data: xr.Dataset) -> xr.Dataset:
    kinds, joints = contact_kinds(data), contact_joints(data)
    labels = {
        "contact": contacts,
        "surface": [kinds[name] for name in contacts],
        "clearance_joint": [joints[name] for name in contacts],
    }
    return table_of("impacts", values, labels, {"case": str(data.attrs.get("case", ""))})


@takes()
def impact_statistics(table: xr.Dataset) -> xr.Dataset:
    """Return statistics of the impacts of each contact.

    Returns:
        Over ``contact``, those with impacts: ``impacts``, how many; ``floored`` and ``touching``, how many of
        them met slower than the law's floor and have not ended; ``median_approach_speed``,
        ``largest_approach_speed`` [m/s], ``median_restitution`` [-], ``peak_force`` [N], ``median_duration``
        of those that ended [s], ``impulse`` [N s] and ``dissipated`` [J] in all.
    """
    labels = table["contact"].values
    contacts = list(dict.fromkeys(str(name) for name in sorted(labels)))
    rows = [table.isel(impact=np.flatnonzero(labels == name)) for name in contacts]
    columns: dict[str, list[float]] = {
        "impacts": [own.sizes["impact"] for own in rows],
        "floored": [int(own["floored"].sum()) for own in rows],
        "touching": [int((~own["ended"]).sum()) for own in rows],
    }
    for name, of, function in (
        ("median_approach_speed", "approach_speed", _median),
        ("largest_approach_speed", "approach_speed", np.max),
        ("median_restitution", "restitution", _median),
        ("median_duration", "duration", _median),
        ("peak_force", "peak_force", np.max),
        ("impulse", "impulse", np.sum),
        ("dissipated", "dissipated", np.sum),
    ):
        counted = [own if of != "duration" else own.where(own["ended"]) for own in rows]
        columns[name] = [float(function(own[of].values)) for own in counted]
    return table_of("impact statistics", columns, {"contact": contacts}, table.attrs)


def _median(values: Array) -> float:
    """Return the median of what is known; NaN of nothing."""
    known = values[np.isfinite(values)]
    return float(np.median(known)) if known.size else float("nan")


# --- blows of joints ----------------------------------------------------------------------------------------


@takes()
def blows(run: RunLike, joint: str | None = None) -> xr.Dataset:
    """Return the table of blows of a run, in order of their onset.

    A blow is what an observer of the joint counts: from where two of its surfaces (bore and journal, or a
    flange and its face) touch while they did not, to where they part, whatever contacts take part. The two
    ends of a bore that are met at once are one blow, and so is an end that knocks while the other rests; each
    contact by itself is in :func:`antenna_pin.analysis.impacts`.

    Returns:
        Over ``blow``: ``onset`` [s], ``duration`` [s], ``contacts``, how many episodes it consists of,
        ``approach_speed`` [m/s] and ``peak_force`` [N], the largest of them, ``impulse`` [N s] and
        ``dissipated`` [J] in all; whether it ``ended``; labelled by ``clearance_joint`` and ``surface``,
        the kind of contact. No rows if the run has no clearance joint.
    """
    table = impacts(run, joint)
    numbers = table["blow"].values
    order = np.unique(numbers, return_index=True)[1]
    own = [table.isel(impact=np.flatnonzero(numbers == numbers[k])) for k in order]
    ends = [part["onset"].values + part["duration"].values for part in own]
    columns: dict[str, Any] = {
        "onset": [part["onset"].values.min() for part in own],
        "duration": [end.max() - part["onset"].values.min() for end, part in zip(ends, own, strict=True)],
        "contacts": [part.sizes["impact"] for part in own],
        **{name: [part[name].values.max() for part in own] for name in ("approach_speed", "peak_force")},
        **{name: [part[name].values.sum() for part in own] for name in ("impulse", "dissipated")},
    }
    columns["ended"] = np.array([part["ended"].values.all() for part in own], dtype=bool)
    labels = {
        "clearance_joint": table["clearance_joint"].values[order],
        "surface": table["surface"].values[order],
    }
    return table_of("blows", columns, labels, table.attrs)


@takes()
def blow_statistics(run: RunLike) -> xr.Dataset:
    """Return the number of ``blows`` of each clearance joint, all surfaces together."""
    data = data_of(run)
    joints = names_along(data, "clearance_joint")
    counts = blow_counts(data) if joints else {}
    own = [sum(n for name, n in counts.items() if name.rpartition(".")[0] == joint) for joint in joints]
    return table_of("blow statistics", {"blows": np.array(own, float)}, {"clearance_joint": joints})
