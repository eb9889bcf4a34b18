"""What the coal backend of the revolute joint needs around its queries, compiled.

The journal frame J used here has its z axis along the journal and an arbitrary rotation about it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from antenna_pin._compile import inlined, kernel, record
from antenna_pin.geometry.revolute_kernels import REVOLUTE, bore_contact, flange_contact
from antenna_pin.records import layout, words_of

#: Placement of H in J.
FRAME = layout(("rotation", "f8", (3, 3)), ("origin", "f8", (3,)))
#: The search on an end circle: the point asked, in J (read by coal) and in H [m]; where the circle stands, in
#: half lengths, and the point's angle on it [rad]; whether the journal's axis passes through the circle;
#: normal in H and gap [m], infinite until it is asked.
END = layout(
    ("in_journal", "f8", (3,)),
    ("in_bearing", "f8", (3,)),
    ("side", "f8"),
    ("angle", "f8"),
    ("inside", "i8"),
    ("normal", "f8", (3,)),
    ("gap", "f8"),
)
#: coal's answer about a flange, in J: distance [m], infinite until it is asked, normal from bearing to
#: journal, nearest point [m].
FLANGE_ANSWER = layout(("gap", "f8"), ("normal", "f8", (3,)), ("point", "f8", (3,)))

# What the kernels are given is one flat array with all of that in it: each array that Python hands over takes
# its time, twice that if it is one of records. Where REVOLUTE, FRAME, END at +z and at -z, and the
# FLANGE_ANSWERs begin in it, and its size.
SHAPE_AT = 0
FRAME_AT = SHAPE_AT + words_of(REVOLUTE)
END_WORDS = words_of(END)
ENDS_AT = FRAME_AT + words_of(FRAME)
ANSWER_WORDS = words_of(FLANGE_ANSWER)
ANSWERS_AT = ENDS_AT + 2 * END_WORDS
WORDS = ANSWERS_AT + 2 * ANSWER_WORDS
# Which END is which, in a type that coal_start is compiled for once.
_UPPER: Any = np.int64(0)
_LOWER: Any = np.int64(1)


@inlined
def _shape_in(work: Any) -> Any:
    return record(work[SHAPE_AT:FRAME_AT], REVOLUTE)


@inlined
def _frame_in(work: Any) -> Any:
    return record(work[FRAME_AT:ENDS_AT], FRAME)


@inlined
def _end_in(work: Any, k: int) -> Any:
    return record(work[ENDS_AT + k * END_WORDS : ENDS_AT + (k + 1) * END_WORDS], END)


@inlined
def _answer_in(work: Any, k: int) -> Any:
    return record(work[ANSWERS_AT + k * ANSWER_WORDS : ANSWERS_AT + (k + 1) * ANSWER_WORDS], FLANGE_ANSWER)


@kernel
def coal_place(work: Any, pose: Any) -> tuple[bool, bool]:
    """Place the bearing in the journal frame and start the search on both end circles.

    Args:
        work: Flat, WORDS; its FRAME and ENDs are filled: at +z, at -z.
        pose: POSE, (1,).

    Returns:
        Whether the journal's axis passes through the circles, so that there is something to ask.
    """
    at = _frame_in(work)
    for k in range(2):
        _answer_in(work, k).gap = math.inf
    ox, oy, oz = pose[0].centre[0], pose[0].centre[1], pose[0].centre[2]
    zx, zy, zz = pose[0].axis[0], pose[0].axis[1], pose[0].axis[2]
    # Smallest rotation taking the z axis to z: R = I + [k] + [k]^2 / (1 + zz), k = e_z x z.
    if zz > -0.5:
        f = 1.0 / (1.0 + zz)
        # Columns of the rotation J -> H are (r00, r01, -zx), (r01, r11, -zy), (zx, zy, zz).
        at.rotation[0, 0] = 1.0 - f * zx * zx
        at.rotation[0, 1] = -f * zx * zy
        at.rotation[0, 2] = -zx
        at.rotation[1, 0] = -f * zx * zy
        at.rotation[1, 1] = 1.0 - f * zy * zy
        at.rotation[1, 2] = -zy
    else:
        # Upside down: first half a turn about x, then the smallest rotation.
        g = 1.0 / (1.0 - zz)
        at.rotation[0, 0] = 1.0 - g * zx * zx
        at.rotation[0, 1] = -g * zx * zy
        at.rotation[0, 2] = zx
        at.rotation[1, 0] = g * zx * zy
        at.rotation[1, 1] = -(1.0 - g * zy * zy)
        at.rotation[1, 2] = -zy
    at.rotation[2, 0] = zx
    at.rotation[2, 1] = zy
    at.rotation[2, 2] = zz
    for i in range(3):
        at.origin[i] = -(at.rotation[i, 0] * ox + at.rotation[i, 1] * oy + at.rotation[i, 2] * oz)
    return coal_start(work, _UPPER, 1.0, pose), coal_start(work, _LOWER, -1.0, pose)


@kernel
def coal_start(work: Any, k: int, side: float, pose: Any) -> bool:
    """Start the search on the circle at ``side`` times half the length; whether END k is to be asked."""
    # Towards the side of the bore that the journal axis is nearest to, where it cuts the circle's plane.
    ox, oy, oz = pose[0].centre[0], pose[0].centre[1], pose[0].centre[2]
    zx, zy, zz = pose[0].axis[0], pose[0].axis[1], pose[0].axis[2]
    shape, end = _shape_in(work), _end_in(work, k)
    radius = shape.bearing_radius
    lift = (side * shape.half_length - oz) / zz if zz != 0.0 else 0.0
    cx = ox + lift * zx
    cy = oy + lift * zy
    inside = bool(zz != 0.0 and cx * cx + cy * cy <= radius * radius)
    end.side = side
    end.gap = math.inf
    end.angle = math.atan2(cy, cx) if (cx != 0.0 or cy != 0.0) else 0.0
    end.inside = 1 if inside else 0
    _place_point(shape, _frame_in(work), end)
    return inside


@kernel
def _place_point(shape: Any, frame: Any, end: Any) -> None:
    end.in_bearing[0] = shape.bearing_radius * math.cos(end.angle)
    end.in_bearing[1] = shape.bearing_radius * math.sin(end.angle)
    end.in_bearing[2] = end.side * shape.half_length
    for i in range(3):
        end.in_journal[i] = (
            frame.rotation[i, 0] * end.in_bearing[0]
            + frame.rotation[i, 1] * end.in_bearing[1]
            + frame.rotation[i, 2] * end.in_bearing[2]
            + frame.origin[i]
        )


@kernel
def coal_turn(work: Any, k: int, normal: Any, gap: float) -> bool:
    """Make one Newton step of d gap / d phi = 0 in END k from coal's gap and normal (in J); True when done.

    The derivative of the gap along the circle is -n . dQ/dphi; its own derivative follows from the curvature
    of the distance to a line. Once the step is below 1e-5 rad, gap and normal are carried over it to second
    and first order, which is exact to 1e-10 in the normal and far below round-off in the gap: no further
    query is needed. Where the minimum is so flat that its angle is lost in round-off the gap decides.
    """
    shape, at, end = _shape_in(work), _frame_in(work), _end_in(work, k)
    nx, ny, nz = normal[0], normal[1], normal[2]
    hx = at.rotation[0, 0] * nx + at.rotation[1, 0] * ny + at.rotation[2, 0] * nz
    hy = at.rotation[0, 1] * nx + at.rotation[1, 1] * ny + at.rotation[2, 1] * nz
    hz = at.rotation[0, 2] * nx + at.rotation[1, 2] * ny + at.rotation[2, 2] * nz
    radius = shape.bearing_radius
    qx, qy = end.in_bearing[0], end.in_bearing[1]
    tx = -qy
    ty = qx
    slope = -(hx * tx + hy * ty)
    # dist'' = (|t_perp|^2 - (n.t)^2) / dist - n . Q'' with t_perp the tangent's part square to the journal
    # axis and Q'' = -(qx, qy, 0).
    zx, zy, zz = at.rotation[2, 0], at.rotation[2, 1], at.rotation[2, 2]
    along = tx * zx + ty * zy
    span = gap + shape.journal_radius
    curvature = (radius * radius - along * along - slope * slope) / span + hx * qx + hy * qy
    if curvature > 0.0:
        step = -slope / curvature
        gain = 0.5 * slope * slope / curvature
        if step > 0.5:
            step = 0.5
        elif step < -0.5:
            step = -0.5
    else:
        step = -0.5 if slope > 0.0 else 0.5
        gain = 1.0
    done = bool(abs(step) < 1e-5 or gain < 1e-24)
    # n changes by -(t_perp - (n.t) n) / dist per radian.
    f = step / span if done else 0.0
    hx -= f * (tx - along * zx + slope * hx)
    hy -= f * (ty - along * zy + slope * hy)
    hz -= f * (-along * zz + slope * hz)
    scale = 1.0 / math.sqrt(hx * hx + hy * hy + hz * hz)
    end.normal[0] = hx * scale
    end.normal[1] = hy * scale
    end.normal[2] = hz * scale
    end.gap = gap - gain if done else gap
    end.angle += step
    _place_point(shape, at, end)
    return done


@kernel
def coal_collect(work: Any, pose: Any, table: Any, row: int) -> None:
    """Turn coal's answers into the four rows of the table, in H.

    The bore's stand in the ENDs of ``work``, the flanges' in its FLANGE_ANSWERs. Of a cylinder exactly
    parallel to the normal, up to a tilt of some 1e-12, coal takes the middle of the end face for the nearest
    point, 1e-10 of half its length too far out: that is put right. Where the axis of the journal passes
    outside an end circle, which parts cannot do, the closed form's gap stands. A row that was not asked for
    stays as it is.
    """
    dimensions, at = _shape_in(work), _frame_in(work)
    for k in range(2):
        out = table[row + k]
        end = _end_in(work, k)
        if end.inside == 0:
            bore_contact(dimensions, 1.0 - 2.0 * k, pose[0], out)
            continue
        if end.gap == math.inf:
            continue
        out.gap = end.gap
        for i in range(3):
            out.normal[i] = end.normal[i]
            out.point[i] = end.in_bearing[i]
    for k in range(2):
        out = table[row + 2 + k]
        answer = _answer_in(work, k)
        if answer.gap == math.inf:
            continue
        out.gap = answer.gap
        nx, ny, nz = answer.normal[0], answer.normal[1], answer.normal[2]
        for i in range(3):
            out.normal[i] = at.rotation[0, i] * nx + at.rotation[1, i] * ny + at.rotation[2, i] * nz
        if pose[0].sine < 1e-11:
            # Is the nearest point on the axis of the cylinder asked, or at its rim?
            px, py = answer.point[0], answer.point[1]
            if dimensions.flange_radius >= dimensions.outer_radius:
                px -= at.origin[0]
                py -= at.origin[1]
            edge = min(dimensions.outer_radius, dimensions.flange_radius)
            if px * px + py * py < 0.25 * edge * edge:
                flange_contact(dimensions, 1.0 - 2.0 * k, pose[0], out)
                out.gap = answer.gap + 1e-10 * dimensions.half_length - edge * pose[0].sine
                continue
        px = answer.point[0] - at.origin[0]
        py = answer.point[1] - at.origin[1]
        pz = answer.point[2] - at.origin[2]
        for i in range(3):
            out.point[i] = at.rotation[0, i] * px + at.rotation[1, i] * py + at.rotation[2, i] * pz
