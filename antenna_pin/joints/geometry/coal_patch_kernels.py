"""Queries to coal about a joint under distributed load, compiled: strips and sectors.

The strips are those loaded in closed form and their neighbours on the surface, the sectors those of pressing
flanges; each is measured as a point against the journal, or against the inner face of its flange.

The work array of a joint has, after its QUERY, REVOLUTE and FRAME, the END of each strip, PATCH_QUERY, the
nodes of the sectors, (sectors, NODE), and for each flange its deepest point and its sectors, (2, sectors + 1,
POINT).
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats, Pose, Record, Records, Vector3, layout, words_of
from antenna_pin.compiled.decorators import deferred, inlined, record
from antenna_pin.joints.geometry.coal_kernels import (
    END_WORDS,
    ENDS_AT,
    PlacementRecord,
    coal_set_out,
    coal_start,
    coal_turn,
    end_in,
    frame_in,
    query_in,
    shape_in,
)
from antenna_pin.joints.geometry.patch_kernels import (
    APART,
    NODE,
    sector_contacts,
    strip_contacts,
    take_place,
)


class PatchQuery(Record):
    """Strips and sectors of a joint."""

    strips: int  # number of strips
    sectors: int  # number of sectors of each flange
    first: int  # row of the first strip, from the joint's first row
    radius: float  # radius of the sectors' circle [m]


PATCH_QUERY = layout(PatchQuery)
_HEAD_WORDS = words_of(PATCH_QUERY)
NODE_WORDS = words_of(NODE)


class PointQuery(Record):
    """A point of an end face before a flange's inner face, in J."""

    asked: int  # 1: to be measured by coal
    place: Vector3  # [m]
    gap: float  # [m]
    normal: Vector3  # normal from bearing to journal


POINT = layout(PointQuery)
POINT_WORDS = words_of(POINT)


def patch_words(strips: int, sectors: int) -> int:
    """Return the size of the work array of a joint under distributed load."""
    return points_at(strips, sectors) + 2 * (sectors + 1) * POINT_WORDS


def head_at(strips: int) -> int:
    """Return where PATCH_QUERY stands in a work array."""
    return ENDS_AT + strips * END_WORDS


def points_at(strips: int, sectors: int) -> int:
    """Return where the points stand in a work array."""
    return head_at(strips) + _HEAD_WORDS + sectors * NODE_WORDS


@inlined
def _patches_in(work: Floats) -> PatchQuery:
    """Return the numbers of strips and sectors; QUERY has the number of strips, too."""
    at = ENDS_AT + query_in(work).strips * END_WORDS
    return record(work[at : at + _HEAD_WORDS], PATCH_QUERY)


@inlined
def _nodes_in(work: Floats) -> int:
    """Return where the sectors' nodes begin."""
    return int(ENDS_AT + query_in(work).strips * END_WORDS + _HEAD_WORDS)


@inlined
def _point_in(work: Floats, k: int) -> PointQuery:
    """Return point k of both flanges."""
    at = _nodes_in(work) + _patches_in(work).sectors * NODE_WORDS + k * POINT_WORDS
    return record(work[at : at + POINT_WORDS], POINT)


@inlined
def _row_of(patches: PatchQuery, row: int, k: int) -> int:
    """Return the row of point k: each flange, followed by its sectors."""
    each = patches.sectors + 1
    flange, sector = k // each, k % each
    if sector == 0:
        return int(row + 2 + flange)
    return int(row + patches.first + patches.strips + flange * patches.sectors + sector - 1)


@deferred
def patches_set_out(work: Floats, pose: Records[Pose], table: Records[Contact], row: int) -> None:
    """Fill the rows in closed form; request strips and sectors near contact."""
    coal_set_out(work, pose, 0)
    query, patches, shape = query_in(work), _patches_in(work), shape_in(work)
    first, strips = row + patches.first, patches.strips
    strip_contacts(shape, strips, pose[0], table, row, first)
    for k in range(strips):
        end = end_in(work, k)
        end.asked = 0
        if table[first + k].gap != APART and coal_start(work, k, (2.0 * k + 1.0) / strips - 1.0, pose):
            end.asked = 1
            query.asked = 1
    at = _nodes_in(work)
    nodes = work[at : at + patches.sectors * NODE_WORDS].view(NODE)
    sector_contacts(shape, nodes, patches.radius, pose[0], table, row + 2, first + strips)
    frame = frame_in(work)
    for k in range(2 * (patches.sectors + 1)):
        point, out = _point_in(work, k), table[_row_of(patches, row, k)]
        point.asked = 0
        if out.gap != APART:
            point.asked = 1
            query.asked = 1
            _place(frame, out, point)


@inlined
def _place(frame: PlacementRecord, out: Contact, point: PointQuery) -> None:
    """Write the place of a contact's point in J."""
    r, p = frame.rotation, out.point
    for i in range(3):
        point.place[i] = r[i, 0] * p[0] + r[i, 1] * p[1] + r[i, 2] * p[2] + frame.origin[i]


@deferred
def patches_take_in(work: Floats, table: Records[Contact], row: int) -> bool:
    """Convert coal's results into the rows, in H; return whether they are final."""
    query, patches, frame = query_in(work), _patches_in(work), frame_in(work)
    first, strips = row + patches.first, patches.strips
    query.asked = 0
    for k in range(strips):
        end = end_in(work, k)
        if end.asked == 0:
            continue
        if coal_turn(work, k):
            end.asked = 0
        else:
            query.asked = 1
        out = table[first + k]
        out.gap = end.gap
        for i in range(3):
            out.normal[i] = end.normal[i]
            out.point[i] = end.in_bearing[i]
    half = strips // 2
    for h in range(2):
        begin = first + half if h == 0 else first
        least = begin
        for k in range(begin, begin + half):
            if table[k].gap < table[least].gap:
                least = k
        take_place(table[row + h], table[least])
    for k in range(2 * (patches.sectors + 1)):
        point = _point_in(work, k)
        if point.asked == 0:
            continue
        point.asked = 0
        out, r, n = table[_row_of(patches, row, k)], frame.rotation, point.normal
        out.gap = point.gap
        for i in range(3):
            out.normal[i] = r[0, i] * n[0] + r[1, i] * n[1] + r[2, i] * n[2]
    return bool(query.asked == 0)
