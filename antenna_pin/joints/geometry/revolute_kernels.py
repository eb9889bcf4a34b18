"""Closed-form distances between a flanged journal and its bearing, compiled.

All vectors are in the bearing frame H: origin at the bearing's centre, z along its axis. A pose
(:data:`antenna_pin.base.records.POSE`) gives the journal's centre ``o`` and unit axis ``z``; a candidate
contact is a row of :data:`antenna_pin.base.records.CONTACT`. Bore and flange read the joint's dimensions as
one record.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Pose, Record, Records, layout
from antenna_pin.compiled.decorators import inlined, kernel


class Revolute(Record):
    """Dimensions of a revolute joint, at one end of the bearing."""

    primitive: int  # its kind
    side: float  # +1 or -1, the bearing's end
    bearing_radius: float  # R_i [m]
    half_length: float  # L_i / 2 [m]
    outer_radius: float  # R_io [m]
    journal_radius: float  # R_j [m]
    flange_radius: float  # R_f [m]
    half_distance: float  # L_j / 2 [m]
    unused: float  # as long as other shapes


REVOLUTE = layout(Revolute)
_MAX_ITERATIONS = 60

# Contact scenarios.
NONE = 0
ONE_POINT = 1
TWO_POINTS = 2
EXTENDED = 3  # line in the bore, surface at a flange


@inlined
def nearest_on_ellipse(major: float, minor: float, x: float, y: float) -> tuple[float, float]:
    """Return the point of an ellipse nearest to (x, y).

    Its semi-axes lie along the coordinate axes.

    The nearest point lies in the quadrant of (x, y): of the two local minima that a narrow ellipse has, the
    global one is found, never the other. In that quadrant it solves

        G(s) = (major x / (s + major^2 - minor^2))^2 + (minor y / s)^2 - 1 = 0,

    convex and decreasing for s > 0: once left of the root Newton climbs to it without fail. The start is the
    root of the circle, an upper bound and nearly the root at small tilt; a step that falls below the lower
    bound is cut.
    """
    px = abs(x)
    py = abs(y)
    delta = (major - minor) * (major + minor)
    if minor * py > 1e-290:  # far below any length; closer to zero the terms below under- and overflow
        low = max(minor * py, major * px - delta)
        s = max(low, minor * math.sqrt(px * px + py * py))
        for _ in range(_MAX_ITERATIONS):
            u = major * px / (s + delta)
            w = minor * py / s
            g = u * u + w * w - 1.0
            slope = 2.0 * (u * u / (s + delta) + w * w / s)
            step = g / slope
            s += step
            if s < low:
                s = low
            elif abs(step) <= 3e-9 * s:  # the next, quadratically smaller, would be round-off
                break
        ex = major * major * px / (s + delta)
        ey = minor * minor * py / s
    elif major * px < delta:
        ex = major * major * px / delta
        ey = minor * math.sqrt(max(0.0, 1.0 - (ex / major) ** 2))
    else:
        ex = major
        ey = 0.0
    # Back onto the ellipse to round-off: a point off it by eps errs in distance by eps, along it by eps^2.
    if minor > 0.0:
        u = ex / major
        w = ey / minor
        scale = math.sqrt(u * u + w * w)  # nearly 1: nothing that could over- or underflow
        ex /= scale
        ey /= scale
    return math.copysign(ex, x), math.copysign(ey, y)


@kernel
def bore_contact(shape: Revolute, side: float, pose: Pose, out: Contact) -> None:
    """Write the radial candidate at the bearing's circle.

    The circle is at ``side`` (+1, -1 or between) times half the bearing's length.

    gap = min over Q on the circle of dist(Q, journal axis) - R_j. Along the journal axis the circle appears
    as an ellipse with semi-axes R_i and R_i cos(tilt), and the journal axis as a point: the nearest point of
    an ellipse. An axis that passes outside the circle counts by minus its distance: an impossible pose, whose
    depth grows with the distance.
    """
    radius = shape.bearing_radius
    ox, oy, oz = pose.centre[0], pose.centre[1], pose.centre[2]
    zx, zy, zz = pose.axis[0], pose.axis[1], pose.axis[2]
    sine = pose.sine
    # Unit vectors: a along the line of nodes, b0 square to it in the bearing plane, b its projection square
    # to z.
    if sine > 0.0:
        ax = -zy / sine
        ay = zx / sine
    else:
        ax = 1.0
        ay = 0.0
    b0x = -ay
    b0y = ax
    if zz < 0.0:  # keep the projected semi-axis positive for a reversed journal
        b0x = -b0x
        b0y = -b0y
    lean = b0x * zx + b0y * zy  # b0 . z = -+ sine
    shrink = min(abs(zz), 1.0)  # the axis may be longer than 1 by round-off
    # d = O_s - O_j; its parts along a and b, the offset of the ellipse's centre from the journal axis.
    dx = -ox
    dy = -oy
    dz = side * shape.half_length - oz
    axial = dx * zx + dy * zy + dz * zz
    da = dx * ax + dy * ay
    db = dx * b0x + dy * b0y - lean * axial
    if shrink > 0.0:
        db /= shrink
    ea, eb = nearest_on_ellipse(radius, radius * shrink, -da, -db)
    # From the journal axis to Q, in (a, b).
    qa = ea + da
    qb = eb + db
    distance = math.sqrt(qa * qa + qb * qb)
    side_of_wall = 1.0
    if da * da * shrink * shrink + db * db > radius * radius * shrink * shrink:
        side_of_wall = -1.0
    ca = ea
    cb = eb / shrink if shrink > 0.0 else 0.0
    bx = b0x - lean * zx
    by = b0y - lean * zy
    bz = -lean * zz
    if shrink > 0.0:
        bx /= shrink
        by /= shrink
        bz /= shrink
    out.gap = side_of_wall * distance - shape.journal_radius
    if distance > 0.0:
        inverse = -side_of_wall / distance
        out.normal[0] = (qa * ax + qb * bx) * inverse
        out.normal[1] = (qa * ay + qb * by) * inverse
        out.normal[2] = qb * bz * inverse
    else:
        out.normal[0] = 0.0
        out.normal[1] = 0.0
        out.normal[2] = 0.0
    out.point[0] = ca * ax + cb * b0x
    out.point[1] = ca * ay + cb * b0y
    out.point[2] = side * shape.half_length


@kernel
def flange_contact(shape: Revolute, side: float, pose: Pose, out: Contact) -> None:
    """Axial candidate between the flange and the bearing's end face at ``side`` (+1 or -1).

    Where the flange covers the bearing's outer edge (R_f >= R_io) that edge meets the plane of the flange:
    gap = L_j/2 - max over Q on the edge of side (Q - O_j) . z. A smaller flange meets the plane of the end
    face with its own rim: gap = min over P on the rim of side P_z - L_i/2. The point is the deepest; of
    exactly parallel axes, where all of the rim is equally deep, that on the axis.
    """
    half = shape.half_length
    ox, oy, oz = pose.centre[0], pose.centre[1], pose.centre[2]
    zx, zy, zz = pose.axis[0], pose.axis[1], pose.axis[2]
    sine = pose.sine
    outer = shape.outer_radius
    flange = shape.flange_radius
    reach = shape.half_distance
    if flange >= outer:
        dz = side * half - oz
        along = -ox * zx - oy * zy + dz * zz
        out.gap = reach - side * along - outer * sine
        out.normal[0] = side * zx
        out.normal[1] = side * zy
        out.normal[2] = side * zz
        if sine > 0.0:
            out.point[0] = side * outer * zx / sine
            out.point[1] = side * outer * zy / sine
        else:
            out.point[0] = 0.0
            out.point[1] = 0.0
        out.point[2] = side * half
    else:
        # Centre of the flange's inner face, and the steepest direction towards the bearing in its plane.
        fx = ox + side * reach * zx
        fy = oy + side * reach * zy
        fz = oz + side * reach * zz
        out.gap = side * fz - half - flange * sine
        out.normal[0] = 0.0
        out.normal[1] = 0.0
        out.normal[2] = side
        if sine > 0.0:
            fx += side * flange * zx * zz / sine
            fy += side * flange * zy * zz / sine
            fz -= side * flange * sine
        out.point[0] = fx
        out.point[1] = fy
        out.point[2] = fz


@kernel
def revolute_contacts(shape: Revolute, pose: Pose, table: Records[Contact]) -> None:
    """Fill a table's first rows: bore at +z, -z, flange at +z, -z."""
    for k in range(2):
        side = 1.0 - 2.0 * k
        bore_contact(shape, side, pose, table[k])
        flange_contact(shape, side, pose, table[2 + k])


@kernel
def contact_scenario(
    shape: Revolute, pose: Pose, table: Records[Contact], row: int, spare: Contact
) -> tuple[int, int]:
    """Classify the penetrations of rows ``row`` to ``row + 3`` of a table.

    The row ``spare`` is scratch.

    Radial: none, one end, two ends, line (both ends and the middle section on the same side). Axial: none,
    one point, two points (both flanges), surface (the whole annulus of a flange).
    """
    plus, minus = table[row], table[row + 1]
    first = plus.gap < 0.0
    second = minus.gap < 0.0
    radial = NONE
    if first and second:
        radial = TWO_POINTS
        bore_contact(shape, 0.0, pose, spare)
        same_plus = 0.0
        same_minus = 0.0
        for i in range(3):
            same_plus += plus.normal[i] * spare.normal[i]
            same_minus += minus.normal[i] * spare.normal[i]
        if spare.gap < 0.0 and same_plus > 0.0 and same_minus > 0.0:
            radial = EXTENDED
    elif first or second:
        radial = ONE_POINT
    front = -table[row + 2].gap
    back = -table[row + 3].gap
    whole = 2.0 * min(shape.outer_radius, shape.flange_radius) * pose.sine
    axial = NONE
    if (front > 0.0 and front >= whole) or (back > 0.0 and back >= whole):
        axial = EXTENDED
    elif front > 0.0 and back > 0.0:
        axial = TWO_POINTS
    elif front > 0.0 or back > 0.0:
        axial = ONE_POINT
    return radial, axial


@kernel
def scenario_in(
    dimensions: Records[Revolute], poses: Records[Pose], table: Records[Contact]
) -> tuple[int, int]:
    """Return the contact scenario of poses[0], filling the five rows of a table."""
    shape, pose = dimensions[0], poses[0]
    revolute_contacts(shape, pose, table)
    return contact_scenario(shape, pose, table, 0, table[4])
