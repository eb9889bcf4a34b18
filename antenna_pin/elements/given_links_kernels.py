"""Effect of a user's function on links, compiled.

A compiled function is called; a plain one was called before.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.calls import call_3
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.desk_kernels import Desk, clear


class PackedGivenLinks(Record):
    """A function of a user's on links; its parameters, then the desk stand behind."""

    address: float  # 0: Python calls it


LAYOUT = layout(PackedGivenLinks)
SIZE = words_of(LAYOUT)


@inlined
def act(words: Floats, at: int, t: float, desk: Desk) -> None:
    """Have the function write what it does; not-a-number where it raises."""
    own = record(words[at : at + SIZE], LAYOUT)
    if own.address == 0.0:
        return
    clear(desk)
    place = float(words.ctypes.data + 8 * (at + SIZE))
    if call_3(own.address, t, place, 0.0) != 0.0:
        _, links, joints, _ = desk
        for i in range(links.shape[0]):
            links[i].force[0] = math.nan
        for i in range(joints.shape[0]):
            joints[i].torque = math.nan
