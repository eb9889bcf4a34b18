"""Layouts of records that compiled code and classes share, read by field names.

Kernels work on flat arrays of 8-byte words; a part of such an array is read as a record, at the cost of an
offset: ``record(words[at : at + words_of(POSE)], POSE).axis[2]``, with ``record`` of ``compiled.decorators``.
A record is a class with one annotated field a line; ``float`` and ``int`` may stand side by side. Here are
the records that several rooms share; those of laws, shapes and elements stand with their kernels.
"""

from __future__ import annotations

import inspect
import sys
from typing import TYPE_CHECKING, Annotated, Any, Self, TypeVar, get_args, get_origin, get_type_hints

import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.record import Layout

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
    "Block",
    "Contact",
    "Floats",
    "Indices2",
    "Indices3",
    "Ints",
    "Matrix3",
    "Memory",
    "Pose",
    "Program",
    "Record",
    "Records",
    "Six",
    "Triple",
    "Vector2",
    "Vector3",
    "Vector6",
    "memory_numbers",
    "memory_records",
    "numbers_of",
    "packed",
    "place_of",
    "fields_of",
    "layout",
    "words_of",
]


#: Arrays of any size.
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

#: Numbers by themselves, as of a vector, or of a motion or wrench with the linear part first.
Triple = tuple[float, float, float]
Six = tuple[float, float, float, float, float, float]

#: Arrays of fixed size in a record: fields of others are ``Annotated[Floats, shape]``.
Vector2 = Annotated[Floats, 2]
Vector3 = Annotated[Floats, 3]
Vector6 = Annotated[Floats, 6]
Matrix3 = Annotated[Floats, (3, 3)]
Indices2 = Annotated[Ints, 2]
Indices3 = Annotated[Ints, 3]


if TYPE_CHECKING:

    class Record(np.generic):
        """As below: ``numpy.void`` is final in NumPy's stubs, and fields are those that are annotated."""

        def __new__(cls) -> Self: ...  # noqa: D102
        def __getitem__(self, name: str) -> Any: ...
        def __setitem__(self, name: str, value: Any) -> None: ...

else:

    class Record(np.void):
        """A record whose fields are attributes, as in compiled code; ``numpy.record``, in Python, is slow."""

        __getattr__ = np.void.__getitem__  # of what a record has not itself
        __setattr__ = np.void.__setitem__


if TYPE_CHECKING:
    from builtins import property as packed
else:

    class packed(property):  # noqa: N801 - a decorator
        """A computed number of a class for its kernels."""


_Record = TypeVar("_Record", bound=Record)

#: Records in a row, (n,).
Records = np.ndarray[tuple[int], np.dtype[_Record]]


def fields_of(kind: type[Record]) -> dict[str, Any]:
    """Return the fields of a record and their annotations, in order.

    Raises:
        ValueError: A field that NumPy's own attributes would hide.
    """
    names = {"float": float, "int": int} | globals() | vars(sys.modules[kind.__module__])
    fields = {
        name: names.get(hint) or eval(hint, names) if isinstance(hint, str) else hint
        for base in reversed(kind.__mro__)
        for name, hint in inspect.get_annotations(base).items()
    }
    if taken := [name for name in fields if hasattr(Record, name)]:
        raise ValueError(
            f"record: no field may have the name of an attribute of numpy.void, got {', '.join(taken)}: "
            "without the compiler it would be that attribute; take another name"
        )
    return fields


def numbers_of(cls: type[Any]) -> dict[str, Any]:
    """Return the numbers of a class for its kernels, with types: fields, then ``packed`` properties.

    Fields that are no numbers, or are ``unpacked``, are not among them.
    """
    unpacked = getattr(cls, "unpacked", ())
    found = {name: hint for name, hint in get_type_hints(cls).items() if name not in unpacked}
    for base in reversed(cls.__mro__):
        for name, one in vars(base).items():
            if isinstance(one, packed):
                found[name] = get_type_hints(one.fget, include_extras=True)["return"]
    return {name: kind for name, hint in found.items() if (kind := _packed_as(hint)) is not None}


def _packed_as(hint: Any) -> Any:
    """Return the type of a number or fixed array in a record, else None."""
    if hint in (float, int, bool) or get_origin(hint) is Annotated:
        return int if hint is bool else hint
    parts = get_args(hint)
    return Annotated[Floats, len(parts)] if get_origin(hint) is tuple and {*parts} == {float} else None


def layout(kind: type[_Record]) -> Layout[_Record]:
    """Return the layout of a record in 8-byte numbers, fields in order.

    Args:
        kind: A class with fields ``float``, ``int``, or an array of these, as :data:`Vector3`.
    """
    return Layout((kind, [_field(name, hint) for name, hint in fields_of(kind).items()]))


def _field(name: str, hint: Any) -> tuple[Any, ...]:
    """Return a field as NumPy takes it."""
    if hint is float or hint is int:
        return name, hint
    array, shape = get_args(hint)
    (number,) = get_args(get_args(array)[1])
    return name, number, shape if isinstance(shape, tuple) else (shape,)


def words_of(kind: np.dtype[Any]) -> int:
    """Return the size of a record in 8-byte numbers."""
    return kind.itemsize // 8


def place_of(kind: np.dtype[Any], field: str) -> int:
    """Return the place in a record at which a field begins, in 8-byte numbers."""
    assert kind.fields is not None
    return int(kind.fields[field][1]) // 8


# How a joint moves, and what its numbers in q are: an angle about an axis, the same as (cos, sin), a way
# along an axis; (x, y, cos, sin), v being (linear in body axes, rate); a quaternion xyzw, v in body axes;
# position and quaternion, v being (linear, angular) in body axes. To a configuration those of one number are
# alike, and of the last kind: q' = v.
FIXED_AXIS, CIRCLE, SLIDE, PLANE, ROTATION, RIGID, VECTOR = range(7)


class Contact(Record):
    """A candidate contact, a row of the contact table; vectors in bearing axes."""

    gap: float  # [m]; by geometry, as normal and point
    normal: Vector3  # unit, from bearing to journal
    point: Vector3  # from the bearing's centre [m]
    rate: float  # of the depth [m/s]; by the joint, as all that follows
    slip: Vector3  # [m/s]
    force: float  # normal force [N]
    friction: Vector3  # on the journal [N]
    elastic: float  # part of the normal force [N]
    lost_normal: float  # power lost in normal direction, of a patch under distributed load [W]
    lost_friction: float  # power lost to friction, of a patch [W]
    share: float  # of its patch's law; of a flange's own row: sin of half its loaded arc's half-angle
    arm: Vector3  # of a flange under point load: from the force's point to the deepest one [m]


CONTACT = layout(Contact)


class Memory(Record):
    """The discrete state of a contact."""

    touching: float  # 0 or 1
    approach_speed: float  # at the onset of the present contact [m/s]
    effective_mass: float  # at the onset [kg]


MEMORY = layout(Memory)


class Pose(Record):
    """Pose, twist and load of a journal in its bearing, in bearing axes."""

    centre: Vector3  # [m]
    axis: Vector3  # unit
    sine: float  # of the tilt between the axes
    rotation: Matrix3  # from the axes of the joint's frame on the journal's side
    velocity: Vector3  # of the centre [m/s]
    spin: Vector3  # angular velocity [rad/s]
    force: Vector3  # resultant of the contacts on the journal [N]
    moment: Vector3  # of the contacts about the centre [N m]


POSE = layout(Pose)


class Program(Record):
    """The head of a system's program, the flat numbers of all its force elements."""

    nq: int  # size of q
    nv: int  # size of v
    contacts: int  # how many
    rows: int  # of the contact table: contacts, then strips and sectors
    points: int  # where springs between points begin, behind the blocks of joints; the end if none


PROGRAM = layout(Program)


class Block(Record):
    """The beginning of every block of a program."""

    kind: int  # of the block
    length: int  # in 8-byte words


BLOCK = layout(Block)


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
