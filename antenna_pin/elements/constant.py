"""A constant torque."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.readable import GIVEN, readable
from antenna_pin.compiled.decorators import inlined
from antenna_pin.elements.element import Drive


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantDrive(Drive):
    """A constant torque, or force at a sliding joint.

    Attributes:
        value: [N*m] ([N]).
    """

    kernels: ClassVar[str] = __name__
    commanded: ClassVar[str] = "value"

    value: float = parameter("N*m", sliding="N")

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return f"constant {readable(self.value, self.unit('value', slides), GIVEN)}"


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def effort(drive: ConstantDrive, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return float(drive.value)
