"""Layouts of the numbers that compiled code and classes share: each is declared once, and read by name.

Kernels work on flat arrays of 8-byte words; a stretch of such an array is read as a record inside, at the
cost of an offset: ``record(words[at : at + words_of(POSE)], POSE).axis[2]``, with ``record`` of
``compiled.decorators``. Integers and floats may stand side by side in one. Here are the records that several
rooms share; those of laws, shapes and elements stand with their kernels.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = [
    "BLOCK",
    "CIRCLE",
    "CONTACT",
    "FIXED_AXIS",
    "MEMORY",
    "PLANE",
    "POSE",
    "PROGRAM",
    "RIGID",
    "ROTATION",
    "SLIDE",
    "VECTOR",
    "Record",
    "memory_numbers",
    "memory_records",
    "place_of",
    "check_names",
    "layout",
    "words_of",
]


class Record(np.void):  # type: ignore[misc]  # final in NumPy's stubs only
    """A record whose fields are attributes, as in compiled code; ``numpy.record``, in Python, is slow."""

    __getattr__ = np.void.__getitem__  # of what a record has not itself
    __setattr__ = np.void.__setitem__


def check_names(names: Iterable[str]) -> None:
    """Refuse names of fields that a record of NumPy's has itself: read uncompiled, they would be those.

    Raises:
        ValueError: Says which.
    """
    if taken := [name for name in names if hasattr(Record, name)]:
        raise ValueError(
            f"record: no field may have the name of an attribute of numpy.void, got {', '.join(taken)}: "
            "without the compiler it would be that attribute; take another name"
        )


def layout(*fields: Any) -> np.dtype[Any]:
    """Return the layout of a record whose fields are read as attributes, compiled or not.

    Args:
        *fields: As NumPy takes them, of 8-byte numbers: ``("rate", "f8")``, ``("normal", "f8", (3,))``.

    Raises:
        ValueError: A field that NumPy's own attributes would hide.
    """
    check_names(field[0] for field in fields)
    return np.dtype((Record, list(fields)))


def words_of(kind: np.dtype[Any]) -> int:
    """Return how many 8-byte numbers a record has."""
    return kind.itemsize // 8


def place_of(kind: np.dtype[Any], field: str) -> int:
    """Return where in a record a field begins, in 8-byte numbers."""
    assert kind.fields is not None
    return int(kind.fields[field][1]) // 8


# How a joint moves, and what its numbers in q are: an angle about an axis, the same as (cos, sin), a way
# along an axis; (x, y, cos, sin), v being (linear in body axes, rate); a quaternion xyzw, v in body axes;
# position and quaternion, v being (linear, angular) in body axes. To a configuration those of one number are
# alike, and of the last kind: q' = v.
FIXED_AXIS, CIRCLE, SLIDE, PLANE, ROTATION, RIGID, VECTOR = range(7)

#: A candidate contact, a row of the contact table; vectors in bearing axes. Geometry fills the gap [m], the
#: normal (bearing to journal) and the point [m] from the bearing's centre, a joint the rest: depth rate
#: [m/s], slip [m/s], normal force, friction on the journal and the normal force's elastic part [N]; of a
#: patch under distributed load the power lost in normal direction and to friction [W]; of a strip or sector
#: its ``share`` of its patch's law (of a flange's own row: sin of half its loaded arc's half-angle); of a
#: flange under point load the ``arm`` from the force's point to the deepest one [m].
CONTACT = layout(
    ("gap", "f8"),
    ("normal", "f8", (3,)),
    ("point", "f8", (3,)),
    ("rate", "f8"),
    ("slip", "f8", (3,)),
    ("force", "f8"),
    ("friction", "f8", (3,)),
    ("elastic", "f8"),
    ("lost_normal", "f8"),
    ("lost_friction", "f8"),
    ("share", "f8"),
    ("arm", "f8", (3,)),
)

#: What a contact remembers: whether it touches (0 or 1), approach speed [m/s] and effective mass [kg] at the
#: onset of the present contact.
MEMORY = layout(("touching", "f8"), ("approach_speed", "f8"), ("effective_mass", "f8"))

#: Pose and twist of a journal in its bearing, all in bearing axes: centre [m], unit axis, sine of the tilt
#: between the axes, rotation from the axes of the joint's frame on the journal's side, velocity of the centre
#: [m/s], angular velocity [rad/s]; and room for the resultant of its contacts about the centre [N, N m].
POSE = layout(
    ("centre", "f8", (3,)),
    ("axis", "f8", (3,)),
    ("sine", "f8"),
    ("rotation", "f8", (3, 3)),
    ("velocity", "f8", (3,)),
    ("spin", "f8", (3,)),
    ("force", "f8", (3,)),
    ("moment", "f8", (3,)),
)

#: Head of a system's program, the flat numbers of all its force elements: sizes of q and v, contacts, rows of
#: its contact table (contacts, then strips and sectors), and where behind the blocks of joints those of
#: springs between points begin: its end if there are none.
PROGRAM = layout(("nq", "i8"), ("nv", "i8"), ("contacts", "i8"), ("rows", "i8"), ("points", "i8"))

#: How every block of a program begins: what it is, and how many 8-byte numbers it takes.
BLOCK = layout(("kind", "i8"), ("length", "i8"))


def memory_records(numbers: Any) -> NDArray[Any]:
    """Return contact memory as records, (contacts,), from records or plain numbers, (contacts, 3)."""
    given = np.asarray(numbers)
    if given.dtype == MEMORY:
        return given
    plain: NDArray[np.float64] = np.ascontiguousarray(given, dtype=float)
    return plain.reshape(-1, words_of(MEMORY)).view(MEMORY)[:, 0]


def memory_numbers(memory: NDArray[Any]) -> NDArray[np.float64]:
    """Return contact memory as plain numbers: touching, approach speed, effective mass, (contacts, 3)."""
    plain: NDArray[np.float64] = np.ascontiguousarray(memory).view(np.float64)
    return plain.reshape(-1, words_of(MEMORY)).copy()
