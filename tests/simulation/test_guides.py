"""Sliders with play in their guides, drawn at random on a body that floats free: what they must keep."""

import json

import numpy as np
import pytest

from antenna_pin import ClearanceJoint, RunSettings, System, simulate
from antenna_pin.contact import Hertz, LankaraniNikravesh, NoFriction, Tanh
from antenna_pin.dynamics import JointSpring, SineDrive
from antenna_pin.joints.geometry import PrismaticClearance
from antenna_pin.mechanism import Urdf, build_mechanism


def link(name, mass, size, centre):
    a, b, c = (float(s) for s in size)
    moments = {"ixx": b * b + c * c, "iyy": a * a + c * c, "izz": a * a + b * b}
    inertia = " ".join(f'{key}="{mass / 12.0 * value!r}"' for key, value in moments.items())
    return (
        f'<link name="{name}"><inertial><origin xyz="{" ".join(map(repr, map(float, centre)))}"/>'
        f'<mass value="{mass!r}"/><inertia {inertia} ixy="0" ixz="0" iyz="0"/></inertial></link>'
    )


def guided(seed, backend="closed-form", wide=0.0):
    """A body and a slider on it, driven and sprung along the guide, and the velocity it starts with."""
    rng = np.random.default_rng(seed)
    axis = rng.normal(size=3)
    placed = f'xyz="{rng.normal():.3f} 0.1 -0.2" rpy="0.3 {rng.normal():.3f} 0.5"'
    text = (
        '<robot name="guided">'
        + link("body", 20.0, rng.uniform(0.2, 0.6, 3), rng.uniform(-0.1, 0.1, 3))
        + '<joint name="slide" type="prismatic"><parent link="body"/><child link="carriage"/>'
        f'<origin {placed}/><axis xyz="{" ".join(map(repr, map(float, axis)))}"/>'
        '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
        + link("carriage", float(rng.uniform(0.5, 3.0)), (0.1, 0.05, 0.04), rng.uniform(-0.03, 0.03, 3))
        + "</robot>"
    )
    mechanism = build_mechanism(Urdf.from_text(text, "guided").variant(joints={"slide": "free"}), "free")
    play = float(rng.uniform(5e-5, 3e-4)) + wide
    sides = dict(slider_width=0.04, slider_height=0.06, slider_length=0.1)
    shape = PrismaticClearance(
        guide_width=0.04 + 2.0 * play,
        guide_height=0.06 + play,
        corner_radius=float(rng.choice([0.0, 0.003])),
        roll=float(rng.uniform(-3.0, 3.0)),
        **sides,
    )
    elastic = bool(rng.integers(2))
    joint = ClearanceJoint(
        name="slide",
        geometry=shape,
        radial=Hertz(stiffness=1e9) if elastic else LankaraniNikravesh(stiffness=1e9, restitution=0.7),
        friction=NoFriction() if elastic else Tanh(coefficient_of_friction=0.2, transition_speed=0.01),
        backend=backend,
        offset=float(rng.uniform(-0.02, 0.02)),
        maximum_depth=1e-3,
    )
    system = System(
        mechanism,
        clearances=[joint],
        drives={"push": SineDrive(joint="slide", amplitude=3.0, frequency=7.0)},
        springs={"coil": JointSpring(joint="slide", stiffness=200.0, damping=2.0, rest_angle=0.01)},
    )
    v = np.zeros(system.model.nv)
    v[3:6] = rng.uniform(-0.3, 0.3, 3)
    v[6:9] = rng.uniform(-0.05, 0.05, 3)
    return system, v


@pytest.mark.parametrize("seed", range(12))
def test_momentum_is_kept_and_the_ledger_closes(seed):
    """Wherever the guide points, with offset, roll, sharp or round corners, drive, spring and damper."""
    system, v = guided(seed)
    run = simulate(system, duration=0.1, v=v, settings=RunSettings(rtol=1e-10))
    assert run.completed, run.message
    assert run.data.sizes["episode"] > 0
    kept = json.loads(run.data.attrs["conservation"])
    # Some thousand steps at 1e-10; impacts of corners of 1e9 N/m^1.5.
    assert kept["linear_momentum_drift_relative"] < 1e-9
    assert kept["angular_momentum_drift_relative"] < 1e-9
    assert kept["energy_error"] < 1e-8 * run.data["kinetic_energy"].values.max()


def test_the_way_along_a_guide_is_recorded_with_its_derivatives():
    """Of a slider that flies, turning, in a wide guide: central differences of 1e-5 s."""
    system, v = guided(4, wide=0.2)
    v[9:12] = 2.0, -3.0, 1.0
    settings = RunSettings(rtol=1e-12, output_rate=1e5)
    data = simulate(system, duration=2e-3, v=v, settings=settings).data
    assert data.sizes["episode"] == 0
    way, rate, acceleration = (
        data[f"slide_{name}"].values[:, 0] for name in ("position", "rate", "acceleration")
    )
    # A sixth of the third derivative, some m/s^3 and m/s^4, times h^2; and round-off over h.
    assert np.gradient(way, 1e-5)[1:-1] == pytest.approx(rate[1:-1], abs=1e-8)
    assert np.gradient(rate, 1e-5)[1:-1] == pytest.approx(acceleration[1:-1], abs=1e-6)
    assert np.ptp(acceleration) > 1e-3
