"""Poses of bodies and loads of joints, from what a result carries."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import Trajectory, load_scenario, simulate
from antenna_pin.analysis import body_poses, joint_loads
from antenna_pin.errors import FileFormatError

# Scenario, case, duration: journals that move in a bearing off the joint's origin, in a plane, in a socket.
RUNS = {
    "revolute": ("bai2020", "case3", 0.03, {"clearance.elevation.offset": "5 mm"}),
    "planar": ("bai2020", "case2-planar", 0.12, {}),
    "spherical": ("spherical_pendulum", "spatial", 0.03, {}),
}


@pytest.fixture(scope="module")
def runs():
    found = {}
    for kind, (name, case, duration, changes) in RUNS.items():
        scenario = load_scenario(name, case=case, overrides=changes)
        for joint in scenario.clearance:
            scenario = scenario.with_overrides({f"clearance.{joint}.geometry": "closed-form"})
        found[kind] = simulate(scenario, duration=duration)
    return found


def compose(position, attitude, seven):
    """Return a frame's pose in the world, from its link's and its place in the link."""
    turn = Rotation.from_quat(attitude)
    return position + turn.apply(seven[:3]), turn * Rotation.from_quat(seven[3:])


@pytest.mark.parametrize("kind", RUNS)
def test_the_journal_is_where_bodies_and_joint_say(runs, kind):
    """Bearing's body, bearing, journal in it; and journal's body, journal: two ways to one pose."""
    data = runs[kind].data
    bodies = body_poses(data)
    for joint, place in json.loads(data.attrs["clearance_joints"]).items():
        assert place["kind"] == kind
        ends = {
            side: compose(
                bodies["position"].sel(body=place[f"{side}_body"]).values,
                bodies["attitude"].sel(body=place[f"{side}_body"]).values,
                np.array(place[f"{side}_placement"]),
            )
            for side in ("bearing", "journal")
        }
        origin, axes = ends["bearing"]
        p = data["journal_position"].sel(clearance_joint=joint).values
        turn = axes * Rotation.from_quat(data["journal_attitude"].sel(clearance_joint=joint).values)
        # Round-off of positions of a metre or two.
        np.testing.assert_allclose(origin + axes.apply(p), ends["journal"][0], atol=1e-14)
        assert (turn.inv() * ends["journal"][1]).magnitude().max() < 1e-14
        # It moves, or nothing was shown.
        assert np.ptp(p, axis=0).max() > 1e-6


@pytest.mark.parametrize("kind", RUNS)
def test_what_passes_through_a_joint_with_play_is_its_contact_force(runs, kind):
    """The bodies beyond the joint are moved by its contacts; motors there are torques only."""
    data = runs[kind].data
    bodies, loads = body_poses(data), joint_loads(data)
    for joint, place in json.loads(data.attrs["clearance_joints"]).items():
        _, axes = compose(
            bodies["position"].sel(body=place["bearing_body"]).values,
            bodies["attitude"].sel(body=place["bearing_body"]).values,
            np.array(place["bearing_placement"]),
        )
        passed = axes.inv().apply(loads["force"].sel(moving_joint=joint).values)
        contact = data["joint_force"].sel(clearance_joint=joint).values
        if kind == "planar":  # the plane itself carries what is across it
            passed, contact = passed[:, :2], contact[:, :2]
        largest = np.abs(contact).max()
        assert largest > 10.0
        # Round-off of a mass matrix whose bodies differ by 2400 to 5 kg.
        np.testing.assert_allclose(passed, contact, atol=1e-10 * largest)


def test_an_ideal_joint_carries_the_same_by_tree_and_by_constraint():
    """The hinge's reaction follows from the motion alone, whatever computed that."""
    loads = [
        joint_loads(simulate(load_scenario("bai2020", case=case), duration=0.05))
        for case in ("case1", "case1-constraint")
    ]
    for name in ("force", "torque"):
        tree, constraint = (load[name].sel(moving_joint="elevation").values for load in loads)
        # Both integrate at rtol 1e-8; the reaction depends smoothly on the state.
        np.testing.assert_allclose(constraint, tree, atol=1e-7 * np.abs(tree).max())
        assert np.abs(tree).max() > 1.0


def test_a_picked_sample_is_the_same_sample(runs):
    data = runs["revolute"].data
    some = [0, 7, data.sizes["time"] - 1]
    for call in (body_poses, joint_loads):
        whole, part = call(data).isel(time=some), call(data, times=some)
        for name in whole.data_vars:
            assert np.array_equal(whole[name], part[name])


def test_data_without_a_mechanism_is_refused(runs):
    data = runs["revolute"].data.copy()
    del data.attrs["urdf"]
    with pytest.raises(FileFormatError, match="must contain its mechanism"):
        body_poses(data)


def test_bodies_survive_the_file(runs, tmp_path):
    run = runs["planar"]
    again = Trajectory.load(run.save(tmp_path / "run.nc"))
    assert np.array_equal(body_poses(again)["attitude"], body_poses(run)["attitude"])
