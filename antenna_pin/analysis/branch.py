"""Stability along a branch of periodic solutions."""

from __future__ import annotations

import cmath
import itertools
import math
from typing import NamedTuple

import numpy as np
import xarray as xr

from antenna_pin.analysis._run import floats
from antenna_pin.base.arguments import takes


class StabilitySpan(NamedTuple):
    """Consecutive orbits of equal stability along a branch."""

    stability: str  # stable, unstable or neutral
    first: float  # value of the parameter at the first of them
    last: float  # at the last
    orbits: int  # their number
    largest: tuple[complex, complex]  # least and greatest of their largest multipliers, by size [-]


@takes()
def said_of_multiplier(multiplier: complex, digits: int = 4, places: int | None = None) -> str:
    """Return a multiplier as text: a signed number, or size and angle.

    Args:
        multiplier: [-].
        digits: Significant ones.
        places: Behind the point, that are known; all if left out.
    """
    size = abs(multiplier) if places is None else round(abs(multiplier), places)
    if multiplier.imag == 0.0:
        return f"{math.copysign(size, multiplier.real):.{digits}g}"
    return f"{size:.{digits}g} at {math.degrees(cmath.phase(multiplier)):.4g} deg"


@takes()
def stability_spans(branch: xr.Dataset) -> list[StabilitySpan]:
    """Return the spans of equal stability along a branch."""
    values = floats(branch["value"])
    every = np.nan_to_num(branch["multiplier_real"].values + 1j * branch["multiplier_imaginary"].values)
    # They are in the order of their sizes; a system without freedoms has none.
    largest = every[:, 0] if every.shape[1] else np.zeros(len(every), dtype=complex)
    spans = []
    said = [str(one) for one in branch["stability"].values]
    for stability, group in itertools.groupby(range(len(said)), key=said.__getitem__):
        places = list(group)
        here = sorted(largest[places].tolist(), key=abs)
        ends = here[0], here[-1]
        first, last = float(values[places[0]]), float(values[places[-1]])
        spans.append(StabilitySpan(stability, first, last, len(places), ends))
    return spans


@takes()
def unexplained_changes(branch: xr.Dataset) -> list[tuple[float, float]]:
    """Return the parameter values about each change of stability without a located bifurcation.

    A multiplier passes 1 there, and no fold is: another branch crosses this one, as where a symmetry breaks.
    """
    values = floats(branch["value"])
    said = [str(one) for one in branch["stability"].values]
    known = {int(one) for one in branch["after"].values}
    return [
        (float(values[k]), float(values[k + 1]))
        for k in range(len(said) - 1)
        if said[k] != said[k + 1] and k not in known
    ]
