"""Long runs with the fewest samples that draw the same lines.

A line of more samples than it has pixels looks the same with fewer. In each of 4096 equal parts of the time
the first, the last, the lowest and the highest sample of every drawn quantity are stored, and both ends of
each gap (NaN), so that no sample moves and no extreme is lost. The samples around 2050 even times, by which
sizes between spikes are determined, are stored as well.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from antenna_pin.analysis import LONG, blocks
from antenna_pin.show.plot._runs import LabelledRun
from antenna_pin.show.plot._style import Array

#: Returns what is to be drawn of a part of a run: arrays over its samples, (m,) or (m, k).
Columns = Callable[[LabelledRun], Iterable[Array]]
_Indices = NDArray[np.int_]

_PARTS = 4096
# Windows between whose spikes a size is looked for, and samples in each.
_WINDOWS, _IN_WINDOW = 50, 41


def thinned(run: LabelledRun, columns: Columns) -> LabelledRun:
    """Return a long run with the samples that draw its columns; others unchanged."""
    time = run.time
    if time.size <= LONG:
        return run
    even = np.searchsorted(time, even_instants(time), side="right")
    # At an instant with two samples, and at the end, interpolation may look at any of the four.
    around = np.concatenate([even - 2, even - 1, even, even + 1])
    kept = np.concatenate([around, _shown(run, columns, 0, time.size)])
    return _of(run, np.unique(np.clip(kept, 0, time.size - 1)))


def closer(run: LabelledRun, window: tuple[float, float] | None, columns: Columns) -> LabelledRun:
    """Return a thinned run with further samples for a close view [s]."""
    if run.kept is None or window is None:
        return run
    whole = run.whole
    time = whole.time
    first = max(int(np.searchsorted(time, window[0])) - 1, 0)
    last = min(int(np.searchsorted(time, window[1], side="right")) + 1, time.size)
    shown = np.arange(first, last)
    if shown.size > LONG:
        shown = _shown(whole, columns, first, last)
    return _of(whole, np.union1d(run.kept, shown))


def turning(angle: Array) -> Array:
    """Return a column with samples wherever an angle has turned by another radian.

    Between two stored samples the angle then turns by less than half a turn, so that ``numpy.unwrap`` finds
    the same turns as with all samples.
    """
    steps = np.floor(np.unwrap(angle))
    odd = np.mod(steps, 2.0) == 1.0
    return np.where(odd, np.nan, 0.0)


def _of(run: LabelledRun, indices: _Indices) -> LabelledRun:
    return replace(run, data=run.data.isel(time=indices), kept=indices, all=run)


def telling(place: Array, values: Array) -> _Indices:
    """Return indices of points that draw a line over ascending places, (n,) each."""
    starts = _starts(place, float(place[0]), float(place[-1]))
    return np.unique(np.concatenate(_extremes_of(values, starts, place.size)))


def _starts(place: Array, start: float, end: float) -> _Indices:
    """Return the first point in each of the equal parts between two places."""
    part = np.minimum((place - start) * (_PARTS / ((end - start) or 1.0)), _PARTS - 1).astype(int)
    return np.flatnonzero(np.diff(part, prepend=-1))


def _extremes_of(columns: Array, starts: _Indices, count: int) -> list[_Indices]:
    mine = [starts, starts[1:] - 1, np.array([count - 1])]
    for values in np.asarray(columns, dtype=float).reshape(count, -1).T:
        mine += _telling(values, starts)
    return mine


def _shown(run: LabelledRun, columns: Columns, begin: int, last: int) -> _Indices:
    """Return the samples that draw a range of a run."""
    data = run.data.isel(time=slice(begin, last))
    start, end = (float(data["time"].values[k]) for k in (0, -1))
    found = []
    for part in blocks(data):
        drawn = replace(run, data=part)
        time = drawn.time
        starts = _starts(time, start, end)
        mine = [starts, starts[1:] - 1, np.array([time.size - 1])]
        for column in columns(drawn):
            mine += _extremes_of(column, starts, time.size)
        found.append(begin + np.unique(np.concatenate(mine)))
        begin += time.size
    return np.concatenate(found).astype(int)


def _telling(values: Array, starts: _Indices) -> list[_Indices]:
    """Return the least and largest values of stretches, and both sides of gaps."""
    lengths = np.diff(starts, append=values.size)
    stretch = np.repeat(np.arange(starts.size), lengths)
    found = []
    for extreme in (np.fmin, np.fmax):
        hits = np.flatnonzero(values == extreme.reduceat(values, starts)[stretch])
        found.append(hits[np.unique(stretch[hits], return_index=True)[1]])
    edges = np.flatnonzero(np.diff(np.isnan(values)))
    return [*found, edges, edges + 1]


def between_spikes(time: Array, value: Array) -> float:
    """Return the size of a quantity between its spikes, over samples of any spacing.

    It is the largest, over fifty windows of equal length, of the median size: what lasts shorter than half a
    window is a spike. So a slow oscillation counts whole, whatever impacts stand on it.
    """
    known = np.isfinite(value)
    time, size = time[known], np.abs(value[known])
    if time.size < 2 or not time[-1] > time[0]:
        return float(size.max(initial=0.0))
    even = even_instants(time)
    return float(np.median(np.interp(even, time, size).reshape(_WINDOWS, _IN_WINDOW), axis=1).max())


def even_instants(time: Array) -> Array:
    """Return the times at which :func:`between_spikes` evaluates samples, (n,) [s]."""
    return np.linspace(time[0], time[-1], _WINDOWS * _IN_WINDOW)
