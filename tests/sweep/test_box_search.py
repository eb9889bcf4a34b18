"""Worst cases against closed forms: corners of monotone responses, searches inside for others."""

import numpy as np
import pytest

from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.sweep.box_search import MOST_CORNERS, corners_of, worst_case


@pytest.mark.parametrize("variables", [1, 2, 5])
def test_worst_case_of_a_monotone_response_is_its_corner(variables):
    """Products of rising and falling factors have their largest value at one corner; no search beats it."""
    signs = np.array([1.0 if k % 2 == 0 else -1.0 for k in range(variables)])

    def response(x):
        return np.prod(1.0 + 0.3 * signs * x, axis=1)

    found = worst_case(response, variables, runs=100, seed=1)
    assert not found.inside
    assert found.point.tolist() == found.corner.tolist() == (signs > 0.0).astype(float).tolist()
    assert found.value == pytest.approx(1.3 ** int((signs > 0.0).sum()), rel=1e-14)


def test_search_beats_every_corner_of_a_smooth_maximum_inside():
    """1 - |x - c|^2 is 1 at c; the search finds it to 1e-6 in 200 runs of three variables."""
    centre = np.array([0.3, 0.62, 0.45])

    def response(x):
        return 1.0 - ((x - centre) ** 2).sum(axis=1)

    found = worst_case(response, 3, runs=200, seed=0)
    corner = 1.0 - (np.minimum(centre, 1.0 - centre) ** 2).sum()
    assert found.at_corner == pytest.approx(corner, rel=1e-14)
    assert found.inside and found.value > found.at_corner
    assert found.value == pytest.approx(1.0, abs=1e-6)
    assert found.runs <= 200 + 8 + 6


@pytest.mark.parametrize("seed", range(5))
def test_search_finds_the_highest_of_many_maxima(seed):
    """cos(6 pi (x - c)) - 3 (x - c)^2 has seven maxima, of which the one at c = 0.37 alone reaches 1."""

    def response(x):
        return np.cos(6.0 * np.pi * (x[:, 0] - 0.37)) - 3.0 * (x[:, 0] - 0.37) ** 2

    found = worst_case(response, 1, runs=60, seed=seed)
    assert found.point[0] == pytest.approx(0.37, abs=1e-3)
    assert found.value == pytest.approx(1.0, abs=1e-4)


def test_points_without_a_number_are_passed_over():
    """Where a response has none, the worst of the others counts; of none at all the result is NaN."""
    found = worst_case(lambda x: np.where(x[:, 0] > 0.5, np.nan, x[:, 0]), 1, runs=50)
    assert found.value == pytest.approx(0.5, abs=1e-3) and found.at_corner == 0.0
    assert np.isnan(worst_case(lambda x: np.full(len(x), np.nan), 1).value)


def test_too_many_corners_are_refused():
    """Thirteen variables have 8192; the message says what to do."""
    with pytest.raises(InvalidParameterError, match=f"at most {MOST_CORNERS} combinations; name fewer.*8192"):
        corners_of([2] * 13)
