"""Displacements of a state carried along steps of a run, by the run's own method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine.carry_kernels import CarryRoom, ChainRoom, carry_along, carry_chain
from antenna_pin.engine.compiled import CompiledStepper
from antenna_pin.engine.tangents import Tangents
from antenna_pin.integrate.kernels import STATE

__all__ = ["Along", "Carrying", "Steps"]

Array = NDArray[np.float64]


class Along(NamedTuple):
    """What a step makes of displacements.

    Attributes:
        ways: At its end, (displacement, k).
        errors: By how much these are off by the method, (moving, k): ways, rates and bristles.
        rough: By how much by differences, likewise.
        sizes: Of the two, in units, (2, k).
        books: How what is integrated along the run is displaced by the step, (nx, k).
    """

    ways: Array
    errors: Array
    rough: Array
    sizes: Array
    books: Array


class Steps(NamedTuple):
    """Steps one after another.

    Attributes:
        times: When they begin, (steps,) [s].
        sizes: Of them, (steps,) [s].
        grades: How time goes in each, as :meth:`Carrying.along` has it, (steps,).
        origins: Likewise, (steps,).
        states: Where they begin, (steps, size).
    """

    times: Array
    sizes: Array
    grades: NDArray[np.int64]
    origins: Array
    states: Array


class Carrying:
    """Carries displacements along steps by the stages of the method that a run is made with.

    Args:
        stepper: Whose rates they go by, and whose method; its contact memory and program are those of the
            moment.
        tangents: Derivatives of these rates.
        coarse: Over what a step of differences of each part of a displacement must be one at most.
    """

    def __init__(self, stepper: CompiledStepper, tangents: Tangents, coarse: Array) -> None:
        """Allocate nothing: how many displacements there are shows when they come."""
        self._stepper, self._tangents, self._coarse = stepper, tangents, coarse
        self._work = np.zeros_like(stepper.work)
        self._rooms: dict[int, CarryRoom] = {}

    @staticmethod
    def takes(stepper: CompiledStepper) -> bool:
        """Whether a stepper's method is one of which displacements go by the stages."""
        return stepper.newton is None and stepper.method.adaptive

    def along(
        self, time: float, y: Array, h: float, ways: Array, *, grade: int = 0, origin: float = 0.0
    ) -> Along:
        """Carry displacements along a step.

        Args:
            time: Where it begins [s].
            y: State there.
            h: Its size [s].
            ways: Displacements there, (displacement, k).
            grade: Whether time goes with the square of what is integrated over, from an instant before the
                start on, 1, or back from one behind the end, -1; or evenly, 0.
            origin: Where that instant is: the root of the time from there to the nearer end of the step over
                that to the other, [0, 1).
        """
        room = self._room(ways.shape[1])
        work = room.work[self._stepper.method.stages + STATE]
        work[: len(y)] = y
        room.ways[:] = ways.T
        carry_along(time, h, grade, origin, room)
        self._stepper.answers.check()
        return Along(room.now.T.copy(), room.errors.T, room.rough.T, room.sizes, room.books.T)

    def along_all(
        self, steps: Steps, ways: Array, off: Array, scales: Array, good: float
    ) -> tuple[int, Array, Array, Array]:
        """Carry displacements, and what they are off by, along steps one after another.

        Args:
            steps: The steps.
            ways: Displacements before the first, (displacement, k).
            off: What they are off by, likewise.
            scales: Of the parts of a displacement in coordinates, in which sizes are compared.
            good: What the method, or differences, may be off by in a step, over a displacement.

        Returns:
            Along how many, up to one in which they are not known well enough or at whose end a contact that
            touches has no force; displacements behind these and what they are off by; how what is integrated
            along the run is displaced by them, (nx, k).
        """
        count = ways.shape[1]
        room = self._room(2 * count)
        room.ways[:count], room.ways[count:] = ways.T, off.T
        books = np.zeros((count, room.books.shape[1]))
        done = carry_chain(good, ChainRoom(room, *steps, scales, books))
        self._stepper.answers.check()
        return int(done), room.ways[:count].T.copy(), room.ways[count:].T.copy(), books.T

    def _room(self, count: int) -> CarryRoom:
        """Return what so many displacements are carried with."""
        room = self._rooms.get(count)
        if room is None or room.tangent is not self._tangents.room:
            room = self._rooms[count] = self._made(count)
        return room

    def _made(self, count: int) -> CarryRoom:
        manifold, stages = self._stepper.manifold, self._stepper.method.stages
        tangent = self._tangents.room
        moving, rates = 2 * manifold.nv + len(tangent.bristles), manifold.nv + manifold.nx
        return CarryRoom(
            tangent=tangent,
            tableau=self._stepper.tableau,
            work=self._work,
            ways=np.zeros((count, len(self._coarse))),
            now=np.zeros((count, len(self._coarse))),
            slopes=np.zeros((stages, count, moving)),
            coarse=self._coarse,
            steps=np.zeros(count),
            books=np.zeros((count, manifold.nx)),
            bracket=np.zeros(manifold.nv),
            both=np.zeros((2, count, rates)),
            errors=np.zeros((count, moving)),
            rough=np.zeros((count, moving)),
            sizes=np.zeros((2, count)),
        )
