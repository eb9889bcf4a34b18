"""Labelled numbers by the schema of results, for files and datasets."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, variables_of

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True)
class Column:
    """Variable with the attributes of xarray's that a writer reads."""

    dims: tuple[str, ...]  # its dimensions
    values: NDArray[Any]  # its numbers
    attrs: Mapping[str, Any]  # its attributes

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of the values."""
        return self.values.dtype

    @property
    def shape(self) -> tuple[int, ...]:
        """Length along each dimension."""
        return self.values.shape

    @property
    def ndim(self) -> int:
        """Number of dimensions."""
        return self.values.ndim

    @property
    def size(self) -> int:
        """Number of values."""
        return self.values.size

    @property
    def nbytes(self) -> int:
        """Size of the values [bytes]."""
        return self.values.nbytes

    def __getitem__(self, rows: slice) -> Column:
        """Return some of it along its first dimension."""
        return Column(self.dims, self.values[rows], self.attrs)


@dataclass(slots=True)
class Content:
    """Content of a dataset without xarray, which loads slower than a short run."""

    coords: dict[str, Column]  # coordinates by name
    data: dict[str, Column]  # the other variables
    attrs: dict[str, Any]  # of all

    @property
    def variables(self) -> dict[str, Column]:
        """All variables, in the order of a dataset."""
        return {**self.data, **self.coords}

    @property
    def sizes(self) -> dict[str, int]:
        """Length of each dimension, in the order of a dataset."""
        return {
            dim: size
            for column in self.variables.values()
            for dim, size in zip(column.dims, column.shape, strict=True)
        }

    def dataset(self) -> xr.Dataset:
        """Return the content as a dataset."""
        import xarray as xr

        coordinates, variables = (
            {name: xr.Variable(one.dims, one.values, one.attrs) for name, one in columns.items()}
            for columns in (self.coords, self.data)
        )
        # Coordinates first: given with the variables they would be merged and compared with them one by one.
        return xr.Dataset(variables, coords=xr.Coordinates(coordinates), attrs=self.attrs)


@dataclass(slots=True)
class Unlabelled:
    """Parts of a result, from which its data are made when read."""

    values: Mapping[str, Any]  # by variable
    labels: Mapping[str, Any]  # by dimension and coordinate; of ``episode`` and ``tick`` their number
    attributes: Mapping[str, Any]  # the first of the dataset
    of_system: Callable[[], Mapping[str, Any]]  # returns those that follow, of the system
    more: dict[str, Any]  # the last ones; may be added to
    free_base: bool
    lean: bool = False  # without series
    left_out: Collection[str] = ()  # further variables that the record does not have

    def labelled(self) -> xr.Dataset:
        """Return a dataset by the schema.

        Raises:
            KeyError: The labels' dimensions require a variable that is not given.
        """
        return self.content().dataset()

    def content(self) -> Content:
        """Return the content without xarray."""
        return Content(*self.columns(), {**self.attributes, **self.of_system(), **self.more})

    def columns(self) -> tuple[dict[str, Column], dict[str, Column]]:
        """Return its coordinates and its other variables, by name."""
        labels = self.labels
        coordinates: dict[str, Column] = {}
        left_out = {"time"} if self.lean else set()
        for name in DIMENSIONS:
            if name == "time" and not self.lean:
                about = {"units": "s", "long_name": "time"}
                coordinates[name] = Column((name,), np.asarray(labels[name]), about)
            elif name in labels and name not in ("time", "episode", "tick"):
                coordinates[name] = Column((name,), _text(labels[name]), {})
        for one in COORDINATES:
            if one.dim in labels:
                coordinates[one.name] = Column(
                    (one.dim,), _text(labels[one.name]), {"long_name": one.meaning}
                )
        variables = {
            one.name: Column(one.dims, np.asarray(self.values[one.name]), one.attributes)
            for one in variables_of(set(labels) - left_out, self.free_base)
            if one.name not in self.left_out
        }
        return coordinates, variables


def _text(labels: Any) -> Any:
    # Text of a fixed width: xarray inspects objects one by one, for longer than all the rest takes.
    return np.array(labels, dtype=str)
