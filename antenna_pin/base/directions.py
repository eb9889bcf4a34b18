"""Directions: three numbers with arbitrary length, made unit vectors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from antenna_pin.base.rules import A_DIRECTION
from antenna_pin.base.units import shown
from antenna_pin.errors import InvalidParameterError

__all__ = ["A_DIRECTION", "direction", "unit"]


def unit(vector: ArrayLike) -> NDArray[np.float64]:
    """Return the unit vector along a finite, nonzero vector, (n,) [-].

    It is divided by its largest entry first, so that no square overflows or underflows.
    """
    given = np.asarray(vector, dtype=np.float64)
    given = given / np.abs(given).max()
    return np.asarray(given / np.linalg.norm(given))


def direction(value: ArrayLike, place: object, name: str) -> NDArray[np.float64]:
    """Return the unit vector along a direction, (3,) [-], or refuse what is none.

    Args:
        value: Of any length [-].
        place: Whose it is, an object or the name of a place, for the message.
        name: Its name.

    Raises:
        InvalidParameterError: It is zero, or not finite, or not three numbers.
    """
    try:
        vector = np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError, OverflowError):
        vector = np.zeros(0)
    if vector.shape != (3,) or not np.isfinite(vector).all() or not vector.any():
        raise InvalidParameterError(place, name, A_DIRECTION, said=shown(value))
    return unit(vector)
