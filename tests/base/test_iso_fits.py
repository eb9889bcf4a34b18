"""ISO 286 by published values, and chains of tolerances by closed forms."""

import math

import numpy as np
import pytest

from antenna_pin.base.iso_fits import read_fit, size_limits
from antenna_pin.base.tolerance_chain import Dimension, ToleranceChain
from antenna_pin.base.units import any_quantity, quantity
from antenna_pin.errors import InvalidParameterError

# Nominal size [mm], class, upper and lower deviation [um], as printed in ISO 286-2:2010.
PUBLISHED = """
20 H7 +21 0;   20 g6 -7 -20;   50 f7 -25 -50;   100 k6 +25 +3;   30 p6 +35 +22;   6 h6 0 -8
10 H7 +15 0;   10 f7 -13 -28;  6 H8 +18 0;      6 e8 -20 -38;    25 H11 +130 0;   25 c11 -110 -240
3 g6 -2 -8;    3 H7 +10 0;     3 K7 0 -10;      3 N9 -4 -29;     18 m6 +18 +7;    80 n6 +39 +20
20 K7 +6 -15;  20 M7 0 -21;    20 N7 -7 -28;    20 P7 -14 -35;   20 K8 +10 -23;   20 N9 0 -52
20 P9 -22 -74; 8 K6 +2 -7;     280 M6 -9 -41;   200 r6 +106 +77; 160 f6 -43 -68;  400 E7 +182 +125
20 js6 +6.5 -6.5;  20 JS7 +10.5 -10.5;  20 j6 +9 -4;  20 J7 +12 -9;  120 d9 -120 -207;  500 h6 0 -40
"""


@pytest.mark.parametrize(
    "row", [one.strip() for one in PUBLISHED.replace("\n", ";").split(";") if one.strip()]
)
def test_limits_are_those_of_the_standard(row):
    size, name, upper, lower = row.split()
    found = size_limits(float(size) / 1000.0, name)
    # Deviations are decimals of micrometres, rounded once to a float.
    assert found.upper == pytest.approx(float(upper) * 1e-6, rel=1e-15, abs=0.0)
    assert found.lower == pytest.approx(float(lower) * 1e-6, rel=1e-15, abs=0.0)


def test_a_fit_has_limits_of_its_play():
    fit = read_fit("ø20 H7/g6")
    assert (fit.least, fit.mean, fit.largest) == pytest.approx((3.5e-6, 12e-6, 20.5e-6), rel=1e-12)
    assert fit.sigma() == pytest.approx(math.hypot(21e-6, 13e-6) / 12.0, rel=1e-12)
    assert fit.tolerance_ratio == pytest.approx(12.0 / 17.0, rel=1e-12)
    assert fit.radial_clearance(1.0, -1.0) == pytest.approx(fit.largest, rel=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("20 H7", 'two tolerance classes, such as "20 H7/g6"'),
        ("20 g6/H7", "hole's class in capitals before"),
        ("20 H7/u6", "of a letter among a b c"),
        ("20 H17/g6", "grade must be a grade from 1 to 16"),
        ("600 H7/g6", "nominal must be a size above 0 and up to 500 mm"),
        ("0.3 H7/a11", "size above the deviations of its shaft"),
        ("20 H7/j9", "one of j5, j6, j7"),
        ("20 K9/h6", "grade 8 or finer for K"),
    ],
)
def test_what_is_no_fit_is_refused(text, words):
    with pytest.raises(InvalidParameterError, match=words):
        read_fit(text)


def test_two_uniform_dimensions_make_a_triangle():
    """Of widths 2 and 1 um the sum has a trapezium; its probabilities are areas."""
    chain = ToleranceChain(
        name="play",
        dimensions=[
            Dimension(name="a", nominal=1e-3, minus=-1e-6, plus=1e-6, distribution="uniform"),
            Dimension(
                name="b", nominal=0.9e-3, minus=0.0, plus=1e-6, coefficient=-1.0, distribution="uniform"
            ),
        ],
    )
    mean = 1e-4 - 0.5e-6
    assert chain.nominal == pytest.approx(1e-4, rel=1e-12) and chain.mean == pytest.approx(mean, rel=1e-12)
    assert chain.worst_case == pytest.approx((mean - 1.5e-6, mean + 1.5e-6), rel=1e-12)
    half = 0.5 * math.hypot(2e-6, 1e-6)
    assert chain.root_sum_square == pytest.approx((mean - half, mean + half), rel=1e-12)
    # The flank is a parabola: (y / um)^2 / 4 up to 1 um from the end. Cells of 2e-4 um blur it by 1e-8.
    for y in (0.2, 0.7, 1.0):
        assert chain.probability_below(mean + (y - 1.5) * 1e-6) == pytest.approx(0.25 * y * y, abs=1e-6)
    assert chain.quantile(0.5) == pytest.approx(mean, rel=1e-9)
    assert chain.shares == pytest.approx({"a": 0.8, "b": 0.2})


def test_a_cut_off_normal_dimension_by_sampling_of_its_inverse():
    """Mean, standard deviation and a tail against SciPy's truncated normal."""
    from scipy.stats import truncnorm

    one = Dimension(name="d", nominal=0.0, minus=-6e-6, plus=6e-6, sigmas=2.0)
    assert one.sigma == pytest.approx(truncnorm(-2.0, 2.0).std() * 3e-6, rel=1e-9)
    chain = ToleranceChain(name="y", dimensions=[one])
    assert chain.probability_below(-3e-6) == pytest.approx(truncnorm(-2.0, 2.0).cdf(-1.0), abs=1e-6)
    four = ToleranceChain(name="y", dimensions=[one] * 4)
    assert four.sigma == pytest.approx(2.0 * one.sigma, rel=1e-12)
    assert four.quantile(0.9) == pytest.approx(four.sigma * 1.2816, rel=0.01)  # nearly normal, kurtosis -0.2


def test_temperatures_are_kelvin():
    assert quantity("20 degC", "K", "t") == 293.15
    assert quantity("-40 °F", "K", "t") == quantity("-40 degC", "K", "t") == 233.15
    assert quantity("300 K", "K", "t") == 300.0 and any_quantity("85 degC") == (358.15, "K")
    with pytest.raises(Exception, match=r"must be a temperature \[K\], got '3 mm'"):
        quantity("3 mm", "K", "t")
    assert np.isclose(quantity("11.7 um/m/K", "1/K", "a"), 11.7e-6, rtol=1e-15)
