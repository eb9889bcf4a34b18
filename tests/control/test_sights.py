"""What a controller sees of links and joints at its instants: axes, angles between them, loads of joints."""

import dataclasses
import math
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.analysis import body_poses, joint_loads
from antenna_pin.dynamics import PointSpring
from antenna_pin.elements import ConstantDrive, JointSpring, OutsideForce, PrescribedMotion, Thruster
from antenna_pin.elements.control import Controller

CRAFT = """<robot name="craft">
  <link name="hull"><inertial><mass value="4"/>
    <inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="continuous"><parent link="hull"/><child link="arm"/>
    <origin xyz="0.3 0 0.1" rpy="0.3 -0.4 0.5"/><axis xyz="0 0.6 0.8"/></joint>
  <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="1.5"/>
    <inertia ixx="0.01" iyy="0.2" izz="0.21" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/>
    <origin xyz="0.8 0 0" rpy="0 0 1.5707963267948966"/></joint>
  <link name="tip"/>
</robot>"""
RIDE = """<robot name="ride"><link name="post"/>
  <joint name="lift" type="prismatic"><parent link="post"/><child link="box"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <link name="box"><inertial><origin xyz="0.2 0 0"/><mass value="3"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""


@dataclass
class Watch(Controller):
    """Commands nothing; notes what it is told to."""

    period: float = 0.05
    commands: tuple[str, ...] = ("motor",)
    signals: tuple[str, ...] = ()
    looks: Any = None

    def update(self, now):
        now.note(**dict(zip(self.signals, map(float, self.looks(now)), strict=True)))
        return {}


def watched(system, looks, count, duration=0.5, engine="compiled", v=None):
    """Return the run and what was seen, (instants, count); samples stand at the instants."""
    watch = Watch(looks=looks, signals=tuple(f"s{k}" for k in range(count)))
    settings = RunSettings(rtol=1e-10, output_rate=20.0, engine=engine)
    run = simulate(system, v=v, duration=duration, settings=settings, controllers={"watch": watch})
    return run, run.data.tick_signal.values[:, :count]


def craft(base="free", gravity=(0.0, 0.0, 0.0), springs=None, **forces):
    mechanism = build_mechanism(Urdf.from_text(CRAFT, "craft.urdf"), base, gravity)
    drives = {"motor": ConstantDrive(joint="hinge", value=0.3)}
    return System(mechanism, drives=drives, springs=springs or {}, elements={"forces": forces})


TUMBLE = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6, 0.7])


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_direction_is_a_column_of_the_links_attitude(engine):
    """Of a link that is fixed to another too; against poses of the record; round-off of products."""
    run, seen = watched(
        craft(), lambda now: now.direction("tip", (0.0, 3.0, 4.0)), 3, engine=engine, v=TUMBLE
    )
    poses = body_poses(run)
    names = poses["body"].values.tolist()
    assert seen.shape == (11, 3)
    at = poses["attitude"].values[:, names.index("tip")] if "tip" in names else None
    turned = Rotation.from_quat(at).apply([0.0, 0.6, 0.8])
    np.testing.assert_allclose(seen, turned, rtol=0.0, atol=1e-14)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.4, math.pi / 2, math.pi - 1e-9, math.pi])
def test_an_angle_off_axis_is_right_where_its_cosine_is_not(angle):
    """The cosine of 1e-9 rad is 1 to the last bit: by the arc tangent the angle is right to round-off."""
    target = (math.cos(angle), math.sin(angle), 0.0)
    _, seen = watched(craft(), lambda now: [now.off_axis("hull", (2.0, 0.0, 0.0), target)], 1, duration=0.05)
    assert seen[0, 0] == pytest.approx(angle, abs=3e-16)


def test_a_turning_joint_turns_an_axis_by_its_angle():
    """On a fixed base: the axis across the hinge leaves where it was by the hinge's angle, 0.8 rad/s t."""
    urdf = Urdf.from_text(CRAFT.replace("0 0.6 0.8", "0 0 1").replace('rpy="0.3 -0.4 0.5"', ""), "c.urdf")
    system = System(
        build_mechanism(urdf, "fixed", (0.0, 0.0, 0.0)),
        drives={"motor": ConstantDrive(joint="hinge", value=0)},
    )
    still = Watch(looks=lambda now: [now.off_axis("arm", (1, 0, 0), (1, 0, 0))], signals=("off",))
    run = simulate(system, v=[0.8], duration=0.5, controllers={"watch": still})
    np.testing.assert_allclose(run.data.tick_signal.values[:, 0], 0.8 * run.data.tick_time.values, atol=1e-14)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_lift_carries_its_weight_and_what_moves_it(engine):
    """m (g + a) along, its moment m (g + a) times the arm across, of a motion that is given: closed form."""
    mechanism = build_mechanism(Urdf.from_text(RIDE, "ride.urdf"), "fixed", (0.0, 0.0, -9.81))
    swing = {"amplitude": 0.1, "frequency": 2.0}
    system = System(
        mechanism,
        drives={"way": PrescribedMotion(joint="lift", **swing)},
        elements={"forces": {"motor": OutsideForce(at=("box", (0, 0, 0)), force=(1.0, 0, 0), value=0.0)}},
    )
    omega = 2 * math.pi * 2.0
    run, seen = watched(
        system, lambda now: now.joint_load("lift"), 6, engine=engine, v=[0.1 * omega], duration=0.5
    )
    time = run.data.tick_time.values
    along = 3.0 * (9.81 - 0.1 * omega**2 * np.sin(omega * time))
    zero = np.zeros_like(time)
    expected = np.stack([zero, zero, along, zero, -0.2 * along, zero], axis=1)
    np.testing.assert_allclose(seen, expected, rtol=0.0, atol=1e-10)  # of what holds the motion


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize("beside", ["nothing", "a spring", "forces"])
def test_a_joints_load_is_that_of_the_record(beside, engine):
    """Inverse dynamics of the recorded motion, by another path: what acts on links is taken off in both."""
    springs = {"k": JointSpring(joint="hinge", stiffness=2.0, damping=0.1)} if beside == "a spring" else {}
    forces = {}
    if beside == "forces":
        forces = {
            "push": OutsideForce(at=("tip", (0.1, 0.2, 0.3)), force=(2.0, -1.0, 0.5), torque=(0.1, 0.0, 0.2)),
            "jet": Thruster(at=("hull", (0.5, 0.0, 0.0)), direction=(0, 1, 0), thrust=1.0),
        }
    gravity = (0.3, -0.2, -1.0)
    system = craft(gravity=gravity, springs=springs, **forces)
    run, seen = watched(system, lambda now: now.joint_load("hinge"), 6, engine=engine, v=TUMBLE)
    loads = joint_loads(run)
    poses = body_poses(run)
    # In the axes of the joint's frame on the child, which are the link's.
    turns = Rotation.from_quat(poses["attitude"].values[:, poses["body"].values.tolist().index("arm")])
    for k, name in enumerate(("force", "torque")):
        recorded = turns.inv().apply(loads[name].sel(moving_joint="hinge").values)
        np.testing.assert_allclose(seen[:, 3 * k : 3 * k + 3], recorded, rtol=0.0, atol=1e-12)


def test_a_force_beyond_a_joint_that_stands_still_is_what_it_passes():
    """At rest on a fixed base, held by a motion: the joint's load is the force, moments about its frame."""
    urdf = Urdf.from_text(CRAFT, "craft.urdf")
    push = OutsideForce(at=("arm", (0.4, 0.0, 0.0)), force=(0.0, 0.0, -5.0), torque=(1.0, 0.0, 0.0))
    system = System(
        build_mechanism(urdf, "fixed", (0.0, 0.0, 0.0)),
        drives={"hold": PrescribedMotion(joint="hinge")},
        elements={"forces": {"push": push, "motor": dataclasses.replace(push, value=0.0)}},
    )
    _, seen = watched(system, lambda now: now.joint_load("hinge"), 6, duration=0.05)
    np.testing.assert_allclose(seen[0], [0, 0, 5.0, -1.0, -0.4 * 5.0, 0], atol=1e-13)  # round-off


def test_a_load_that_the_motion_does_not_tell_is_refused():
    spring = PointSpring(
        first=("hull", (0, 0, 0)), second=("arm", (0.4, 0, 0)), stiffness=1.0, free_length=0.1
    )
    for system, looks, said in (
        (craft(springs={"s": spring}), lambda now: now.joint_load("hinge"), "no springs between points"),
        (craft(), lambda now: now.joint_load("hing"), "did you mean hinge"),
        (craft(), lambda now: now.direction("arn", (1, 0, 0)), "arn"),
        (craft(), lambda now: [now.off_axis("arm", (1, 0, 0), (0, 0, 0))], "target must"),
    ):
        run, _ = watched(system, looks, 1)
        assert not run.completed
        assert said in run.message
        assert "\n" not in run.message
