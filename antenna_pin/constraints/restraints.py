r"""Joints whose rate the rows of constraints prescribe, found by rank.

A joint's rate is prescribed where its unit vector e is a combination of rows,

.. math:: J^T x = e,

for then all velocities that satisfy the rows have one and the same rate there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from antenna_pin.constraints.factor_kernels import NOTHING
from antenna_pin.constraints.solver import Constraints

__all__ = ["motions_that_prescribe", "rows_that_share"]

Array = NDArray[np.float64]

# Of a unit vector, or of a row of length one: the part that counts as none.
_RANK = 1e-9


def motions_that_prescribe(constraints: Constraints, at: int, held: Sequence[int] = ()) -> tuple[str, ...]:
    """Return the names of the motions from which the rate of a joint follows; none if it is free, or fixed.

    Args:
        constraints: With the rows of the state written.
        at: Place of the joint in v.
        held: Rows of elements that hold their joints, among the last of the plan, which count too.
    """
    motions = constraints.plan.motions
    rows = constraints.every_row[[*range(constraints.rows), *(constraints.rows + k for k in held)]]
    if not motions or _combination(rows[len(motions) :], at) is not None:
        return ()
    shares = _combination(rows, at)
    if shares is None:
        return ()
    return tuple(name for name, share in zip(motions, shares, strict=False) if abs(share) > _RANK)


def _combination(rows: Array, at: int) -> Array | None:
    """Return by how much each row, of length one, makes up a joint's unit vector; None if they cannot."""
    wanted = np.zeros(rows.shape[1])
    wanted[at] = 1.0
    lengths = np.linalg.norm(rows, axis=1)
    lengths[lengths <= NOTHING] = np.inf
    unit = rows / lengths[:, None]
    found = np.linalg.lstsq(unit.T, wanted, rcond=_RANK)[0] if len(rows) else np.zeros(0)
    return found if np.abs(unit.T @ found - wanted).max() < _RANK else None


def rows_that_share(constraints: Constraints) -> tuple[int, ...]:
    """Return the elements, by the number of their row, whose load other rows could carry as well.

    Args:
        constraints: With the rows of the state written.
    """
    rows = constraints.every_row
    lengths = np.linalg.norm(rows, axis=1)
    some = np.flatnonzero(lengths > NOTHING * constraints.plan.length)
    if not len(some):
        return ()
    _, sizes, ways = np.linalg.svd((rows[some] / lengths[some, None]).T)
    loads = ways[np.count_nonzero(sizes > _RANK) :]  # that balance each other
    shares = np.abs(loads).max(axis=0, initial=0.0) > _RANK
    return tuple(int(k) - constraints.rows for k in some[shares] if k >= constraints.rows)
