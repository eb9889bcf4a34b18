"""A place on a link, as elements take it."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from antenna_pin.elements.element import ForceElement
from antenna_pin.errors import InvalidParameterError

__all__ = ["Point", "checked_point"]

Point: TypeAlias = tuple[str, tuple[float, float, float]]
"""A link, or ``world``, and a place in its frame [m]."""


def checked_point(element: ForceElement, name: str, given: Any) -> Point:
    """Return a link and a point on it with floats, or refuse what is none."""
    link: object = None
    try:
        link, place = given
        x, y, z = map(float, place)
    except (TypeError, ValueError):
        link = None
    if not isinstance(link, str) or not all(map(math.isfinite, (x, y, z))):
        raise InvalidParameterError(element, name, "a link and three finite numbers [m]", given)
    return link, (x, y, z)
