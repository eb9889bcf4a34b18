"""A mass that falls onto a rigid floor, read by a filtered accelerometer: scenario, fit file, closed form."""

import numpy as np
from scipy import signal

GRAVITY, RESTITUTION, HEIGHT, CORNER = 9.81, 0.5, 1.0, 50.0
TIME = np.arange(1, 301) / 500.0  # of the record [s]
NOISE = 0.5  # standard deviation of a row [m/s^2]

URDF = """<robot name="m">
<link name="ground"/>
<link name="mass"><inertial><origin xyz="0 0 0"/><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="ground"/><child link="mass"/><axis xyz="0 0 1"/>
<limit lower="-100" upper="100" effort="1e9" velocity="1e9"/></joint>
</robot>"""

SCENARIO = """format = 1
duration = 0.61
[mechanism]
urdf = "m.urdf"
base = "fixed"
gravity = [0, 0, -9.81]
[stops.floor]
joint = "slide"
kind = "rigid"
lower = 0.0
restitution = 0.5
[initial.joints.slide]
position = 1.0
[integrator]
engine = "compiled"
"""

FIT = """format = 1
scenario = "scenario.toml"
{more}
[parameters.height]
key = "initial.joints.slide.position"
start = "{start} m"
between = ["0.8 m", "1.2 m"]
[parameters.restitution]
key = "stops.floor.restitution"
start = {restitution}
between = [0.1, 0.9]
[records.test]
file = "ball.csv"
[records.test.columns.a]
sensor = "accelerometer"
link = "mass"
direction = [0, 0, 1]
filter = {{ corner = "50 Hz", order = {order} }}
sd = "0.5 m/s**2"
"""


def response(time, order):
    """Return the response of the filter to an impulse of 1 m/s at zero, and its derivative over time."""
    residues, poles, _ = signal.residue(*signal.butter(order, 2.0 * np.pi * CORNER, analog=True))
    after = np.maximum(time, 0.0)
    each = np.exp(np.outer(after, poles)) * residues
    return [np.where(time > 0.0, one.sum(axis=1).real, 0.0) for one in (each, each * poles)]


def reading(height, restitution, order):
    """Return what is read of the fall, (n,) [m/s^2], and its derivatives by height and restitution, (n, 2).

    Free fall reads nothing; the blow is an impulse (1 + e) v when the fall has ended.
    """
    when, speed = np.sqrt(2.0 * height / GRAVITY), np.sqrt(2.0 * GRAVITY * height)
    found, rate = response(TIME - when, order)
    later, faster = when / (2.0 * height), speed / (2.0 * height)
    by_height = (1.0 + restitution) * (faster * found - speed * later * rate)
    return (1.0 + restitution) * speed * found, np.column_stack([by_height, speed * found])


def write(folder, record, *, order=4, start=1.01, restitution=0.48, more=""):
    """Write scenario, record and fit file; return the path of the last."""
    (folder / "m.urdf").write_text(URDF)
    (folder / "scenario.toml").write_text(SCENARIO)
    rows = np.column_stack([TIME, record])
    np.savetxt(folder / "ball.csv", rows, delimiter=",", header="time,a", comments="", fmt="%.17g")
    path = folder / "ball.fit.toml"
    path.write_text(FIT.format(order=order, start=start, restitution=restitution, more=more))
    return path
