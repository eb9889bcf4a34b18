"""Roots between two places, also of functions that answer at these no more as they did."""

import math

import pytest

from antenna_pin.base.calculus import root_between


def test_a_root_is_found_to_the_last_digit():
    assert root_between(lambda x: x * x - 2.0, 0.0, 2.0, absolute=1e-16) == pytest.approx(
        math.sqrt(2.0), rel=1e-15
    )


def test_known_values_at_the_ends_are_what_counts():
    """A function that is zero at an end but for round-off has any sign there when it is evaluated anew."""
    off = root_between(lambda x: x + 1e-16, 0.0, 1.0, absolute=1e-15, ends=(-2e-16, 1.0))
    assert 0.0 <= off <= 4e-15
    there = root_between(lambda x: x - 1.0 - 1e-16, 0.0, 1.0, absolute=1e-15, ends=(-1.0, 1e-16))
    assert 1.0 - 4e-15 <= there <= 1.0


def test_where_a_function_is_no_number_it_has_passed():
    """log of a negative number beyond 0.3: where it ends is found, not an error."""
    found = root_between(
        lambda x: math.log(0.3 - x) - 9.0 if x < 0.3 else math.nan,
        0.0,
        1.0,
        absolute=1e-12,
        ends=(-10.0, 1.0),
    )
    assert found == pytest.approx(0.3, abs=1e-11)
