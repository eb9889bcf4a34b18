"""Statistics of load, against statics, ledgers and closed forms."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import load_statistics, touching_intervals
from antenna_pin.errors import UnknownNameError

WEIGHT = 1.872 * 9.80665  # of the pendulum's bar [N]


@pytest.fixture(scope="module")
def antenna():
    overrides = ["clearance.elevation.geometry=closed-form"]
    return simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.2)


def test_a_bar_at_rest_loads_its_hinge_by_its_weight():
    """Momentum: the mean force is the weight, but for what it moved in the milliseconds of sinking in."""
    run = simulate(load_scenario("pendulum", case="planar-rest"))
    whole = load_statistics(run)
    assert whole["mean_force"].item() == pytest.approx(WEIGHT, rel=1e-4)
    assert whole["impulse"].item() == pytest.approx(WEIGHT * float(run.data["time"].values[-1]), rel=1e-4)
    assert whole["contact_share"].item() == pytest.approx(1.0, rel=1e-12)
    assert whole["joint_force_percentile"].sel(percent=50.0).item() == pytest.approx(WEIGHT, rel=1e-3)
    assert whole["episodes"].item() == 1
    assert whole["peak_force"].item() > WEIGHT


def test_statistics_of_a_single_impact_are_its_pulse():
    """Half a hertzian pulse: mean force times time is the impulse, m (v + v')."""
    run = simulate(load_scenario("impact_pair", overrides=["output.rate=100 kHz"]), duration=3e-3)
    found = load_statistics(run, "bore")
    table = run.data
    speeds = 0.1 + abs(float(table["depth_rate"].values[-1, 0]))
    assert found["impulse"].item() == pytest.approx(1.2 * speeds, rel=1e-7)
    assert found["mean_force"].item() == pytest.approx(1.2 * speeds / 3e-3, rel=1e-7)
    touched = float((table["release_time"] - table["onset_time"]).item())
    assert found["contact_share"].item() == pytest.approx(touched / 3e-3, rel=1e-9)
    assert found["mean_force_in_contact"].item() == pytest.approx(1.2 * speeds / touched, rel=1e-7)
    # Central impact without friction: the joint's force is the contact's; samples against the exact integral.
    assert found["joint_mean_force"].item() == pytest.approx(found["mean_force"].item(), rel=1e-3)
    assert found["joint_rms_force"].item() == pytest.approx(found["rms_force"].item(), rel=1e-12)
    assert found["joint_peak_force"].item() == pytest.approx(found["peak_force"].item(), rel=1e-9)
    # It never touches for most of the time.
    assert found["force_percentile"].sel(percent=50.0).item() == 0.0


def test_statistics_keep_the_ledgers(antenna):
    found = load_statistics(antenna)
    data = antenna.data
    assert found["impulse"].values == pytest.approx(data["normal_impulse"].values[-1], rel=1e-12)
    assert found["joint_impulse"].item() == pytest.approx(float(found["impulse"].sum()), rel=1e-12)
    lost = float((data["dissipation_normal"] + data["dissipation_friction"]).values[-1].sum())
    assert found["joint_dissipated"].item() == pytest.approx(lost, rel=1e-12)
    assert found["joint_episodes"].item() == data.sizes["episode"]
    never = found["episodes"].values == 0
    assert np.isnan(found["mean_force_in_contact"].values[never]).all()
    assert (found["contact_share"].values[never] == 0.0).all()
    assert (np.diff(found["force_percentile"].values, axis=1) >= 0.0).all()
    both = found["contact_share"].values
    assert both.max() <= found["joint_contact_share"].item() <= both.sum()
    for name in found.data_vars:
        assert found[name].attrs["units"]


def test_touching_is_what_the_samples_say(antenna):
    """Every onset and release is a sample, so the time in contact is a sum of steps between them."""
    data = antenna.data
    contacts = ["elevation.radial+", "elevation.radial-"]
    intervals = touching_intervals(antenna, contacts)
    assert (intervals[1:, 0] > intervals[:-1, 1]).all()
    either = data["touching"].sel(contact=contacts).values.any(axis=1)
    expected = np.diff(data["time"].values)[either[:-1]].sum()
    assert (intervals[:, 1] - intervals[:, 0]).sum() == pytest.approx(expected, rel=1e-9)
    assert touching_intervals(antenna, []).shape == (0, 2)
    with pytest.raises(UnknownNameError, match="contact 'elevation.radial' is unknown"):
        touching_intervals(antenna, ["elevation.radial"])


def test_what_is_there_of_little_is_given(antenna):
    ideal = simulate(load_scenario("pendulum", case="ideal"), duration=0.01)
    assert load_statistics(ideal).sizes["contact"] == 0
    start = load_statistics(antenna.data.isel(time=[0], episode=slice(0, 0)))
    assert (start["mean_force"].values == 0.0).all()
    assert start["joint_contact_share"].item() == 0.0
