"""Displacements carried over parts of a step by whole matrices, cut where rates break."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate import NODES, Propagator
from antenna_pin.nonlinear.breaks import BETWEEN, left_over
from antenna_pin.nonlinear.field import Field
from antenna_pin.nonlinear.frames import Frame
from antenna_pin.nonlinear.instants import Carried, wrong_by
from antenna_pin.nonlinear.missed import Kink, Missed, StepAnew
from antenna_pin.nonlinear.pieces import HALVINGS, Piece
from antenna_pin.nonlinear.within import Within, kink_in

__all__ = ["ByMatrices"]

Array = NDArray[np.float64]

# How often a step is halved to find where it breaks: what is wrong then is in the doubt.
_SEARCHES = 8
# In how many steps the round-off of rates is looked at once, where nothing changes.
_LOOKS = 8
# How often round-off may be what a piece's derivatives are off by.
_NOISY = 30.0


class ByMatrices:
    """Carries displacements over parts of a step as short as they must be.

    Args:
        field: The rates.
        within: States within the step.
        again: Makes it anew, cut at kinks.
        missed: Counts what displacements miss of these.
        good: What a part may be wrong by, over the displacements.

    Attributes:
        made: Parts over which displacements were carried.
        left_over: What is wrong by breaks that were not found, over the displacements.
        opening: At the step's end the derivative of the gap of a contact that ends there over coordinates,
            (size,); None if there is none.
    """

    def __init__(self, field: Field, within: Within, again: StepAnew, missed: Missed, good: float) -> None:
        """Begin with nothing."""
        self._field, self._within, self._again, self._missed = field, within, again, missed
        self._good, self.made, self.left_over = good, 0, 0.0
        self.opening: Array | None = None
        self._looked_at = self._steps = 0
        self._unseen: tuple[float, Array] | None = None
        self._way: tuple[Frame, Array, Array] | None = None
        self._propagator = Propagator(0)

    def begin(self, time: float, y: Array, anew: bool) -> None:
        """Begin a step in a state.

        Args:
            time: When [s].
            y: State.
            anew: Whether the round-off of rates may be another than it was.
        """
        self._steps += 1
        if anew or self._steps > self._looked_at + _LOOKS:
            self._unseen = time, y

    def _along(self, frame: Frame) -> tuple[Array, Array]:
        """Return the displacement along which breaks are looked for, some of every state, and its parts."""
        if self._way is None or self._way[0] is not frame:
            within = self._within
            up = self._field.lift(frame, within.time, within.at(0.0)).up
            some = np.asarray(np.random.default_rng(0).standard_normal(up.shape[1]))
            *_, numbers, _, clock = self._field.parts
            some[up[numbers].any(axis=0) | up[clock].any(axis=0)] = 0.0  # what breaks does so in states
            unit = np.asarray(some / np.linalg.norm(some))
            self._way = frame, up @ unit, unit
        return self._way[1:]

    def over(self, piece: Piece, carried: Carried) -> Carried:
        """Return displacements behind a part of the step."""
        self.made += 1
        frame, (way, unit) = carried.frame, self._along(carried.frame)
        if self._unseen is not None:
            self._field.look_at(*self._unseen, way)
            self._unseen, self._looked_at = None, self._steps
        field, within, at = self._field, self._within, self._within.at
        start, whole = within.time, within.size
        length = (piece.b - piece.a) * whole
        thetas, slopes = piece.at(NODES)
        found = [field.matrix(frame, start + s * whole, at(s), way) for s in thetas.tolist()]
        sixth, fourth, books = (
            np.array([one * s for one, s in zip(each, slopes, strict=True)])
            for each in ([f.sixth for f in found], [f.fourth for f in found], [f.books for f in found])
        )
        if self._propagator.size != sixth.shape[1]:
            self._propagator = Propagator(sixth.shape[1])
        step = self._propagator.step(length, sixth)
        # What breaks at a place between the nodes, or behind the last, neither method sees.
        seen = [(f.along * s, f.noise * s) for f, s in zip(found, slopes.tolist(), strict=True)]
        for s, slope in zip(*(one.tolist() for one in piece.at(BETWEEN)), strict=True):
            value, noise = field.along_way(start + s * whole, at(s), way)
            seen.append((value * slope, noise * slope))
        rest, (low, high) = left_over(np.array([value for value, _ in seen]), piece.known)
        noise = _NOISY * length * max(one for _, one in seen)
        off = length * rest if length * rest <= self._good else max(length * rest - noise, 0.0)
        found_break = None
        if off > self._good:
            by = field, frame, way, unit
            found_break = kink_in(piece, (low, high), seen, within, by)
        searching = off > self._good and piece.halvings > HALVINGS - _SEARCHES
        rough = not wrong_by(piece, step, carried, self._missed.flow, self.opening) <= self._good
        if piece.halvings > 0 and (found_break is not None or searching or rough):
            cut = 0.5 * (piece.a + piece.b) if found_break is None else found_break[0]
            before, behind = piece.cut(cut, found_break is not None)
            carried = self.over(before, carried)
            if found_break is not None:
                carried = self._pass(*found_break, carried)
            return self.over(behind, carried)
        self.left_over += off
        other = step.other + self._propagator.change(length, fourth - sixth)
        booked = carried.books + self._propagator.integral(length, books) @ carried.matrix
        return Carried(step.matrix @ carried.matrix, other @ carried.other, frame, booked)

    def _pass(self, theta: float, kink: Kink, carried: Carried) -> Carried:
        """Count what displacements miss of a kink at a fraction of the step."""
        time, y = self._within.time + theta * self._within.size, self._within.at(theta)
        self._again.to(time)
        down = self._field.lift(carried.frame, time, y).down
        error = self._missed.error(carried) + down @ self._again.off(time, y)
        return self._missed.passed(kink, error, carried)
