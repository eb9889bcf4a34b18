"""Derivatives whose steps are made finer next to kinks, of functions that are known."""

import math

import numpy as np
import pytest

from antenna_pin.base.calculus import WEIGHTS
from antenna_pin.integrate.difference_kernels import BEGIN, FINER, OFTEN, add, clear, place_at, rests, settle

FIRST = 1e-3


def derivative(function, first=FIRST):
    """Return the derivative of a number's function at zero by both orders, and in how many trials."""
    trial, out, so_far, step, trials = np.zeros((4, 1)), np.zeros((2, 1)), BEGIN, first, 0
    for _ in range(OFTEN):
        trials, moves = trials + 1, False
        clear(trial, 1)
        for turn in range(7):
            place = place_at(turn, 3)
            values = np.array([function(place * step)])
            moves = add(values, 1, place, WEIGHTS, trial) or moves
            if rests(turn, moves, 1, trial):
                break
        so_far = settle(trial, values, step, (0, 1), so_far, out)
        if not so_far[2]:
            break
        step /= FINER
    return out[0, 0], out[1, 0], trials


@pytest.mark.parametrize("away", [3.1, 2.0, 1.0, 0.6, 0.1, 1e-2, 1e-4, 1e-5])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_the_slope_on_the_own_side_of_a_kink(away, side):
    """However near it is: central differences of both orders would agree on the middle of two slopes."""
    place = side * away * FIRST

    def function(s):
        return math.sin(s) + 5.0 * max(s - place, 0.0)

    right = 1.0 + (5.0 if place < 0.0 else 0.0)
    sixth, _, _ = derivative(function)
    # Steps end as fine as the kink is near: round-off of values of 1e-3 or less, over that.
    assert sixth == pytest.approx(right, rel=1e-9 + 1e-17 / abs(place))


@pytest.mark.parametrize("away", [0.81 / 8.0**k for k in range(6)])
def test_a_step_at_which_differences_are_none_is_no_end(away):
    """Of max(s - d, 0) they are zero at 0.81 d, on the way to steps that straddle it no more."""
    sixth, other, trials = derivative(lambda s: 5.0 * max(s - away * FIRST, 0.0))
    assert sixth == other == 0.0
    assert trials < OFTEN


@pytest.mark.parametrize("slope", [0.0, -0.08, -0.1062])
def test_a_step_at_which_differences_are_small_is_no_end(slope):
    """Where the middle of two slopes is near zero, what orders differ by is a large share of it."""
    for away in np.geomspace(1.5e-6, 3.0, 400).tolist():
        sixth, _, _ = derivative(lambda s, away=away: slope * s - 0.2876 * max(s - away * FIRST, 0.0))
        # Round-off of a place over steps that are a part in 24 of it at least.
        assert sixth == pytest.approx(slope, abs=1e-14)


@pytest.mark.parametrize("away", [0.0, 1e-12])
def test_where_a_kink_is_nearer_than_any_step_the_orders_part_by_half_its_jump(away):
    """So that who uses the derivative knows that it is none."""
    sixth, other, trials = derivative(lambda s: math.sin(s) + 5.0 * max(s - away, 0.0))
    assert trials == OFTEN
    assert abs(other - sixth) == pytest.approx(2.5, rel=0.01)  # the finest step is 5e-10


def test_next_to_a_jump_steps_are_finer_than_to_the_jump():
    """There the orders part by the same share of a derivative that grows, until it is not straddled."""
    sixth, other, trials = derivative(lambda s: math.sin(s) + (1.0 if s > 1e-6 else 0.0))
    assert 1 < trials < OFTEN
    assert sixth == pytest.approx(1.0, rel=1e-7)  # of values of 1e-6, a step of 2e-7: found 1e-10
    assert abs(other - sixth) < 1e-7


@pytest.mark.parametrize("function", [math.sin, math.cos, math.exp, lambda s: (1.0 + s) ** 1.5])
def test_smooth_functions_take_one_trial(function):
    """How they bend is no larger than what the two orders part by anyway."""
    exact = {math.sin: 1.0, math.cos: 0.0, math.exp: 1.0}.get(function, 1.5)
    sixth, other, trials = derivative(function)
    assert trials == 1
    # Round-off of values of 1 over the step.
    assert sixth == pytest.approx(exact, abs=1e-12) and other == pytest.approx(exact, abs=1e-11)


def test_what_nothing_depends_on_takes_three_looks():
    """On the spot and at the farthest on both sides; not where one side moves, as a plateau's end does."""
    looks = []

    def level(s):
        looks.append(s)
        return 7.0

    assert derivative(level) == (0.0, 0.0, 1) and len(looks) == 3
    for side in (1.0, -1.0):
        sixth, other, trials = derivative(lambda s, side=side: 7.0 + max(side * s - 2.5 * FIRST, 0.0))
        assert sixth == other == 0.0 and trials > 1
