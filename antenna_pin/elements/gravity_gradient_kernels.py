"""The gradient of gravity on a circular orbit, compiled."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, Vector3, layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.elements.desk_kernels import Desk


class PackedGravityGradient(Record):
    """An orbit as the gravity gradient needs it."""

    angular_rate: float  # of the orbit [rad/s]
    nadir: Vector3  # direction to the centre at t = 0
    ahead: Vector3  # the direction that follows a quarter of a turn later


LAYOUT = layout(PackedGravityGradient)
SIZE = words_of(LAYOUT)


@inlined
def act(words: Floats, at: int, t: float, desk: Desk) -> None:
    """Write force and torque on every body, whose points are their mass centres."""
    own = record(words[at : at + SIZE], LAYOUT)
    c, s = math.cos(own.angular_rate * t), math.sin(own.angular_rate * t)
    ex = c * own.nadir[0] + s * own.ahead[0]
    ey = c * own.nadir[1] + s * own.ahead[1]
    ez = c * own.nadir[2] + s * own.ahead[2]
    square = own.angular_rate * own.angular_rate
    links = desk[1]
    for i in range(links.shape[0]):
        link = links[i]
        p, r, inertia = link.place, link.rotation, link.inertia
        along = 3.0 * (ex * p[0] + ey * p[1] + ez * p[2])
        factor = link.mass * square
        link.force[0] = factor * (along * ex - p[0])
        link.force[1] = factor * (along * ey - p[1])
        link.force[2] = factor * (along * ez - p[2])
        # e and I e in the body's axes.
        ax = r[0, 0] * ex + r[1, 0] * ey + r[2, 0] * ez
        ay = r[0, 1] * ex + r[1, 1] * ey + r[2, 1] * ez
        az = r[0, 2] * ex + r[1, 2] * ey + r[2, 2] * ez
        hx = inertia[0, 0] * ax + inertia[0, 1] * ay + inertia[0, 2] * az
        hy = inertia[1, 0] * ax + inertia[1, 1] * ay + inertia[1, 2] * az
        hz = inertia[2, 0] * ax + inertia[2, 1] * ay + inertia[2, 2] * az
        mx, my, mz = ay * hz - az * hy, az * hx - ax * hz, ax * hy - ay * hx
        for k in range(3):
            link.torque[k] = 3.0 * square * (r[k, 0] * mx + r[k, 1] * my + r[k, 2] * mz)
