"""A controller of angle and rate: closed forms, its limit, its reference, what it spends, where it acts."""

import math
import re
from pathlib import Path

import numpy as np
import pytest
from wheel import INERTIA, wheel_urdf

from antenna_pin import RunSettings, System, build_mechanism, load_scenario, simulate
from antenna_pin.elements import PDController
from antenna_pin.scenario import DRIVE_SPECS

PANEL = Path(__file__).parents[2] / "scripts" / "examples" / "panel"

TIGHT = RunSettings(rtol=1e-12, output_rate=100.0)


def follow(kind="continuous", start=(0.0, 0.0), duration=2.0, settings=TIGHT, **given):
    """Run a wheel, or a sled of the same inertia, that is made to follow a reference."""
    mechanism = build_mechanism(wheel_urdf(kind, mass=INERTIA), base="fixed")
    system = System(mechanism, drives={"motor": PDController(joint="axle", **given)})
    q = [math.cos(start[0]), math.sin(start[0])] if kind == "continuous" else [start[0]]
    return simulate(system, duration=duration, q=q, v=[start[1]], settings=settings).data


def motion(data):
    name = "motion_angle" if "axle" in data["joint"].values else "slide_position"
    return data["time"].values, data[name].values[:, 0]


def oscillation(t, start, rate, kp, kd):
    """Angle and rate of the damped oscillator about zero."""
    decay, omega = kd / (2.0 * INERTIA), math.sqrt(kp / INERTIA - (kd / (2.0 * INERTIA)) ** 2)
    sine = (rate + decay * start) / omega
    return np.exp(-decay * t) * (start * np.cos(omega * t) + sine * np.sin(omega * t))


@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_about_a_ramp_a_wheel_is_a_damped_oscillator(kind):
    """The error of a reference that grows steadily obeys the free equation, through whole turns too."""
    t, angle = motion(follow(kind, (0.3, -0.2), duration=6.0, kp=8.0, kd=0.4, angle=0.1, rate=1.7))
    expected = 0.1 + 1.7 * t + oscillation(t, 0.3 - 0.1, -0.2 - 1.7, 8.0, 0.4)
    assert angle == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("rtol", [1e-6, 1e-12])
def test_a_limited_torque_is_constant_then_linear_then_constant(rtol):
    """From rest the demand, of the angle alone, is beyond the limit but near the reference.

    A step that went across one of the two kinks would show at any tolerance: each is where a step ends.
    """
    kp, limit, wanted = 10.0, 2.0, 1.0
    settings = RunSettings(rtol=rtol, output_rate=100.0)
    given = {"kp": kp, "limit": limit, "angle": wanted}
    t, angle = motion(follow("revolute", duration=1.2, settings=settings, **given))
    near, omega, pull = limit / kp, math.sqrt(kp / INERTIA), limit / INERTIA
    first = math.sqrt(2.0 * (wanted - near) / pull)  # where kp (wanted - angle) is the limit
    speed = pull * first
    swing = math.hypot(near, speed / omega)
    turned = math.asin(near / swing)
    second = first + 2.0 * turned / omega
    assert 0.5 < first < second < 1.0
    expected = np.select(
        [t < first, t < second],
        [0.5 * pull * t**2, wanted + swing * np.sin(omega * (t - first) - turned)],
        wanted + near + speed * (t - second) - 0.5 * pull * (t - second) ** 2,
    )
    # The tolerance of the linear part; its kinks add nothing.
    assert angle == pytest.approx(expected, abs=max(1e-12, 0.01 * rtol))


def test_the_ledger_of_a_controller_closes():
    """What it puts in, with braking counted as less, is the kinetic energy; its size is the gross work."""
    data = follow(duration=3.0, kp=30.0, kd=0.5, limit=2.0, angle=1.0, amplitude=0.4, frequency=1.5)
    torque = data["drive_torque"].values[:, 0]
    assert torque.max() == 2.0 and torque.min() == -2.0 and (abs(torque) < 1.9).any()
    work, gross = data["drive_work"].values[:, 0], data["drive_gross_work"].values[:, 0]
    kinetic = 0.5 * INERTIA * data["motion_rate"].values[:, 0] ** 2
    assert work == pytest.approx(kinetic, abs=1e-9)
    assert abs(data["energy_error"].values).max() < 1e-9 * gross[-1]
    assert gross[-1] > 1.5 * abs(work[-1])


def test_its_reference_and_error_stand_in_the_result():
    data = follow(kp=20.0, kd=1.0, limit=3.0, amplitude=0.5, frequency=0.8)
    t, angle = motion(data)
    wanted = 0.5 * np.sin(2.0 * math.pi * 0.8 * t)
    assert data["control_reference"].values[:, 0] == pytest.approx(wanted, abs=1e-14)
    assert data["control_error"].values[:, 0] == pytest.approx(wanted - angle, abs=1e-14)
    slope = 0.5 * 2.0 * math.pi * 0.8 * np.cos(2.0 * math.pi * 0.8 * t) - data["motion_rate"].values[:, 0]
    demand = 20.0 * (wanted - angle) + slope
    assert data["drive_torque"].values[:, 0] == pytest.approx(np.clip(demand, -3.0, 3.0), abs=1e-12)


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "kp must be above zero, or kd, got neither"),
        ({"kp": 1.0, "amplitude": 1.0}, "frequency must be given beside an amplitude, got none"),
        ({"kp": 1.0, "frequency": 1.0}, "amplitude must be given beside a frequency, got none"),
        ({"kp": 1.0, "time": (0.0, 1.0)}, "reference must be given beside time, got none"),
        (
            {"kp": 1.0, "time": (0, 1), "reference": (0,)},
            "reference must be as many numbers as time, 2, got 1",
        ),
        ({"kp": 1.0, "axis": "shaft"}, "axis must be bearing or journal, got 'shaft'"),
    ],
)
def test_refuses_what_is_no_controller(given, message):
    with pytest.raises(ValueError, match=f"^{re.escape(f'PDController: {message}')}$"):
        PDController(joint="axle", **given)


def test_refuses_a_run_beyond_its_table():
    with pytest.raises(
        ValueError, match="drive 'motor': time must be a table that covers the run from 0 to 2 s"
    ):
        follow(kp=1.0, time=(0.0, 1.0), reference=(0.0, 1.0))


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"kp": "5 N"}, "kp must be a torsional stiffness [N*m/rad] or a stiffness [N/m], got '5 N' (force)"),
        ({"kp": 1, "limit": "0 N*m"}, "limit must be positive, got '0 N*m'"),
        (
            {"kp": 1, "angle": "1 deg", "rate": "1 m/s"},
            "rate must be for a turning joint, as angle is, got '1 m/s'",
        ),
        ({"kp": 1, "reference": [0, 1]}, "time must be given beside reference, got none"),
        (
            {"kp": 1, "time": [0, 0], "reference": [0, 1]},
            "time[1] must be above the one before, 0.0",
        ),
        ({"kd": 1, "limits": 2}, "limits is unknown; did you mean limit?"),
    ],
)
def test_a_scenario_refuses_what_is_no_controller(given, message):
    with pytest.raises(ValueError, match=f"^{re.escape(f'PDControllerSpec: {message}')}"):
        DRIVE_SPECS["pd"](joint="axle", kind="pd", **given)


def test_a_controller_in_a_scenario_moves_a_joint_with_play():
    """The example: its reference comes from a table, and its torque meets the limit at once."""
    data = simulate(load_scenario(PANEL, case="held"), duration=0.05).data
    assert data["control_reference"].values[0].tolist() == [0.0]
    assert data["drive_torque"].values[1:, 0] == pytest.approx(-0.5, rel=1e-15, abs=0.0)
    assert data["motion_rate"].sel(joint="hinge").values[-1] < -0.05
    work, gross = data["drive_work"].values[-1, 0], data["drive_gross_work"].values[-1, 0]
    assert 0.0 < work <= gross
    assert abs(data["energy_error"].values).max() < 1e-7 * gross
