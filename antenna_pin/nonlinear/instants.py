"""Displacements at equal times, and at the neighbours' own instants: of an onset, of a release.

A displacement w of a state at equal times is ``w + f dt`` at a neighbour's own instant, which is later by dt.
With time as a coordinate beside the others it goes by the same equation, the flow f too. What is integrated
along a run, b' = L, acts on nothing: its displacement is carried beside these and is ``B + L dt`` there.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import Propagated
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame
from antenna_pin.nonlinear.pieces import Piece

__all__ = ["Carried", "at_equal_times", "with_time", "wrong_by"]

Array = NDArray[np.float64]


class Carried(NamedTuple):
    """Displacements carried along a run, in coordinates along axes in the present state.

    Attributes:
        matrix: (size, k).
        other: The same by differences of another order and another rule: what is between tells the doubt.
        frame: The axes.
        books: Displacements of what is integrated along the run, (nx, k).
    """

    matrix: Array
    other: Array
    frame: Frame
    books: Array


def with_time(carried: Carried) -> Carried:
    """Return displacements with time as a coordinate; they are at equal times if it was none."""
    frame = carried.frame
    if frame.clock:
        return carried
    matrix, other = (np.insert(one, 2 * frame.ways, 0.0, axis=0) for one in carried[:2])
    return Carried(matrix, other, frame._replace(clock=True), carried.books)


def at_equal_times(field: Field, carried: Carried, time: float, y: Array) -> Carried:
    """Return displacements at equal times, without time as a coordinate.

    Args:
        field: The rates, with the contacts and the program of the moment.
        carried: Displacements.
        time: When [s].
        y: State.
    """
    if not carried.frame.clock:
        return carried
    frame, up = carried.frame._replace(clock=False), field.lift(carried.frame, time, y).up
    late = up[field.parts[-1].start]
    back = field.lift(frame, time, y).down @ (up - np.outer(field.flow(time, y), late))
    books = carried.books - np.outer(field.booked(time, y), late @ carried.matrix)
    return Carried(back @ carried.matrix, back @ carried.other, frame, books)


def wrong_by(piece: Piece, step: Propagated, carried: Carried, flow: int, opening: Array | None) -> float:
    """Return what a step of a piece is wrong by, over its size [-].

    Next to onsets and releases it is what it does to what is carried, at the neighbours' own.

    Args:
        piece: The part of a step.
        step: What it makes of the identity.
        carried: Displacements before it.
        flow: In which column the flow is, if it is carried.
        opening: At the step's end the derivative of the gap of a contact that ends there over coordinates,
            (size,); None if there is none.
    """
    if not (piece.graded or piece.falling) or not carried.frame.clock:
        return step.off
    ends, wrong = step.matrix @ carried.matrix, (step.matrix - step.other) @ carried.matrix
    if piece.falling and opening is not None:
        late = (opening @ ends) / (opening @ ends[:, flow])
        late[flow] = 0.0
        ends, wrong = (one - np.outer(one[:, flow], late) for one in (ends, wrong))
        ends[:, flow] = 0.0
    sizes = np.linalg.norm(ends, axis=0)
    counts = sizes > 0.0
    return float((np.linalg.norm(wrong, axis=0)[counts] / sizes[counts]).max(initial=0.0))
