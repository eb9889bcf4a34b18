"""Dry friction of a joint that holds what it sticks, compiled.

What depends on the load is not in ``effort``: where rows are solved, it is added by what :func:`bearing`,
:func:`rub` and :func:`bear` say of it (:mod:`antenna_pin.dynamics.constraints.loaded_kernels`).
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.hook_kernels import Loaded, Own


class PackedStickingFriction(Record):
    """Parameters and state of a friction that sticks."""

    mode: int  # UNDECIDED, FORWARD, ...
    where: float  # it sticks [rad] ([m])
    prescribed: float  # 1: motions prescribe the joint's rate
    coulomb: float  # friction of slipping [N m] ([N])
    static: float  # up to which it sticks [N m] ([N])
    viscous: float  # [N m s/rad] ([N s/m])
    stribeck_rate: float  # [rad/s] ([m/s])
    exponent: float  # of Stribeck's curve
    coefficient: float  # of slipping, by the load
    static_coefficient: float  # of sticking, by the load
    radial: float  # load over radial force [m] ([-])
    axial: float  # over axial force [m] ([-])
    bending: float  # over moment [-] ([1/m])
    middle: float  # of the bearing along the axis [m]
    burden: float  # load at the last evaluation [N m] ([N])


LAYOUT = layout(PackedStickingFriction)
SIZE = words_of(LAYOUT)

# Modes. Slipping one way or the other; sticking; at rest and held by others, with all its friction pushing
# as if it slipped forward, or backward.
UNDECIDED = 0
FORWARD = 1
BACKWARD = 2
STUCK = 3
PUSHED = 4
PULLED = 5

#: Rate up to which a joint stands whose rate is prescribed: above the round-off of rates that rows hold
#: [rad/s] ([m/s]).
STANDSTILL_RATE = 1e-10


@inlined
def _direction(mode_now: int) -> float:
    """Way along which it slips, or would; 0 where it does neither."""
    if mode_now == FORWARD or mode_now == PUSHED:
        return 1.0
    return -1.0 if mode_now == BACKWARD or mode_now == PULLED else 0.0


@inlined
def _fade(law: PackedStickingFriction, rate: float) -> float:
    """Return the remaining share of the excess of static friction at a rate."""
    if law.mode == PUSHED or law.mode == PULLED:
        return 1.0
    if law.stribeck_rate == 0.0:
        return 0.0
    return math.exp(-((abs(rate) / law.stribeck_rate) ** law.exponent))


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return the torque [N m] ([N]) that no load adds to.

    It is zero while the joint sticks, for then a row carries it.
    """
    law = record(words[at : at + SIZE], LAYOUT)
    dry = law.coulomb + (law.static - law.coulomb) * _fade(law, rate)
    return float(-_direction(law.mode) * dry - law.viscous * rate)


@inlined
def write_rates(
    words: Floats, at: int, angle: float, rate: float, power: float, rates: Floats, x: int
) -> None:
    """Power that it takes, whatever the load [W]."""
    rates[x] = -power


@inlined
def mode(words: Floats, at: int) -> int:
    """Return the present mode."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)


@inlined
def hold(words: Floats, at: int) -> tuple[bool, float]:
    """Return whether the joint sticks, and the position."""
    law = record(words[at : at + SIZE], LAYOUT)
    return law.mode == STUCK, float(law.where)


@inlined
def grip(words: Floats, at: int) -> float:
    """Return the largest sticking torque at the last evaluation's load [N m] ([N])."""
    law = record(words[at : at + SIZE], LAYOUT)
    return float(law.static + law.static_coefficient * law.burden)


@inlined
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Rate in the direction of slipping; what is left of the grip while it sticks.

    Where the rate is prescribed the function passes zero once the joint moves the other way: round-off of a
    joint that stands changes nothing.
    """
    law = record(words[at : at + SIZE], LAYOUT)
    _, _, rate, load = motion
    if k == 0:
        if law.prescribed != 0.0:
            if law.mode == UNDECIDED:
                return float(STANDSTILL_RATE - abs(rate)), 0.0
            return float(_direction(law.mode) * rate + STANDSTILL_RATE), 0.0
        if law.mode == FORWARD:
            return float(rate), 0.0
        if law.mode == UNDECIDED:
            return -1.0, 0.0
        return (float(-rate), 0.0) if law.mode == BACKWARD else (1.0, 0.0)
    return (float(grip(words, at) - abs(load)), 0.0) if law.mode == STUCK else (1.0, 0.0)


@inlined
def bearing(words: Floats, at: int) -> tuple[float, float, float, float]:
    """Return the weights of the load and the middle of the bearing [m].

    Weights are over radial force, axial force [m] and moment [-].
    """
    law = record(words[at : at + SIZE], LAYOUT)
    return float(law.radial), float(law.axial), float(law.bending), float(law.middle)


@inlined
def rub(words: Floats, at: int, rate: float, own: Own) -> float:
    """Torque by load, with its sign [-]."""
    law = record(words[at : at + SIZE], LAYOUT)
    level = law.coefficient + (law.static_coefficient - law.coefficient) * _fade(law, rate)
    return float(-_direction(law.mode) * level)


@inlined
def bear(words: Floats, at: int, burden: float) -> None:
    """Take notice of the load [N m] ([N])."""
    record(words[at : at + SIZE], LAYOUT).burden = burden
