"""A prescribed motion, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work
from antenna_pin.elements.term_kernels import course


class PackedMotion(Record):
    """A motion.

    Behind stand coefficients of t^2 and higher powers, then ``terms`` words of its course.
    """

    position: float  # at t = 0 [rad] ([m])
    rate: float  # [rad/s] ([m/s])
    amplitude: float  # of its sine [rad] ([m])
    angular_frequency: float  # [rad/s]
    phase: float  # [rad]
    powers: int  # coefficients behind
    terms: int  # words of the course behind those


LAYOUT = layout(PackedMotion)
SIZE = words_of(LAYOUT)
# Its power is known once the forces of constraint are.
write_rates = write_work


@inlined
def motion(words: Floats, at: int, t: float) -> tuple[float, float, float]:
    """Position, its rate and its acceleration at time t [s]."""
    m = record(words[at : at + SIZE], LAYOUT)
    turned = m.angular_frequency * t + m.phase
    sine, cosine = m.amplitude * math.sin(turned), m.amplitude * math.cos(turned)
    value = slope = bend = 0.0
    for k in range(m.powers - 1, -1, -1):
        # Horner's rule for the polynomial of t that stands behind t^2, with its first two derivatives.
        bend = bend * t + 2.0 * slope
        slope = slope * t + value
        value = value * t + words[at + SIZE + k]
    position = m.position + m.rate * t + value * t * t + sine
    rate = m.rate + (slope * t + 2.0 * value) * t + m.angular_frequency * cosine
    acceleration = (bend * t + 4.0 * slope) * t + 2.0 * value - m.angular_frequency**2 * sine
    start = at + SIZE + m.powers
    if m.terms > 0:
        own = course(words, start, start + m.terms, t)
        position += own[0]
        rate += own[1]
        acceleration += own[2]
    return position, rate, acceleration


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: what holds the motion is a force of constraint."""
    return 0.0
