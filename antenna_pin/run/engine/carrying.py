"""Displacements of a state carried along steps of a run, by the run's own method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate.kernels import STATE
from antenna_pin.run.engine.carry_kernels import CarryRoom, carry_along
from antenna_pin.run.engine.chain_kernels import ChainRoom, carry_chain
from antenna_pin.run.engine.compiled import CompiledStepper
from antenna_pin.run.engine.tangents import Tangents

__all__ = ["Along", "Carrying", "Steps", "third_order"]

Array = NDArray[np.float64]


class Along(NamedTuple):
    """Map of tangents over a step.

    Attributes:
        ways: At its end, (displacement, k), with what they are off by behind them.
        errors: By how much these are off by the method in the step, (moving, few): ways, rates and bristles.
        rough: By how much by differences, likewise.
        sizes: Of the two, in units, (2, few).
        books: How what is integrated along the run is displaced by the step, (nx, few).
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
        since: When contacts, drives or rates have changed last, (steps,) [s].
        until: When they change next, (1,) [s].
        states: Where they begin, (steps, size).
    """

    times: Array
    sizes: Array
    since: Array
    until: Array
    states: Array


class Carrying:
    """Propagation of tangents along steps by the stages of the run's method.

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
        self._rooms: dict[tuple[int, int, bool], CarryRoom] = {}

    @staticmethod
    def takes(stepper: CompiledStepper) -> bool:
        """Return whether tangents of a stepper's method are propagated stage by stage."""
        return stepper.newton is None and stepper.method.adaptive

    def along(
        self,
        start: tuple[float, float, Array],
        ways: Array,
        off: Array,
        *,
        until: float,
        since: float,
    ) -> Along:
        """Carry displacements, and what they are off by, along a step.

        Args:
            start: When it begins [s], its size [s], and the state there.
            ways: Displacements there, (displacement, few).
            off: What some are off by, (displacement, k - few).
            until: When contacts, drives or rates change next [s].
            since: When they have changed last [s].
        """
        time, size, y = start
        few = ways.shape[1]
        room = self._room(few + off.shape[1], few, True)
        room.work[self._stepper.method.stages + STATE][: len(y)] = y
        room.ways[:few], room.ways[few:] = ways.T, off.T
        carry_along(time, size, until, since, room)
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
        room, full = (self._room(2 * count, count, every) for every in (False, True))
        room.ways[:count], room.ways[count:] = ways.T, off.T
        booked, books = np.zeros_like(room.books), np.zeros_like(room.books)
        chain = ChainRoom(room, full, *steps, scales, np.zeros_like(room.ways), booked, books)
        done = carry_chain(good, chain)
        self._stepper.answers.check()
        return int(done), room.ways[:count].T.copy(), room.ways[count:].T.copy(), books.T

    def _room(self, count: int, few: int, every: bool) -> CarryRoom:
        """Return what displacements, some of which are what others are off by, are carried with.

        Of ``count`` tangents the first ``few`` are tangents, the others errors, by all stages if ``every``.
        """
        room = self._rooms.get((count, few, every))
        if room is None or room.tangent is not self._tangents.room:
            room = self._rooms[count, few, every] = self._allocate(count, few, every)
        return room

    def _allocate(self, count: int, few: int, every: bool) -> CarryRoom:
        manifold, tableau, size = self._stepper.manifold, self._stepper.tableau, len(self._coarse)
        tangent = self._tangents.room
        moving, rates = 2 * manifold.nv + len(tangent.bristles), manifold.nv + manifold.nx
        rests, asked = (tableau.weights, np.ones(len(tableau.nodes), dtype=np.int64))
        if not every:
            rests, asked = third_order(tableau.nodes, tableau.last)
        return CarryRoom(
            tangent=tangent,
            tableau=tableau,
            work=self._work,
            ways=np.zeros((count, size)),
            now=np.zeros((count, size)),
            slopes=np.zeros((len(tableau.nodes), count, moving)),
            coarse=self._coarse,
            steps=np.zeros(count),
            rests=rests,
            asked=asked,
            few=np.zeros((few, size)),
            few_steps=np.zeros(few),
            few_both=np.zeros((2, few, rates)),
            books=np.zeros((few, manifold.nx)),
            bracket=np.zeros(manifold.nv),
            both=np.zeros((2, count, rates)),
            errors=np.zeros((few, moving)),
            rough=np.zeros((few, moving)),
            sizes=np.zeros((2, few)),
        )


def third_order(nodes: Array, last: int) -> tuple[Array, NDArray[np.int64]]:
    """Return the weights and stages of an embedded third-order method.

    With nodes 0, c and d: weights of the step are those of the quadrature, and d's stage is from c's by what
    is left of the conditions of third order (Hairer, Norsett and Wanner 1993, II.1).
    """
    weights, asked = np.zeros((len(nodes), len(nodes))), np.zeros(len(nodes), dtype=np.int64)
    inner = [i for i in range(1, last) if 0.0 < nodes[i] < 1.0]
    one = min(inner, key=lambda i: abs(float(nodes[i]) - 1.0 / 3.0))
    behind = [i for i in inner if i > one and nodes[i] > nodes[one]]
    other = min(behind, key=lambda i: abs(float(nodes[i]) - 2.0 / 3.0))
    c, d = float(nodes[one]), float(nodes[other])
    of_other = (1.0 / 3.0 - 0.5 * c) / (d * (d - c))
    of_one = (0.5 - of_other * d) / c
    from_one = 1.0 / (6.0 * of_other * c)
    asked[[0, one, other]] = 1
    weights[one, 0] = c
    weights[other, [0, one]] = d - from_one, from_one
    weights[last, [0, one, other]] = 1.0 - of_one - of_other, of_one, of_other
    return weights, asked
