"""Linear differential equations with variable matrices: collocation steps and their errors."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.integrate.linear_kernels import propagate

Array = NDArray[np.float64]

_GAUSS = 0.5 + 0.5 * np.polynomial.legendre.leggauss(4)[0]
#: Where in a step the matrix is asked for: at Gauss's four nodes, and next to its end, where it may jump.
NODES: Array = np.append(_GAUSS, 1.0 - 1e-6)


class Propagated(NamedTuple):
    """Map of the identity over a step.

    Attributes:
        matrix: By collocation at Gauss's four nodes, of order 8, (n, n).
        other: By collocation at these and next to the end.
    """

    matrix: Array
    other: Array

    @property
    def off(self) -> float:
        """By how much the two differ, over their size; zero where nothing is carried [-]."""
        if not self.matrix.size:
            return 0.0
        return float(np.linalg.norm(self.matrix - self.other) / np.linalg.norm(self.matrix))


def _weights(nodes: Array) -> tuple[Array, Array]:
    """Return the stage and step weights of the collocation method with given nodes."""
    powers = np.arange(1, len(nodes) + 1)
    inverse = np.linalg.inv(nodes[:, None] ** (powers - 1))
    return (nodes[:, None] ** powers / powers) @ inverse, (1.0 / powers) @ inverse


_METHODS = _weights(_GAUSS), _weights(NODES)


class Propagator:
    """Steps of ``W' = A W`` by collocation (Hairer, Norsett and Wanner 1993, II.7).

    Args:
        size: n.

    Attributes:
        size: n.
    """

    def __init__(self, size: int) -> None:
        """Allocate once."""
        self.size, most = size, len(NODES) * size
        self._whole, self._pivots = np.zeros((most, most)), np.zeros(most, dtype=np.int64)
        self._rates, self._out = np.zeros((size, most)), np.zeros((size, size))

    def step(self, length: float, matrices: Array) -> Propagated:
        """Return what a step makes of the identity; not numbers, if there is no such.

        Args:
            length: Of the step.
            matrices: A at :data:`NODES`, (5, n, n).
        """
        other, one = (self._by(k, length, matrices) for k in (1, 0))
        return Propagated(one, other)

    def integral(self, length: float, rows: Array) -> Array:
        """Return the integral of ``R W`` over the step that was made last, (r, n).

        Args:
            length: Of the step.
            rows: R at :data:`NODES`, (5, r, n).
        """
        stages, weights = _METHODS[0]
        n, s = len(self._out), len(weights)
        slopes = self._rates[:, : s * n].reshape(n, s, n)  # by column of W, by node
        ways = np.eye(n) + length * np.einsum("ij,bja->iab", stages, slopes)
        return np.asarray(length * np.einsum("i,ira,iab->rb", weights, rows[:s], ways, optimize=True))

    def change(self, length: float, matrices: Array) -> Array:
        """Return the first-order change of a step with its matrices, near the identity.

        Args:
            length: Of the step.
            matrices: By how much they change at :data:`NODES`, (5, n, n).
        """
        return np.asarray(length * np.einsum("i,iab->ab", _METHODS[0][1], matrices[:-1]))

    def _by(self, method: int, length: float, matrices: Array) -> Array:
        stages, weights = _METHODS[method]
        s, n = len(weights), len(self._out)
        room = self._whole[: s * n, : s * n], self._pivots[: s * n], self._rates[:, : s * n]
        if not propagate(stages, weights, length, matrices[:s], room, self._out):
            return np.full((n, n), np.nan)
        return self._out.copy()
