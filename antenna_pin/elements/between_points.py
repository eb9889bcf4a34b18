"""What every element between two points is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from antenna_pin.elements.element import LOSS, ForceElement, Integral
from antenna_pin.elements.point import Point, checked_point

__all__ = ["BetweenPoints"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BetweenPoints(ForceElement):
    """Base of the elements that draw points of two links together, or of a link and the world.

    Beside its kernels ``LAYOUT`` and ``stored(words, at, length)``, as those of an element at a joint:

    - ``tension(words, at, length, rate)``: the force that draws the points together [N];
    - ``loss(words, at, rate)``: the power that it takes [W], which its one integral is of.

    Attributes:
        first: A link, or ``world``, and a point in its frame [m].
        second: Another link and a point in its frame [m].
    """

    integrals: ClassVar[tuple[Integral, ...]] = (LOSS,)

    first: Point
    second: Point

    def __post_init__(self) -> None:
        """Check the parameters; the points' numbers become floats."""
        for name in ("first", "second"):
            object.__setattr__(self, name, checked_point(self, name, getattr(self, name)))
        # Said in full: with slots the class is not the one that the method was written in.
        ForceElement.__post_init__(self)

    def check_length(self, place: str, length: float) -> None:
        """Refuse a start in which it has no direction.

        Args:
            place: Its name, for the message.
            length: Distance of the points at the start [m].
        """
