"""The table of impacts, against the closed forms of an impact and the ledgers of a run."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import impact_statistics, impacts
from antenna_pin.errors import FileFormatError, UnknownNameError


def delivered(asked):
    """Restitution of Lankarani and Nikravesh's law: chi (1 + c) = ln[(1 + chi)/(1 - chi c)]."""
    chi = 0.75 * (1.0 - asked**2)
    return brentq(lambda c: chi * (1 + c) - math.log((1 + chi) / (1 - chi * c)), 1e-6, 1 - 1e-12)


@pytest.fixture(scope="module", params=["planar", "contact", "flange", "spherical"])
def pair(request):
    overrides = ["clearance.bore.geometry=closed-form"]
    return request.param, simulate(load_scenario("impact_pair", case=request.param, overrides=overrides))


def test_restitution_is_the_laws_own(pair):
    """Two free bodies: nothing but the law decides. The run's tolerance is 1e-10."""
    case, run = pair
    table = impacts(run)
    ended = table["ended"].values
    assert table.sizes["impact"] == (10 if case == "contact" else 5)
    assert table["restitution"].values[ended] == pytest.approx(np.full(ended.sum(), delivered(0.7)), rel=1e-7)
    assert not table["floored"].any()


def test_what_is_lost_is_kinetic_energy(pair):
    """Reduced mass 1.2 kg: half m (v^2 - v'^2), shared by the contacts that meet at once."""
    case, run = pair
    table = impacts(run)
    table = table.isel(impact=np.flatnonzero(table["ended"].values))
    share = 0.6 if case == "contact" else 1.2
    speeds = table["approach_speed"].values, table["separation_speed"].values
    lost = 0.5 * share * (speeds[0] ** 2 - speeds[1] ** 2)
    assert table["dissipated"].values == pytest.approx(lost, rel=1e-6)
    assert table["impulse"].values == pytest.approx(share * (speeds[0] + speeds[1]), rel=1e-7)
    kinetic = run.data["kinetic_energy"].values
    assert table["dissipated"].sum() == pytest.approx(kinetic[0] - kinetic[-1], rel=1e-7)


def test_rows_are_in_order_and_labelled(pair):
    case, run = pair
    table = impacts(run)
    assert (np.diff(table["onset"]) >= 0.0).all()
    assert set(table["clearance_joint"].values) == {"bore"}
    assert all(name.startswith("bore.") for name in table["contact"].values)
    since = table["peak_time"] - table["onset"]
    assert ((since > 0.0) & (since < table["duration"])).all()
    for name in table.data_vars:
        assert table[name].attrs["units"]
        assert table[name].attrs["long_name"]


def test_a_pendulum_at_rest_is_one_touch_without_end():
    run = simulate(load_scenario("pendulum", case="planar-rest"), duration=0.02)
    table = impacts(run, "hinge")
    assert table.sizes["impact"] == 1
    assert not table["ended"].item()
    # Laid into the bore at rest, it meets it without speed: the law sees its floor.
    assert table["floored"].item()
    assert table["approach_speed"].item() == pytest.approx(0.0, abs=1e-9)
    assert math.isnan(table["restitution"].item())
    assert math.isnan(table["separation_speed"].item())
    assert table["duration"].item() == pytest.approx(0.02, rel=1e-12)
    whole = float(run.data["normal_impulse"].values[-1].sum())
    assert table["impulse"].item() == pytest.approx(whole, rel=1e-12)


def test_statistics_are_of_each_contact(pair):
    case, run = pair
    table = impacts(run)
    found = impact_statistics(table)
    assert list(found["contact"].values) == sorted(set(table["contact"].values))
    assert found["impacts"].sum() == table.sizes["impact"]
    assert found["touching"].sum() == 0
    assert found["median_restitution"].values == pytest.approx(delivered(0.7), rel=1e-7)
    assert found["dissipated"].sum() == pytest.approx(float(table["dissipated"].sum()), rel=1e-12)
    assert found["largest_approach_speed"].max() == table["approach_speed"].max()
    none = impact_statistics(table.isel(impact=slice(0, 0)))
    assert none.sizes["contact"] == 0
    assert none["peak_force"].attrs["units"] == "N"


def test_a_run_may_have_no_impacts():
    """Without clearance, or cut off at once."""
    run = simulate(load_scenario("pendulum", case="ideal"), duration=0.01)
    table = impacts(run)
    assert table.sizes["impact"] == 0
    assert table["restitution"].attrs["units"] == "1"
    with pytest.raises(UnknownNameError, match="clearance joint 'hinge' is unknown"):
        impacts(run, "hinge")
    run = simulate(load_scenario("impact_pair"), duration=1e-4)
    assert impacts(run.data.isel(time=[0])).sizes["impact"] == 0


def test_samples_thinned_out_are_refused(pair):
    _, run = pair
    with pytest.raises(FileFormatError, match="no samples at its contact events"):
        impacts(run.data.isel(time=slice(0, 1)))
    with pytest.raises(FileFormatError, match="no variable 'depth_rate'"):
        impacts(run.data.drop_vars("depth_rate"))


@pytest.mark.parametrize("later", [1.0, 1e4, -1e6])
def test_impacts_long_after_time_zero_are_found_by_times_that_are_rounded(pair, later):
    """An instant and its sample are off by round-off of the time, which grows with it."""
    _, run = pair
    moved = {name: run.data[name] + later for name in ("onset_time", "release_time", "peak_time")}
    off = 2.0 * math.ulp(later)
    moved["onset_time"] = moved["onset_time"] + off * (-1.0) ** np.arange(run.data.sizes["episode"])
    data = run.data.assign(moved).assign_coords(time=run.data["time"] + later)
    table, here = impacts(data), impacts(run)
    # Two ends that meet at once, at speeds that are the same to 1e-9, may be told in the other order.
    assert table["approach_speed"].values == pytest.approx(here["approach_speed"].values, rel=1e-8)
    # Durations are of a hundredth of a second.
    assert table["duration"].values == pytest.approx(here["duration"].values, abs=4.0 * off)
