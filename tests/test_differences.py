"""Derivatives by differences, and their doubt, of functions whose derivatives are known."""

import math

import numpy as np
import pytest

from antenna_pin.differences import slope

STEPS = (1e-1, 2e-2, 4e-3, 8e-4)


def smooth(s):
    """Return functions whose derivatives of every order are there, like those of a map across an impact."""
    return np.array([math.exp(3.0 * s), math.cos(2.0 * s) + s, 1.0 / (1.0 - 2.0 * s)])


def test_a_smooth_function_is_not_doubted_for_its_even_derivatives():
    """Of 1/(1 - 2s) the fourth derivative is 384; the doubt is the error of fourth order all the same."""
    found = slope(smooth, STEPS)
    off = np.abs(found.value - [3.0, 1.0, 2.0]).max()
    # Where both orders agree to 1e-8 of the derivative; what sixth order is off by is far below.
    assert off < found.doubt <= 1e-8 * 3.0
    assert off < 1e-11


@pytest.mark.parametrize("jump", [1e-2, 1e-5, 1.0])
def test_a_kink_on_the_spot_is_doubted_by_half_its_jump(jump):
    """Differences give the mean of both slopes, from which each is half of the jump."""
    found = slope(lambda s: smooth(s) + 0.5 * jump * abs(s), STEPS)
    assert found.value == pytest.approx([3.0, 1.0, 2.0], abs=1e-9)
    # The smooth part leaves f6 h^5 / 12 = 46,080 h^5 / 12 at steps of 4e-3: 4e-9.
    assert found.doubt == pytest.approx(0.5 * jump, abs=1e-8)


def test_a_kink_beside_the_spot_is_doubted():
    """At three steps of the smallest the orders disagree by a share of its jump that no step takes away."""
    found = slope(lambda s: np.array([s + max(0.0, s - 1e-3)]), STEPS)
    assert 0.01 < found.doubt < 1.0
