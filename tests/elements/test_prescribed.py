"""Prescribed motions: rate and acceleration are the derivatives of the position."""

import math
import re

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from antenna_pin.elements import CallableMotion, DistanceMotion, PrescribedMotion

TIMES = tuple(np.linspace(0.0, 2.0, 9))

MOTIONS = {
    "sum": PrescribedMotion(
        joint="a",
        position=0.3,
        rate=-1.1,
        coefficients=(0.7, -0.4, 0.2),
        amplitude=0.5,
        frequency=0.8,
        phase=0.6,
        time=TIMES,
        positions=tuple(np.cos(3.0 * np.array(TIMES))),
    ),
    "distance": DistanceMotion(
        joint="a",
        offset=(0.1, -0.2, 0.3),
        mean=(1.1, 0.0, 0.2),
        velocity=(0.02, 0.0, -0.1),
        amplitude=(0.0, 0.05, 0.07),
        frequency=0.5,
        phase=(0.0, 0.0, 1.5),
    ),
    "functions": CallableMotion(
        joint="a", position=math.sin, velocity=math.cos, acceleration=lambda t: -math.sin(t)
    ),
}


@pytest.mark.parametrize("motion", MOTIONS.values(), ids=MOTIONS)
def test_rate_and_acceleration_are_derivatives(motion):
    """By differences of fourth order over 1e-4 s: 1e-15 over that, and where third derivatives jump."""
    h = 1e-4
    for t in np.random.default_rng(3).uniform(0.01, 1.99, 50):
        values = {k: motion.at(t + k * h) for k in (-2, -1, 1, 2)}
        for order in (0, 1):
            slope = 8.0 * (values[1][order] - values[-1][order]) - values[2][order] + values[-2][order]
            assert slope / (12.0 * h) == pytest.approx(motion.at(t)[order + 1], abs=1e-9)


def test_values_are_those_of_the_formula():
    """At a time, each part by its own formula: round-off."""
    t, table = 1.3, CubicSpline(TIMES, np.cos(3.0 * np.array(TIMES)))
    expected = 0.3 - 1.1 * t + 0.7 * t**2 - 0.4 * t**3 + 0.2 * t**4
    expected += 0.5 * math.sin(2.0 * math.pi * 0.8 * t + 0.6) + float(table(t))
    assert MOTIONS["sum"].at(t)[0] == pytest.approx(expected, rel=1e-14)
    path = np.array([1.1, 0.0, 0.2]) + t * np.array([0.02, 0.0, -0.1])
    path = path + np.array([0.0, 0.05, 0.07]) * np.sin(math.pi * t + np.array([0.0, 0.0, 1.5]))
    assert MOTIONS["distance"].at(t)[0] == pytest.approx(
        float(np.linalg.norm(path + [0.1, -0.2, 0.3])), rel=1e-14
    )


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"amplitude": 1.0}, "PrescribedMotion: frequency must be given beside an amplitude, got none"),
        ({"frequency": 1.0}, "PrescribedMotion: amplitude must be given beside a frequency, got none"),
        ({"time": (0.0, 1.0)}, "PrescribedMotion: positions must be given beside time, got none"),
        (
            {"time": (0.0, 0.0), "positions": (0.0, 1.0)},
            "PrescribedMotion: time[1] must be above the one before, 0.0, got 0.0",
        ),
    ],
)
def test_refusals(given, message):
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        PrescribedMotion(joint="a", **given)
