"""The rows of all constraints in one state, compiled: J, right sides, residuals.

A row is one equation: ``J a = lack`` of accelerations, ``J v = 0`` of velocities except for a motion's rate,
with residuals ``gap`` and ``speed``. Rows of rotations are multiplied by the plan's length, so that all are
in metres.

The row of an element that holds its joint is that of a motion to the held position, and zero otherwise.

A coupling's is ``follower - multiplier leader - second further = offset`` in the positions of two or three
joints, scaled so that its largest number is that of a single rotation or displacement.

For a closure let A and B be its frames, d the vector from A's origin to B's, n an axis of A, w angular
velocities and v_r = v_B - v_A - w_A x d the velocity of B's origin relative to A. Held along n::

    gap  n . d    speed  n . v_r
    acceleration  n . (a_B - a_A - alpha_A x d - w_A x (w_A x d) - 2 w_A x v_r)

rotation about n blocked, with the rotation vector phi of B in A::

    gap  n . phi    speed  n . (w_B - w_A)
    acceleration  n . (alpha_B - alpha_A) + (w_A x n) . (w_B - w_A)

and the axes a of A and b of B held at right angles, with e = b x a::

    gap  a . b    speed  e . (w_B - w_A)
    acceleration  e . (alpha_B - alpha_A) + e' . (w_B - w_A)
"""

from __future__ import annotations

import math

from antenna_pin.base.records import CIRCLE, FIXED_AXIS, PLANE, RIGID, SLIDE, Floats, Triple
from antenna_pin.compiled.decorators import deferred, inlined, kernel
from antenna_pin.dynamics.constraints.driven_kernels import driven_rate, twist_row
from antenna_pin.dynamics.constraints.layout_kernels import (
    BODY_WORDS,
    PLACE_WORDS,
    PLAN_WORDS,
    ClosureRecord,
    Coupled,
    Driven,
    body_at,
    closure_at,
    coupled_at,
    driven_at,
    found_in,
    hold_at,
    place_at,
    plan_of,
)
from antenna_pin.elements import kernels as elements
from antenna_pin.mechanism.room_kernels import Nine
from antenna_pin.mechanism.tree_kernels import (
    BODY,
    PLACE,
    Place,
    bias_accelerations,
    cross,
    place_bodies,
    unwrapped,
)

# Round-off of a difference of numbers, over the sum of their sizes: half an ulp of each, several times.
_ROUND_OFF = 4.0 * 2.220446049250313e-16


@deferred
def write_rows(t: float, y: Floats, program: Floats, plan: Floats, work: Floats) -> None:
    """Write the rows of all constraints at time t [s] and state y, with residuals."""
    _write(t, y, program, plan, work, True)


@kernel
def write_residuals(t: float, y: Floats, program: Floats, plan: Floats, work: Floats) -> None:
    """Write residuals as :func:`write_rows`, but leave J; biases of accelerations are overwritten."""
    _write(t, y, program, plan, work, False)


@inlined
def _write(t: float, y: Floats, program: Floats, plan: Floats, work: Floats, whole: bool) -> None:
    head = plan_of(plan)
    tree = plan[PLAN_WORDS : PLAN_WORDS + BODY_WORDS * head.bodies].view(BODY)
    places = work[: PLACE_WORDS * (head.bodies + 1)].view(PLACE)
    place_bodies(y, head.nq, tree, places)
    found = found_in(plan, work)
    found.gap = found.turn = found.speed = found.spin = 0.0
    if whole:
        bias_accelerations(tree, places)
        for k in range(head.width * head.nv):
            work[head.jacobian + k] = 0.0
    for c in range(head.closures):
        closure = closure_at(plan, c)
        _closure_rows(plan, work, closure)
        if whole:
            closure_columns(plan, work, closure)
    for m in range(head.motions):
        _motion_row(t, y, program, plan, work, driven_at(plan, m))
    for k in range(head.couplings):
        _coupling_row(y, plan, work, coupled_at(plan, k))
    for k in range(head.holds):
        _hold_row(y, program, plan, work, hold_at(plan, k))


@inlined
def _larger(a: float, b: float) -> float:
    """Return the larger of two numbers; NaN if one is none, which closes nothing."""
    return a if a > b or a != a else b


@inlined
def _note(plan: Floats, work: Floats, row: int, turns: bool, gap: float, speed: float, lack: float) -> None:
    """Write a row's numbers, and remember the largest residuals."""
    head, found = plan_of(plan), found_in(plan, work)
    scale = head.length if turns else 1.0
    work[head.gap + row] = scale * gap
    work[head.speed + row] = scale * speed
    work[head.lack + row] = scale * lack
    if turns:
        found.turn = _larger(found.turn, abs(gap))
        found.spin = _larger(found.spin, abs(speed))
    else:
        found.gap = _larger(found.gap, abs(gap))
        found.speed = _larger(found.speed, abs(speed))


@inlined
def _position(y: Floats, x: int, q: int, turn: int) -> float:
    """Return the position of a single-axis joint in a state, with whole turns.

    The state is [q, v, x]; x begins at ``x``, with turned angles at ``turn``.
    """
    if turn < 0:
        return float(y[q])
    return unwrapped(math.atan2(y[q + 1], y[q]), y[x + turn])


@kernel
def _motion_row(t: float, y: Floats, program: Floats, plan: Floats, work: Floats, driven: Driven) -> None:
    head = plan_of(plan)
    wanted, rate, acceleration = elements.motion(driven.kind, program, driven.words, t)
    if driven.moves != 0:
        angle, bias = twist_row(y, plan, work, driven)
        speed = driven_rate(y, plan, work, driven) - rate
        _note(plan, work, driven.row, True, angle - wanted, speed, acceleration - bias)
        return
    angle = _position(y, head.nq + head.nv, driven.q, driven.turn)
    turns = driven.slides == 0
    work[head.jacobian + driven.v * head.width + driven.row] = head.length if turns else 1.0
    speed = y[head.nq + driven.v] - rate
    _note(plan, work, driven.row, turns, angle - wanted, speed, acceleration)


@kernel
def _hold_row(y: Floats, program: Floats, plan: Floats, work: Floats, own: Driven) -> None:
    """Write the row of an element that may hold its joint; zeros, dropped later, otherwise."""
    head = plan_of(plan)
    held, where = elements.hold(own.kind, program, own.words)
    turns = own.slides == 0
    number = gap = speed = 0.0
    if held:
        number = head.length if turns else 1.0
        gap = _position(y, head.nq + head.nv, own.q, own.turn) - where
        speed = y[head.nq + own.v]
    work[head.jacobian + own.v * head.width + own.row] = number
    _note(plan, work, own.row, turns, gap, speed, 0.0)


@kernel
def _coupling_row(y: Floats, plan: Floats, work: Floats, coupled: Coupled) -> None:
    head = plan_of(plan)
    q, v, turn, x = coupled.q, coupled.v, coupled.turn, head.nq + head.nv
    follower = _position(y, x, q[0], turn[0])
    led = coupled.multiplier * _position(y, x, q[1], turn[1])
    other = 0.0
    if coupled.second != 0.0:
        other = coupled.second * _position(y, x, q[2], turn[2])
    gap = follower - led - other - coupled.offset
    # For angles of many turns round-off exceeds the tolerance of closed loops, and is no residual.
    if abs(gap) <= _ROUND_OFF * (abs(follower) + abs(led) + abs(other) + abs(coupled.offset)):
        gap = 0.0
    speed = y[head.nq + v[0]] - coupled.multiplier * y[head.nq + v[1]]
    if coupled.second != 0.0:
        speed -= coupled.second * y[head.nq + v[2]]
    turns = coupled.slides == 0
    number = coupled.scale * (head.length if turns else 1.0)
    at = head.jacobian + coupled.row
    work[at + v[2] * head.width] = -number * coupled.second
    work[at + v[1] * head.width] = -number * coupled.multiplier
    work[at + v[0] * head.width] = number
    _note(plan, work, coupled.row, turns, coupled.scale * gap, coupled.scale * speed, 0.0)


@inlined
def _place_frame(plan: Floats, work: Floats, b: int, rotation: Floats, origin: Floats, own: Place) -> None:
    """Write placement and motion of a closure's frame on a body or the world."""
    if b < 0:
        for k in range(3):
            own.origin[k] = origin[k]
            own.velocity[k] = own.spin[k] = own.bias[k] = own.bias_spin[k] = 0.0
            for n in range(3):
                own.rotation[k, n] = rotation[k, n]
        return
    on = place_at(work, b)
    for k in range(3):
        # Lever from the body's origin, temporarily.
        own.slide[k] = 0.0
        for n in range(3):
            own.slide[k] += on.rotation[k, n] * origin[n]
            own.rotation[k, n] = (
                on.rotation[k, 0] * rotation[0, n]
                + on.rotation[k, 1] * rotation[1, n]
                + on.rotation[k, 2] * rotation[2, n]
            )
    for k in range(3):
        own.turn[k] = cross(on.spin, own.slide, k)
    for k in range(3):
        own.origin[k] = on.origin[k] + own.slide[k]
        own.velocity[k] = on.velocity[k] + own.turn[k]
        own.spin[k] = on.spin[k]
        own.bias_spin[k] = on.bias_spin[k]
        own.bias[k] = on.bias[k] + cross(on.bias_spin, own.slide, k) + cross(on.spin, own.turn, k)


@kernel
def _closure_rows(plan: Floats, work: Floats, closure: ClosureRecord) -> None:
    head = plan_of(plan)
    # Fields of the frames and of the scratch body are used for vectors.
    a, b = place_at(work, head.bodies + 1), place_at(work, head.bodies + 2)
    room = place_at(work, head.bodies)
    _place_frame(plan, work, closure.first, closure.first_rotation, closure.first_origin, a)
    _place_frame(plan, work, closure.second, closure.second_rotation, closure.second_origin, b)
    way, seen, bias = room.origin, room.velocity, room.bias
    spin, bias_spin, angle = room.spin, room.bias_spin, room.turn
    for k in range(3):
        way[k] = b.origin[k] - a.origin[k]
        spin[k] = b.spin[k] - a.spin[k]
        bias_spin[k] = b.bias_spin[k] - a.bias_spin[k]
    for k in range(3):
        seen[k] = b.velocity[k] - a.velocity[k] - cross(a.spin, way, k)
    for k in range(3):
        # w_A x d + 2 v_r; w_A x of it is the rest.
        room.slide[k] = cross(a.spin, way, k) + 2.0 * seen[k]
    for k in range(3):
        bias[k] = b.bias[k] - a.bias[k] - cross(a.bias_spin, way, k) - cross(a.spin, room.slide, k)
    if closure.about[0] + closure.about[1] + closure.about[2] != 0:
        _rotation_vector(a, b, closure.attitude, angle)
    row = closure.row
    for k in range(3):
        if closure.along[k] != 0:
            gap = speed = lack = 0.0
            for n in range(3):
                axis = a.rotation[n, k]
                gap += axis * way[n]
                speed += axis * seen[n]
                lack -= axis * bias[n]
            _note(plan, work, row, False, gap, speed, lack)
            row += 1
    for k in range(3):
        if closure.about[k] != 0:
            speed = lack = 0.0
            for n in range(3):
                i, j = (n + 1) % 3, (n + 2) % 3
                axis = a.rotation[n, k]
                turning = a.spin[i] * a.rotation[j, k] - a.spin[j] * a.rotation[i, k]
                speed += axis * spin[n]
                lack -= axis * bias_spin[n] + turning * spin[n]
            _note(plan, work, row, True, angle[k], speed, lack)
            row += 1
    if closure.square != 0:
        _square_row(plan, work, row, a, b, spin, bias_spin)


@inlined
def _rotation_vector(a: Place, b: Place, attitude: int, angle: Floats) -> None:
    """Write the rotation vector, in A, of B or of its held third axis."""
    p, q = a.rotation, b.rotation
    zx = p[0, 0] * q[0, 2] + p[1, 0] * q[1, 2] + p[2, 0] * q[2, 2]
    zy = p[0, 1] * q[0, 2] + p[1, 1] * q[1, 2] + p[2, 1] * q[2, 2]
    zz = p[0, 2] * q[0, 2] + p[1, 2] * q[1, 2] + p[2, 2] * q[2, 2]
    angle[0], angle[1], angle[2] = -zy, zx, 0.0
    cosine = zz
    if attitude != 0:
        xx = p[0, 0] * q[0, 0] + p[1, 0] * q[1, 0] + p[2, 0] * q[2, 0]
        xy = p[0, 1] * q[0, 0] + p[1, 1] * q[1, 0] + p[2, 1] * q[2, 0]
        xz = p[0, 2] * q[0, 0] + p[1, 2] * q[1, 0] + p[2, 2] * q[2, 0]
        yx = p[0, 0] * q[0, 1] + p[1, 0] * q[1, 1] + p[2, 0] * q[2, 1]
        yy = p[0, 1] * q[0, 1] + p[1, 1] * q[1, 1] + p[2, 1] * q[2, 1]
        yz = p[0, 2] * q[0, 1] + p[1, 2] * q[1, 1] + p[2, 2] * q[2, 1]
        angle[0], angle[1], angle[2] = 0.5 * (yz - zy), 0.5 * (zx - xz), 0.5 * (xy - yx)
        cosine = 0.5 * (xx + yy + zz - 1.0)
    sine = math.sqrt(angle[0] * angle[0] + angle[1] * angle[1] + angle[2] * angle[2])
    whole = math.atan2(sine, cosine)
    if sine > 1e-9:
        for k in range(3):
            angle[k] *= whole / sine
    elif cosine < 0.0:
        # Opposite: the axis is undetermined.
        angle[0], angle[1], angle[2] = whole, 0.0, 0.0


@inlined
def _square_row(
    plan: Floats, work: Floats, row: int, a: Place, b: Place, spin: Floats, bias_spin: Floats
) -> None:
    """Write the row of two perpendicular axes; direction e lies along ``slide``."""
    gap = speed = lack = 0.0
    for n in range(3):
        i, j = (n + 1) % 3, (n + 2) % 3
        gap += a.rotation[n, 2] * b.rotation[n, 2]
        a.slide[n] = b.rotation[i, 2] * a.rotation[j, 2] - b.rotation[j, 2] * a.rotation[i, 2]
        # The rates of the two axes.
        a.turn[n] = a.spin[i] * a.rotation[j, 2] - a.spin[j] * a.rotation[i, 2]
        b.turn[n] = b.spin[i] * b.rotation[j, 2] - b.spin[j] * b.rotation[i, 2]
    for n in range(3):
        i, j = (n + 1) % 3, (n + 2) % 3
        turning = (
            b.turn[i] * a.rotation[j, 2]
            - b.turn[j] * a.rotation[i, 2]
            + b.rotation[i, 2] * a.turn[j]
            - b.rotation[j, 2] * a.turn[i]
        )
        speed += a.slide[n] * spin[n]
        lack -= a.slide[n] * bias_spin[n] + turning * spin[n]
    _note(plan, work, row, True, gap, speed, lack)


# --- columns of a row ---------------------------------------------------------------------------------------


#: Directions of a closure, 0 or 1: along and about each axis of its first frame, and the angle of two axes.
Held = tuple[int, int, int, int, int, int, int]
#: Axes of the first frame, row after row, held directions, and the direction of the angle of two axes.
Holds = tuple[Nine, Held, Triple]


@kernel
def closure_columns(plan: Floats, work: Floats, closure: ClosureRecord) -> None:
    """Write J of a closure whose frames are placed; ``slide`` is its first perpendicular axis."""
    # Local copies: for a compiler the output could be the same array.
    a, b = place_at(work, plan_of(plan).bodies + 1), place_at(work, plan_of(plan).bodies + 2)
    r, along, about = a.rotation, closure.along, closure.about
    frame = (r[0, 0], r[1, 0], r[2, 0], r[0, 1], r[1, 1], r[2, 1], r[0, 2], r[1, 2], r[2, 2])
    held = (along[0], along[1], along[2], about[0], about[1], about[2], closure.square)
    origin = (b.origin[0], b.origin[1], b.origin[2])
    holds = frame, held, (a.slide[0], a.slide[1], a.slide[2])
    first, second = closure.first, closure.second
    # Down to the common body: bodies below move both sides equally.
    while first != second:
        if first > second:
            _columns(plan, work, closure.row, first, -1.0, origin, holds)
            first = body_at(plan, first).parent
        else:
            _columns(plan, work, closure.row, second, 1.0, origin, holds)
            second = body_at(plan, second).parent


@inlined
def _columns(plan: Floats, work: Floats, row: int, b: int, sign: float, origin: Triple, holds: Holds) -> None:
    """Write the columns of a closure's rows that belong to the joint of a body.

    Args:
        plan: Plan of the constraints.
        work: Written.
        row: First row of the closure.
        b: The body.
        sign: 1 if it carries the second side, -1 if the first.
        origin: Origin of the closure's second frame.
        holds: Axes along and about which the closure holds, consecutively; held displacements and rotations,
            and whether two axes are at right angles; axis of their relative rotation.
    """
    frame, held, _ = holds
    head = plan_of(plan)
    body, own = body_at(plan, b), place_at(work, b)
    r, kind, width, length = own.rotation, body.kind, head.width, head.length
    at = head.jacobian + body.v * width + row
    d = (origin[0] - own.origin[0], origin[1] - own.origin[1], origin[2] - own.origin[2])
    if kind == FIXED_AXIS or kind == CIRCLE or kind == SLIDE:
        axis = body.axis
        x = sign * (r[0, 0] * axis[0] + r[0, 1] * axis[1] + r[0, 2] * axis[2])
        y = sign * (r[1, 0] * axis[0] + r[1, 1] * axis[1] + r[1, 2] * axis[2])
        z = sign * (r[2, 0] * axis[0] + r[2, 1] * axis[1] + r[2, 2] * axis[2])
        if kind == SLIDE:
            _way_column(work, at, x, y, z, frame, held)
        else:
            _turn_column(work, at, length, (x, y, z), d, holds)
        return
    for k in range(3 if kind == RIGID else 2 if kind == PLANE else 0):
        _way_column(work, at, sign * r[0, k], sign * r[1, k], sign * r[2, k], frame, held)
        at += width
    for k in range(2 if kind == PLANE else 0, 3):
        x, y, z = sign * r[0, k], sign * r[1, k], sign * r[2, k]
        _turn_column(work, at, length, (x, y, z), d, holds)
        at += width


@inlined
def _way_column(work: Floats, at: int, x: float, y: float, z: float, frame: Nine, restraint: Held) -> None:
    """Write one column of a closure's rows, at ``work[at:]``, for translation along (x, y, z)."""
    if restraint[0] != 0:
        work[at] = frame[0] * x + frame[1] * y + frame[2] * z
        at += 1
    if restraint[1] != 0:
        work[at] = frame[3] * x + frame[4] * y + frame[5] * z
        at += 1
    if restraint[2] != 0:
        work[at] = frame[6] * x + frame[7] * y + frame[8] * z


@inlined
def _turn_column(work: Floats, at: int, length: float, axis: Triple, d: Triple, holds: Holds) -> None:
    """Write one column of a closure's rows, at ``work[at:]``, for rotation about an axis."""
    x, y, z = axis
    frame, held, square = holds
    _way_column(work, at, y * d[2] - z * d[1], z * d[0] - x * d[2], x * d[1] - y * d[0], frame, held)
    at += held[0] + held[1] + held[2]
    if held[3] != 0:
        work[at] = length * (frame[0] * x + frame[1] * y + frame[2] * z)
        at += 1
    if held[4] != 0:
        work[at] = length * (frame[3] * x + frame[4] * y + frame[5] * z)
        at += 1
    if held[5] != 0:
        work[at] = length * (frame[6] * x + frame[7] * y + frame[8] * z)
        at += 1
    if held[6] != 0:
        work[at] = length * (square[0] * x + square[1] * y + square[2] * z)
