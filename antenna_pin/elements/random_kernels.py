"""A sum of sines at equal spacing in frequency, compiled: four of them at once."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel, record
from antenna_pin._lanes import LANES, lane, same_lane, sum_of_lane
from antenna_pin.elements.fade_kernels import faded
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.records import layout, words_of

#: Behind it stand the four unit lanes, the lane 0, 1, 2, 3, and then the lines, four by four: a lane of what
#: the displacement has of the cosine, and one of what it has, negated, of the sine.
LAYOUT = layout(("groups", "i8"), ("lowest", "i8"), ("period", "f8"), ("fade_in", "f8"))
SIZE = words_of(LAYOUT)
LINES = SIZE + LANES * LANES + LANES
# Sines and cosines follow from those before by one product each; that often they are computed anew.
_ANEW = 64
# Its power is known once the forces of constraint are.
write_rates = write_work


@inlined
def _lanes_of(words: Any, at: int, first: float, step: float) -> tuple[Any, Any]:
    """Return the cosines and the sines of first, first + step, ... as lanes."""
    cosines, sines = same_lane(0.0), same_lane(0.0)
    for k in range(LANES):
        own = lane(words, at + SIZE + k * LANES)
        cosines = cosines + own * math.cos(first + k * step)
        sines = sines + own * math.sin(first + k * step)
    return cosines, sines


@kernel
def _summed(words: Any, at: int, turned: float) -> tuple[float, float, float]:
    """Position and its first two derivatives by the turn since the period's start [1, 1/rad, 1/rad^2]."""
    m = record(words[at : at + SIZE], LAYOUT)
    along_step, across_step = math.cos(LANES * turned), math.sin(LANES * turned)
    x, v, a = same_lane(0.0), same_lane(0.0), same_lane(0.0)
    cosines, sines = same_lane(0.0), same_lane(0.0)
    order = lane(words, at + SIZE + LANES * LANES) + float(m.lowest)
    for k in range(m.groups):
        if k % _ANEW == 0:
            cosines, sines = _lanes_of(words, at, (m.lowest + LANES * k) * turned, turned)
        own = at + LINES + 2 * LANES * k
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


@inlined
def motion(words: Any, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]."""
    m = record(words[at : at + SIZE], LAYOUT)
    spacing = 2.0 * math.pi / m.period
    turns = t / m.period
    x, v, a = _summed(words, at, 2.0 * math.pi * (turns - math.floor(turns)))
    return faded((x, spacing * v, spacing * spacing * a), t, m.fade_in)


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what holds the motion is a force of constraint."""
    return 0.0
