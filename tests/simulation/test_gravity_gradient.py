"""The gradient of gravity on an orbit: relative orbits, libration, roll and yaw, two bodies."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.analysis import Orbit, orbit_angles
from antenna_pin.elements import GravityGradient
from antenna_pin.errors import AntennaPinError

RATE = 1.1e-3  # [rad/s]
TIGHT = RunSettings(rtol=1e-12, max_step=500.0, output_rate=0.02, engine="compiled")
INERTIA = np.array([120.0, 150.0, 40.0])  # roll, pitch, yaw: stable when aligned [kg m^2]

BODY = """<robot name="body"><link name="body"><inertial><mass value="50"/>
<inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def body(inertia=INERTIA, **changes):
    mechanism = build_mechanism(Urdf.from_text(BODY.format(*inertia), "body.urdf"), "free")
    return System(mechanism, elements={"forces": {"field": GravityGradient(rate=RATE, **changes)}})


def start(orbit, angles, rates=(0.0, 0.0, 0.0)):
    """Attitude by pitch, roll and yaw from orbit-fixed axes, at rates relative to these, at t = 0."""
    turn = orbit.axes(0.0)[0] * Rotation.from_euler("YXZ", angles)
    q = np.array([0.0, 0.0, 0.0, *turn.as_quat()])
    spin = RATE * np.array(orbit.normal) + orbit.axes(0.0)[0].apply(rates)
    return q, np.concatenate([np.zeros(3), turn.inv().apply(spin)])


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_body_off_the_reference_point_moves_as_hill_says(engine):
    """Relative orbits in closed form (Clohessy and Wiltshire), in orbit-fixed axes: x ahead, z down."""
    system, orbit = body(), Orbit(rate=RATE)
    axes = orbit.axes(0.0)[0]
    first, speed = np.array([3.0, -2.0, 5.0]), np.array([1e-3, 2e-3, -3e-3])
    q, v = start(orbit, (0.0, 0.0, 0.0))
    q[:3] = axes.apply(first)
    turning = np.array([0.0, -RATE, 0.0])
    v[:3] = Rotation.from_quat(q[3:]).inv().apply(axes.apply(speed + np.cross(turning, first)))
    span = 6000.0
    run = simulate(system, duration=span, q=q, v=v, settings=dataclasses.replace(TIGHT, engine=engine))
    t = run.data["time"].values
    found = orbit.axes(t).inv().apply(run.data["base_position"].values)
    n, s, c = RATE, np.sin(RATE * t), np.cos(RATE * t)
    # Radial outwards, along and across track, as they are usually written.
    x0, y0, z0, u0, w0, h0 = -first[2], first[0], -first[1], -speed[2], speed[0], -speed[1]
    radial = (4 - 3 * c) * x0 + s / n * u0 + 2 / n * (1 - c) * w0
    along = 6 * (s - n * t) * x0 + y0 - 2 / n * (1 - c) * u0 + (4 * s - 3 * n * t) / n * w0
    normal = z0 * c + h0 / n * s
    exact = np.column_stack([along, -normal, -radial])
    # The run's tolerance over a revolution of some hundred metres.
    np.testing.assert_allclose(found, exact, rtol=0, atol=1e-9 * np.abs(exact).max())
    kept = run.summary()["conservation"]
    assert kept["energy_error_relative"] < 1e-9
    assert kept["linear_momentum_drift_relative"] is None or kept["linear_momentum_drift"] < 1e-9


@pytest.mark.parametrize("amplitude", [0.01, 0.5, 1.3])
def test_pitch_swings_with_the_period_of_the_elliptic_integral(amplitude):
    r"""I_y theta'' = -3 n^2 (I_x - I_z) sin(theta) cos(theta): a pendulum of the double angle."""
    orbit = Orbit(rate=RATE)
    q, v = start(orbit, (amplitude, 0.0, 0.0))
    k = RATE * math.sqrt(3.0 * (INERTIA[0] - INERTIA[2]) / INERTIA[1])
    period = 4.0 * ellipk(math.sin(amplitude) ** 2) / k
    run = simulate(body(), duration=period, q=q, v=v, settings=TIGHT)
    pitch = orbit_angles(run)["pitch"].values
    quarter = simulate(body(), duration=period / 4.0, q=q, v=v, settings=TIGHT)
    # Back where it began, and through nadir after a quarter: the run's tolerance over a libration.
    assert pitch[-1] == pytest.approx(amplitude, rel=0.0, abs=1e-11)
    assert abs(orbit_angles(quarter)["pitch"].values[-1]) < 1e-9 * amplitude
    assert np.abs(orbit_angles(run)[["roll", "yaw"]].to_array().values).max() < 1e-12


def test_a_tilted_orbit_is_the_same_turned():
    """Any normal and any nadir: the motion turns with them."""
    turn = Rotation.from_rotvec([0.3, -0.8, 0.4])
    orbit = Orbit(rate=RATE, normal=tuple(turn.apply([0, 1, 0])), nadir=tuple(turn.apply([0, 0, -1])))
    runs = []
    for one, system in (
        (Orbit(rate=RATE), body()),
        (orbit, body(normal=orbit.normal, nadir=orbit.nadir)),
    ):
        q, v = start(one, (0.3, 0.2, -0.1))
        runs.append(orbit_angles(simulate(system, duration=2000.0, q=q, v=v, settings=TIGHT)))
    for name in ("pitch", "roll", "yaw"):
        np.testing.assert_allclose(*(run[name].values for run in runs), rtol=0, atol=1e-11)


def test_angles_ask_for_an_orbit():
    mechanism = build_mechanism(Urdf.from_text(BODY.format(*INERTIA), "body.urdf"), "free")
    run = simulate(System(mechanism), duration=0.1, v=np.array([0, 0, 0, 0, RATE, 0]), settings=TIGHT)
    with pytest.raises(
        AntennaPinError, match="orbit_angles: orbit must be given, because the run has no gravity gradient"
    ):
        orbit_angles(run)
    # Turning as the orbit does it stays as it stands in that: turned half about, as the world's axes are.
    angles = orbit_angles(run, orbit=Orbit(rate=RATE))
    np.testing.assert_allclose(np.ptp(angles.to_array().values, axis=1), 0.0, rtol=0, atol=1e-12)


def test_what_does_not_go_with_an_orbit_is_refused():
    with pytest.raises(AntennaPinError, match=r"gravity must be none beside what differs of it on an orbit"):
        mechanism = build_mechanism(Urdf.from_text(BODY.format(*INERTIA), "body.urdf"), "free", (0, 0, -9.8))
        System(mechanism, elements={"forces": {"field": GravityGradient(rate=RATE)}})
    with pytest.raises(AntennaPinError, match="nadir must be at right angles to normal"):
        GravityGradient(rate=RATE, nadir=(0.0, 1.0, -1.0))
    with pytest.raises(
        AntennaPinError, match="rate must be given, or mu and radius in its place, got neither"
    ):
        GravityGradient()
    with pytest.raises(AntennaPinError, match="radius must be given beside mu"):
        GravityGradient(mu=3.986e14)
    earth = GravityGradient(mu=3.986004418e14, radius=6.878e6)
    assert earth.orbital_rate == pytest.approx(math.sqrt(3.986004418e14 / 6.878e6**3), rel=1e-15)
