"""Derivatives of motions that are known in closed form, by both methods."""

import numpy as np
import pytest

from antenna_pin import load_scenario
from antenna_pin.studies.sensitivity import sensitivities

MASS, STIFFNESS, DAMPING, PLACE, SPEED, PULL = 2.0, 50.0, 1.2, 0.5, 0.3, 9.81
METHODS = ["runs", "equation"]
#: Every number of the oscillator, by its key.
KEYS = {
    "springs.coil.stiffness": STIFFNESS,
    "springs.coil.damping": DAMPING,
    "mechanism.links.mass.mass": MASS,
    "initial.joints.way.position": PLACE,
    "mechanism.gravity[0]": -PULL,
}


URDF = """<robot name="oscillator"><link name="ground"/>
<link name="mass"><inertial><mass value="2"/>
<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="way" type="prismatic"><parent link="ground"/><child link="mass"/><axis xyz="1 0 0"/>
<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>"""
BASE = f"""
format = 1
title = "a mass that slides"
source = "chosen"
duration = "1.5 s"
[mechanism]
urdf = "mass.urdf"
base = "fixed"
gravity = [{-PULL}, 0.0, 0.0]
links.mass.mass = {MASS}
[initial.joints.way]
position = "{PLACE} m"
velocity = "{SPEED} m/s"
[output]
rate = "10 Hz"
"""
COIL = f"""
[springs.coil]
kind = "spring"
joint = "way"
stiffness = "{STIFFNESS} N/m"
damping = "{DAMPING} N*s/m"
"""
FLOOR = """
[stops.floor]
kind = "rigid"
joint = "way"
lower = "0 m"
upper = "9 m"
restitution = 0.8
"""


def mass(folder, more, base=BASE, **changes):
    """Return the scenario of a mass that slides, with more tables."""
    (folder / "mass.urdf").write_text(URDF)
    (folder / "mass.toml").write_text(base + more)
    overrides = {"integrator.engine": "compiled"} | changes
    return load_scenario(str(folder / "mass.toml"), overrides=overrides)


def stepped_numbers(keys):
    """Yield index, value and all numbers, of which that one goes a step along the imaginary axis."""
    for k, value in enumerate(keys.values()):
        yield k, value, [one + 1e-30j * (i == k) for i, one in enumerate(keys.values())]


def oscillation(t, stiffness, damping, mass, place, gravity):
    """Return place and rate of the damped oscillator under gravity, which are analytic in all arguments."""
    rest, half = mass * gravity / stiffness, 0.5 * damping / mass
    omega = np.sqrt(stiffness / mass - half**2)
    a, b = place - rest, (SPEED + half * (place - rest)) / omega
    decay = np.exp(-half * t)
    wave, slope = a * np.cos(omega * t) + b * np.sin(omega * t), b * np.cos(omega * t) - a * np.sin(omega * t)
    return rest + decay * wave, decay * (omega * slope - half * wave)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_an_oscillator_in_all_its_numbers(tmp_path, method, engine):
    """By the complex step, whose derivatives of the closed form are exact to round-off."""
    times = np.array([0.0, 0.2, 0.7, 1.4])
    oscillator = mass(tmp_path, COIL, **{"integrator.engine": engine})
    found = sensitivities(oscillator, list(KEYS), times, method=method)
    for k, value, stepped in stepped_numbers(KEYS):
        for name, exact in zip(("slide_position", "slide_rate"), oscillation(times, *stepped), strict=True):
            wanted = exact.imag / 1e-30
            ours = found.derivative(name)[:, 0, k]
            # Runs: their tolerance of 1e-12 over a step of 1e-3; the equation: ten of its own tolerances.
            least = 1e-8 if method == "runs" else 1e-10
            assert np.abs(ours - wanted).max() * abs(value) < least
            assert (np.abs(ours - wanted) <= found.doubt(name)[:, 0, k] + 1e-15).all()


def bounces(t, restitution, floor, speed, pull):
    """Return place and rate of a ball that bounces, and when it has, from the closed form."""
    at, place, rate, instants = 0.0, PLACE + 0.0 * floor, speed + 0.0 * floor, []
    while True:
        flight = (rate + np.sqrt(rate**2 + 2.0 * pull * (place - floor))) / pull
        if (at + flight).real > t:
            rest = t - at
            return place + rate * rest - 0.5 * pull * rest**2, rate - pull * rest, instants
        at, place, rate = at + flight, floor, -restitution * (rate - pull * flight)
        instants.append(at)


#: What a bouncing ball is differentiated over, and in which scales.
BALL = {
    "stops.floor.restitution": 0.8,
    "stops.floor.lower": 0.0,
    "initial.joints.way.velocity": SPEED,
    "mechanism.gravity[0]": PULL,
}
SCALES = {key: 0.1 if value == 0.0 else None for key, value in BALL.items()}


@pytest.mark.parametrize("method", METHODS)
def test_a_bouncing_ball_in_all_its_numbers(tmp_path, method):
    """Restitution, place of the floor, first speed and gravity, behind two and three impacts."""
    times = np.array([0.2, 0.7, 1.4])
    found = sensitivities(mass(tmp_path, FLOOR), SCALES, times, method=method)
    for k, value, stepped in stepped_numbers(BALL):
        sign = -1.0 if value == PULL else 1.0
        for i, t in enumerate(times):
            exact = bounces(t, *stepped)[:2]
            for name, one in zip(("slide_position", "slide_rate"), exact, strict=True):
                off = abs(found.derivative(name)[i, 0, k] - sign * one.imag / 1e-30)
                # As above; an impact's instant is located to 1e-13 s, at some 10 m/s^2 per scale of 0.1.
                assert off * (value or 0.1) < (1e-7 if method == "runs" else 1e-10)
