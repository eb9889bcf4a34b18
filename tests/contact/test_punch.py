"""The rigid annular punch: both limits, values found otherwise, and the convergence of the solution."""

import math

import pytest

from antenna_pin.contact import annular_punch_factor
from antenna_pin.contact.materials import _factor


@pytest.mark.parametrize("ratio", [0.0, 1e-3, 0.02, 0.05, 0.1])
def test_a_small_hole_takes_nearly_nothing(ratio):
    """The series of the problem for a small hole; what it leaves out begins with the sixth power."""
    series = 1.0 - 4.0 * ratio**3 / (3.0 * math.pi**2) - 8.0 * ratio**5 / (15.0 * math.pi**2)
    assert annular_punch_factor(ratio) == pytest.approx(series, rel=1e-12, abs=0.011 * ratio**6)


@pytest.mark.parametrize("ratio", [0.99, 0.999, 0.9999, 1.0 - 1e-6])
def test_a_narrow_ring_is_a_bent_line(ratio):
    """Its load is that of a line around a circle; what that leaves out goes as the square of the width."""
    line = math.pi**2 * (1.0 + ratio) / (4.0 * math.log(16.0 * (1.0 + ratio) / (1.0 - ratio)))
    assert annular_punch_factor(ratio) == pytest.approx(line, rel=0.6 * (1.0 - ratio) ** 2 + 1e-14, abs=0.0)


@pytest.mark.parametrize(("ratio", "expected"), [(0.5, 0.981), (10.0 / 12.0, 0.878), (0.95, 0.748)])
def test_values_of_a_boundary_element_solution(ratio, expected):
    """To the digits that it has."""
    assert annular_punch_factor(ratio) == pytest.approx(expected, abs=5.1e-4)


@pytest.mark.parametrize("ratio", [0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 0.95, 0.99])
def test_the_factor_has_converged(ratio):
    """A quarter, half as many and twice as many nodes as are taken."""
    found = [_factor(ratio, nodes) for nodes in (16, 32, 128)]
    assert found == pytest.approx([annular_punch_factor(ratio)] * 3, abs=1e-10)


def test_a_wider_hole_carries_less():
    factors = [annular_punch_factor(k / 50.0) for k in range(50)]
    assert factors[0] == 1.0 and all(b < a for a, b in zip(factors, factors[1:], strict=False))


@pytest.mark.parametrize("ratio", [-0.1, 1.0, math.nan])
def test_a_ring_has_a_width(ratio):
    with pytest.raises(ValueError, match=r"^annular_punch_factor: ratio must be in \[0, 1\), got"):
        annular_punch_factor(ratio)
