"""Linear differential equations over a step by collocation, compiled."""

from __future__ import annotations

from antenna_pin.base.records import Floats, Ints
from antenna_pin.compiled.decorators import kernel
from antenna_pin.integrate.linear_kernels import decompose, solve


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
