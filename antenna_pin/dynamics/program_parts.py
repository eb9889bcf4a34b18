"""The parts of a run in which its force elements are the same."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from itertools import compress, pairwise

import numpy as np
from numpy.typing import NDArray

__all__ = ["program_parts"]


def program_parts(programs: Sequence[NDArray[np.float64]]) -> Iterator[tuple[int, int]]:
    """Yield first and last (past the end) of the samples over which the program stays the same array.

    Args:
        programs: Force elements at each sample: the same array from one to the next unless they changed.
    """
    n = len(programs)
    return pairwise([0, *compress(range(1, n), map(operator.is_not, programs[1:], programs)), n])
