"""How far derivatives can be believed: how they grow along a run, and from when on doubt is too large."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["Growth", "growth_of"]

Array = NDArray[np.float64]

# Samples with a derivative below which nothing is said of how fast it grows.
_FEWEST = 5


class Growth(NamedTuple):
    """How a displacement of the velocities by one parameter grows along a run.

    Attributes:
        key: Of the parameter.
        largest: Velocities change by this at most per scale of it [m/s] ([rad/s]).
        when: At this time [s].
        exponent: By which it grows like exp(exponent t), a straight line through its logarithm over all
            samples: the exponent of this motion over this span, not of an attractor. NaN of fewer than five
            samples [1/s].
        believed: From when on, to the end, doubt is more than the asked share of the largest so far; infinity
            if it is not at the end [s].
    """

    key: str
    largest: float
    when: float
    exponent: float
    believed: float


def growth_of(
    times: Array, slopes: Array, doubts: Array, keys: tuple[str, ...], share: float
) -> tuple[Growth, ...]:
    """Return how the derivatives of velocities grow.

    Args:
        times: Of samples, (n,) [s].
        slopes: Per scale of each parameter, (n, nv, parameters).
        doubts: Likewise.
        keys: Of the parameters.
        share: Of doubt over the derivative, that is believed.
    """
    found = []
    for k, key in enumerate(keys):
        sizes, rest = (np.linalg.norm(one[..., k], axis=1) for one in (slopes, doubts))
        known = np.isfinite(sizes) & (sizes > 0.0)
        if not known.any():
            found.append(Growth(key, 0.0, math.nan, math.nan, math.inf))
            continue
        top = int(np.argmax(np.where(known, sizes, -1.0)))
        told = known & (rest < sizes)
        exponent = math.nan
        if np.count_nonzero(told) >= _FEWEST:
            exponent = float(np.polyfit(times[told], np.log(sizes[told]), 1)[0])
        # A derivative that goes back to zero is known if its doubt is small beside what it has been.
        been = np.maximum.accumulate(np.where(known, sizes, 0.0))
        sure = np.flatnonzero(known & (rest <= share * been))
        last = int(sure[-1]) if len(sure) else 0
        believed = math.inf if known[last + 1 :].sum() == 0 and len(sure) else float(times[last])
        found.append(Growth(key, float(sizes[top]), float(times[top]), exponent, believed))
    return tuple(found)
