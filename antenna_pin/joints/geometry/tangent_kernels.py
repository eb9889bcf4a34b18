"""Changes of candidate contacts with journal motion and dimensions, compiled.

For a primitive with a closed form of its gap, gap, normal and point are differentiated by their definitions;
ends of sliders in guides are excluded (:func:`contact_changes`).

``pose`` and ``row`` are a journal (:data:`antenna_pin.base.records.POSE`) and a candidate
(:data:`antenna_pin.base.records.CONTACT`); ``way`` and ``change`` are the changes of the journal's centre,
axis and rotation and of the shape's dimensions.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Floats, Pose
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.joints.geometry.corner_kernels import CORNER, Corner
from antenna_pin.joints.geometry.kernels import (
    BALL,
    BORE,
    CANDIDATE,
    CIRCLE_IN_CIRCLE,
    CORNER_ON_WALL,
    FLANGE,
)
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE, Revolute
from antenna_pin.joints.geometry.round_kernels import ROUND, Round

#: Starts of the changes of gap, normal and point in the result, and its size.
GAP, NORMAL, POINT, CHANGED = 0, 1, 4, 7


@kernel
def _bore_changes(
    shape: Revolute, change: Revolute, pose: Pose, way: Pose, row: Contact, out: Floats
) -> None:
    """Changes of the point of a bore's end circle nearest to the journal's axis.

    With u from the journal's centre to the circle's point Q and d = u - (u . z) z square to the axis z, d . T
    = 0 along the circle's tangent T, always; this determines the angle of Q along the circle.
    """
    n, q, z, dz, moved = row.normal, row.point, pose.axis, way.axis, way.centre
    radius, reach = shape.bearing_radius, row.gap + shape.journal_radius
    ex, ey = q[0] / radius, q[1] / radius
    tx, ty = -ey, ex
    ux, uy, uz = q[0] - pose.centre[0], q[1] - pose.centre[1], q[2] - pose.centre[2]
    along = ux * z[0] + uy * z[1] + uz * z[2]
    grown, raised = change.bearing_radius, shape.side * change.half_length
    # Changes of u, and of d, with Q fixed on the circle.
    wx, wy, wz = grown * ex - moved[0], grown * ey - moved[1], raised - moved[2]
    turn = wx * z[0] + wy * z[1] + wz * z[2] + ux * dz[0] + uy * dz[1] + uz * dz[2]
    wx -= turn * z[0] + along * dz[0]
    wy -= turn * z[1] + along * dz[1]
    wz -= turn * z[2] + along * dz[2]
    lean = tx * z[0] + ty * z[1]
    square = radius * (1.0 - lean * lean) + reach * (n[0] * ex + n[1] * ey)
    arc = -radius * (wx * tx + wy * ty) / square if square != 0.0 else 0.0
    wx += arc * (tx - lean * z[0])
    wy += arc * (ty - lean * z[1])
    wz -= arc * lean * z[2]
    closing = wx * n[0] + wy * n[1] + wz * n[2]
    out[GAP] = -closing - change.journal_radius
    out[NORMAL] = (closing * n[0] - wx) / reach
    out[NORMAL + 1] = (closing * n[1] - wy) / reach
    out[NORMAL + 2] = (closing * n[2] - wz) / reach
    out[POINT] = grown * ex + arc * tx
    out[POINT + 1] = grown * ey + arc * ty
    out[POINT + 2] = raised


@kernel
def _flange_changes(
    shape: Revolute, change: Revolute, pose: Pose, way: Pose, row: Contact, out: Floats
) -> None:
    """Write the changes of the deepest point of a flange's rim.

    If the flange covers the bearing's edge it is that of the edge.

    With parallel axes the deepest point is that on the axis, and stays there.
    """
    o, z, do, dz, side, sine = pose.centre, pose.axis, way.centre, way.axis, shape.side, pose.sine
    ux, uy, dx, dy = 0.0, 0.0, 0.0, 0.0
    if sine > 0.0:
        ux, uy = z[0] / sine, z[1] / sine
        dx, dy = (dz[0] - ux * way.sine) / sine, (dz[1] - uy * way.sine) / sine
    half, reach = change.half_length, change.half_distance
    if shape.flange_radius >= shape.outer_radius:
        outer, grown = shape.outer_radius, change.outer_radius
        up = side * shape.half_length - o[2]
        along = -do[0] * z[0] - do[1] * z[1] - o[0] * dz[0] - o[1] * dz[1]
        along += (side * half - do[2]) * z[2] + up * dz[2]
        out[GAP] = reach - side * along - grown * sine - outer * way.sine
        for i in range(3):
            out[NORMAL + i] = side * dz[i]
        out[POINT] = side * (grown * ux + outer * dx)
        out[POINT + 1] = side * (grown * uy + outer * dy)
        out[POINT + 2] = side * half
        return
    flange, grown = shape.flange_radius, change.flange_radius
    far = shape.half_distance
    raised = do[2] + side * (reach * z[2] + far * dz[2])
    out[GAP] = side * raised - half - grown * sine - flange * way.sine
    for i in range(3):
        out[NORMAL + i] = 0.0
    # The steepest direction towards the bearing in the plane of the flange, which is (ux zz, uy zz, -sine).
    out[POINT] = do[0] + side * (reach * z[0] + far * dz[0])
    out[POINT] += side * (grown * ux * z[2] + flange * (dx * z[2] + ux * dz[2]))
    out[POINT + 1] = do[1] + side * (reach * z[1] + far * dz[1])
    out[POINT + 1] += side * (grown * uy * z[2] + flange * (dy * z[2] + uy * dz[2]))
    out[POINT + 2] = raised - side * (grown * sine + flange * way.sine)


@kernel
def _round_changes(shape: Round, change: Round, flat: bool, way: Pose, row: Contact, out: Floats) -> None:
    """Write the changes of a ball's candidate, or of a circle's if ``flat``."""
    n, radius = row.normal, shape.bearing_radius
    off = radius - shape.journal_radius - row.gap
    x, y, z = way.centre[0], way.centre[1], 0.0 if flat else way.centre[2]
    closing = x * n[0] + y * n[1] + z * n[2]
    out[GAP] = change.bearing_radius - change.journal_radius + closing
    part = 1.0 / off if off > 0.0 else 0.0
    out[NORMAL] = (closing * n[0] - x) * part
    out[NORMAL + 1] = (closing * n[1] - y) * part
    out[NORMAL + 2] = (closing * n[2] - z) * part
    for i in range(3):
        out[POINT + i] = -change.bearing_radius * n[i] - radius * out[NORMAL + i]


@kernel
def _corner_changes(shape: Corner, change: Corner, pose: Pose, way: Pose, row: Contact, out: Floats) -> None:
    """Changes of a rounded corner's candidate on its wall."""
    gap = change.distance - change.radius
    for i in range(3):
        moved = way.centre[i]
        for k in range(3):
            moved += way.rotation[i, k] * shape.corner[k] + pose.rotation[i, k] * change.corner[k]
        wall, turned = shape.wall[i], change.wall[i]
        gap += turned * (row.point[i] + shape.radius * wall) + wall * moved
        out[NORMAL + i] = turned
        out[POINT + i] = moved - change.radius * wall - shape.radius * turned
    out[GAP] = gap


@inlined
def has_closed_changes(primitive: int) -> bool:
    """Return whether :func:`contact_changes` supports a primitive."""
    return primitive == CORNER_ON_WALL or (primitive >= BORE and primitive <= BALL)


@kernel
def contact_changes(words: Floats, change: Floats, pose: Pose, way: Pose, row: Contact, out: Floats) -> None:
    """Write changes of gap, normal and point of a candidate of closed form.

    Args:
        words: Its record, (CANDIDATE,).
        change: Changes of its dimensions, likewise.
        pose: The journal, POSE.
        way: Changes of centre, axis, its sine, and rotation, POSE.
        row: The candidate, CONTACT; for a flange with the deepest point.
        out: Written, (CHANGED,).
    """
    primitive = record(words[:CANDIDATE], REVOLUTE).primitive
    if primitive == BORE:
        _bore_changes(
            record(words[:CANDIDATE], REVOLUTE), record(change[:CANDIDATE], REVOLUTE), pose, way, row, out
        )
    elif primitive == FLANGE:
        _flange_changes(
            record(words[:CANDIDATE], REVOLUTE), record(change[:CANDIDATE], REVOLUTE), pose, way, row, out
        )
    elif primitive == CORNER_ON_WALL:
        _corner_changes(
            record(words[:CANDIDATE], CORNER), record(change[:CANDIDATE], CORNER), pose, way, row, out
        )
    elif not has_closed_changes(primitive):
        out[GAP] = math.nan
    else:
        flat = primitive == CIRCLE_IN_CIRCLE
        _round_changes(
            record(words[:CANDIDATE], ROUND), record(change[:CANDIDATE], ROUND), flat, way, row, out
        )
