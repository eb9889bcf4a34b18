"""What the coal backend of the revolute joint needs around its queries, compiled.

The journal frame J used here has its z axis along the journal and an arbitrary rotation about it.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import kernel
from antenna_pin.geometry._revolute_kernels import bore_contact, flange_contact
from antenna_pin.records import layout

#: Placement of H in J.
FRAME = layout(("rotation", "f8", (3, 3)), ("origin", "f8", (3,)))
#: The search on an end circle: the point asked, in J (read by coal) and in H [m]; its angle on the circle
#: [rad]; whether the journal's axis passes through the circle; normal in H and gap [m].
END = layout(
    ("in_journal", "f8", (3,)),
    ("in_bearing", "f8", (3,)),
    ("angle", "f8"),
    ("inside", "i8"),
    ("normal", "f8", (3,)),
    ("gap", "f8"),
)
#: coal's answer about a flange, in J: distance [m], normal from bearing to journal, nearest point [m].
FLANGE_ANSWER = layout(("gap", "f8"), ("normal", "f8", (3,)), ("point", "f8", (3,)))


@kernel
def coal_place(shape: Any, pose: Any, frame: Any, ends: Any) -> None:
    """Place the bearing in the journal frame and start the search on both end circles.

    Args:
        shape: REVOLUTE, (1,).
        pose: POSE, (1,).
        frame: FRAME, (1,), to be filled.
        ends: END, (2,), to be filled: at +z, at -z.
    """
    at = frame[0]
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
    for k in range(2):
        coal_start(shape, 1.0 - 2.0 * k, pose, frame, ends, k)


@kernel
def coal_start(shape: Any, side: float, pose: Any, frame: Any, ends: Any, k: int) -> None:
    """Start the search on the circle at ``side`` times half the length, in ends[k]."""
    # Towards the side of the bore that the journal axis is nearest to, where it cuts the circle's plane.
    ox, oy, oz = pose[0].centre[0], pose[0].centre[1], pose[0].centre[2]
    zx, zy, zz = pose[0].axis[0], pose[0].axis[1], pose[0].axis[2]
    radius = shape[0].bearing_radius
    lift = (side * shape[0].half_length - oz) / zz if zz != 0.0 else 0.0
    cx = ox + lift * zx
    cy = oy + lift * zy
    ends[k].angle = math.atan2(cy, cx) if (cx != 0.0 or cy != 0.0) else 0.0
    ends[k].inside = 1 if zz != 0.0 and cx * cx + cy * cy <= radius * radius else 0
    _place_point(shape[0], side, frame[0], ends[k])


@kernel
def _place_point(shape: Any, side: float, frame: Any, end: Any) -> None:
    end.in_bearing[0] = shape.bearing_radius * math.cos(end.angle)
    end.in_bearing[1] = shape.bearing_radius * math.sin(end.angle)
    end.in_bearing[2] = side * shape.half_length
    for i in range(3):
        end.in_journal[i] = (
            frame.rotation[i, 0] * end.in_bearing[0]
            + frame.rotation[i, 1] * end.in_bearing[1]
            + frame.rotation[i, 2] * end.in_bearing[2]
            + frame.origin[i]
        )


@kernel
def coal_turn(shape: Any, side: float, frame: Any, ends: Any, k: int, normal: Any, gap: float) -> bool:
    """Make one Newton step of d gap / d phi = 0 from coal's gap and normal (in J); True when done.

    The derivative of the gap along the circle is -n . dQ/dphi; its own derivative follows from the curvature
    of the distance to a line. Once the step is below 1e-5 rad, gap and normal are carried over it to second
    and first order, which is exact to 1e-10 in the normal and far below round-off in the gap: no further
    query is needed. Where the minimum is so flat that its angle is lost in round-off the gap decides.
    """
    at = frame[0]
    end = ends[k]
    nx, ny, nz = normal[0], normal[1], normal[2]
    hx = at.rotation[0, 0] * nx + at.rotation[1, 0] * ny + at.rotation[2, 0] * nz
    hy = at.rotation[0, 1] * nx + at.rotation[1, 1] * ny + at.rotation[2, 1] * nz
    hz = at.rotation[0, 2] * nx + at.rotation[1, 2] * ny + at.rotation[2, 2] * nz
    radius = shape[0].bearing_radius
    qx, qy = end.in_bearing[0], end.in_bearing[1]
    tx = -qy
    ty = qx
    slope = -(hx * tx + hy * ty)
    # dist'' = (|t_perp|^2 - (n.t)^2) / dist - n . Q'' with t_perp the tangent's part square to the journal
    # axis and Q'' = -(qx, qy, 0).
    zx, zy, zz = at.rotation[2, 0], at.rotation[2, 1], at.rotation[2, 2]
    along = tx * zx + ty * zy
    span = gap + shape[0].journal_radius
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
    _place_point(shape[0], side, at, end)
    return done


@kernel
def coal_collect(shape: Any, pose: Any, frame: Any, ends: Any, answers: Any, table: Any, row: int) -> None:
    """Turn coal's answers into the four rows of the table, in H.

    The bore's stand in ``ends``, the flanges' in ``answers``. Of a cylinder exactly parallel to the normal,
    up to a tilt of some 1e-12, coal takes the middle of the end face for the nearest point, 1e-10 of half its
    length too far out: that is put right. Where the axis of the journal passes outside an end circle, which
    parts cannot do, the closed form's gap stands.
    """
    at = frame[0]
    dimensions = shape[0]
    for k in range(2):
        out = table[row + k]
        if ends[k].inside == 0:
            bore_contact(dimensions, 1.0 - 2.0 * k, pose[0], out)
            continue
        out.gap = ends[k].gap
        for i in range(3):
            out.normal[i] = ends[k].normal[i]
            out.point[i] = ends[k].in_bearing[i]
    for k in range(2):
        out = table[row + 2 + k]
        answer = answers[k]
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
