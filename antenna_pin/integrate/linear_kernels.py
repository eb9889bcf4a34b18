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


# --- by collocation -----------------------------------------------------------------------------------------


@kernel
def propagate(
    stages: Floats,
    weights: Floats,
    size: float,
    matrices: Floats,
    room: tuple[Floats, Ints, Floats],
    out: Floats,
) -> bool:
    """Write the propagator of ``W' = A W`` over a step; return whether it exists.

    Args:
        stages: Weights of the stages, (s, s).
        weights: Of the step, (s,).
        size: Of the step.
        matrices: A at the nodes, (s, n, n).
        room: To write to, one after another: scratch, (s n, s n) and (s n,), and ``W'`` at the nodes by
            columns of the identity, (n, s n).
        out: To write to, (n, n).
    """
    whole, pivots, rates = room
    s, n = matrices.shape[0], matrices.shape[1]
    for i in range(s):
        for j in range(s):
            factor = size * stages[i, j]
            for a in range(n):
                for b in range(n):
                    whole[i * n + a, j * n + b] = -factor * matrices[i, a, b]
    for k in range(s * n):
        whole[k, k] += 1.0
    if not decompose(whole, pivots):
        return False
    for b in range(n):
        for i in range(s):
            for a in range(n):
                rates[b, i * n + a] = matrices[i, a, b]
        solve(whole, pivots, rates[b])
        for a in range(n):
            total = 0.0
            for i in range(s):
                total += weights[i] * rates[b, i * n + a]
            out[a, b] = size * total
        out[b, b] += 1.0
    return True
