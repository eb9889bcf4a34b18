"""Displacements of a state carried along steps of a run, by the run's own method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine.carry_kernels import CarryRoom, carry_along
from antenna_pin.engine.compiled import CompiledStepper
from antenna_pin.engine.tangents import Tangents
from antenna_pin.integrate.kernels import STATE

__all__ = ["Along", "Carrying"]

Array = NDArray[np.float64]


class Along(NamedTuple):
    """What a step makes of displacements.

    Attributes:
        ways: At its end, (displacement, k).
        errors: By how much these are off by the method, (moving, k): ways, rates and bristles.
        rough: By how much by differences, likewise.
        sizes: Of the two, in units, (2, k).
    """

    ways: Array
    errors: Array
    rough: Array
    sizes: Array


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
        count = ways.shape[1]
        room = self._rooms.get(count)
        if room is None or room.tangent is not self._tangents.room:
            room = self._rooms[count] = self._made(count)
        work = room.work[self._stepper.method.stages + STATE]
        work[: len(y)] = y
        room.ways[:] = ways.T
        carry_along(time, h, grade, origin, room)
        self._stepper.answers.check()
        return Along(room.now.T.copy(), room.errors.T, room.rough.T, room.sizes)

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
            bracket=np.zeros(manifold.nv),
            both=np.zeros((2, count, rates)),
            errors=np.zeros((count, moving)),
            rough=np.zeros((count, moving)),
            sizes=np.zeros((2, count)),
        )
