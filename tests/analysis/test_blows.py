"""Blows of a joint beside the impacts of its contacts: what an observer of the joint counts."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import blow_statistics, blows, impacts
from antenna_pin.trajectory import blow_counts, blow_numbers


def recorded(*episodes):
    """Data of a run by its contact episodes: contact, onset and release [s]."""
    names = ["a.radial+", "a.radial-", "a.axial+", "b.radial+"]
    kinds = [name.split(".")[1].rstrip("+-") for name in names]
    contact, onset, release = map(np.array, zip(*episodes, strict=True))
    return xr.Dataset(
        {
            "episode_contact": ("episode", contact),
            "onset_time": ("episode", onset),
            "release_time": ("episode", release),
        },
        coords={
            "contact": names,
            "contact_joint": ("contact", [name[0] for name in names]),
            "contact_kind": ("contact", kinds),
        },
        attrs={"end_time": 10.0},
    )


def test_episodes_of_the_same_surfaces_that_overlap_are_one_blow():
    data = recorded(
        (0, 1.0, 1.1),  # both ends at once: one blow, 0
        (1, 1.0 + 4e-16, 1.2),
        (0, 1.15, 1.3),  # the first again, while the second still touches
        (2, 1.05, 1.06),  # of other surfaces: 1
        (3, 1.05, 1.06),  # of another joint: 2
        (0, 1.3 + 1e-9, 1.4),  # apart for a nanosecond: another, 3
        (1, 1.4 + 1e-13, np.nan),  # at the instant at which the other end parts: the same
        (0, 9.0, 9.5),  # while that lasts: the same
    )
    assert blow_numbers(data).tolist() == [0, 0, 0, 1, 2, 3, 3, 3]
    assert blow_counts(data) == {"a.radial": 2, "a.axial": 1, "b.radial": 1}


def test_a_planar_motion_in_a_bore_with_two_ends_counts_each_blow_once(cli, tmp_path):
    """The two ends of a bore move alike where nothing tilts: each blow is of both."""
    changes = ["clearance.bore.geometry=closed-form"]
    ends = simulate(load_scenario("impact_pair", case="contact", overrides=changes))
    one = simulate(load_scenario("impact_pair", case="planar", overrides=changes))
    count = impacts(one).sizes["impact"]
    assert count > 2 and len(set(ends.data["contact_kind"].values.tolist())) == 2
    table, each = blows(ends), impacts(ends)
    assert each.sizes["impact"] == 2 * count and table.sizes["blow"] == count
    assert (table["contacts"].values == 2).all()
    assert float(blow_statistics(ends)["blows"][0]) == count
    assert ends.summary()["blows"]["bore.radial"] == {"blows": count}
    # Both halves of the force together are the one contact's, whose law has all of the stiffness.
    for name in ("impulse", "dissipated"):
        assert float(table[name].sum()) == pytest.approx(float(each[name].sum()), rel=1e-12)
    path = ends.save(tmp_path / "ends.nc")
    assert f"blows of bore.radial: {count}, of {2 * count} contacts" in cli("impacts", path).out
    assert cli("info", "--all", path).out.split("\n bore.radial ")[-1].split()[0] == str(count)
