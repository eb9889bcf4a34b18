"""A spring and damper between two points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

from antenna_pin.elements.element import LOSS, ForceElement, Integral
from antenna_pin.errors import InvalidParameterError
from antenna_pin.parameters import parameter
from antenna_pin.readable import GIVEN, readable

__all__ = ["Point", "PointSpring"]

Point: TypeAlias = tuple[str, tuple[float, float, float]]
"""A link, or ``world``, and a place in its frame [m]."""


@dataclass(frozen=True, slots=True, kw_only=True)
class PointSpring(ForceElement):
    r"""A linear spring and damper between points of two links, or of a link and the world.

    Along the line between the points, a distance l apart, it draws them together by

    .. math:: F = k (l - l_0) + c \dot l

    With no free length that is the force k d along the way d between the points, smooth through zero.
    Where the points coincide there is no line: the direction is that in which they move apart, the limit of
    passing straight through. A damper's force is continuous there, that of a spring with a free length jumps
    to the other side; where nothing moves, none acts.

    Attributes:
        first: A link, or ``world``, and a point in its frame [m].
        second: Another link and a point in its frame [m].
        free_length: Distance of the points at which the spring is at rest [m].
        stiffness: [N/m].
        damping: [N*s/m].
        on: Whether it acts from the start on; an event may switch it.
    """

    kernels: ClassVar[str] = "point_spring_kernels"
    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)
    one_above_zero: ClassVar[tuple[str, ...]] = ("stiffness", "damping")

    first: Point
    second: Point
    free_length: float = parameter("m", rule="zero or more")
    stiffness: float = parameter("N/m", rule="zero or more", default=0.0)
    damping: float = parameter("N*s/m", rule="zero or more", default=0.0)
    on: bool = True

    def __post_init__(self) -> None:
        """Check the parameters; the points' numbers become floats."""
        for name in ("first", "second"):
            object.__setattr__(self, name, _point(self, name))
        # Said in full: with slots the class is not the one that the method was written in.
        ForceElement.__post_init__(self)

    def words(self, slides: bool = False) -> str:
        """Return what it is in words."""
        said = {"free_length": "free length", "stiffness": "stiffness", "damping": "damping"}
        numbers = ", ".join(
            f"{word} {readable(getattr(self, name), self.unit(name, slides), GIVEN)}"
            for name, word in said.items()
            if getattr(self, name)
        )
        return f"from {self.first[0]} to {self.second[0]}, {numbers}"


def _point(spring: PointSpring, name: str) -> Point:
    given = getattr(spring, name)
    try:
        link, place = given
        x, y, z = map(float, place)
    except (TypeError, ValueError):
        link = None
    if not isinstance(link, str) or not all(map(math.isfinite, (x, y, z))):
        raise InvalidParameterError(spring, name, "a link and three finite numbers [m]", given)
    return link, (x, y, z)
