"""The motion of any body in the world, and its deviation from the ideal run."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import base_motion, body_deviation, body_motion, deviation, moved_body
from antenna_pin.errors import InvalidParameterError, UnknownNameError

QUANTITIES = ("position", "velocity", "acceleration", "angular_velocity", "angular_acceleration")


@pytest.fixture(scope="module")
def runs():
    overrides = ["clearance.joint2.geometry=closed-form", "initial.base.angular_velocity=[0.3, -0.2, 0.5]"]
    return [
        simulate(load_scenario("you2010", case=case, overrides=overrides), duration=0.1)
        for case in ("ideal", "planar")
    ]


def test_a_free_base_moves_as_recorded(runs):
    """The same frame by two ways: recorded pose and rates, and forward kinematics of the tree."""
    recorded, found = base_motion(runs[1]), body_motion(runs[1], "body")
    for name in (*QUANTITIES, "rotation", "attitude"):
        size = max(float(np.abs(recorded[name]).max()), 1.0)
        # Round-off of a few products.
        np.testing.assert_allclose(found[name], recorded[name], rtol=0.0, atol=1e-14 * size)
    for name in QUANTITIES:
        assert found[name].attrs["units"] == recorded[name].attrs["units"]


def test_rates_of_the_last_body_are_derivatives(runs):
    """By central differences of samples 1 ms apart: truncation of a sixth of the step squared."""
    motion = body_motion(runs[0], "shaft2")
    time = motion["time"].values
    inner = slice(1, -1)
    for of, rate in (
        ("position", "velocity"),
        ("velocity", "acceleration"),
        ("angular_velocity", "angular_acceleration"),
    ):
        values = motion[of].values
        found = (values[2:] - values[:-2]) / (time[2:] - time[:-2])[:, None]
        size = np.abs(motion[rate].values).max()
        np.testing.assert_allclose(found, motion[rate].values[inner], rtol=0.0, atol=1e-5 * size)
    turn = Rotation.from_quat(motion["attitude"].values)
    found = (turn[2:] * turn[:-2].inv()).as_rotvec() / (time[2:] - time[:-2])[:, None]
    rate = motion["angular_velocity"].values[inner]
    np.testing.assert_allclose(found, rate, rtol=0.0, atol=1e-4 * np.abs(rate).max())


def test_the_deviation_of_the_base_is_the_one_that_is_known(runs):
    ideal, planar = runs
    known, found = deviation(planar, ideal).data, body_deviation(planar, ideal, "body")
    assert list(found["time"].values) == list(known["time"].values)
    for name in ("attitude", *QUANTITIES):
        size = float(np.abs(known[f"base_{name}"]).max())
        assert size > 0.0
        np.testing.assert_allclose(found[name], known[f"base_{name}"], rtol=0.0, atol=1e-9 * size + 1e-14)


def test_a_joint_s_body_is_the_one_it_moves(runs):
    assert [moved_body(runs[1], joint) for joint in ("joint1", "joint2")] == ["shaft1", "shaft2"]
    with pytest.raises(UnknownNameError, match="joint3"):
        moved_body(runs[1], "joint3")
    with pytest.raises(UnknownNameError, match="shaft3"):
        body_motion(runs[1], "shaft3")


def test_a_run_with_contact_is_nothing_to_compare_with(runs):
    ideal, planar = runs
    with pytest.raises(InvalidParameterError, match="a run without contacts"):
        body_deviation(ideal, planar, "shaft2")
