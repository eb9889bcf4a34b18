"""Base of the backends by coal: queries in an array of numbers."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from antenna_pin.compiled.native import Evaluator, ShapePair, native_shim
from antenna_pin.errors import FunctionError
from antenna_pin.joints.geometry import coal_query_kernels as queries
from antenna_pin.joints.geometry.coal_kernels import MOST_QUERIES, QUERY, SHAPE_AT

_RULE = "a distance of the shapes of each contact"


class CoalBackend:
    """Distances of a joint by coal.

    Queries and results are in one array of numbers, so that compiled code can write the queries, have coal
    evaluate them and read the results.

    Attributes:
        words: Size of that array.
        evaluator: Machine code that evaluates the queries; None where Python does.
    """

    evaluator: Evaluator | None

    def __init__(self, kind: int, contacts: int, words: int) -> None:
        """Store the number of the kind of queries, and sizes."""
        self.words = words
        self._kind, self._contacts = kind, contacts
        self._all = (1.0,) * contacts
        self._work: NDArray[np.float64] | None = None

    @property
    def work(self) -> NDArray[np.float64]:
        """Array of queries and results, (words,)."""
        if self._work is None:
            self.take(np.zeros(self.words))
        assert self._work is not None
        return self._work

    def take(self, work: NDArray[np.float64]) -> None:
        """Use an array for queries and results from now on, (words,)."""
        self._work = work
        query = work[:SHAPE_AT].view(QUERY)
        query["kind"], query["rows"] = self._kind, self._contacts
        self._asked: NDArray[np.int64] = query["asked"]
        self._questions = self.prepare(work)
        shim = native_shim()
        self.evaluator = None if shim is None else shim.pairs(self.pairs())
        query["answer"], query["pairs"] = 0, 0
        if shim is not None and self.evaluator is not None:
            query["answer"], query["pairs"] = shim.distances, self.evaluator.address

    def prepare(self, work: NDArray[np.float64]) -> Sequence[Callable[[], None]]:
        """Write constants into an array; return the queries in Python, bit by bit."""
        raise NotImplementedError

    def pairs(self) -> Sequence[ShapePair]:
        """Return the pairs of shapes, as machine code evaluates them."""
        raise NotImplementedError

    def query(
        self, pose: NDArray[Any], table: NDArray[Any], row: int, wanted: Sequence[float] | None = None
    ) -> None:
        """Fill the joint's rows (see :class:`antenna_pin.joints.geometry.Distances`).

        Raises:
            FunctionError: coal raises an exception in machine code.
        """
        bits = sum(1 << k for k, one in enumerate(self._all if wanted is None else wanted) if one)
        if bits == 0:
            return
        work = self.work
        if self.evaluator is not None:
            if queries.query_coal(work, pose, table, row, bits):
                raise self.failure
            return
        queries.set_out_queries(work, pose, table, row, bits)
        for _ in range(MOST_QUERIES):
            self.answer()
            if queries.take_in_queries(work, pose, table, row):
                break

    def answer(self) -> None:
        """Evaluate the queries of ``work`` by coal in Python, and write the results there."""
        asked = self._asked.item()
        for k, question in enumerate(self._questions):
            if asked >> k & 1:
                question()

    @property
    def failed(self) -> bool:
        """Return whether coal has raised an exception in machine code."""
        return self.evaluator is not None and bool(self.evaluator.error)

    @property
    def failure(self) -> FunctionError:
        """Exception of coal in machine code, as an error."""
        assert self.evaluator is not None
        return FunctionError("coal", "a pose of a joint with play", _RULE, self.evaluator.error)
