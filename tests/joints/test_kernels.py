"""Kernels of joints with play one by one: virtual work, and rates of change along a motion."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from plain_kernels import inner, plain

from antenna_pin.base.records import CONTACT, POSE
from antenna_pin.joints import motion_change_kernels, slope_kernels
from antenna_pin.joints.kernels import unit_normal_force
from antenna_pin.joints.layout_kernels import joint_at
from antenna_pin.joints.motion_change_kernels import change_pose
from antenna_pin.joints.pose_kernels import journal_state
from antenna_pin.joints.row_kernels import row_rates
from antenna_pin.mechanism import frame_aligning_z

AXIS = np.array([0.6, -0.48, 0.64])
PLACES = [("revolute", "parent"), ("revolute", "child"), ("planar", "parent"), ("planar", "child")]


def located(joint_maker, geometry, bearing_on, seed):
    """Return a joint's block, its configuration and twist, and its pose: turned far, off its centre."""
    rng = np.random.default_rng(seed)
    joint = joint_maker(geometry, bearing_on=bearing_on, offset=0.0 if geometry == "planar" else 0.2)
    axis = np.array([0.0, 0.0, 1.0]) if joint.planar else AXIS
    block = joint.block(frame_aligning_z(axis), axis, 0, 0, 0, 0)
    if joint.planar:
        q = np.array([*rng.normal(size=2), np.cos(2.0), np.sin(2.0)])
    else:
        q = np.array([*rng.normal(size=3), *pin.Quaternion(pin.exp3(rng.normal(size=3))).coeffs()])
    v = rng.normal(size=3 if joint.planar else 6)
    return block, q, v, pose_at(block, q, v)


def pose_at(block, q, v):
    pose = np.zeros(1, POSE)
    plain(journal_state)(joint_at(block, 0), np.concatenate([q, v]), len(q), pose[0])
    return pose


def displaced(q, way):
    """Return a configuration moved by a small displacement in the child's own axes."""
    if len(q) == 4:
        turn = np.arctan2(q[3], q[2])
        moved = pin.SE3(pin.exp3(np.array([0.0, 0.0, turn])), np.array([q[0], q[1], 0.0]))
        moved = moved * pin.exp6(np.array([way[0], way[1], 0.0, 0.0, 0.0, way[2]]))
        angle = np.arctan2(moved.rotation[1, 0], moved.rotation[0, 0])
        return np.array([*moved.translation[:2], np.cos(angle), np.sin(angle)])
    moved = pin.XYZQUATToSE3(q) * pin.exp6(way)
    return pin.SE3ToXYZQUAT(moved)


@pytest.mark.parametrize(("geometry", "bearing_on"), PLACES)
def test_a_unit_normal_force_has_the_power_of_the_opening_speed(joint_maker, geometry, bearing_on):
    """Virtual work at a point anywhere: generalized force times twist is how fast the points part there."""
    rng = np.random.default_rng(1)
    for seed in range(3):
        block, _, v, pose = located(joint_maker, geometry, bearing_on, seed)
        table, tau = np.zeros(4, CONTACT), np.zeros(len(v))
        normal, point = rng.normal(size=(2, 3))
        if len(v) == 3:
            normal[2] = point[2] = 0.0
        table["normal"][2], table["point"][2] = normal / np.linalg.norm(normal), point
        plain(row_rates)(pose[0], table[2])
        plain(unit_normal_force)(block, 0, pose, table, 2, tau)
        assert tau @ v == pytest.approx(-table["rate"][2], rel=1e-13, abs=1e-13)


@pytest.mark.parametrize(("geometry", "bearing_on"), PLACES)
def test_a_pose_changes_along_a_displacement_as_its_differences_do(joint_maker, geometry, bearing_on):
    """Of all that a pose says, along displacements of configuration and twist: change_pose."""
    rng, h = np.random.default_rng(2), 1e-4
    block, q, v, pose = located(joint_maker, geometry, bearing_on, 5)
    n = len(v)
    way = rng.normal(size=2 * n)
    room = SimpleNamespace(
        poses=np.concatenate([pose, np.zeros(2, POSE)]),
        tau=np.zeros(n),
        carried=np.zeros(6),
        shifts=SimpleNamespace(steps=np.zeros(0)),
        first_number=np.zeros(1, dtype=np.int64),
        seen=np.zeros(0, dtype=np.int64),
    )
    plain(change_pose)(block, 0, np.concatenate([q, v]), way, room)
    moved = {k: pose_at(block, displaced(q, k * h * way[:n]), v + k * h * way[n:]) for k in (-2, -1, 1, 2)}
    for name in ("centre", "axis", "sine", "rotation", "velocity", "spin"):
        slope = 8.0 * (moved[1][name] - moved[-1][name]) - (moved[2][name] - moved[-2][name])
        # Of fourth order: h^4, and round-off over h.
        assert room.poses[name][1] == pytest.approx(slope[0] / (12.0 * h), abs=1e-10), name


def test_steps_of_differences_of_laws_go_with_the_units_of_speed(joint_maker):
    """Depth rates and slips are displaced by a small share of the joint's unit of speed, or of the rate."""
    block = joint_maker().block(np.eye(3), (0.0, 0.0, 0.0), 0, 0, 0, 0)
    step = inner(slope_kernels, "_first_step")

    def steps(unit, rate):
        asked = np.zeros(20)
        asked[slope_kernels.A_RATE] = rate
        room = SimpleNamespace(asked=asked, units=np.full(12, unit), tau=np.zeros(6))
        return np.array([step(block, 0, 0, i, room) for i in (slope_kernels.A_RATE, slope_kernels.A_SLIP)])

    slow = steps(1e-5, 0.0)
    assert (slow < 0.1 * 1e-5).all() and (slow > 0.0).all()
    assert steps(1e-2, 0.0) == pytest.approx(1e3 * slow, rel=1e-14)
    assert steps(1e-5, -1e-2) == pytest.approx([1e3, 1.0] * slow, rel=1e-14)


def test_a_twist_is_the_transpose_of_a_wrench(joint_maker):
    """The journal's velocity that a joint's own makes does the work of what the wrench does along it."""
    rng = np.random.default_rng(4)
    for geometry, bearing_on in PLACES:
        block, _, v, pose = located(joint_maker, geometry, bearing_on, 6)
        force, moment, tau = rng.normal(size=3), rng.normal(size=3), np.zeros(len(v))
        found = inner(motion_change_kernels, "_twist")(joint_at(block, 0), pose[0], v, 0)
        plain(motion_change_kernels.onto_joint)(joint_at(block, 0), pose[0], force, moment, tau)
        assert tau @ v == pytest.approx(force @ found[:3] + moment @ found[3:], rel=1e-13), geometry
