"""An end stop that gives way, compiled: one or two sides, each a contact with the angle as its depth."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import inlined, kernel, record
from antenna_pin.contact.kernels import NORMAL_SIZE, elastic_energy, elastic_force, normal_force
from antenna_pin.records import layout, words_of

# Its modes: off both sides, on the lower one, on the upper one.
FREE, LOWER, UPPER = 0, 1, 2

#: Limits (infinite where there is none), least approach rate, mass or inertia of laws that ask for one, mode
#: and rate of approach at the onset of the present touch. Behind it stands the law.
LAYOUT = layout(
    ("lower", "f8"),
    ("upper", "f8"),
    ("least_rate", "f8"),
    ("inertia", "f8"),
    ("mode", "i8"),
    ("approach", "f8"),
)
SIZE = words_of(LAYOUT)


@inlined
def depth(stop: Any, angle: float) -> float:
    """How far the joint is pressed into the side that it touches; beyond none it is zero."""
    if stop.mode == LOWER:
        return float(stop.lower - angle)
    if stop.mode == UPPER:
        return float(angle - stop.upper)
    return 0.0


@inlined
def way(stop: Any) -> float:
    """Direction into the side that it touches: -1 lower, +1 upper, 0 neither."""
    if stop.mode == LOWER:
        return -1.0
    return 1.0 if stop.mode == UPPER else 0.0


@kernel
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N], out of the stop; never into it."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if stop.mode == FREE:
        return 0.0
    law = words[at + SIZE : at + SIZE + NORMAL_SIZE]
    sign = way(stop)
    return float(
        -sign * normal_force(law, depth(stop, angle), sign * rate, max(stop.approach, stop.least_rate), stop.inertia)
    )


@kernel
def write_rates(words: Any, at: int, angle: float, rate: float, power: float, rates: Any, x: int) -> None:
    """Power lost [W]: what goes in, but for what the elastic part stores."""
    stop = record(words[at : at + SIZE], LAYOUT)
    rates[x] = 0.0
    if stop.mode != FREE:
        law = words[at + SIZE : at + SIZE + NORMAL_SIZE]
        rates[x] = -power - elastic_force(law, depth(stop, angle)) * way(stop) * rate


@kernel
def stored(words: Any, at: int, angle: float) -> float:
    """Energy stored [J]."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if stop.mode == FREE:
        return 0.0
    return elastic_energy(words[at + SIZE : at + SIZE + NORMAL_SIZE], depth(stop, angle))


@inlined
def margin(words: Any, at: int, t: float, angle: float, rate: float) -> tuple[float, float]:
    """How far its mode is from its end, positive as long as it lasts, and the rate of that."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if stop.mode == LOWER:
        return stop.lower - angle, -rate
    if stop.mode == UPPER:
        return angle - stop.upper, rate
    below, above = angle - stop.lower, stop.upper - angle
    return (below, rate) if below < above else (above, -rate)


@kernel
def switch(words: Any, at: int, t: float, angle: float, rate: float) -> None:
    """Write the mode that begins where the present one ends, and the rate at which it begins."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if stop.mode != FREE:
        stop.mode, stop.approach = FREE, 0.0
    elif angle - stop.lower < stop.upper - angle:
        stop.mode, stop.approach = LOWER, max(-rate, 0.0)
    else:
        stop.mode, stop.approach = UPPER, max(rate, 0.0)
