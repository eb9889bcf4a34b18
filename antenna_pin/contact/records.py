"""Records of the laws' numbers, one for each kind.

The class of a law and its kernels take their names from it.

A law travels as a flat array. A normal law has ``NORMAL_SIZE`` floats, the kinds of its elastic part and of
its dissipation before the parameters of both; a friction law has ``FRICTION_SIZE``, its kind first. Seen as
the record of its kind such an array has names, in a kernel and outside alike, at the speed of an offset::

    record(law, POWER_LAW).stiffness

The classes write it by the same names, with :func:`coded`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import Record, fields_of
from antenna_pin.compiled.record import Layout, record

_Record = TypeVar("_Record", bound=Record)

_ELASTIC_ROOM = 8
_DISSIPATION_ROOM = 6
_KINDS = 2  # of elastic part and dissipation, before the parameters of both

# Kinds of elastic laws, as ``elastic`` of a normal law has them; functions of a user's have theirs in
# :mod:`antenna_pin.contact.called_kernels`.
POWER, LOGARITHMIC, FOUNDATION, BAI_ZHAO, PERSSON, PIN_JOINT = 1.0, 2.0, 3.0, 4.0, 5.0, 6.0

NORMAL_SIZE = _KINDS + _ELASTIC_ROOM + _DISSIPATION_ROOM
FRICTION_SIZE = 12


def _record(size: int, start: int, room: int, kind: type[_Record]) -> Layout[_Record]:
    """Return a record of ``size`` floats with names from float ``start`` on.

    There are at most ``room`` names.
    """
    names = tuple(fields_of(kind))
    if len(names) > room:
        raise ValueError(f"{', '.join(names)}: there is room for {room}")
    layout = {
        "names": names,
        "formats": ["f8"] * len(names),
        "offsets": [8 * (start + i) for i in range(len(names))],
        "itemsize": 8 * size,
    }
    return Layout((kind, layout))


def elastic_record(kind: type[_Record]) -> Layout[_Record]:
    """Return the record of a normal law, with names for its elastic parameters."""
    return _record(NORMAL_SIZE, _KINDS, _ELASTIC_ROOM, kind)


def dissipation_record(kind: type[_Record]) -> Layout[_Record]:
    """Return the record of a normal law with names for the parameters of its dissipation."""
    return _record(NORMAL_SIZE, _KINDS + _ELASTIC_ROOM, _DISSIPATION_ROOM, kind)


def friction_record(kind: type[_Record]) -> Layout[_Record]:
    """Return the record of a friction law with names for its parameters."""
    return _record(FRICTION_SIZE, 1, FRICTION_SIZE - 1, kind)


class NormalLawRecord(Record):
    """The kinds of a normal law, before its parameters."""

    elastic: float  # POWER, LOGARITHMIC, ...
    dissipation: float  # CONSERVATIVE, HYSTERETIC, ... of ``damping_kernels``


class FrictionLawRecord(Record):
    """The kind of a friction law, before its parameters."""

    kind: float  # FRICTIONLESS, VELOCITY_BASED, ... of ``friction_kernels``


NORMAL_LAW = _record(NORMAL_SIZE, 0, _KINDS, NormalLawRecord)
FRICTION_LAW = _record(FRICTION_SIZE, 0, 1, FrictionLawRecord)


def coded(code: NDArray[np.float64], layout: Layout[Any], values: Mapping[str, float]) -> None:
    """Write the parameters of a law into its flat numbers.

    Args:
        code: The law's numbers, shape (``NORMAL_SIZE``,) or (``FRICTION_SIZE``,).
        layout: The record of its kind.
        values: One for each name of the record.

    Raises:
        ValueError: A name is missing, or is not the record's.
    """
    if set(values) != set(layout.names or ()):
        raise ValueError(f"takes {', '.join(layout.names or ())}, got {', '.join(values)}")
    row = record(code, layout)
    for name, value in values.items():
        row[name] = value
