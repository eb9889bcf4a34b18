"""Lyapunov exponents against closed forms and against an exact map."""

import math

import numpy as np
import pytest
from numba import njit

from antenna_pin import RunSettings
from antenna_pin.elements import CallableDrive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.nonlinear import Flow, largest_exponent, lyapunov_spectrum


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
