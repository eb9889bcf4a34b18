"""Displacements carried along pieces of a step by the stages of the run's own method.

Only what is carried is differentiated, where a propagator (:class:`antenna_pin.integrate.Propagator`) wants
whole matrices; and errors are carried with it: what it is off by is a displacement too.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine import Carrying
from antenna_pin.nonlinear.frames import Lift
from antenna_pin.nonlinear.instants import Carried
from antenna_pin.nonlinear.pieces import Piece

__all__ = ["AlongStages"]

Array = NDArray[np.float64]

# How near an instant is from which on derivatives go with a root of time: of that to the ends of a step.
_EVEN = 0.9


class AlongStages:
    """Carries displacements along pieces of a step.

    Args:
        carrying: By what.
        moving: Parts of a displacement that change between events: ways, rates and bristles.

    Attributes:
        since: When contacts or drives have changed last [s].
        made: Pieces along which displacements were carried.
    """

    def __init__(self, carrying: Carrying, moving: slice) -> None:
        """Begin with nothing."""
        self._carrying, self._moving = carrying, moving
        self.since = -math.inf
        self.made = 0

    def _grade(self, piece: Piece, time: float, whole: float) -> tuple[int, float]:
        """Return how time goes along a piece of a step from a time [s], of a size [s].

        Behind an onset the derivative of a force that begins like depth^1.5 goes with the root of time since,
        and likewise before a release. At a kink there is no derivative, and differences have some of both
        sides': where time goes with a square from or to there, it has no share.
        """
        if piece.known[0]:
            return 1, 0.0
        if piece.falling or piece.known[1]:
            return -1, 0.0
        gone = max(time + piece.a * whole - self.since, 0.0)
        origin = math.sqrt(gone / (gone + (piece.b - piece.a) * whole)) if gone < math.inf else 1.0
        return (1, origin) if origin < _EVEN else (0, 0.0)

    def over(
        self, piece: Piece, start: tuple[float, float, Array], lift: Lift, carried: Carried, good: float
    ) -> Carried | None:
        """Return displacements behind a piece of a step, or None where they are not known well enough.

        Args:
            piece: The piece.
            start: When the step begins [s], its size [s], and the state where the piece begins.
            lift: Coordinates as displacements.
            carried: Displacements before the piece.
            good: What the method, or differences, may be off by, over a displacement: next to a kink of a
                force the orders of these part.
        """
        time, whole, y = start
        matrix, off = carried.matrix, carried.other - carried.matrix
        there, behind = (np.flatnonzero(one.any(axis=0)) for one in (matrix, off))
        ways = lift.up @ np.hstack([matrix[:, there], off[:, behind]])
        size = (piece.b - piece.a) * whole
        grade, origin = self._grade(piece, time, whole)
        found = self._carrying.along(time + piece.a * whole, y, size, ways, grade=grade, origin=origin)
        down, moved = lift.down, lift.down @ found.ways
        count = len(there)
        sizes = np.linalg.norm(moved[:, :count], axis=0)
        if not (found.sizes[:, :count] <= good * sizes).all():
            return None
        self.made += 1
        ends, rests = np.zeros_like(matrix), np.zeros_like(matrix)
        ends[:, there], rests[:, behind] = moved[:, :count], moved[:, count:]
        rests[:, there] += down[:, self._moving] @ (found.errors + found.rough)[:, :count]
        return Carried(ends, ends + rests, carried.frame)
