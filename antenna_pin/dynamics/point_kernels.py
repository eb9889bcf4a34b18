"""Springs and dampers between points, compiled: forces, energy and losses.

Their blocks are the first among those of elements on links (:mod:`antenna_pin.dynamics.link_kernels`), from
``points`` of a program's head on: ``ELEMENT``, of which kind, length, x and on are used, the record of its
kind, and a ``SIDE`` for each end.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import (
    CIRCLE,
    FIXED_AXIS,
    PLANE,
    RIGID,
    ROTATION,
    SLIDE,
    Floats,
    Record,
    Records,
    Six,
    Triple,
    Vector3,
    layout,
    words_of,
)
from antenna_pin.compiled.decorators import deferred, inlined, kernel, record
from antenna_pin.dynamics.kernels import PARAMETERS, element_at, head_of
from antenna_pin.elements import kernels as elements
from antenna_pin.mechanism.tree_kernels import Body, Place


class Side(Record):
    """An end of a spring between points."""

    body: int  # index; -1: the world
    point: Vector3  # in the body's frame [m]


SIDE = layout(Side)
SIDE_WORDS = words_of(SIDE)


class Stretched(Record):
    """A spring between points at a sample."""

    length: float  # [m]
    tension: float  # force that draws its points together [N]
    force: Vector3  # on the second point's link, world axes [N]


STRETCH = layout(Stretched)

# Distance of coincident points, relative to their distances from the world's origin: round-off.
COINCIDE = 1e-15


@inlined
def _side(program: Floats, b: int, k: int) -> Side:
    at = b + element_at(program, b).length - (2 - k) * SIDE_WORDS
    return record(program[at : at + SIDE_WORDS], SIDE)


@inlined
def _place(side: Side, places: Records[Place]) -> Six:
    """Return where an end is and its velocity, in the world."""
    p = side.point
    if side.body < 0:
        return p[0], p[1], p[2], 0.0, 0.0, 0.0
    own = places[side.body]
    r, v, w = own.rotation, own.velocity, own.spin
    x = r[0, 0] * p[0] + r[0, 1] * p[1] + r[0, 2] * p[2]
    y = r[1, 0] * p[0] + r[1, 1] * p[1] + r[1, 2] * p[2]
    z = r[2, 0] * p[0] + r[2, 1] * p[1] + r[2, 2] * p[2]
    return (
        own.origin[0] + x,
        own.origin[1] + y,
        own.origin[2] + z,
        v[0] + w[1] * z - w[2] * y,
        v[1] + w[2] * x - w[0] * z,
        v[2] + w[0] * y - w[1] * x,
    )


@inlined
def line(program: Floats, b: int, places: Records[Place]) -> tuple[float, float, float, float, float]:
    """Return length, length rate and direction of the spring at b.

    Where the ends coincide the direction is that in which they move apart; zero if they do not.
    """
    ax, ay, az, ux, uy, uz = _place(_side(program, b, 0), places)
    bx, by, bz, vx, vy, vz = _place(_side(program, b, 1), places)
    x, y, z = bx - ax, by - ay, bz - az
    vx, vy, vz = vx - ux, vy - uy, vz - uz
    length = math.sqrt(x * x + y * y + z * z)
    size = length
    if length <= COINCIDE * (abs(ax) + abs(ay) + abs(az) + abs(bx) + abs(by) + abs(bz)):
        x, y, z = vx, vy, vz
        length, size = 0.0, math.sqrt(x * x + y * y + z * z)
        if size == 0.0:
            return length, 0.0, 0.0, 0.0, 0.0
    x, y, z = x / size, y / size, z / size
    return length, vx * x + vy * y + vz * z, x, y, z


@kernel
def draw(
    program: Floats, b: int, tree: Records[Body], places: Records[Place], tau: Floats, rates: Floats
) -> None:
    """Add the generalized force of the spring at b; write its loss rate.

    Args:
        program: Program of all force elements.
        b: Place of its block.
        tree: Bodies, parents first.
        places: PLACE, (bodies + 1,): places of the bodies.
        tau: Generalized force, (nv,), added to.
        rates: Written behind rates[nv].
    """
    e = element_at(program, b)
    length, rate, x, y, z = line(program, b, places)
    force = e.on * elements.tension(e.kind, program, b + PARAMETERS, length, rate)
    rates[head_of(program).nv + e.x] = e.on * elements.loss(e.kind, program, b + PARAMETERS, rate)
    first, second = _side(program, b, 0), _side(program, b, 1)
    ax, ay, az, _, _, _ = _place(first, places)
    i, j = first.body, second.body
    nothing = 0.0, 0.0, 0.0
    # Down to the common body: opposite forces along one line cancel for bodies below. For the
    # same reason one point of the line serves both.
    while i != j:
        if i > j:
            push(tree[i], places[i], (force * x, force * y, force * z), nothing, (ax, ay, az), tau)
            i = tree[i].parent
        else:
            push(tree[j], places[j], (-force * x, -force * y, -force * z), nothing, (ax, ay, az), tau)
            j = tree[j].parent


@kernel
def push(body: Body, own: Place, force: Triple, torque: Triple, point: Triple, tau: Floats) -> None:
    """Add the effect of a force at a world point, and torque, on a joint."""
    fx, fy, fz = force
    tx, ty, tz = torque
    px, py, pz = point
    r, kind, v = own.rotation, body.kind, body.v
    x, y, z = px - own.origin[0], py - own.origin[1], pz - own.origin[2]
    mx, my, mz = y * fz - z * fy + tx, z * fx - x * fz + ty, x * fy - y * fx + tz
    if kind == FIXED_AXIS or kind == CIRCLE or kind == SLIDE:
        if kind == SLIDE:
            mx, my, mz = fx, fy, fz
        for k in range(3):
            tau[v] += body.axis[k] * (r[0, k] * mx + r[1, k] * my + r[2, k] * mz)
        return
    if kind != ROTATION:
        ways = 3 if kind == RIGID else 2
        for k in range(ways):
            tau[v + k] += r[0, k] * fx + r[1, k] * fy + r[2, k] * fz
        v += ways
    for k in range(2 if kind == PLANE else 0, 3):
        tau[v] += r[0, k] * mx + r[1, k] * my + r[2, k] * mz
        v += 1


@inlined
def add_wrench(
    body: int, places: Records[Place], force: Triple, torque: Triple, point: Triple, out: Floats
) -> None:
    """Add a force at a world point, and torque, to a body's wrench, (bodies, 6)."""
    fx, fy, fz = force
    tx, ty, tz = torque
    px, py, pz = point
    own = places[body].origin
    x, y, z = px - own[0], py - own[1], pz - own[2]
    at = 6 * body
    out[at] += fx
    out[at + 1] += fy
    out[at + 2] += fz
    out[at + 3] += tx + y * fz - z * fy
    out[at + 4] += ty + z * fx - x * fz
    out[at + 5] += tz + x * fy - y * fx


@kernel
def add_pull(program: Floats, b: int, places: Records[Place], out: Floats) -> None:
    """Add what the spring at b does to its two bodies, (6 bodies,)."""
    e = element_at(program, b)
    length, rate, x, y, z = line(program, b, places)
    force = e.on * elements.tension(e.kind, program, b + PARAMETERS, length, rate)
    nothing = 0.0, 0.0, 0.0
    for k in range(2):
        side, sign = _side(program, b, k), 1.0 - 2.0 * k
        if side.body >= 0:
            px, py, pz, _, _, _ = _place(side, places)
            pull = sign * force * x, sign * force * y, sign * force * z
            add_wrench(side.body, places, pull, nothing, (px, py, pz), out)


@kernel
def stored_between(program: Floats, b: int, places: Records[Place]) -> float:
    """Return the energy stored in the spring at b [J]."""
    e = element_at(program, b)
    length, _, _, _, _ = line(program, b, places)
    return float(e.on * elements.stored(e.kind, program, b + PARAMETERS, length))


@deferred
def look_at(program: Floats, places: Records[Place], stretches: Records[Stretched]) -> None:
    """Write what there is to see of all springs between points: ``STRETCH`` of each, (springs,)."""
    k = 0
    b = head_of(program).points
    while k < stretches.shape[0]:
        e, seen = element_at(program, b), stretches[k]
        length, rate, x, y, z = line(program, b, places)
        seen.length = length
        seen.tension = e.on * elements.tension(e.kind, program, b + PARAMETERS, length, rate)
        seen.force[0] = -seen.tension * x
        seen.force[1] = -seen.tension * y
        seen.force[2] = -seen.tension * z
        b += e.length
        k += 1
