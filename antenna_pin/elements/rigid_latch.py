"""A latch that locks its joint."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.elements.capture import HELD, OUTSIDE, Capture, capture
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.modal import Change, Met, Remembered


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidLatch(Capture):
    r"""A latch that captures a joint in a window and locks it there at once.

    .. math:: \Delta E = \tfrac12 I_r\, \dot\phi^2

    is lost, with the reduced inertia I_r of what is on both sides of the joint: an impulse that keeps all
    momentum. When it captures and lets go is as for :class:`Latch`; its torque is that of the row that holds
    the joint.

    Attributes:
        held_at: Held angle of the joint [rad] ([m]).
    """

    kernels: ClassVar[str] = __name__
    loaded: ClassVar[tuple[int, ...]] = (2,)
    remembers: ClassVar[tuple[str, ...]] = ("side", "held_at")
    goes_by: ClassVar[Mapping[str, Remembered]] = {"held_at": "way"}
    goes_by_in: ClassVar[tuple[int, ...]] = (HELD,)
    holds: ClassVar[bool] = True

    held_at: float = field(default=0.0, repr=False)

    def initial_change(self, met: Met) -> Change | None:
        """Return the mode at the start; a moving joint is captured before the run."""
        found = Capture.initial_change(self, met)
        if found is not None and found.mode == HELD and met.rate != 0.0:
            return Change(OUTSIDE, memory=self._side(met))
        return found

    def _capture(self, met: Met, what: str) -> Change:
        return Capture._capture(self, met, what)._replace(memory={**self._side(met), "held_at": met.angle})

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        return "rigid latch " + ", ".join(self.capture_words(slides))


# --- compiled -----------------------------------------------------------------------------------------------


@kernel
def switch(latch: RigidLatch, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 capture, 2 margin of the row to the holding torque."""
    _, angle, rate, load = motion
    if k < 2:
        return capture(latch, k, motion)
    if latch.mode == HELD and not math.isinf(latch.largest_torque):
        return float(latch.largest_torque - abs(load)), 0.0
    return 1.0, 0.0


@inlined
def hold(latch: RigidLatch) -> tuple[bool, float]:
    """Return whether the joint is held, and the position."""
    return latch.mode == HELD, float(latch.held_at)
