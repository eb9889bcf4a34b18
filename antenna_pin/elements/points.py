"""Points on links, and elements between two of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, TypeAlias

from antenna_pin.elements.element import LOSS, ForceElement, Integral
from antenna_pin.errors import InvalidParameterError

# --- points on links ----------------------------------------------------------------------------------------

Point: TypeAlias = tuple[str, tuple[float, float, float]]
"""A link, or ``world``, and a place in its frame [m]."""


def checked_point(element: ForceElement, name: str, pair: Any) -> Point:
    """Return a link and a point on it with floats, or refuse what is none."""
    link: object = None
    try:
        link, place = pair
        x, y, z = map(float, place)
    except (TypeError, ValueError):
        link = None
    if not isinstance(link, str) or not all(map(math.isfinite, (x, y, z))):
        raise InvalidParameterError(element, name, "a link and three finite numbers [m]", pair)
    return link, (x, y, z)


# --- elements between two points ----------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, kw_only=True)
class BetweenPoints(ForceElement):
    """Base of the elements that draw two points of links together.

    Its kernels are ``stored`` of the length, as of an element at a joint, and

    - ``tension``: the force that draws the points together [N];
    - ``loss``: the power that it takes [W], which its one integral is of.

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
