"""How long a run spent in each contact scenario, against the contacts' own start and end times."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import scenario_shares
from antenna_pin.errors import FileFormatError


def touching_time(run, contact):
    """Time in which a contact touches [s], from its episodes."""
    data = run.data
    mine = data["episode_contact"].values == list(data["contact"].values).index(contact)
    ends = np.nan_to_num(data["release_time"].values[mine], nan=float(data["time"].values[-1]))
    return float((ends - data["onset_time"].values[mine]).sum())


def impacts(case):
    """Five impacts of two free bodies, none at an output time."""
    return simulate(load_scenario("impact_pair", case=case, overrides=["output.rate=9700"]))


@pytest.fixture(scope="module")
def antenna():
    overrides = ["clearance.elevation.geometry=closed-form"]
    return simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.5)


def test_one_contact_takes_the_share_of_its_episodes():
    """Ten contact changes; the share is a sum of the very times they are located at."""
    for case, pair in (("planar", ("one_point", "none")), ("flange", ("none", "surface"))):
        run = impacts(case)
        share = scenario_shares(run).sel(clearance_joint="bore")
        names = {"planar": ["bore.radial"], "flange": ["bore.axial+", "bore.axial-"]}[case]
        touching = sum(touching_time(run, name) for name in names) / 20e-3
        assert 0.05 < touching < 0.5
        assert float(share.sel(radial=pair[0], axial=pair[1])) == pytest.approx(touching, rel=1e-12)
        assert float(share.sel(radial="none", axial="none")) == pytest.approx(1.0 - touching, rel=1e-12)


def test_both_ends_at_once_are_a_line():
    run = impacts("contact")
    share = scenario_shares(run).sel(clearance_joint="bore")
    touching = touching_time(run, "bore.radial+") / 20e-3
    assert touching_time(run, "bore.radial-") == pytest.approx(touching_time(run, "bore.radial+"), rel=1e-12)
    assert float(share.sel(radial="line", axial="none")) == pytest.approx(touching, rel=1e-12)
    assert float(share.sum()) == pytest.approx(1.0, rel=1e-12)


def test_shares_of_the_antenna(antenna):
    """What the located contacts say exactly is met exactly: no contact, and how many ends touch."""
    share = scenario_shares(antenna)
    assert share.dims == ("clearance_joint", "radial", "axial")
    assert share.attrs["units"] == "1"
    share = share.sel(clearance_joint="elevation")
    assert float(share.sum()) == pytest.approx(1.0, rel=1e-12)
    time = antenna.data["time"].values
    span = np.diff(time) / time[-1]
    touching = antenna.data["touching"].values[:-1]
    for kind, dim, columns in (("radial", "axial", [0, 1]), ("axial", "radial", [2, 3])):
        count = touching[:, columns].sum(axis=1)
        own = share.sum(dim)
        assert float(own.sel({kind: "none"})) == pytest.approx(span[count == 0].sum(), rel=1e-12)
    ends = share.sum("axial")
    both = span[touching[:, :2].sum(axis=1) == 2].sum()
    assert float(ends.sel(radial="one_point")) > 0.0
    # One end's and both ends' times change at located instants, too.
    assert float(ends.sel(radial=["two_points", "line"]).sum()) == pytest.approx(both, rel=1e-12)
    # The antenna's flanges cannot both touch: docs/contact-scenarios.md.
    assert float(share.sel(axial="two_points").sum()) == 0.0


def test_a_spherical_joint_has_no_axial_contact():
    run = simulate(load_scenario("spherical_pendulum", case="floating"), duration=0.1)
    share = scenario_shares(run)
    assert list(share["clearance_joint"].values) == ["upper", "lower"]
    for joint in ("upper", "lower"):
        own = share.sel(clearance_joint=joint)
        touching = touching_time(run, f"{joint}.spherical") / 0.1
        assert float(own.sel(radial="one_point", axial="none")) == pytest.approx(touching, rel=1e-12)


def test_a_run_without_clearance_has_no_shares():
    run = simulate(load_scenario("pendulum", case="ideal"), duration=0.01)
    assert scenario_shares(run).sizes["clearance_joint"] == 0


def samples(time, radial, touching):
    """Data of a joint with four contacts, its flanges free."""
    n = len(time)
    joint = ("time", "clearance_joint")
    return xr.Dataset(
        {
            "radial_scenario": (joint, np.array(radial).reshape(n, 1)),
            "axial_scenario": (joint, np.zeros((n, 1), dtype=int)),
            "touching": (("time", "contact"), np.hstack([np.array(touching), np.zeros((n, 2), dtype=int)])),
        },
        coords={
            "time": time,
            "clearance_joint": ["a.b"],
            "contact": ["a.b.radial+", "a.b.radial-", "a.b.axial+", "a.b.axial-"],
            "contact_joint": ("contact", ["a.b"] * 4),
            "contact_kind": ("contact", ["radial", "radial", "axial", "axial"]),
        },
    )


def test_time_between_samples_goes_to_what_is_seen_at_its_ends():
    """Uneven samples, by hand."""
    # One end from 1 s on, both from 3 s to 6 s, first two points (seen at 4 s) and then a line (at 5 s).
    data = samples(
        time=[0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0],
        radial=[0, 0, 1, 1, 2, 3, 1, 1],
        touching=[[0, 0], [1, 0], [1, 0], [1, 1], [1, 1], [1, 1], [0, 1], [0, 1]],
    )
    share = 8.0 * scenario_shares(data).sel(clearance_joint="a.b", axial="none")
    assert share.sel(radial="none") == 1.0
    assert share.sel(radial="one_point") == 4.0
    assert share.sel(radial="two_points") == 1.5
    assert share.sel(radial="line") == 1.5
    data = samples(time=[0.0, 1.0, 3.0, 4.0], radial=[0, 0, 0, 0], touching=[[0, 0], [1, 1], [0, 0], [0, 0]])
    share = scenario_shares(data).sel(clearance_joint="a.b", axial="none")
    assert share.sel(radial="two_points") == 0.5
    data = samples(time=[0.0, 1.0], radial=[0, 0], touching=[[0, 0], [0, 0]]).drop_vars("touching")
    with pytest.raises(FileFormatError, match="touching"):
        scenario_shares(data)
