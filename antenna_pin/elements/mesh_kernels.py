"""Gears, splines, belts and cables, compiled: springs on either side of a deflection.

The deflection is ``x = a input - b output - rest - e(input)``, with e a periodic curve. On the one side a
spring is compressed by ``x + room``, on the other by ``-x + room``: a negative room is half the play between
the flanks of teeth, a positive one the stretch at which strands were fitted. A spring pushes (pulls) one way
only; its damper adds at most as much as the spring gives, so that the sum starts and ends at zero. The mode
says which sides are in contact; the torque asks the deflection alone.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.elements.curve_kernels import curve
from antenna_pin.elements.hook_kernels import Loaded

# Springs: 1 on the side of a positive deflection, 2 on both sides, 0 one that acts both ways, without room.
BOTH_WAYS = 0
TWO = 2

# Its modes: which sides are in contact, each a bit.
APART, PLUS, MINUS, BOTH = 0, 1, 2, 3

# Its function that passes zero where the deflection turns back, once in a touch of one side.
TURNS = 2


class PackedMesh(Record):
    """Parameters and state of a mesh; one period of its error's curve stands behind."""

    a: float  # multiplier of the input's angle
    b: float  # multiplier of the output's angle
    rest: float  # deflection's offset [rad] ([m])
    stiffness: float  # [N m/rad] ([N/m])
    damping: float  # [N m s/rad] ([N s/m])
    room: float  # minus half the play, or the stretch at fitting [rad] ([m])
    springs: int  # 1, TWO or BOTH_WAYS
    forward: float  # efficiency, driving
    backward: float  # efficiency, driven
    slow: float  # rate of the input where friction is 71 % of its limit [rad/s]
    points: int  # of the error's curve; 0: none
    mode: int  # which sides are in contact
    turned: float  # 1: the deflection has turned back in the present touch


LAYOUT = layout(PackedMesh)
SIZE = words_of(LAYOUT)


@inlined
def _pushes(mesh: PackedMesh, depth: float, rate: float) -> tuple[float, float]:
    """Return the forces of spring and damper on one side.

    Arguments are its compression and the rate of that.
    """
    if depth <= 0.0:
        return 0.0, 0.0
    elastic = mesh.stiffness * depth
    return elastic, min(max(mesh.damping * rate, -elastic), elastic)


@inlined
def _forces(mesh: PackedMesh, x: float, rate: float) -> tuple[float, float]:
    """Force against the deflection: that of springs, and that of dampers."""
    if mesh.springs == BOTH_WAYS:
        return mesh.stiffness * x, mesh.damping * rate
    elastic, damped = _pushes(mesh, x + mesh.room, rate)
    if mesh.springs == TWO:
        other, more = _pushes(mesh, mesh.room - x, -rate)
        elastic -= other
        damped -= more
    return elastic, damped


@kernel
def between(
    words: Floats, at: int, angle: float, rate: float, other: float, other_rate: float
) -> tuple[float, float, float, float]:
    """Deflection, its rate, and its derivatives over the angles of input and output."""
    mesh = record(words[at : at + SIZE], LAYOUT)
    x = mesh.a * angle - mesh.b * other - mesh.rest
    slope = mesh.a
    if mesh.points > 0:
        first = words[at + SIZE]
        period = words[at + SIZE + mesh.points - 1] - first
        turned = angle - first
        turned -= period * math.floor(turned / period)
        error, steep = curve(words, at + SIZE, mesh.points, first + turned)
        x -= error
        slope -= steep
    return float(x), float(slope * rate - mesh.b * other_rate), float(slope), float(-mesh.b)


@kernel
def effort(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Torque [N m], or force [N], along the deflection."""
    elastic, damped = _forces(record(words[at : at + SIZE], LAYOUT), angle, rate)
    return float(-elastic - damped)


@inlined
def dissipation(words: Floats, at: int, x: float, rate: float) -> float:
    """Power that its dampers take [W]."""
    _, damped = _forces(record(words[at : at + SIZE], LAYOUT), x, rate)
    return float(damped * rate)


@kernel
def drag(words: Floats, at: int, torque: float, rate: float) -> float:
    """Return the friction torque on the input, by its mesh torque and rate [N m].

    Driving (torque against the rate) the input gives 1 / forward of what the mesh takes, driven it gets
    ``backward`` of what the mesh gives; near rest the share is rounded off.
    """
    mesh = record(words[at : at + SIZE], LAYOUT)
    if mesh.forward == 1.0 and mesh.backward == 1.0:
        return 0.0
    share = rate / math.sqrt(rate * rate + mesh.slow * mesh.slow)
    driving = 1.0 / mesh.forward - 1.0 if torque * rate < 0.0 else 1.0 - mesh.backward
    return float(-abs(torque) * driving * share)


@kernel
def stored(words: Floats, at: int, angle: float) -> float:
    """Energy stored [J]."""
    mesh = record(words[at : at + SIZE], LAYOUT)
    if mesh.springs == BOTH_WAYS:
        return float(0.5 * mesh.stiffness * angle * angle)
    depth = max(angle + mesh.room, 0.0)
    other = max(mesh.room - angle, 0.0) if mesh.springs == TWO else 0.0
    return float(0.5 * mesh.stiffness * (depth * depth + other * other))


@kernel
def switch(words: Floats, at: int, k: int, motion: Loaded) -> tuple[float, float]:
    """Return function k with its rate: 0, 1 gap of a side, 2 closing rate.

    Side 0 is plus, 1 minus; in contact the gap is the depth.
    """
    mesh = record(words[at : at + SIZE], LAYOUT)
    x, rate = motion[1], motion[2]
    if mesh.springs == BOTH_WAYS or (k == 1 and mesh.springs != TWO):
        return 1.0, 0.0
    if k == TURNS:
        if mesh.turned != 0.0 or (mesh.mode != PLUS and mesh.mode != MINUS):
            return 1.0, 0.0
        return (rate if mesh.mode == PLUS else -rate), 0.0
    side, way = (PLUS, 1.0) if k == 0 else (MINUS, -1.0)
    depth, speed = way * x + mesh.room, way * rate
    if mesh.mode & side:
        return float(depth), float(speed)
    return float(-depth), float(-speed)


@inlined
def mode(words: Floats, at: int) -> int:
    """The present one."""
    return int(record(words[at : at + SIZE], LAYOUT).mode)


@kernel
def kink(words: Floats, at: int, t: float, angle: float, rate: float) -> float:
    """Return a function that passes zero at a damper's limit; negative at it.

    Of each side in contact what the spring gives beyond its damper; a touch begins and ends at the limit.
    """
    mesh = record(words[at : at + SIZE], LAYOUT)
    limit = mesh.damping * abs(rate)
    plus = mesh.stiffness * (angle + mesh.room) - limit
    minus = mesh.stiffness * (mesh.room - angle) - limit
    if mesh.mode == BOTH:
        return float(plus * minus)
    if mesh.mode == APART:
        return -1.0
    return float(plus if mesh.mode == PLUS else minus)
