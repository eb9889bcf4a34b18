"""Four numbers at once in compiled code, in one register of the processor.

Compilers vectorise sums only if they may change the order of additions, which changes results. Here the four
numbers are independent: the results are those of four separate loops, to the last bit. Lanes add, subtract
and multiply, with one another and with a number. Uncompiled they are arrays; ``intrinsics.py`` has the
compiled form.
"""

from __future__ import annotations

from typing import Any

import numpy as np

#: Numbers in a lane.
LANES = 4


def lane(numbers: Any, at: int) -> Any:
    """Return ``numbers[at : at + LANES]`` of a contiguous array; nothing is checked."""
    return numbers[at : at + LANES].copy()


def put_lane(numbers: Any, at: int, value: Any) -> None:
    """Write a lane into ``numbers[at : at + LANES]`` of a contiguous array, unchecked."""
    numbers[at : at + LANES] = value


def lane_of_row(rows: Any, r: int, k: int) -> Any:
    """Return ``rows[r, k : k + LANES]`` of a contiguous array, unchecked."""
    return rows[r, k : k + LANES].copy()


def put_lane_of_row(rows: Any, r: int, k: int, value: Any) -> None:
    """Write a lane into ``rows[r, k : k + LANES]`` of a contiguous array, unchecked."""
    rows[r, k : k + LANES] = value


def same_lane(number: float) -> Any:
    """Return a lane that is one number all along."""
    return np.full(LANES, number)


def sum_of_lane(value: Any) -> float:
    """Return the sum of a lane's numbers."""
    return float((value[0] + value[1]) + (value[2] + value[3]))
