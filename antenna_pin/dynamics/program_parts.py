"""The parts of a run in which its force elements are the same."""

from __future__ import annotations

import operator
from collections.abc import Iterator, Sequence
from itertools import compress, pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

__all__ = ["program_parts", "records_at"]


def program_parts(programs: Sequence[NDArray[np.float64]]) -> Iterator[tuple[int, int]]:
    """Yield first and last (past the end) of the samples over which the program stays the same array.

    Args:
        programs: Force elements at each sample: the same array from one to the next unless they changed.
    """
    n = len(programs)
    return pairwise([0, *compress(range(1, n), map(operator.is_not, programs[1:], programs)), n])


def records_at(programs: Sequence[NDArray[np.float64]], place: int, layout: np.dtype[Any]) -> NDArray[Any]:
    """Return the records at a place of the program at each sample, as events and parameters have left them.

    Args:
        programs: Force elements at each sample: the same array from one to the next unless they changed.
        place: Where in a program the record begins.
        layout: Of the record.
    """
    found = np.zeros(len(programs), layout)
    for first, last in program_parts(programs):
        found[first:last] = programs[first][place : place + layout.itemsize // 8].view(layout)[0]
    return found
