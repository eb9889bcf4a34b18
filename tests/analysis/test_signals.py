"""The signals of a run whose spectra tell something."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import base_motion, dominant_frequencies, signals


def test_signals_of_the_antenna():
    overrides = ["clearance.elevation.geometry=closed-form"]
    run = simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.05)
    found = signals(run)
    data = run.data
    elevation = data["motion_acceleration"].sel(joint="elevation").values
    assert np.array_equal(found["elevation acceleration"].values, elevation)
    assert np.array_equal(found["elevation force y"].values, data["joint_force"].values[:, 0, 1])
    turn = base_motion(run)["angular_acceleration"].values[:, 2]
    assert np.array_equal(found["base angular acceleration z"].values, turn)
    assert found["base acceleration x"].units == "m/s^2"
    for one in found.values():
        assert one.time.shape == one.values.shape


def test_the_drive_shows_in_an_ideal_run():
    """The elevation drive is a sine of 1 Hz; five periods, and a base that barely moves."""
    found = signals(simulate(load_scenario("bai2020", case="case1")))
    assert not any(" force " in name for name in found)
    one = found["elevation acceleration"]
    peaks = dominant_frequencies(one.time, one.values, 1)
    # The other axis turns, which modulates it by some parts in a thousand.
    assert peaks["frequency"].item() == pytest.approx(1.0, abs=0.005)
    assert peaks["amplitude"].item() == pytest.approx(np.abs(one.values).max(), rel=0.02)


def test_a_fixed_base_has_no_signals_and_zeros_are_left_out():
    found = signals(simulate(load_scenario("pendulum", case="planar"), duration=0.02))
    assert list(found) == ["hinge acceleration", "hinge force x", "hinge force y"]
