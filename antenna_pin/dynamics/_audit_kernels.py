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

# Of a moving body in the world: rotation (row-major), origin, velocity of the origin, angular velocity.
PLACE_SIZE = 18
# Of a state: energies, momenta about the mass centre, their scales; then the mass centre.
KINETIC = 0
GRAVITY = 1
LINEAR = 2
ANGULAR = 5
LINEAR_SCALE = 8
ANGULAR_SCALE = 9
AUDIT_SIZE = 10


@inlined
def _about_axis(axis: Any, c: float, s: float, m: Any) -> None:
    """Write the rotation about an axis by an angle of cosine c and sine s into m[0:9], row-major."""
    x, y, z = axis[0], axis[1], axis[2]
    t = 1.0 - c
    m[0], m[1], m[2] = c + t * x * x, t * x * y - s * z, t * x * z + s * y
    m[3], m[4], m[5] = t * x * y + s * z, c + t * y * y, t * y * z - s * x
    m[6], m[7], m[8] = t * x * z - s * y, t * y * z + s * x, c + t * z * z


@inlined
def _of_quaternion(q: Any, i: int, m: Any) -> None:
    """Write the rotation of the quaternion (xyzw) at q[i:] into m[0:9], row-major."""
    x, y, z, w = q[i], q[i + 1], q[i + 2], q[i + 3]
    m[0], m[1], m[2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)
    m[3], m[4], m[5] = 2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)
    m[6], m[7], m[8] = 2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)


@inlined
def _relative(body: Any, y: Any, nq: int, m: Any, way: Any) -> None:
    """Write how a joint places and moves its body.

    Into m its rotation; into way the displacement in the joint's frame, and in the body's own the velocities,
    linear and angular.
    """
    i, j = body.q, nq + body.v
    axis = body.axis
    for k in range(9):
        way[k] = 0.0
    if body.kind == FIXED_AXIS or body.kind == CIRCLE:
        if body.kind == CIRCLE:
            _about_axis(axis, y[i], y[i + 1], m)
        else:
            _about_axis(axis, math.cos(y[i]), math.sin(y[i]), m)
        for k in range(3):
            way[6 + k] = axis[k] * y[j]
    elif body.kind == SLIDE:
        _about_axis(axis, 1.0, 0.0, m)
        for k in range(3):
            way[k] = axis[k] * y[i]
            way[3 + k] = axis[k] * y[j]
    elif body.kind == RIGID:
        _of_quaternion(y, i + 3, m)
        for k in range(3):
            way[k] = y[i + k]
            way[3 + k] = y[j + k]
            way[6 + k] = y[j + 3 + k]
    elif body.kind == ROTATION:
        _of_quaternion(y, i, m)
        for k in range(3):
            way[6 + k] = y[j + k]
    else:
        c, s = y[i + 2], y[i + 3]
        m[0], m[1], m[2] = c, -s, 0.0
        m[3], m[4], m[5] = s, c, 0.0
        m[6], m[7], m[8] = 0.0, 0.0, 1.0
        way[0], way[1] = y[i], y[i + 1]
        way[3], way[4] = y[j], y[j + 1]
        way[8] = y[j + 2]


@kernel
def audit_state(y: Any, nq: int, tree: Any, gravity: Any, work: Any, out: Any) -> None:
    """Write the energies and momenta of a state into out[0:AUDIT_SIZE].

    Args:
        y: State, q and v first.
        nq: Where v starts in it.
        tree: Bodies, parents first.
        gravity: (3,) [m/s^2].
        work: To write to, (bodies + 2, PLACE_SIZE).
        out: [kinetic, gravity [J], linear (3) [kg m/s], angular (3) [kg m^2/s], both scales].
    """
    bodies = tree.shape[0]
    m, way = work[bodies], work[bodies + 1]
    for k in range(AUDIT_SIZE):
        out[k] = 0.0
    mass = 0.0
    cx = cy = cz = 0.0
    for b in range(bodies):
        body = tree[b]
        _relative(body, y, nq, m, way)
        own = work[b]
        # The joint's frame in the world, into own; then the joint's motion on top of it.
        if body.parent < 0:
            for k in range(3):
                own[9 + k] = body.position[k]
                own[12 + k] = 0.0
                own[15 + k] = 0.0
                for n in range(3):
                    own[3 * k + n] = body.rotation[k, n]
        else:
            on = work[body.parent]
            for k in range(3):
                own[15 + k] = on[15 + k]
                own[9 + k] = on[9 + k]
                for n in range(3):
                    own[9 + k] += on[3 * k + n] * body.position[n]
                    own[3 * k + n] = (
                        on[3 * k] * body.rotation[0, n]
                        + on[3 * k + 1] * body.rotation[1, n]
                        + on[3 * k + 2] * body.rotation[2, n]
                    )
        r0, r1, r2, r3, r4, r5, r6, r7, r8 = (
            own[0],
            own[1],
            own[2],
            own[3],
            own[4],
            own[5],
            own[6],
            own[7],
            own[8],
        )
        own[9] += r0 * way[0] + r1 * way[1] + r2 * way[2]
        own[10] += r3 * way[0] + r4 * way[1] + r5 * way[2]
        own[11] += r6 * way[0] + r7 * way[1] + r8 * way[2]
        for n in range(3):
            own[n] = r0 * m[n] + r1 * m[3 + n] + r2 * m[6 + n]
            own[3 + n] = r3 * m[n] + r4 * m[3 + n] + r5 * m[6 + n]
            own[6 + n] = r6 * m[n] + r7 * m[3 + n] + r8 * m[6 + n]
        if body.parent >= 0:
            on = work[body.parent]
            dx, dy, dz = own[9] - on[9], own[10] - on[10], own[11] - on[11]
            own[12] = on[12] + on[16] * dz - on[17] * dy
            own[13] = on[13] + on[17] * dx - on[15] * dz
            own[14] = on[14] + on[15] * dy - on[16] * dx
        for k in range(3):
            own[12 + k] += own[3 * k] * way[3] + own[3 * k + 1] * way[4] + own[3 * k + 2] * way[5]
            own[15 + k] += own[3 * k] * way[6] + own[3 * k + 1] * way[7] + own[3 * k + 2] * way[8]
        # Its mass centre from its origin, and its momenta, in the world.
        c = body.centre
        sx = own[0] * c[0] + own[1] * c[1] + own[2] * c[2]
        sy = own[3] * c[0] + own[4] * c[1] + own[5] * c[2]
        sz = own[6] * c[0] + own[7] * c[1] + own[8] * c[2]
        mass += body.mass
        cx += body.mass * (own[9] + sx)
        cy += body.mass * (own[10] + sy)
        cz += body.mass * (own[11] + sz)
        _momenta(body, own, sx, sy, sz, m)
        for k in range(3):
            out[LINEAR + k] += m[k]
        out[KINETIC] += m[6]
    cx, cy, cz = cx / mass, cy / mass, cz / mass
    out[GRAVITY] = -mass * (gravity[0] * cx + gravity[1] * cy + gravity[2] * cz)
    for b in range(bodies):
        body = tree[b]
        own = work[b]
        c = body.centre
        sx = own[0] * c[0] + own[1] * c[1] + own[2] * c[2]
        sy = own[3] * c[0] + own[4] * c[1] + own[5] * c[2]
        sz = own[6] * c[0] + own[7] * c[1] + own[8] * c[2]
        _momenta(body, own, sx, sy, sz, m)
        px, py, pz = m[0], m[1], m[2]
        dx, dy, dz = own[9] + sx - cx, own[10] + sy - cy, own[11] + sz - cz
        lx = m[3] + dy * pz - dz * py
        ly = m[4] + dz * px - dx * pz
        lz = m[5] + dx * py - dy * px
        out[ANGULAR] += lx
        out[ANGULAR + 1] += ly
        out[ANGULAR + 2] += lz
        if body.counts != 0:
            out[LINEAR_SCALE] += math.sqrt(px * px + py * py + pz * pz)
            out[ANGULAR_SCALE] += math.sqrt(lx * lx + ly * ly + lz * lz)


@inlined
def _momenta(body: Any, own: Any, sx: float, sy: float, sz: float, m: Any) -> None:
    """Write linear and angular momentum about its own mass centre, and the kinetic energy, into m[0:7]."""
    wx, wy, wz = own[15], own[16], own[17]
    ux = own[12] + wy * sz - wz * sy
    uy = own[13] + wz * sx - wx * sz
    uz = own[14] + wx * sy - wy * sx
    # In the body's own axes.
    ax = own[0] * wx + own[3] * wy + own[6] * wz
    ay = own[1] * wx + own[4] * wy + own[7] * wz
    az = own[2] * wx + own[5] * wy + own[8] * wz
    inertia = body.inertia
    hx = inertia[0, 0] * ax + inertia[0, 1] * ay + inertia[0, 2] * az
    hy = inertia[1, 0] * ax + inertia[1, 1] * ay + inertia[1, 2] * az
    hz = inertia[2, 0] * ax + inertia[2, 1] * ay + inertia[2, 2] * az
    m[0], m[1], m[2] = body.mass * ux, body.mass * uy, body.mass * uz
    m[3] = own[0] * hx + own[1] * hy + own[2] * hz
    m[4] = own[3] * hx + own[4] * hy + own[5] * hz
    m[5] = own[6] * hx + own[7] * hy + own[8] * hz
    m[6] = 0.5 * (m[0] * ux + m[1] * uy + m[2] * uz + ax * hx + ay * hy + az * hz)
