"""Distances of candidate contacts by coal, each of two shapes of its own."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import coal
import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.native import NOT_TURNED, PLANE_GIVEN, SECOND_TURNED, ShapePair
from antenna_pin.joints.geometry.coal_backend import CoalBackend
from antenna_pin.joints.geometry.coal_kernels import PAIRS, SHAPE_AT
from antenna_pin.joints.geometry.coal_pair_kernels import PAIR, ROW_WORDS

__all__ = ["CoalPairs", "Partners"]


class Partners(NamedTuple):
    """Two shapes of coal whose distance is that of a candidate contact.

    Attributes:
        first: The first shape.
        second: The second shape; of a given plane any half-space.
        turned: ``NOT_TURNED``, ``SECOND_TURNED`` or ``PLANE_GIVEN`` (:mod:`antenna_pin.compiled.native`).
    """

    first: Any
    second: Any
    turned: int = NOT_TURNED


class CoalPairs(CoalBackend):
    """Distances of candidate contacts by coal.

    Args:
        candidates: Those of the joint as the kernels have them, (contacts, CANDIDATE).
        partners: Of each contact the shapes of its one or two queries
            (:func:`antenna_pin.joints.geometry.coal_pair_kernels.pairs_set_out`).
    """

    def __init__(self, candidates: NDArray[np.float64], partners: Sequence[Sequence[Partners]]) -> None:
        """Build functors once."""
        super().__init__(PAIRS, len(candidates), SHAPE_AT + len(candidates) * ROW_WORDS)
        self._candidates = candidates
        self._request = coal.DistanceRequest()
        #: Bit of each query, its shapes, and their functor.
        self._pairs = [
            (2 * k + which, pair, coal.ComputeDistance(pair.first, pair.second))
            for k, row in enumerate(partners)
            for which, pair in enumerate(row)
        ]

    def prepare(self, work: NDArray[np.float64]) -> Sequence[Callable[[], None]]:
        """Write the candidates into an array; return the queries in Python, bit by bit."""
        end = SHAPE_AT + self._candidates.size
        work[SHAPE_AT:end] = self._candidates.ravel()
        self._numbers = work[end : self.words].view(PAIR)
        questions: list[Callable[[], None]] = [lambda: None] * (2 * self._contacts)
        for bit, pair, functor in self._pairs:
            questions[bit] = self._question(self._numbers[bit // 2], pair, functor)
        return questions

    def pairs(self) -> Sequence[ShapePair]:
        """Return the pairs of shapes, as machine code evaluates them."""
        numbers = self._numbers
        return [
            ShapePair(
                functor=functor,
                request=self._request,
                asked=self._asked,
                bit=bit,
                distance=numbers["gap"][bit // 2 : bit // 2 + 1],
                normal=numbers["normal"][bit // 2],
                point=numbers["point"][bit // 2],
                first=numbers["first"][bit // 2],
                second=numbers["second"][bit // 2],
                turned=pair.turned,
                turn=None if pair.turned == NOT_TURNED else numbers["turn"][bit // 2],
                plane=pair.second if pair.turned == PLANE_GIVEN else None,
                shapes=pair,
            )
            for bit, pair, functor in self._pairs
        ]

    def _question(self, numbers: Any, pair: Partners, functor: Any) -> Callable[[], None]:
        """Return a query of coal in Python."""
        at_first, at_second = coal.Transform3s(), coal.Transform3s()
        request, result = self._request, coal.DistanceResult()
        first, second, turn = numbers["first"], numbers["second"], numbers["turn"]

        def ask() -> None:
            measure = functor
            at_first.setTranslation(first)
            at_second.setTranslation(second)
            if pair.turned == SECOND_TURNED:
                at_second.setRotation(turn)
            elif pair.turned == PLANE_GIVEN:
                plane = coal.Halfspace(turn[0].copy(), float(turn[1, 0]))
                measure = coal.ComputeDistance(pair.first, plane)
            result.clear()
            numbers["gap"] = measure(at_first, at_second, request, result)
            numbers["normal"] = result.normal
            numbers["point"] = result.getNearestPoint1()

        return ask
