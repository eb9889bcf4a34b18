"""Marks of closures: each at its place on its link, none for a joint of the tree that is held."""

import numpy as np
import pytest
from driven_four_bar import write_driven_four_bar
from scipy.spatial.transform import Rotation
from single_loops import bricard

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_poses, closures_of
from antenna_pin.show.record import record

from .conftest import placed


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return write_driven_four_bar(tmp_path_factory.mktemp("driven"))


def marks(recording):
    """Return the placements of all marks, (4, 4), by the paths that the player lists."""
    fact = next((fact for fact in recording.data["facts"] if "closure" in fact["text"]), None)
    return {} if fact is None else {name: placed(recording)[name] for name in fact["paths"]}


def test_a_mark_is_where_both_links_meet(path):
    run = simulate(load_scenario(path, case="ideal"), duration=0.02)
    ((name, placed),) = marks(record(run)).items()
    assert name.endswith("/closure rocker_pin")
    poses = body_poses(run, times=[0, -1])
    closure = closures_of(run)["rocker_pin"]
    ends = []
    for body, point in (("rocker", placed[:3, 3]), ("coupler", closure["first_placement"][:3])):
        turn = Rotation.from_quat(poses["attitude"].sel(body=body).values)
        ends.append(poses["position"].sel(body=body).values + turn.apply(point))
    # Loops are closed to round-off of half a metre.
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-14)
    # meshcat's cylinders lie along y, and the pin along the joint's axis, which is -y of the link.
    assert abs(placed[:3, 1]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)


def test_a_joint_of_the_tree_that_is_held_has_no_mark(path):
    run = simulate(load_scenario(path, case="held"), duration=0.01)
    assert len(closures_of(run)) == 2
    assert [name.rpartition(" ")[2] for name in marks(record(run))] == ["rocker_pin"]


def test_a_closure_with_the_world_is_marked_on_its_link(tmp_path):
    loop = bricard()
    (tmp_path / "loop.urdf").write_text(loop.urdf)
    (tmp_path / "bricard.toml").write_text(loop.scenario)
    run = simulate(load_scenario(tmp_path / "bricard.toml"), duration=0.01)
    ((name, placed),) = marks(record(run)).items()
    bodies = [str(body) for body in body_poses(run, times=[0])["body"].values]
    assert name == f"run/{bodies.index('bar_5')}/closure pin_6"
    assert placed[:3, 3] == pytest.approx([0.0, 1.0, 0.0])


def test_a_tree_has_no_marks(planar_run):
    assert marks(record(planar_run)) == {}
