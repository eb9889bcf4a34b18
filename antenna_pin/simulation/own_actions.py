"""What a run does by itself where something of an element passes: no action of a user's events."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["GRAZE", "STILL", "Edge", "Kink", "Switch"]


@dataclass(frozen=True, slots=True)
class Kink:
    """A step ends there, unrecorded: where an element's effort has a kink."""


#: Of a function of an element's: a rate that is none [1/s].
STILL = 1e-11
#: How far below zero it may come and go back unseen, as round-off [rad] ([m]).
GRAZE = 1e-15


@dataclass(frozen=True, slots=True)
class Switch:
    """An element may change its mode.

    Attributes:
        place: Of the element, as ``latches.hinge``.
        number: Of its function that passes zero.
    """

    place: str
    number: int


@dataclass(frozen=True, slots=True)
class Edge:
    """An element changes by itself, at the instants that it names.

    Attributes:
        place: Of the element, as ``forces.jet``.
    """

    place: str
