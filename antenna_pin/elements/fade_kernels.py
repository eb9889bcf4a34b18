"""Fade-in of a motion: a factor from 0 to 1, compiled."""

from __future__ import annotations

from antenna_pin.compiled.decorators import inlined


@inlined
def fade(t: float, length: float) -> tuple[float, float, float]:
    """Return the factor at time t [s] with its first two derivatives.

    The factor is 10 u^3 - 15 u^4 + 6 u^5 of u = t / length.

    Its first two derivatives are zero at both ends, so that acceleration begins without a jump.
    """
    if t >= length:
        return 1.0, 0.0, 0.0
    u = t / length
    rest = 1.0 - u
    value = u * u * u * (10.0 + u * (6.0 * u - 15.0))
    return value, 30.0 * u * u * rest * rest / length, 60.0 * u * rest * (rest - u) / (length * length)


@inlined
def faded(swing: tuple[float, float, float], t: float, length: float) -> tuple[float, float, float]:
    """Position, rate and acceleration of a motion, given with both derivatives, that fades in."""
    x, v, a = swing
    w, slope, bend = fade(t, length)
    return w * x, w * v + slope * x, w * a + 2.0 * slope * v + bend * x
