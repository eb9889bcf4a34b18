"""Sound scenarios with an element of every kind: a small rig, and what joints may have besides play."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

_LINK = (
    '<link name="{0}"><inertial><origin xyz="0.1 0.05 0"/><mass value="1"/>'
    '<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
_JOINT = (
    '<joint name="{0}" type="{1}"><parent link="{2}"/><child link="{0}_link"/><origin xyz="0.3 0 0"/>'
    '<axis xyz="0 0 1"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>'
)
_JOINTS = (
    *(("hinge", "revolute", "base"), ("arm", "revolute", "hinge_link"), ("wheel", "continuous", "base")),
    *(("third", "continuous", "base"), ("slide", "prismatic", "base")),
)

#: The rig: three hinges at the base, one of them with an arm, and a slide.
RIG = "".join(_JOINT.format(*one) + _LINK.format(f"{one[0]}_link") for one in _JOINTS)
RIG = f'<robot name="rig">{_LINK.format("base")}{RIG}</robot>'

_BASE: Mapping[str, Any] = {
    "duration": 1e-3,
    "integrator": {"engine": "compiled"},
    "initial": {"joints": {"hinge": {"angle": 0.1, "rate": 2.0}, "slide": {"velocity": 0.3}}},
}

# A scenario with each, and one with all of a text that go together.
_TOGETHER = """
stops.hinge = {lower="-0.5 rad", upper="0.1005 rad", stiffness="2000 N*m/rad", restitution=0.6, \
    upper_law="kelvin-voigt", upper_damping="2 N*m*s/rad"}
stops.arm = {kind="rigid", restitution=0.4, upper_restitution=0.2}
latches.slide = {angle="1 mm", width="1 mm", greatest_rate="1 m/s", greatest_energy="5 J", \
    stiffness="1e4 N/m", damping="5 N*s/m", play="0.2 mm"}
latches.wheel = {kind="rigid", angle=0.0, width=0.1, direction="up", holding_torque="4 N*m", \
    switches_off=["springs.wen"]}
frictions.hinge = {coulomb="0.1 N*m", static="0.2 N*m", stribeck_rate="0.1 rad/s", viscous=0.01, \
    coefficient=0.2, radius="20 mm"}
frictions.arm = {kind="dahl", coulomb="0.1 N*m", stiffness="20 N*m/rad"}
frictions.third = {kind="lugre", coulomb="0.1 N*m", static="0.2 N*m", stribeck_rate="0.1 rad/s", \
    stiffness="20 N*m/rad", damping="0.1 N*m*s/rad"}
frictions.slide = {kind="gonthier-bristle", coulomb="1 N", stribeck_rate="0.1 m/s", stiffness="200 N/m", \
    damping="1 N*s/m", dwell_time="0.3 s"}
gears.train = {input="hinge", output="third", ratio=-3.0, stiffness="50 N*m/rad", \
    damping="0.1 N*m*s/rad", play="0.02 rad", efficiency=0.9}
gears.shaft = {kind="spline", input="third", output="wheel", stiffness="30 N*m/rad"}
gears.rack = {kind="rack", input="hinge", output="slide", radius="0.1 m", stiffness="2e3 N/m", play="2 mm"}
gears.loop = {kind="belt", input="hinge", output="arm", input_radius="0.1 m", output_radius="0.2 m", \
    stiffness="900 N/m", pretension="4 N"}
gears.strand = {kind="cable", input="third", output="hinge", input_radius="0.1 m", output_radius="0.2 m", \
    stiffness="900 N/m", slack="10 mm"}
springs.wen = {joint="wheel", kind="bouc-wen", alpha=0.3, stiffness="2 N*m/rad", yield_angle="0.1 rad"}
springs.slips = {joint="arm", kind="maxwell-slip", stiffness=[2.0, 1.0], slip=[0.05, 0.2]}
springs.tape = {joint="hinge", kind="constant-torque", torque="0.3 N*m", upper=0.5, ramp=0.1}
springs.curve = {joint="third", kind="table", angle=[-1.0, 0.0, 1.0], torque=[1.0, 0.2, -1.0]}
springs.harness = {joint="arm", kind="harness", angle=[-1.0, 1.0], torque=[0.2, -0.4], torque_back=[0.3, \
    -0.2], reversal=0.05}
springs.strut = {first={link="base", point=[0, 0, 0.5]}, second={link="arm_link", point=[0.1, 0, 0]}, \
    stiffness="9 N/m", free_length="0.2 m"}
springs.plain = {joint="slide", kind="friction", friction="1 N", regularisation_speed="1 mm/s"}
references.slew = {kind="s-curve", end=0.3, rate=1.0, acceleration=4.0, jerk=40.0}
references.swing = {kind="chirp", amplitude=0.1, first="1 Hz", last="20 Hz", duration="1 s"}
references.both = {kind="sum", parts=["slew", "swing"]}
drives.servo = {joint="arm", kind="motor", torque_constant=0.05, resistance=0.8, inductance=1e-3, \
    current_limit=3.0, ratio=20.0}
drives.hold = {joint="third", kind="pd", kp=8.0, kd=0.5, limit=2.0, follows="both"}
drives.push = {joint="slide", kind="constant", value=0.1}
drives.spin = {joint="wheel", kind="constant", value=0.0}
controllers.loop = {kind="pid", acts_on="servo", period="0.2 ms", kp=6.0, ki=3.0, kd=0.4, reference=0.2, \
    delay="0.1 ms", upper=5.0, sensor={noise=1e-4, seed=3, bits=12}}
controllers.switch = {kind="bang-bang", acts_on="push", period="0.1 ms", measures="angle slide", \
    measures_rate="rate slide", slope=0.1, level=0.5, dead_band=1e-3}
controllers.state = {kind="state-feedback", acts_on=["spin"], measures=["angle wheel", "rate wheel"], \
    period="0.3 ms", gain=[[1.0, 0.1]]}
forces.wind = {kind="force", at={link="arm_link", point=[0.1, 0, 0.2]}, force=[1.0, 0.0, 2.0], \
    follows="slew"}
forces.jet = {kind="thruster", at={link="hinge_link", point=[0.1, 0, 0]}, direction=[1, 1, 0], \
    thrust="4 N", starts=[0.0, 5e-4], durations=[2e-4]}
forces.field = {kind="gravity-gradient", rate="1e-3 rad/s"}
rotors.arm = {inertia="1e-4 kg*m^2", ratio=20.0}
rotors.third = {kind="armature", inertia="1e-3 kg*m^2"}
events.off = {kind="time", time="0.4 ms", action="set", set="latches.slide.on", to=false}
"""
# Each by itself: they shut others out.
_ALONE = (
    'bearings.wheel = {kind="stiffness", radial=2000000.0, axial=1000000.0, tilt=3000.0, '
    "damping_time=0.0001}",
    'bearings.wheel = {kind="balls", count=9, ball_diameter="8 mm", pitch_diameter="40 mm", '
    'contact_angle="25 deg", preload="100 N", arrangement="back-to-back", spread="20 mm"}',
    'bearings.wheel = {kind="preload", force="10 N", stiffness="1e4 N/m"}\n'
    'clearance.wheel = {model="contact", bearing_radius="10 mm", radial_clearance="0.1 mm", '
    'bearing_length="50 mm", axial_clearance="0.2 mm", bearing_outer_radius="12 mm", '
    'flange_radius="14 mm", geometry="closed-form", normal={law="lankarani-nikravesh", '
    'stiffness=1000000000.0, restitution=0.5}, friction={law="none"}}',
    'couplings.hinge = {leader="wheel", multiplier=-2.0, offset=0.1}',
    'couplings.hinge = {kind="differential", first="wheel", second="third"}',
    'couplings.hinge = {kind="planetary", sun="wheel", ring="third", ratio=3.0}',
    'drives.hinge = {kind="motion", follows="way"}\nreferences.way = {kind="rest-to-rest", end=0.3, '
    'duration="1 s"}\ninitial.joints.hinge = {}',
    'drives.hinge = {kind="table", time=[0.0, 1.0], torque=[1.0, 2.0]}\ndrives.wheel = {kind="sine", '
    'amplitude=2.0, frequency="30 Hz"}',
    'mechanism = {base="fixed"}\nshake.up = {kind="sine", direction=[0, 0, 1], acceleration=9.8, '
    'frequency="40 Hz", fade_in="10 ms"}',
    'mechanism = {base="fixed"}\nshake.up = {kind="sweep", axis=[0, 1, 0], velocity=0.1, '
    'start_frequency="5 Hz", end_frequency="100 Hz", octaves_per_minute=4.0, back=true}',
    'mechanism = {base="fixed"}\nshake.up = {kind="random", direction=[1, 0, 0], frequency=[20.0, 80.0, '
    "200.0], density=[1.0, 4.0, 4.0], period=0.5, seed=1}",
    'mechanism = {base="fixed"}\nshake.up = {kind="table", direction=[1, 0, 0], of="acceleration", '
    "time=[0.0, 0.1, 0.2], course=[0.0, 1.0, 0.0], scale=9.80665}",
    "stops = true",
)


def rigs() -> Iterator[dict[str, Any]]:
    """Yield the scenarios' tables: with what goes together, and with what stands alone."""
    for text in (_TOGETHER, *_ALONE):
        more = tomllib.loads(text)
        mechanism = {"urdf": "rig.urdf", "base": "free", **more.pop("mechanism", {})}
        yield {**_BASE, **more, "mechanism": mechanism}
