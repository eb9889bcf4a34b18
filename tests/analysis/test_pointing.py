"""Where an antenna looks, how far off that is, and what of it the indices of ECSS-E-ST-60-10C tell."""

import dataclasses
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import (
    Antenna,
    Command,
    Orbit,
    body_poses,
    body_twists,
    boresight,
    interpolate_attitude,
    interpolation_error,
    pointing_error,
)
from antenna_pin.errors import AntennaPinError, InvalidParameterError, UnknownNameError
from antenna_pin.scenario import OrbitSpec

DISH = Antenna(body="reflector", boresight=(1, 0, 0), up=(0, 0, 1))


@pytest.fixture(scope="module")
def ideal():
    """The antenna with an ideal joint, 0.3 s."""
    return simulate(load_scenario("bai2020", case="case1"), duration=0.3)


def with_q(run, q):
    """Return a run with other configurations."""
    return dataclasses.replace(run, data=run.data.assign(q=(run.data["q"].dims, q)))


def turned(run, change):
    """Return a run with the elevation joint turned further by an angle at each sample."""
    index = list(run.data["configuration"].values).index("elevation")
    q = run.data["q"].values.copy()
    q[:, index] += change
    return with_q(run, q)


def rotated(run, whole):
    """Return a run with the whole system rotated in the world."""
    q = run.data["q"].values.copy()
    q[:, :3] = whole.apply(q[:, :3])
    q[:, 3:7] = (whole * Rotation.from_quat(q[:, 3:7])).as_quat()
    return with_q(run, q)


# --- attitude between samples ---


def tumbling(t):
    """A body that spins up and nods, by Euler angles; its attitude, and its rate in body axes."""
    psi, theta, phi = 0.3 * t + 2.0 * t**2, 0.8 * np.sin(3.0 * t), np.cos(2.0 * t)
    psi_, theta_, phi_ = 0.3 + 4.0 * t, 2.4 * np.cos(3.0 * t), -2.0 * np.sin(2.0 * t)
    attitude = Rotation.from_euler("ZYX", np.column_stack([psi, theta, phi]))
    omega = np.column_stack(
        [
            phi_ - psi_ * np.sin(theta),
            theta_ * np.cos(phi) + psi_ * np.cos(theta) * np.sin(phi),
            -theta_ * np.sin(phi) + psi_ * np.cos(theta) * np.cos(phi),
        ]
    )
    return attitude, omega


def test_attitude_between_samples_is_of_fourth_order():
    """Values and rates at both ends make a cubic; slerp would be of second order."""
    t = np.linspace(0.0, 1.0, 1001)
    exact, _ = tumbling(t)
    errors = []
    for n in (20, 40, 80, 160):
        knots = np.linspace(0.0, 1.0, n + 1)
        at, omega = tumbling(knots)
        found = interpolate_attitude(t, knots, at, omega)
        errors.append((found.inv() * exact).magnitude().max())
        # The estimate from every other sample is of the error's size.
        assert 0.5 < interpolation_error(knots, at, omega) / errors[-1] < 2.0
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([4.0, 4.0, 4.0], abs=0.15)
    assert errors[-1] < 1e-7


def test_attitude_at_samples_is_the_samples_and_of_a_steady_turn_exact():
    """About a fixed axis at a fixed rate the rotation vector is linear: round-off of 2.5 rad."""
    knots = np.array([0.0, 0.1, 0.1, 0.35, 1.0])  # uneven, one twice
    at, omega = tumbling(knots)
    found = interpolate_attitude(knots, knots, at, omega)
    assert (found.inv() * at).magnitude().max() < 1e-15
    knots, t = np.array([0.0, 1.0]), np.linspace(0.0, 1.0, 11)
    spin = np.array([0.4, -2.0, 1.5])
    at = Rotation.from_rotvec(np.outer(knots, spin))
    found = interpolate_attitude(t, knots, at, np.tile(spin, (2, 1)))
    assert (found.inv() * Rotation.from_rotvec(np.outer(t, spin))).magnitude().max() < 4e-15
    at, omega = tumbling(np.array([0.0, 1.0]))
    with pytest.raises(InvalidParameterError, match="times must be from 0 s to 1 s, got 1.5"):
        interpolate_attitude([0.5, 1.5], [0.0, 1.0], at, omega)


def test_rates_of_bodies_are_those_of_their_attitudes(ideal):
    """The rate in the link's axes, against differences of its attitude and position."""
    poses, twists = body_poses(ideal), body_twists(ideal)
    h = 2e-3
    for link in ("shaft1", "reflector"):
        at = Rotation.from_quat(poses["attitude"].sel(body=link).values)
        place = poses["position"].sel(body=link).values
        omega = (at[:-2].inv() * at[2:]).as_rotvec() / h
        speed = at[1:-1].inv().apply(place[2:] - place[:-2]) / h
        # Central differences: (h/2)^2 / 6 of the second derivative of the rate, some 40 rad/s^3.
        assert twists["angular_velocity"].sel(body=link).values[1:-1] == pytest.approx(omega, abs=2e-5)
        assert twists["velocity"].sel(body=link).values[1:-1] == pytest.approx(speed, abs=2e-5)
        assert np.abs(omega).max() > 0.5


# --- where it looks ---


def test_the_boresight_follows_the_joints(ideal):
    """Azimuth about z, elevation about -y: with a body that hardly moves, the joints' own angles."""
    looks = boresight(ideal)
    angles = ideal.data["motion_angle"]
    held = Rotation.from_quat(ideal.data["base_attitude"].values)
    az, el = angles.sel(joint="azimuth").values, angles.sel(joint="elevation").values
    expected = held.apply(np.column_stack([np.cos(el) * np.cos(az), np.cos(el) * np.sin(az), -np.sin(el)]))
    np.testing.assert_allclose(looks["direction"], expected, atol=1e-15)
    assert looks["azimuth"].values == pytest.approx(np.arctan2(expected[:, 1], expected[:, 0]), abs=1e-15)
    assert looks["elevation"].values == pytest.approx(np.arcsin(expected[:, 2]), abs=1e-15)
    assert "orbit_direction" not in looks


def test_azimuth_goes_round_without_a_jump(ideal):
    q = ideal.data["q"].values.copy()
    index = list(ideal.data["configuration"].values).index("azimuth")
    q[:, index] = np.linspace(0.0, 20.0, len(q))
    q[:, 3:7] = (0.0, 0.0, 0.0, 1.0)
    looks = boresight(with_q(ideal, q))
    assert looks["azimuth"].values == pytest.approx(q[:, index], abs=1e-13)


@pytest.mark.parametrize(
    "antenna",
    [DISH, Antenna(body="shaft2", boresight=(0, 2, 1)), Antenna(body="body", boresight=(0.1, 0, -3))],
)
def test_the_antennas_axes_are_right_handed(antenna):
    """Boresight first; up without its part along it; the default up is z, or x near z."""
    x, y, z = antenna.axes.as_matrix().T
    asked = np.array(antenna.boresight) / np.linalg.norm(antenna.boresight)
    second = antenna.up or ((1, 0, 0) if abs(asked[2]) > 0.9 else (0, 0, 1))
    assert x == pytest.approx(asked, abs=1e-15)
    assert np.cross(x, y) == pytest.approx(z, abs=1e-15)
    assert np.dot(z, second) > 0.0
    assert abs(np.dot(y, second)) < 1e-15


# --- orbit ---


def test_rate_of_an_orbit():
    """Kepler's third law; 500 km up it takes 94.6 minutes, and the geostationary orbit a sidereal day."""
    low = Orbit.from_spec(OrbitSpec(altitude="500 km"))
    assert low.period == pytest.approx(94.6 * 60, rel=1e-3)
    high = Orbit.from_spec(OrbitSpec(altitude="35786 km"))
    assert high.period == pytest.approx(86164.1, rel=1e-5)
    assert Orbit.from_spec(OrbitSpec(period="90 min")).rate == pytest.approx(2 * math.pi / 5400, rel=1e-15)
    assert Orbit.from_spec(OrbitSpec(rate="0.06 deg/s")).rate == pytest.approx(math.radians(0.06), rel=1e-15)


def test_orbit_axes_fly_along_the_orbit():
    """The position is against nadir, x along its derivative, y against the normal."""
    orbit = Orbit(rate=0.5, normal=(1, 2, 0), nadir=(2, -1, 3))
    t = np.linspace(0.0, orbit.period, 9)
    x, y, z = (orbit.axes(t).apply(axis) for axis in np.eye(3))
    h = 1e-4
    position = [-orbit.axes(t + step).apply([0, 0, 1]) for step in (-h, h)]
    velocity = (position[1] - position[0]) / (2 * h)
    # Central difference: (rate h)^2 / 6.
    assert velocity == pytest.approx(0.5 * x, abs=1e-9)
    assert -y == pytest.approx(np.tile(np.array([1, 2, 0]) / math.sqrt(5), (9, 1)), abs=1e-15)
    assert z[0] == pytest.approx(np.array([2, -1, 3]) / math.sqrt(14), abs=1e-15)
    assert np.cross(x, y) == pytest.approx(z, abs=1e-15)
    assert z[-1] == pytest.approx(z[0], abs=1e-14)


def test_a_boresight_fixed_in_orbit_axes_turns_in_inertial_ones_at_the_orbital_rate(ideal):
    """And one that stands still in inertial axes turns the other way in the orbit's."""
    orbit = Orbit(rate=1.2)
    time = ideal.data["time"].values
    q = np.tile(ideal.data["q"].values[0], (time.size, 1))
    still = boresight(with_q(ideal, q), DISH, orbit)
    # The normal is +y and nadir -z: x along the velocity turns down, towards nadir, with time.
    assert still["orbit_elevation"].values == pytest.approx(-1.2 * time, abs=1e-15)
    q[:, 3:7] = Rotation.from_rotvec(np.outer(1.2 * time, [0, 1, 0])).as_quat()
    fixed = boresight(with_q(ideal, q), DISH, orbit)
    assert fixed["orbit_direction"].values == pytest.approx(np.tile([1, 0, 0], (time.size, 1)), abs=1e-15)
    turn = np.arccos(np.clip(fixed["direction"].values @ fixed["direction"].values[0], -1, 1))
    assert turn[1:] / time[1:] == pytest.approx(1.2, rel=1e-8)  # the arc cosine's precision near 1


# --- error ---


def test_an_ideal_run_has_no_error_against_itself(ideal):
    found = pointing_error(ideal, ideal)
    assert np.abs(found["error"].values).max() < 5e-16
    assert found["half_cone"].values.max() < 5e-16


def test_the_ideal_run_may_have_another_output_rate(ideal):
    """The interpolation's error falls with the fourth power of its spacing, and the estimate tells it."""
    errors = []
    for rate in (50, 100, 200):
        scenario = load_scenario("bai2020", case="case1", overrides=[f"output.rate={rate}"])
        found = pointing_error(ideal, simulate(scenario, duration=0.3))
        errors.append(found["half_cone"].values.max())
        assert 0.3 < found.attrs["interpolation_error"] / errors[-1] < 3.0
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx([4.0, 4.0], abs=0.3)
    assert errors[-1] < 2e-9


@pytest.mark.parametrize("size", [1e-9, 1e-6, 1e-2, 0.5])
def test_an_elevation_error_is_told_exactly(ideal, size):
    """Elevation turns about the cross axis, in the ideal antenna's axes: no other component, and no loss."""
    change = size * np.sin(np.linspace(0.0, 9.0, ideal.data.sizes["time"]))
    found = pointing_error(turned(ideal, change), ideal)
    # Round-off of the attitudes, some 1e-16, is all.
    assert found["error"].sel(pointing_axis="cross").values == pytest.approx(change, abs=1e-15)
    assert np.abs(found["error"].drop_sel(pointing_axis="cross").values).max() < 1e-15
    assert found["half_cone"].values == pytest.approx(np.abs(change), abs=1e-15)
    assert found["boresight_error"].sel(cross_axis="cross").values == pytest.approx(change, abs=1e-15)


@pytest.mark.parametrize("angle", [1e-12, 1e-9, 1e-4, 1.0, 3.14])
@pytest.mark.parametrize("clocking", [0.0, 1e-9, 0.3, 3.0])
def test_half_cone_is_exact_at_any_angle(ideal, angle, clocking):
    """A turn about the boresight, then one square to it: the half cone is the second alone."""
    from antenna_pin.analysis.pointing import _swing

    about = np.array([0.0, 0.6, -0.8])
    error = Rotation.from_rotvec(angle * about) * Rotation.from_rotvec([clocking, 0.0, 0.0])
    swing, half_cone = _swing(Rotation.from_quat(error.as_quat()[None]))
    assert half_cone[0] == pytest.approx(angle, rel=1e-15 if angle < 3 else 1e-13, abs=0.0)
    # Near pi the axis of the smallest turn is ill-defined, by round-off over pi - angle.
    assert swing[0] == pytest.approx(angle * about[1:], rel=1e-12 if angle < 3 else 1e-11, abs=1e-16)


def test_the_play_of_a_pendulum_turns_its_boresight_by_the_deviation_of_its_angle():
    """On a fixed base and in a plane, the pointing error is the difference of the motion angles."""
    runs = [simulate(load_scenario("pendulum", case=case), duration=0.2) for case in ("planar", "ideal")]
    slot = runs[0].data["joint"].values[0]
    body = body_poses(runs[0])["body"].values[-1]
    axis = Antenna(body=body, boresight=(0, 0, -1), up=(0, 1, 0))
    found = pointing_error(*runs, antenna=axis)
    angle = [run.data["motion_angle"].sel(joint=slot) for run in runs]
    common = np.intersect1d(runs[0].data["time"], runs[1].data["time"])
    deviation = (angle[0].sel(time=common) - angle[1].sel(time=common)).values
    error = np.linalg.norm(found["error"].sel(time=common).values, axis=1)
    assert error == pytest.approx(np.abs(deviation), abs=1e-14)
    assert np.abs(deviation).max() > 1e-5


def test_turning_the_whole_leaves_the_error(ideal):
    """Errors are told in the ideal antenna's own axes: where both runs lie in the world is no matter."""
    change = 0.1 * np.sin(np.linspace(0.0, 9.0, ideal.data.sizes["time"]))
    other = turned(ideal, change)
    whole = Rotation.from_rotvec([1.0, -2.0, 0.5])
    before = pointing_error(other, ideal)
    after = pointing_error(rotated(other, whole), rotated(ideal, whole))
    for name in ("error", "boresight_error", "half_cone"):
        np.testing.assert_allclose(after[name], before[name], atol=1e-15)


def test_a_commanded_direction_in_the_world(ideal):
    """Against the initial boresight the half cone is the angle swept; clocking needs a commanded up."""
    looks = boresight(ideal)["direction"].values
    swept = np.arctan2(np.linalg.norm(np.cross(looks[0], looks), axis=1), looks @ looks[0])
    found = pointing_error(ideal, command=Command(direction=(3, 0, 0)))
    assert list(found["pointing_axis"].values) == ["cross", "up"]
    assert found["half_cone"].values == pytest.approx(swept, abs=1e-15)
    assert np.hypot(*found["error"].values.T) == pytest.approx(swept, abs=1e-15)
    whole = pointing_error(ideal, command=Command(direction=(1, 0, 0), up=(0, 0, 1)))
    attitude = Rotation.from_quat(boresight(ideal)["attitude"].values)
    np.testing.assert_allclose(whole["error"], attitude.as_rotvec(), atol=1e-15)
    assert (found.attrs["against"], found.attrs["interpolation_error"]) == ("direction in world axes", 0.0)


def test_the_scenarios_command_is_taken(ideal):
    """A boresight that keeps still while the orbit turns falls behind at the orbital rate."""
    overrides = {
        "pointing.commanded": "orbit",
        "pointing.direction": [1, 0, 0],
        "pointing.orbit": {"rate": "0.1 rad/s"},
        "drives.azimuth.amplitude": 0.0,
        "drives.elevation.amplitude": 0.0,
    }
    run = simulate(load_scenario("bai2020", case="case1", overrides=overrides), duration=0.3)
    found = pointing_error(run)
    assert found["half_cone"].values == pytest.approx(0.1 * run.data["time"].values, abs=1e-15)


def test_the_example_of_the_docs_points_to_the_earth(ideal):
    """Laid over the shipped scenario: the antenna looks along the orbit, so a right angle off nadir."""
    path = Path(__file__).parents[2] / "scripts" / "examples" / "pointing.toml"
    table = tomllib.loads(path.read_text())
    run = simulate(load_scenario("bai2020", case="case1", overrides=table), duration=0.002)
    found = pointing_error(run)
    assert list(found["pointing_axis"].values) == ["boresight", "cross", "up"]
    assert found["half_cone"].values == pytest.approx(math.pi / 2, abs=1e-5)


def test_what_cannot_be_compared_is_refused_in_one_line(ideal):
    short = simulate(load_scenario("bai2020", case="case1"), duration=0.1)
    bare = dataclasses.replace(ideal, scenario=None)
    direct = Command(direction=(1, 0, 0))
    for call, message in (
        (lambda: pointing_error(ideal), "got neither an ideal run nor a commanded direction"),
        (
            lambda: pointing_error(ideal, short),
            "covers the time of the other, 0 s to 0.3 s, got '0 s to 0.1 s'",
        ),
        (lambda: pointing_error(ideal, ideal, command=direct), "command must be left out"),
        (
            lambda: pointing_error(ideal, command=Command(direction=(1, 0, 0), frame="orbit")),
            "set pointing.orbit",
        ),
        (lambda: boresight(bare), r"must have a table \[pointing\]"),
        (
            lambda: Antenna(body="b", boresight=(0, 0, 0)),
            "boresight must be three finite numbers, not all zero",
        ),
        (lambda: Command(direction=(1, 0, 0), up=(2, 0, 0)), "direction_up must not lie along direction"),
        (lambda: Command(direction=(1, 0, 0), frame="moon"), "frame 'moon' is unknown"),
        (lambda: Orbit(rate=0.0), "Orbit: rate must be positive and finite .rad.s., got 0.0"),
        (lambda: Orbit(rate=1.0, normal=(0, 0, 1)), "nadir must be perpendicular to normal"),
    ):
        with pytest.raises(AntennaPinError, match=message) as refused:
            call()
        assert "\n" not in str(refused.value)
    with pytest.raises(UnknownNameError, match="link 'dish' is unknown"):
        boresight(ideal, Antenna(body="dish", boresight=(1, 0, 0)))
