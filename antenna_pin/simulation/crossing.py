"""What is known of where an event's function passes zero, and what an event remembers."""

from __future__ import annotations

import math
from typing import NamedTuple

__all__ = ["Bracket", "Crossing", "Looks", "Memory"]


class Crossing(NamedTuple):
    """Where an event's function passes zero.

    Attributes:
        event: Number of the event.
        theta: At which fraction of the trial step.
        side: The sign that it has passed to, if it has done so already; 0 if it is zero there.
        slope: Of the function there, per second; 0 if it has none.
        noise: What it may be off by there.
        until: Up to which fraction the event is known to do nothing else.
    """

    event: int
    theta: float
    side: float = 0.0
    slope: float = 0.0
    noise: float = 0.0
    until: float = math.inf


class Bracket(NamedTuple):
    """Where an event's function passes zero: between two fractions of a trial step, with its values there.

    Further what it may be off by, up to which fraction the event does nothing else, and the side it has
    passed to, if it has done so already.
    """

    event: int
    a: float
    b: float
    fa: float
    fb: float
    noise: float
    until: float
    side: float = 0.0

    @property
    def guess(self) -> float:
        """About where."""
        return (
            self.a + (self.b - self.a) * self.fa / (self.fa - self.fb) if self.fa * self.fb < 0.0 else self.a
        )


class Looks(NamedTuple):
    """A function at some fractions of a trial step: its values and rates there."""

    thetas: list[float]
    values: list[float]
    rates: list[float]

    def stays(self, i: int, side: float) -> float:
        """Return up to which fraction it stays on the side that it has come to in the i-th part."""
        for j in range(i + 1, len(self.thetas)):
            back = side * self.rates[j - 1] < 0.0 < side * self.rates[j]
            if not side * self.values[j] > 0.0 or back:
                return self.thetas[j - 1]
        return math.inf


class Memory:
    """What one event remembers, in use (see :class:`EventMemory`)."""

    __slots__ = ("count", "last", "noise", "side")

    def __init__(self) -> None:
        """Begin with an event that has never happened."""
        self.count = 0
        self.last = -math.inf
        self.side = self.noise = 0.0

    def sign(self, value: float) -> float:
        """Return the side that a value tells of: 0 if none."""
        if not abs(value) > (self.noise if self.side == 0.0 else 0.0):  # nor does NaN
            return 0.0
        return math.copysign(1.0, value)
