"""A latch that locks a joint rigidly."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any, ClassVar

from antenna_pin.elements.modal import Change, Met, Modal
from antenna_pin.parameters import parameter

__all__ = ["RigidLatch"]

# A rate that is round-off [rad/s] ([m/s]).
_STILL = 1e-11


@dataclass(frozen=True, slots=True, kw_only=True)
class RigidLatch(Modal):
    """A latch that locks its joint where it passes an angle: the rate jumps to zero, and all momentum stays.

    A joint that comes too fast passes, and is tried again each time it comes by. Switched off it lets go.

    Attributes:
        angle: Where it latches [rad] ([m]).
        greatest_rate: At which it still latches [rad/s] ([m/s]); None for any.
        on: Whether it is there from the start on; an event may switch it.
    """

    kernels: ClassVar[str] = "rigid_latch_kernels"
    modes: ClassVar[tuple[str, ...]] = ("free", "latched")
    switches: ClassVar[int] = 1
    remembers: ClassVar[tuple[str, ...]] = ("side", "where")
    holds: ClassVar[bool] = True

    angle: float = parameter("rad", sliding="m")
    greatest_rate: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    on: bool = True
    side: float = field(default=1.0, repr=False)
    where: float = field(default=0.0, repr=False)

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        return {name: getattr(self, name) for name in ("angle", "side", "where", "mode")}

    def first(self, met: Met) -> Change | None:
        """Learn from which side the joint comes; one that rests where it latches is latched."""
        way = met.angle - self.angle
        if way == 0.0 and met.rate == 0.0:
            return Change(1, memory={"where": self.angle})
        return Change(0, memory={"side": math.copysign(1.0, way or met.rate)})

    def passed(self, k: int, met: Met) -> Change | None:
        """Latch, or let pass what is too fast."""
        if self.side * met.rate > _STILL:
            return None
        if self.greatest_rate is not None and abs(met.rate) > self.greatest_rate:
            return Change(0, "too fast", {"side": -self.side})
        return Change(1, "latched", {"where": met.angle})

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        fast = "" if self.greatest_rate is None else f", up to {self.said('greatest_rate', slides)}"
        return f"rigid latch at {self.said('angle', slides)}{fast}"
