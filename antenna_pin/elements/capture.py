"""Base of latches: capture of a joint, and release."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar, Literal

from antenna_pin.base.parameters import parameter
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.elements.element import packed
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.modal import CAPTURE, Change, Met, ModalElement

Direction = Literal["both", "up", "down"]
_WAYS: dict[Direction, float] = {"both": 0.0, "up": 1.0, "down": -1.0}

# Modes: outside the window; inside, but too fast or the wrong way; held; let go and still inside.
OUTSIDE, INSIDE, HELD, LET_GO = 0, 1, 2, 3
# Its functions: the ends of the window, the rates that it captures at, the holding torque.
_WINDOW, _RATES, _HOLDING = 0, 1, 2
# An angle, or a rate, that is round-off of one.
_STILL = 1e-11


@dataclass(frozen=True, slots=True, kw_only=True)
class Capture(ModalElement):
    """Base of the latches.

    Attributes:
        angle: Held angle, the middle of the window [rad] ([m]).
        width: The window from its middle to either end; zero for the angle alone [rad] ([m]).
        greatest_rate: Largest rate of a capture [rad/s] ([m/s]); None for any rate.
        greatest_energy: Largest energy of a capture, half the reduced inertia at the joint times the rate
            squared [J]; None for any energy.
        direction: Required direction of the joint, unless it is at rest.
        holding_torque: Torque of release [N*m] ([N]); None if never.
        switches_off: Elements switched off by the capture, such as ``springs.deployment``.
        on: Whether it is armed from the start on; an event may switch it: off, it lets go.
        side: On which side of the window it is, or was, +1 above, -1 below.
    """

    modes: ClassVar[tuple[str, ...]] = ("outside", "inside", "held", "let go")
    change_names: ClassVar[Mapping[str, tuple[str, ...]]] = {
        "capture": ("latched",),
        "refusal": ("refused",),
        "release": ("let go",),
    }
    switches: ClassVar[int] = 3
    weighs: ClassVar[bool] = True
    remembers: ClassVar[tuple[str, ...]] = ("side",)

    angle: float = parameter("rad", sliding="m")
    width: float = parameter("rad", sliding="m", rule="zero or more", default=0.0)
    greatest_rate: float | None = parameter("rad/s", sliding="m/s", rule="positive", default=None)
    greatest_energy: float | None = parameter("J", rule="positive", default=None)
    direction: Direction = "both"
    holding_torque: float | None = parameter("N*m", sliding="N", rule="positive", default=None)
    switches_off: tuple[str, ...] = ()
    on: bool = True
    side: float = field(default=-1.0, repr=False)

    @packed
    def window(self) -> tuple[float, float]:
        """Position of capture [rad] ([m])."""
        return self.angle - self.width, self.angle + self.width

    def facts(self) -> dict[str, float]:
        """Return where it holds, and its window."""
        lower, upper = self.window
        return {"angle": float(self.angle), "lower": float(lower), "upper": float(upper)}

    @property
    def weighed(self) -> tuple[int, ...]:
        """Return the functions that need the joint's reduced inertia."""
        return () if self.greatest_energy is None else (1,)

    def captures(self, met: Met) -> bool:
        """Return whether a joint in the window is captured as it moves."""
        way = _WAYS[self.direction] * met.rate if self.direction != "both" else abs(met.rate)
        slow = self.greatest_rate is None or way <= self.greatest_rate
        return 0.0 <= way and slow and (self.greatest_energy is None or met.energy <= self.greatest_energy)

    def initial_change(self, met: Met) -> Change | None:
        """Return where the joint starts: beside the window, in it, or held there."""
        lower, upper = self.window
        side = self._side(met)
        if not lower <= met.angle <= upper:
            return Change(OUTSIDE, memory=side)
        if self.greatest_energy is not None and met.rate != 0.0:
            return Change(OUTSIDE, memory=side)  # it comes in before the run begins, and is weighed then
        return self._capture(met, "") if self.captures(met) else Change(INSIDE, memory=side)

    def passed(self, k: int, met: Met) -> Change | None:
        """Return the change at the window (0), the rate (1), or of a release (2)."""
        if self.mode == HELD:
            return self.lets_go_with(met) if k == _HOLDING else None
        if k == _RATES:  # slow enough now, but for round-off
            return self._capture(met, "latched") if self.mode == INSIDE else None
        if k != _WINDOW:
            return None
        if self.mode == OUTSIDE:
            if self.captures(met):
                return self._capture(met, "latched")
            if self.width == 0.0:
                return Change(OUTSIDE, "refused", {"side": -self.side}, phase=CAPTURE)
            return Change(INSIDE, "refused", phase=CAPTURE)
        return Change(OUTSIDE, memory=self._side(met))

    def lets_go_with(self, met: Met) -> Change:
        """Return the change of a release: still inside, or outside without width.

        It is then on the side where it stands; at the angle itself on that to which it goes, or is drawn.
        """
        if self.width > 0.0:
            return Change(LET_GO, "let go")
        ways = (met.angle - self.angle, met.rate, -met.load)
        way = next((one for one in ways[:2] if abs(one) > _STILL), ways[2])
        return Change(OUTSIDE, "let go", {"side": math.copysign(1.0, way)})

    def armed(self, met: Met) -> Change | None:
        """Learn on which side the joint is."""
        return Change(OUTSIDE, memory=self._side(met))

    def _side(self, met: Met) -> dict[str, float]:
        return {"side": -1.0 if met.angle < self.angle else 1.0}

    def _capture(self, met: Met, what: str) -> Change:
        return Change(HELD, what, self._side(met), switches_off=self.switches_off, phase=CAPTURE)

    @packed
    def rate_limit(self) -> float:
        """Greatest rate of a capture, infinity for any [rad/s] ([m/s])."""
        return math.inf if self.greatest_rate is None else self.greatest_rate

    @packed
    def energy_limit(self) -> float:
        """Greatest energy of a capture, infinity for any [J]."""
        return math.inf if self.greatest_energy is None else self.greatest_energy

    @packed
    def capture_way(self) -> float:
        """Sign of the rate of a capture; 0 for both."""
        return _WAYS[self.direction]

    @packed
    def largest_torque(self) -> float:
        """Torque at which it lets go, infinity for never [N*m] ([N])."""
        return math.inf if self.holding_torque is None else self.holding_torque

    def capture_words(self, slides: bool) -> list[str]:
        """Return in words when it captures."""
        told = [f"at {self.text_of('angle', slides)}"]
        if self.width:
            told.append(f"window {self.text_of('width', slides)} to either side")
        most = [
            self.text_of(name, slides)
            for name in ("greatest_rate", "greatest_energy")
            if getattr(self, name) is not None
        ]
        if most:
            told.append(f"captures up to {' and '.join(most)}")
        if self.direction != "both":
            told.append(f"on the way {self.direction}")
        if self.holding_torque is not None:
            told.append(f"lets go at {self.text_of('holding_torque', slides)}")
        return told


@inlined
def beyond_capture(latch: Capture, rate: float, inertia: float) -> float:
    """Return the excess of the rate over the limit of capture [rad/s].

    It is zero or less where the latch captures.

    A latch with a greatest energy needs the joint's reduced inertia; NaN gives NaN.
    """
    most = latch.rate_limit
    if not math.isinf(latch.energy_limit):
        by_energy = math.sqrt(2.0 * latch.energy_limit / inertia)
        if not by_energy > most:
            most = by_energy
    if latch.capture_way == 0.0:
        return float(abs(rate) - most)
    way = latch.capture_way * rate
    return float(-way if -way > way - most else way - most)


@inlined
def inside(latch: Capture, angle: float) -> float:
    """Return the distance of the joint to the window's ends; negative outside."""
    return float(min(angle - latch.window[0], latch.window[1] - angle))


@kernel
def capture(latch: Capture, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k of every latch: 0 end of the window, 1 rate of capture."""
    _, angle, rate, inertia = motion
    if k == 0 and latch.mode != HELD:
        if latch.mode == OUTSIDE:
            end = latch.window[1] if latch.side > 0.0 else latch.window[0]
            return float(latch.side * (angle - end)), float(latch.side * rate)
        return inside(latch, angle), (rate if angle < latch.angle else -rate)
    if k == 1 and latch.mode == INSIDE:
        return beyond_capture(latch, rate, inertia), 0.0
    return 1.0, 0.0
