"""Drives and springs by themselves: their curves over time, and what is no element."""

import math
import re

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator

from antenna_pin.elements import (
    CallableDrive,
    ConstantDrive,
    SineDrive,
    TableDrive,
    kernels,
    kind_of,
)

# --- curves -------------------------------------------------------------------------------------------------


def effort(drive, t):
    """Torque of a drive at a time, as the kernels compute it."""
    return kernels.effort(kind_of(type(drive)), drive.words_of_kernel(), 0, t, 0.0, 0.0)


def test_constant_torque():
    assert [effort(ConstantDrive(joint="a", value=-2.5), t) for t in (0.0, 1.0, 1e9)] == [-2.5] * 3


def test_sine_torque():
    drive = SineDrive(joint="a", amplitude=4.0, frequency=1.5, phase=0.3)
    for t in np.linspace(0.0, 10.0, 101):
        expected = 4.0 * math.sin(2.0 * math.pi * 1.5 * t + 0.3)
        assert effort(drive, t) == pytest.approx(expected, abs=1e-13)  # round-off of an angle of 100 rad
    assert effort(SineDrive(joint="a", amplitude=4.0, frequency=1.0), 0.25) == pytest.approx(
        4.0, rel=1e-15, abs=0.0
    )


TIMES = (0.0, 0.1, 0.35, 0.4, 1.2, 2.0)
VALUES = (0.0, 3.0, 3.0, -1.0, -1.5, 0.5)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_table_passes_through_its_points(interpolation):
    drive = TableDrive(joint="a", time=TIMES, torque=VALUES, interpolation=interpolation)
    for t, value in zip(TIMES, VALUES, strict=True):
        assert effort(drive, t) == pytest.approx(value, abs=1e-15)  # round-off


def test_linear_table():
    drive = TableDrive(joint="a", time=TIMES, torque=VALUES)
    for t in np.random.default_rng(1).uniform(0.0, 2.0, 200):
        assert effort(drive, t) == pytest.approx(np.interp(t, TIMES, VALUES), abs=1e-14)  # round-off


def test_cubic_table_is_monotone_between_its_points():
    """No overshoot: a torque that rises in the table rises in between."""
    drive = TableDrive(joint="a", time=TIMES, torque=VALUES, interpolation="cubic")
    reference = PchipInterpolator(TIMES, VALUES)
    for (t0, t1), (y0, y1) in zip(
        zip(TIMES[:-1], TIMES[1:], strict=True), zip(VALUES[:-1], VALUES[1:], strict=True), strict=True
    ):
        curve = np.array([effort(drive, t) for t in np.linspace(t0, t1, 50)])
        assert curve == pytest.approx(reference(np.linspace(t0, t1, 50)), abs=1e-14)  # round-off
        assert (np.diff(curve) * np.sign(y1 - y0) >= -1e-15).all()
        assert curve.min() >= min(y0, y1) - 1e-15 and curve.max() <= max(y0, y1) + 1e-15


def test_cubic_table_has_a_continuous_slope():
    drive = TableDrive(joint="a", time=TIMES, torque=VALUES, interpolation="cubic")
    h = 1e-6
    for t in TIMES[1:-1]:
        left = (effort(drive, t) - effort(drive, t - h)) / h
        right = (effort(drive, t + h) - effort(drive, t)) / h
        # Half a second derivative of at most 1e4 on each side; a kink here would be of 10 and more.
        assert left == pytest.approx(right, abs=1e4 * h + 1e-9)


@pytest.mark.parametrize("interpolation", ["linear", "cubic"])
def test_shortest_table(interpolation):
    drive = TableDrive(joint="a", time=(1.0, 3.0), torque=(2.0, 4.0), interpolation=interpolation)
    assert [effort(drive, t) for t in (1.0, 2.0, 3.0)] == pytest.approx([2.0, 3.0, 4.0], rel=1e-15, abs=0.0)


# --- refusals -------------


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (
            lambda: ConstantDrive(joint="a", value=1.0, axis="shaft"),
            "ConstantDrive: axis must be bearing or journal, got 'shaft'",
        ),
        (
            lambda: TableDrive(joint="a", time=(0.0,), torque=(1.0,)),
            "TableDrive: time must be at least 2 numbers, got 1",
        ),
        (
            lambda: TableDrive(joint="a", time=(0.0, 1.0, 1.0), torque=(1.0, 2.0, 3.0)),
            "TableDrive: time[2] must be above the one before, 1.0, got 1.0",
        ),
        (
            lambda: TableDrive(joint="a", time=(0.0, math.nan), torque=(1.0, 2.0)),
            "TableDrive: time must be finite numbers, got (0.0, nan)",
        ),
        (
            lambda: TableDrive(joint="a", time=(0.0, 1.0), torque=(1.0, math.inf)),
            "TableDrive: torque must be finite numbers, got (1.0, inf)",
        ),
        (
            lambda: TableDrive(joint="a", time=(0.0, 1.0), torque=(1.0, 2.0, 3.0)),
            "TableDrive: torque must be as many numbers as time, 2, got 3",
        ),
        (
            lambda: TableDrive(joint="a", time=(0.0, 1.0), torque=(1.0, 2.0), interpolation="spline"),
            "TableDrive: interpolation must be linear or cubic, got 'spline'",
        ),
        (
            lambda: CallableDrive(joint="a", torque=lambda t, a, r: 0.0, axis="x"),
            "CallableDrive: axis must be bearing or journal, got 'x'",
        ),
    ],
)
def test_refuses_what_is_no_element(make, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        make()
