"""A spring with hysteresis after Bouc and Wen, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.hook_kernels import Motion, Own, Powered


class PackedBoucWen(Record):
    """A spring with hysteresis."""

    alpha: float  # share of the stiffness that is elastic
    stiffness: float  # [N m/rad] ([N/m])
    yield_angle: float  # [rad] ([m])
    slope: float  # A, of z over the angle at z = 0, in yield angles
    beta: float  # shape of the loop
    gamma: float  # shape of the loop
    exponent: float  # n
    rest_angle: float  # [rad] ([m])
    start: float  # z at the start


LAYOUT = layout(PackedBoucWen)
SIZE = words_of(LAYOUT)
# Among what it integrates.
HEAT = 0
Z = 1


@inlined
def effort_of(words: Floats, at: int, motion: Motion, own: Own) -> float:
    """Torque [N m], or force [N]."""
    law = record(words[at : at + SIZE], LAYOUT)
    _, angle, _ = motion
    y, i = own
    z = law.start + y[i + Z]
    elastic = law.alpha * law.stiffness * (angle - law.rest_angle)
    return float(-elastic - (1.0 - law.alpha) * law.stiffness * law.yield_angle * z)


@inlined
def write_rates_of(words: Floats, at: int, motion: Powered, own: Own, rates: Floats, x: int) -> None:
    """Power that is lost [W], and the rate of z [1/s]."""
    law = record(words[at : at + SIZE], LAYOUT)
    _, rate, _ = motion
    y, i = own
    z = law.start + y[i + Z]
    size = math.pow(abs(z), law.exponent)
    sign = math.copysign(1.0, z)
    yields = size * (law.beta * abs(rate) * sign + law.gamma * rate)
    rates[x + Z] = (law.slope * rate - yields) / law.yield_angle
    rates[x + HEAT] = (1.0 - law.alpha) * law.stiffness * law.yield_angle * z * yields / law.slope


@inlined
def stored_of(words: Floats, at: int, angle: float, own: Own) -> float:
    """Energy stored [J]."""
    law = record(words[at : at + SIZE], LAYOUT)
    y, i = own
    z = law.yield_angle * (law.start + y[i + Z])
    turned = angle - law.rest_angle
    elastic = law.alpha * turned * turned + (1.0 - law.alpha) * z * z / law.slope
    return float(0.5 * law.stiffness * elastic)


@inlined
def kink_of(words: Floats, at: int, k: int, motion: Motion, own: Own) -> float:
    """Return the rate (k = 0) or z (1), zero at kinks.

    Where the joint turns back the rate of z changes; it depends on the size of z.
    """
    if k == 0:
        return float(motion[2])
    y, i = own
    return float(record(words[at : at + SIZE], LAYOUT).start + y[i + Z])
