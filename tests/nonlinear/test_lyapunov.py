"""Lyapunov exponents against closed forms and against an exact map."""

import math

import numpy as np
import pytest
from numba import njit
from scipy.linalg import expm

from antenna_pin import RunSettings
from antenna_pin.elements import CallableDrive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.nonlinear import Flow, flow_of, largest_exponent, lyapunov_spectrum


def test_neighbours_of_a_damped_oscillator_come_together_at_half_its_damping(oscillator):
    m, k, c, period = 2.0, 50.0, 1.5, 0.25
    flow = Flow(oscillator(m, k, c, 3.0, 1.0 / period))
    start = flow.first(np.array([0.1]), np.zeros(1))
    spectrum = lyapunov_spectrum(flow, start, period, 40)
    # The sum is the divergence, at every instant. Neighbours turn on ellipses of axes 1 and 5: what that does
    # to a distance between the ends is log 5 at most, over the time.
    off = math.log(math.sqrt(k / m)) / (40 * period)
    assert spectrum.values.sum() == pytest.approx(-c / m, rel=1e-8)
    assert spectrum.values == pytest.approx([-0.5 * c / m] * 2, abs=off)
    largest = largest_exponent(flow, start, period, 40)
    assert largest.values[0] == pytest.approx(-0.5 * c / m, abs=off)
    assert largest.verdict == spectrum.verdict == "contracting"
    assert lyapunov_spectrum(flow, start, period, 5).verdict == "too short to decide"


@njit
def cubic(t, x, v):
    """Return the force of a spring that stiffens."""
    return -(x**3)


@pytest.mark.slow
def test_chaos_of_a_driven_cubic_spring(oscillator):
    """x'' + 0.05 x' + x^3 = 7.5 cos t (Ueda 1979, J. Stat. Phys. 20, 181-196): 0.103 per unit of time.

    Sprott (Chaos and Time-Series Analysis, 2003, app. A) has 0.1034, recalled and not read again; variational
    equations by a fourth-order method over 300 000 periods give that too. What was read is 0.0999, of a run
    of unknown length (sites.google.com/view/lyapunov-spectrum/home/duffing_eqs).
    """
    drive = CallableDrive(joint="way", torque=cubic)
    system = oscillator(1.0, 0.0, 0.05, 7.5, 0.5 / math.pi, 0.5 * math.pi, own=drive)
    flow, period = Flow(system, RunSettings(rtol=1e-8, engine="compiled")), 2.0 * math.pi
    start = flow.after(flow.first(np.array([2.5]), np.zeros(1)), 50 * period)
    found = largest_exponent(flow, start, period, 150)
    assert found.verdict == "chaotic" and found.errors[0] < 0.016
    assert abs(found.values[0] - 0.1034) < 3.0 * found.errors[0]
    # The sum is the divergence, whatever the motion: the variational equation has it to its own 1e-9.
    spectrum = lyapunov_spectrum(flow, start, period, 20)
    assert spectrum.values.sum() == pytest.approx(-0.05, abs=1e-8)
    assert abs(spectrum.values[0] - 0.1034) < 3.0 * spectrum.errors[0]


PENDULUM = f"""
[springs.hinge]
damping = 0.1
[drives.motor]
joint = "hinge"
kind = "sine"
amplitude = 2.5
frequency = {0.5 / math.pi!r}
"""


@pytest.mark.slow  # the spring above shows the same by its own numbers
def test_chaos_of_a_driven_pendulum_of_a_scenario(rig):
    """phi'' + 0.1 phi' + sin phi = 2.5 sin t: 0.160 of arXiv:physics/0303077, and Mathematica's 0.1606.

    As both are quoted at mathematica.stackexchange.com/questions/185364.
    """
    flow, start = flow_of(rig(PENDULUM, True, -1.0), rtol=1e-8)
    period = 2.0 * math.pi
    start = flow.after(start, 20 * period)
    spectrum = lyapunov_spectrum(flow, start, period, 60)
    # The bob's own moment of inertia of 1e-6 beside 1 kg m^2.
    assert spectrum.values.sum() == pytest.approx(-0.1, rel=2e-6)
    # 0.015 over 200 periods, by the root of their number 0.027 over 60; such an estimate is good to a half.
    assert spectrum.verdict == "chaotic" and spectrum.errors[0] < 0.045
    assert abs(spectrum.values[0] - 0.160) < 3.0 * spectrum.errors[0]


def exact_growth(state, t, period, count, matrix, steady, w, force, m, restitution):
    """Largest exponent of impacts at x = 0, flights and jumps of the tangent in closed form [1/s]."""

    def particular(time):
        turned = steady * np.exp(1j * w * time)
        return np.array([turned.imag, (1j * w * turned).imag])

    def acceleration(time, y):
        return matrix[1] @ y + force * math.sin(w * time) / m

    step = period / 400
    one = expm(matrix * step)
    way, total, begin = np.array([1.0, 0.0]), 0.0, t
    for _ in range(400 * count):
        ahead = particular(t + step) + one @ (state - particular(t))
        if ahead[0] > 0.0 and state[0] <= 0.0:
            low, high = 0.0, step
            for _ in range(60):
                middle = 0.5 * (low + high)
                at = particular(t + middle) + expm(matrix * middle) @ (state - particular(t))
                low, high = (low, middle) if at[0] > 0.0 else (middle, high)
            there, v = t + high, at[1]
            hit, after = np.array([0.0, v]), np.array([0.0, -restitution * v])
            rate = (acceleration(there, after) + restitution * acceleration(there, hit)) / v
            way = np.array([[-restitution, 0.0], [rate, -restitution]]) @ (expm(matrix * high) @ way)
            rest = step - high
            ahead = particular(t + step) + expm(matrix * rest) @ (after - particular(there))
            way = expm(matrix * rest) @ way
        else:
            way = one @ way
        state, t = ahead, t + step
        length = np.linalg.norm(way)
        total, way = total + math.log(length), way / length
    return total / (t - begin)


@pytest.mark.slow
def test_chaos_of_an_impact_oscillator_against_its_exact_map(oscillator, turned_back):
    """Driven at 2.8 times its own frequency against a stop at rest, its grazing chaos (Nordmark's)."""
    m, k, c, force, frequency, restitution = 1.0, 1.0, 0.02, 1.0, 2.8 / (2.0 * math.pi), 0.8
    flow = Flow(oscillator(m, k, c, force, frequency), events=(turned_back(0.0, restitution),))
    period, w = 1.0 / frequency, 2.0 * math.pi * frequency
    start = flow.after(flow.first(np.array([-0.05]), np.zeros(1)), 100 * period)
    ours = largest_exponent(flow, start, period, 300)
    matrix = np.array([[0.0, 1.0], [-k / m, -c / m]])
    steady = force / (k - m * w**2 + 1j * c * w)
    state = np.array([start.q[0], start.v[0]])
    exact = exact_growth(state, start.time, period, 2000, matrix, steady, w, force, m, restitution)
    assert abs(ours.values[0] - exact) < 4.0 * ours.errors[0] + 0.01
    assert ours.verdict == "chaotic"
    spectrum = lyapunov_spectrum(flow, start, period, 1000)
    assert abs(spectrum.values[0] - exact) < 4.0 * spectrum.errors[0] + 0.01
    # A volume shrinks by the damping, and at each impact by the square of the restitution.
    counted = (spectrum.values.sum() + c / m) * 1000 * period / (2.0 * math.log(restitution))
    assert counted == pytest.approx(round(counted), abs=2e-3)
    # The run in one is another one after some periods, for its steps are not cut at each.
    assert counted == pytest.approx(flow.traverse(start, 1000 * period).events, rel=0.02)


@pytest.mark.parametrize(("name", "value"), [("interval", 0.0), ("transient", -1.0), ("count", 0)])
def test_refusals(oscillator, name, value):
    flow = Flow(oscillator(damping=1.0))
    given = {"interval": 1.0, "count": 10, "transient": 0.0, name: value}
    with pytest.raises(InvalidParameterError, match=f"Lyapunov exponents.*{name}"):
        largest_exponent(flow, flow.first(np.zeros(1), np.ones(1)), **given)


def test_an_interval_in_which_neighbours_meet_is_refused(oscillator):
    """They come e^-50 nearer: what is left of their distance is round-off."""
    flow = Flow(oscillator(stiffness=1.0, damping=2.0))
    with pytest.raises(InvalidParameterError, match="interval must be so short that neighbours"):
        largest_exponent(flow, flow.first(np.ones(1), np.zeros(1)), 50.0, 40)
