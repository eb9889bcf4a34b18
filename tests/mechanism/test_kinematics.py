"""Poses, twists and accelerations of links over many configurations, by Pinocchio and by differences."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin.errors import InvalidParameterError
from antenna_pin.mechanism import build_mechanism, kinematics, link_poses, link_twists

STEP = 1e-4  # between configurations [s]


@pytest.fixture
def mechanism(crooked):
    return build_mechanism(crooked, base="free")


@pytest.fixture
def course(mechanism):
    """A motion at constant rates in the axes that move: times, configurations, velocities."""
    model, random = mechanism.model, np.random.default_rng(2)
    v = random.normal(size=model.nv)
    begin = pin.integrate(model, pin.neutral(model), random.normal(size=model.nv))
    time = STEP * np.arange(-1, 2)
    return np.array([pin.integrate(model, begin, t * v) for t in time]), np.array([v, v, v])


def test_poses_are_those_of_every_frame(mechanism):
    model, random = mechanism.model, np.random.default_rng(1)
    q = np.array([pin.randomConfiguration(model, -np.ones(model.nq), np.ones(model.nq)) for _ in range(6)])
    names = [link.name for link in mechanism.urdf.robot.links]
    positions, attitudes = link_poses(mechanism, q)
    assert positions.shape == (6, len(names), 3) and attitudes.shape == (6, len(names), 4)
    data = model.createData()
    for row, position, attitude in zip(q, positions, attitudes, strict=True):
        pin.framesForwardKinematics(model, data, row)
        for k, name in enumerate(names):
            frame = data.oMf[mechanism.frame(name)]
            assert position[k] == pytest.approx(frame.translation, abs=1e-14)
            assert Rotation.from_quat(attitude[k]).as_matrix() == pytest.approx(frame.rotation, abs=1e-14)
    some = random.permutation(names)[:3].tolist()
    places = [names.index(name) for name in some]
    few = link_poses(mechanism, q, some)
    assert np.array_equal(few[0], positions[:, places])
    assert np.array_equal(np.abs(few[1]), np.abs(attitudes[:, places]))


def test_quaternions_of_three_turns_do_not_jump(mechanism, monkeypatch):
    """Nor between the parts in which configurations are taken: each turn passes -1 once."""
    model = mechanism.model
    slot, count = mechanism.joint("swivel"), 200
    v = np.zeros((count, model.nv))
    v[:, slot.v] = np.linspace(0.0, 6.0 * np.pi, count)[:, None]
    q = np.array([pin.integrate(model, pin.neutral(model), one) for one in v])
    whole = link_poses(mechanism, q)
    monkeypatch.setattr(kinematics, "_AT_ONCE", 7)
    in_parts = link_poses(mechanism, q)
    assert np.array_equal(whole[0], in_parts[0]) and np.array_equal(whole[1], in_parts[1])
    # Half the angle from one to the next, of an axis of length 1.
    apart = np.linalg.norm(np.diff(whole[1], axis=0), axis=2).max()
    assert apart == pytest.approx(2.0 * np.sin(0.25 * 6.0 * np.pi / (count - 1)), rel=1e-9)


def test_twists_are_the_rates_of_poses(mechanism, course):
    q, v = course
    positions, attitudes = link_poses(mechanism, q)
    twists = link_twists(mechanism, q, v)
    assert twists.shape == (3, positions.shape[1], 6)
    for k in range(positions.shape[1]):
        before, now, after = Rotation.from_quat(attitudes[:, k])
        linear = now.inv().apply((positions[2, k] - positions[0, k]) / (2.0 * STEP))
        angular = (before.inv() * after).as_rotvec() / (2.0 * STEP)
        # Central differences: a sixth of STEP^2 times third derivatives of some 10^2.
        assert twists[1, k] == pytest.approx([*linear, *angular], abs=1e-6)


def test_a_link_moves_by_its_twist_in_world_axes(mechanism, course):
    """Its acceleration is the rate of its velocity: rates of coordinates are constant here."""
    q, v = course
    attitudes, motion = kinematics.link_motion(mechanism, "tip", q, v, np.zeros_like(v))
    twists = link_twists(mechanism, q, v, ["tip"])[:, 0]
    for turn, row, twist in zip(attitudes, motion, twists, strict=True):
        assert row[1] == pytest.approx(turn @ twist[:3], abs=1e-13)
        assert row[2] == pytest.approx(turn @ twist[3:], abs=1e-13)
    assert motion[:, 0] == pytest.approx(link_poses(mechanism, q, ["tip"])[0][:, 0], abs=1e-15)
    for rate, of in ((3, 1), (4, 2)):
        differences = (motion[2, of] - motion[0, of]) / (2.0 * STEP)
        assert motion[1, rate] == pytest.approx(differences, abs=1e-5)


@pytest.mark.parametrize("q", [np.zeros(3), np.zeros((2, 3)), np.zeros((1, 2, 3))])
def test_configurations_of_another_shape_are_refused(mechanism, q):
    rule = rf"link_poses: q must be of shape \(n, {mechanism.model.nq}\), got"
    with pytest.raises(InvalidParameterError, match=rule):
        link_poses(mechanism, q)
