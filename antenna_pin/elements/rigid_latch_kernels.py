"""A latch that locks its joint, compiled: a row holds it."""

from __future__ import annotations

import math
from typing import Any

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.latch_kernels import HELD, capture

#: Window with its middle, greatest rate, energy (infinite: any) and way of capture (+1, -1, 0 for both),
#: torque at which it lets go (infinite: never), the mode, on which side of the window the joint is or was
#: (+1 above), where it is held.
LAYOUT = layout(
    ("lower", "f8"),
    ("middle", "f8"),
    ("upper", "f8"),
    ("greatest_rate", "f8"),
    ("greatest_energy", "f8"),
    ("direction", "f8"),
    ("holding", "f8"),
    ("mode", "i8"),
    ("side", "f8"),
    ("held_at", "f8"),
)
SIZE = words_of(LAYOUT)


@inlined
def effort(words: Any, at: int, t: float, angle: float, rate: float) -> float:
    """None: a row holds the joint."""
    return 0.0


@inlined
def write_rates(words: Any, at: int, angle: float, rate: float, power: float, rates: Any, x: int) -> None:
    """Nothing is lost but in the capture, which is booked as it happens."""
    rates[x] = 0.0


@kernel
def switch(words: Any, at: int, k: int, motion: Any) -> tuple[float, float]:
    """Functions 0 and 1 are those of capture, 2 what the row's torque lacks to the holding torque."""
    latch = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate, load = motion
    if k < 2:
        return capture(latch, k, motion)
    if latch.mode == HELD and not math.isinf(latch.holding):
        return float(latch.holding - abs(load)), 0.0
    return 1.0, 0.0


@inlined
def hold(words: Any, at: int) -> tuple[bool, float]:
    """Whether the joint is held, and where."""
    latch = record(words[at : at + SIZE], LAYOUT)
    return latch.mode == HELD, float(latch.held_at)


@inlined
def mode(words: Any, at: int) -> int:
    """The present one."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)
