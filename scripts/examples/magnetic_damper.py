"""A magnetic damper: eddy currents in a body that turns in a field take what of its spin is across it."""

import numpy as np
from numba import njit

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import CallableElement

LINK = """<link name="{}"><inertial><mass value="{}"/>
<inertia ixx="0.9" iyy="1" izz="1.2" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
robot = f'<robot name="cube">{LINK.format("cube", 6)}</robot>'
RATE = 1.1e-3  # of the orbit [rad/s]


@njit
def damper(t, p, links, joints, states, whole):
    """Turn against the spin across the field."""
    k, size = p[0], p[1]
    field = np.array([2.0 * np.sin(RATE * t), 0.0, np.cos(RATE * t)]) * size  # a dipole's, over its pole [T]
    spin = links[0].spin
    links[0].torque[:] = k * np.cross(np.cross(spin, field), field)
    whole.loss = -(links[0].torque * spin).sum()


eddy = CallableElement(
    act=damper,
    links=(("cube", (0.0, 0.0, 0.0)),),
    parameters={"k": 2e5, "field": 3e-5},
    passive=True,
)
system = System(build_mechanism(Urdf.from_text(robot, "cube"), "free"), elements={"forces": {"eddy": eddy}})
start = np.array([0.0, 0.0, 0.0, 0.05, 0.02, -0.04])
run = simulate(
    system,
    duration=20_000.0,
    v=start,
    settings=RunSettings(engine="compiled", rtol=1e-9, max_step=100.0, output_rate=0.01),
)
spin = np.linalg.norm(run.data["base_angular_velocity"].values, axis=1)
print(run.outcome.name, "spin [rad/s]:", round(spin[0], 4), "->", f"{spin[-1]:.2e}")
print("lost [mJ]:", round(1e3 * run.data["total_force_loss"].item(), 4))
print("energy error [J]:", run.summary()["conservation"]["energy_error"])
