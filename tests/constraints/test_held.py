"""A joint held by constraint is the joint of the tree, and what Pinocchio's own solver makes of it."""

import re

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import load_scenario
from antenna_pin.dynamics import JointSpring, SineDrive, System, Workspace, acceleration
from antenna_pin.errors import MechanismError, UnknownNameError
from antenna_pin.integrate import METHODS, Stepper
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.scenario.assemble import build_system

# A hinge with an oblique axis in turned frames, between bodies that are nowhere symmetric, on a slide.
CROOKED = """<robot name="crooked">
  <link name="hull"><inertial><origin xyz="0.1 -0.2 0.05" rpy="0.3 -0.4 0.5"/><mass value="50"/>
    <inertia ixx="5" iyy="6" izz="7" ixy="0.1" ixz="-0.2" iyz="0.3"/></inertial></link>
  <joint name="slide" type="prismatic"><parent link="hull"/><child link="arm"/>
    <origin xyz="0.2 0.3 0.4" rpy="0.5 -1.2 2.0"/><axis xyz="1 2 -2"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="arm"><inertial><origin xyz="0 0.3 0.1" rpy="1 0.2 0"/><mass value="3"/>
    <inertia ixx="0.2" iyy="0.05" izz="0.21" ixy="0.01" ixz="0" iyz="-0.02"/></inertial></link>
  <joint name="wrist" type="revolute"><parent link="arm"/><child link="hand"/>
    <origin xyz="0 0.6 0" rpy="-0.7 1.1 0.4"/><axis xyz="-0.3 0.1 -0.9"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
  <link name="hand"><inertial><origin xyz="0.05 0.1 0"/><mass value="1.5"/>
    <inertia ixx="0.03" iyy="0.02" izz="0.04" ixy="0" ixz="0" iyz="0.001"/></inertial></link>
</robot>"""


def antenna():
    """The antenna of Bai and Zhao with its torques: tree, constrained, name of the joint."""
    tree, held = (build_system(load_scenario("bai2020", case=c)) for c in ("case1", "case1-constraint"))
    return tree, held, "elevation"


def crooked(base):
    """With gravity, a torque and a spring at the hinge: tree, constrained, name of the joint."""
    urdf, gravity = Urdf.from_text(CROOKED, "crooked.urdf"), (0.3, -1.0, -9.8)
    elements = dict(
        drives={"motor": SineDrive(joint="wrist", amplitude=3.0, frequency=0.7, phase=0.4)},
        springs={"coil": JointSpring(joint="wrist", stiffness=7.0, damping=0.3, rest_angle=0.2)},
    )
    free = urdf.variant(joints={"wrist": "free"})
    return (
        System(build_mechanism(urdf, base, gravity), **elements),
        System(build_mechanism(free, base, gravity), **elements, held={"wrist": "revolute"}),
        "wrist",
    )


SYSTEMS = {
    "antenna": antenna,
    "crooked, floating": lambda: crooked("free"),
    "crooked, held": lambda: crooked("fixed"),
}


@pytest.fixture(scope="module", params=SYSTEMS)
def pair(request):
    return SYSTEMS[request.param]()


def spread_out(held, name, tree_slot, q, v):
    """A state of the tree with a revolute joint as one of the tree with a free joint."""
    slot = held.mechanism.joint(name)
    (angle,), (rate,) = q[tree_slot.q], v[tree_slot.v]
    pose = [0.0, 0.0, 0.0, *pin.Quaternion(pin.exp3(angle * slot.axis)).coeffs()]
    twist = [0.0, 0.0, 0.0, *(rate * slot.axis)]
    return (
        np.concatenate([q[: tree_slot.q.start], pose, q[tree_slot.q.stop :]]),
        np.concatenate([v[: tree_slot.v.start], twist, v[tree_slot.v.stop :]]),
    )


def random_states(pair, count, seed):
    tree, held, name = pair
    slot, rng = tree.mechanism.joint(name), np.random.default_rng(seed)
    for _ in range(count):
        q = pin.integrate(tree.model, tree.neutral(), rng.normal(size=tree.model.nv))
        v = rng.normal(size=tree.model.nv)
        yield rng.uniform(0.05, 0.45), q, v, *spread_out(held, name, slot, q, v)


def test_accelerations_are_those_of_the_tree(pair):
    """At 100 random states that satisfy the constraint, torques on: 1e-11 relative."""
    tree, held, name = pair
    slot = tree.mechanism.joint(name)
    parts = {"base": range(slot.v.start - 1), "joints": [slot.v.start - 1, slot.v.start]}
    worst = dict.fromkeys(["all", *parts], 0.0)
    for t, q, v, q_held, v_held in random_states(pair, 100, 1):
        expected = acceleration(tree, t, q, v)
        found = acceleration(held, t, q_held, v_held)
        free = found[held.mechanism.joint(name).v]
        axis = held.mechanism.joint(name).axis
        # Nothing moves but about the axis.
        forbidden = np.array([*free[:3], *np.cross(axis, free[3:])])
        reduced = np.array([*found[: slot.v.start], axis @ free[3:]])
        size = np.abs(expected).max()
        worst["all"] = max(worst["all"], np.abs([*(reduced - expected), *forbidden]).max() / size)
        for part, rows in parts.items():
            if len(rows):
                rows = list(rows)
                error = np.abs(reduced[rows] - expected[rows]).max() / np.abs(expected[rows]).max()
                worst[part] = max(worst[part], error)
    # Round-off of a mass matrix whose entries span 1e-2 to 2400 and of an equation too many; found 1.5e-13.
    assert worst["all"] < 1e-11
    assert worst["base"] < 1e-11
    assert worst["joints"] < 1e-11


def test_angles_stay_those_of_the_tree_over_two_seconds():
    """Both torques on, from rest; 1e-9 rad."""
    tree, held, name = antenna()
    slots = tree.mechanism.joint(name), held.mechanism.joint(name)
    start = tree.neutral(), np.zeros(tree.model.nv)
    ends = []
    for system, (q, v) in ((tree, start), (held, spread_out(held, name, slots[0], *start))):
        scales = np.ones(2 * system.manifold.nv + system.manifold.nx)
        stepper = Stepper(Workspace(system), METHODS["dormand-prince-853"], scales, 1.0)
        stepper.restart(0.0, system.state(q, v))
        for _ in range(200):
            stepper.attempt(0.01)
            stepper.accept()
        ends.append(stepper.y.copy())
    (tree_end, held_end), (hinge, joint) = ends, slots
    pose = held_end[joint.q]
    turn = pin.log3(pin.Quaternion(np.array(pose[3:])).matrix())
    azimuth = tree.mechanism.joint("azimuth").q
    assert np.abs(tree_end[hinge.q]) > 1.0  # it has gone far
    # The drift off the constraint, a double integral of the accelerations' round-off; found 3e-13.
    assert turn @ joint.axis == pytest.approx(tree_end[hinge.q][0], abs=1e-9)
    assert held_end[azimuth] == pytest.approx(tree_end[azimuth], abs=1e-9)
    assert held_end[:7] == pytest.approx(tree_end[:7], abs=1e-9)
    assert pose[:3] == pytest.approx(np.zeros(3), abs=1e-9)
    assert np.cross(turn, joint.axis) == pytest.approx(np.zeros(3), abs=1e-9)


def test_refuses_a_joint_that_is_not_free():
    mechanism = build_mechanism(Urdf.from_text(CROOKED, "crooked.urdf"), "free")
    message = "joint 'wrist': must be floating in the model to be held by constraint, got revolute"
    with pytest.raises(MechanismError, match=f"^{re.escape(message)}$"):
        System(mechanism, held={"wrist": "revolute"})
    with pytest.raises(UnknownNameError, match="did you mean wrist"):
        System(mechanism, held={"wirst": "revolute"})
