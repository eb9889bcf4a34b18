"""The power of the depth, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Record
from antenna_pin.compiled.decorators import inlined
from antenna_pin.contact.records import elastic_record


class PowerLaw(Record):
    """A power of the depth."""

    stiffness: float  # K [N/m^n]
    exponent: float  # n [-]


POWER_LAW = elastic_record(PowerLaw)


@inlined
def power(depth: float, exponent: float) -> float:
    """``depth**exponent``, continued to negative depth where the exponent is an integer, else zero there.

    The continuation lets an integrator step smoothly across the end of a contact before that end is
    located; no accepted state lies beyond it.
    """
    if depth > 0.0:
        if exponent == 1.5:
            return depth * math.sqrt(depth)
        if exponent == 1.0:
            return depth
        return float(depth**exponent)
    whole = math.floor(exponent)
    if whole != exponent:
        return 0.0
    size = float((-depth) ** exponent)
    return size if whole % 2.0 == 0.0 else -size
