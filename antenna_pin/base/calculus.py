"""Roots, least values and derivatives of functions of one variable."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

# --- roots and least values ---------------------------------------------------------------------------------
#
# Few runs look for one, and all would wait a quarter of a second.

#: Of the float nearest to a root: no closer one can be told.
_LAST_DIGIT = 4.0 * 2.0**-52


def root_between(
    function: Callable[[float], float],
    a: float,
    b: float,
    *,
    absolute: float,
    relative: float = _LAST_DIGIT,
    ends: tuple[float, float] | None = None,
) -> float:
    """Return the zero of a function between places of different sign (Brent's method).

    Args:
        function: Of a number.
        a: One place.
        b: The other.
        absolute: How far from the root the result may be.
        relative: The same, as a share of the result.
        ends: Known values at both places, of different signs or zero. The function is evaluated between the
            places only, and where its value is not a number it counts as that at the second place.
    """
    from scipy.optimize import brentq

    if ends is None:
        return float(brentq(function, a, b, xtol=absolute, rtol=relative))
    known = dict(zip((a, b), ends, strict=True))

    def bounded(x: float) -> float:
        value = known.get(x)
        if value is None:
            value = function(x)
        return value if math.isfinite(value) else math.copysign(1.0, ends[1])

    return float(brentq(bounded, a, b, xtol=absolute, rtol=relative))


def least_between(
    function: Callable[[float], float], a: float, b: float, *, absolute: float
) -> tuple[float, float]:
    """Return the minimum of a function between two numbers, and its value there.

    Args:
        function: Of a number, with one minimum between them.
        a: The smaller.
        b: The larger.
        absolute: How far from the minimum the result may be.
    """
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(function, bounds=(a, b), method="bounded", options={"xatol": absolute})
    return float(found.x), float(found.fun)


# --- derivatives --------------------------------------------------------------------------------------------

Array = NDArray[np.float64]

#: Steps that are tried where nothing is known of a function's scale, the largest first [rad, m or rates].
STEPS = (1e-2, 1e-3, 1e-4, 1e-6)

#: Of central differences at 1, 2 and 3 steps: of sixth order, and of fourth; their difference tells a kink.
WEIGHTS = np.array([[45.0, -9.0, 1.0], [8.0, -1.0, 0.0]]) / np.array([[60.0], [12.0]])
_SIXTH, _FOURTH = WEIGHTS
# A kink on the spot, J |s| / 2, is only in even differences e_k = f(kh) + f(-kh) - 2 f(0), by J k h, where a
# smooth function has f2 (kh)^2 + f4 (kh)^4 / 12 + f6 (kh)^6 / 360, by its derivatives. Weights w with w.k = 6
# and w.k^2 = w.k^4 = 0 leave J / 2 of w.e / 12 h, and f6 h^5 / 12 of a smooth function: where steps are good
# that is below f5 h^4 / 30, which is between the two orders above.
_KINK = np.array([15.0, -6.0, 1.0]) / 12.0
_ROUND_OFF = 4.0 * float(np.finfo(float).eps)
# Difference of the two orders over the derivative that is good enough; doubt above which there is a kink; and
# derivatives over the largest that are round-off.
_GOOD, _ROUGH, _NOTHING = 1e-8, 1e-3, 1e-6
# How near second order is to fourth, over the derivative, where sixth would change nothing of that.
_NEAR = 1e-6


# The median of third differences of what is normally distributed, over its deviation.
_OF_THIRDS = 0.6745 * 20.0**0.5


def roughness(values: Array) -> Array:
    """Return the scatter of evenly spaced values about a smooth curve, (n,).

    By the median of their third differences, of which a kink shows in three.

    Args:
        values: (count, n), of a dozen or so.
    """
    thirds = np.median(np.abs(np.diff(values, 3, axis=0)), axis=0)
    return np.asarray(thirds / _OF_THIRDS)


class Slope(NamedTuple):
    """A derivative.

    Attributes:
        value: Of the shape of the function's value.
        doubt: By how much other differences say otherwise: large beside the value at a kink or a jump.
    """

    value: Array
    doubt: float


def slope(function: Callable[[float], Array], steps: Sequence[float] = STEPS) -> Slope:
    """Return the derivative of a function of one number at zero.

    Of sixth order; the first step counts with which fourth order agrees to eight digits, or else the one with
    which it agrees best. Of a smooth function of scale one, the error is some 1e-13 of the derivative. The
    doubt is what is between the two orders, or at a kink on the spot half of the jump of its slope.

    Args:
        function: ``(s) -> values``, which may be the same array each time.
        steps: To be tried, the largest first.
    """
    best, least, doubt = np.zeros(0), np.inf, np.inf
    here = np.array(function(0.0))
    size = float(np.abs(here).max(initial=0.0))
    for h in steps:
        ahead, behind = (np.array([np.array(function(side * k * h)) for k in (1, 2, 3)]) for side in (1, -1))
        odd, even = ahead - behind, ahead + behind - 2.0 * here
        sixth = np.tensordot(_SIXTH, odd, 1) / h
        scale = float(np.abs(sixth).max(initial=0.0))
        noise = _ROUND_OFF * size / h
        bend = np.tensordot(_KINK, even, 1) / h
        share, kink = (
            max(float(np.abs(one).max(initial=0.0)) - noise, 0.0) / scale if scale > 0.0 else 0.0
            for one in (sixth - np.tensordot(_FOURTH, odd, 1) / h, bend)
        )
        if share < least:
            best, least, doubt = sixth, share, max(share, kink) * scale
        if share <= _GOOD:
            break
    return Slope(np.asarray(best, dtype=float), doubt)


def few(function: Callable[[int], Array], step: float) -> tuple[Array, Array]:
    """Return the derivative of a function at zero with its error estimate, by few evaluations.

    Where each builds much: by three of values on a straight line, whose second and third differences are
    round-off, with no doubt; by four where fourth order and second differ so little, by h^2 f3 / 6, that what
    fourth leaves out, h^4 f5 / 30, is nothing; else by six. Infinite values have no derivative, and zero.
    """
    here, ahead, behind, farther = (np.asarray(function(j), dtype=float) for j in (0, 1, -1, 2))
    noise = _ROUND_OFF * np.abs([here, ahead, behind, farther]).max(axis=0)
    with np.errstate(invalid="ignore"):
        first = ahead - behind
        bent = np.abs(ahead + behind - 2.0 * here), np.abs(farther - behind - 3.0 * (ahead - here))
        if not (np.maximum(*bent) > 2.0 * noise).any():
            return np.where(np.isfinite(first), 0.5 * first / step, 0.0), np.zeros_like(first)
        odd = [first, farther - function(-2)]
        second, found = 0.5 * first, (8.0 * first - odd[1]) / 12.0
        doubt = np.abs(found - second)
        if (doubt > _NEAR * np.abs(found) + noise).any():
            found, fourth = WEIGHTS @ np.array([*odd, function(3) - function(-3)])
            doubt = np.abs(found - fourth)
        else:
            doubt = np.zeros_like(found)
    changes = np.isfinite(found) & ((first != 0.0) | (odd[1] != 0.0))
    return np.where(changes, found / step, 0.0), np.where(changes, doubt / step, 0.0)


def gradient(
    function: Callable[[Array], Array], ways: Array, steps: Sequence[float] = STEPS
) -> tuple[Array, NDArray[np.bool_]]:
    """Return directional derivatives of a vector function at zero, (values, m), and kinks.

    Along ways of the latter the function has a kink or a jump, there or next to it.

    Args:
        function: ``(step) -> values``.
        ways: Columns, (n, m).
        steps: To be tried, the largest first.
    """

    def along(way: Array) -> Slope:
        return slope(lambda s: function(s * way), steps)

    found = [along(way) for way in ways.T]
    if not found:
        return np.zeros((len(function(np.zeros(len(ways)))), 0)), np.zeros(0, dtype=bool)
    table = np.column_stack([one.value for one in found])
    scales = np.abs(table).max(axis=0, initial=0.0)
    scales = np.maximum(scales, _NOTHING * float(scales.max()))
    return table, np.array([one.doubt for one in found]) > _ROUGH * scales
