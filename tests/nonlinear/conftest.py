"""Oscillators whose periodic solutions and their multipliers are known in closed form."""

from __future__ import annotations

import pytest

from antenna_pin import System, Urdf, build_mechanism
from antenna_pin.elements import JointSpring, SineDrive

CARRIAGE = (
    '<robot name="oscillator"><link name="ground"/>'
    '<link name="mass"><inertial><mass value="{mass}"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="way" type="prismatic"><parent link="ground"/><child link="mass"/><axis xyz="1 0 0"/>'
    '<limit lower="-9" upper="9" effort="1" velocity="1"/></joint></robot>'
)


@pytest.fixture
def oscillator():
    """A function that makes a mass on a spring and a damper, driven by a sine."""

    def make(mass=1.0, stiffness=1.0, damping=0.0, amplitude=0.0, frequency=1.0, phase=0.0):
        mechanism = build_mechanism(Urdf.from_text(CARRIAGE.format(mass=mass), "oscillator"), "fixed")
        springs = {"coil": JointSpring(joint="way", stiffness=stiffness, damping=damping)}
        drives = {}
        if amplitude:
            drives["motor"] = SineDrive(joint="way", amplitude=amplitude, frequency=frequency, phase=phase)
        return System(mechanism, springs=springs, drives=drives)

    return make
