"""Forces and moments at the bearings of joints with load-dependent friction, compiled.

They follow from the accelerations of the bodies beyond a joint, minus the forces of closures and elements on
links: of redundant equations the least forces. ``room`` holds ``OF_BODY`` numbers of each body (acceleration
due to the coordinates' accelerations alone, force and moment at its origin, in the world), then scratch.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import PLANE, RIGID, ROTATION, SLIDE, Floats
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.force_kernels import least_forces, wrenches
from antenna_pin.dynamics.constraints.layout_kernels import (
    ClosureRecord,
    applied_in,
    body_at,
    closure_at,
    hold_at,
    place_at,
    plan_of,
)
from antenna_pin.elements import kernels as elements
from antenna_pin.mechanism.tree_kernels import Body, Place, cross

OF_BODY = 12
SCRATCH = 24


def room_for(bodies: int, closures: int, rows: int) -> int:
    """Return how many numbers of room there must be."""
    return OF_BODY * bodies + SCRATCH + rows + 6 * closures + 2 * rows * (rows + 1)


@kernel
def write_carried(
    program: Floats, plan: Floats, work: Floats, rates: Floats, room: Floats, out: Floats
) -> None:
    """Write the loads of joints with friction by load, (holds, 6).

    Across the axis force and moment, (2,) each, then along it both, at the bearing's middle, on the child.
    """
    head = plan_of(plan)
    _write_wrenches(plan, work, rates, room)
    for k in range(head.holds):
        own = hold_at(plan, k)
        radial, axial, _, middle = elements.bearing(own.kind, program, own.words)
        if radial == 0.0 and axial == 0.0:
            continue
        b = 0
        while body_at(plan, b).v != own.v:
            b += 1
        body, place, first = body_at(plan, b), place_at(work, b), OF_BODY * b
        force, moment = room[first + 6 : first + 9], room[first + 9 : first + 12]
        lever, axes = room[OF_BODY * head.bodies :], room[OF_BODY * head.bodies + 3 :]
        for i in range(3):
            axes[6 + i] = 0.0
            for c in range(3):
                axes[6 + i] += place.rotation[i, c] * body.axis[c]
            lever[i] = middle * axes[6 + i]
        _complete(axes)
        for c in range(3):
            along, turning = 0.0, 0.0
            for i in range(3):
                along += axes[3 * c + i] * force[i]
                turning += axes[3 * c + i] * (moment[i] - cross(lever, force, i))
            if c < 2:
                out[6 * k + c], out[6 * k + 2 + c] = along, turning
            else:
                out[6 * k + 4], out[6 * k + 5] = along, turning


@inlined
def _complete(axes: Floats) -> None:
    """Write two directions that are at right angles to a third, and to each other."""
    least = 0
    for c in range(1, 3):
        if abs(axes[6 + c]) < abs(axes[6 + least]):
            least = c
    size = math.sqrt(1.0 - axes[6 + least] * axes[6 + least])
    for c in range(3):
        axes[c] = ((1.0 if c == least else 0.0) - axes[6 + least] * axes[6 + c]) / size
    for c in range(3):
        axes[3 + c] = cross(axes[6:9], axes[0:3], c)


@kernel
def _write_wrenches(plan: Floats, work: Floats, rates: Floats, room: Floats) -> None:
    """Write accelerations of the bodies and loads at the joint origins, in world axes."""
    head = plan_of(plan)
    for b in range(head.bodies):
        _move(plan, work, rates, room, b)
    applied, _ = applied_in(plan)
    for b in range(head.bodies):
        for k in range(6):
            room[OF_BODY * b + 6 + k] -= work[applied + 6 * b + k]
    _take_closures(plan, work, room)
    for b in range(head.bodies - 1, -1, -1):
        parent = body_at(plan, b).parent
        if parent < 0:
            continue
        at, on = OF_BODY * b + 6, OF_BODY * parent + 6
        force, lever = room[at : at + 3], room[OF_BODY * head.bodies :]
        for k in range(3):
            lever[k] = place_at(work, b).origin[k] - place_at(work, parent).origin[k]
        for k in range(3):
            room[on + k] += force[k]
            room[on + 3 + k] += room[at + 3 + k] + cross(lever, force, k)


@inlined
def _move(plan: Floats, work: Floats, rates: Floats, room: Floats, b: int) -> None:
    """Write a body's acceleration and its own force and moment at its origin."""
    head, body, place, at = plan_of(plan), body_at(plan, b), place_at(work, b), OF_BODY * b
    spare = room[OF_BODY * head.bodies :]
    lever, slide, turn = spare[0:3], spare[3:6], spare[6:9]
    kind, v = body.kind, body.v
    for k in range(3):
        lever[k] = 0.0
        x = y = 0.0
        if kind == RIGID:
            x, y = rates[v + k], rates[v + 3 + k]
        elif kind == ROTATION:
            y = rates[v + k]
        elif kind == PLANE:
            x, y = (rates[v + k], 0.0) if k < 2 else (0.0, rates[v + 2])
        elif kind == SLIDE:
            x = body.axis[k] * rates[v]
        else:
            y = body.axis[k] * rates[v]
        slide[k], turn[k] = x, y
    if body.parent >= 0:
        for k in range(3):
            lever[k] = place.origin[k] - place_at(work, body.parent).origin[k]
    r = place.rotation
    for k in range(3):
        x = r[k, 0] * slide[0] + r[k, 1] * slide[1] + r[k, 2] * slide[2]
        y = r[k, 0] * turn[0] + r[k, 1] * turn[1] + r[k, 2] * turn[2]
        if body.parent >= 0:
            on = OF_BODY * body.parent
            x += room[on + k] + cross(room[on + 3 : on + 6], lever, k)
            y += room[on + 3 + k]
        room[at + k], room[at + 3 + k] = x, y
    # Due to accelerations of coordinates so far; those due to velocities are added.
    centre, total, spin = spare[0:3], spare[3:6], spare[6:9]
    for k in range(3):
        centre[k] = r[k, 0] * body.centre[0] + r[k, 1] * body.centre[1] + r[k, 2] * body.centre[2]
        spin[k] = room[at + 3 + k] + place.bias_spin[k]
    way = spare[9:12]
    for k in range(3):
        way[k] = cross(place.spin, centre, k)
    for k in range(3):
        total[k] = room[at + k] + place.bias[k] + cross(spin, centre, k) + cross(place.spin, way, k)
    for k in range(3):
        room[at + 6 + k] = body.mass * (total[k] - head.gravity[k])
    _gyrate(body, place, spin, spare[12:])
    for k in range(3):
        room[at + 9 + k] = spare[12 + k] + cross(centre, room[at + 6 : at + 9], k)


@inlined
def _gyrate(body: Body, place: Place, spin: Floats, out: Floats) -> None:
    """Write a body's inertial moment about its centre: I alpha + w x (I w)."""
    own = out[3:6]
    _turn_inertia(body, place, spin, out[6:12], own)
    for k in range(3):
        out[k] = own[k]
    _turn_inertia(body, place, place.spin, out[6:12], own)
    for k in range(3):
        out[k] += cross(place.spin, own, k)


@inlined
def _turn_inertia(body: Body, place: Place, vector: Floats, spare: Floats, out: Floats) -> None:
    """Write R I R^T times a vector."""
    r, inertia = place.rotation, body.inertia
    for k in range(3):
        spare[k] = r[0, k] * vector[0] + r[1, k] * vector[1] + r[2, k] * vector[2]
    for k in range(3):
        spare[3 + k] = inertia[k, 0] * spare[0] + inertia[k, 1] * spare[1] + inertia[k, 2] * spare[2]
    for k in range(3):
        out[k] = r[k, 0] * spare[3] + r[k, 1] * spare[4] + r[k, 2] * spare[5]


@inlined
def _take_closures(plan: Floats, work: Floats, room: Floats) -> None:
    """Take from what bodies need what closures do to them."""
    head = plan_of(plan)
    if head.closures == 0:
        return
    spare = room[OF_BODY * head.bodies :]
    forces, at = spare[9 : 9 + head.rows], 9 + head.rows
    held = spare[at : at + 6 * head.closures]
    least_forces(plan, work, spare[at + 6 * head.closures :], forces)
    wrenches(plan, work, forces, held.reshape((head.closures, 2, 3)))
    for c in range(head.closures):
        closure = closure_at(plan, c)
        # In the axes of the first side, the moment about the second side's point.
        for k in range(3):
            for part in range(2):
                total = 0.0
                for i in range(3):
                    axis = closure.first_rotation[k, i]
                    if closure.first >= 0:
                        on, own = place_at(work, closure.first).rotation, closure.first_rotation
                        axis = on[k, 0] * own[0, i] + on[k, 1] * own[1, i] + on[k, 2] * own[2, i]
                    total += axis * held[6 * c + 3 * part + i]
                spare[3 * part + k] = total
        for side in range(2):
            b = closure.first if side == 0 else closure.second
            if b < 0:
                continue
            sign, at_body = (1.0 if side == 0 else -1.0), OF_BODY * b + 6
            lever = spare[6:9]
            _from_body(work, closure, b, lever)
            for k in range(3):
                room[at_body + k] += sign * spare[k]
                room[at_body + 3 + k] += sign * (spare[3 + k] + cross(lever, spare[0:3], k))


@inlined
def _from_body(work: Floats, closure: ClosureRecord, b: int, lever: Floats) -> None:
    """Write the way from a body's origin to the second side's point."""
    point = closure.second_origin
    for k in range(3):
        lever[k] = point[k]
        if closure.second >= 0:
            on = place_at(work, closure.second)
            r = on.rotation
            lever[k] = on.origin[k] + r[k, 0] * point[0] + r[k, 1] * point[1] + r[k, 2] * point[2]
    for k in range(3):
        lever[k] -= place_at(work, b).origin[k]
