"""A force and torque from outside on a link, over time, compiled."""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin.base.records import Floats, Record, Vector3, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.desk_kernels import Desk, turned
from antenna_pin.elements.term_kernels import course


class PackedOutsideForce(Record):
    """A force on a link; ``terms`` words of its course stand behind."""

    force: Vector3  # [N]
    torque: Vector3  # [N m]
    world: int  # 1: in world axes, 0: in the link's
    value: float  # present multiplier
    terms: int  # words of the course behind


LAYOUT = layout(PackedOutsideForce)
SIZE: Any = np.int64(words_of(LAYOUT))


@inlined
def act(words: Floats, at: int, t: float, desk: Desk) -> None:
    """Write force and torque on the link."""
    own = record(words[at : at + SIZE], LAYOUT)
    value = own.value
    if own.terms > 0:
        factor, _, _ = course(words, at + SIZE, at + SIZE + own.terms, t)
        value *= factor
    link = desk[1][0]
    f, m = own.force, own.torque
    fx, fy, fz, mx, my, mz = f[0], f[1], f[2], m[0], m[1], m[2]
    if own.world == 0:
        fx, fy, fz = turned(link.rotation, fx, fy, fz)
        mx, my, mz = turned(link.rotation, mx, my, mz)
    link.force[0], link.force[1], link.force[2] = value * fx, value * fy, value * fz
    link.torque[0], link.torque[1], link.torque[2] = value * mx, value * my, value * mz
