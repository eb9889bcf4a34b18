"""Queries to coal at a state: written and evaluated by compiled code.

After the contact table, the work array of :func:`antenna_pin.dynamics.kernels.evaluate` has a section for
each joint whose gaps are measured by coal without other Python code: the place of its block in the program,
and the array of queries and results (:mod:`antenna_pin.joints.geometry.coal_query_kernels`). If coal's
machine code is called by address, :func:`answer_queries` does all of it; else Python is called back between
:func:`set_out_queries` and :func:`take_in_queries`.
"""

from __future__ import annotations

from antenna_pin.base.records import CONTACT, MEMORY, POSE, Floats, Program, Record, layout, words_of
from antenna_pin.compiled.decorators import deferred, inlined, kernel, record
from antenna_pin.dynamics.kernels import CONTACT_WORDS, MEMORY_WORDS, POSE_WORDS, evaluate, head_of
from antenna_pin.joints.geometry.coal_query_kernels import query_coal, set_out, take_in
from antenna_pin.joints.layout_kernels import joint_at
from antenna_pin.joints.pose_kernels import journal_state


class Queried(Record):
    """The head of a joint's stretch of queries."""

    block: int  # place of the joint in the program
    words: int  # length of the section


QUERIED = layout(Queried)
HEAD = words_of(QUERIED)


@inlined
def _first_piece(head: Program) -> int:
    """Return where the first stretch begins."""
    return int(head.nv + POSE_WORDS + MEMORY_WORDS * head.contacts + CONTACT_WORDS * head.rows)


@inlined
def has_queries(program: Floats, work: Floats) -> bool:
    """Return whether queries are necessary."""
    return bool(_first_piece(head_of(program)) < work.shape[0])


@deferred
def set_out_queries(y: Floats, program: Floats, work: Floats) -> None:
    """Write the queries to coal at the state y: gaps of touching contacts."""
    head = head_of(program)
    nv = head.nv
    pose = work[nv : nv + POSE_WORDS].view(POSE)
    memory = work[nv + POSE_WORDS : nv + POSE_WORDS + MEMORY_WORDS * head.contacts].view(MEMORY)
    at = _first_piece(head)
    table = work[at - CONTACT_WORDS * head.rows : at].view(CONTACT)
    while at < work.shape[0]:
        queried = record(work[at : at + HEAD], QUERIED)
        j = joint_at(program, queried.block)
        wanted = 0
        for k in range(j.contacts):
            if memory[j.row + k].touching != 0.0:
                wanted |= 1 << k
        journal_state(j, y, head.nq, pose[0])
        set_out(work[at + HEAD : at + queried.words], pose, table, j.row, wanted)
        at += queried.words


@deferred
def take_in_queries(y: Floats, program: Floats, work: Floats) -> bool:
    """Write coal's results into the contact table; return whether they are final."""
    head = head_of(program)
    nv = head.nv
    pose = work[nv : nv + POSE_WORDS].view(POSE)
    at = _first_piece(head)
    table = work[at - CONTACT_WORDS * head.rows : at].view(CONTACT)
    final = True
    while at < work.shape[0]:
        queried = record(work[at : at + HEAD], QUERIED)
        j = joint_at(program, queried.block)
        journal_state(j, y, head.nq, pose[0])
        if not take_in(work[at + HEAD : at + queried.words], pose, table, j.row):
            final = False
        at += queried.words
    return final


@deferred
def answer_queries(y: Floats, program: Floats, work: Floats, everything: bool) -> int:
    """Measure the gaps of touching contacts, or of all, by coal's machine code.

    Returns:
        Status of the first call that failed, 0 if none did.
    """
    head = head_of(program)
    nv = head.nv
    pose = work[nv : nv + POSE_WORDS].view(POSE)
    memory = work[nv + POSE_WORDS : nv + POSE_WORDS + MEMORY_WORDS * head.contacts].view(MEMORY)
    at = _first_piece(head)
    table = work[at - CONTACT_WORDS * head.rows : at].view(CONTACT)
    while at < work.shape[0]:
        queried = record(work[at : at + HEAD], QUERIED)
        j = joint_at(program, queried.block)
        wanted = 0
        for k in range(j.contacts):
            if everything or memory[j.row + k].touching != 0.0:
                wanted |= 1 << k
        if wanted != 0:
            journal_state(j, y, head.nq, pose[0])
            status = query_coal(work[at + HEAD : at + queried.words], pose, table, j.row, wanted)
            if status != 0:
                return int(status)
        at += queried.words
    return 0


@kernel
def evaluate_queried(t: float, y: Floats, program: Floats, work: Floats, rates: Floats) -> int:
    """:func:`antenna_pin.dynamics.kernels.evaluate` on measured gaps; return the status of the queries."""
    status = answer_queries(y, program, work, False)
    evaluate(t, y, program, work, rates)
    return int(status)
