"""Tree of bodies in numbers, compiled: places and motions of its bodies.

``tree`` has one :data:`BODY` for each moving body, in the model's order: parents stand before their children.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import (
    CIRCLE,
    FIXED_AXIS,
    RIGID,
    ROTATION,
    SLIDE,
    Floats,
    Matrix3,
    Record,
    Records,
    Vector3,
    layout,
)
from antenna_pin.compiled.decorators import inlined, kernel


class Body(Record):
    """A moving body and its joint; lengths and axes in the joint's frame."""

    parent: int  # index of the body that it is on; -1: the world
    kind: int  # how the joint moves: FIXED_AXIS, CIRCLE, ...
    q: int  # start in q
    v: int  # start in v
    counts: int  # 1: counts in the scales of momentum
    axis: Vector3  # of the joint
    rotation: Matrix3  # of the joint's frame in the parent's
    position: Vector3  # of the joint's frame in the parent's [m]
    mass: float  # [kg]
    centre: Vector3  # of mass [m]
    inertia: Matrix3  # about the centre of mass [kg m^2]
    armature: float  # what a turning joint feels beside the body's inertia [kg m^2]


BODY = layout(Body)


class Place(Record):
    """Pose and motion of a body in the world, or by its joint."""

    rotation: Matrix3  # of its frame
    origin: Vector3  # [m]
    velocity: Vector3  # of the origin [m/s]
    spin: Vector3  # angular velocity [rad/s]
    slide: Vector3  # what its joint adds to the velocity, world axes [m/s]
    turn: Vector3  # what its joint adds to the angular velocity, world axes [rad/s]
    bias: Vector3  # acceleration of the origin by velocities alone (:func:`bias_accelerations`) [m/s^2]
    bias_spin: Vector3  # angular acceleration by velocities alone [rad/s^2]


PLACE = layout(Place)


@inlined
def unwrapped(angle: float, reference: float) -> float:
    """Return an angle shifted by whole turns to within half a turn of ``reference`` [rad]."""
    return angle + 2.0 * math.pi * math.floor((reference - angle) / (2.0 * math.pi) + 0.5)


@inlined
def _about_axis(axis: Floats, c: float, s: float, m: Floats) -> None:
    """Write the rotation about an axis by an angle of cosine c and sine s."""
    x, y, z = axis[0], axis[1], axis[2]
    t = 1.0 - c
    m[0, 0], m[0, 1], m[0, 2] = c + t * x * x, t * x * y - s * z, t * x * z + s * y
    m[1, 0], m[1, 1], m[1, 2] = t * x * y + s * z, c + t * y * y, t * y * z - s * x
    m[2, 0], m[2, 1], m[2, 2] = t * x * z - s * y, t * y * z + s * x, c + t * z * z


@inlined
def _of_quaternion(q: Floats, i: int, m: Floats) -> None:
    """Write the rotation of the quaternion (xyzw) at q[i:]."""
    x, y, z, w = q[i], q[i + 1], q[i + 2], q[i + 3]
    m[0, 0], m[0, 1], m[0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)
    m[1, 0], m[1, 1], m[1, 2] = 2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)
    m[2, 0], m[2, 1], m[2, 2] = 2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)


@inlined
def relative(body: Body, y: Floats, nq: int, way: Place) -> None:
    """Write displacement and velocity of a body by its joint, in a ``PLACE``.

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
def place_bodies(y: Floats, nq: int, tree: Records[Body], places: Records[Place]) -> None:
    """Write poses and motions of the bodies in the world.

    Args:
        y: State, q and v first.
        nq: Where v starts in it.
        tree: Bodies, parents first.
        places: To write to, PLACE, (bodies + 1,); the last is scratch.
    """
    bodies = tree.shape[0]
    way = places[bodies]
    for b in range(bodies):
        body, own = tree[b], places[b]
        relative(body, y, nq, way)
        if body.parent < 0:
            _place_on_world(body, own)
        else:
            _place_on(body, places[body.parent], own)
        _move(own, way)
        if body.parent >= 0:
            _carry(places[body.parent], own)
        r = own.rotation
        for k in range(3):
            own.slide[k] = r[k, 0] * way.velocity[0] + r[k, 1] * way.velocity[1] + r[k, 2] * way.velocity[2]
            own.turn[k] = r[k, 0] * way.spin[0] + r[k, 1] * way.spin[1] + r[k, 2] * way.spin[2]
            own.velocity[k] += own.slide[k]
            own.spin[k] += own.turn[k]


@inlined
def cross(a: Floats, b: Floats, k: int) -> float:
    """Component k of the cross product of two vectors."""
    i, j = (k + 1) % 3, (k + 2) % 3
    return float(a[i] * b[j] - a[j] * b[i])


@kernel
def bias_accelerations(tree: Records[Body], places: Records[Place]) -> None:
    """Write the accelerations of bodies at zero generalized acceleration.

    With r from the parent's origin, u the velocity that the joint adds and w angular velocities,
    a = a_p + alpha_p x r + w_p x (w_p x r + u) + w x u and alpha = alpha_p + w_p x (w - w_p).
    """
    for b in range(tree.shape[0]):
        own, parent = places[b], tree[b].parent
        if parent < 0:
            for k in range(3):
                own.bias[k] = cross(own.spin, own.slide, k)
                own.bias_spin[k] = 0.0
            continue
        on, way = places[parent], places[tree.shape[0]]
        for k in range(3):
            way.origin[k] = own.origin[k] - on.origin[k]
        for k in range(3):
            # How r changes: with the parent, and along the joint.
            way.velocity[k] = cross(on.spin, way.origin, k) + own.slide[k]
        for k in range(3):
            own.bias[k] = (
                on.bias[k]
                + cross(on.bias_spin, way.origin, k)
                + cross(on.spin, way.velocity, k)
                + cross(own.spin, own.slide, k)
            )
            own.bias_spin[k] = on.bias_spin[k] + cross(on.spin, own.turn, k)


@inlined
def _place_on_world(body: Body, own: Place) -> None:
    """Write the frame of a joint on the world."""
    for k in range(3):
        own.origin[k] = body.position[k]
        own.velocity[k] = 0.0
        own.spin[k] = 0.0
        for n in range(3):
            own.rotation[k, n] = body.rotation[k, n]


@inlined
def _place_on(body: Body, on: Place, own: Place) -> None:
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
def _move(own: Place, way: Place) -> None:
    """Turn and displace a joint's frame, in place, to the body's frame."""
    m = way.rotation
    for k in range(3):
        a, b, c = own.rotation[k, 0], own.rotation[k, 1], own.rotation[k, 2]
        own.origin[k] += a * way.origin[0] + b * way.origin[1] + c * way.origin[2]
        for n in range(3):
            own.rotation[k, n] = a * m[0, n] + b * m[1, n] + c * m[2, n]


@inlined
def _carry(on: Place, own: Place) -> None:
    """Write the velocity of a body's origin that its parent causes."""
    dx = own.origin[0] - on.origin[0]
    dy = own.origin[1] - on.origin[1]
    dz = own.origin[2] - on.origin[2]
    own.velocity[0] = on.velocity[0] + on.spin[1] * dz - on.spin[2] * dy
    own.velocity[1] = on.velocity[1] + on.spin[2] * dx - on.spin[0] * dz
    own.velocity[2] = on.velocity[2] + on.spin[0] * dy - on.spin[1] * dx
