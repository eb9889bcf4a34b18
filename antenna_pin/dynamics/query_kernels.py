"""Queries to coal at a state: written and evaluated by compiled code.

Behind the contact table, the work array of :func:`antenna_pin.dynamics.kernels.evaluate` has a stretch for
each joint of which coal measures the gaps and nothing else is done in Python: where its block stands in the
program, arguments and results (:mod:`antenna_pin.joints.geometry.coal_kernels`).
"""

from __future__ import annotations

from antenna_pin.base.records import CONTACT, MEMORY, POSE, Floats, Program, Record, layout, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.dynamics.kernels import CONTACT_WORDS, MEMORY_WORDS, POSE_WORDS, head_of
from antenna_pin.joints.geometry.coal_kernels import WORDS, coal_set_out, coal_take_in
from antenna_pin.joints.layout_kernels import joint_at
from antenna_pin.joints.pose_kernels import journal_state


class Queried(Record):
    """The head of a joint's stretch of queries."""

    block: int  # of the joint in the program


QUERIED = layout(Queried)
HEAD = words_of(QUERIED)
QUERIED_WORDS = HEAD + WORDS


@inlined
def _first_piece(head: Program) -> int:
    """Return where the first stretch begins."""
    return int(head.nv + POSE_WORDS + MEMORY_WORDS * head.contacts + CONTACT_WORDS * head.rows)


@inlined
def has_queries(program: Floats, work: Floats) -> bool:
    """Return whether queries are necessary."""
    return bool(_first_piece(head_of(program)) < work.shape[0])


@kernel
def set_out_queries(y: Floats, program: Floats, work: Floats) -> None:
    """Write the queries to coal at the state y: gaps of touching contacts."""
    head = head_of(program)
    nv = head.nv
    pose = work[nv : nv + POSE_WORDS].view(POSE)
    memory = work[nv + POSE_WORDS : nv + POSE_WORDS + MEMORY_WORDS * head.contacts].view(MEMORY)
    at = _first_piece(head)
    while at < work.shape[0]:
        j = joint_at(program, record(work[at : at + HEAD], QUERIED).block)
        wanted = 0
        for k in range(j.contacts):
            if memory[j.row + k].touching != 0.0:
                wanted |= 1 << k
        journal_state(j, y, head.nq, pose[0])
        coal_set_out(work[at + HEAD : at + QUERIED_WORDS], pose, wanted)
        at += QUERIED_WORDS


@kernel
def take_in_queries(y: Floats, program: Floats, work: Floats) -> bool:
    """Write coal's results into the contact table; return whether they are final."""
    head = head_of(program)
    nv = head.nv
    pose = work[nv : nv + POSE_WORDS].view(POSE)
    at = _first_piece(head)
    table = work[at - CONTACT_WORDS * head.rows : at].view(CONTACT)
    final = True
    while at < work.shape[0]:
        j = joint_at(program, record(work[at : at + HEAD], QUERIED).block)
        journal_state(j, y, head.nq, pose[0])
        if not coal_take_in(work[at + HEAD : at + QUERIED_WORDS], pose, table, j.row):
            final = False
        at += QUERIED_WORDS
    return final
