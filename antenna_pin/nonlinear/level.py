"""A basis of coordinates of which all but one each leave the depths of contacts as they are.

Next to where a contact begins, the derivative of its force over the depth is as large as one likes, and what
it is multiplied by next to nothing: the sum of all coordinates' parts of the depth. It is that to round-off if
it is taken as one number, and not as the sum of products of which each is large and differentiated by itself.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

__all__ = ["level"]

Array = NDArray[np.float64]

# Part of a row's largest number that must be left of it beside those before: else it says nothing new.
_NEW = 1e-3


def level(rows: Sequence[Array], ways: int) -> Array:
    """Return the basis, by columns, (size, size).

    Args:
        rows: Derivatives of gaps over coordinates, the shallowest first, (size,) each.
        ways: Among how many coordinates, the first ones, that one is chosen which changes a gap.
    """
    basis, taken = np.eye(len(rows[0])), []
    for row in rows:
        here = row @ basis
        among = np.abs(here[:ways])
        among[taken] = 0.0
        one = int(np.argmax(among))
        if among[one] <= _NEW * np.abs(row[:ways]).max():
            continue
        share = here / here[one]
        share[one] = 0.0
        basis -= np.outer(basis[:, one], share)
        taken.append(one)
    return basis
