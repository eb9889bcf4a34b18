"""Margins of sampled loops against closed forms, and against runs that become unstable where they say."""

import math

import numpy as np
import pytest

from antenna_pin.errors import AntennaPinError
from antenna_pin.run.simulation import simulate
from antenna_pin.scenario import load_scenario
from antenna_pin.studies.linear import loop_margins
from antenna_pin.studies.verification import LoopPoint, margins_of_points, measured_gain_margin, measured_loop

PERIOD, INERTIA = 0.01, 0.5

URDF = """<robot name="wheel">
  <link name="hub"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="axis" type="continuous"><parent link="hub"/><child link="wheel"/><axis xyz="0 0 1"/></joint>
  <link name="wheel"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="0.5" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>
"""
SCENARIO = """format = 1
duration = "3 s"
mechanism = {{ urdf = "wheel.urdf", base = "fixed" }}
[drives.motor]
kind = "constant"
joint = "axis"
value = 0.0
[controllers.loop]
kind = "pid"
acts_on = "motor"
period = {period}
{loop}
[initial.joints.axis]
angle = 0.01
{more}
"""


@pytest.fixture
def wheel(tmp_path):
    """Return a function that builds the scenario of a wheel under a controller."""
    (tmp_path / "wheel.urdf").write_text(URDF)

    def built(loop, more="", name="wheel"):
        path = tmp_path / f"{name}.toml"
        path.write_text(SCENARIO.format(period=PERIOD, loop=loop, more=more))
        return load_scenario(path)

    return built


def double_integrator(z, kp, kd, delay):
    """L(z) of PD on an inertia: kp + kd (1 - 1/z)/h times h^2 (z + 1) / (2 J (z - 1)^2), periods late."""
    plant = PERIOD**2 * (z + 1.0) / (2.0 * INERTIA * (z - 1.0) ** 2)
    return (kp + kd * (1.0 - 1.0 / z) / PERIOD) * plant * z**-delay


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_response_is_that_of_the_exact_discrete_loop(wheel, delay):
    """To round-off grown by 1 / |z - 1|^2, 1e-8 of the response, over five decades of frequency."""
    kp, kd = 40.0, 6.0
    found = loop_margins(wheel(f"kp = {kp}\nkd = {kd}\ndelay_periods = {delay}"))
    z = np.exp(2j * np.pi * found.frequency * PERIOD)
    expected = double_integrator(z, kp, kd, delay)
    high = found.frequency > 0.01 / PERIOD / 2.0
    assert found.response[high] == pytest.approx(expected[high], rel=1e-7)
    assert found.stable


def test_a_delay_of_half_a_period_splits_the_hold(wheel):
    """u acts for the second half of one period and the first of the next: two exact columns."""
    kp, kd = 40.0, 6.0
    found = loop_margins(wheel(f"kp = {kp}\nkd = {kd}\ndelay_periods = 0.5"))
    z = np.exp(2j * np.pi * found.frequency * PERIOD)
    h = PERIOD
    # Angle and rate after a torque of 1 over the second half, and over the first half, of a period.
    now = np.array([0.5 * (h / 2) ** 2, h / 2]) / INERTIA
    old = np.array([0.5 * (h / 2) ** 2 + (h / 2) ** 2, h / 2]) / INERTIA
    column = now[:, None] + old[:, None] / z
    angle = (column[0] * (z - 1.0) + h * column[1]) / (z - 1.0) ** 2
    expected = (kp + kd * (1.0 - 1.0 / z) / h) * angle
    high = found.frequency > 0.01 / h / 2.0
    assert found.response[high] == pytest.approx(expected[high], rel=1e-7)


def test_margins_are_where_the_loop_becomes_unstable(wheel):
    """With the gain times 0.98 of its margin a run decays, times 1.02 it grows; so do the roots."""
    kp, kd = 40.0, 6.0
    margin = loop_margins(wheel(f"kp = {kp}\nkd = {kd}\ndelay_periods = 1")).gain_margin
    sizes = {}
    for share in (0.98, 1.02):
        factor = share * margin
        scenario = wheel(f"kp = {factor * kp}\nkd = {factor * kd}\ndelay_periods = 1")
        assert loop_margins(scenario).stable == (share < 1.0)
        angle = simulate(scenario).data["motion_angle"].sel(joint="axis").values
        third = len(angle) // 3
        sizes[share] = abs(angle[-third:]).max() / abs(angle[third:-third]).max()
    assert sizes[0.98] < 0.9 and sizes[1.02] > 1.1


def test_phase_margin_and_bandwidth_are_those_of_a_fine_root(wheel):
    """Where |L| is 1, found by bisection on the closed form, the phase is the margin above -180 degrees."""
    kp, kd = 40.0, 6.0
    found = loop_margins(wheel(f"kp = {kp}\nkd = {kd}\ndelay_periods = 1"))
    low, high = 0.1, 20.0
    for _ in range(80):
        middle = math.sqrt(low * high)
        z = np.exp(2j * np.pi * middle * PERIOD)
        low, high = (middle, high) if abs(double_integrator(z, kp, kd, 1)) > 1.0 else (low, middle)
    phase = np.angle(double_integrator(np.exp(2j * np.pi * low * PERIOD), kp, kd, 1)) % (2.0 * np.pi)
    # The response is linear between points 6e-4 apart in the logarithm of the frequency.
    assert found.bandwidth == pytest.approx(low, rel=1e-5)
    assert found.phase_margin == pytest.approx(phase - np.pi, abs=1e-5)
    assert found.delay_margin == pytest.approx(found.phase_margin / (2.0 * np.pi * low), rel=1e-4)


def test_coulomb_friction_counts_as_constant(wheel):
    """A joint at rest under regularised friction has the margins of the same without its Coulomb part."""
    loop = "kp = 40\nkd = 6\ndelay_periods = 1"
    rub = '[springs."rub.1"]\njoint = "axis"\nkind = "friction"\nfriction = {}\ndamping = 0.2'
    with_friction = loop_margins(wheel(loop, rub.format(0.3)))
    without = loop_margins(wheel(loop, rub.format(0.0), "smooth"))
    assert with_friction.gain_margin == pytest.approx(without.gain_margin, rel=1e-12)


def test_loops_without_a_pid_are_refused(wheel):
    """Names that there are, and motors whose current is a state of its own."""
    with pytest.raises(AntennaPinError, match="pid controller 'lop' is unknown; did you mean loop"):
        loop_margins(wheel("kp = 1"), "lop")


def test_a_loop_measured_in_runs_is_the_linear_one_where_nothing_bends(wheel):
    """Y / E of a sine equals the exact response to what the start leaves after four periods."""
    scenario = wheel(
        'kp = 40\nkd = 6\ndelay_periods = 1\nderivative = "error"\nfollows = "slow"',
        '[references.slow]\nkind = "constant"\nvalue = 0.0',
    )
    found = loop_margins(scenario)
    (point,) = measured_loop(scenario, "loop", [2.0], 0.1)
    z = np.exp(2j * np.pi * 2.0 * PERIOD)
    assert point.gain == pytest.approx(double_integrator(z, 40.0, 6.0, 1), rel=1e-3)
    assert point.distortion < 1e-3 and found.bandwidth > 1.0


def test_gain_margin_in_runs_is_that_of_small_motions_about_the_operating_point(wheel):
    """A spring that is there beyond 0.3 rad only: about 0.6 rad the loop is that on a linear spring."""
    loop = 'kp = 40\nkd = 6\ndelay_periods = 1\nderivative = "error"\nfollows = "slow"'
    slow = '[references.slow]\nkind = "constant"\nvalue = 0.0\n'
    kinked = '[springs.s]\njoint = "axis"\nkind = "table"\ninterpolation = "linear"\n'
    kinked += "angle = [-1, 0.3, 1.3]\ntorque = [0, 0, -25]"
    linear = '[springs.s]\njoint = "axis"\nstiffness = 25'
    exact = loop_margins(wheel(loop, slow + linear, "linear"))
    scenario = wheel(loop, slow + kinked)
    margin, points = measured_gain_margin(scenario, "loop", 0.05, 0.6)
    assert margin == pytest.approx(exact.gain_margin, rel=0.02)
    assert len(points) == 6
    # Where the spring counts most, below the crossing.
    (near,) = measured_loop(scenario, "loop", [0.8], 0.05, 0.6)
    (far,) = measured_loop(scenario, "loop", [0.8], 0.05)
    expected = np.interp(0.8, exact.frequency, exact.response)
    assert near.gain == pytest.approx(expected, rel=0.02)
    assert abs(far.gain - expected) > abs(expected)  # without the spring


def test_margins_of_measured_points_are_those_of_their_loop():
    """Points of an exact response, straight between them in logarithms: to the spacing's square."""
    loop = {"kp": 40.0, "kd": 6.0, "delay": 1}
    frequency = np.geomspace(0.1, 0.499 / PERIOD, 20_000)
    response = double_integrator(np.exp(2j * np.pi * frequency * PERIOD), **loop)
    k = np.flatnonzero(np.abs(response) >= 1.0)[-1]
    lag = np.unwrap(np.angle(response)) - 2.0 * np.pi * (np.angle(response[0]) > 0.0)
    late = np.flatnonzero(lag >= -np.pi)[-1]
    exact = (np.pi + lag[k], 1.0 / abs(response[late]), frequency[k], frequency[late])
    found = margins_of_points(
        [LoopPoint(f, complex(one), 0.0) for f, one in zip(frequency[::500], response[::500], strict=True)]
    )
    assert found == pytest.approx(exact, rel=1e-2)
    some = margins_of_points([LoopPoint(f, complex(1.0 / f), 0.0) for f in (0.5, 0.8)])
    assert math.isnan(some.phase) and math.isnan(some.gain)


def test_limits_lower_the_gain_of_a_measured_loop_as_their_describing_function(wheel):
    """L = N(A) times that of small motions, N = 2/pi (asin 1/a + sqrt(1 - 1/a^2)/a) at a = A / limit."""
    kp, kd, limit, amplitude, frequency = 40.0, 6.0, 2.0, 0.3, 1.5
    loop = f'kp = {kp}\nkd = {kd}\nderivative = "error"\nfollows = "slow"\nlower = -{limit}\nupper = {limit}'
    scenario = wheel(loop, '[references.slow]\nkind = "constant"\nvalue = 0.0')
    z = np.exp(2j * np.pi * frequency * PERIOD)
    small = double_integrator(z, kp, kd, 0)
    controller = kp + kd * (1.0 - 1.0 / z) / PERIOD
    gain = 1.0
    for _ in range(200):  # the error's amplitude follows from the loop, and the gain from the error
        a = max(abs(controller) * amplitude / abs(1.0 + gain * small) / limit, 1.0)
        gain = 0.5 * gain + 0.5 * 2.0 / np.pi * (np.arcsin(1.0 / a) + np.sqrt(1.0 - 1.0 / a**2) / a)
    (point,) = measured_loop(scenario, "loop", [frequency], amplitude)
    assert gain < 0.8
    # Harmonics that the inertia leaves: a ninth of a third of the fundamental.
    assert point.gain == pytest.approx(gain * small, rel=0.05)
