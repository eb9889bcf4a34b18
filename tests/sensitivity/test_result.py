"""Sensitivities as rows for people."""

import math

import numpy as np
import pytest

from antenna_pin.studies.sensitivity.result import Changed


def changed(value, *slopes):
    return Changed("peak_force", "N", value, np.array(slopes), np.zeros(len(slopes)))


@pytest.mark.parametrize(
    ("row", "most"),
    [
        (changed(4.0, 1.0, -2.0), 0.5),
        (changed(-4.0, 3.0, -2.0), 0.75),
        (changed(1e-3, 0.0, 2.0), 2000.0),
        (changed(4.0, math.nan, 1.0), 0.25),
        (changed(0.0, 1.0), 0.0),
    ],
)
def test_the_largest_change_is_counted_over_the_number_itself(row, most):
    assert row.most == pytest.approx(most, rel=1e-15)
