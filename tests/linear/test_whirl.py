"""A rotor on bearings: forward and backward whirl against the characteristic equation."""

import numpy as np
import pinocchio as pin
import pytest

from antenna_pin import Urdf, build_mechanism, simulate
from antenna_pin.base.settings import RunSettings
from antenna_pin.dynamics import System
from antenna_pin.elements import BallBearing, StiffnessBearing, moved
from antenna_pin.studies.linear import modes

MASS, ACROSS, ALONG, HEIGHT = 2.0, 0.006, 0.01, 0.03
ROTOR = f"""<robot name="rotor"><link name="hull"><inertial><mass value="{{hull}}"/>
<inertia ixx="{{inertia}}" iyy="{{inertia}}" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="disc"><inertial><origin xyz="0 0 {HEIGHT}"/><mass value="{MASS}"/>
<inertia ixx="{ACROSS}" iyy="{{across}}" izz="{ALONG}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="axle" type="continuous"><parent link="hull"/><child link="disc"/>
<origin xyz="0 0 0.0"/><axis xyz="0 0 1"/></joint></robot>"""
BEARING = StiffnessBearing(joint="axle", radial=2e6, axial=3e6, tilt=4e3, coupling=1.5e4, offset=-0.02)


def rotor(*bearings, base="fixed", across=ACROSS, hull=5.0, inertia=1.0):
    text = ROTOR.format(hull=hull, inertia=inertia, across=across)
    mechanism = build_mechanism(Urdf.from_text(text, "rotor.urdf").variant(joints={"axle": "free"}), base)
    return System(mechanism, elements={"bearings": {f"b{k}": one for k, one in enumerate(bearings)}})


def spinning(system, spin, turned=0.0):
    """Configuration and velocity of a rotor that has turned."""
    v = np.zeros(system.model.nv)
    v[-1] = spin
    step = np.zeros(system.model.nv)
    step[-1] = turned
    return pin.integrate(system.model, system.neutral(), step), v


def whirl(stiffness, spin):
    """Angular frequencies of u = x + i y and w = ty - i tx, all exp(i omega t), negative ones backward.

    m u'' + k1 u + k2 w = 0 and A w'' - i C spin w' + k2 u + k3 w = 0, about the mass centre.
    """
    k1, k2, k3 = stiffness[0, 0], stiffness[0, 4], stiffness[4, 4]
    equation = np.polymul([-MASS, 0.0, k1], [-ACROSS, ALONG * spin, k3])
    equation = np.polysub(equation, [k2**2])
    found = np.roots(equation).real
    for _ in range(5):  # Newton's steps to the last digit
        found -= np.polyval(equation, found) / np.polyval(np.polyder(equation), found)
    return np.sort(found)


@pytest.mark.parametrize("spin", [0.0, 30.0, 2000.0])
def test_forward_and_backward_whirl(spin):
    """Both whirls of both pairs, and the axial motion, at a spin; turned by any angle."""
    system = rotor(BEARING)
    q, v = spinning(system, spin, 0.7)
    found = modes(system, q=q, v=v, moving=True)
    expected = np.abs(whirl(moved(BEARING.stiffness, HEIGHT + 0.02), spin))
    expected = np.sort([*expected, np.sqrt(BEARING.axial / MASS)]) / (2.0 * np.pi)
    # Derivatives of forces are good to 1e-11 of the largest.
    # At rest the free turn counts as a motion too.
    assert np.sort(found.frequency)[-5:] == pytest.approx(expected, rel=1e-8, abs=0.0)
    if spin == 2000.0:
        assert expected[-1] > 3.0 * expected[-3]  # the splitting is seen


def test_bearings_that_are_stiffer_one_way():
    """The rotor's axes turn, the bearing does not: frequencies do not depend on how far it has turned."""
    matrix = BEARING.stiffness
    matrix[0, 0] *= 1.4
    uneven = StiffnessBearing(joint="axle", matrix=tuple(matrix.ravel()), offset=-0.02)
    system = rotor(uneven)
    found = []
    for turned in (0.0, 0.9):
        q, v = spinning(system, 500.0, turned)
        found.append(np.sort(modes(system, q=q, v=v, moving=True).frequency))
    assert found[0] == pytest.approx(found[1], rel=1e-9, abs=0.0)
    # By hand: M z'' + (D + G) z' + K z = 0 in axes that do not spin, z = (x, y, tx, ty) at the mass centre.
    k = moved(matrix, HEIGHT + 0.02)[np.ix_([0, 1, 3, 4], [0, 1, 3, 4])]
    mass = np.diag([MASS, MASS, ACROSS, ACROSS])
    gyro = np.zeros((4, 4))
    gyro[2, 3], gyro[3, 2] = ALONG * 500.0, -ALONG * 500.0
    whole = np.block(
        [[np.zeros((4, 4)), np.eye(4)], [-np.linalg.solve(mass, k), -np.linalg.solve(mass, gyro)]]
    )
    by_hand = np.sort(np.abs(np.linalg.eigvals(whole).imag))[::2] / (2.0 * np.pi)
    axial = np.sqrt(BEARING.axial / MASS) / (2.0 * np.pi)
    assert found[0] == pytest.approx(np.sort([*by_hand, axial]), rel=1e-8, abs=0.0)


def test_a_rotor_that_is_not_round_is_seen_in_its_own_axes():
    """There its equations stay what they are, on bearings that are the same all round."""
    system = rotor(BEARING, across=1.5 * ACROSS)
    q, v = spinning(system, 500.0)
    found = modes(system, q=q, v=v, moving=True)
    assert not any("axes" in note for note in found.notes)


def test_free_floating_the_hull_takes_part():
    """Along the axis both masses swing against each other: k (1/m + 1/M), whatever the spin."""
    system = rotor(BEARING, base="free", hull=3.0)
    q, v = spinning(system, 800.0, 0.4)
    found = modes(system, q=q, v=v, moving=True).frequency
    expected = np.sqrt(BEARING.axial * (1.0 / MASS + 1.0 / 3.0)) / (2.0 * np.pi)
    assert np.abs(found - expected).min() < 1e-8 * expected


def test_whirl_in_time_is_whirl_of_the_modes():
    """A run set off in one forward whirl comes round at the frequency that modes give."""
    spin = 2000.0
    system = rotor(BEARING)
    stiffness = moved(BEARING.stiffness, HEIGHT + 0.02)
    omega = whirl(stiffness, spin)[-1]
    # Of the shape: u over w from the first equation; so small that the motion is linear to w^2.
    w = 1e-6
    u = stiffness[0, 4] * w / (MASS * omega**2 - stiffness[0, 0])
    q, v = spinning(system, spin)
    # Coordinates at the joint's origin: x = u - height w, with tilt about y, w real at the start.
    v[:] = 0.0
    step = np.array([0.0, 0.0, 0.0, 0.0, w, 0.0])
    centre = pin.exp3(step[3:])
    x = np.array([u, 0.0, HEIGHT]) - centre @ np.array([0.0, 0.0, HEIGHT])
    q = np.concatenate([x, pin.Quaternion(centre).coeffs()])
    rate = np.array([-omega * w, 0.0, 0.0]) + centre @ np.array([0.0, 0.0, spin])
    speed = np.array([0.0, omega * u, 0.0]) - np.cross(rate, centre @ np.array([0.0, 0.0, HEIGHT]))
    v = np.concatenate([centre.T @ speed, centre.T @ rate])
    times = 20 * 2.0 * np.pi / omega
    run = simulate(
        system, q=q, v=v, duration=times, settings=RunSettings(rtol=1e-11, output_rate=20.0 / times)
    )
    tilt = run.data.bearing_tilt.values[:, 0]
    # Each sample is one period on: the axis is where it was; 1e-6 of the whirl over 20 of its turns.
    assert np.abs(tilt[:, 1] - w).max() < 1e-6 * w
    assert np.abs(tilt[:, 0]).max() < 1e-6 * w


SIZES = {
    "machine": {"count": 12, "ball_diameter": 6e-3, "pitch_diameter": 40e-3, "preload": 50.0, "spread": 0.02},
    # Balls pressed in by 2 nm: tilts by a nanoradian, which make 2 pm at their circle, would be round-off.
    "tiny": {"count": 7, "ball_diameter": 4e-4, "pitch_diameter": 2e-3, "preload": 3e-4, "spread": 0.001},
}


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("spin", [0.0, 300.0])
def test_balls_summed_over_are_their_stiffness_at_the_preload(spin, size):
    """Small motions of the nonlinear bearing are those of its matrix."""
    found = []
    for by in ("balls", "linear"):
        bearing = BallBearing(
            joint="axle", contact_angle=0.26, arrangement="back-to-back", by=by, **SIZES[size]
        )
        system = rotor(bearing)
        q, v = spinning(system, spin, 0.2)
        found.append(modes(system, q=q, v=v, moving=True))
        assert not any("kink" in note for note in found[-1].notes)
    # Differences over hundredths of the balls' depth, of sixth order.
    assert found[0].frequency == pytest.approx(found[1].frequency, rel=1e-9, abs=0.0)
