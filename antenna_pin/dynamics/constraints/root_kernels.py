"""Root L of M = L L^T and its solutions, compiled, sparse for limbs."""

from __future__ import annotations

import math

from antenna_pin.base.records import Floats
from antenna_pin.compiled.decorators import inlined


@inlined
def write_root(mass: Floats, nv: int, root: Floats, starts: Floats) -> None:
    """Write L of L L^T, (nv nv,), its diagonal inverted, and rows' first columns."""
    for i in range(nv):
        row = i * nv
        begin = 0
        while begin < i and mass[i, begin] == 0.0:
            begin += 1
        starts[i] = begin
        for j in range(begin, i):
            total = mass[i, j]
            for k in range(max(begin, int(starts[j])), j):
                total -= root[row + k] * root[j * nv + k]
            root[row + j] = total * root[j * nv + j]
        total = mass[i, i]
        for k in range(begin, i):
            total -= root[row + k] * root[row + k]
        root[row + i] = 1.0 / math.sqrt(total)


@inlined
def solve_forth(nv: int, root: Floats, starts: Floats, out: Floats) -> None:
    """Solve L x = out in place."""
    for i in range(nv):
        total = out[i]
        for k in range(int(starts[i]), i):
            total -= root[i * nv + k] * out[k]
        out[i] = total * root[i * nv + i]


@inlined
def solve_back(nv: int, root: Floats, starts: Floats, out: Floats) -> None:
    """Solve L^T x = out in place."""
    for i in range(nv - 1, -1, -1):
        out[i] *= root[i * nv + i]
        for k in range(int(starts[i]), i):
            out[k] -= root[i * nv + k] * out[i]
