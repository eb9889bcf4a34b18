"""Four numbers at once are the numbers of four loops."""

import numba
import numpy as np

import antenna_pin._intrinsics  # noqa: F401 - which tells Numba of lanes
from antenna_pin._lanes import LANES, lane, put_lane, same_lane, sum_of_lane


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
