"""A spring and damper between two points, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record


class PackedPointSpring(Record):
    """A spring with damper between two points."""

    stiffness: float  # [N/m]
    damping: float  # [N s/m]
    free_length: float  # [m]


LAYOUT = layout(PackedPointSpring)
SIZE = words_of(LAYOUT)


@inlined
def tension(words: Floats, at: int, length: float, rate: float) -> float:
    """Return the force that draws the points together [N].

    Arguments are the distance [m] and its rate [m/s].
    """
    spring = record(words[at : at + SIZE], LAYOUT)
    return float(spring.stiffness * (length - spring.free_length) + spring.damping * rate)


@inlined
def loss(words: Floats, at: int, rate: float) -> float:
    """Power that the damper takes [W]."""
    return float(record(words[at : at + SIZE], LAYOUT).damping * rate * rate)


@inlined
def stored(words: Floats, at: int, length: float) -> float:
    """Energy stored [J]."""
    spring = record(words[at : at + SIZE], LAYOUT)
    stretch = length - spring.free_length
    return float(0.5 * spring.stiffness * stretch * stretch)
