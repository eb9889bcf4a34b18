"""How a joint with play lies in a program: its block of numbers, declared.

A block is ``JOINT``, then for each contact its candidate's record (:mod:`antenna_pin.geometry.kernels`), its
normal and its friction law, then under distributed load ``PATCHES`` and the sectors' nodes. Of what is an
array the place is returned, not the array: compiled code that counts no references returns none.
"""

from __future__ import annotations

from typing import Any

from antenna_pin.base.records import layout, words_of
from antenna_pin.compiled.decorators import inlined, record
from antenna_pin.contact.friction_kernels import FRICTION_SIZE
from antenna_pin.contact.kernels import NORMAL_SIZE
from antenna_pin.geometry.kernels import CANDIDATE
from antenna_pin.geometry.revolute_kernels import REVOLUTE

#: The kind of block that a joint with play is in a program.
CLEARANCE = 1

# Its mode: what the rows of the contact table hold already.
ALL_COMPILED = 0
GEOMETRY_GIVEN = 1  # gap, normal and point (coal, or another backend in Python)
FORCES_GIVEN = 2  # forces too (laws in Python)

#: Starts of the joint's slices of q and v; rows of its contacts; where in x the numbers start that they
#: integrate, how many each has, and where the turned angle is (-1: none); whether it is a planar joint
#: (3 freedoms, else 6), under distributed load, slides, and has its bearing on the child; axes of bearing and
#: journal frame in the joint's frames on parent and child (columns) and their centre there [m].
JOINT = layout(
    ("kind", "i8"),
    ("length", "i8"),
    ("mode", "i8"),
    ("q", "i8"),
    ("v", "i8"),
    ("row", "i8"),
    ("contacts", "i8"),
    ("x", "i8"),
    ("stride", "i8"),
    ("turn", "i8"),
    ("planar", "i8"),
    ("distributed", "i8"),
    ("slides", "i8"),
    ("on_child", "i8"),
    ("axes", "f8", (3, 3)),
    ("centre", "f8", (3,)),
)
JOINT_WORDS = words_of(JOINT)

#: A contact's part of a block: candidate, normal law, friction law.
CANDIDATE_WORDS = CANDIDATE + NORMAL_SIZE + FRICTION_SIZE

#: Under distributed load: strips, sectors, row of the first strip, radius of the sectors' circle [m]; the
#: sectors' nodes follow (:data:`antenna_pin.geometry.patch_kernels.NODE`).
PATCHES = layout(("strips", "i8"), ("sectors", "i8"), ("first", "i8"), ("radius", "f8"))
PATCHES_WORDS = words_of(PATCHES)

#: What a contact integrates, from its own start in x on; bristles follow.
INTEGRALS = layout(("impulse", "f8"), ("lost_normal", "f8"), ("lost_friction", "f8"))
BRISTLES = words_of(INTEGRALS)


@inlined
def joint_at(p: Any, b: int) -> Any:
    """Return the head of the joint whose block stands at p[b:]."""
    return record(p[b : b + JOINT_WORDS], JOINT)


@inlined
def candidate_at(b: int, k: int) -> int:
    """Return where the candidate of contact k stands."""
    return b + JOINT_WORDS + k * CANDIDATE_WORDS


@inlined
def primitive_of(p: Any, b: int, k: int) -> int:
    """Return the primitive of contact k."""
    return int(revolute_of(p, b, k).primitive)


@inlined
def revolute_of(p: Any, b: int, k: int) -> Any:
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
def patches_at(p: Any, b: int) -> Any:
    """Return the record of distributed load of a joint with four contacts."""
    at = candidate_at(b, 4)
    return record(p[at : at + PATCHES_WORDS], PATCHES)


@inlined
def nodes_at(b: int) -> int:
    """Return where the nodes of the sectors stand."""
    return candidate_at(b, 4) + PATCHES_WORDS
