"""Central differences of two orders whose step is made finer while the orders disagree, compiled.

Who wants the derivative of something along one direction begins with :func:`clear`, adds what it is at each
neighbour (:func:`add`), and asks :func:`keep` whether that will do. A trial is (kinds, values), of each kind
of differences, the finest order first.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from antenna_pin._compile import inlined

#: How often a step is made finer at most, and by how much.
OFTEN, FINER = 8, 8.0
#: Difference of the orders over the derivative that is good enough.
_GOOD = 1e-10
_UNSURE = 16.0 * float(np.finfo(float).eps)


@inlined
def clear(trial: Any, count: int) -> None:
    """Begin a trial of so many values."""
    for kind in range(trial.shape[0]):
        for i in range(count):
            trial[kind, i] = 0.0


@inlined
def add(values: Any, count: int, side: float, point: int, step: float, weights: Any, trial: Any) -> None:
    """Add the values at ``side (point + 1) step`` to a trial, by ``weights``, (kinds, points)."""
    for kind in range(trial.shape[0]):
        weight = side * weights[kind, point] / step
        if weight != 0.0:
            for i in range(count):
                trial[kind, i] += weight * values[i]


@inlined
def apart(trial: Any, values: Any, step: float, first: int, last: int) -> float:
    """Return by how much two orders differ in ``first <= i < last``, over the largest derivative there.

    What the round-off of values makes of it does not count: it is all there is where a derivative is zero.
    """
    largest, off, size = 0.0, 0.0, 0.0
    for i in range(first, last):
        largest = max(largest, abs(trial[0, i]))
        off = max(off, abs(trial[0, i] - trial[1, i]))
        size = max(size, abs(values[i]))
    off -= _UNSURE * size / step
    return off / largest if off > 0.0 else 0.0


@inlined
def keep(trial: Any, count: int, off: float, best: float, out: Any) -> float:
    """Keep a trial that is better than the best yet (below 0: none); return by how much orders now differ.

    Args:
        trial: It.
        count: How many values it has.
        off: By how much its orders differ.
        best: By how much the orders of what is kept differ.
        out: To write to, as the trial.
    """
    if best >= 0.0 and not off < best:
        return best
    for kind in range(trial.shape[0]):
        for i in range(count):
            out[kind, i] = trial[kind, i]
    return off


@inlined
def goes_on(off: float, best: float) -> bool:
    """Whether a finer step is worth trying: what was found last is no good, and the best yet."""
    return best > _GOOD and off <= best
