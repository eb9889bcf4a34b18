"""A torque from a function in Python."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.elements.element import Drive

__all__ = ["CallableDrive"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CallableDrive(Drive):
    """A torque from a Python function of time and motion; slower than the others.

    Attributes:
        torque: ``(t [s], angle [rad], rate [rad/s]) -> [N m]``; of a clearance joint the motion angle and its
            rate. The angle counts whole turns.
    """

    kernels: ClassVar[str] = "_given_kernels"
    in_python: ClassVar[bool] = True

    torque: Callable[[float, float, float], float]

    def values(self) -> dict[str, Any]:
        """Return its numbers; the value is written before each evaluation."""
        return {"value": 0.0}

    def given(self, t: float, angle: float, rate: float) -> tuple[float, ...]:
        """Return the numbers of its record at time t [s]."""
        return (self.torque(t, angle, rate),)

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        return "a function in Python"
