"""Arithmetic of the revolute joint's coal backend around its queries, compiled.

The caller calls :func:`coal_set_out` with a pose, has coal evaluate the requested rows, and calls
:func:`coal_take_in`, repeatedly until no queries are left: nearly always once, since the search on a bore's
end circle starts at the deepest point of the closed form, where the gap is stationary. The result is coal's
own gap and normal; if they contradict that the point is the deepest one, the search continues from there.

The journal frame J used here has its z axis along the journal and an arbitrary rotation about it.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import (
    Contact,
    Floats,
    Matrix3,
    Pose,
    Record,
    Records,
    Triple,
    Vector3,
    layout,
    words_of,
)
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE, Revolute, bore_contact, flange_contact


class Query(Record):
    """Rows as bits: 1, 2 the bore's circles, 4, 8 the flanges.

    The first of each pair is at +z, the second at -z.
    """

    wanted: int  # rows
    asked: int  # rows still to be queried
    kind: int  # FLANGED, PAIRS or PATCHED (``coal_pair_kernels.py``, ``coal_patch_kernels.py``)
    rows: int  # number of queries
    strips: int  # of PATCHED
    answer: int  # address of the machine code for the queries; 0: Python evaluates them
    pairs: int  # its object


QUERY = layout(Query)


class PlacementRecord(Record):
    """The placement of H in J."""

    rotation: Matrix3  # from H to J
    origin: Vector3  # [m]


FRAME = layout(PlacementRecord)


class End(Record):
    """The search on an end circle of the bore."""

    in_journal: Vector3  # the point queried, in J, read by coal [m]
    in_bearing: Vector3  # the same point in H [m]
    side: float  # place of the circle, in half lengths
    angle: float  # angle of the point on the circle [rad]
    inside: int  # 1: the journal's axis passes through the circle
    asked: int  # of a strip: 1: to be queried
    normal: Vector3  # in H
    gap: float  # [m]
    answer: float  # coal's last distance [m]
    direction: Vector3  # coal's last normal, in J


END = layout(End)


class Discs(Record):
    """Placement in H of the discs that stand for small flanges."""

    rotation: Matrix3  # from J to H
    centre: Vector3  # of the disc at +z [m]
    other: Vector3  # centre of the disc at -z [m]


DISCS = layout(Discs)


class FlangeAnswer(Record):
    """Result of coal for a flange, in J; for a small flange in H, reversed."""

    gap: float  # [m]
    normal: Vector3  # from bearing to journal
    point: Vector3  # nearest one [m]


FLANGE_ANSWER = layout(FlangeAnswer)

# All arrays of the kernels are parts of one flat array: each array that Python passes takes time, records
# twice as much. Starts of QUERY, REVOLUTE, FRAME, END at +z and at -z,
# FLANGE_ANSWERs and DISCS in it, and its size.
SHAPE_AT = words_of(QUERY)
FRAME_AT = SHAPE_AT + words_of(REVOLUTE)
END_WORDS = words_of(END)
ENDS_AT = FRAME_AT + words_of(FRAME)
ANSWER_WORDS = words_of(FLANGE_ANSWER)
ANSWERS_AT = ENDS_AT + 2 * END_WORDS
DISCS_AT = ANSWERS_AT + 2 * ANSWER_WORDS
WORDS = DISCS_AT + words_of(DISCS)
FLANGED, PAIRS, PATCHED = 1, 2, 3  # kinds of queries
FLANGES = 12  # the bits of both
MOST_QUERIES = 12  # about one pose
_APPROACH = 6  # largest number of Newton steps before the first query


@inlined
def query_in(work: Floats) -> Query:
    """Return what is wanted of coal."""
    return record(work[:SHAPE_AT], QUERY)


@inlined
def shape_in(work: Floats) -> Revolute:
    """Return the dimensions of the joint."""
    return record(work[SHAPE_AT:FRAME_AT], REVOLUTE)


@inlined
def frame_in(work: Floats) -> PlacementRecord:
    """Return the placement of H in J."""
    return record(work[FRAME_AT:ENDS_AT], FRAME)


@inlined
def end_in(work: Floats, k: int) -> End:
    """Return the search on circle k."""
    return record(work[ENDS_AT + k * END_WORDS : ENDS_AT + (k + 1) * END_WORDS], END)


@inlined
def _answer_in(work: Floats, k: int) -> FlangeAnswer:
    return record(work[ANSWERS_AT + k * ANSWER_WORDS : ANSWERS_AT + (k + 1) * ANSWER_WORDS], FLANGE_ANSWER)


@kernel
def coal_set_out(work: Floats, pose: Records[Pose], wanted: int) -> None:
    """Place the bearing in the journal frame and list the queries of coal.

    Args:
        work: Flat, WORDS; its QUERY, FRAME and the queried ENDs are filled.
        pose: POSE, (1,).
        wanted: Rows, as bits.
    """
    query, at = query_in(work), frame_in(work)
    query.wanted = wanted
    query.asked = wanted & FLANGES
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
    shape = shape_in(work)
    if shape.flange_radius < shape.outer_radius and query.asked != 0:
        _place_discs(at, shape, record(work[DISCS_AT:WORDS], DISCS))
    for k in range(2):
        if wanted >> k & 1 and coal_start(work, k, 1.0 - 2.0 * k, pose):
            query.asked |= 1 << k


@inlined
def _place_discs(at: PlacementRecord, shape: Revolute, discs: Discs) -> None:
    """Place the discs of small flanges, half a length behind their inner faces."""
    reach = shape.half_distance + shape.half_length
    for i in range(3):
        for j in range(3):
            discs.rotation[i, j] = at.rotation[j, i]
        along = at.rotation[0, i] * at.origin[0] + at.rotation[1, i] * at.origin[1]
        along = -(along + at.rotation[2, i] * at.origin[2])
        discs.centre[i] = along + reach * at.rotation[2, i]
        discs.other[i] = along - reach * at.rotation[2, i]


@kernel
def coal_start(work: Floats, k: int, side: float, pose: Records[Pose]) -> bool:
    """Start the search on the circle at ``side``; return whether END k needs queries."""
    # Towards the side of the bore nearest to the journal axis, where it cuts the circle's plane.
    ox, oy, oz = pose[0].centre[0], pose[0].centre[1], pose[0].centre[2]
    zx, zy, zz = pose[0].axis[0], pose[0].axis[1], pose[0].axis[2]
    shape, end = shape_in(work), end_in(work, k)
    radius = shape.bearing_radius
    lift = (side * shape.half_length - oz) / zz if zz != 0.0 else 0.0
    cx = ox + lift * zx
    cy = oy + lift * zy
    inside = bool(zz != 0.0 and cx * cx + cy * cy <= radius * radius)
    end.side = side
    end.inside = 1 if inside else 0
    end.angle = math.atan2(cy, cx) if (cx != 0.0 or cy != 0.0) else 0.0
    _place_point(shape, frame_in(work), end)
    if inside:
        _approach(shape, frame_in(work), end)
    return inside


@inlined
def _place_point(shape: Revolute, frame: PlacementRecord, end: End) -> None:
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


@inlined
def _in_bearing(at: PlacementRecord, x: float, y: float, z: float) -> Triple:
    """Return a direction of J in H."""
    return (
        at.rotation[0, 0] * x + at.rotation[1, 0] * y + at.rotation[2, 0] * z,
        at.rotation[0, 1] * x + at.rotation[1, 1] * y + at.rotation[2, 1] * z,
        at.rotation[0, 2] * x + at.rotation[1, 2] * y + at.rotation[2, 2] * z,
    )


@inlined
def _newton(shape: Revolute, at: PlacementRecord, end: End, normal: Triple, gap: float) -> Triple:
    """Return a Newton step in an END [rad], gap loss [m], and slope.

    The equation is d gap / d phi = 0.

    The derivative of the gap along the circle is -n . dQ/dphi, n the normal in H; its own derivative follows
    from the curvature of the distance to a line,
    dist'' = (|t_perp|^2 - (n.t)^2) / dist - n . Q'' with t_perp the part of the tangent t = dQ/dphi square to
    the journal axis and Q'' = -(qx, qy, 0).
    """
    hx, hy, _ = normal
    radius = shape.bearing_radius
    qx, qy = end.in_bearing[0], end.in_bearing[1]
    tx = -qy
    ty = qx
    slope = -(hx * tx + hy * ty)
    along = tx * at.rotation[2, 0] + ty * at.rotation[2, 1]
    span = gap + shape.journal_radius
    curvature = (radius * radius - along * along - slope * slope) / span + hx * qx + hy * qy
    if curvature > 0.0:
        return min(0.5, max(-0.5, -slope / curvature)), 0.5 * slope * slope / curvature, slope
    return (-0.5 if slope > 0.0 else 0.5), 1.0, slope


@inlined
def _approach(shape: Revolute, at: PlacementRecord, end: End) -> None:
    """Place the point of an END at the closed form's least gap."""
    for _ in range(_APPROACH):
        x, y = end.in_journal[0], end.in_journal[1]
        distance = math.sqrt(x * x + y * y)
        if distance == 0.0:
            return
        normal = _in_bearing(at, -x / distance, -y / distance, 0.0)
        step, gain, _ = _newton(shape, at, end, normal, distance - shape.journal_radius)
        # The last step is one over which coal's result is extrapolated.
        if abs(step) < 1e-7 or gain < 1e-24:
            return
        end.angle += step
        _place_point(shape, at, end)


@kernel
def coal_turn(work: Floats, k: int) -> bool:
    """Make one Newton step in END k from coal's result; return whether it is done.

    The equation is d gap / d phi = 0.

    Once the step is below 1e-5 rad, gap and normal are carried over it to second and first order, which is
    exact to 1e-10 in the normal and far below round-off in the gap: no further query is needed. Where the
    minimum is so flat that its angle is lost in round-off the gap decides.
    """
    shape, at, end = shape_in(work), frame_in(work), end_in(work, k)
    gap = end.answer
    hx, hy, hz = _in_bearing(at, end.direction[0], end.direction[1], end.direction[2])
    step, gain, slope = _newton(shape, at, end, (hx, hy, hz), gap)
    done = bool(abs(step) < 1e-5 or gain < 1e-24)
    # n changes by -(t_perp - (n.t) n) / dist per radian.
    f = step / (gap + shape.journal_radius) if done else 0.0
    zx, zy, zz = at.rotation[2, 0], at.rotation[2, 1], at.rotation[2, 2]
    tx, ty = -end.in_bearing[1], end.in_bearing[0]
    along = tx * zx + ty * zy
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
def coal_take_in(work: Floats, pose: Records[Pose], table: Records[Contact], row: int) -> bool:
    """Convert coal's results into the requested rows, in H; return whether they suffice."""
    query = query_in(work)
    query.asked &= ~FLANGES
    for k in range(2):
        if query.asked >> k & 1 and coal_turn(work, k):
            query.asked &= ~(1 << k)
    _collect(work, pose, table, row)
    return bool(query.asked == 0)


@inlined
def _collect(work: Floats, pose: Records[Pose], table: Records[Contact], row: int) -> None:
    """Write the rows that are wanted, in H.

    The bore's stand in the ENDs of ``work``, the flanges' in its FLANGE_ANSWERs. Of a cylinder exactly
    parallel to the normal, up to a tilt of some 1e-12, coal takes the middle of the end face for the nearest
    point, 1e-10 of half its length too far out: that is put right. Where the axis of the journal passes
    outside an end circle, which parts cannot do, the closed form's gap stands. A row that is not wanted
    stays as it is.
    """
    dimensions, at, wanted = shape_in(work), frame_in(work), query_in(work).wanted
    for k in range(2):
        if not wanted >> k & 1:
            continue
        out = table[row + k]
        end = end_in(work, k)
        if end.inside == 0:
            bore_contact(dimensions, 1.0 - 2.0 * k, pose[0], out)
            continue
        out.gap = end.gap
        for i in range(3):
            out.normal[i] = end.normal[i]
            out.point[i] = end.in_bearing[i]
    for k in range(2):
        if not wanted >> (2 + k) & 1:
            continue
        out = table[row + 2 + k]
        answer = _answer_in(work, k)
        out.gap = answer.gap
        covers = dimensions.flange_radius >= dimensions.outer_radius
        nx, ny, nz = answer.normal[0], answer.normal[1], answer.normal[2]
        for i in range(3):
            if covers:
                out.normal[i] = at.rotation[0, i] * nx + at.rotation[1, i] * ny + at.rotation[2, i] * nz
            else:
                out.normal[i] = -answer.normal[i]
        if pose[0].sine < 1e-11:
            # Is the nearest point on the axis of the cylinder asked, or at its rim?
            px, py, pz = answer.point[0], answer.point[1], answer.point[2]
            if covers:
                px -= at.origin[0]
                py -= at.origin[1]
            else:
                x = at.rotation[0, 0] * px + at.rotation[0, 1] * py + at.rotation[0, 2] * pz + at.origin[0]
                y = at.rotation[1, 0] * px + at.rotation[1, 1] * py + at.rotation[1, 2] * pz + at.origin[1]
                px, py = x, y
            edge = min(dimensions.outer_radius, dimensions.flange_radius)
            if px * px + py * py < 0.25 * edge * edge:
                flange_contact(dimensions, 1.0 - 2.0 * k, pose[0], out)
                out.gap = answer.gap + 1e-10 * dimensions.half_length - edge * pose[0].sine
                continue
        if not covers:
            for i in range(3):
                out.point[i] = answer.point[i]
            continue
        px = answer.point[0] - at.origin[0]
        py = answer.point[1] - at.origin[1]
        pz = answer.point[2] - at.origin[2]
        for i in range(3):
            out.point[i] = at.rotation[0, i] * px + at.rotation[1, i] * py + at.rotation[2, i] * pz
