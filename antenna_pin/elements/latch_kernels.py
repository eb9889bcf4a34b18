"""A latch that holds by a spring, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel, record
from antenna_pin.records import layout, words_of

# Its modes: outside the window; inside, but too fast or the wrong way; held; let go and still inside.
OUTSIDE, INSIDE, HELD, LET_GO = 0, 1, 2, 3

#: Window, where it holds, greatest rate and way of capture (+1, -1, 0 for both), spring and damper with half
#: of its play, torque at which it lets go (infinite: never), and the mode.
LAYOUT = layout(
    ("lower", "f8"),
    ("upper", "f8"),
    ("angle", "f8"),
    ("greatest_rate", "f8"),
    ("direction", "f8"),
    ("stiffness", "f8"),
    ("damping", "f8"),
    ("half_play", "f8"),
    ("holding", "f8"),
    ("mode", "i8"),
)
SIZE = words_of(LAYOUT)


@inlined
def excess(latch: Any, angle: float) -> float:
    """How far the joint is beyond the latch's own play, with its sign; zero inside."""
    off = float(angle - latch.angle)
    if off > latch.half_play:
        return off - latch.half_play
    return off + latch.half_play if off < -latch.half_play else 0.0


@inlined
def grip(latch: Any, angle: float, rate: float) -> float:
    """Torque [N m], or force [N], of the spring and the damper; only back to the latched angle."""
    off = excess(latch, angle)
    if latch.half_play > 0.0 and off == 0.0:
        return 0.0
    torque = -latch.stiffness * off - latch.damping * rate
    if latch.half_play > 0.0 and torque * off > 0.0:
        return 0.0  # the flank does not pull
    return float(torque)


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    latch = record(words[at : at + SIZE], LAYOUT)
    return grip(latch, angle, rate) if latch.mode == HELD else 0.0


@inlined
def write_rates(words: Any, at: int, angle: float, rate: float, power: float, rates: Any, x: int) -> None:
    """Power lost [W]: what goes in, but for what the spring stores."""
    latch = record(words[at : at + SIZE], LAYOUT)
    rates[x] = 0.0
    if latch.mode == HELD:
        rates[x] = -power - latch.stiffness * excess(latch, angle) * rate


@inlined
def stored(words: Any, at: int, angle: float) -> float:
    """Energy stored [J]."""
    latch = record(words[at : at + SIZE], LAYOUT)
    if latch.mode != HELD:
        return 0.0
    off = excess(latch, angle)
    return float(0.5 * latch.stiffness * off * off)


@inlined
def beyond_capture(latch: Any, rate: float) -> float:
    """By how much the rate is not one to be captured at [rad/s]; zero or less where it is."""
    if latch.direction == 0.0:
        return abs(rate) - float(latch.greatest_rate)
    way = latch.direction * rate
    return max(way - latch.greatest_rate, -way)


@inlined
def inside(latch: Any, angle: float) -> float:
    """How far the joint is inside the window; negative outside."""
    return float(min(angle - latch.lower, latch.upper - angle))


@kernel
def margin(words: Any, at: int, t: float, angle: float, rate: float) -> tuple[float, float]:
    """How far its mode is from its end, positive as long as it lasts, and the rate of that (0: unknown)."""
    latch = record(words[at : at + SIZE], LAYOUT)
    if latch.mode == HELD:
        return latch.holding - abs(grip(latch, angle, rate)), 0.0
    deep = inside(latch, angle)
    slope = rate if angle - latch.lower < latch.upper - angle else -rate
    if latch.mode == OUTSIDE:
        return -deep, -slope
    if latch.mode == INSIDE:
        # Either ends it: a share of the half window, or of the rate.
        share = deep / (0.5 * (latch.upper - latch.lower))
        off = beyond_capture(latch, rate)
        scale = latch.greatest_rate if 0.0 < latch.greatest_rate < math.inf else 1.0
        return min(share, off / scale), 0.0
    return deep, slope


@kernel
def switch(words: Any, at: int, t: float, angle: float, rate: float) -> None:
    """Write the mode that begins where the present one ends."""
    latch = record(words[at : at + SIZE], LAYOUT)
    if latch.mode == HELD:
        latch.mode = LET_GO
    elif latch.mode == LET_GO:
        latch.mode = OUTSIDE
    elif latch.mode == OUTSIDE:
        latch.mode = HELD if beyond_capture(latch, rate) <= 0.0 else INSIDE
    else:
        # Which of the two has ended it: the nearer to its end.
        share = inside(latch, angle) / (0.5 * (latch.upper - latch.lower))
        scale = latch.greatest_rate if 0.0 < latch.greatest_rate < math.inf else 1.0
        latch.mode = HELD if beyond_capture(latch, rate) / scale < share else OUTSIDE
