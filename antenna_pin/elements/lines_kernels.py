"""A sum of sines at equal spacing in frequency, compiled: four of them at once.

In the words stand the four unit lanes, the lane 0, 1, 2, 3, and then the lines, four by four: a lane of what
the displacement has of the cosine, and one of what it has, negated, of the sine.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.compiled.lanes import LANES, lane, same_lane, sum_of_lane

_FIRST = LANES * LANES + LANES
# Sines and cosines follow from those before by one product each; that often they are computed anew.
_ANEW = 64


@inlined
def _lanes_of(words: Floats, at: int, start: float, step: float) -> tuple[Any, Any]:
    """Return the cosines and the sines of start, start + step, ... as lanes."""
    cosines, sines = same_lane(0.0), same_lane(0.0)
    for k in range(LANES):
        own = lane(words, at + k * LANES)
        cosines = cosines + own * math.cos(start + k * step)
        sines = sines + own * math.sin(start + k * step)
    return cosines, sines


@kernel
def lines(words: Floats, at: int, groups: int, lowest: int, turned: float) -> tuple[float, float, float]:
    """Return the sum and its derivatives over the turn [1, 1/rad, 1/rad^2].

    The turn counts from the period's start.

    Args:
        words: In which the lines stand.
        at: Where.
        groups: How many lanes of them.
        lowest: Number of the first line: periods of it in one of all.
        turned: Turn since the start of the period, of line 1 [rad].
    """
    along_step, across_step = math.cos(LANES * turned), math.sin(LANES * turned)
    x, v, a = same_lane(0.0), same_lane(0.0), same_lane(0.0)
    cosines, sines = same_lane(0.0), same_lane(0.0)
    order = lane(words, at + LANES * LANES) + float(lowest)
    for k in range(groups):
        if k % _ANEW == 0:
            cosines, sines = _lanes_of(words, at, (lowest + LANES * k) * turned, turned)
        own = at + _FIRST + 2 * LANES * k
        p, r = lane(words, own), lane(words, own + LANES)
        swing = p * cosines - r * sines
        x = x + swing
        v = v + order * (p * sines + r * cosines)
        a = a + order * (order * swing)
        cosines, sines = (
            cosines * along_step - sines * across_step,
            sines * along_step + cosines * across_step,
        )
        order = order + float(LANES)
    return sum_of_lane(x), -sum_of_lane(v), -sum_of_lane(a)
