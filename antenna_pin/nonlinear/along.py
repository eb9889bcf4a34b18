"""Displacements carried along pieces of a step by the stages of the run's own method.

Only what is carried is differentiated, where a propagator (:class:`antenna_pin.integrate.Propagator`) wants
whole matrices; and errors are carried with it: what it is off by is a displacement too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine import Carrying, Steps
from antenna_pin.nonlinear.frames import Frame, Lift
from antenna_pin.nonlinear.instants import Carried
from antenna_pin.nonlinear.pieces import Piece
from antenna_pin.nonlinear.within import Within

__all__ = ["AlongStages", "Step"]

Array = NDArray[np.float64]

# How often at most pieces of a step are tried, those next to a kink as short as it matters, until whole
# matrices are looked at for what breaks there.
_TRIES = 48
# What a step over a kink may be off by, over its estimate, which is made for what is smooth: of order 8(5,3)
# it is no more in nine of ten, wherever between its stages the kink is.
_OVER_KINKS = 13.0


class Step(NamedTuple):
    """A step of a run.

    Attributes:
        time: When it begins [s].
        size: Of it [s].
        y: State where it begins.
        until: When it ends [s].
        end: State there, before what changes then.
        changes: Whether contacts or drives have changed where it begins, and whether they do where it ends.
        known: Whether there is a break that is known at the one and at the other end.
    """

    time: float
    size: float
    y: Array
    until: float
    end: Array
    changes: tuple[bool, bool]
    known: tuple[bool, bool]

    @property
    def piece(self) -> Piece:
        """All of it."""
        return Piece(0.0, 1.0, *self.changes, self.known)


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

    def _since(self, known: bool, time: float) -> float:
        """Return when rates have changed last, of a piece that begins at a time, with a break or not [s]."""
        return time if known else self.since

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
        begin, size = time + piece.a * whole, (piece.b - piece.a) * whole
        # A break that is known at both ends has no piece.
        falling = (piece.falling or piece.known[1]) and not piece.known[0]
        found = self._carrying.along(
            (begin, size, y),
            lift.up @ matrix[:, there],
            lift.up @ off[:, behind],
            until=begin + size if falling else math.inf,
            since=self._since(piece.known[0], begin),
        )
        down, moved = lift.down, lift.down @ found.ways
        count = len(there)
        sizes = np.linalg.norm(moved[:, :count], axis=0)
        if not (found.sizes * [[_OVER_KINKS], [1.0]] <= good * sizes).all():
            return None
        self.made += 1
        ends, rests = np.zeros_like(matrix), np.zeros_like(matrix)
        ends[:, there], rests[:, behind] = moved[:, :count], moved[:, count:]
        rests[:, there] += down[:, self._moving] @ (_OVER_KINKS * found.errors + found.rough)
        books = carried.books.copy()
        books[:, there] += found.books
        return Carried(ends, ends + rests, carried.frame, books)

    def in_halves(
        self,
        piece: Piece,
        within: Within,
        lift: Callable[[Frame, float, Array], Lift],
        carried: Carried,
        good: float,
    ) -> Carried | None:
        """Return displacements behind a piece of a step, along ever shorter halves where need be, or None.

        Args:
            piece: The piece.
            within: States within the step.
            lift: Makes displacements of coordinates about a state: of constraints those where a piece begins.
            carried: Displacements before the piece.
            good: As for :meth:`over`.
        """
        tries = _TRIES

        def along(piece: Piece, carried: Carried) -> Carried | None:
            nonlocal tries
            if all(piece.known) or tries == 0:
                return None
            tries -= 1
            y = within.at(piece.a)
            here = lift(carried.frame, within.time + piece.a * within.size, y)
            found = self.over(piece, (within.time, within.size, y), here, carried, good)
            if found is None and piece.halvings > 0:
                found = carried
                for half in piece.cut(0.5 * (piece.a + piece.b), False):
                    found = None if found is None else along(half, found)
            return found

        return along(piece, carried)

    def over_steps(
        self, steps: Sequence[Step], lift: Lift, carried: Carried, good: float, until: float
    ) -> tuple[int, Carried]:
        """Return along how many steps displacements are known well enough, and these behind them.

        Args:
            steps: One after another, between two changes of the axes.
            lift: Coordinates as displacements, the same along the steps.
            carried: Displacements before them.
            good: As for :meth:`over`.
            until: When a contact ends next, behind them; infinite if that is not known [s].
        """
        matrix, off = carried.matrix, carried.other - carried.matrix
        there = np.flatnonzero((matrix != 0.0).any(axis=0) | (off != 0.0).any(axis=0))
        every = Steps(
            np.array([one.time for one in steps]),
            np.array([one.size for one in steps]),
            np.array([self._since(one.known[0], one.time) for one in steps]),
            np.array([until]),
            np.array([one.y for one in steps]),
        )
        # Each part of a displacement is one coordinate, or none.
        scales = np.abs(lift.down).sum(axis=0)
        before = lift.up @ matrix[:, there], lift.up @ off[:, there]
        done, ways, rest, booked = self._carrying.along_all(every, *before, scales, good)
        self.made += done
        if not done:
            return 0, carried
        ends, rests, books = np.zeros_like(matrix), np.zeros_like(matrix), carried.books.copy()
        ends[:, there], rests[:, there] = lift.down @ ways, lift.down @ rest
        books[:, there] += booked
        return done, Carried(ends, ends + rests, carried.frame, books)
