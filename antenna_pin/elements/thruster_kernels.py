"""A thruster, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Record, Vector3, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.desk_kernels import Desk, turned


class PackedThruster(Record):
    """A thruster."""

    thrust: float  # at full level [N]
    direction: Vector3  # of the force on the link, in its axes
    firing: float  # 1: at full level
    throttle: float  # level if not, 0 to 1
    rise_time: float  # time constant of the level [s]; 0: it follows at once
    fall_time: float  # time constant of a falling level [s]


LAYOUT = layout(PackedThruster)
SIZE = words_of(LAYOUT)


@inlined
def act(words: Floats, at: int, t: float, desk: Desk) -> None:
    """Write the force on the link, and the rate of its level if that follows."""
    own = record(words[at : at + SIZE], LAYOUT)
    level = 1.0 if own.firing != 0.0 else own.throttle
    if own.rise_time > 0.0:
        state = desk[3][0]
        lacks = level - state.value
        state.rate = lacks / (own.rise_time if lacks > 0.0 else own.fall_time)
        level = state.value
    force = level * own.thrust
    link = desk[1][0]
    x, y, z = turned(link.rotation, own.direction[0], own.direction[1], own.direction[2])
    link.force[0], link.force[1], link.force[2] = force * x, force * y, force * z
