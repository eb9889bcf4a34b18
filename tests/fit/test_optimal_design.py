"""Which test next, against designs that are known in closed form."""

import numpy as np
import pytest

from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.studies.fit.identifiability import design, planned

NAMES, ONES = ("intercept", "slope"), np.ones(2)


def _at(*places):
    """Return measurements of a straight line, one at each place."""
    return {f"{x:g}": np.array([[1.0, x]]) for x in places}


def test_optimal_designs_in_closed_form():
    """Of a line, a parabola, and a value beyond the interval."""
    # D-optimal: half at each end (Fedorov 1972); so is it for the slope alone.
    grid = _at(*np.linspace(-1.0, 1.0, 21))
    for criterion, wanted in (("D", None), ("c", "slope"), ("A", None)):
        plan = planned(grid, NAMES, ONES, 10, criterion=criterion, wanted=wanted)
        # The bound of the equivalence theorem is 1e-6; weights, at a flat optimum, are its root.
        assert plan.weights[[0, -1]] == pytest.approx([0.5, 0.5], abs=1e-3)
        assert plan.gap <= 1e-6
        assert plan.counts.tolist() == [5, *[0] * 19, 5]
    # D-optimal for 1, x, x^2 on [-1, 1]: a third each at -1, 0, 1.
    grid = {f"{x:g}": np.array([[1.0, x, x**2]]) for x in np.linspace(-1.0, 1.0, 21)}
    plan = planned(grid, ("a", "b", "c"), np.ones(3), 9)
    assert plan.weights[[0, 10, 20]] == pytest.approx(np.full(3, 1.0 / 3.0), abs=1e-3)
    assert plan.counts[[0, 10, 20]].tolist() == [3, 3, 3]
    # For the value at x0 > 1 beyond [-1, 1], weights are (x0 -+ 1) / 2 x0, after a change of the origin.
    x0 = 2.0
    grid = _at(*(np.linspace(-1.0, 1.0, 21) - x0))
    plan = planned(grid, NAMES, ONES, 8, criterion="c", wanted="intercept")
    near, far = (x0 + 1.0) / (2.0 * x0), (x0 - 1.0) / (2.0 * x0)
    assert plan.weights[[0, -1]] == pytest.approx([far, near], abs=2e-3)
    assert plan.counts[[0, -1]].tolist() == [2, 6]
    # With ten measurements at the upper end, ten more for the slope are all made at the lower one.
    known = np.tile([1.0, 1.0], (10, 1))
    plan = planned(_at(-1.0, 0.0, 1.0), NAMES, ONES, 10, known=known, criterion="c", wanted="slope")
    assert plan.counts.tolist() == [10, 0, 0]


def test_the_next_test_of_a_line_is_the_one_farthest_from_what_is_known():
    """After measurements near 1 the slope is told most by the other end, the intercept by the middle."""
    known = np.array([[1.0, 0.9], [1.0, 1.0]])
    found = design(_at(-1.0, 0.0, 1.0), NAMES, ONES, known=known, criterion="c", wanted="slope")
    assert found.experiments[0] == "-1"
    rows = np.vstack([known, [[1.0, -1.0]]])
    covariance = np.linalg.inv(rows.T @ rows)
    assert found.half[0] == pytest.approx(1.959963984540054 * np.sqrt(np.diag(covariance)), rel=1e-12)
    assert found.criteria["D"][0] == pytest.approx(np.linalg.det(covariance) ** 0.25, rel=1e-12)
    assert found.criteria["A"][0] == pytest.approx(np.sqrt(np.trace(covariance)), rel=1e-12)
    assert found.criteria["E"][0] == pytest.approx(np.sqrt(np.linalg.eigvalsh(covariance)[-1]), rel=1e-12)
    before = np.sqrt(np.diag(np.linalg.inv(known.T @ known)))
    assert found.before == pytest.approx(1.959963984540054 * before, rel=1e-11)
    middle = design(_at(-1.0, 0.0, 1.0), NAMES, ONES, known=known, criterion="c", wanted="intercept")
    assert middle.experiments[0] == "-1" or middle.experiments[0] == "0"
    assert middle.criteria["c"].tolist() == sorted(middle.criteria["c"])


def test_order_does_not_hang_on_units():
    """An experiment that leaves something open is the worst."""
    # Slopes in other units, with the scale that goes with them: the same order and lengths in scales.
    known = np.array([[1.0, 0.9], [1.0, 1.0]])
    one = design(_at(-1.0, 0.0, 1.0), NAMES, ONES, known=known)
    units = np.array([1.0, 1e6])
    other = design(
        {name: rows / units for name, rows in _at(-1.0, 0.0, 1.0).items()}, NAMES, units, known=known / units
    )
    assert other.experiments == one.experiments
    assert other.criteria["D"] == pytest.approx(one.criteria["D"], rel=1e-9)
    assert other.half / units == pytest.approx(one.half, rel=1e-9)
    # Two measurements at one place do not tell intercept and slope; the sum of experiments may.
    grid = {"same": np.array([[1.0, 1.0], [1.0, 1.0]]), "two": np.array([[1.0, 0.0], [1.0, 1.0]])}
    found = design(grid, NAMES, ONES)
    assert found.experiments == ("two", "same")
    assert np.isinf(found.half[1]).all() and np.isinf(found.criteria["D"][1])
    assert np.isinf(found.before).all()


def test_what_cannot_be_planned_is_refused():
    with pytest.raises(
        InvalidParameterError, match="such that all of them together determine every parameter"
    ):
        planned({"same": np.array([[1.0, 1.0]])}, NAMES, ONES, 4)
    with pytest.raises(InvalidParameterError, match="wanted must be the parameter that c is of, got none"):
        design(_at(0.0), NAMES, ONES, criterion="c")
    with pytest.raises(UnknownNameError, match="slope"):
        design(_at(0.0), NAMES, ONES, criterion="c", wanted="slop")
    with pytest.raises(UnknownNameError, match="criterion"):
        design(_at(0.0), NAMES, ONES, criterion="G")
    with pytest.raises(InvalidParameterError, match="experiments must be one or more, got none"):
        design({}, NAMES, ONES)
    with pytest.raises(InvalidParameterError, match="total must be 1 or more"):
        planned(_at(-1.0, 1.0), NAMES, ONES, 0)
