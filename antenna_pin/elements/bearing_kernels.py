"""A bearing as springs, compiled: force on its inner ring, and stored energy.

Coordinates are those of :mod:`antenna_pin.elements.bearing`: the place of the journal's point at the
bearing's reference point, and the tilt z x a of its axis a, in bearing axes.
"""

from __future__ import annotations

import math
from typing import Annotated

from antenna_pin.base.records import Floats, Pose, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.hook_kernels import JournalPlace


class PackedBearing(Record):
    """A bearing: matrices over (x, y, z, tilt about x, tilt about y).

    Its balls stand behind.
    """

    stiffness: Annotated[Floats, (5, 5)]  # [N/m, N/rad, N m/rad]
    damping: Annotated[Floats, (5, 5)]  # [N s/m, N s/rad, N m s/rad]
    push: Annotated[Floats, 5]  # force [N] and moment [N m] in its centred place
    energy: float  # in its centred place [J]
    offset: float  # reference point along the axis from the joint's [m]
    balls: int  # how many


LAYOUT = layout(PackedBearing)
SIZE = words_of(LAYOUT)


class Ball(Record):
    """A ball between the groove centres of its raceways."""

    cosine: float  # of its azimuth
    sine: float  # of its azimuth
    height: float  # inner groove centre, centred, along the axis from the reference point [m]
    radius: float  # inner groove centre off the axis [m]
    off: float  # from the outer groove centre to the inner, off the axis [m]
    along: float  # the same, along the axis [m]
    rest: float  # distance of the groove centres, unloaded [m]
    hertz: float  # force over elongation^1.5 [N/m^1.5]


BALL = layout(Ball)
BALL_SIZE = words_of(BALL)


@inlined
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Zero: a bearing has no torque about its axis."""
    return 0.0


@inlined
def _ball(words: Floats, at: int, k: int) -> Ball:
    first = at + SIZE + k * BALL_SIZE
    return record(words[first : first + BALL_SIZE], BALL)


@inlined
def _coordinates(
    offset: float, place: tuple[float, float, float, float, float, float]
) -> tuple[float, float, float, float, float]:
    """Return the five coordinates of a journal's centre and axis."""
    x, y, z, ax, ay, az = place
    # 1 - cos of the tilt without cancellation.
    sunk = (ax * ax + ay * ay) / (1.0 + az) if az > 0.0 else 1.0 - az
    return x + offset * ax, y + offset * ay, z - offset * sunk, -ay, ax


@inlined
def _elongation(ball: Ball, q: tuple[float, float, float, float, float]) -> tuple[float, float, float]:
    """Return the compression of a ball [m], and its load's direction, off and along."""
    x, y, z, tx, ty = q
    tilt = ball.cosine * ty - ball.sine * tx
    off = ball.off + ball.cosine * x + ball.sine * y + ball.height * tilt
    along = ball.along + z - ball.radius * tilt
    way = math.sqrt(off * off + along * along)
    return way - ball.rest, off / way, along / way


@kernel
def press(words: Floats, at: int, pose: Pose) -> float:
    """Write force and moment on the journal into its pose; return the loss [W].

    The moment is about the journal's centre.
    """
    b = record(words[at : at + SIZE], LAYOUT)
    s = b.offset
    ax, ay, az = pose.axis[0], pose.axis[1], pose.axis[2]
    q = _coordinates(s, (pose.centre[0], pose.centre[1], pose.centre[2], ax, ay, az))
    wx, wy, wz = pose.spin[0], pose.spin[1], pose.spin[2]
    # a' = w x a.
    dx, dy, dz = wy * az - wz * ay, wz * ax - wx * az, wx * ay - wy * ax
    v = (pose.velocity[0] + s * dx, pose.velocity[1] + s * dy, pose.velocity[2] + s * dz, -dy, dx)
    fx, fy, fz, mx, my = b.push[0], b.push[1], b.push[2], b.push[3], b.push[4]
    lost = 0.0
    for k in range(5):
        elastic, damped = q[k], v[k]
        fx -= b.stiffness[0, k] * elastic + b.damping[0, k] * damped
        fy -= b.stiffness[1, k] * elastic + b.damping[1, k] * damped
        fz -= b.stiffness[2, k] * elastic + b.damping[2, k] * damped
        mx -= b.stiffness[3, k] * elastic + b.damping[3, k] * damped
        my -= b.stiffness[4, k] * elastic + b.damping[4, k] * damped
        for i in range(5):
            lost += v[i] * b.damping[i, k] * damped
    for k in range(b.balls):
        ball = _ball(words, at, k)
        depth, off, along = _elongation(ball, q)
        if depth > 0.0:
            load = ball.hertz * depth * math.sqrt(depth)
            fx -= load * off * ball.cosine
            fy -= load * off * ball.sine
            fz -= load * along
            turn = load * (ball.height * off - ball.radius * along)
            mx += turn * ball.sine
            my -= turn * ball.cosine
    pose.force[0], pose.force[1], pose.force[2] = fx, fy, fz
    # Tilts change by w x a, so that their torques are these; then the force's about the journal's centre.
    pose.moment[0] = mx * az + s * (ay * fz - az * fy)
    pose.moment[1] = my * az + s * (az * fx - ax * fz)
    pose.moment[2] = -mx * ax - my * ay + s * (ax * fy - ay * fx)
    return float(lost)


@kernel
def journal_energy(words: Floats, at: int, place: JournalPlace) -> float:
    """Return the energy stored [J], with the journal's centre and axis at ``place``."""
    b = record(words[at : at + SIZE], LAYOUT)
    q = _coordinates(b.offset, place)
    total = float(b.energy)
    for i in range(5):
        total -= b.push[i] * q[i]
        for k in range(5):
            total += 0.5 * q[i] * b.stiffness[i, k] * q[k]
    for k in range(b.balls):
        ball = _ball(words, at, k)
        depth, _, _ = _elongation(ball, q)
        if depth > 0.0:
            total += 0.4 * ball.hertz * depth * depth * math.sqrt(depth)
    return float(total)


@kernel
def coordinates(
    words: Floats, at: int, place: JournalPlace
) -> tuple[float, float, float, float, float, float]:
    """Return the five coordinates of a journal at ``place`` [m], [1].

    Behind them stands where the reference point is along the axis [m].
    """
    offset = float(record(words[at : at + SIZE], LAYOUT).offset)
    x, y, z, tx, ty = _coordinates(offset, place)
    return x, y, z, tx, ty, offset
