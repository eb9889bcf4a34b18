"""Access to a run's samples, names and times, and its division into parts."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np
import xarray as xr

from antenna_pin.base.arguments import takes
from antenna_pin.base.arrays import Array
from antenna_pin.errors import FileFormatError, UnknownNameError
from antenna_pin.trajectory import Trajectory, series

#: Components of a vector.
AXES = ("x", "y", "z")
RunLike: TypeAlias = Trajectory | xr.Dataset


def data_of(run: RunLike) -> xr.Dataset:
    """Return the samples of a run."""
    return run.data if isinstance(run, Trajectory) else run


def label_of(data: xr.Dataset) -> str:
    """Return the name of a run for messages."""
    return str(data.attrs.get("case") or "a run without a case name")


def entries_in(run: RunLike, attribute: str) -> dict[str, dict[str, Any]]:
    """Return the entries of an attribute that is a JSON table; {} without it."""
    found: dict[str, dict[str, Any]] = json.loads(data_of(run).attrs.get(attribute, "{}"))
    return found


def floats(array: xr.DataArray) -> Array:
    """Return the numbers of an array."""
    return np.asarray(array.values, dtype=float)


def variable(data: xr.Dataset, name: str, place: str) -> xr.DataArray:
    """Return a variable, or refuse a run without it."""
    if name not in data:
        series(data, place)
        raise FileFormatError(f"{place}: the run has no variable {name!r}; is it an antenna_pin result?")
    return data[name]


def sample_times(data: xr.Dataset, place: str) -> Array:
    """Return the sample times [s], (n,): not decreasing, not evenly spaced."""
    return np.asarray(variable(data, "time", place).values, dtype=float)


def choose(place: str, what: str, wanted: str | None, known: list[str]) -> list[str]:
    """Return all known names, or the one wanted."""
    if wanted is None:
        return known
    if wanted not in known:
        raise UnknownNameError(place, what, wanted, known)
    return [wanted]


# --- long runs, part by part --------------------------------------------------------------------------------

#: A run of more samples is looked at part by part.
LONG = 100_000
#: Samples of a part.
ROWS = 16_384
# A spline through all samples is that through the nearest ones to round-off: what a knot does to its n-th
# neighbour falls as (2 - sqrt 3)^n, to 1e-37 at the 64th.
_MARGIN = 64


@takes()
def blocks(data: xr.Dataset, rows: int | None = None, overlap: int = 0) -> Iterator[xr.Dataset]:
    """Yield the parts of a long run along time, or a short run.

    Args:
        data: Of the run.
        rows: Samples of a part; 16,384 of a long run if left out.
        overlap: Samples that a part has in common with the one before.
    """
    count = data.sizes["time"]
    if rows is None:
        rows = ROWS if count > LONG else max(count, 1)
    if count <= rows:
        yield data
        return
    for first in range(0, count - overlap, rows):
        yield data.isel(time=slice(first, first + rows + overlap))


@takes()
def samples_around(
    data: xr.Dataset, times: Array, rows: int | None = None
) -> Iterator[tuple[slice, xr.Dataset]]:
    """Yield slices of times with the samples of a run for interpolation there.

    Of a run that is not long these are all times, and all samples.

    Args:
        data: Of the run to be interpolated.
        times: Not decreasing, (n,) [s].
        rows: Samples that are enough for a part; 16,384 of a long run if left out.
    """
    own = data["time"].values
    if rows is None:
        rows = ROWS if own.size > LONG else own.size
    if own.size <= rows or not times.size:
        yield slice(0, times.size), data
        return
    first = np.maximum(np.searchsorted(own, times, side="left") - _MARGIN, 0)
    last = np.searchsorted(own, times, side="right") + _MARGIN
    begin = 0
    while begin < times.size:
        end = begin + max(int(np.searchsorted(last[begin:], first[begin] + rows + 2 * _MARGIN, "right")), 1)
        end = min(end, begin + rows, times.size)
        yield slice(begin, end), data.isel(time=slice(int(first[begin]), int(last[end - 1])))
        begin = end
