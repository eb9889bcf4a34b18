"""What a test can tell before anything is fitted."""

import math
import sys

import numpy as np
import pytest
from known_curves import Curve, line, oscillator

from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.fit.identifiability import identifiable
from antenna_pin.studies.fit.plan import parameter_size
from antenna_pin.studies.fit.uncertainty import rank_of


def test_expected_errors_are_those_of_the_fit_to_come(times):
    """Of a linear model they hang on the times only: sd / sqrt(Sxx) of the slope."""
    found = identifiable(line(times, 0.0 * times, 0.1))
    apart = times - times.mean()
    assert found.error[1] == pytest.approx(0.1 / np.sqrt(apart @ apart), rel=1e-12, abs=0.0)
    assert found.alone[1] == pytest.approx(0.1 / np.sqrt(times @ times), rel=1e-12, abs=0.0)
    # The variance inflation of two columns is 1 / (1 - their squared cosine).
    cosine2 = times.sum() ** 2 / (times.size * (times @ times))
    assert found.inflation[1] ** 2 == pytest.approx(1.0 / (1.0 - cosine2), rel=1e-12, abs=0.0)
    assert found.half == pytest.approx(1.959963984540054 * found.error, rel=1e-14, abs=0.0)
    assert found.together == () and found.hold == () and found.poor == ()
    # Along its directions, in scales, errors are one over the singular values.
    assert found.singular == pytest.approx(
        np.linalg.svd(np.column_stack([np.ones_like(times), times]) / 0.1, compute_uv=False)
    )


def test_mass_and_stiffness_of_free_motion_are_told_together_only(times):
    found = identifiable(oscillator(times, np.cos(5.0 * times), 0.02))
    assert not found.rank.determined.any() and np.isinf(found.half).all()
    assert found.together == (
        "mass and stiffness: only in combination: the record does not change when they change, "
        "mass by 1 %, stiffness by 1 %",
    )
    assert len(found.hold) == 1


def test_what_a_record_does_not_feel_and_what_it_tells_beside_it(times):
    """Of m, k, an offset, and a number that is nowhere in the model the offset alone is told."""

    def slopes(t, x):
        ours = oscillator(t, t).slopes(t, x[:2])
        return np.column_stack([ours, np.ones_like(t), np.zeros_like(t)])

    model = Curve(
        ("mass", "stiffness", "offset", "colour"),
        times,
        lambda t, x: np.cos(np.sqrt(x[1] / x[0]) * t) + x[2],
        slopes,
        np.cos(5.0 * times),
        np.array([2.0, 50.0, 0.0, 3.0]),
        0.02,
    )
    found = identifiable(model)
    assert found.rank.determined.tolist() == [False, False, True, False]
    assert found.rank.influential.tolist() == [True, True, True, False]
    assert found.together[-1] == "colour: not at all: the record does not change with it"
    assert set(found.hold) == {"colour"} | ({"mass", "stiffness"} & set(found.hold))
    # Held as it says, the rest can be told.
    kept = [k for k, name in enumerate(model.names) if name not in found.hold]
    assert rank_of(model.jacobian(model.start)[:, kept], model.scale[kept]).full
    # With the offset a record of the frequency is as good as if that was known by another name.
    reduced = model.jacobian(model.start)[:, [0, 2]]
    expected = np.sqrt(np.linalg.inv(reduced.T @ reduced)[1, 1])
    assert found.error[2] == pytest.approx(expected, rel=1e-7, abs=0.0)  # to the doubt of a column


def test_a_change_of_nothing_is_said_in_scales(times):
    """An offset of zero that only its sum with another tells is changed by a share of its scale."""
    model = Curve(
        ("offset", "bias"),
        times,
        lambda t, x: x[0] + x[1] + 0.0 * t,
        lambda t, x: np.ones((t.size, 2)),
        0.0 * times,
        np.array([0.0, 0.5]),
    )
    (said,) = identifiable(model).together
    assert said.endswith("offset by 1 % of its scale, bias by −2 %") or said.endswith(
        "bias by 1 %, offset by −0.5 % of its scale"
    )


def test_three_that_hang_together_in_two_ways_are_said_two_at_a_time():
    """Columns a, b, a, b: what is said names pairs, as few together as can be, not all four."""
    rng = np.random.default_rng(3)
    a, b = rng.standard_normal((2, 40))
    found = rank_of(np.column_stack([a, b, 3.0 * a, -b]), np.ones(4))
    pairs = sorted(tuple(np.flatnonzero(np.abs(row) > 1e-9)) for row in found.null)
    assert pairs == [(0, 2), (1, 3)]


def test_what_is_told_to_less_than_its_size_is_said(times):
    """Differences that are no numbers are refused."""
    model = line(times, 0.0 * times, 5.0)
    found = identifiable(model)
    assert found.poor == ("intercept", "slope")  # 5 / sqrt(31) is 0.9, and twice that is more than 1
    jacobian = np.ones((4, 2))
    jacobian[2, 1] = np.nan
    with pytest.raises(InvalidParameterError, match="jacobian must be finite, got nan in row 2, column 1"):
        rank_of(jacobian, np.ones(2))
    with pytest.raises(InvalidParameterError, match=r"of 3 columns, one a parameter, got shape \(4, 2\)"):
        rank_of(jacobian, np.ones(3))


@pytest.mark.parametrize(
    ("start", "low", "high", "size"),
    [
        (-3.0, 0.0, 10.0, 3.0),
        (0.0, -2.0, 5.0, 7.0),
        (0.0, -math.inf, 5.0, 1.0),
        (0.0, 2.0, math.inf, 1.0),
        (0.0, -math.inf, math.inf, 1.0),
        (0.0, -sys.float_info.max, sys.float_info.max, 1.0),  # as "no bounds" may be written
    ],
)
def test_a_parameter_that_starts_at_zero_is_as_large_as_its_bounds_are_apart(start, low, high, size):
    assert parameter_size(start, low, high) == size
