"""Queries to coal about a joint with play, of any kind, compiled.

In a run machine code of coal's is called by address in between (:func:`query_coal`); from Python, where there
is none, Python asks between :func:`set_out` and :func:`take_in`.
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats, Pose, Records
from antenna_pin.compiled.calls import call_back
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.joints.geometry.coal_kernels import (
    FLANGED,
    MOST_QUERIES,
    coal_set_out,
    coal_take_in,
    query_in,
)
from antenna_pin.joints.geometry.coal_pair_kernels import pairs_set_out, pairs_take_in


@inlined
def set_out(work: Floats, pose: Records[Pose], table: Records[Contact], row: int, wanted: int) -> None:
    """Write the queries of the wanted contacts of a joint, as bits, whose rows begin at ``row``."""
    if query_in(work).kind == FLANGED:
        coal_set_out(work, pose, wanted)
    else:
        pairs_set_out(work, pose, table, row, wanted)


@inlined
def take_in(work: Floats, pose: Records[Pose], table: Records[Contact], row: int) -> bool:
    """Write coal's results into the rows; return whether they are final, or coal is to be asked again."""
    if query_in(work).kind == FLANGED:
        return bool(coal_take_in(work, pose, table, row))
    return bool(pairs_take_in(work, table, row))


@kernel
def query_coal(work: Floats, pose: Records[Pose], table: Records[Contact], row: int, wanted: int) -> int:
    """Fill the wanted rows of a joint by coal's machine code; return its status, 0 if all is well."""
    query = query_in(work)
    set_out(work, pose, table, row, wanted)
    for _ in range(MOST_QUERIES):
        if query.asked != 0:
            status = call_back(query.answer, 0.0, query.pairs)
            if status != 0:
                return int(status)
        if take_in(work, pose, table, row):
            break
    return 0


@kernel
def set_out_queries(
    work: Floats, pose: Records[Pose], table: Records[Contact], row: int, wanted: int
) -> None:
    """:func:`set_out`, called from Python."""
    set_out(work, pose, table, row, wanted)


@kernel
def take_in_queries(work: Floats, pose: Records[Pose], table: Records[Contact], row: int) -> bool:
    """:func:`take_in`, called from Python."""
    return bool(take_in(work, pose, table, row))
