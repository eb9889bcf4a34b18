"""Shapes of joints with play as lists of candidate contacts, compiled.

A joint with play is a row of *candidates*, each a record of ``CANDIDATE`` words that begins with its
primitive. A new primitive is a file of its own and one line here.
"""

from __future__ import annotations

import math

from antenna_pin.base.records import Contact, Floats, Pose, Records, words_of
from antenna_pin.compiled.decorators import inlined, kernel, record
from antenna_pin.joints.geometry.corner_kernels import CORNER, corner_contact
from antenna_pin.joints.geometry.guide_kernels import EDGE, edge_contact, rod_contact
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE, bore_contact, flange_contact
from antenna_pin.joints.geometry.round_kernels import ROUND, ball_contact, circle_contact

#: Words of a candidate's record, whatever its primitive.
CANDIDATE = words_of(REVOLUTE)

BORE = 1
FLANGE = 2
CIRCLE_IN_CIRCLE = 3
BALL = 4
CORNER_ON_WALL = 5
EDGE_IN_GUIDE = 6
ROD_IN_GUIDE = 7


@inlined
def candidate_contact(words: Floats, at: int, pose: Pose, out: Contact) -> None:
    """Fill gap, normal and point of the candidate whose record stands at words[at:]."""
    shape = words[at : at + CANDIDATE]
    revolute = record(shape, REVOLUTE)
    primitive = revolute.primitive
    if primitive == BORE:
        bore_contact(revolute, revolute.side, pose, out)
    elif primitive == FLANGE:
        flange_contact(revolute, revolute.side, pose, out)
    elif primitive == CIRCLE_IN_CIRCLE:
        circle_contact(record(shape, ROUND), pose, out)
    elif primitive == BALL:
        ball_contact(record(shape, ROUND), pose, out)
    elif primitive == CORNER_ON_WALL:
        corner_contact(record(shape, CORNER), pose, out)
    elif primitive == EDGE_IN_GUIDE:
        edge_contact(record(shape, EDGE), pose, out)
    elif primitive == ROD_IN_GUIDE:
        rod_contact(revolute, pose, out)
    else:
        out.gap = math.nan  # no such primitive


@kernel
def fill(candidates: Floats, pose: Records[Pose], table: Records[Contact]) -> None:
    """Fill the rows of a table from flat candidates, one after another; pose: POSE, (1,)."""
    for k in range(table.shape[0]):
        candidate_contact(candidates, k * CANDIDATE, pose[0], table[k])
