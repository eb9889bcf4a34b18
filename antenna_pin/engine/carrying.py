"""Propagation of tangents along steps of a run, by the run's own method."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.engine.carry_kernels import CarryRoom, carry_along
from antenna_pin.engine.chain_kernels import ChainRoom, carry_chain
from antenna_pin.engine.compiled import CompiledStepper
from antenna_pin.engine.tangents import Tangents
from antenna_pin.integrate.kernels import STATE

__all__ = ["Along", "Carrying", "Steps", "third_order"]

Array = NDArray[np.float64]


class Along(NamedTuple):
    """Map of tangents over a step.

    Attributes:
        ways: Tangents at the end, (displacement, k), their errors behind them.
        errors: Errors of the method in the step, (moving, few): displacements, rates and bristles.
        rough: Errors of differences, likewise.
        sizes: Sizes of the two, in units, (2, few).
        books: Tangents of the integrals along the run over the step, (nx, few).
    """

    ways: Array
    errors: Array
    rough: Array
    sizes: Array
    books: Array


class Steps(NamedTuple):
    """Consecutive steps.

    Attributes:
        times: Begins, (steps,) [s].
        sizes: Sizes, (steps,) [s].
        since: Times of the last change of contacts, drives or rates, (steps,) [s].
        until: Time of the next change, (1,) [s].
        states: States at the begins, (steps, size).
    """

    times: Array
    sizes: Array
    since: Array
    until: Array
    states: Array


class Carrying:
    """Propagation of tangents along steps, by the stages of the run's method.

    Args:
        stepper: Stepper with rates and method; its contact memory and program are the present ones.
        tangents: Derivatives of these rates.
        coarse: Largest step of differences of each part of a tangent.
    """

    def __init__(self, stepper: CompiledStepper, tangents: Tangents, coarse: Array) -> None:
        """Begin without buffers, which depend on the number of tangents."""
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
        """Propagate tangents and their errors along a step.

        Args:
            start: Begin [s] and size [s] of the step, and the state there.
            ways: Tangents at the begin, (displacement, few).
            off: Errors of some tangents, (displacement, k - few).
            until: Time of the next change of contacts, drives or rates [s].
            since: Time of the last such change [s].
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
        """Propagate tangents and their errors along consecutive steps.

        Args:
            steps: Steps.
            ways: Tangents before the first, (displacement, k).
            off: Their errors, likewise.
            scales: Scales of the coordinates of a tangent, for comparisons of sizes.
            good: Permitted error of the method, or of differences, in a step, over a tangent.

        Returns:
            Number of steps, up to too large an error or a touching contact without force at a step's end;
            tangents after these steps and their errors; tangents of the integrals along the run, (nx, k).
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
        """Return the buffers of ``count`` tangents, ``few`` without their errors.

        With ``every`` the errors are propagated by all stages.
        """
        room = self._rooms.get((count, few, every))
        if room is None or room.tangent is not self._tangents.room:
            room = self._rooms[count, few, every] = self._made(count, few, every)
        return room

    def _made(self, count: int, few: int, every: bool) -> CarryRoom:
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
    """Return weights of a third-order method by three stages of a method, and their flags.

    With nodes 0, c and d the weights of the step are those of the quadrature; the weight of d's stage on c's
    follows from the conditions of third order (Hairer, Norsett and Wanner 1993, II.1).

    Args:
        nodes: Nodes of the stages, (stages,).
        last: Stage at the end of the step.
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
