"""Where the derivative of rates breaks within a step: at kinks of forces that nobody has told of.

A step of an equation ``w' = A(t) w`` has the order of its quadrature where A is smooth, and none where it
jumps between two of the nodes or behind the last of them. So A is also looked at along one direction, at more
places than the nodes and at both ends: what a polynomial leaves of that is no larger than a step's error,
or there is a jump, which is bracketed, or the step is too long.

Near a kink central differences ramp from the one derivative to the other, odd about the kink, so that the
middle of the ramp is the kink's instant to the square of their step.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from antenna_pin.base.differences import WEIGHTS
from antenna_pin.integrate import NODES

__all__ = ["BETWEEN", "ENDS", "Break", "SAMPLES", "left_over", "located"]

Array = NDArray[np.float64]

# How near an end of a step it is looked at, as a part of the step: a jump beyond adds that much of itself.
_EDGE = 1.0 - float(NODES[-1])
#: Where a step is looked at besides at its nodes: the largest gap is a sixth of the step.
BETWEEN = np.array([_EDGE, 0.02, 0.2, 0.5, 0.8, 0.98])
#: Where it is looked at in all, the nodes first.
SAMPLES = np.concatenate([NODES, BETWEEN])
#: Which of these are the step's ends: first and last.
ENDS = len(NODES), len(NODES) - 1
# Degree of the polynomial.
_DEGREE = 6
# Part of a jump, and how the ramp of differences of sixth order rises in its middle, per step.
_QUARTER, _RISE = 0.25, float(WEIGHTS[0].sum())
# Of a bracket, half the part in which more than this part of the change happens if it is a jump.
_NARROW, _MOST = 0.05, 0.5


class Break(NamedTuple):
    """A jump of a derivative.

    Attributes:
        place: Where.
        beside: Places before it and behind it, near but apart from what is next to it.
        later: By how much later it is for a neighbour a step of the ramps away.
    """

    place: float
    beside: tuple[float, float]
    later: float


def _rests(places: Array) -> Array:
    """Return what takes the nearest polynomial away from values at some places, (places, places)."""
    basis = np.linalg.qr(np.polynomial.legendre.legvander(2.0 * places - 1.0, _DEGREE))[0]
    return np.asarray(np.eye(len(places)) - basis @ basis.T)


def _kept(known: tuple[bool, bool]) -> NDArray[np.intp]:
    """Return which samples count, in the order of their places."""
    left_out = {end for end, is_known in zip(ENDS, known, strict=True) if is_known}
    return np.array([k for k in np.argsort(SAMPLES).tolist() if k not in left_out])


_KEPT = {(one, other): _kept((one, other)) for one in (False, True) for other in (False, True)}
_REST = {known: _rests(SAMPLES[kept]) for known, kept in _KEPT.items()}


def left_over(values: Array, known: tuple[bool, bool]) -> tuple[float, tuple[int, int]]:
    """Return how much a polynomial leaves of values at :data:`SAMPLES`, and between which two it breaks most.

    Args:
        values: (samples, n).
        known: Whether its first and its last end are breaks that are known: values there do not count.
    """
    kept = _KEPT[known]
    rest = _REST[known] @ values[kept]
    worst = int(np.argmax(np.linalg.norm(np.diff(rest, axis=0), axis=1)))
    return float(np.linalg.norm(rest, axis=1).max()), (int(kept[worst]), int(kept[worst + 1]))


def located(
    ramps: Callable[[float], Array],
    jumps: Callable[[float], Array],
    low: float,
    high: float,
    before: Array,
    after: Array,
) -> Break | None:
    """Return where a function of one number jumps between two places, or None if it does not jump there.

    Args:
        ramps: ``(place) -> values``, by steps that are the same everywhere.
        jumps: The same by steps that straddle no kink.
        low: Below the jump.
        high: Above it.
        before: Values there.
        after: Likewise.
    """
    change = after - before
    size = float(change @ change)

    def past(function: Callable[[float], Array], place: float) -> float:
        return float((function(place) - before) @ change) / size - 0.5

    if not size > 0.0 or not past(ramps, low) < 0.0 < past(ramps, high):
        return None
    place = float(brentq(lambda there: past(ramps, there), low, high, xtol=1e-15, rtol=1e-15))
    near = _NARROW * (high - low)
    beside = max(place - near, low), min(place + near, high)
    if not past(jumps, beside[1]) - past(jumps, beside[0]) > _MOST:
        return None
    # How the ramp rises tells how much later a neighbour comes to the kink.
    there, rise = high, past(ramps, high)
    if rise > _QUARTER > past(ramps, place):
        there = float(brentq(lambda at: past(ramps, at) - _QUARTER, place, high, xtol=1e-15, rtol=1e-6))
        rise = _QUARTER
    return Break(place, beside, (there - place) / (rise / _RISE))
