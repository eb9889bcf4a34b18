"""A tether between two craft: it pulls and cannot push, gives and loses energy, and is slack at times."""

import math

import numpy as np
from numba import njit

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import CallableElement

LINK = """<link name="{}"><inertial><mass value="{}"/>
<inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = '<joint name="apart" type="floating"><parent link="tug"/><child link="debris"/></joint>'
robot = f'<robot name="pair">{LINK.format("tug", 40)}{JOINT}{LINK.format("debris", 90)}</robot>'


@njit
def tether(t, p, links, joints, states, whole):
    """Pull the second link towards the first."""
    stiffness, damping, free = p
    way = links[1].place - links[0].place
    length = math.sqrt((way * way).sum())
    way /= length
    whole.kink = length - free  # where it is zero a step ends
    if length > free:
        rate = (way * (links[1].velocity - links[0].velocity)).sum()
        whole.energy = 0.5 * stiffness * (length - free) ** 2
        whole.loss = damping * rate**2
        links[1].force[:] = -(stiffness * (length - free) + damping * rate) * way


line = CallableElement(
    act=tether,
    links=(("tug", (0.5, 0.0, 0.0)), ("debris", (-0.4, 0.3, 0.0))),
    parameters={"stiffness": 30.0, "damping": 5.0, "free": 10.0},
    internal=True,  # the first link takes the reaction of the second
    passive=True,  # its work is what it stores and loses
    has_kink=True,
)
system = System(build_mechanism(Urdf.from_text(robot, "pair"), "free"), elements={"forces": {"line": line}})
q, v = system.neutral(), np.zeros(12)
q[7:10], v[6] = (10.5, 0.0, 0.0), 0.3  # 0.3 m/s apart, and not yet tight
run = simulate(
    system, duration=30.0, q=q, v=v, settings=RunSettings(engine="compiled", rtol=1e-9, max_step=1.0)
)

kept = run.summary()["conservation"]
print(run.outcome.name, "most stored [J]:", round(run.data["force_energy"].max().item(), 3))
print("lost [J]:", round(run.data["total_force_loss"].item(), 3))
print("errors of momentum [kg m/s] and energy [J]:", kept["linear_momentum_drift"], kept["energy_error"])
