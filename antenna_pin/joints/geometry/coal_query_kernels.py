"""Queries to coal about a joint with play, of any kind, compiled.

In a run coal's machine code is called by address in between (:func:`query_coal`); without it Python evaluates
the queries between :func:`set_out` and :func:`take_in`.
"""

from __future__ import annotations

from antenna_pin.base.records import Contact, Floats, Pose, Records
from antenna_pin.compiled.calls import call_back
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.joints.geometry.coal_kernels import (
    FLANGED,
    MOST_QUERIES,
    PATCHED,
    SHAPE_AT,
    WORDS,
    coal_set_out,
    coal_take_in,
    query_in,
)
from antenna_pin.joints.geometry.coal_pair_kernels import ROW_WORDS, pairs_set_out, pairs_take_in
from antenna_pin.joints.geometry.coal_patch_kernels import patch_words, patches_set_out, patches_take_in


def most_words(contacts: int, strips: int, sectors: int) -> int:
    """Return the largest size of a joint's work array."""
    return max(WORDS, SHAPE_AT + contacts * ROW_WORDS, patch_words(strips, sectors) if strips else 0)


@inlined
def set_out(work: Floats, pose: Records[Pose], table: Records[Contact], row: int, wanted: int) -> None:
    """Write the queries of wanted contacts (bits) of a joint; of all under distributed load."""
    if query_in(work).kind == FLANGED:
        coal_set_out(work, pose, wanted)
    elif query_in(work).kind == PATCHED:
        patches_set_out(work, pose, table, row)
    else:
        pairs_set_out(work, pose, table, row, wanted)


@inlined
def take_in(work: Floats, pose: Records[Pose], table: Records[Contact], row: int) -> bool:
    """Write coal's results into the rows; return whether they are final."""
    if query_in(work).kind == FLANGED:
        return bool(coal_take_in(work, pose, table, row))
    if query_in(work).kind == PATCHED:
        return bool(patches_take_in(work, table, row))
    return bool(pairs_take_in(work, table, row))


@kernel
def query_coal(work: Floats, pose: Records[Pose], table: Records[Contact], row: int, wanted: int) -> int:
    """Fill the wanted rows of a joint by coal's machine code; return its status."""
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
