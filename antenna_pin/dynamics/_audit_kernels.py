"""Energies and momenta of a tree of bodies in one state, compiled.

``tree`` has one :data:`BODY` for each moving body, in the model's order: parents stand before their children.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin._compile import inlined, kernel
from antenna_pin.records import layout

# A moving body and the joint that moves it: index of the body that it is on (-1: the world), kind, starts in
# q and v, whether it counts in the scales of momentum; the joint's axis, its frame in the parent's;
# mass [kg], centre of mass [m] and inertia about it [kg m^2] in the joint's frame.
BODY = layout(
    ("parent", np.int64),
    ("kind", np.int64),
    ("q", np.int64),
    ("v", np.int64),
    ("counts", np.int64),
    ("axis", np.float64, (3,)),
    ("rotation", np.float64, (3, 3)),
    ("position", np.float64, (3,)),
    ("mass", np.float64),
    ("centre", np.float64, (3,)),
    ("inertia", np.float64, (3, 3)),
)
FIXED_AXIS = 0  # an angle about an axis
CIRCLE = 1  # the same, known by cosine and sine
SLIDE = 2
RIGID = 3
ROTATION = 4
PLANE = 5

# Where a body is in the world, or by its joint: rotation and origin [m], velocity of the origin [m/s] and
# angular velocity [rad/s].
PLACE = layout(
    ("rotation", np.float64, (3, 3)),
    ("origin", np.float64, (3,)),
    ("velocity", np.float64, (3,)),
    ("spin", np.float64, (3,)),
)
# What a state has: energies [J] (those stored in contacts and springs are others' to write), momenta, the
# angular one about the mass centre, and their scales [kg m/s, kg m^2/s].
AUDIT = layout(
    ("kinetic", np.float64),
    ("contacts", np.float64),
    ("springs", np.float64),
    ("gravity", np.float64),
    ("linear", np.float64, (3,)),
    ("angular", np.float64, (3,)),
    ("linear_scale", np.float64),
    ("angular_scale", np.float64),
)


@inlined
def _about_axis(axis: Any, c: float, s: float, m: Any) -> None:
    """Write the rotation about an axis by an angle of cosine c and sine s."""
    x, y, z = axis[0], axis[1], axis[2]
    t = 1.0 - c
    m[0, 0], m[0, 1], m[0, 2] = c + t * x * x, t * x * y - s * z, t * x * z + s * y
    m[1, 0], m[1, 1], m[1, 2] = t * x * y + s * z, c + t * y * y, t * y * z - s * x
    m[2, 0], m[2, 1], m[2, 2] = t * x * z - s * y, t * y * z + s * x, c + t * z * z


@inlined
def _of_quaternion(q: Any, i: int, m: Any) -> None:
    """Write the rotation of the quaternion (xyzw) at q[i:]."""
    x, y, z, w = q[i], q[i + 1], q[i + 2], q[i + 3]
    m[0, 0], m[0, 1], m[0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)
    m[1, 0], m[1, 1], m[1, 2] = 2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)
    m[2, 0], m[2, 1], m[2, 2] = 2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)


@inlined
def _relative(body: Any, y: Any, nq: int, way: Any) -> None:
    """Write how a joint places and moves its body, in a ``PLACE``.

    Its rotation; its displacement in the joint's frame; its velocities in the body's own.
    """
    i, j = body.q, nq + body.v
    axis = body.axis
    for k in range(3):
        way.origin[k] = 0.0
        way.velocity[k] = 0.0
        way.spin[k] = 0.0
    if body.kind == FIXED_AXIS or body.kind == CIRCLE:
        if body.kind == CIRCLE:
            _about_axis(axis, y[i], y[i + 1], way.rotation)
        else:
            _about_axis(axis, math.cos(y[i]), math.sin(y[i]), way.rotation)
        for k in range(3):
            way.spin[k] = axis[k] * y[j]
    elif body.kind == SLIDE:
        _about_axis(axis, 1.0, 0.0, way.rotation)
        for k in range(3):
            way.origin[k] = axis[k] * y[i]
            way.velocity[k] = axis[k] * y[j]
    elif body.kind == RIGID:
        _of_quaternion(y, i + 3, way.rotation)
        for k in range(3):
            way.origin[k] = y[i + k]
            way.velocity[k] = y[j + k]
            way.spin[k] = y[j + 3 + k]
    elif body.kind == ROTATION:
        _of_quaternion(y, i, way.rotation)
        for k in range(3):
            way.spin[k] = y[j + k]
    else:
        m, c, s = way.rotation, y[i + 2], y[i + 3]
        m[0, 0], m[0, 1], m[0, 2] = c, -s, 0.0
        m[1, 0], m[1, 1], m[1, 2] = s, c, 0.0
        m[2, 0], m[2, 1], m[2, 2] = 0.0, 0.0, 1.0
        way.origin[0], way.origin[1] = y[i], y[i + 1]
        way.velocity[0], way.velocity[1] = y[j], y[j + 1]
        way.spin[2] = y[j + 2]


@kernel
def audit_state(y: Any, nq: int, tree: Any, gravity: Any, places: Any, audits: Any) -> None:
    """Write the energies and momenta of a state but those of contacts and springs.

    Args:
        y: State, q and v first.
        nq: Where v starts in it.
        tree: Bodies, parents first.
        gravity: (3,) [m/s^2].
        places: To write to, PLACE, (bodies + 1,).
        audits: To write to, AUDIT, (1,).
    """
    bodies = tree.shape[0]
    out = audits[0]
    way = places[bodies]
    out.kinetic = out.linear_scale = out.angular_scale = 0.0
    for k in range(3):
        out.linear[k] = 0.0
        out.angular[k] = 0.0
    mass = 0.0
    cx = cy = cz = 0.0
    for b in range(bodies):
        body, own = tree[b], places[b]
        _relative(body, y, nq, way)
        if body.parent < 0:
            _place_on_world(body, own)
        else:
            _place_on(body, places[body.parent], own)
        _move(own, way)
        if body.parent >= 0:
            _carry(places[body.parent], own)
        r = own.rotation
        for k in range(3):
            own.velocity[k] += (
                r[k, 0] * way.velocity[0] + r[k, 1] * way.velocity[1] + r[k, 2] * way.velocity[2]
            )
            own.spin[k] += r[k, 0] * way.spin[0] + r[k, 1] * way.spin[1] + r[k, 2] * way.spin[2]
        sx, sy, sz = _lever(body, own)
        mass += body.mass
        cx += body.mass * (own.origin[0] + sx)
        cy += body.mass * (own.origin[1] + sy)
        cz += body.mass * (own.origin[2] + sz)
        px, py, pz, _, _, _, kinetic = _momenta(body, own, sx, sy, sz)
        out.linear[0] += px
        out.linear[1] += py
        out.linear[2] += pz
        out.kinetic += kinetic
    cx, cy, cz = cx / mass, cy / mass, cz / mass
    out.gravity = -mass * (gravity[0] * cx + gravity[1] * cy + gravity[2] * cz)
    for b in range(bodies):
        body, own = tree[b], places[b]
        sx, sy, sz = _lever(body, own)
        px, py, pz, hx, hy, hz, _ = _momenta(body, own, sx, sy, sz)
        dx, dy, dz = own.origin[0] + sx - cx, own.origin[1] + sy - cy, own.origin[2] + sz - cz
        lx = hx + dy * pz - dz * py
        ly = hy + dz * px - dx * pz
        lz = hz + dx * py - dy * px
        out.angular[0] += lx
        out.angular[1] += ly
        out.angular[2] += lz
        if body.counts != 0:
            out.linear_scale += math.sqrt(px * px + py * py + pz * pz)
            out.angular_scale += math.sqrt(lx * lx + ly * ly + lz * lz)


@inlined
def _place_on_world(body: Any, own: Any) -> None:
    """Write the frame of a joint on the world."""
    for k in range(3):
        own.origin[k] = body.position[k]
        own.velocity[k] = 0.0
        own.spin[k] = 0.0
        for n in range(3):
            own.rotation[k, n] = body.rotation[k, n]


@inlined
def _place_on(body: Any, on: Any, own: Any) -> None:
    """Write the frame of a joint on a body, which turns with it."""
    for k in range(3):
        own.spin[k] = on.spin[k]
        own.origin[k] = on.origin[k]
        for n in range(3):
            own.origin[k] += on.rotation[k, n] * body.position[n]
            own.rotation[k, n] = (
                on.rotation[k, 0] * body.rotation[0, n]
                + on.rotation[k, 1] * body.rotation[1, n]
                + on.rotation[k, 2] * body.rotation[2, n]
            )


@inlined
def _move(own: Any, way: Any) -> None:
    """Turn and displace a joint's frame, in place, by what the joint does: the body's frame."""
    m = way.rotation
    for k in range(3):
        a, b, c = own.rotation[k, 0], own.rotation[k, 1], own.rotation[k, 2]
        own.origin[k] += a * way.origin[0] + b * way.origin[1] + c * way.origin[2]
        for n in range(3):
            own.rotation[k, n] = a * m[0, n] + b * m[1, n] + c * m[2, n]


@inlined
def _carry(on: Any, own: Any) -> None:
    """Write the velocity that a body's origin has from the body that it is on."""
    dx = own.origin[0] - on.origin[0]
    dy = own.origin[1] - on.origin[1]
    dz = own.origin[2] - on.origin[2]
    own.velocity[0] = on.velocity[0] + on.spin[1] * dz - on.spin[2] * dy
    own.velocity[1] = on.velocity[1] + on.spin[2] * dx - on.spin[0] * dz
    own.velocity[2] = on.velocity[2] + on.spin[0] * dy - on.spin[1] * dx


@inlined
def _lever(body: Any, own: Any) -> tuple[float, float, float]:
    """Mass centre of a body from its origin, in the world [m]."""
    r, c = own.rotation, body.centre
    return (
        r[0, 0] * c[0] + r[0, 1] * c[1] + r[0, 2] * c[2],
        r[1, 0] * c[0] + r[1, 1] * c[1] + r[1, 2] * c[2],
        r[2, 0] * c[0] + r[2, 1] * c[1] + r[2, 2] * c[2],
    )


@inlined
def _momenta(
    body: Any, own: Any, sx: float, sy: float, sz: float
) -> tuple[float, float, float, float, float, float, float]:
    """Linear and angular momentum of a body about its own mass centre, in the world, and kinetic energy."""
    wx, wy, wz = own.spin[0], own.spin[1], own.spin[2]
    ux = own.velocity[0] + wy * sz - wz * sy
    uy = own.velocity[1] + wz * sx - wx * sz
    uz = own.velocity[2] + wx * sy - wy * sx
    # In the body's own axes.
    r = own.rotation
    ax = r[0, 0] * wx + r[1, 0] * wy + r[2, 0] * wz
    ay = r[0, 1] * wx + r[1, 1] * wy + r[2, 1] * wz
    az = r[0, 2] * wx + r[1, 2] * wy + r[2, 2] * wz
    inertia = body.inertia
    hx = inertia[0, 0] * ax + inertia[0, 1] * ay + inertia[0, 2] * az
    hy = inertia[1, 0] * ax + inertia[1, 1] * ay + inertia[1, 2] * az
    hz = inertia[2, 0] * ax + inertia[2, 1] * ay + inertia[2, 2] * az
    px, py, pz = body.mass * ux, body.mass * uy, body.mass * uz
    return (
        px,
        py,
        pz,
        r[0, 0] * hx + r[0, 1] * hy + r[0, 2] * hz,
        r[1, 0] * hx + r[1, 1] * hy + r[1, 2] * hz,
        r[2, 0] * hx + r[2, 1] * hy + r[2, 2] * hz,
        0.5 * (px * ux + py * uy + pz * uz + ax * hx + ay * hy + az * hz),
    )
