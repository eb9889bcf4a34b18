"""Four numbers at once are the numbers of four loops."""

import numba
import numpy as np

import antenna_pin.compiled.intrinsics  # noqa: F401 - which tells Numba of lanes
from antenna_pin.compiled.lanes import (
    LANES,
    lane,
    lane_of_row,
    put_lane,
    put_lane_of_row,
    same_lane,
    sum_of_lane,
)


def combined(one, other, factor, out):
    """Return the sum of the last of what every operation makes of two arrays, lane after lane, in ``out``."""
    total = same_lane(0.0)
    for at in range(0, one.shape[0], LANES):
        total = total + factor * lane(one, at) * lane(other, at) - lane(other, at) * factor
        put_lane(out, at, total)
    return sum_of_lane(total)


def test_lanes_are_four_loops_to_the_last_bit():
    """No order of additions is changed, no product fused with a sum: that would show in the last bits."""
    rng = np.random.default_rng(1)
    one, other = rng.normal(size=(2, 40))
    expected = np.zeros(40)
    for k in range(LANES):
        total = 0.0
        for at in range(k, 40, LANES):
            total = total + 0.3 * one[at] * other[at] - other[at] * 0.3
            expected[at] = total
    ends = expected[-LANES:]
    for function in (combined, numba.njit(combined)):
        out = np.zeros(40)
        assert function(one, other, 0.3, out) == (ends[0] + ends[1]) + (ends[2] + ends[3])
        assert np.array_equal(out, expected)


def shifted(rows, factor, out):
    """Write a lane of one row, and a multiple of it, into another array's rows."""
    for r in range(rows.shape[0]):
        own = lane_of_row(rows, r, r)
        put_lane_of_row(out, r, 1, own)
        put_lane_of_row(out, r, 1 + LANES, factor * own)


def test_lanes_of_a_row_begin_anywhere_in_it():
    """Rows of any length: where a lane stands is counted in numbers, not in lanes."""
    rows = np.arange(21.0).reshape(3, 7)
    expected = np.full((3, 10), -1.0)
    for r in range(3):
        expected[r, 1 : 1 + LANES] = rows[r, r : r + LANES]
        expected[r, 1 + LANES : 1 + 2 * LANES] = 0.3 * rows[r, r : r + LANES]
    for function in (shifted, numba.njit(shifted)):
        out = np.full((3, 10), -1.0)
        function(rows, 0.3, out)
        assert np.array_equal(out, expected)
