"""The variables of a result without xarray, of which runs that are only compared need none."""

from __future__ import annotations

from antenna_pin.trajectory.labelled import Column, Unlabelled
from antenna_pin.trajectory.result import Trajectory

__all__ = ["columns_of"]


def columns_of(run: Trajectory) -> dict[str, Column]:
    """Return all variables of a result by name, coordinates too; xarray is asked where it has them."""
    unlabelled: Unlabelled | None = getattr(run, "_unlabelled", None)
    if unlabelled is None:
        found = run.data.variables.items()
        return {str(name): Column(tuple(map(str, one.dims)), one.values, one.attrs) for name, one in found}
    coordinates, variables = unlabelled.columns()
    return {**variables, **coordinates}
