"""Layout of a joint with play in a program: its block of numbers.

A block is ``JOINT``, then for each contact its candidate's record
(:mod:`antenna_pin.joints.geometry.kernels`), its normal and its friction law, then under distributed load
``PATCHES`` and the sectors' nodes. Functions return the place of an array, not the array: compiled code
without reference counts returns none.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Matrix3, Record, Vector3, layout, words_of
from antenna_pin.compiled.decorators import in_python, inlined, record
from antenna_pin.contact.kernels import NORMAL_SIZE
from antenna_pin.contact.records import FRICTION_SIZE
from antenna_pin.joints.geometry.kernels import CANDIDATE
from antenna_pin.joints.geometry.patch_kernels import NODE
from antenna_pin.joints.geometry.revolute_kernels import REVOLUTE, Revolute

#: The kind of block that a joint with play is in a program.
CLEARANCE = 1

# Mode of a joint: quantities that Python has written to the contact table.
ALL_COMPILED = 0
GEOMETRY_GIVEN = 1  # gap, normal and point (coal, or another backend in Python)
FORCES_GIVEN = 2  # forces too (laws in Python)


class JointRecord(Record):
    """A joint with play; frames in the joint's frames on parent and child."""

    kind: int  # of the block
    length: int  # of the block, in 8-byte words
    mode: int  # quantities from Python: none, GEOMETRY_GIVEN, FORCES_GIVEN
    q: int  # start of the joint's slice of q
    v: int  # start of the joint's slice of v
    row: int  # row of its first contact in the table
    contacts: int  # number of contacts
    x: int  # start of their integrals
    stride: int  # number of integrals of each
    turn: int  # place of the turned angle in x; -1: none
    planar: int  # 1: 3 freedoms, else 6
    distributed: int  # 1: distributed load
    slides: int  # 1: prismatic
    on_child: int  # 1: the bearing is on the child
    axes: Matrix3  # rotation from joint frame to bearing and journal frame (columns)
    centre: Vector3  # origin of these frames [m]


JOINT = layout(JointRecord)
JOINT_WORDS = words_of(JOINT)

#: A contact's part of a block: candidate, normal law, friction law.
CANDIDATE_WORDS = CANDIDATE + NORMAL_SIZE + FRICTION_SIZE


class Patches(Record):
    """Patches under distributed load; the nodes of sectors follow."""

    strips: int  # number of strips
    sectors: int  # number of sectors
    first: int  # row of the first strip
    radius: float  # radius of the sectors' circle [m]


PATCHES = layout(Patches)
PATCHES_WORDS = words_of(PATCHES)


class Integrals(Record):
    """Integrals of a contact, from its own start in x on; bristles follow."""

    impulse: float  # of the normal force [N s]
    lost_normal: float  # [J]
    lost_friction: float  # [J]


INTEGRALS = layout(Integrals)
BRISTLES = words_of(INTEGRALS)


@inlined
def joint_at(p: Floats, b: int) -> JointRecord:
    """Return the head of the joint whose block stands at p[b:]."""
    return record(p[b : b + JOINT_WORDS], JOINT)


@inlined
def candidate_at(b: int, k: int) -> int:
    """Return where the candidate of contact k stands."""
    return b + JOINT_WORDS + k * CANDIDATE_WORDS


@inlined
def primitive_of(p: Floats, b: int, k: int) -> int:
    """Return the primitive of contact k."""
    return int(revolute_of(p, b, k).primitive)


@inlined
def revolute_of(p: Floats, b: int, k: int) -> Revolute:
    """Return the dimensions of contact k of a revolute joint."""
    at = candidate_at(b, k)
    return record(p[at : at + CANDIDATE], REVOLUTE)


@inlined
def normal_at(b: int, k: int) -> int:
    """Return where contact k's normal law stands."""
    return candidate_at(b, k) + CANDIDATE


@inlined
def friction_at(b: int, k: int) -> int:
    """Return where contact k's friction law stands."""
    return candidate_at(b, k) + CANDIDATE + NORMAL_SIZE


@inlined
def patches_at(p: Floats, b: int) -> Patches:
    """Return the record of distributed load of a joint with four contacts."""
    at = candidate_at(b, 4)
    return record(p[at : at + PATCHES_WORDS], PATCHES)


@inlined
def nodes_at(b: int) -> int:
    """Return where the nodes of the sectors stand."""
    return candidate_at(b, 4) + PATCHES_WORDS


def tail_of(block: NDArray[np.float64]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Return views of a block with distributed load: PATCHES, (1,), and the sectors' nodes."""
    at = in_python(candidate_at)(0, 4)
    end = at + PATCHES_WORDS
    return block[at:end].view(PATCHES), block[end:].view(NODE)
