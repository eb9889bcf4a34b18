"""A latch that holds by a spring, compiled."""

from __future__ import annotations

import math
from typing import Protocol

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.hook_kernels import Loaded

# Its modes: outside the window; inside, but too fast or the wrong way; held; let go and still inside.
OUTSIDE, INSIDE, HELD, LET_GO = 0, 1, 2, 3


class Window(Protocol):
    """A latch, compliant or rigid, as its capture depends on it; see :class:`PackedLatch`."""

    lower: float
    middle: float
    upper: float
    greatest_rate: float
    greatest_energy: float
    direction: float
    mode: int
    side: float


class PackedLatch(Record):
    """Parameters and state of a latch."""

    lower: float  # start of its window [rad] ([m])
    middle: float  # of its window, where it holds [rad] ([m])
    upper: float  # end of its window [rad] ([m])
    greatest_rate: float  # of a capture [rad/s] ([m/s]), inf: any
    greatest_energy: float  # of a capture [J], inf: any
    direction: float  # of a capture, +1 or -1; 0: both
    stiffness: float  # [N m/rad] ([N/m])
    damping: float  # [N m s/rad] ([N s/m])
    half_play: float  # [rad] ([m])
    holding: float  # torque at which it lets go [N m] ([N]), inf: never
    mode: int  # open or holding
    side: float  # of the window on which the joint is or was, +1: above
    flank: float  # of its play to which it is pressed, 0: none


LAYOUT = layout(PackedLatch)
SIZE = words_of(LAYOUT)


@inlined
def excess(latch: PackedLatch, angle: float) -> float:
    """Return the signed distance of the joint beyond the latch's play; zero inside."""
    off = float(angle - latch.middle)
    if off > latch.half_play:
        return float(off - latch.half_play)
    return float(off + latch.half_play) if off < -latch.half_play else 0.0


@inlined
def held_torque(latch: PackedLatch, angle: float, rate: float) -> float:
    """Return the torque of spring and damper [N m] ([N]).

    With play it is that of the flank under load.

    Where that would pull, the joint comes off it (``switch``); in a trial step beyond, the torque
    goes on as it is, so that steps are smooth.
    """
    if latch.half_play > 0.0 and latch.flank == 0.0:
        return 0.0
    off = angle - latch.middle - latch.flank * latch.half_play
    return float(-latch.stiffness * off - latch.damping * rate)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N]."""
    latch = record(words[at : at + SIZE], LAYOUT)
    return held_torque(latch, angle, rate) if latch.mode == HELD else 0.0


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Power lost [W]: what goes in, but for what the spring stores."""
    latch = record(words[at : at + SIZE], LAYOUT)
    rates[x] = 0.0
    if latch.mode == HELD:
        rates[x] = -power - latch.stiffness * excess(latch, angle) * rate


@inlined
def stored(words: Floats, at: int, angle: float) -> float:
    """Energy stored [J]."""
    latch = record(words[at : at + SIZE], LAYOUT)
    if latch.mode != HELD:
        return 0.0
    off = excess(latch, angle)
    return float(0.5 * latch.stiffness * off * off)


@inlined
def beyond_capture(latch: Window, rate: float, inertia: float) -> float:
    """Return the excess of the rate over the limit of capture [rad/s].

    It is zero or less where the latch captures.

    A latch with a greatest energy asks for the joint's reduced inertia; not-a-number gives not-a-number.
    """
    most = latch.greatest_rate
    if not math.isinf(latch.greatest_energy):
        by_energy = math.sqrt(2.0 * latch.greatest_energy / inertia)
        if not by_energy > most:
            most = by_energy
    if latch.direction == 0.0:
        return float(abs(rate) - most)
    way = latch.direction * rate
    return float(-way if -way > way - most else way - most)


@inlined
def inside(latch: Window, angle: float) -> float:
    """Return the distance of the joint to the window's ends; negative outside."""
    return float(min(angle - latch.lower, latch.upper - angle))


@kernel
def capture(latch: Window, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k of every latch: 0 end of the window, 1 rate of capture."""
    _, angle, rate, inertia = motion
    if k == 0 and latch.mode != HELD:
        if latch.mode == OUTSIDE:
            end = latch.upper if latch.side > 0.0 else latch.lower
            return float(latch.side * (angle - end)), float(latch.side * rate)
        return inside(latch, angle), (rate if angle < latch.middle else -rate)
    if k == 1 and latch.mode == INSIDE:
        return beyond_capture(latch, rate, inertia), 0.0
    return 1.0, 0.0


@inlined
def _flanks(latch: PackedLatch, angle: float, rate: float) -> tuple[float, float]:
    """Return the pressure of a flank, or the distance to one.

    The distance counts also while the flank would pull.
    """
    if latch.mode != HELD or latch.half_play == 0.0:
        return 1.0, 0.0
    if latch.flank != 0.0:
        return float(-latch.flank * held_torque(latch, angle, rate)), 0.0
    off = float(angle - latch.middle)
    outward = float(rate if off > 0.0 else -rate)
    if outward >= 0.0:
        return float(latch.half_play - abs(off)), -outward
    # It has left the flank with that still bent: where it turns back it meets it as the sum comes to push.
    return float(latch.half_play - abs(off) - latch.damping * outward / latch.stiffness), 0.0


@kernel
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 capture, 2 margin to the holding torque, 3 flanks."""
    latch = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate, _ = motion
    if k < 2:
        return capture(latch, k, motion)
    if k == 3:
        return _flanks(latch, angle, rate)
    if latch.mode == HELD and not math.isinf(latch.holding):
        return float(latch.holding - abs(held_torque(latch, angle, rate))), 0.0
    return 1.0, 0.0


@inlined
def mode(words: Floats, at: int) -> int:
    """The present one."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)
