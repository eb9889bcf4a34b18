"""The gradient of gravity on an orbit: relative orbits, libration, roll and yaw, two bodies."""

import dataclasses
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.analysis import Orbit, orbit_angles
from antenna_pin.dynamics import JointSpring
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


def test_roll_and_yaw_swing_with_their_two_frequencies():
    """Against the characteristic equation of the linear motion, by amplitudes of a microradian."""
    orbit = Orbit(rate=RATE)
    q, v = start(orbit, (0.0, 2e-6, 1e-6))
    step = 400.0
    run = simulate(
        body(), duration=60 * step, q=q, v=v, settings=dataclasses.replace(TIGHT, output_rate=1 / step)
    )
    angles = orbit_angles(run)
    t = run.data["time"].values
    even = [int(np.argmin(np.abs(t - k * step))) for k in range(61)]
    roll = angles["roll"].values[even]
    # Of two frequencies: r(k+2) + r(k-2) = a (r(k+1) + r(k-1)) + b r(k).
    rows = np.column_stack([roll[3:-1] + roll[1:-3], roll[2:-2]])
    a, b = np.linalg.lstsq(rows, roll[4:] + roll[:-4], rcond=None)[0]
    cosines = np.roots([4.0, -2.0 * a, -b - 2.0])
    found = np.sort(np.arccos(cosines)) / step
    i_x, i_y, i_z = INERTIA
    k_r, k_y = (i_y - i_z) / i_x, (i_y - i_x) / i_z
    squares = np.roots([1.0, -(1.0 + 3.0 * k_r + k_r * k_y), 4.0 * k_r * k_y])
    exact = RATE * np.sort(np.sqrt(squares))
    # Amplitudes of 1e-6 leave squares of that; the fit of nearly equal numbers takes the rest.
    np.testing.assert_allclose(found, exact, rtol=1e-5)


SLIDE = """<robot name="pair"><link name="one"><inertial><origin xyz="0 0 1.5"/><mass value="5"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="boom" type="prismatic"><parent link="one"/><child link="two"/><origin xyz="0 0 -1"/>
<axis xyz="0 0 -1"/><limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
<link name="two"><inertial><mass value="8"/>
<inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def test_two_masses_on_a_spring_move_as_points_in_the_field():
    """Against their equations of motion as two points, in inertial axes, with the spring between them."""
    mechanism = build_mechanism(Urdf.from_text(SLIDE, "pair.urdf"), "free")
    field, spring = GravityGradient(rate=RATE), JointSpring(joint="boom", stiffness=2e-5, rest_angle=0.0)
    system = System(mechanism, springs={"coil": spring}, elements={"forces": {"field": field}})
    orbit = Orbit(rate=RATE)
    attitude, spin = start(orbit, (0.4, 0.0, 0.0))
    q, v = system.neutral(), np.zeros(system.model.nv)
    q[:7], v[:6] = attitude, spin
    axis = Rotation.from_quat(attitude[3:7]).apply([0.0, 0.0, 1.0])
    # About the common centre, 2.5 m from one to the other.
    centre = (5.0 * 1.5 - 8.0 * 1.0) / 13.0
    q[:3] = -centre * axis
    body_rate = v[3:6].copy()
    v[:3] = -np.cross(body_rate, [0.0, 0.0, centre])
    run = simulate(system, duration=3000.0, q=q, v=v, settings=TIGHT)
    spin_world = Rotation.from_quat(attitude[3:7]).apply(body_rate)
    points = np.array([(1.5 - centre) * axis, (-1.0 - centre) * axis])
    speeds = np.cross(spin_world, points)
    nadir, ahead = np.array([0.0, 0.0, -1.0]), np.cross([0.0, 1.0, 0.0], [0.0, 0.0, -1.0])

    def rates(t, y):
        p, w = y[:6].reshape(2, 3), y[6:]
        e = math.cos(RATE * t) * nadir + math.sin(RATE * t) * ahead
        field = RATE**2 * (3.0 * np.outer(p @ e, e) - p)
        way = p[1] - p[0]
        length = float(np.linalg.norm(way))
        pull = 2e-5 * (length - 2.5) * way / length
        return np.concatenate([w, (field + np.array([pull / 5.0, -pull / 8.0])).ravel()])

    first = np.concatenate([points.ravel(), speeds.ravel()])
    found = solve_ivp(rates, (0.0, 3000.0), first, method="DOP853", rtol=1e-12, atol=1e-13)
    p = found.y[:6, -1].reshape(2, 3)
    length = 2.5 + run.data["slide_position"].values[-1, 0]
    # The bodies are no points: their own moments of 1e-3 beside 19 kg m^2.
    assert length == pytest.approx(float(np.linalg.norm(p[1] - p[0])), rel=2e-4, abs=0.0)
    assert abs(length - 2.5) > 0.05  # and the spring does give
    kept = run.summary()["conservation"]
    assert kept["energy_error_relative"] < 1e-9 and kept["angular_momentum_drift_relative"] < 1e-9


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
