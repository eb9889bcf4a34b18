"""A wheel on a hub with one drive, and sampled controllers of it: what the tests of controllers share."""

import dataclasses

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import ConstantDrive
from antenna_pin.elements.control import Pid, Sensor

RIG = """
<robot name="rig">
  <link name="hub">
    <inertial><mass value="{mass}"/>
      <inertia ixx="3" iyy="3" izz="3" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="wheel">
    <inertial><mass value="1"/><inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="joint" type="continuous"><parent link="hub"/><child link="wheel"/><axis xyz="0 0 1"/></joint>
</robot>
"""
HUB, WHEEL = 3.0, 2.0  # [kg m^2]
PERIOD = 0.01  # [s]
# Between instants the motion is a polynomial of the second degree, which every step has exactly; what remains
# is round-off of a hundred of them.
ROUND_OFF = 1e-13


def rig(base="fixed", torque=0.0):
    urdf = Urdf.from_text(RIG.format(mass=1), "rig.urdf")
    mechanism = build_mechanism(urdf, base=base, gravity=(0.0, 0.0, 0.0))
    return System(mechanism, drives={"motor": ConstantDrive(joint="joint", value=torque)})


def run_of(pid, base="fixed", duration=0.5, **more):
    settings = RunSettings(output_rate=1.0 / PERIOD, **more)
    return simulate(rig(base), duration=duration, controllers={"loop": pid}, settings=settings)


PLAIN = Pid(acts_on="motor", period=PERIOD, kp=40.0, ki=30.0, kd=8.0, reference=0.3)
KINDS = {
    "plain": PLAIN,
    "p": dataclasses.replace(PLAIN, ki=0.0, kd=0.0),
    "one period late": dataclasses.replace(PLAIN, delay_periods=1.0),
    "two and a half periods late": dataclasses.replace(PLAIN, delay_periods=2.5),
    "late by seconds": dataclasses.replace(PLAIN, delay=0.015),
    "filtered": dataclasses.replace(PLAIN, derivative_filter=0.02, derivative="error"),
    "trapezoid": dataclasses.replace(PLAIN, integrator="trapezoid"),
    "forward": dataclasses.replace(PLAIN, integrator="forward"),
    "clamped": dataclasses.replace(PLAIN, ki=300.0, lower=-1.0, upper=2.0),
    "back": dataclasses.replace(
        PLAIN, ki=300.0, lower=-1.0, upper=2.0, anti_windup="back-calculation", tracking_time=0.05
    ),
    "wound up": dataclasses.replace(PLAIN, ki=300.0, lower=-1.0, upper=2.0, anti_windup="none"),
    "slewed": dataclasses.replace(PLAIN, slew=50.0),
    "in steps": dataclasses.replace(PLAIN, sensor=Sensor(resolution=0.013)),
}
