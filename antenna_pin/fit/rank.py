"""Which parameters, and which combinations of them, a record feels at all: the rank of a Jacobian.

Parameters have units of their own, so that sizes of a Jacobian's columns say nothing beside one another.
Columns are brought to length 1 first: what is left between them is how alike two changes of the record are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from antenna_pin.errors import InvalidParameterError

__all__ = ["DOUBT", "Rank", "rank_of"]

Array = NDArray[np.float64]

DOUBT = 1e-7
"""Relative error that a column of a Jacobian is taken to have: that of good differences of runs [-]."""


@dataclass(frozen=True, slots=True, eq=False)
class Rank:
    """What a Jacobian tells of its parameters.

    Attributes:
        felt: Whether a parameter changes the record at all, (p,).
        determined: Whether it can be told from the record, all others free, (p,).
        lengths: Of the columns, each times its parameter's scale, (p,) [-].
        singular: Singular values of the columns at length 1, falling, those of parameters that are not felt
            left out, (felt,) [-].
        told: Directions of the scaled parameters that the record tells, a row each, (rank, p).
        null: Directions along which the record stays as it is, a row each with a 1 in a place where the
            others have a 0, (p - rank, p) in scales of the parameters: as few parameters together as can be.
    """

    felt: NDArray[np.bool_]
    determined: NDArray[np.bool_]
    lengths: Array
    singular: Array
    told: Array
    null: Array

    @property
    def full(self) -> bool:
        """Whether every parameter can be told."""
        return bool(self.determined.all())


def rank_of(jacobian: Array, scale: Array, doubt: float = DOUBT) -> Rank:
    """Return what a Jacobian tells of its parameters.

    A direction is one that cannot be told if what it does to the record is within the error of the Jacobian
    itself: a singular value below ``doubt`` times the root of the number of parameters, of columns of length
        1. A
    parameter is not felt if one scale of it does less than ``doubt`` squared of what one of the strongest
    does.

    Args:
        jacobian: Derivatives of the weighted residuals, (m, p).
        scale: Typical size of each parameter, (p,).
        doubt: Relative error of its columns [-].

    Raises:
        InvalidParameterError: The Jacobian holds what is no number, or has another shape.
    """
    count = len(scale)
    if jacobian.ndim != 2 or jacobian.shape[1] != count or not len(jacobian):
        raise InvalidParameterError(
            "fit", "jacobian", f"of {count} columns, one a parameter", said=f"shape {jacobian.shape}"
        )
    if not np.isfinite(jacobian).all():
        row, column = np.argwhere(~np.isfinite(jacobian))[0].tolist()
        raise InvalidParameterError(
            "fit", "jacobian", "finite", said=f"{jacobian[row, column]} in row {row}, column {column}"
        )
    scaled = jacobian * scale
    lengths = np.linalg.norm(scaled, axis=0)
    felt = lengths > doubt**2 * lengths.max(initial=0.0)
    places = np.flatnonzero(felt)
    unit = scaled[:, places] / lengths[places]
    _, singular, right = np.linalg.svd(unit, full_matrices=len(unit) < len(places))
    kept = int(np.count_nonzero(singular > doubt * np.sqrt(max(len(places), 1))))
    told, null = np.zeros((kept, count)), np.zeros((count - kept, count))
    told[:, places] = right[:kept] / lengths[places]  # scaled @ told.T has orthogonal columns
    determined = felt.copy()
    # Singular vectors are as far off as the columns are, over the gap between their singular values.
    determined[places] = np.linalg.norm(right[kept:], axis=0) <= 100.0 * doubt * np.sqrt(len(places))
    null[: len(places) - kept, places] = right[kept:] / lengths[places]
    null[len(places) - kept :, ~felt] = np.eye(count - len(places))
    null[:, determined] = 0.0
    null = _echelon(null)
    null = null[np.argsort(np.abs(null).argmax(axis=1), kind="stable")] if len(null) else null
    return Rank(felt, determined, lengths, singular, told, null)


def _echelon(rows: Array) -> Array:
    """Return rows of the same span, each with a 1 where all others have a 0, the largest entry first."""
    found = rows.copy()
    free = np.ones(found.shape[1], dtype=bool)
    for k in range(len(found)):
        sizes = np.where(free, np.abs(found[k:]), 0.0)
        row, column = np.unravel_index(int(sizes.argmax()), sizes.shape)
        found[[k, k + int(row)]] = found[[k + int(row), k]]
        found[k] /= found[k, column]
        free[column] = False
        others = np.arange(len(found)) != k
        found[others] -= np.outer(found[others, column], found[k])
    return found
