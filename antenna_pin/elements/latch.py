"""A latch that holds by a spring."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

from antenna_pin.base.parameters import parameter
from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.elements.capture import HELD, Capture, capture
from antenna_pin.elements.element import packed
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.modal import Change, Met

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
        flank: Flank under load, +1 above, -1 below, 0 neither.
    """

    kernels: ClassVar[str] = __name__
    switches: ClassVar[int] = 4
    remembers: ClassVar[tuple[str, ...]] = ("side", "flank")

    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    play: float = parameter("rad", sliding="m", rule="zero or more", default=0.0)

    flank: float = field(default=0.0, repr=False)

    def flank_at(self, angle: float, rate: float) -> float:
        """Return the flank that a held joint is pressed to; 0 for none."""
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

    @packed
    def half_play(self) -> float:
        """Play to either side [rad] ([m])."""
        return 0.5 * self.play

    def words(self, slides: bool = False) -> str:
        """Return the description."""
        named = {"stiffness": "stiffness", "damping": "damping", "play": "play"}
        return "latch " + ", ".join([*self.capture_words(slides), *self.said_of(named, slides)])


# --- compiled -----------------------------------------------------------------------------------------------


@inlined
def excess(latch: Latch, angle: float) -> float:
    """Return the signed distance of the joint beyond the latch's play; zero inside."""
    off = float(angle - latch.angle)
    if off > latch.half_play:
        return float(off - latch.half_play)
    return float(off + latch.half_play) if off < -latch.half_play else 0.0


@inlined
def held_torque(latch: Latch, angle: float, rate: float) -> float:
    """Return the torque of spring and damper [N m] ([N]).

    With play it is that of the flank under load.

    Where that would pull, the joint leaves it (``switch``); in a trial step beyond, the torque
    continues, so that steps are smooth.
    """
    if latch.half_play > 0.0 and latch.flank == 0.0:
        return 0.0
    off = angle - latch.angle - latch.flank * latch.half_play
    return float(-latch.stiffness * off - latch.damping * rate)


@inlined
def effort(latch: Latch, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    return held_torque(latch, angle, rate) if latch.mode == HELD else 0.0


@inlined
def write_rates(latch: Latch, angle: float, rate: float, power: float, rates: Floats, x: int) -> None:
    """Power lost [W]: what goes in, but for what the spring stores."""
    rates[x] = 0.0
    if latch.mode == HELD:
        rates[x] = -power - latch.stiffness * excess(latch, angle) * rate


@inlined
def stored(latch: Latch, angle: float) -> float:
    """Energy stored [J]."""
    if latch.mode != HELD:
        return 0.0
    off = excess(latch, angle)
    return float(0.5 * latch.stiffness * off * off)


@inlined
def _flanks(latch: Latch, angle: float, rate: float) -> tuple[float, float]:
    """Return the pressure of a flank, or the distance to one that would pull."""
    if latch.mode != HELD or latch.half_play == 0.0:
        return 1.0, 0.0
    if latch.flank != 0.0:
        return float(-latch.flank * held_torque(latch, angle, rate)), 0.0
    off = float(angle - latch.angle)
    outward = float(rate if off > 0.0 else -rate)
    if outward >= 0.0:
        return float(latch.half_play - abs(off)), -outward
    # It has left the flank with that still bent: where it turns back it meets it as the sum comes to push.
    return float(latch.half_play - abs(off) - latch.damping * outward / latch.stiffness), 0.0


@kernel
def switch(latch: Latch, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 capture, 2 margin to the holding torque, 3 flanks."""
    _, angle, rate, _ = motion
    if k < 2:
        return capture(latch, k, motion)
    if k == 3:
        return _flanks(latch, angle, rate)
    if latch.mode == HELD and not math.isinf(latch.largest_torque):
        return float(latch.largest_torque - abs(held_torque(latch, angle, rate))), 0.0
    return 1.0, 0.0
