"""Oscillators whose periodic solutions and their multipliers are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import RunSettings, System, Urdf, build_mechanism, load_scenario
from antenna_pin.elements import ConstantDrive, JointSpring, SineDrive
from antenna_pin.run.simulation import Angle, Event, Jump
from antenna_pin.studies.nonlinear import Flow

CARRIAGE = (
    '<robot name="oscillator"><link name="ground"/>'
    '<link name="mass"><inertial><mass value="{mass}"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="way" type="prismatic"><parent link="ground"/><child link="mass"/><axis xyz="1 0 0"/>'
    '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>'
)


@pytest.fixture
def oscillator():
    """A function that makes a mass on a spring and a damper, driven by a sine, and by more if given."""

    def make(mass=1.0, stiffness=1.0, damping=0.0, amplitude=0.0, frequency=1.0, phase=0.0, pull=0.0, **more):
        urdf = Urdf.from_text(CARRIAGE.format(mass=mass), "oscillator")
        springs = {"coil": JointSpring(joint="way", stiffness=stiffness, damping=damping)}
        drives = dict(more)
        if amplitude:
            drives["motor"] = SineDrive(joint="way", amplitude=amplitude, frequency=frequency, phase=phase)
        mechanism = build_mechanism(urdf, "fixed", (-pull, 0.0, 0.0))
        return System(mechanism, springs=springs, drives=drives)

    return make


BAR = (
    '<robot name="{name}"><link name="ground"/>'
    '<link name="bob"><inertial><origin xyz="{centre}"/><mass value="1"/>'
    '<inertia ixx="1e-6" iyy="1e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="{joint}" type="{kind}"><parent link="ground"/><child link="bob"/>{more}</joint></robot>'
)
HINGE = {"name": "pendulum", "joint": "hinge", "kind": "continuous", "centre": "0 0 -1"}
WAY = {"name": "carriage", "joint": "way", "kind": "prismatic", "centre": "0 0 0"}


@pytest.fixture
def pendulum():
    """A function that makes a pendulum of 1 kg at 1 m, with a damper, that a torque and a spring hold."""

    def make(gravity, damping, torque=0.0, stiffness=0.0):
        urdf = Urdf.from_text(BAR.format(more='<axis xyz="0 1 0"/>', **HINGE), "pendulum")
        return System(
            build_mechanism(urdf, "fixed", (0.0, 0.0, -gravity)),
            springs={"damper": JointSpring(joint="hinge", stiffness=stiffness, damping=damping)},
            drives={"motor": ConstantDrive(joint="hinge", value=torque)},
        )

    return make


@pytest.fixture
def turned_back():
    """A function that makes the event of a stop, at which the velocity turns back with a restitution."""

    def make(place, restitution):
        back = Jump(lambda now: (now.q, -restitution * now.v))
        return Event(name="stop", when=Angle("way", place), direction=1, action=back)

    return make


@pytest.fixture
def mapped(oscillator):
    """A function that makes a flow whose map over 1 s is a map of (x, v) that is given.

    A mass flies, and half way an event maps the state to where the flight from what is wanted leads.
    """
    system = oscillator(stiffness=0.0)

    def make(map_of):
        def jump(now):
            x, v = map_of(now.q[0] - 0.5 * now.v[0], now.v[0])
            return np.array([x - 0.5 * v]), np.array([v])

        half = Event(name="half", when=lambda now: now.time - 0.5, direction=1, action=Jump(jump))
        return Flow(system, RunSettings(rtol=1e-12, engine="compiled"), (half,)), 1.0

    return make


FILE = """
format = 1
title = "{title}"
duration = "{duration}"
[mechanism]
urdf = "rig.urdf"
base = "fixed"
gravity = [0, 0, {gravity!r}]
[integrator]
engine = "compiled"
rtol = {rtol}
{tables}
"""


@pytest.fixture
def rig(tmp_path):
    """A function that makes a scenario of one mass: a carriage on a way, or a pendulum of 1 m and 1 kg."""

    def make(tables, turns=False, gravity=0.0, duration="10 s", rtol=1e-10):
        parts = HINGE if turns else WAY
        axis = '<axis xyz="0 1 0"/>' if turns else '<axis xyz="1 0 0"/>'
        limit = "" if turns else '<limit lower="-9" upper="9" effort="1" velocity="1"/>'
        (tmp_path / "rig.urdf").write_text(BAR.format(more=axis + limit, **parts))
        text = FILE.format(title=parts["name"], duration=duration, gravity=gravity, rtol=rtol, tables=tables)
        (tmp_path / "scenario.toml").write_text(text)
        return load_scenario(tmp_path / "scenario.toml")

    return make


TABLE = """<robot name="table"><link name="ground"/>
<link name="table"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="ball"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="shaker" type="prismatic"><parent link="ground"/><child link="table"/><axis xyz="0 0 1"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
<joint name="hollow" type="continuous"><parent link="table"/><child link="ball"/><axis xyz="0 1 0"/></joint>
</robot>"""
BALL = """
format = 1
title = "Ball in the hollow of a table that goes up and down"
duration = "1 s"
[mechanism]
urdf = "table.urdf"
base = "fixed"
gravity = [0, 0, {pull!r}]
[clearance.hollow]
model = "planar"
bearing_radius = 1.0
radial_clearance = {hollow!r}
geometry = "closed-form"
normal = {{ law = "lankarani-nikravesh", restitution = 0.5, stiffness = 1e8 }}
[drives.shaker]
kind = "motion"
amplitude = 0.01
frequency = {frequency!r}
[integrator]
engine = "compiled"
"""


@pytest.fixture
def ball_on_table(tmp_path):
    """A function that makes a scenario of a ball of 1 kg in the hollow of a shaking table.

    In the table's axes the third is the hinge's: x of the ball, then y downwards.
    """

    def make(gravity, hollow, frequency):
        (tmp_path / "table.urdf").write_text(TABLE)
        text = BALL.format(pull=-gravity, hollow=hollow, frequency=frequency)
        (tmp_path / "scenario.toml").write_text(text)
        return load_scenario(tmp_path / "scenario.toml")

    return make


# Two springs at right angles to the way, let go of at their free length: a restoring force that grows as the
# cube of the way, a Duffing oscillator without linear part but for the coil.
DUFFING = """
[springs.way]
stiffness = 1.0
damping = 0.1
[springs.side]
first = { link = "ground", point = [0, 1.0, 0] }
second = { link = "bob", point = [0, 0, 0] }
stiffness = 2.0
free_length = 1.0
[drives.motor]
joint = "way"
kind = "sine"
amplitude = 0.25
frequency = 0.2
"""


@pytest.fixture
def stiffening(rig):
    """A function that makes a scenario of these springs, run to a tolerance."""
    return lambda rtol: rig(DUFFING, rtol=rtol)
