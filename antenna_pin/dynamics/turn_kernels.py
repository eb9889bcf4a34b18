"""Turned angles of a state, brought up to its configuration, compiled.

What they are stands in :mod:`antenna_pin.dynamics.kernels`.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, Records, layout
from antenna_pin.compiled.decorators import kernel
from antenna_pin.dynamics.kernels import head_of
from antenna_pin.joints.layout_kernels import joint_at
from antenna_pin.joints.pose_kernels import wrapped_angle
from antenna_pin.mechanism.tree_kernels import unwrapped


class TurnedAngle(Record):
    """A turned angle."""

    x: int  # its place
    play: int  # block of its joint with play; -1: none
    q: int  # start of its joint's part of q
    v: int  # start of its joint's part of v


TURN = layout(TurnedAngle)


@kernel
def turn_on(program: Floats, turns: Records[TurnedAngle], y: Floats) -> float:
    """Update the turned angles (``TURN``, each) in a state's x; return the fastest rate [rad/s]."""
    head = head_of(program)
    x0 = head.nq + head.nv
    fastest = 0.0
    for k in range(turns.shape[0]):
        turn = turns[k]
        at = x0 + turn.x
        i = head.nq + turn.v
        if turn.play < 0:
            angle = math.atan2(y[turn.q + 1], y[turn.q])
            rate = abs(y[i])
        else:
            j = joint_at(program, turn.play)
            angle, _, _ = wrapped_angle(j, y)
            if j.planar != 0:
                rate = abs(y[i + 2])
            else:
                rate = math.sqrt(y[i + 3] * y[i + 3] + y[i + 4] * y[i + 4] + y[i + 5] * y[i + 5])
        y[at] = unwrapped(angle, y[at])
        fastest = max(fastest, rate)
    return fastest
