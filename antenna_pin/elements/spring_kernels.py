"""A spring and damper, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record


class PackedSpring(Record):
    """A spring with damper at a joint."""

    stiffness: float  # [N m/rad] ([N/m])
    damping: float  # [N m s/rad] ([N s/m])
    rest_angle: float  # [rad] ([m])
    shorter_way: int  # 1: deflected at most by half a turn


LAYOUT = layout(PackedSpring)
SIZE = words_of(LAYOUT)


@inlined
def deflection(words: Floats, at: int, angle: float) -> float:
    """Return the angle of the joint from rest.

    It is the shorter way round if the spring has that option.
    """
    spring = record(words[at : at + SIZE], LAYOUT)
    turned = float(angle - spring.rest_angle)
    if spring.shorter_way != 0:
        return turned + 2.0 * math.pi * math.floor(0.5 - turned / (2.0 * math.pi))
    return turned


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    spring = record(words[at : at + SIZE], LAYOUT)
    return float(-spring.stiffness * deflection(words, at, angle) - spring.damping * rate)


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Power that the damper takes [W]."""
    rates[x] = record(words[at : at + SIZE], LAYOUT).damping * rate * rate


@inlined
def stored(words: Floats, at: int, angle: float) -> float:
    """Energy stored [J]."""
    turned = deflection(words, at, angle)
    return float(0.5 * record(words[at : at + SIZE], LAYOUT).stiffness * turned * turned)
