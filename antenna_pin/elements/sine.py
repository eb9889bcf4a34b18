"""A torque that swings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.elements.element import Drive
from antenna_pin.parameters import parameter
from antenna_pin.readable import GIVEN, number, readable

__all__ = ["SineDrive"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SineDrive(Drive):
    """The torque, or force at a sliding joint, ``amplitude * sin(2 pi frequency t + phase)``.

    Attributes:
        amplitude: [N*m] ([N]).
        frequency: [Hz].
        phase: [rad].
    """

    kernels: ClassVar[str] = "sine_kernels"

    amplitude: float = parameter("N*m", sliding="N")
    frequency: float = parameter("Hz", rule="positive")
    phase: float = parameter("rad", default=0.0)

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        omega = 2.0 * math.pi * self.frequency
        return {"amplitude": self.amplitude, "angular_frequency": omega, "phase": self.phase}

    @property
    def longest_step(self) -> float:
        """An eighth of the period [s]."""
        return 0.125 / self.frequency

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        phase = f" + {readable(self.phase, 'rad', GIVEN)}" if self.phase else ""
        amplitude = readable(self.amplitude, self.unit("amplitude", slides), GIVEN)
        return f"{amplitude} × sin(2π · {number(self.frequency, GIVEN)} Hz · t{phase})"
