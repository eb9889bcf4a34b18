"""Curves through tables: what a double cannot hold of them is refused, all else is finite and silent."""

import math
import warnings

import pytest
from hypothesis import given
from hypothesis import strategies as st

from antenna_pin.elements import PDController, PrescribedMotion, TableDrive
from antenna_pin.elements.curve import cubics
from antenna_pin.errors import InvalidParameterError

CLASSES = {
    "torque": lambda time, values: TableDrive(joint="a", time=time, torque=values),
    "positions": lambda time, values: PrescribedMotion(joint="a", time=time, positions=values),
    "reference": lambda time, values: PDController(joint="a", kp=1.0, kd=1.0, time=time, reference=values),
}


@pytest.mark.parametrize("name", CLASSES)
@pytest.mark.parametrize(
    ("time", "values", "says"),
    [
        ((0, 1), (-1e308, 1e308), "{} must be numbers at most"),
        ((0, 1e-300), (0, 1), r"time\[1\] must be 1e-100 s or more above the one before"),
        ((0, 1, 1 + 1e-15), (0, 1, 0), None),
        ((0, 1e-99, 1), (0, 100, 0), r"{}\[1\] must be such that its slope from the one before, 0"),
        ((-1e308, 1e308), (0, 1), "time must be numbers at most"),
    ],
)
def test_a_slope_that_overflows_is_refused_by_its_point(name, time, values, says):
    if says is None:
        CLASSES[name](time, values)
        return
    with pytest.raises(InvalidParameterError, match=says.format(name)):
        CLASSES[name](time, values)


steps = st.sampled_from([1e-100, 1e-50, 1.0, 1e99])
heights = st.sampled_from([0.0, 5e-324, 1e-100, 1.0, -1e100, 1e100])


@given(points=st.lists(st.tuples(steps, heights), min_size=2, max_size=5))
def test_what_is_taken_has_finite_cubics_without_a_word(points):
    """With the second derivatives that kernels make of them."""
    time, t = [], 0.0
    for step, _ in points:
        t += step
        time.append(t)
    values = [height for _, height in points]
    try:
        table = TableDrive(joint="a", time=time, torque=values)
    except InvalidParameterError:
        return
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for kind in ("linear", "cubic", "smooth"):
            assert all(math.isfinite(6.0 * word) for word in cubics(table.time, table.torque, kind))
