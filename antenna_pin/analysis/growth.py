r"""How a deviation grows: by a power of time, or exponentially.

What is fitted is the envelope :math:`E(t) = \max_{s \le t} |d(s)|`, which never falls, so that zero crossings
of an oscillating deviation do not count. In its logarithm both laws are straight lines,

.. math:: \ln E = \ln c + p \ln (t - t_0), \qquad \ln E = \ln c + \lambda (t - t_0),

with :math:`t_0` the start of the run. They are fitted by least squares at 200 points evenly over the time of
growth: from where E first passes a thousandth of its final value (less may be no more than two integrations
differ by) to where it reaches that value. The rest of the run, where nothing grows, is left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from antenna_pin.analysis._run import Array

__all__ = ["Growth", "growth_of"]

_POINTS = 200
_LEAST_RECORDS = 8
_LEAST_GROWTH = 3.0
_LEAST_SHARE = 0.2
_LEAST_FIT = 0.9


@dataclass(frozen=True, slots=True, kw_only=True)
class Growth:
    """Fits to the envelope of a deviation.

    Attributes:
        kind: Law that fits better, or "none" where neither says anything (see ``note``).
        exponent: p of the power of time [-]; NaN where nothing is fitted.
        power_r2: Coefficient of determination of ln E for the power [-].
        rate: lambda of the exponential [1/s]; NaN where nothing is fitted.
        exponential_r2: The same for the exponential [-].
        start: Where the fit begins [s].
        end: Where the fit ends [s].
        note: Why neither law says anything; empty if one does.
    """

    kind: Literal["power", "exponential", "none"]
    exponent: float
    power_r2: float
    rate: float
    exponential_r2: float
    start: float
    end: float
    note: str = ""

    def __str__(self) -> str:
        """Return the better law in words."""
        if self.kind == "power":
            return f"t^{self.exponent:.3g} (R2 {self.power_r2:.3f})"
        if self.kind == "exponential":
            return f"exp({self.rate:.3g}/s t) (R2 {self.exponential_r2:.3f})"
        return self.note


def growth_of(time: ArrayLike, deviation: ArrayLike) -> Growth:
    """Return how a deviation grows; the module's text says what is fitted.

    The fit means nothing, and ``kind`` is "none", if the envelope rises in fewer than 8 samples (one or two
    jumps are not a law), by less than a factor of 3 (then it is level), for less than a fifth of the run
    (then one early event made it), or if neither straight line explains nine tenths of the variance of ln E.
    A rate is that of this run over this time, not a Lyapunov exponent: play bounds a deviation, or friction
    drives it, long before.

    Args:
        time: Sample times, not decreasing, (n,) [s].
        deviation: Samples, (n,).
    """
    t = np.asarray(time, dtype=float)
    envelope = np.maximum.accumulate(np.abs(np.asarray(deviation, dtype=float)))
    if t.size < 2 or not envelope[-1] > 0.0:
        return _nothing("it does not deviate", t)
    # Time zero has no logarithm, and a deviation there would be no growth.
    first = max(int(np.argmax(envelope > 1e-3 * envelope[-1])), int(np.argmax(t > t[0])))
    last = int(np.argmax(envelope >= envelope[-1]))
    if np.count_nonzero(np.diff(envelope[first : last + 1])) + 1 < _LEAST_RECORDS:
        return _nothing("it rises in a few jumps only", t)
    if envelope[last] < _LEAST_GROWTH * envelope[first]:
        return _nothing("it is level", t)
    if t[last] - t[first] < _LEAST_SHARE * (t[-1] - t[0]):
        return _nothing("it grows for less than a fifth of the run", t)
    since = t - t[0]
    points = np.linspace(since[first], since[last], _POINTS)
    held = np.searchsorted(since, points, side="right") - 1
    logarithm = np.log(envelope[np.clip(held, first, last)])
    exponent, power = _line(np.log(points), logarithm)
    rate, exponential = _line(points, logarithm)
    better = max(power, exponential)
    poor = better < _LEAST_FIT
    return Growth(
        kind="none" if poor else "power" if power >= exponential else "exponential",
        exponent=exponent,
        power_r2=power,
        rate=rate,
        exponential_r2=exponential,
        start=float(t[first]),
        end=float(t[last]),
        note="neither a power nor an exponential fits" if poor else "",
    )


def _nothing(note: str, time: Array) -> Growth:
    nan = float("nan")
    start, end = (float(time[0]), float(time[-1])) if time.size else (nan, nan)
    return Growth(
        kind="none",
        exponent=nan,
        power_r2=nan,
        rate=nan,
        exponential_r2=nan,
        start=start,
        end=end,
        note=note,
    )


def _line(x: Array, y: Array) -> tuple[float, float]:
    """Return slope and coefficient of determination of a straight line."""
    dx, dy = x - x.mean(), y - y.mean()
    slope = float(dx @ dy / (dx @ dx))
    left = dy - slope * dx
    return slope, float(1.0 - left @ left / (dy @ dy))
