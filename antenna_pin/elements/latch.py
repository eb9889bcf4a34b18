"""A latch that holds by a spring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from antenna_pin.elements.capture import Capture
from antenna_pin.parameters import parameter

__all__ = ["Latch"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Latch(Capture):
    r"""A latch that captures a joint in a window and then holds it by a spring and a damper.

    .. math:: \tau = -k\, e - c\, \dot\phi, \qquad
              e = \operatorname{sign}(\phi - \phi_l) \max(|\phi - \phi_l| - \tfrac12 p,\, 0)

    with its own play p, inside of which nothing acts, and whose flanks do not pull. It captures as long as
    the joint is in the window: where the joint comes in, after a rebound, where it slows down to the greatest
    rate, or turns to the right way. Coming in too fast, or the wrong way, is refused, and an event like
    capture and letting go.

    It lets go where an event puts it off (``latches.NAME.on``), and where its torque comes to the holding
    torque; it captures again once the joint has left the window. A start in the window, slow enough, is a
    start held. At a joint with play phi is the motion angle. The angle counts whole turns.

    Attributes:
        stiffness: k [N*m/rad] ([N/m]).
        damping: c [N*m*s/rad] ([N*s/m]).
        play: p, in all, from flank to flank [rad] ([m]).
    """

    kernels: ClassVar[str] = "latch_kernels"

    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    play: float = parameter("rad", sliding="m", rule="zero or more", default=0.0)

    @property
    def has_kinks(self) -> bool:
        """Whether it has flanks, that the joint comes to and leaves while it is held."""
        return self.play > 0.0

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        return self.capture_values() | {
            "stiffness": self.stiffness,
            "damping": self.damping,
            "half_play": 0.5 * self.play,
        }

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        named = {"stiffness": "stiffness", "damping": "damping", "play": "play"}
        return "latch " + ", ".join([*self.capture_words(slides), *self.said_of(named, slides)])
