"""A rigid end stop, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, record
from antenna_pin.records import layout, words_of

#: Where the stops are (infinite: none), and the mode.
LAYOUT = layout(("lower", "f8"), ("upper", "f8"), ("mode", "i8"))
SIZE = words_of(LAYOUT)
# Modes: away from both, resting on one.
FREE = 0
LOWER = 1
UPPER = 2


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what a stop carries is a force of constraint, or an impulse."""
    return 0.0


@inlined
def write_rates(words: Any, at: int, rate: float, power: float, rates: Any, x: int) -> None:
    """Nothing: what it takes it takes in impulses."""
    rates[x] = 0.0


@inlined
def mode(words: Any, at: int) -> int:
    """Return the present mode."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)


@inlined
def hold(words: Any, at: int) -> tuple[bool, float]:
    """Whether the joint rests on a stop, and where that is."""
    stop = record(words[at : at + SIZE], LAYOUT)
    return stop.mode != FREE, float(stop.lower if stop.mode == LOWER else stop.upper)


@inlined
def switch(words: Any, at: int, k: int, motion: Any) -> tuple[float, float]:
    """Way to the upper stop, to the lower one, and what presses on the one that the joint rests on."""
    stop = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate, load = motion
    if k < 2:
        if stop.mode != FREE or math.isinf(stop.upper if k == 0 else stop.lower):
            return 1.0, 0.0
        if k == 0:
            return float(stop.upper - angle), float(-rate)
        return float(angle - stop.lower), float(rate)
    if stop.mode == FREE:
        return 1.0, 0.0
    return float(load if stop.mode == LOWER else -load), 0.0
