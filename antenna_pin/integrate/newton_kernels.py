"""The equations of an implicit step and their solution by simplified Newton steps, compiled.

For :mod:`antenna_pin.integrate.radau_kernels`, which says what is solved. The rows of ``work``: the
derivative at the step's start; those of the collocation polynomial at the three stages, from which the dense
output comes; the error; then as in :mod:`antenna_pin.integrate.kernels`.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from antenna_pin.base import records
from antenna_pin.base.records import Floats, Ints, Records
from antenna_pin.compiled.by_address import by_address
from antenna_pin.compiled.decorators import inlined, kernel
from antenna_pin.integrate.kernels import START, STATE, TOTAL, U, magnitudes, store
from antenna_pin.integrate.linear_kernels import decompose, solve
from antenna_pin.integrate.manifold_kernels import retract, space_of

# Typed, for the compiler.
ERROR_ROW: Any = np.int64(4)
FIRST: Any = np.int64(0)
END: Any = np.int64(2)


class ImplicitProgress(records.Record):
    """The progress of an implicit step."""

    phase: int  # what the next derivative is for
    column: int  # of the Jacobian that it is for
    stage: int  # that it is for
    rounds: int  # of Newton's iteration
    fresh: int  # 1: the Jacobian is that of the present start
    t: float  # time to evaluate at [s]
    step: float  # size of the last Newton step, in tolerances
    error: float  # scaled


PROGRESS = records.layout(ImplicitProgress)


@by_address
class Radau(NamedTuple):
    """The method's numbers, and what its steps work on; n components of z, m columns."""

    progress: Records[ImplicitProgress]  # PROGRESS, (1,)
    nodes: Floats  # c_i of the stages, (3,)
    inverse: Floats  # inverse of A, (3, 3)
    back: Floats  # T, from W to Z, (3, 3)
    forth: Floats  # its inverse, (3, 3)
    values: Floats  # eigenvalues of the inverse of A: the real one, the other's parts, (3,)
    error: Floats  # weights of the stages' increments in the error, (3,)
    columns: Ints  # components that the derivative depends on, increasing, (m,)
    z: Floats  # increments, (3, n)
    w: Floats  # in the other coordinates, (3, n)
    f: Floats  # derivatives at the stages, (3, n)
    jacobian: Floats  # of all components to the columns, (n, m)
    real: Floats  # factors, (m, m)
    complex: NDArray[np.complex128]  # factors, (m, m)
    pivots: Ints  # (2, m)
    solved: Floats  # (m,), scratch
    paired: NDArray[np.complex128]  # (m,), complex, scratch


@inlined
def write_state(z: Floats, r: int, stages: int, layout: Ints, work: Floats) -> None:
    """Write the state at chart coordinates z[r] into STATE and U."""
    space = space_of(layout)
    nq, nv, nx = space.nq, space.nv, space.nx
    for k in range(nv):
        work[stages + U, k] = z[r, k]
    for k in range(nv, nv + nv + nx):
        work[stages + STATE, nq - nv + k] = work[stages + START, nq - nv + k] + z[r, k]
    retract(layout, work, stages + START, z, r, work, stages + STATE)


@inlined
def _start_of(work: Floats, start: int, nq: int, nv: int, k: int) -> float:
    """Component k of z at the start."""
    return 0.0 if k < nv else float(work[start, nq - nv + k])


@inlined
def _way(radau: Radau, stages: int, layout: Ints, work: Floats, scales: Floats) -> float:
    """By how much the component of the present column is moved for a difference."""
    space = space_of(layout)
    k = radau.columns[radau.progress[0].column]
    size = abs(_start_of(work, stages + START, space.nq, space.nv, k))
    if scales[k] != math.inf:
        size = max(size, scales[k])
    way = 1.5e-8 * (size if size > 0.0 else 1.0)
    # The very difference of the two numbers in the machine.
    start = _start_of(work, stages + START, space.nq, space.nv, k)
    return float((start + way) - start)


@kernel
def vary(radau: Radau, stages: int, layout: Ints, work: Floats, scales: Floats) -> None:
    """Write the state at the start with the component of the present column moved."""
    n = radau.z.shape[1]
    for k in range(n):
        radau.z[0, k] = 0.0
    radau.z[0, radau.columns[radau.progress[0].column]] = _way(radau, stages, layout, work, scales)
    write_state(radau.z, FIRST, stages, layout, work)


@kernel
def keep_column(radau: Radau, stages: int, layout: Ints, work: Floats, scales: Floats) -> None:
    """Keep the column of the Jacobian that the answer gives."""
    store(ERROR_ROW, stages, layout, work)
    c = radau.progress[0].column
    way = _way(radau, stages, layout, work, scales)
    for k in range(radau.z.shape[1]):
        radau.jacobian[k, c] = (work[ERROR_ROW, k] - work[0, k]) / way


@kernel
def factorize(h: float, radau: Radau) -> bool:
    """Factorize both systems for steps of size h; return whether they are regular."""
    m = radau.columns.shape[0]
    real, pair = radau.values[0] / h, complex(radau.values[1], radau.values[2]) / h
    for i in range(m):
        k = radau.columns[i]
        for j in range(m):
            slope = radau.jacobian[k, j]
            radau.real[i, j] = -slope
            radau.complex[i, j] = -slope
        radau.real[i, i] += real
        radau.complex[i, i] += pair
    if not decompose(radau.real, radau.pivots[0]):
        return False
    return bool(decompose(radau.complex, radau.pivots[1]))


@inlined
def _is_column(radau: Radau, c: int, k: int) -> bool:
    return bool(c < radau.columns.shape[0] and radau.columns[c] == k)


@kernel
def newton_step(
    h: float, stages: int, layout: Ints, work: Floats, scales: Floats, rtol: float, radau: Radau
) -> float:
    """Make a Newton step from the stage derivatives; return its size in tolerances (RMS)."""
    space = space_of(layout)
    m, n = radau.columns.shape[0], radau.z.shape[1]
    forth, w, f = radau.forth, radau.w, radau.f
    real, pair = radau.values[0] / h, complex(radau.values[1], radau.values[2]) / h
    for c in range(m):
        k = radau.columns[c]
        total = forth[0, 0] * f[0, k] + forth[0, 1] * f[1, k] + forth[0, 2] * f[2, k]
        radau.solved[c] = total - real * w[0, k]
        one = forth[1, 0] * f[0, k] + forth[1, 1] * f[1, k] + forth[1, 2] * f[2, k]
        two = forth[2, 0] * f[0, k] + forth[2, 1] * f[1, k] + forth[2, 2] * f[2, k]
        radau.paired[c] = complex(one, two) - pair * complex(w[1, k], w[2, k])
    solve(radau.real, radau.pivots[0], radau.solved)
    solve(radau.complex, radau.pivots[1], radau.paired)
    c, count, square = 0, 0, 0.0
    for k in range(n):
        if _is_column(radau, c, k):
            dw, dpair = radau.solved[c], radau.paired[c]
            c += 1
        else:
            dw = forth[0, 0] * f[0, k] + forth[0, 1] * f[1, k] + forth[0, 2] * f[2, k] - real * w[0, k]
            one = forth[1, 0] * f[0, k] + forth[1, 1] * f[1, k] + forth[1, 2] * f[2, k]
            two = forth[2, 0] * f[0, k] + forth[2, 1] * f[1, k] + forth[2, 2] * f[2, k]
            dpair = complex(one, two) - pair * complex(w[1, k], w[2, k])
            for j in range(m):
                dw += radau.jacobian[k, j] * radau.solved[j]
                dpair += radau.jacobian[k, j] * radau.paired[j]
            dw /= real
            dpair /= pair
        w[0, k] += dw
        w[1, k] += dpair.real
        w[2, k] += dpair.imag
        for i in range(3):
            radau.z[i, k] = (
                radau.back[i, 0] * w[0, k] + radau.back[i, 1] * w[1, k] + radau.back[i, 2] * w[2, k]
            )
        if scales[k] != math.inf:
            start = abs(_start_of(work, stages + START, space.nq, space.nv, k))
            bound = rtol * (scales[k] + start)
            square += (dw * dw + dpair.real * dpair.real + dpair.imag * dpair.imag) / (bound * bound)
            count += 3
    return math.sqrt(square / count) if count > 0 else 0.0


@inlined
def _size(begin: int, end: int, h: float, stages: int, work: Floats, scales: Floats, rtol: float) -> float:
    """Root mean square of the scaled error of the components from ``begin`` to ``end``."""
    count, square = 0, 0.0
    for k in range(begin, end):
        if scales[k] != math.inf:
            error = h * work[ERROR_ROW, k] / (rtol * (scales[k] + work[stages + TOTAL, k]))
            square += error * error
            count += 1
    return math.sqrt(square / count) if count > 0 else 0.0


@kernel
def estimate(
    h: float, row: int, stages: int, layout: Ints, work: Floats, scales: Floats, rtol: float, radau: Radau
) -> float:
    """Write the step's error, over h, into its row; return the scaled error.

    ``row`` has the derivative that it is estimated with: at the start, or there plus the first estimate.
    """
    m, n = radau.columns.shape[0], radau.z.shape[1]
    real, z = radau.values[0] / h, radau.z
    for k in range(n):
        change = radau.error[0] * z[0, k] + radau.error[1] * z[1, k] + radau.error[2] * z[2, k]
        work[ERROR_ROW, k] = work[row, k] + change / h
    for c in range(m):
        radau.solved[c] = work[ERROR_ROW, radau.columns[c]]
    solve(radau.real, radau.pivots[0], radau.solved)
    c = 0
    for k in range(n):
        if _is_column(radau, c, k):
            work[ERROR_ROW, k] = radau.solved[c] / h
            c += 1
        else:
            value = work[ERROR_ROW, k]
            for j in range(m):
                value += radau.jacobian[k, j] * radau.solved[j]
            work[ERROR_ROW, k] = value / real / h
    magnitudes(layout, stages, work)
    space = space_of(layout)
    motion = _size(FIRST, 2 * space.nv, h, stages, work, scales, rtol)
    plain = _size(2 * space.nv, n, h, stages, work, scales, rtol)
    return float(motion if motion != motion or motion >= plain else plain)


@kernel
def write_slopes(h: float, stages: int, layout: Ints, work: Floats, radau: Radau) -> None:
    """Write the slopes of the collocation polynomial at the stages."""
    for k in range(radau.z.shape[1]):
        for i in range(3):
            total = 0.0
            for j in range(3):
                total += radau.inverse[i, j] * radau.z[j, k]
            work[1 + i, k] = total / h
