"""What a branch of periodic solutions comes to: where along it they are stable."""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np
import xarray as xr

__all__ = ["StabilitySpan", "stability_spans", "unexplained_changes"]


class StabilitySpan(NamedTuple):
    """Orbits next to one another along a branch that are alike stable.

    Attributes:
        stability: stable, unstable or neutral.
        first: Value of the parameter of the first of them.
        last: Of the last.
        orbits: How many they are.
        largest: Sizes of their largest multipliers, from the least to the greatest [-].
    """

    stability: str
    first: float
    last: float
    orbits: int
    largest: tuple[float, float]


def stability_spans(branch: xr.Dataset) -> list[StabilitySpan]:
    """Return where along a branch orbits are stable, in order.

    Args:
        branch: Of :func:`antenna_pin.nonlinear.branch_table`.
    """
    values = np.asarray(branch["value"].values, dtype=float)
    sizes = np.hypot(branch["multiplier_real"].values, branch["multiplier_imaginary"].values)
    largest = np.nanmax(sizes, axis=1, initial=0.0)
    spans = []
    said = [str(one) for one in branch["stability"].values]
    for stability, group in itertools.groupby(range(len(said)), key=said.__getitem__):
        places = list(group)
        here = largest[places]
        ends = float(here.min()), float(here.max())
        first, last = float(values[places[0]]), float(values[places[-1]])
        spans.append(StabilitySpan(stability, first, last, len(places), ends))
    return spans


def unexplained_changes(branch: xr.Dataset) -> list[tuple[float, float]]:
    """Return the values of the parameter about each change of stability without a bifurcation that was found.

    A multiplier passes 1 there, and no fold is: another branch crosses this one, as where a symmetry breaks.

    Args:
        branch: Of :func:`antenna_pin.nonlinear.branch_table`.
    """
    values = np.asarray(branch["value"].values, dtype=float)
    said = [str(one) for one in branch["stability"].values]
    known = {int(one) for one in branch["after"].values}
    return [
        (float(values[k]), float(values[k + 1]))
        for k in range(len(said) - 1)
        if said[k] != said[k + 1] and k not in known
    ]
