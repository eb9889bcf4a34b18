"""A rigid end stop, compiled: at rest on it a row holds the joint."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.hook_kernels import Loaded
from antenna_pin.elements.stop_kernels import FREE, LOWER, UPPER, beyond


class PackedRigidStop(Record):
    """Parameters and state of a rigid stop."""

    lower: float  # limit [rad] ([m]), -inf: none
    upper: float  # limit [rad] ([m]), inf: none
    mode: int  # off both, at rest on the lower, or on the upper one


LAYOUT = layout(PackedRigidStop)
SIZE = words_of(LAYOUT)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """None: a row holds the joint."""
    return 0.0


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Nothing is lost but in blows, which are booked as they happen."""
    rates[x] = 0.0


@kernel
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 distance to a side and rate; 2 load [N m]."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if k < 2:
        return (
            beyond(stop.lower, stop.upper, stop.mode, k, motion[1], motion[2])
            if stop.mode == FREE
            else (1.0, 0.0)
        )
    if stop.mode == FREE:
        return 1.0, 0.0
    return float(motion[3] if stop.mode == LOWER else -motion[3]), 0.0


@inlined
def hold(words: Floats, at: int) -> tuple[bool, float]:
    """Return whether the joint rests on a side, and the position of the side."""
    stop = record(words[at : at + SIZE], LAYOUT)
    return stop.mode != FREE, float(stop.upper if stop.mode == UPPER else stop.lower)


@inlined
def mode(words: Floats, at: int) -> int:
    """The present one."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)
