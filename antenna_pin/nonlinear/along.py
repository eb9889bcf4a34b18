"""Displacements carried along pieces of a step by the stages of the run's own method.

Only what is carried is differentiated, where a propagator (:class:`antenna_pin.integrate.Propagator`) wants
whole matrices; and errors are carried with it: what it is off by is a displacement too.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine import Carrying
from antenna_pin.nonlinear.frames import Lift
from antenna_pin.nonlinear.pieces import GRADE, Piece
from antenna_pin.nonlinear.saltation import Carried

__all__ = ["AlongStages"]

Array = NDArray[np.float64]


class AlongStages:
    """Carries displacements along pieces of a step.

    Args:
        carrying: By what.
        moving: Parts of a displacement that change between events: ways, rates and bristles.

    Attributes:
        made: Pieces along which displacements were carried.
        left: Pieces that were left to whole matrices.
    """

    def __init__(self, carrying: Carrying, moving: slice) -> None:
        """Begin with nothing."""
        self._carrying, self._moving = carrying, moving
        self.made = self.left = 0

    def over(
        self, piece: Piece, start: tuple[float, float, Array], lift: Lift, carried: Carried, good: float
    ) -> Carried | None:
        """Return displacements behind a piece of a step, or None where they are not known well enough.

        Args:
            piece: The piece.
            start: When the step begins [s], its size [s], and the state where the piece begins.
            lift: Coordinates as displacements.
            carried: Displacements before the piece.
            good: What the method may be off by, over a displacement.
        """
        time, whole, y = start
        matrix, off = carried.matrix, carried.other - carried.matrix
        there, behind = (np.flatnonzero(one.any(axis=0)) for one in (matrix, off))
        ways = lift.up @ np.hstack([matrix[:, there], off[:, behind]])
        size = (piece.b - piece.a) * whole
        grade = 1 if piece.graded else -1 if piece.falling else 0
        found = self._carrying.along(time + piece.a * whole, y, size, ways, grade=grade, power=GRADE)
        down, moved = lift.down, lift.down @ found.ways
        count = len(there)
        sizes = np.linalg.norm(moved[:, :count], axis=0)
        if not (found.sizes[0, :count] <= good * sizes).all():
            return None
        self.made += 1
        ends, rests = np.zeros_like(matrix), np.zeros_like(matrix)
        ends[:, there], rests[:, behind] = moved[:, :count], moved[:, count:]
        rests[:, there] += down[:, self._moving] @ (found.errors + found.rough)[:, :count]
        return Carried(ends, ends + rests, carried.frame)
