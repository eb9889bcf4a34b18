"""Intervals of tilts between the axes of journal and bearing."""

from __future__ import annotations

import math
from dataclasses import dataclass

__all__ = ["UPRIGHT", "TiltRange", "milliradians"]

#: A journal square to its bearing [rad].
UPRIGHT = 0.5 * math.pi


def milliradians(tilt: float) -> str:
    """Return a tilt [rad] as text in mrad, without the unit."""
    return f"{1e3 * tilt:.4g}"


@dataclass(frozen=True, slots=True)
class TiltRange:
    """An interval of tilts between the axes of journal and bearing.

    Attributes:
        low: [rad].
        high: [rad].
        open_low: Whether ``low`` itself is left out.
        open_high: Whether ``high`` itself is left out.
    """

    low: float
    high: float
    open_low: bool = False
    open_high: bool = False

    @property
    def empty(self) -> bool:
        """Whether it holds no tilt."""
        return self.low > self.high or (self.low == self.high and (self.open_low or self.open_high))

    def intersection(self, other: TiltRange) -> TiltRange:
        """Return the tilts that both hold."""
        low, high = max(self.low, other.low), min(self.high, other.high)
        sides = (self, other)
        return TiltRange(
            low,
            high,
            any(side.low == low and side.open_low for side in sides),
            any(side.high == high and side.open_high for side in sides),
        )

    @property
    def typical(self) -> float:
        """A tilt inside: the lower end where it belongs to the interval, else the middle [rad]."""
        return 0.5 * (self.low + self.high) if self.open_low else self.low

    def __str__(self) -> str:
        """Return the interval in mrad."""
        if self.empty:
            return "none"
        if self.low == self.high:
            return milliradians(self.low)
        ends = "(" if self.open_low else "[", ")" if self.open_high else "]"
        high = "90 deg" if self.high == UPRIGHT else milliradians(self.high)
        return f"{ends[0]}{milliradians(self.low)}, {high}{ends[1]}"
