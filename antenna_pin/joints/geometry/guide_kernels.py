"""Distances between a slider and a guide that ends, compiled.

Either may be the longer.

The guide is a block with a through hollow; its outside does not count. Of a slider that protrudes from a
mouth only the part within the guide can touch: the contact is between the slider's flank and the mouth's
edge. Where the slider ends within the guide its end meets the wall. A slider that is completely outside may
meet the block's face.

With ``apart`` the distance of the slider's end from the wall (to the centre of its rounding), ``inside`` its
distance within the mouth, and the flank leaning towards the wall by phi, the edge's distance from the flank
is (apart - inside tan(phi)) cos(phi). The larger of the two counts where the flank leans towards the wall,
else the smaller: so the gap does not jump as an end passes the mouth.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Pose, Record, Vector2, Vector3, layout
from antenna_pin.compiled.decorators import deferred, kernel
from antenna_pin.joints.geometry.revolute_kernels import Revolute, bore_contact


class GuideCorner(Record):
    """A corner (``corner_kernels.CORNER``) in a guide that ends."""

    primitive: int  # its kind
    corner: Vector3  # centre of the rounding, from the journal's centre in the child's axes [m]
    wall: Vector2  # normal of the wall into the hollow, across the axis
    distance: float  # distance of the wall from the bearing's centre [m]
    radius: float  # radius of the corner [m]
    reach: float  # half the guide's length [m]


EDGE = layout(GuideCorner)
_MAX_ITERATIONS = 60


@deferred
def edge_contact(shape: GuideCorner, pose: Pose, out: Contact) -> None:
    """Write the candidate at one end of a long edge: its corner, or the mouth.

    The edge counts within the guide.

    Exact for a slider apart from its wall and for one that presses, where the depth is along the normal of
    wall or edge with the smaller overlap; the guide's mouth is sharp, the slider's edge rounded.
    """
    wx, wy, reach, radius = shape.wall[0], shape.wall[1], shape.reach, shape.radius
    zx, zy, zz = pose.axis[0], pose.axis[1], pose.axis[2]
    ex, ey, ez = pose.centre[0], pose.centre[1], pose.centre[2]
    half = 0.0  # of the edge, with the sign of this end
    for k in range(3):
        c = shape.corner[k]
        rx, ry, rz = pose.rotation[0, k] * c, pose.rotation[1, k] * c, pose.rotation[2, k] * c
        ex += rx
        ey += ry
        ez += rz
        half += rx * zx + ry * zy + rz * zz
    # Mouth next to this end, and direction of the edge there.
    outward = 1.0 if half >= 0.0 else -1.0
    mouth = outward if zz >= 0.0 else -outward
    lean = -outward * (wx * zx + wy * zy)
    steep = abs(zz)
    square = lean * lean + steep * steep
    slant = math.sqrt(square)
    apart = shape.distance + wx * ex + wy * ey
    inside = reach - mouth * ez
    across = (apart * steep - inside * lean) / slant  # from the mouth's edge to the line of the long edge
    on_edge = across > apart if lean > 0.0 else across < apart
    beside = False
    if lean > 0.0 and apart > 0.0:
        on_edge = inside * steep <= -apart * lean
        beside = inside < 0.0 and not on_edge
    way = 0.0  # along the edge from its end to the point nearest to the mouth's
    if on_edge:
        cosine, sine, distance = steep / slant, lean / slant, across
        way = outward * (inside * steep + apart * lean) / square
    elif beside:
        distance = math.sqrt(apart * apart + inside * inside)
        cosine, sine = apart / distance, -inside / distance
    else:
        cosine, sine, distance = 1.0, 0.0, apart
    nx, ny, nz = cosine * wx, cosine * wy, sine * mouth
    # Completely outside, beyond this mouth or the other?
    gone = mouth * (ez - 2.0 * half * zz) - reach
    back = -mouth * ez - reach
    if max(gone, back) > distance:
        distance = max(gone, back)
        nx, ny, nz = 0.0, 0.0, mouth
        way = -2.0 * half
        if back >= gone:
            nz, way = -mouth, 0.0
    out.gap = distance - radius
    out.normal[0], out.normal[1], out.normal[2] = nx, ny, nz
    out.point[0] = ex + way * zx - radius * nx
    out.point[1] = ey + way * zy - radius * ny
    out.point[2] = ez + way * zz - radius * nz


@kernel
def farthest_on_ellipse(major: float, minor: float, x: float, y: float) -> tuple[float, float]:
    """Return the point of an ellipse farthest from (x, y).

    Its semi-axes lie along the coordinate axes.

    It lies in the quadrant opposite to (x, y) and solves, for q > 0 and delta = major^2 - minor^2,

        G(q) = (major x / q)^2 + (minor y / (q + delta))^2 - 1 = 0,

    convex and decreasing, by Newton as in
    :func:`antenna_pin.joints.geometry.revolute_kernels.nearest_on_ellipse`.
    """
    px = abs(x)
    py = abs(y)
    delta = (major - minor) * (major + minor)
    if major * px > 1e-290:  # far below any length
        low = max(major * px, minor * py - delta)
        q = max(low, major * math.sqrt(px * px + py * py))
        for _ in range(_MAX_ITERATIONS):
            u = major * px / q
            w = minor * py / (q + delta)
            g = u * u + w * w - 1.0
            slope = 2.0 * (u * u / q + w * w / (q + delta))
            step = g / slope
            q += step
            if q < low:
                q = low
            elif abs(step) <= 3e-9 * q:  # the next, quadratically smaller, would be round-off
                break
        u = major * px / q
        w = minor * py / (q + delta)
    elif minor * py < delta:
        w = minor * py / delta
        u = math.sqrt(max(0.0, 1.0 - w * w))
    else:
        u = 0.0
        w = 1.0
    scale = math.sqrt(u * u + w * w)  # nearly 1: back onto the ellipse to round-off
    return -math.copysign(major * u / scale, x), -math.copysign(minor * w / scale, y)


@deferred
def rod_contact(shape: Revolute, pose: Pose, out: Contact) -> None:
    """Write the candidate at one end of a round slider: its rim, or the mouth.

    The slider counts within the guide.

    REVOLUTE, of which half_length is half the guide's and half_distance half the slider's. The rim's gap is
    R_i - max over P on the rim of dist(P, guide's axis), the mouth's that of a bore's end circle.
    """
    zx, zy, zz = pose.axis[0], pose.axis[1], pose.axis[2]
    end = shape.side * shape.half_distance
    ox, oy, oz = pose.centre[0] + end * zx, pose.centre[1] + end * zy, pose.centre[2] + end * zz
    reach = shape.half_length
    mouth = shape.side if zz >= 0.0 else -shape.side
    sine = pose.sine
    # Unit vectors: a along the line of nodes, (bx, by) square to it in the cross section.
    ax, ay = 1.0, 0.0
    if sine > 0.0:
        ax, ay = -zy / sine, zx / sine
    bx, by = ay, -ax  # direction in which the axis leans
    shrink = min(abs(zz), 1.0)  # the axis may be longer than 1 by round-off
    radius = shape.journal_radius
    ea, eb = farthest_on_ellipse(radius, radius * shrink, -(ox * ax + oy * ay), -(ox * bx + oy * by))
    px = ox + ea * ax + eb * bx
    py = oy + ea * ay + eb * by
    pz = oz - eb / zz * sine if zz != 0.0 else oz
    distance = math.sqrt(px * px + py * py)
    gap = shape.bearing_radius - distance
    ux, uy = px / distance, py / distance
    inside = reach - mouth * pz
    near = 4.0 * abs(gap) * sine  # within the play of the mouth either may count
    on_mouth = inside < -near
    if abs(inside) <= near and sine > 0.0:
        bore_contact(shape, mouth, pose, out)
        leans = shape.side * (ux * zx + uy * zy) > 0.0
        on_mouth = out.gap > gap if leans else out.gap < gap
    if on_mouth:
        bore_contact(shape, mouth, pose, out)
        gap = out.gap
    else:
        out.gap = gap
        out.normal[0], out.normal[1], out.normal[2] = -ux, -uy, 0.0
        out.point[0], out.point[1], out.point[2] = px, py, pz
    # Completely outside, beyond this mouth or the other?
    gone = mouth * (oz - 2.0 * end * zz) - reach
    back = -mouth * oz - reach
    if max(gone, back) > gap:
        way = -2.0 * end if gone > back else 0.0
        out.gap = max(gone, back)
        out.normal[0], out.normal[1] = 0.0, 0.0
        out.normal[2] = mouth if gone > back else -mouth
        out.point[0], out.point[1], out.point[2] = ox + way * zx, oy + way * zy, oz + way * zz
