"""What the analyses need to know of a run: its samples, names and times."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from antenna_pin.errors import FileFormatError, UnknownNameError
from antenna_pin.trajectory import Trajectory, series

__all__ = [
    "Array",
    "RunLike",
    "choose",
    "data_of",
    "label_of",
    "sample_times",
    "variable",
]

Array = NDArray[np.float64]
RunLike: TypeAlias = Trajectory | xr.Dataset


def data_of(run: RunLike) -> xr.Dataset:
    """Return the samples of a run."""
    return run.data if isinstance(run, Trajectory) else run


def label_of(data: xr.Dataset) -> str:
    """Return what a run is called in a message."""
    return str(data.attrs.get("case") or "a run without a case name")


def variable(data: xr.Dataset, name: str, place: str) -> xr.DataArray:
    """Return a variable, or say that it is missing."""
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
