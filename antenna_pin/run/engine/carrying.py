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

Array = NDArray[np.float64]


class Along(NamedTuple):
    """Map of tangents over a step.

    Attributes:
        ways: Tangents at the end, (displacement, k), followed by their errors.
        errors: Errors by the method in the step, (moving, few): displacements, rates and bristles.
        rough: Errors by differences, likewise.
        sizes: Sizes of both, in units, (2, few).
        books: Change of the integrated numbers of the run in the step, (nx, few).
    """

    ways: Array
    errors: Array
    rough: Array
    sizes: Array
    books: Array


class Steps(NamedTuple):
    """Consecutive steps.

    Attributes:
        times: Starts, (steps,) [s].
        sizes: Step sizes, (steps,) [s].
        since: Times of the last change of contacts, drives or rates, (steps,) [s].
        until: Time of the next change, (1,) [s].
        states: States at the starts, (steps, size).
    """

    times: Array
    sizes: Array
    since: Array
    until: Array
    states: Array


class Carrying:
    """Propagation of tangents along steps by the stages of the run's method.

    Args:
        stepper: Stepper with rates and method, at its present contact memory and program.
        tangents: Derivatives of these rates.
        coarse: Inverse upper bounds of a step of differences, for each part of a displacement.
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
        """Propagate tangents and their errors along a step.

        Args:
            start: Start [s], step size [s], and state there.
            ways: Tangents there, (displacement, few).
            off: Errors of some, (displacement, k - few).
            until: Time of the next change of contacts, drives or rates [s].
            since: Time of their last change [s].
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
            steps: The steps.
            ways: Tangents before the first, (displacement, k).
            off: Their errors, likewise.
            scales: Scales of the parts of a displacement in coordinates, in which sizes are compared.
            good: Permitted error of the method, or of differences, in a step, relative to a tangent.

        Returns:
            Number of steps, up to one with too large an error or at whose end a touching contact has no
            force; tangents after these and their errors; change of the integrated numbers of the run, (nx,
            k).
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
        """Return the arrays for propagation of tangents and errors.

        Of ``count`` rows the first ``few`` are tangents, the others errors, with all stages if ``every``.
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

    With nodes 0, c and d: weights of the step are those of the quadrature, and the stage at d uses that at c
    by the remaining condition of third order (Hairer, Norsett and Wanner 1993, II.1).
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
