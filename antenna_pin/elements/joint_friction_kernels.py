"""Friction of a joint, viscous and Coulomb's, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record


class PackedJointFriction(Record):
    """Viscous and Coulomb friction."""

    damping: float  # [N m s/rad] ([N s/m])
    friction: float  # Coulomb's [N m] ([N])
    regularisation_speed: float  # [rad/s] ([m/s])


LAYOUT = layout(PackedJointFriction)
SIZE = words_of(LAYOUT)


@inlined
def resistance(words: Floats, at: int, rate: float) -> float:
    """Torque [N m], or force [N], against the rate."""
    law = record(words[at : at + SIZE], LAYOUT)
    size = math.sqrt(rate * rate + law.regularisation_speed * law.regularisation_speed)
    return float(law.damping * rate + law.friction * rate / size)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return -resistance(words, at, rate)


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Power that it takes [W]."""
    rates[x] = resistance(words, at, rate) * rate
