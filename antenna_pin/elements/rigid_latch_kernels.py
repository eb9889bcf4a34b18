"""A latch that locks its joint, compiled: a row holds it."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.latch_kernels import HELD, capture


class PackedRigidLatch(Record):
    """Parameters and state of a rigid latch."""

    lower: float  # start of its window [rad] ([m])
    middle: float  # of its window [rad] ([m])
    upper: float  # end of its window [rad] ([m])
    greatest_rate: float  # of a capture [rad/s] ([m/s]), inf: any
    greatest_energy: float  # of a capture [J], inf: any
    direction: float  # of a capture, +1 or -1; 0: both
    holding: float  # torque at which it lets go [N m] ([N]), inf: never
    mode: int  # open or holding
    side: float  # of the window on which the joint is or was, +1: above
    held_at: float  # where it holds [rad] ([m])


LAYOUT = layout(PackedRigidLatch)
SIZE = words_of(LAYOUT)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """None: a row holds the joint."""
    return 0.0


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Nothing is lost but in the capture, which is booked as it happens."""
    rates[x] = 0.0


@kernel
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 capture, 2 margin of the row to the holding torque."""
    latch = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate, load = motion
    if k < 2:
        return capture(latch, k, motion)
    if latch.mode == HELD and not math.isinf(latch.holding):
        return float(latch.holding - abs(load)), 0.0
    return 1.0, 0.0


@inlined
def hold(words: Floats, at: int) -> tuple[bool, float]:
    """Return whether the joint is held, and the position."""
    latch = record(words[at : at + SIZE], LAYOUT)
    return latch.mode == HELD, float(latch.held_at)


@inlined
def mode(words: Floats, at: int) -> int:
    """The present one."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)
