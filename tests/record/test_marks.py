"""Marks beside the bodies: each where the result has it, shown when the result says so."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_poses
from antenna_pin.show.record import record
from antenna_pin.studies.linear import modes, swing

from .conftest import doubles, floats, placed, shapes_in


def listed(recording, begins):
    return next(fact for fact in recording.data["facts"] if fact["text"].startswith(begins))


@pytest.fixture(scope="module")
def array_run():
    return simulate(load_scenario("solar_array"), duration=0.05)


def test_stops_and_latches_are_shown_by_their_modes(array_run):
    """Of the two parts in one place that is seen whose colour says what the recorded mode is."""
    recording = record(array_run)
    (actor,) = recording.data["actors"]
    shown = {track["path"]: track["data"] for track in actor["tracks"] if track["kind"] == "shown"}
    modes = array_run.data["element_mode"].sel(element="stops.second").values[recording.frames.indices]
    times = array_run.data["time"].values[recording.frames.indices]
    assert {0, 2} <= set(modes)
    for colour, wanted in (("4D5866", modes != 2), ("D55E00", modes == 2)):
        (path,) = (one for one in shown if one.endswith(f"stops.second upper/{colour}"))
        changes = doubles(shown[path])
        assert np.array_equal(np.searchsorted(changes, times, side="right") % 2 == 1, wanted)


def test_a_pointer_reaches_to_the_stops_and_hides_none(array_run):
    """It ends in the middle of a wedge, and is thinner than that each way: of both some is seen."""
    recording = record(array_run)
    shapes, scene = shapes_in(recording), placed(recording)
    (pointer,) = (path for path in shapes if path.endswith("pointer root"))
    wedges = [path for path in shapes if "stops.root " in path]
    assert len(wedges) == 4  # lower and upper, each in two colours
    size = "width", "height", "depth"
    along, *across = (shapes[pointer][name] for name in size)
    (joint,) = (path for path in listed(recording, "joints")["paths"] if path.endswith(" root"))
    for path in wedges:
        far = np.linalg.norm(scene[path][:3, 3] - scene[joint][:3, 3])
        assert far == pytest.approx(along, rel=1e-9)
        assert max(across) < min(shapes[path][name] for name in size)


def test_joints_springs_and_frames_are_where_they_are(array_run):
    recording = record(array_run)
    scene = placed(recording)
    joints = listed(recording, "joints")
    assert joints["shown"] is False and len(joints["paths"]) == 4
    for path in joints["paths"]:
        # meshcat's cylinders lie along y; the hinges are along y of frames that are all parallel.
        assert abs(scene[path][:3, 1]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
    assert {label["text"] for label in joints["labels"]} == {"root", "first", "second", "third"}
    springs = listed(recording, "springs")
    for path in springs["paths"]:
        name = path.rpartition(" ")[2]
        (joint,) = (one for one in joints["paths"] if one.endswith(f" {name}"))
        aside = scene[path][:3, 3] - scene[joint][:3, 3]
        assert aside[[0, 2]] == pytest.approx(0.0, abs=1e-12) and abs(aside[1]) > 0.0  # along the axis
    frames = listed(recording, "frames")
    assert frames["paths"] == [f"{body['path']}/frame" for body in recording.data["bodies"]]
    for path in frames["paths"]:
        for k, axis in enumerate("xyz"):
            middle = scene[f"{path}/{axis}"][:3, 3]
            assert middle / np.linalg.norm(middle) == pytest.approx(np.eye(3)[k], abs=1e-15)


def test_bodies_hang_on_one_another_as_in_the_urdf(array_run):
    found = {body["name"]: body["parent"] for body in record(array_run).data["bodies"]}
    assert found == {"bus": None, "yoke": "bus", "inner": "yoke", "middle": "inner", "outer": "middle"}


URDF = """<robot name="swing">
<link name="post"/>
<link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="1"/>
<inertia ixx="0.01" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="pin" type="continuous"><parent link="post"/><child link="arm"/><axis xyz="0 -1 0"/></joint>
</robot>
"""
SCENARIO = """format = 1
title = "a bar on a spring"
duration = "0.4 s"
[mechanism]
urdf = "swing.urdf"
base = "fixed"
gravity = [0.0, 0.0, -9.8]
[springs.string]
stiffness = "200 N/m"
free_length = "0.4 m"
first = {link = "world", point = [0.3, 0.1, 0.9]}
second = {link = "arm", point = [0.8, 0.0, 0.02]}
"""


def test_a_spring_between_points_goes_from_one_to_the_other(tmp_path):
    """Its ends, z = 0 and 1 of what is drawn, at every key frame; across it is as thick as it was."""
    (tmp_path / "swing.urdf").write_text(URDF)
    (tmp_path / "swing.toml").write_text(SCENARIO)
    run = simulate(load_scenario(tmp_path / "swing.toml"))
    recording = record(run)
    (track,) = (one for one in recording.data["actors"][0]["tracks"] if one["name"] == "spring string")
    drawn = floats(track["data"], 12).reshape(-1, 3, 4)
    pose = body_poses(run, times=recording.frames.indices).sel(body="arm")
    end = pose["position"].values + Rotation.from_quat(pose["attitude"].values).apply([0.8, 0.0, 0.02])
    assert np.ptp(end, axis=0).max() > 0.05
    assert drawn[:, :, 3] == pytest.approx(np.tile([0.3, 0.1, 0.9], (len(end), 1)), abs=1e-6)  # 32-bit floats
    assert drawn[:, :, 3] + drawn[:, :, 2] == pytest.approx(end, abs=1e-6)
    across = drawn[:, :, :2]
    assert np.einsum("tik,til->tkl", across, across) == pytest.approx(
        np.tile(np.eye(2), (len(end), 1, 1)), abs=1e-6
    )
    assert np.einsum("tik,ti->tk", across, drawn[:, :, 2]) == pytest.approx(0.0, abs=1e-6)


def test_a_mode_shape_is_drawn_with_stops_and_latches_as_they_are_in_its_state(array_run):
    """Small motions change no mode: a shape has that of the state all along, in which the run ended."""
    swings = swing(modes(array_run), 9)
    now = array_run.data["element_mode"].isel(time=-1)
    assert now.values.any()
    for place in map(str, swings.data["element"].values):
        assert set(swings.data["element_mode"].sel(element=place).values) == {int(now.sel(element=place))}
    assert listed(record(swings), "stops")["paths"]
