"""A torque that swings, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.ledger_kernels import write_work


class PackedSine(Record):
    """A sinusoidal effort."""

    amplitude: float  # [N m] ([N])
    angular_frequency: float  # [rad/s]
    phase: float  # [rad]


LAYOUT = layout(PackedSine)
SIZE = words_of(LAYOUT)
write_rates = write_work


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    sine = record(words[at : at + SIZE], LAYOUT)
    return float(sine.amplitude * math.sin(sine.angular_frequency * t + sine.phase))
