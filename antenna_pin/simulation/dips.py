"""Least values of a function in a step, of which no rate is known: a load near what it may be."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from antenna_pin.base.roots import least_between
from antenna_pin.engine.watch_kernels import CHECK_POINT, FIRST_POINT, SECOND_POINT, THIRD_POINT
from antenna_pin.simulation.crossing import Looks

__all__ = ["with_dips"]

# Share of the spread of values that an interpolation may be off by, and how many points are taken at most.
_OFF, _MOST = 0.01, 512


def with_dips(f: Callable[[float], float], look: Looks) -> Looks:
    """Return a function whose rate is not known at as many points of a step as show where it is least.

    Points are doubled until a cubic spline through them foretells those between; then each least value among
    them is located.

    Args:
        f: Of a fraction of the step.
        look: At points that are known, the step's ends among them.
    """
    from scipy.interpolate import CubicSpline

    if max(look.values) == min(look.values):
        return look
    thetas = np.array([0.0, FIRST_POINT, SECOND_POINT, CHECK_POINT, THIRD_POINT, 1.0])
    values = np.array([look.values[0], *map(f, thetas[1:-1].tolist()), look.values[-1]])
    while len(thetas) < _MOST:
        between = 0.5 * (thetas[1:] + thetas[:-1])
        found = np.array([f(theta) for theta in between.tolist()])
        off = np.abs(found - CubicSpline(thetas, values)(between)).max()
        thetas = np.insert(thetas, range(1, len(thetas)), between)
        values = np.insert(values, range(1, len(values)), found)
        if off <= _OFF * np.ptp(values):
            break
    beside = np.concatenate([[np.inf], values, [np.inf]])
    for i in np.flatnonzero((values < beside[:-2]) & (values <= beside[2:]))[::-1].tolist():
        first, last = float(thetas[max(i - 1, 0)]), float(thetas[min(i + 1, len(thetas) - 1)])
        low, value = least_between(f, first, last, absolute=1e-12)
        if value < values[i]:
            at = int(np.searchsorted(thetas, low))
            thetas, values = np.insert(thetas, at, low), np.insert(values, at, value)
    return Looks(thetas.tolist(), values.tolist(), [0.0] * len(thetas))
