"""A latch that holds by a spring."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from antenna_pin.elements.element import LOSS, Element, Integral
from antenna_pin.errors import InvalidParameterError
from antenna_pin.parameters import parameter

__all__ = ["Latch"]

Direction = Literal["both", "up", "down"]
_WAYS: dict[Direction, float] = {"both": 0.0, "up": 1.0, "down": -1.0}


@dataclass(frozen=True, slots=True, kw_only=True)
class Latch(Element):
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
        angle: phi_l, where it holds, in the middle of the window [rad] ([m]).
        width: The window from its middle to either end [rad] ([m]).
        greatest_rate: Up to which it captures [rad/s] ([m/s]); None for any rate.
        direction: The way that the joint must go, or be at rest, to be captured.
        stiffness: k [N*m/rad] ([N/m]).
        damping: c [N*m*s/rad] ([N*s/m]).
        play: p, in all, from flank to flank [rad] ([m]).
        holding_torque: At which it lets go [N*m] ([N]); None if never.
        on: Whether it is armed from the start on; an event may switch it: off, it lets go.
    """

    kernels: ClassVar[str] = "latch_kernels"
    senses: ClassVar[bool] = True
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)
    modes: ClassVar[tuple[str, ...]] = ("outside", "inside", "held", "let go")

    angle: float = parameter("rad", sliding="m")
    width: float = parameter("rad", sliding="m", rule="positive")
    greatest_rate: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    direction: Direction = "both"
    stiffness: float = parameter("N*m/rad", sliding="N/m", rule="positive")
    damping: float = parameter("N*m*s/rad", sliding="N*s/m", rule="zero or more", default=0.0)
    play: float = parameter("rad", sliding="m", rule="zero or more", default=0.0)
    holding_torque: float | None = parameter("N*m", sliding="N", rule="positive", default=None)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters, and that play and window fit."""
        Element.__post_init__(self)
        if self.play >= 2.0 * self.width:
            rule = f"below twice the width, {2.0 * self.width:g}; else it captures where it does not hold"
            raise InvalidParameterError(self, "play", rule, self.play)

    @property
    def window(self) -> tuple[float, float]:
        """Where it captures [rad] ([m])."""
        return self.angle - self.width, self.angle + self.width

    def values(self) -> dict[str, Any]:
        """Return its numbers, by the names that its record has for them."""
        lower, upper = self.window
        return {
            "lower": lower,
            "upper": upper,
            "angle": self.angle,
            "greatest_rate": math.inf if self.greatest_rate is None else self.greatest_rate,
            "direction": _WAYS[self.direction],
            "stiffness": self.stiffness,
            "damping": self.damping,
            "half_play": 0.5 * self.play,
            "holding": math.inf if self.holding_torque is None else self.holding_torque,
            "mode": 0,
        }

    def words(self, slides: bool) -> str:
        """Return what it is in words."""
        told = [f"latch at {self.said('angle', slides)}, window {self.said('width', slides)} to either side"]
        if self.greatest_rate is not None:
            told.append(f"captures up to {self.said('greatest_rate', slides)}")
        if self.direction != "both":
            told.append(f"on the way {self.direction}")
        named = {"stiffness": "stiffness", "damping": "damping", "play": "play"}
        told += self.said_of(named, slides)
        if self.holding_torque is not None:
            told.append(f"lets go at {self.said('holding_torque', slides)}")
        return ", ".join(told)
