"""What an equation's displacements make of the numbers of a result, by their names there."""

from __future__ import annotations

import math

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.dynamics import System
from antenna_pin.sensitivity.along import Along
from antenna_pin.sensitivity.by_equation import ByEquation
from antenna_pin.sensitivity.by_runs import Slopes
from antenna_pin.sensitivity.in_time import InTime
from antenna_pin.sensitivity.largest import largest_of, peaks_of
from antenna_pin.sensitivity.parameters import Parameter
from antenna_pin.simulation.sources import TOTALS

__all__ = ["by_names"]

Array = NDArray[np.float64]

# Two times of one event [s].
_SAME = 1e-9
# What is told of how elements meet their joints, in the order of what ``Change`` has of it.
_OF_CHANGES = ("change_angle", "change_rate", "change_rate_after", "change_loss", "change_impulse")


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
    series, in_time = equation.series(displaced), InTime(equation, displaced)
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
    """Return by how much contacts begin and end and events happen later."""
    found = {}
    for name, what in (("onset_time", "onset"), ("release_time", "release"), ("event_time", "event")):
        if name not in here:
            continue
        late = np.zeros((len(run[name]), len(scales)))
        for i, time in enumerate(run[name].values.tolist()):
            if math.isnan(time):
                late[i] = math.nan
                continue
            own = "" if what == "event" else str(run["episode_contact"].values[i])
            near = (p for p in along.passed if p.what == what and own in ("", p.name))
            late[i] = next((p.late / scales for p in near if abs(p.time - time) < _SAME), 0.0)
        found[name] = late
    return found


def _episodes(
    along: Along, series: dict[str, tuple[Array, Array]], run: xr.Dataset, system: System, scales: Array
) -> dict[str, Array]:
    """Return what is told of each contact from its onset to its release."""
    if "onset_time" not in run:
        return {}
    times = along.displaced.chunk.times
    begin = float(times[0])
    names = ("impulse", "dissipated", "approach_speed", "effective_mass", "peak_depth")
    found = {name: np.full((len(run["onset_time"]), len(scales)), math.nan) for name in names}
    used: set[int] = set()
    for i, (onset, c) in enumerate(
        zip(run["onset_time"].values.tolist(), run["episode_contact"].values.tolist(), strict=True)
    ):
        near = (
            k
            for k, one in enumerate(along.lasting)
            if one.contact == c
            and k not in used
            and (abs(one.onset - onset) < _SAME or one.onset == -math.inf)
        )
        k = next(near, None)
        if k is None:
            continue
        used.add(k)
        one, end = along.lasting[k], float(run["release_time"].values[i])
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
    return found
