"""A latch that holds by a spring."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.elements.capture import HELD, Capture
from antenna_pin.elements.modal import Change, Met

__all__ = ["Latch"]

# The function of its flanks.
_FLANKS = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class Latch(Capture):
    r"""A latch that captures a joint and holds it by spring and damper.

    .. math:: \tau = -k\, e - c\, \dot\phi, \qquad
              e = \operatorname{sign}(\phi - \phi_l) \max(|\phi - \phi_l| - \tfrac12 p,\, 0)

    with its own play p. It captures where the joint comes into the window, slows down to the greatest rate
    there or turns to the right way; coming in too fast, or the wrong way, is refused, which is an event too.

    It lets go where an event puts it off (``latches.NAME.on``), and where its torque comes to the holding
    torque; it captures again once the joint has left the window. A start in the window, slow enough, is a
    start held. At a joint with play phi is the motion angle. The angle counts whole turns.

    Attributes:
        stiffness: k [N*m/rad] ([N/m]).
        damping: c [N*m*s/rad] ([N*s/m]).
        play: p, in all, from flank to flank [rad] ([m]).
        flank: Which flank the joint is pressed to, +1 above, -1 below, 0 neither.
    """

    kernels: ClassVar[str] = "latch_kernels"
    switches: ClassVar[int] = 4
    remembers: ClassVar[tuple[str, ...]] = ("side", "flank")

    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    play: float = parameter("rad", sliding="m", rule="zero or more", default=0.0)

    flank: float = field(default=0.0, repr=False)

    def flank_at(self, angle: float, rate: float) -> float:
        """Return the flank that a held joint is pressed to; 0 for none.

        Arguments are in [rad] and [rad/s] ([m] and [m/s]).
        """
        way = 1.0 if angle > self.angle else -1.0
        bent, outward = way * (angle - self.angle) - 0.5 * self.play, way * rate
        pressed = self.stiffness * bent + self.damping * outward
        touches = bent > 0.0 or (bent == 0.0 and outward > 0.0)
        return way if self.play > 0.0 and touches and pressed > 0.0 else 0.0

    def passed(self, k: int, met: Met) -> Change | None:
        """Come to a flank or off it; all else as every latch."""
        if k != _FLANKS:
            return Capture.passed(self, k, met)
        if self.mode != HELD:
            return None
        beyond = 1.0 if met.angle > self.angle else -1.0
        return Change(HELD, memory={"flank": 0.0 if self.flank else beyond})

    def in_another(self, met: Met) -> Change | None:
        """Return the change of flank where joint or latch have been moved."""
        flank = self.flank_at(met.angle, met.rate)
        return Change(HELD, memory={"flank": flank}) if self.mode == HELD and flank != self.flank else None

    def _capture(self, met: Met, what: str) -> Change:
        found = Capture._capture(self, met, what)
        return found._replace(memory={**found.memory, "flank": self.flank_at(met.angle, met.rate)})

    def derived(self) -> dict[str, Any]:
        """Return the packed parameters that are no fields of the element."""
        return Capture.derived(self) | {"half_play": 0.5 * self.play}

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        named = {"stiffness": "stiffness", "damping": "damping", "play": "play"}
        return "latch " + ", ".join([*self.capture_words(slides), *self.said_of(named, slides)])
