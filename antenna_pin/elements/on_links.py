"""Base of elements on links: forces from outside, thrusters, users' elements."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.elements.element import GROSS_WORK, LOSS, WORK, ForceElement, Integral
from antenna_pin.elements.points import Point, checked_point

_AXES = ("x", "y", "z")

#: What is integrated of each, as ``BOOK`` has it.
BOOKED: tuple[Integral, ...] = (
    WORK,
    GROSS_WORK,
    LOSS,
    *(Integral(f"impulse_{axis}", "N*s") for axis in _AXES),
    *(Integral(f"angular_impulse_{axis}", "N*m*s") for axis in _AXES),
    *(Integral(f"central_impulse_{axis}", "N*m*s") for axis in _AXES),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class OnLinks(ForceElement):
    """Base of the elements that act on links, in the world's axes.

    Its kernel is ``act`` (:mod:`antenna_pin.elements.desk_kernels`). What it does is booked as work that it
    puts in, and as impulse and angular impulse.
    """

    integrals: ClassVar[tuple[Integral, ...]] = BOOKED

    # Whether its links are all bodies, at their mass centres; whether gravity must be none beside it.
    everywhere: ClassVar[bool] = False
    replaces_gravity: ClassVar[bool] = False
    # Whether the first link takes the reaction of all others; whether it puts nothing in.
    internal: ClassVar[bool] = False
    passive: ClassVar[bool] = False

    on: bool = True

    @property
    def places(self) -> tuple[Point, ...]:
        """The links that it acts on, each with a point in its frame [m]."""
        return ()

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it sees and acts at."""
        return ()

    def from_now_on(self, t: float) -> dict[str, float]:
        """Return its numbers that change by themselves, as they are from a time on [s]."""
        return {}

    def facts(self) -> dict[str, float]:
        """Return numbers that readers of a result may need, by name."""
        return {}


@dataclass(frozen=True, slots=True, kw_only=True)
class AtPoint(OnLinks):
    """Base of those that act on one link at one point.

    Attributes:
        at: A link, and a point in its frame [m].
    """

    at: Point

    def __post_init__(self) -> None:
        """Check the parameters; the point's numbers become floats."""
        object.__setattr__(self, "at", checked_point(self, "at", self.at))
        ForceElement.__post_init__(self)

    @property
    def places(self) -> tuple[Point, ...]:
        """Its link and point."""
        return (self.at,)
