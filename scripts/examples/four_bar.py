"""A closed loop built by hand: a four-bar linkage swings under gravity, from a state that is found."""

import numpy as np

from antenna_pin import Closure, System, Urdf, build_mechanism, simulate
from antenna_pin.dynamics import assembled
from antenna_pin.dynamics.constraints import Anchor

BAR = """<link name="{name}"><inertial><origin xyz="{half} 0 0"/><mass value="1"/>
  <inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
HINGE = """<joint name="{name}" type="continuous"><parent link="{parent}"/><child link="{child}"/>
  <origin xyz="{x} 0 0"/><axis xyz="0 -1 0"/></joint>"""
urdf = Urdf.from_text(
    '<robot name="four_bar"><link name="ground"/>'
    + BAR.format(name="crank", half=0.1)
    + BAR.format(name="coupler", half=0.25)
    + BAR.format(name="rocker", half=0.175)
    + HINGE.format(name="a", parent="ground", child="crank", x=0)
    + HINGE.format(name="b", parent="crank", child="coupler", x=0.2)
    + HINGE.format(name="c", parent="coupler", child="rocker", x=0.5)
    + "</robot>",
    "four_bar",
)
axis = (0.0, -1.0, 0.0)
loop = Closure(
    kind="revolute",
    first=Anchor.at("ground", (0.4, 0.0, 0.0), axis),
    second=Anchor.at("rocker", (0.35, 0.0, 0.0), axis),
)
system = System(build_mechanism(urdf, "fixed", (0.0, 0.0, -9.81)), closures={"d": loop})

guess = np.array([0.0, 1.0, 1.0, 0.0, 0.0, -1.0])  # cosines and sines: crank up, coupler level, rocker down
q, v = assembled(system, guess, held=["a"])
run = simulate(system, duration=1.0, q=q, v=v)
print(f"angle of the rocker after 1 s: {run.data.motion_angle.sel(joint='c')[-1].item():.9f} rad")
print(f"largest force in the closure: {np.linalg.norm(run.data.closure_force[:, 0], axis=1).max():.6f} N")
held = run.constraints
print(
    f"{held['closure_equations']} equations, {held['closure_rank']} independent, mobility {held['mobility']}"
)
