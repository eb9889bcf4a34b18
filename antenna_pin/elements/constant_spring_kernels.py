"""A spring of constant torque, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record


class PackedConstantSpring(Record):
    """A constant torque between ends."""

    torque: float  # [N m] ([N])
    lower: float  # end [rad] ([m]), -inf: none
    upper: float  # end [rad] ([m]), inf: none
    ramp: float  # way beyond an end over which the torque fades [rad] ([m])


LAYOUT = layout(PackedConstantSpring)
SIZE = words_of(LAYOUT)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    spring = record(words[at : at + SIZE], LAYOUT)
    beyond = max(spring.lower - angle, angle - spring.upper, 0.0) / spring.ramp
    return float(spring.torque * max(1.0 - beyond, 0.0))


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Nothing is lost."""
    rates[x] = 0.0


@inlined
def _way(lower: float, upper: float, ramp: float, angle: float) -> float:
    """Return the integral of the active share of the torque, but for a constant."""
    found = min(angle, upper)
    if not math.isinf(lower):
        s = min(max(1.0 - (lower - angle) / ramp, 0.0), 1.0)
        found = 0.5 * ramp * s * s + max(found - lower, 0.0)
    if not math.isinf(upper):
        s = min(max((angle - upper) / ramp, 0.0), 1.0)
        found += ramp * s * (1.0 - 0.5 * s)
    return found


@inlined
def stored(words: Floats, at: int, angle: float) -> float:
    """Return the energy stored [J]: work from here to the end, or to angle zero."""
    spring = record(words[at : at + SIZE], LAYOUT)
    lower, upper, ramp = float(spring.lower), float(spring.upper), float(spring.ramp)
    if spring.torque > 0.0 and not math.isinf(upper):
        end = _way(lower, upper, ramp, upper + ramp)
    elif spring.torque < 0.0 and not math.isinf(lower):
        end = 0.0  # below its ramp
    else:
        end = _way(lower, upper, ramp, 0.0)
    return float(spring.torque * (end - _way(lower, upper, ramp, angle)))


@inlined
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Product of the ways to where its ramps begin and end."""
    spring = record(words[at : at + SIZE], LAYOUT)
    found = 1.0
    if not math.isinf(spring.lower):
        found *= (angle - spring.lower) * (angle - spring.lower + spring.ramp)
    if not math.isinf(spring.upper):
        found *= (angle - spring.upper) * (angle - spring.upper - spring.ramp)
    return float(found)
