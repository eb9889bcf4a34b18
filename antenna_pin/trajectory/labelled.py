"""Numbers as a labelled dataset, by the schema of results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

from antenna_pin.trajectory.schema import COORDINATES, DIMENSIONS, variables_of

__all__ = ["Unlabelled", "labelled"]


@dataclass(slots=True)
class Unlabelled:
    """All that a dataset is made of. To make it takes longer than a short run: it is made where it is read.

    Attributes:
        values: Of each variable, by name.
        labels: As :func:`labelled` takes them.
        attributes: The first of the dataset.
        of_system: What tells those that follow, of what was run.
        more: The last ones; to be added to.
        free_base: Whether the base is free.
        lean: Whether the series are left out.
    """

    values: Mapping[str, Any]
    labels: Mapping[str, Any]
    attributes: Mapping[str, Any]
    of_system: Callable[[], Mapping[str, Any]]
    more: dict[str, Any]
    free_base: bool
    lean: bool = False

    def labelled(self) -> xr.Dataset:
        """Return the dataset."""
        attributes = {**self.attributes, **self.of_system(), **self.more}
        return labelled(self.values, self.labels, attributes, free_base=self.free_base, lean=self.lean)


def labelled(
    values: Mapping[str, Any],
    labels: Mapping[str, Any],
    attributes: Mapping[str, Any],
    *,
    free_base: bool,
    lean: bool = False,
) -> xr.Dataset:
    """Return a dataset by the schema.

    Args:
        values: Of each variable, by name.
        labels: Of each dimension and coordinate, by name; of ``episode`` and ``tick`` how many there are.
        attributes: Of the dataset.
        free_base: Whether the base is free.
        lean: Whether to leave the series out.

    Raises:
        KeyError: The labels' dimensions ask for a variable that is not given.
    """
    coordinates: dict[str, xr.Variable] = {}
    left_out = {"time"} if lean else set()
    for name in DIMENSIONS:
        if name == "time" and not lean:
            coordinates[name] = xr.Variable(name, labels[name], {"units": "s", "long_name": "time"})
        elif name in labels and name not in ("time", "episode", "tick"):
            coordinates[name] = xr.Variable(name, _text(labels[name]))
    for coordinate in COORDINATES:
        if coordinate.dim in labels:
            text = _text(labels[coordinate.name])
            coordinates[coordinate.name] = xr.Variable(
                coordinate.dim, text, {"long_name": coordinate.meaning}
            )
    variables = {
        variable.name: xr.Variable(variable.dims, values[variable.name], variable.attributes)
        for variable in variables_of(set(labels) - left_out, free_base)
    }
    # Coordinates first: given with the variables they would be merged and compared with them one by one.
    return xr.Dataset(variables, coords=xr.Coordinates(coordinates), attrs=dict(attributes))


def _text(labels: Any) -> Any:
    # Text of a fixed width: of objects xarray asks what they are, for longer than all the rest takes.
    return np.array(labels, dtype=str)
