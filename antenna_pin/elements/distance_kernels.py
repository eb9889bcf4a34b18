"""The length of a leg to a point that moves along a path, compiled."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.motion_kernels import effort

__all__ = ["LAYOUT", "effort", "motion", "write_rates"]

LAYOUT = layout(
    ("centre", "f8", (3,)),
    ("speed", "f8", (3,)),
    ("amplitude", "f8", (3,)),
    ("phase", "f8", (3,)),
    ("angular_frequency", "f8"),
)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def motion(words: Any, at: int, t: float) -> tuple[float, float, float]:
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
