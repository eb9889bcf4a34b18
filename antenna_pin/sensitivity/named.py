"""What an equation's displacements make of the numbers of a result, by their names there."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.dynamics import System
from antenna_pin.sensitivity.along import Along, Lasting
from antenna_pin.sensitivity.by_equation import ByEquation
from antenna_pin.sensitivity.by_runs import Slopes
from antenna_pin.sensitivity.in_time import InTime
from antenna_pin.sensitivity.largest import largest_of, peaks_of
from antenna_pin.sensitivity.parameters import Parameter
from antenna_pin.simulation.variables import TOTALS

__all__ = ["by_names"]

Array = NDArray[np.float64]

# Two times of one event [s].
_SAME = 1e-9
# What is told of how elements meet their joints, in the order of what ``Change`` has of it.
_OF_CHANGES = (
    "change_angle",
    "change_rate",
    "change_rate_after",
    "change_loss",
    "change_impulse",
    "change_energy",
)


def by_names(
    equation: ByEquation,
    along: Along,
    here: xr.Dataset,
    run: xr.Dataset,
    parameters: tuple[Parameter, ...],
) -> list[Slopes]:
    """Return derivatives over each parameter; NaN where a number has none that is known.

    Args:
        equation: Along whose run displacements were carried.
        along: That run, as it was looked at.
        here: What the result has at the times that are asked for.
        run: The result.
        parameters: The parameters.
    """
    displaced, system = along.displaced, equation.flow.system
    series, in_time = equation.told.series(displaced), InTime(equation.told, displaced)
    times, scales = displaced.chunk.times, np.array([one.scale for one in parameters])
    most = displaced.doubts.max(axis=0, initial=0.0) if len(displaced.doubts) else np.zeros(len(parameters))
    found: dict[str, tuple[Array, Array]] = {}
    at = np.searchsorted(times, here["time"].values) if "time" in here.sizes else None
    for name, (value, doubt) in series.items():
        if name in here and at is not None:
            found[name] = value[at], doubt[at]
    for name, of in TOTALS.items():
        if name in here and of in series:
            found[name] = series[of][0][-1], series[of][1][-1]
    instants = _instants(along, here, run, scales)
    instants |= _episodes(along, series, run, system, scales)
    instants |= _changes(along, run, scales)
    for name, value in instants.items():
        if name in here:
            found[name] = value, np.abs(value) * most
    peaks = peaks_of(along, series, in_time, run, scales)
    if "peak_time" in here:
        found["peak_time"] = peaks.late, peaks.late_doubt
        found["peak_force"] = peaks.force, peaks.force_doubt
    if at is not None:
        found |= largest_of(along, series, in_time, run, peaks, (here["time"].values, scales))
    return [
        Slopes(
            {name: v[..., k] for name, (v, _) in found.items()}, {n: d[..., k] for n, (_, d) in found.items()}
        )
        for k in range(len(parameters))
    ]


def _instants(along: Along, here: xr.Dataset, run: xr.Dataset, scales: Array) -> dict[str, Array]:
    """Return by how much contacts begin and end and events happen later, and what these bring in."""
    found = {}
    matched = matched_contacts(along, run)
    for at, name in enumerate(("onset_time", "release_time")):
        if name in here:
            found[name] = np.full((len(run[name]), len(scales)), math.nan)
            for i, one in enumerate(matched):
                if one is not None and not math.isnan(float(run[name].values[i])):
                    found[name][i] = one.late[at] / scales
    if "event_time" in here:
        found |= _events(along, run, scales)
    return found


def _events(along: Along, run: xr.Dataset, scales: Array) -> dict[str, Array]:
    """Return when events happen and what they bring in; changes of mode at one instant are one event."""
    count = len(run["event_time"])
    times, energies = np.full((2, count, len(scales)), math.nan)
    used: set[int] = set()
    for i, (name, time) in enumerate(
        zip(run["event"].values, run["event_time"].values.tolist(), strict=True)
    ):
        near = [k for k, one in enumerate(along.happened) if abs(one.time - time) < _SAME]
        same = [k for k in near if along.happened[k].name == name and k not in used]
        if not (same or near):
            continue
        k = (same or [k for k in near if k not in used] or near)[0]
        times[i] = along.happened[k].late / scales
        # Of several changes by one passage the first has all that it brings in.
        energies[i] = 0.0 if k in used else along.happened[k].energy / scales
        used.add(k)
    return {"event_time": times, "event_energy": energies}


def matched_contacts(along: Along, run: xr.Dataset) -> list[Lasting | None]:
    """Return of each contact of a result how it is displaced: those of one place follow in one order."""
    contacts = run["episode_contact"].values.tolist() if "episode_contact" in run else []
    own = {c: [one for one in along.lasting if one.contact == c] for c in set(contacts)}
    alike = {c: len(own[c]) == contacts.count(c) for c in own}
    return [own[c].pop(0) if alike[c] else None for c in contacts]


def _episodes(
    along: Along, series: dict[str, tuple[Array, Array]], run: xr.Dataset, system: System, scales: Array
) -> dict[str, Array]:
    """Return what is told of each contact from its onset to its release."""
    if "onset_time" not in run:
        return {}
    times = along.displaced.chunk.times
    begin = float(times[0])
    matched = matched_contacts(along, run)
    names = ("impulse", "dissipated", "approach_speed", "effective_mass", "peak_depth")
    found = {name: np.full((len(run["onset_time"]), len(scales)), math.nan) for name in names}
    for i, (onset, c, one) in enumerate(
        zip(run["onset_time"].values.tolist(), run["episode_contact"].values.tolist(), matched, strict=True)
    ):
        if one is None:
            continue
        end = float(run["release_time"].values[i])
        until = math.inf if math.isnan(end) else end
        books = (along.books if one.books[1] is None else one.books[1]) - one.books[0]
        found["impulse"][i] = books[system.impulse_x[c]] / scales
        found["dissipated"][i] = (books[system.lost_normal_x[c]] + books[system.lost_friction_x[c]]) / scales
        for name, logarithm in zip(("approach_speed", "effective_mass"), one.remembered, strict=True):
            found[name][i] = float(run[name].values[i]) * logarithm / scales
        deepest = [
            time for contact, time in along.deepest if contact == c and max(onset, begin) < time < until
        ]
        if deepest:
            places = [int(np.argmin(np.abs(times - time))) for time in deepest]
            depths = along.depths[places, c]
            found["peak_depth"][i] = series["depth"][0][places[int(np.argmax(depths))], c]
    return found


def _changes(along: Along, run: xr.Dataset, scales: Array) -> dict[str, Array]:
    """Return what is told of how elements have met their joints."""
    if "change_time" not in run:
        return {}
    count = len(run["change_time"])
    found = {name: np.full((count, len(scales)), math.nan) for name in ("change_time", *_OF_CHANGES)}
    used: set[int] = set()
    for i in range(count):
        time = float(run["change_time"].values[i])
        angle = float(run["change_angle"].values[i])
        for k, one in enumerate(along.changes):
            if (
                k in used
                or abs(one.time - time) > _SAME
                or abs(one.angle - angle) > 1e-9 * (1.0 + abs(angle))
            ):
                continue
            used.add(k)
            found["change_time"][i] = one.late / scales
            for name, slope in zip(_OF_CHANGES, one.slopes, strict=True):
                found[name][i] = slope / scales
            break
    lacks = np.isnan(run["change_energy"].values)
    found["change_energy"][lacks] = math.nan  # of elements that do not weigh their joint
    return found
