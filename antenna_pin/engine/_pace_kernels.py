"""The size of a step, compiled: what its error allows, and what must not be stepped over."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import kernel
from antenna_pin.records import layout

SAFETY = 0.9
SHRINK = 0.2
GROW = 6.0
LARGEST_TURN = 2.0  # [rad] of a joint in one step: an angle's whole turns are counted from step to step

#: What decides how long the next step is: whether sizes follow errors and the power that they follow them by,
#: the fixed size, the longest and the least size [s], the end of the run [s], the fastest rate of a joint
#: that turns without end [rad/s], and which of the instants at which steps must end comes next.
PACE = layout(
    ("adaptive", "i8"),
    ("power", "i8"),
    ("step", "f8"),
    ("longest", "f8"),
    ("least", "f8"),
    ("end", "f8"),
    ("spin", "f8"),
    ("next", "i8"),
)


@kernel
def cut(pace: Any, breaks: Any, t: float, h: float) -> tuple[float, bool]:
    """Cut a step from t [s] to the longest allowed, to the next instant at which steps end, to the end.

    Args:
        pace: PACE, (1,); moves on to the next instant.
        breaks: Instants at which steps must end, increasing [s].
        t: Where it starts [s].
        h: What is wished [s].

    Returns:
        Its size [s], and whether the run's end has cut it.
    """
    p = pace[0]
    h = min(h, p.longest)
    if h * p.spin > LARGEST_TURN:
        h = LARGEST_TURN / p.spin
    while p.next < breaks.shape[0] and breaks[p.next] <= t:
        p.next += 1
    last = p.next >= breaks.shape[0]
    end = p.end if last else breaks[p.next]
    rest = end - t
    # Two equal steps rather than a sliver at the end.
    halved = p.adaptive != 0 and h > 0.5 * rest
    by_end = (h >= rest or halved) and last
    if h >= rest:
        return rest, by_end
    return (0.5 * rest if halved else h), by_end


@kernel
def following(pace: Any, wished: float, tried: float, error: float, rejected: bool) -> float:
    """Return the step to try after one that passed [s].

    Args:
        pace: PACE, (1,).
        wished: What was to be tried [s].
        tried: What it was cut to, and passed [s].
        error: Its scaled error [-].
        rejected: Whether longer ones did not pass.
    """
    p = pace[0]
    if p.adaptive == 0:
        return float(p.step)
    grow = GROW
    if error != 0.0:
        grow = min(GROW, SAFETY * math.pow(error, -1.0 / p.power))
    size = tried * grow
    if rejected:
        size = min(size, tried)
    if tried < wished:  # cut for the sake of an output or the end, not of the error
        size = max(size, wished)
    return float(size)


@kernel
def shortened(pace: Any, tried: float, error: float) -> float:
    """Return the step to try after one with too large an error [s]."""
    if math.isfinite(error):
        return float(tried * max(SHRINK, SAFETY * math.pow(error, -1.0 / pace[0].power)))
    return float(tried * SHRINK)


@kernel
def hopeless(pace: Any, h: float) -> bool:
    """Whether a step shortened to h [s] is not to be tried."""
    return bool(h < pace[0].least or pace[0].adaptive == 0)
