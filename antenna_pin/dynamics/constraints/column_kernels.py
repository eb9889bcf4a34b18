"""J of a closure, compiled: columns of the joints that carry its two sides."""

from __future__ import annotations

from antenna_pin.base.records import CIRCLE, FIXED_AXIS, PLANE, RIGID, SLIDE, Floats, Triple
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.dynamics.constraints.layout_kernels import ClosureRecord, body_at, place_at, plan_of
from antenna_pin.mechanism.room_kernels import Nine

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
