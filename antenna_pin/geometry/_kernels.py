"""Closed-form distances between a journal and a bearing, compiled.

All vectors are in the bearing frame H: origin at the bearing's centre, z along its axis. The pose of the
journal is its centre ``o`` and its unit axis ``z``. A candidate contact is one row of a table::

    [gap, normal (3), contact point (3), ...]

gap positive apart; normal from the bearing into the journal; point, the deepest, from the bearing's
centre. Later columns of a row belong to the joint (rates and forces), but for ``SHARE``. Rows of a revolute
joint: bore at s = +1, bore at s = -1, flange at s = +1, flange at s = -1.

A revolute geometry travels as ``REVOLUTE_SIZE`` floats ``[R_i, L_i / 2, R_io, R_j, R_f, L_j / 2]``.
"""

from __future__ import annotations

import math
from typing import Any

from antenna_pin._compile import kernel

#: Columns of a contact table; geometry fills the first seven (gap, normal, point), a joint the others.
TABLE_WIDTH = 24
REVOLUTE_SIZE = 6
PLANAR_SIZE = 2
GAP = 0
NORMAL = 1
POINT = 4
SHARE = 18  # of a strip or sector: its part of its patch's law
_MAX_ITERATIONS = 60


@kernel
def nearest_on_ellipse(major: float, minor: float, x: float, y: float) -> tuple[float, float]:
    """Return the point of an ellipse nearest to (x, y), both semi-axes along the coordinate axes.

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
    scale = math.hypot(ex / major, ey / minor) if minor > 0.0 else 1.0
    ex /= scale
    ey /= scale
    return math.copysign(ex, x), math.copysign(ey, y)


@kernel
def bore_contact(
    shape: Any,
    side: float,
    ox: float,
    oy: float,
    oz: float,
    zx: float,
    zy: float,
    zz: float,
    sine: float,
    table: Any,
    row: int,
) -> None:
    """Radial candidate at the bearing's end circle ``side`` (+1 or -1).

    gap = min over Q on the circle of dist(Q, journal axis) - R_j. Seen along the journal axis the circle is
    an ellipse with semi-axes R_i and R_i cos(tilt), and the journal axis is a point: the nearest point of an
    ellipse. An axis that passes outside the circle counts by minus its distance: the pose is one that the
    parts cannot have, and the deeper in the wall the farther out.
    """
    radius = shape[0]
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
    if zz < 0.0:  # keep the projected semi-axis positive for a journal put in the other way round
        b0x = -b0x
        b0y = -b0y
    lean = b0x * zx + b0y * zy  # b0 . z = -+ sine
    shrink = min(abs(zz), 1.0)  # the axis may be longer than 1 by round-off
    # d = O_s - O_j; its parts along a and b, the offset of the ellipse's centre from the journal axis.
    dx = -ox
    dy = -oy
    dz = side * shape[1] - oz
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
    table[row, 0] = side_of_wall * distance - shape[3]
    if distance > 0.0:
        inverse = -side_of_wall / distance
        table[row, 1] = (qa * ax + qb * bx) * inverse
        table[row, 2] = (qa * ay + qb * by) * inverse
        table[row, 3] = qb * bz * inverse
    else:
        table[row, 1] = 0.0
        table[row, 2] = 0.0
        table[row, 3] = 0.0
    table[row, 4] = ca * ax + cb * b0x
    table[row, 5] = ca * ay + cb * b0y
    table[row, 6] = side * shape[1]


@kernel
def flange_contact(
    shape: Any,
    side: float,
    ox: float,
    oy: float,
    oz: float,
    zx: float,
    zy: float,
    zz: float,
    sine: float,
    table: Any,
    row: int,
) -> None:
    """Axial candidate between the flange and the bearing's end face at ``side`` (+1 or -1).

    Where the flange covers the bearing's outer edge (R_f >= R_io) that edge meets the plane of the flange:
    gap = L_j/2 - max over Q on the edge of side (Q - O_j) . z. A smaller flange meets the plane of the end
    face with its own rim: gap = min over P on the rim of side P_z - L_i/2. The point is the deepest; of
    exactly parallel axes, where all of the rim is equally deep, that on the axis.
    """
    half = shape[1]
    outer = shape[2]
    flange = shape[4]
    reach = shape[5]
    if flange >= outer:
        dz = side * half - oz
        along = -ox * zx - oy * zy + dz * zz
        table[row, 0] = reach - side * along - outer * sine
        table[row, 1] = side * zx
        table[row, 2] = side * zy
        table[row, 3] = side * zz
        if sine > 0.0:
            table[row, 4] = side * outer * zx / sine
            table[row, 5] = side * outer * zy / sine
        else:
            table[row, 4] = 0.0
            table[row, 5] = 0.0
        table[row, 6] = side * half
    else:
        # Centre of the flange's inner face, and the steepest direction towards the bearing in its plane.
        fx = ox + side * reach * zx
        fy = oy + side * reach * zy
        fz = oz + side * reach * zz
        table[row, 0] = side * fz - half - flange * sine
        table[row, 1] = 0.0
        table[row, 2] = 0.0
        table[row, 3] = side
        if sine > 0.0:
            fx += side * flange * zx * zz / sine
            fy += side * flange * zy * zz / sine
            fz -= side * flange * sine
        table[row, 4] = fx
        table[row, 5] = fy
        table[row, 6] = fz


@kernel
def revolute_contacts(
    shape: Any, ox: float, oy: float, oz: float, zx: float, zy: float, zz: float, table: Any, row: int
) -> None:
    """Fill the four rows of a revolute clearance joint from ``row`` on."""
    sine = math.sqrt(zx * zx + zy * zy)
    bore_contact(shape, 1.0, ox, oy, oz, zx, zy, zz, sine, table, row)
    bore_contact(shape, -1.0, ox, oy, oz, zx, zy, zz, sine, table, row + 1)
    flange_contact(shape, 1.0, ox, oy, oz, zx, zy, zz, sine, table, row + 2)
    flange_contact(shape, -1.0, ox, oy, oz, zx, zy, zz, sine, table, row + 3)


@kernel
def planar_contact(shape: Any, ox: float, oy: float, table: Any, row: int) -> None:
    """Fill the one row of a planar clearance joint: circle in circle, shape [R_i, R_j]."""
    eccentricity = math.hypot(ox, oy)
    table[row, 0] = shape[0] - shape[1] - eccentricity
    if eccentricity > 0.0:
        ux = ox / eccentricity
        uy = oy / eccentricity
    else:
        ux = 1.0
        uy = 0.0
    table[row, 1] = -ux
    table[row, 2] = -uy
    table[row, 3] = 0.0
    table[row, 4] = shape[0] * ux
    table[row, 5] = shape[0] * uy
    table[row, 6] = 0.0


@kernel
def spherical_contact(shape: Any, ox: float, oy: float, oz: float, table: Any, row: int) -> None:
    """Fill the one row of a spherical clearance joint: ball in socket, shape [R_socket, R_ball]."""
    eccentricity = math.sqrt(ox * ox + oy * oy + oz * oz)
    table[row, 0] = shape[0] - shape[1] - eccentricity
    if eccentricity > 0.0:
        ux = ox / eccentricity
        uy = oy / eccentricity
        uz = oz / eccentricity
    else:
        ux = 1.0
        uy = 0.0
        uz = 0.0
    table[row, 1] = -ux
    table[row, 2] = -uy
    table[row, 3] = -uz
    table[row, 4] = shape[0] * ux
    table[row, 5] = shape[0] * uy
    table[row, 6] = shape[0] * uz


# --- distributed contact: the bore cut into strips, the flanges into sectors
# ------------------------------------

APART = 1.0  # [m], the gap written to strips that are known to be apart without being computed


@kernel
def strip_contacts(
    shape: Any,
    strips: int,
    ox: float,
    oy: float,
    oz: float,
    zx: float,
    zy: float,
    zz: float,
    table: Any,
    row: int,
    first: int,
) -> None:
    """Fill the bore's strips, and its two halves: the +z one in ``row``, the -z one behind it.

    The strips stand from ``first`` on, from the -z to the +z end; a strip is the circle at its middle. The
    gap is concave along the bearing (the distance between two straight axes is convex), so in each half it is
    least at the outermost or the innermost strip, and from those two the loaded strips are found; the others
    are marked as apart. A half's row is that of its least gap. Each strip has 2 / strips of the law of its
    half.
    """
    sine = math.sqrt(zx * zx + zy * zy)
    half = strips // 2
    for k in range(strips):
        table[first + k, 0] = APART
    for h in range(2):
        if h == 0:
            inner, outer, step = half, strips - 1, -1
        else:
            inner, outer, step = half - 1, 0, 1
        least = outer
        for begin, towards in ((outer, step), (inner, -step)):
            k = begin
            while (k >= half) == (h == 0) and 0 <= k < strips:
                if table[first + k, 0] != APART:
                    break
                side = (2.0 * k + 1.0) / strips - 1.0
                bore_contact(shape, side, ox, oy, oz, zx, zy, zz, sine, table, first + k)
                table[first + k, SHARE] = 2.0 / strips
                if table[first + k, 0] < table[first + least, 0]:
                    least = k
                if table[first + k, 0] >= 0.0:
                    break
                k += towards
        for i in range(7):
            table[row + h, i] = table[first + least, i]


@kernel
def sector_contacts(
    shape: Any,
    nodes: Any,
    count: int,
    radius: float,
    ox: float,
    oy: float,
    oz: float,
    zx: float,
    zy: float,
    zz: float,
    table: Any,
    row: int,
    first: int,
) -> None:
    r"""Fill the flanges' sectors, from ``first`` on, and the two flanges' own rows, ``row`` and the next.

    The annulus is a ring of ``radius``; its depth at the angle phi from its deepest point is
    d - 2 a sin^2(phi/2), a = radius sin(tilt), and the loaded arc ends at sin(phi/2) = sigma,
    sigma^2 = d / (2 a), or is the whole ring (sigma = 1). The sectors divide the loaded arc: with
    sin(phi/2) = sigma sin(t)

        1/(2 pi) integral of f dphi = 1/pi integral over t of f sigma cos(t) / sqrt(1 - sigma^2 sin^2(t)) dt

    by the midpoint rule. The integrand is periodic in t, as d cos^2(t) is the depth of a partly loaded ring,
    so that the sum converges quickly, passes smoothly from the part to the whole, where the sectors stand
    evenly, and is the same for all directions of the tilt. ``nodes`` holds sin(t_k) and cos(t_k) / count.
    Those of the +z flange come first. A flange's row is that of its deepest point, with sigma in ``SHARE``.
    """
    sine = math.sqrt(zx * zx + zy * zy)
    a = radius * sine
    for h in range(2):
        side = 1.0 - 2.0 * h
        start = first + h * count
        depth = side * (-ox * zx - oy * zy + (side * shape[1] - oz) * zz) - shape[5] + a
        ux = side * zx / sine if sine > 0.0 else 1.0
        uy = side * zy / sine if sine > 0.0 else 0.0
        r = row + h
        table[r, 0] = -depth
        table[r, 1] = side * zx
        table[r, 2] = side * zy
        table[r, 3] = side * zz
        table[r, 4] = radius * ux
        table[r, 5] = radius * uy
        table[r, 6] = side * shape[1]
        sigma = math.sqrt(depth / (2.0 * a)) if 0.0 < depth < 2.0 * a else 1.0
        table[r, SHARE] = sigma
        if depth <= 0.0:
            for k in range(count):
                table[start + k, 0] = APART
            continue
        for k in range(count):
            s = sigma * nodes[2 * k]
            root = math.sqrt(1.0 - s * s)
            c = 1.0 - 2.0 * s * s
            d = 2.0 * s * root
            r = start + k
            table[r, 0] = 2.0 * a * s * s - depth
            table[r, 1] = side * zx
            table[r, 2] = side * zy
            table[r, 3] = side * zz
            table[r, 4] = radius * (c * ux - d * uy)
            table[r, 5] = radius * (d * ux + c * uy)
            table[r, 6] = side * shape[1]
            table[r, SHARE] = sigma * nodes[2 * k + 1] / root


# --- what the coal backend needs around its queries --------------------------------------------------------


@kernel
def coal_place(
    shape: Any, ox: float, oy: float, oz: float, zx: float, zy: float, zz: float, work: Any
) -> None:
    """Place the bearing in the journal frame and start the search on both end circles.

    ``work`` (52 floats): [0:9] rotation of H in J (row-major), [9:12] origin of H in J, then for side +1 and
    -1 a record of 20 floats: [0:3] Q in J (read by coal), [3] angle, [4] whether the journal axis passes
    through the circle, [5:8] Q in H, [8:11] normal in H, [11] gap. The journal frame J used here has its z
    axis along the journal and an arbitrary rotation about it.
    """
    # Smallest rotation taking the z axis to z: R = I + [k] + [k]^2 / (1 + zz), k = e_z x z.
    f = 1.0 / (1.0 + zz) if zz > -0.5 else 0.0
    if zz > -0.5:
        r00 = 1.0 - f * zx * zx
        r01 = -f * zx * zy
        r11 = 1.0 - f * zy * zy
        # Columns of the rotation J -> H are (r00, r01, -zx), (r01, r11, -zy), (zx, zy, zz).
        work[0] = r00
        work[1] = r01
        work[2] = -zx
        work[3] = r01
        work[4] = r11
        work[5] = -zy
    else:
        # Upside down: first half a turn about x, then the smallest rotation.
        g = 1.0 / (1.0 - zz)
        work[0] = 1.0 - g * zx * zx
        work[1] = -g * zx * zy
        work[2] = zx
        work[3] = g * zx * zy
        work[4] = -(1.0 - g * zy * zy)
        work[5] = -zy
    work[6] = zx
    work[7] = zy
    work[8] = zz
    for i in range(3):
        work[9 + i] = -(work[3 * i] * ox + work[3 * i + 1] * oy + work[3 * i + 2] * oz)
    for k in range(2):
        coal_start(shape, 1.0 - 2.0 * k, ox, oy, oz, zx, zy, zz, work, 12 + 20 * k)


@kernel
def coal_start(
    shape: Any,
    side: float,
    ox: float,
    oy: float,
    oz: float,
    zx: float,
    zy: float,
    zz: float,
    work: Any,
    base: int,
) -> None:
    """Start the search on the circle at ``side`` times half the length, in the record at work[base]."""
    # Towards the side of the bore that the journal axis is nearest to, where it cuts the circle's plane.
    lift = (side * shape[1] - oz) / zz if zz != 0.0 else 0.0
    cx = ox + lift * zx
    cy = oy + lift * zy
    work[base + 3] = math.atan2(cy, cx) if (cx != 0.0 or cy != 0.0) else 0.0
    inside = zz != 0.0 and cx * cx + cy * cy <= shape[0] * shape[0]
    work[base + 4] = 1.0 if inside else 0.0
    _coal_point(shape, side, work, base)


@kernel
def _coal_point(shape: Any, side: float, work: Any, base: int) -> None:
    angle = work[base + 3]
    qx = shape[0] * math.cos(angle)
    qy = shape[0] * math.sin(angle)
    qz = side * shape[1]
    work[base + 5] = qx
    work[base + 6] = qy
    work[base + 7] = qz
    for i in range(3):
        work[base + i] = work[3 * i] * qx + work[3 * i + 1] * qy + work[3 * i + 2] * qz + work[9 + i]


@kernel
def coal_turn(shape: Any, side: float, work: Any, base: int, normal: Any, gap: float) -> bool:
    """Make one Newton step of d gap / d phi = 0 from coal's gap and normal (in J); True when done.

    The derivative of the gap along the circle is -n . dQ/dphi; its own derivative follows from the curvature
    of the distance to a line. Once the step is below 1e-5 rad, gap and normal are carried over it to second
    and first order, which is exact to 1e-10 in the normal and far below round-off in the gap: no further
    query is needed. Where the minimum is so flat that its angle is lost in round-off the gap decides.
    """
    nx, ny, nz = normal[0], normal[1], normal[2]
    hx = work[0] * nx + work[3] * ny + work[6] * nz
    hy = work[1] * nx + work[4] * ny + work[7] * nz
    hz = work[2] * nx + work[5] * ny + work[8] * nz
    radius = shape[0]
    qx, qy = work[base + 5], work[base + 6]
    tx = -qy
    ty = qx
    slope = -(hx * tx + hy * ty)
    # dist'' = (|t_perp|^2 - (n.t)^2) / dist - n . Q'' with t_perp the tangent's part square to the journal
    # axis and Q'' = -(qx, qy, 0).
    zx, zy, zz = work[6], work[7], work[8]
    along = tx * zx + ty * zy
    span = gap + shape[3]
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
    work[base + 8] = hx * scale
    work[base + 9] = hy * scale
    work[base + 10] = hz * scale
    work[base + 11] = gap - gain if done else gap
    work[base + 3] += step
    _coal_point(shape, side, work, base)
    return done


@kernel
def coal_collect(
    shape: Any, work: Any, gaps: Any, normals: Any, points: Any, sine: float, table: Any, row: int
) -> None:
    """Turn coal's answers into the four rows of the table, in H.

    The bore's stand in ``work``; ``gaps`` (2,), ``normals`` (2, 3) and ``points`` (2, 3) are those of the
    flanges: coal's distances, normals from the bearing to the journal, and nearest points, in J. Of a
    cylinder exactly parallel to the normal, up to a tilt of some 1e-12, coal takes the middle of the end face
    for the nearest point, 1e-10 of half its length too far out: that is put right. Where the axis of the
    journal passes outside an end circle, which parts cannot do, the closed form's gap stands.
    """
    zx, zy, zz = work[6], work[7], work[8]
    ox = -(work[0] * work[9] + work[3] * work[10] + work[6] * work[11])
    oy = -(work[1] * work[9] + work[4] * work[10] + work[7] * work[11])
    oz = -(work[2] * work[9] + work[5] * work[10] + work[8] * work[11])
    for k in range(2):
        base = 12 + 20 * k
        if work[base + 4] == 0.0:
            bore_contact(shape, 1.0 - 2.0 * k, ox, oy, oz, zx, zy, zz, sine, table, row + k)
            continue
        table[row + k, 0] = work[base + 11]
        for i in range(3):
            table[row + k, 1 + i] = work[base + 8 + i]
            table[row + k, 4 + i] = work[base + 5 + i]
    for k in range(2):
        r = row + 2 + k
        table[r, 0] = gaps[k]
        nx, ny, nz = normals[k, 0], normals[k, 1], normals[k, 2]
        for i in range(3):
            table[r, 1 + i] = work[i] * nx + work[3 + i] * ny + work[6 + i] * nz
        if sine < 1e-11:
            # Is the nearest point on the axis of the cylinder asked, or at its rim?
            px, py = points[k, 0], points[k, 1]
            if shape[4] >= shape[2]:
                px -= work[9]
                py -= work[10]
            edge = min(shape[2], shape[4])
            if px * px + py * py < 0.25 * edge * edge:
                flange_contact(shape, 1.0 - 2.0 * k, ox, oy, oz, zx, zy, zz, sine, table, r)
                table[r, 0] = gaps[k] + 1e-10 * shape[1] - edge * sine
                continue
        px = points[k, 0] - work[9]
        py = points[k, 1] - work[10]
        pz = points[k, 2] - work[11]
        for i in range(3):
            table[r, 4 + i] = work[i] * px + work[3 + i] * py + work[6 + i] * pz


# --- contact scenario
# ----------------------------------------------------------------------------------------

NONE = 0
ONE_POINT = 1
TWO_POINTS = 2
EXTENDED = 3  # line in the bore, surface at a flange


@kernel
def contact_scenario(
    shape: Any,
    ox: float,
    oy: float,
    oz: float,
    zx: float,
    zy: float,
    zz: float,
    table: Any,
    row: int,
    spare: int,
) -> tuple[int, int]:
    """Classify the penetrations of rows ``row`` to ``row + 3``; row ``spare`` is scratch.

    Radial: none, one end, two ends, line (both ends and the middle section on the same side). Axial: none,
    one point, two points (both flanges), surface (the whole annulus of a flange).
    """
    sine = math.sqrt(zx * zx + zy * zy)
    first = table[row, 0] < 0.0
    second = table[row + 1, 0] < 0.0
    radial = NONE
    if first and second:
        radial = TWO_POINTS
        bore_contact(shape, 0.0, ox, oy, oz, zx, zy, zz, sine, table, spare)
        same_plus = 0.0
        same_minus = 0.0
        for i in range(1, 4):
            same_plus += table[row, i] * table[spare, i]
            same_minus += table[row + 1, i] * table[spare, i]
        if table[spare, 0] < 0.0 and same_plus > 0.0 and same_minus > 0.0:
            radial = EXTENDED
    elif first or second:
        radial = ONE_POINT
    edge = min(shape[2], shape[4])
    front = -table[row + 2, 0]
    back = -table[row + 3, 0]
    whole = 2.0 * edge * sine
    axial = NONE
    if (front > 0.0 and front >= whole) or (back > 0.0 and back >= whole):
        axial = EXTENDED
    elif front > 0.0 and back > 0.0:
        axial = TWO_POINTS
    elif front > 0.0 or back > 0.0:
        axial = ONE_POINT
    return radial, axial
