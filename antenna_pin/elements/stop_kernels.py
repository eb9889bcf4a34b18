"""A compliant end stop, compiled: one or two sides as contacts over the angle."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.contact.kernels import NORMAL_SIZE, elastic_energy, elastic_force, normal_force
from antenna_pin.elements.hook_kernels import Loaded

# Its modes: off both sides, on the lower one, on the upper one.
FREE, LOWER, UPPER = 0, 1, 2

# Its function that passes zero where the joint turns back, once in a touch.
TURNS = 2


class PackedStop(Record):
    """Parameters and state of a stop; the laws of its two sides stand behind."""

    lower: float  # limit [rad] ([m]), -inf: none
    upper: float  # limit [rad] ([m]), inf: none
    least_rate: float  # least approach rate that a touch remembers [rad/s] ([m/s])
    inertia: float  # for laws of the lower side that need a mass [kg m^2] ([kg])
    upper_inertia: float  # the same of the upper side
    mode: int  # off both, on the lower, or on the upper one
    approach: float  # rate at the onset of the present touch [rad/s] ([m/s])
    turned: float  # 1: the touch has turned back


LAYOUT = layout(PackedStop)
SIZE = words_of(LAYOUT)


@inlined
def depth(stop: PackedStop, angle: float) -> float:
    """Return the depth of the joint in the side that it touches; else zero."""
    if stop.mode == LOWER:
        return float(stop.lower - angle)
    if stop.mode == UPPER:
        return float(angle - stop.upper)
    return 0.0


@inlined
def way(stop: PackedStop) -> float:
    """Direction into the side that it touches: -1 lower, +1 upper, 0 neither."""
    if stop.mode == LOWER:
        return -1.0
    return 1.0 if stop.mode == UPPER else 0.0


@inlined
def law_at(at: int, stop: PackedStop) -> int:
    """Return the place of the law of the side that the joint touches."""
    return at + SIZE + NORMAL_SIZE if stop.mode == UPPER else at + SIZE


@kernel
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N], out of the stop; never into it."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if stop.mode == FREE:
        return 0.0
    first, sign = law_at(at, stop), way(stop)
    law = words[first : first + NORMAL_SIZE]
    inertia = stop.upper_inertia if stop.mode == UPPER else stop.inertia
    approach = max(stop.approach, stop.least_rate)
    return float(-sign * normal_force(law, depth(stop, angle), sign * rate, approach, inertia))


@kernel
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Write the power lost [W], and the size of the torque.

    Lost is the power put in, less the rate of the elastic energy.
    """
    stop = record(words[at : at + SIZE], LAYOUT)
    rates[x] = rates[x + 1] = 0.0
    if stop.mode != FREE:
        first = law_at(at, stop)
        law = words[first : first + NORMAL_SIZE]
        rates[x] = -power - elastic_force(law, depth(stop, angle)) * way(stop) * rate
        rates[x + 1] = abs(effort(words, at, 0.0, angle, rate))


@kernel
def stored(words: Floats, at: int, angle: float) -> float:
    """Energy stored [J]."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if stop.mode == FREE:
        return 0.0
    first = law_at(at, stop)
    return elastic_energy(words[first : first + NORMAL_SIZE], depth(stop, angle))


@inlined
def beyond(lower: float, upper: float, mode: int, k: int, angle: float, rate: float) -> tuple[float, float]:
    """Return the gap to side k, or the depth in it, and its rate.

    Side 0 is the lower one, 1 the upper one.
    """
    side = LOWER if k == 0 else UPPER
    gap = angle - lower if k == 0 else upper - angle
    if math.isinf(gap) or (mode != FREE and mode != side):
        return 1.0, 0.0
    slope = rate if k == 0 else -rate
    return (gap, slope) if mode == FREE else (-gap, -slope)


@kernel
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k: 0, 1 gap or depth with its rate; 2 closing rate."""
    stop = record(words[at : at + SIZE], LAYOUT)
    if k == TURNS:
        return (way(stop) * motion[2], 0.0) if stop.mode != FREE and stop.turned == 0.0 else (1.0, 0.0)
    return beyond(stop.lower, stop.upper, stop.mode, k, motion[1], motion[2])


@inlined
def mode(words: Floats, at: int) -> int:
    """The present one."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)
