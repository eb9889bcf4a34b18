"""A root, or a least value, of a function between two numbers: SciPy's, loaded when the first is looked for.

Few runs look for one, and all would wait a quarter of a second.
"""

from __future__ import annotations

import math
from collections.abc import Callable

__all__ = ["least_between", "root_between"]

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
    """Return where a function that has different signs at two places is zero (Brent's method).

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
    """Return where between two numbers a function is least, to ``absolute``, and its value there.

    Args:
        function: Of a number, with one minimum between them.
        a: The smaller.
        b: The larger.
        absolute: How far from the minimum the result may be.
    """
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(function, bounds=(a, b), method="bounded", options={"xatol": absolute})
    return float(found.x), float(found.fun)
