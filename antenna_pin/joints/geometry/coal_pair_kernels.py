"""Queries to coal about candidate contacts one by one, compiled: round parts, corners, edges, rods.

Adjacent parts of journal and bearing are found in closed form; coal measures their distances.
:func:`pairs_set_out` places the two shapes of each wanted contact, :func:`pairs_take_in` reads the measured
distances.

The work array of a joint has, after its QUERY, the candidates, (contacts, CANDIDATE), then the pairs,
(contacts, PAIR).
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
    Vector3,
    layout,
    words_of,
)
from antenna_pin.compiled.decorators import deferred, inlined, record
from antenna_pin.joints.geometry.coal_kernels import SHAPE_AT, query_in
from antenna_pin.joints.geometry.corner_kernels import CORNER, Corner
from antenna_pin.joints.geometry.guide_kernels import EDGE, GuideCorner
from antenna_pin.joints.geometry.kernels import (
    BALL,
    CANDIDATE,
    CIRCLE_IN_CIRCLE,
    CORNER_ON_WALL,
    EDGE_IN_GUIDE,
    candidate_contact,
)
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE


class PairQuery(Record):
    """Two shapes in bearing axes, and their distance."""

    first: Vector3  # place of the first shape [m]
    second: Vector3  # place of the second shape [m]
    turn: Matrix3  # rotation of the second shape; of a plane its normal and distance [m]
    gap: float  # distance [m], negative in penetration
    normal: Vector3  # normal from the first shape to the second
    point: Vector3  # nearest point of the first shape [m]


PAIR = layout(PairQuery)
PAIR_WORDS = words_of(PAIR)
#: Words of a contact.
ROW_WORDS = CANDIDATE + PAIR_WORDS


@inlined
def _pair_in(work: Floats, k: int) -> PairQuery:
    """Return the pair of contact k."""
    at = SHAPE_AT + query_in(work).rows * CANDIDATE + k * PAIR_WORDS
    return record(work[at : at + PAIR_WORDS], PAIR)


@deferred
def pairs_set_out(work: Floats, pose: Records[Pose], table: Records[Contact], row: int, wanted: int) -> None:
    """Place the shapes of the wanted contacts, and request their distances.

    Contact k has bit k of ``wanted``, and bits 2 k and 2 k + 1 of the queries: of a rod the first is the
    rim against the guide, the second the mouth against the rod.
    """
    query = query_in(work)
    query.wanted = wanted
    query.asked = 0
    for k in range(query.rows):
        if wanted >> k & 1:
            query.asked |= _set_out(work, k, pose[0], table[row + k]) << (2 * k)


@inlined
def _set_out(work: Floats, k: int, pose: Pose, out: Contact) -> int:
    """Place the shapes of contact k; return its requested queries as bits."""
    at = SHAPE_AT + k * CANDIDATE
    words, pair = work[at : at + CANDIDATE], _pair_in(work, k)
    primitive = record(words, REVOLUTE).primitive
    if primitive == CORNER_ON_WALL:
        _place_corner(record(words, CORNER), pose, pair)
        return 1
    candidate_contact(work, at, pose, out)
    if primitive == CIRCLE_IN_CIRCLE or primitive == BALL:
        for i in range(3):
            pair.first[i] = out.point[i]
            pair.second[i] = pose.centre[i]
        return 1
    if primitive == EDGE_IN_GUIDE:
        _place_edge(record(words, EDGE), out, pair)
        return 1
    return _place_rod(record(words, REVOLUTE).half_length, pose, out, pair)


@inlined
def _place_corner(shape: Corner, pose: Pose, pair: PairQuery) -> None:
    """Place the ball of a corner's rounding; the wall stands at the origin."""
    for i in range(3):
        place = pose.centre[i]
        for k in range(3):
            place += pose.rotation[i, k] * shape.corner[k]
        pair.first[i] = place
        pair.second[i] = 0.0


@inlined
def _place_edge(shape: GuideCorner, out: Contact, pair: PairQuery) -> None:
    """Place the ball of an edge's rounding, and the plane through the mouth."""
    x = -shape.distance * shape.wall[0]
    y = -shape.distance * shape.wall[1]
    z = math.copysign(shape.reach, out.point[2])
    for i in range(3):
        pair.first[i] = out.point[i] + shape.radius * out.normal[i]
        pair.second[i] = 0.0
        pair.turn[0, i] = out.normal[i]
    pair.turn[1, 0] = out.normal[0] * x + out.normal[1] * y + out.normal[2] * z


@inlined
def _place_rod(reach: float, pose: Pose, out: Contact, pair: PairQuery) -> int:
    """Place a point of the rim (1) or the mouth (2); 0: none is near."""
    if abs(out.normal[2]) == 1.0:
        return 0  # outside the guide: no round part is near
    for i in range(3):
        pair.first[i] = out.point[i]
    if abs(out.point[2]) != reach:
        pair.second[0] = 0.0
        pair.second[1] = 0.0
        pair.second[2] = out.point[2]
        return 1
    for i in range(3):
        pair.second[i] = pose.centre[i]
    _write_smallest_rotation(pose, pair)
    return 2


@inlined
def _write_smallest_rotation(pose: Pose, pair: PairQuery) -> None:
    """Write the smallest rotation that takes the z axis to the journal's axis."""
    x, y, z = pose.axis[0], pose.axis[1], pose.axis[2]
    length = math.sqrt(x * x + y * y + z * z)
    x, y, z = x / length, y / length, z / length
    upright = z >= -1.0 + 1e-12
    f = 1.0 / (1.0 + z) if upright else 0.0
    pair.turn[0, 0] = 1.0 - f * x * x if upright else 1.0
    pair.turn[0, 1] = -f * x * y if upright else 0.0
    pair.turn[0, 2] = x if upright else 0.0
    pair.turn[1, 0] = -f * x * y if upright else 0.0
    pair.turn[1, 1] = 1.0 - f * y * y if upright else -1.0
    pair.turn[1, 2] = y if upright else 0.0
    pair.turn[2, 0] = -x if upright else 0.0
    pair.turn[2, 1] = -y if upright else 0.0
    pair.turn[2, 2] = z if upright else -1.0


@deferred
def pairs_take_in(work: Floats, table: Records[Contact], row: int) -> bool:
    """Write measured gaps, normals and points into the requested rows; return that they are final."""
    query = query_in(work)
    for k in range(query.rows):
        asked = query.asked >> (2 * k) & 3
        if asked == 0:
            continue
        out, pair = table[row + k], _pair_in(work, k)
        primitive = record(
            work[SHAPE_AT + k * CANDIDATE : SHAPE_AT + (k + 1) * CANDIDATE], REVOLUTE
        ).primitive
        slider = primitive == CORNER_ON_WALL or primitive == EDGE_IN_GUIDE
        if not slider and primitive != CIRCLE_IN_CIRCLE and primitive != BALL and asked == 1:
            out.gap = -pair.gap  # inside the guide: the closed form's normal is used
            continue
        out.gap = pair.gap
        for i in range(3):
            # coal's normal is from the first shape to the second: from the slider to its wall
            out.normal[i] = -pair.normal[i] if slider else pair.normal[i]
            if primitive == CORNER_ON_WALL:
                out.point[i] = pair.point[i]
    query.asked = 0
    return True
