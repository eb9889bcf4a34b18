"""Derivatives by differences, and their doubt, of functions whose derivatives are known."""

import math

import numpy as np
import pytest

from antenna_pin.base.calculus import few, slope

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


def asked(function):
    """Return the derivative of a function by few of its neighbours, its doubt, and which were asked."""
    steps = []

    def there(j):
        steps.append(j)
        return np.array([function(1e-3 * j)])

    (value,), (doubt,) = few(there, 1e-3)
    return value, doubt, sorted(steps)


@pytest.mark.parametrize(
    ("function", "exact", "count"),
    [
        (lambda s: 3.0 + 0.7 * s, 0.7, 4),  # on a straight line
        (lambda s: math.sin(s), 1.0, 5),  # which bends by its third derivative alone
        (lambda s: (2.0 + 2.0 * s) ** 1.5, 1.5 * 2.0**1.5, 5),
        (lambda s: math.exp(30.0 * s), 30.0, 7),
        (lambda s: math.inf, 0.0, 4),
    ],
)
def test_few_neighbours_tell_a_derivative(function, exact, count):
    """To round-off over the step, and of six to h^6 30^7 / 140 = 2e-10; no more are asked than are needed."""
    value, doubt, steps = asked(function)
    assert value == pytest.approx(exact, abs=1e-11 * max(1.0, abs(exact)), rel=0.0)
    assert doubt <= 1e-5 * abs(exact) and len(steps) == count


def test_a_kink_among_few_neighbours_is_told():
    """A slope that goes from 0 to 1 between one step and two: odd differences of 0, 1/2, 3/2 steps."""
    _, doubt, steps = asked(lambda s: max(s, 1.5e-3))
    assert doubt == pytest.approx(3 / 60 - 1 / 24, rel=1e-9) and len(steps) == 7
