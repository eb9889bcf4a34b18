"""A rigid latch, compiled."""

from __future__ import annotations

from typing import Any

from antenna_pin._compile import inlined, record
from antenna_pin.elements.rigid_stop_kernels import effort, write_rates
from antenna_pin.records import layout, words_of

__all__ = ["LAYOUT", "effort", "hold", "mode", "switch", "write_rates"]

#: Where it latches, from which side the joint comes, where it is held, and the mode.
LAYOUT = layout(("angle", "f8"), ("side", "f8"), ("where", "f8"), ("mode", "i8"))
SIZE = words_of(LAYOUT)


@inlined
def mode(words: Any, at: int) -> int:
    """Return the present mode: free, latched."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)


@inlined
def hold(words: Any, at: int) -> tuple[bool, float]:
    """Whether the joint is latched, and where."""
    latch = record(words[at : at + SIZE], LAYOUT)
    return latch.mode != 0, float(latch.where)


@inlined
def switch(words: Any, at: int, k: int, motion: Any) -> tuple[float, float]:
    """Way to where it latches, from the side that the joint is on."""
    latch = record(words[at : at + SIZE], LAYOUT)
    _, angle, rate, _ = motion
    if latch.mode != 0:
        return 1.0, 0.0
    return float(latch.side * (angle - latch.angle)), float(latch.side * rate)
