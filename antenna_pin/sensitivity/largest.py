"""Largest forces of contacts and largest sizes of series, by the equation: by how much, and how much later.

A force is largest where its rate F' is zero. In a neighbour, whose rate there is other by dF', that is later
by ``-dF' / F''``; the largest force itself changes by what it changes at equal times. One that is largest
where something happens, such as where another contact begins, goes with that instant.

What is said with its largest size at a sample is that of a sample of the run's own: of an output time, which
stays, or of an instant at which a contact's force is largest, with which it goes. An effort that is largest
between samples changes by what it changes at that time: its rate there is zero.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.sensitivity.along import Along
from antenna_pin.sensitivity.in_time import InTime
from antenna_pin.simulation.variables import SIZES

__all__ = ["Peaks", "largest_of", "moments_of", "peaks_of"]

Array = NDArray[np.float64]
Series = dict[str, tuple[Array, Array]]

# Two times of one event [s]; two that are one but for round-off, over the later.
_SAME, _ONE = 1e-9, 1e-14
# How far off a force's largest value may be found, over the time that it takes to bend: there it is smooth.
_FOUND = 1e-3


class Peaks(NamedTuple):
    """Of each contact of a result when its force is largest and how large, (episodes, parameters) each.

    Attributes:
        late: By how much later per scale [s].
        late_doubt: By how much that is in doubt.
        force: By how much larger at that instant [N].
        force_doubt: Likewise.
    """

    late: Array
    late_doubt: Array
    force: Array
    force_doubt: Array


def moments_of(run: xr.Dataset) -> Array:
    """Return when forces of contacts, and sizes that are said, are largest in a result (n,) [s]."""
    found = [run["peak_time"].values] if "peak_time" in run else []
    found += [_times(run, name).reshape(-1) for name in _said(run)]
    every = np.concatenate(found) if found else np.zeros(0)
    return np.unique(every[np.isfinite(every)])


def peaks_of(along: Along, series: Series, in_time: InTime, run: xr.Dataset, scales: Array) -> Peaks:
    """Return what is told of the largest forces of contacts; NaN where one has no derivative that is known.

    Args:
        along: The run that was looked at, at :func:`moments_of` too.
        series: Derivatives at its samples and their doubts, by name, (n, ..., parameters).
        in_time: How its samples go on.
        run: The result.
        scales: Of the parameters, (parameters,).
    """
    displaced, times = along.displaced, along.displaced.chunk.times
    begin, end = float(times[0]), float(times[-1])
    count = len(run["peak_time"]) if "peak_time" in run else 0
    late, rest, force, off = np.full((4, count, len(scales)), math.nan)
    smooth: list[tuple[int, int, int, float]] = []
    for i in range(count):
        onset, release, when = (
            float(run[name].values[i]) for name in ("onset_time", "release_time", "peak_time")
        )
        if not when >= begin or float(run["peak_force"].values[i]) == 0.0:
            continue
        if abs(when - onset) < _SAME:  # what the force jumps to there is not looked at
            late[i], rest[i] = _goes_with(along, when, scales), 0.0
            continue
        long = (release if release < end else end) - max(onset, begin)
        smooth.append((i, _at(times, when), int(run["episode_contact"].values[i]), long))
    if not smooth:
        return Peaks(late, rest, force, off)
    places, contacts = np.array([one[1] for one in smooth]), np.array([one[2] for one in smooth])
    bends = in_time.forces(places, contacts, np.array([one[3] for one in smooth]))
    for n, (i, at, c, _) in enumerate(smooth):
        own = bends.of(n)
        force[i], off[i] = (one[at, c] for one in series["normal_force"])
        most = displaced.doubts[at]
        if own.is_a_top(_FOUND):
            late[i], rest[i], correction = own.later(most)
            late[i], rest[i] = late[i] / scales, rest[i] / scales
            force[i] += correction / scales
            off[i] += np.abs(correction) / scales
        elif min(times[at] - begin, end - times[at]) < _ONE * end:
            late[i] = rest[i] = 0.0  # where the run begins or ends
        else:
            late[i] = _goes_with(along, float(times[at]), scales)
            rest[i] = np.abs(late[i]) * most
            force[i] += own.rate[0] * late[i]
            off[i] += np.abs(own.rate[0]) * rest[i]
    return Peaks(late, rest, force, off)


def largest_of(
    along: Along, series: Series, in_time: InTime, run: xr.Dataset, peaks: Peaks, at: tuple[Array, Array]
) -> Series:
    """Return what is told of sizes that are said with their largest value at a sample, and doubts, by name.

    Args:
        along: The run that was looked at.
        series: Derivatives at its samples and their doubts, by name.
        in_time: How its samples go on.
        run: The result.
        peaks: What :func:`peaks_of` says of it.
        at: Times that were asked for, ascending, and scales of the parameters.
    """
    asked, scales = at
    times = along.displaced.chunk.times
    found: Series = {}
    for name in (one for one in _said(run) if SIZES[one] in series):
        tops = _times(run, name)
        slopes, doubts = np.full((2, *tops.shape, len(scales)), math.nan)
        for index in np.ndindex(tops.shape):
            when = float(tops[index])
            row, place = _at(run["time"].values, when), _at(times, when)
            column = _column(run, name, index)
            way = _direction(run[SIZES[name]].values[(row, *column)])
            slope, doubt = (one[(place, *column)].reshape(len(way), -1) for one in series[SIZES[name]])
            moves = _moves(along, run, peaks, when, asked, scales)
            if moves is None:
                continue
            slopes[index], doubts[index] = way @ slope, np.abs(way) @ doubt
            if moves[0].any():
                rate, rest = in_time.series(place, moves[2])[SIZES[name]]
                per_second = float(way @ np.atleast_1d(rate[column]))
                slopes[index] += per_second * moves[0]
                doubts[index] += abs(per_second) * moves[1]
                doubts[index] += float(np.abs(way) @ np.atleast_1d(rest[column])) * np.abs(moves[0])
        found[name] = slopes, doubts
    return found


def _said(run: xr.Dataset) -> list[str]:
    """Return the names of what a result says with its largest size at a sample, but of how it is computed."""
    return [one for one in SIZES if one in run and SIZES[one] in run and one != "peak_energy_error"]


def _column(run: xr.Dataset, name: str, index: tuple[int, ...]) -> tuple[int, ...]:
    """Return where the series of a size stands: of drives only motions have one."""
    if name != "peak_effort":
        return index
    drives = run["drive"].values.tolist()
    return (drives.index(run["motion"].values[index[0]]),)


def _times(run: xr.Dataset, name: str) -> Array:
    """Return when each size of a result is largest, in the shape of what is said of it [s]."""
    if f"time_of_{name}" in run:
        return np.asarray(run[f"time_of_{name}"].values)
    values = run[SIZES[name]].values
    sizes = np.linalg.norm(values, axis=-1) if run[SIZES[name]].dims[-1] == "axis" else np.abs(values)
    out = np.zeros(run[name].shape, dtype=int)
    for index in np.ndindex(out.shape):
        out[index] = int(np.argmax(sizes[(slice(None), *_column(run, name, index))]))
    return np.asarray(run["time"].values[out])


def _direction(value: Array) -> Array:
    """Return what makes of the change of a number, or of a vector, that of its size."""
    if np.ndim(value) == 0:
        return np.array([math.copysign(1.0, value)])
    size = float(np.linalg.norm(value))
    return np.asarray(value / size) if size > 0.0 else np.full_like(value, math.nan)


def _at(times: Array, when: float) -> int:
    return int(np.argmin(np.abs(times - when)))


def _goes_with(along: Along, when: float, scales: Array) -> Array:
    """Return by how much what happens at an instant comes later; NaN if nothing does."""
    near = (one.late / scales for one in along.passed if abs(one.time - when) < _SAME)
    return next(near, np.full(len(scales), math.nan))


def _moves(
    along: Along, run: xr.Dataset, peaks: Peaks, when: float, asked: Array, scales: Array
) -> tuple[Array, Array, float] | None:
    """Return by how much later a sample is, its doubt and how long what is there lasts; None if not known."""
    still, one = np.zeros(len(scales)), _ONE * when
    if (np.abs(asked - when) <= 4.0 * np.spacing(max(when, float(asked[-1])))).any():
        return still, still, 0.0
    if any(abs(passed.time - when) < _SAME for passed in along.passed):
        return None  # a sample on one side of what jumps there
    for i in np.flatnonzero(np.abs(run["peak_time"].values - when) <= one) if "peak_time" in run else ():
        if not np.isfinite(peaks.late[i]).all():
            return None
        until = float(run["release_time"].values[i])
        end = float(along.displaced.chunk.times[-1])
        return (
            peaks.late[i],
            peaks.late_doubt[i],
            (until if until < end else end) - float(run["onset_time"].values[i]),
        )
    return still, still, 0.0
