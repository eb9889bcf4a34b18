"""Parts of a step over which displacements are carried at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

__all__ = ["HALVINGS", "Piece", "at_once"]

Array = NDArray[np.float64]

# How often a step is halved; and the power of what is integrated over that time goes with next to where a
# contact begins or ends.
HALVINGS, _GRADE = 30, 4
# In parts of a step, and in units of the last place of its time, what counts as the same instant.
_AT_ONCE, _ULPS = 1e-12, 4.0


class Piece(NamedTuple):
    """A part of a step, which runs from 0 to 1.

    Attributes:
        a: Where it begins.
        b: Where it ends.
        graded: Whether the step begins where contacts or drives have changed.
        falling: Whether it ends there.
        known: Whether its first and its last end are breaks that are known.
        halvings: How often it may be cut yet.
    """

    a: float
    b: float
    graded: bool = False
    falling: bool = False
    known: tuple[bool, bool] = (False, False)
    halvings: int = HALVINGS

    def at(self, places: Array) -> tuple[Array, Array]:
        """Return fractions of the step and their slopes over places from 0 to 1.

        Behind an onset the derivative of a force that begins like depth^1.5 goes with the root of time, and
        likewise before a release: there time goes with a power of what is integrated over.
        """
        size = self.b - self.a
        if self.graded:
            return self.a + size * places**_GRADE, _GRADE * places ** (_GRADE - 1)
        if self.falling:
            rest = 1.0 - places
            return self.b - size * rest**_GRADE, _GRADE * rest ** (_GRADE - 1)
        return self.a + size * places, np.ones(len(places))

    def cut(self, at: float, known: bool) -> tuple[Piece, Piece]:
        """Return it in two, cut at a fraction of the step, which may be a break that is known."""
        first, last = self.known
        less = self.halvings - 1
        return (
            self._replace(b=at, falling=False, known=(first, known), halvings=less),
            self._replace(a=at, graded=False, known=(known, last), halvings=less),
        )


def at_once(time: float, size: float) -> float:
    """Return what part of a step counts as one instant.

    Args:
        time: When it begins [s].
        size: How long it is [s].
    """
    return max(_AT_ONCE, _ULPS * float(np.spacing(time)) / size)
