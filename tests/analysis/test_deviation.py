"""Deviation from the ideal run: of signals in closed form, and of runs whose difference is known."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import base_motion, deviation
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.trajectory.schema import VARIABLES


def made_up(time, angle, rate, acceleration, contacts=(), case="made up", joints=("hinge",)):
    """A run of joints that all move alike, without a base."""
    values = {"motion_angle": angle, "motion_rate": rate, "motion_acceleration": acceleration}
    time = np.asarray(time)
    coords = {"time": time, "joint": list(joints)} | ({"contact": list(contacts)} if contacts else {})
    columns = {
        name: (
            ("time", "joint"),
            np.repeat(x(time)[:, None], len(joints), 1),
            {"units": VARIABLES[name].units},
        )
        for name, x in values.items()
    }
    return xr.Dataset(columns, coords=coords, attrs={"case": case})


def ideal(time, **more):
    return made_up(
        time, lambda t: np.sin(3 * t), lambda t: 3 * np.cos(3 * t), lambda t: -9 * np.sin(3 * t), **more
    )


def deviating(time, **more):
    """The ideal plus 1e-3 t^2."""
    return made_up(
        time,
        lambda t: np.sin(3 * t) + 1e-3 * t**2,
        lambda t: 3 * np.cos(3 * t) + 2e-3 * t,
        lambda t: -9 * np.sin(3 * t) + 2e-3,
        **more,
    )


GRID = np.linspace(0.0, 4.0, 4001)
CROWDED = np.sort(np.concatenate([GRID, np.random.default_rng(1).uniform(0.0, 4.0, 500), GRID[50:90]]))


def test_a_known_deviation_is_found():
    """Spline errors: h^4/384 times the fourth derivative, 2e-13 of the angle, 2e-12 of the acceleration."""
    found = deviation(deviating(CROWDED), ideal(GRID))
    assert found.data["angle"].values[:, 0] == pytest.approx(1e-3 * CROWDED**2, abs=1e-12)
    assert found.data["acceleration"].values == pytest.approx(2e-3, abs=1e-9)
    angle = found["hinge angle"]
    assert (angle.maximum, angle.time_of_maximum, angle.end) == pytest.approx((0.016, 4.0, 0.016), rel=1e-9)
    assert angle.rms == pytest.approx(0.016 / np.sqrt(5.0), rel=1e-5)  # of t^2 over (0, 4); trapezoids
    assert angle.units == "rad"
    assert angle.growth.kind == "power"
    assert angle.growth.exponent == pytest.approx(2.0, rel=0.01)
    assert found["hinge rate"].maximum == pytest.approx(8e-3, rel=1e-6)
    assert found["hinge acceleration"].growth.kind == "none"  # level


def test_runs_are_compared_while_both_last():
    late = deviation(deviating(GRID), ideal(np.linspace(0.0, 2.5, 2501)))
    assert late.data["time"].values[-1] == 2.5
    assert late["hinge angle"].end == pytest.approx(1e-3 * 2.5**2, rel=1e-9)
    early = deviation(deviating(GRID[:1000]), ideal(GRID))
    assert early.data.sizes["time"] == 1000


@pytest.mark.parametrize(
    ("run", "reference", "joint", "said"),
    [
        (deviating(GRID), ideal(GRID, contacts=["hinge.radial"]), None, "a run without contacts"),
        (deviating(GRID[:1]), ideal(GRID), None, "two samples or more"),
        (deviating(GRID), ideal(GRID[:1]), None, "two samples or more"),
        (deviating(GRID + 10.0), ideal(GRID), None, "with 0 samples from 0 to 4 s"),
        (deviating(GRID), ideal(GRID, joints=["other"]), None, "of the same mechanism"),
        (deviating(GRID), ideal(GRID), "hing", "did you mean hinge"),
    ],
)
def test_what_cannot_be_compared_is_refused(run, reference, joint, said):
    with pytest.raises((InvalidParameterError, UnknownNameError), match=said):
        deviation(run, reference, joint)


@pytest.fixture(scope="module")
def antennas():
    overrides = ["clearance.elevation.geometry=closed-form"]
    ideal_run = simulate(load_scenario("bai2020", case="case1"), duration=0.2)
    coarse = simulate(load_scenario("bai2020", case="case1", overrides=["output.rate=300"]), duration=0.2)
    play = simulate(load_scenario("bai2020", case="case3", overrides=overrides), duration=0.2)
    return ideal_run, coarse, play


def test_an_ideal_run_does_not_deviate_from_itself(antennas):
    """Sampled at another rate: interpolation leaves h^4/384 of a motion of 1 Hz, and the run's own 1e-9."""
    ideal_run, coarse, _ = antennas
    found = deviation(ideal_run, coarse)
    motion = {"angle": 0.05, "rate": 0.6, "acceleration": 6.0}
    for quantity, size in motion.items():
        assert np.abs(found.data[quantity].values).max() < 1e-8 * size
    for name in ("base_position", "base_attitude", "base_velocity", "base_angular_velocity"):
        assert np.abs(found.data[name].values).max() < 1e-10
    assert deviation(ideal_run, ideal_run)["elevation angle"].maximum == 0.0


def test_play_makes_the_antenna_deviate(antennas):
    ideal_run, _, play = antennas
    found = deviation(play, ideal_run)
    assert list(found.data["joint"].values) == ["azimuth", "elevation"]
    last = play.data["motion_angle"].values[-1] - ideal_run.data["motion_angle"].values[-1]
    assert found.data["angle"].values[-1] == pytest.approx(last, abs=1e-14)  # both have a sample there
    base = play.data["base_position"].values[-1] - ideal_run.data["base_position"].values[-1]
    assert found["base position"].end == pytest.approx(np.linalg.norm(base), rel=1e-9)
    one = deviation(play, ideal_run, "elevation")
    assert list(one.data["joint"].values) == ["elevation"]
    assert one["elevation angle"] == found["elevation angle"]
    with pytest.raises(UnknownNameError):
        one["azimuth angle"]


def test_rotation_goes_on_beyond_half_a_turn():
    """A base that turns about z at 1 rad/s for 20 s."""
    t = np.linspace(0.0, 20.0, 201)
    half = 0.5 * t
    zero = np.zeros((t.size, 6))
    rates = zero + [0, 0, 0, 0, 0, 1.0]
    names = [f"base.{part}" for part in ("vx", "vy", "vz", "wx", "wy", "wz")]
    quaternion = np.column_stack([0 * t, 0 * t, np.sin(half), np.cos(half)])
    data = xr.Dataset(
        {
            "base_position": (("time", "axis"), zero[:, :3]),
            "base_attitude": (("time", "quaternion"), quaternion),
            "v": (("time", "coordinate"), rates),
            "a": (("time", "coordinate"), zero),
        },
        coords={"time": t, "axis": ["x", "y", "z"], "coordinate": names},
    )
    assert base_motion(data)["rotation"].values[:, 2] == pytest.approx(t, abs=1e-12)
    with pytest.raises(InvalidParameterError, match="one with a free base"):
        base_motion(ideal(GRID))
    # Sampled ten times coarser and with quaternions of either sign it is the same motion: h^4/384/2^4.
    coarse = data.isel(time=slice(0, None, 10)).copy(deep=True)
    coarse["base_attitude"][1::2] *= -1.0
    found = deviation(data, coarse)
    assert np.abs(found.data["base_attitude"].values).max() < 3e-4


def test_a_slider_deviates_from_the_ideal_one_along_its_way(slider_run, ideal_slider_run):
    """Without friction nothing but the walls' tilt acts along the guide: the ideal one goes on at 0.3 m/s."""
    found = deviation(slider_run, ideal_slider_run)
    assert [one.of for one in found.measures] == ["slide position", "slide rate", "slide acceleration"]
    away = slider_run.data["slide_position"].values[-1, 0] - 0.3 * 0.1
    assert found["slide position"].end == pytest.approx(away, rel=1e-9, abs=1e-15)
    assert found["slide position"].units == "m"
