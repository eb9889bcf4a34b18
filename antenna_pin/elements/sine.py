"""A torque that swings."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, number
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.course import Swing
from antenna_pin.elements.element import Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class SineDrive(Swing, Drive):
    """The torque or force ``amplitude * sin(2 pi frequency t + phase)``.

    Attributes:
        amplitude: [N*m] ([N]).
        frequency: [Hz].
        phase: [rad].
    """

    kernels: ClassVar[str] = __name__

    amplitude: float = parameter("N*m", sliding="N")
    frequency: float = parameter("Hz", rule="positive")
    phase: float = parameter("rad", default=0.0)

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        phase = f" + {self.text_of('phase', slides)}" if self.phase else ""
        frequency = number(self.frequency, GIVEN)
        return f"{self.text_of('amplitude', slides)} × sin(2π · {frequency} Hz · t{phase})"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def effort(sine: SineDrive, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return float(sine.amplitude * math.sin(sine.angular_frequency * t + sine.phase))
