"""Responses of small motions to a shaken base, against closed forms."""

import numpy as np
import pytest

from antenna_pin import System, Urdf, build_mechanism
from antenna_pin.dynamics import assembled
from antenna_pin.elements import JointSpring, SineShake
from antenna_pin.errors import AntennaPinError
from antenna_pin.mechanism import with_shaken_base
from antenna_pin.studies.linear import frequency_response, modes, sources_of

LINK = (
    '<link name="{0}"><inertial><origin xyz="{1} 0 0"/><mass value="{2}"/>'
    '<inertia ixx="0.01" iyy="0.02" izz="0.03" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
HINGE = (
    '<joint name="hinge" type="continuous"><parent link="base"/><child link="arm"/>'
    '<origin xyz="0.1 0 0"/><axis xyz="0 0 1"/></joint>'
)
TIP = (
    '<joint name="mount" type="fixed"><parent link="arm"/><child link="tip"/>'
    '<origin xyz="0.5 0 0"/></joint><link name="tip"/>'
)
ARM = LINK.format("base", 0, 3) + HINGE + LINK.format("arm", 0.2, 1.5) + TIP
STIFFNESS, DAMPING, ABOUT = 40.0, 0.3, 0.03 + 1.5 * 0.2**2
FREQUENCIES = np.array([1.0, 3.0, 4.4, 5.0, 20.0])


def shaken(shake):
    urdf = with_shaken_base(Urdf.from_text(f'<robot name="arm">{ARM}</robot>', "arm"), {"s": shake})
    springs = {"hinge": JointSpring(joint="hinge", stiffness=STIFFNESS, damping=DAMPING)}
    system = System(build_mechanism(urdf, "fixed"), drives={"s": shake}, springs=springs)
    q, v = assembled(system, system.neutral())
    return modes(system, q=q, v=v)


def hinge(torque):
    """The hinge's angle for a torque on it that swings, over the frequencies."""
    s = 2j * np.pi * FREQUENCIES
    return torque / (ABOUT * s**2 + DAMPING * s + STIFFNESS)


def test_a_base_along_a_direction():
    """I phi'' + c phi' + k phi = -m l a; the tip has a + r phi'' across, to first order."""
    found = shaken(SineShake(joint="s", direction=(0, 1, 0), frequency=1.0, displacement=1e-3))
    assert "shake.s" in sources_of(found)
    answer = frequency_response(found, "shake.s", ["hinge", "body_acceleration[tip].y"], FREQUENCIES)
    phi = hinge(-1.5 * 0.2)
    tip = 1.0 + 0.5 * phi * (2j * np.pi * FREQUENCIES) ** 2
    assert np.abs(answer.response.values[:, 0] / phi - 1).max() < 1e-9  # of differences of forces
    assert np.abs(answer.response.values[:, 1] / tip - 1).max() < 1e-9
    assert answer.unit.values.tolist() == ["rad/(m/s^2)", "m/s^2/(m/s^2)"]


def test_a_base_about_an_axis():
    """About a point d = 0.3 m behind the hinge: I phi'' + c phi' + k phi = -(I + m l d) alpha."""
    shake = SineShake(joint="s", axis=(0, 0, 1), point=(-0.2, 0, 0), frequency=1.0, displacement=1e-3)
    answer = frequency_response(shaken(shake), "shake.s", "hinge", FREQUENCIES)
    phi = hinge(-(ABOUT + 1.5 * 0.2 * 0.3))
    assert np.abs(answer.response.values[:, 0] / phi - 1).max() < 1e-9
    assert answer.unit.values.tolist() == ["rad/(rad/s^2)"]


def test_without_targets_all_joints_but_the_bases_answer():
    found = shaken(SineShake(joint="s", direction=(0, 1, 0), frequency=1.0, displacement=1e-3))
    assert frequency_response(found, "shake.s").target.values.tolist() == ["hinge"]


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ("body_acceleration[tipp].y", "link 'tipp' is unknown; did you mean tip"),
        ("body_acceleration[tip].u", "body_acceleration[LINK].x, y or z"),
        ("body_acceleration[tip]", "body_acceleration[LINK].x, y or z"),
    ],
)
def test_a_link_or_axis_that_there_is_not_is_refused(target, words):
    found = shaken(SineShake(joint="s", direction=(0, 1, 0), frequency=1.0, displacement=1e-3))
    with pytest.raises(AntennaPinError) as error:
        frequency_response(found, "shake.s", target, FREQUENCIES)
    assert words in str(error.value)
