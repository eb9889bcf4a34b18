"""The length of a leg to a point that moves along a path, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, Vector3, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.motion_kernels import effort

__all__ = ["LAYOUT", "effort", "motion", "write_rates"]


class PackedDistance(Record):
    """The path of a point, seen from a leg's foot."""

    centre: Vector3  # at t = 0 [m]
    speed: Vector3  # [m/s]
    amplitude: Vector3  # of a sine along each axis [m]
    phase: Vector3  # of each [rad]
    angular_frequency: float  # of all [rad/s]


LAYOUT = layout(PackedDistance)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def motion(words: Floats, at: int, t: float) -> tuple[float, float, float]:
    """Distance, its rate and its acceleration at time t [s]."""
    m = record(words[at : at + SIZE], LAYOUT)
    omega = m.angular_frequency
    # r.r, r.r', r'.r' + r.r''.
    square = along = bend = 0.0
    for k in range(3):
        turned = omega * t + m.phase[k]
        sine, cosine = m.amplitude[k] * math.sin(turned), m.amplitude[k] * math.cos(turned)
        way = m.centre[k] + m.speed[k] * t + sine
        rate = m.speed[k] + omega * cosine
        square += way * way
        along += way * rate
        bend += rate * rate - way * omega * omega * sine
    distance = math.sqrt(square)
    speed = along / distance
    return distance, speed, (bend - speed * speed) / distance
