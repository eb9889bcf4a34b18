"""Small dense systems of linear equations, real or complex, compiled: factors in place, no allocation."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import kernel

RealOrComplex = Floats | NDArray[np.complex128]


@kernel
def decompose(matrix: RealOrComplex, pivots: Ints) -> bool:
    """Factorize a square matrix in place by pivoted LU; return whether it is regular.

    Args:
        matrix: (n, n), real or complex; on return U with the multipliers of L below.
        pivots: (n,); row with which each was exchanged.
    """
    n = pivots.shape[0]
    for k in range(n):
        best, largest = k, abs(matrix[k, k])
        for i in range(k + 1, n):
            size = abs(matrix[i, k])
            if size > largest:
                best, largest = i, size
        if not largest > 0.0:  # a NaN fails too
            return False
        pivots[k] = best
        if best != k:
            for j in range(n):
                matrix[k, j], matrix[best, j] = matrix[best, j], matrix[k, j]
        over = 1.0 / matrix[k, k]
        for i in range(k + 1, n):
            if matrix[i, k] != 0.0:
                factor = matrix[i, k] * over
                matrix[i, k] = factor
                for j in range(k + 1, n):
                    matrix[i, j] -= factor * matrix[k, j]
    return True


@kernel
def solve(matrix: RealOrComplex, pivots: Ints, right: RealOrComplex) -> None:
    """Overwrite the right-hand side, (n,), with the solution, by the factors of :func:`decompose`."""
    n = pivots.shape[0]
    for k in range(n):
        other = pivots[k]
        right[k], right[other] = right[other], right[k]
    for i in range(n):
        value = right[i]
        for j in range(i):
            value -= matrix[i, j] * right[j]
        right[i] = value
    for i in range(n - 1, -1, -1):
        value = right[i]
        for j in range(i + 1, n):
            value -= matrix[i, j] * right[j]
        right[i] = value / matrix[i, i]
