"""Periodic solutions and their multipliers against closed forms."""

import math

import numpy as np
import pytest
from impact_oscillator import Impacts

from antenna_pin import load_scenario
from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.studies.nonlinear import (
    Flow,
    NoOrbitError,
    Stroboscope,
    flow_of,
    largest_exponent,
    lyapunov_spectrum,
    periodic_orbit,
    poincare,
)


def sorted_alike(one, other):
    return np.sort_complex(np.asarray(one)), np.sort_complex(np.asarray(other))


def test_a_driven_damped_oscillator(oscillator):
    """Its orbit is the steady state, its multipliers are exp(lambda T); both to round-off of the runs."""
    m, k, c, force, frequency = 2.0, 50.0, 1.5, 3.0, 1.3
    flow = Flow(oscillator(m, k, c, force, frequency))
    orbit = periodic_orbit(flow, flow.first(np.zeros(1), np.zeros(1)), 1.0 / frequency)
    w = 2.0 * math.pi * frequency
    response = force / (k - m * w**2 + 1j * c * w)
    assert orbit.start.q == pytest.approx([response.imag], rel=1e-10)
    assert orbit.start.v == pytest.approx([(1j * w * response).imag], rel=1e-10)
    found, exact = sorted_alike(orbit.multipliers, np.exp(np.roots([m, c, k]) / frequency))
    assert found == pytest.approx(exact, abs=1e-11)
    assert orbit.stable and orbit.doubt < 1e-8 and orbit.iterations <= 2
    assert orbit.exponents == pytest.approx([-0.5 * c / m] * 2, rel=1e-9)


@pytest.mark.parametrize("span", [1e-90, 1e-14, 0.0, -1.0, math.nan, math.inf])
def test_a_span_is_one_that_steps_can_make(oscillator, span):
    flow = Flow(oscillator(1.0, 1.0))
    start = flow.first(np.ones(1), np.zeros(1))
    with pytest.raises(
        InvalidParameterError, match="period must be finite and 1e-13 s or more, from t = 0 s on"
    ):
        periodic_orbit(flow, start, span)
    for exponents in (largest_exponent, lyapunov_spectrum):
        with pytest.raises(InvalidParameterError, match="interval must be finite and 1e-13 s or more"):
            exponents(flow, start, span, 3)
    if 0.0 < span < math.inf:
        scenario = load_scenario("slider_crank", case="ideal")
        with pytest.raises(InvalidParameterError, match="period must be finite and 1e-13 s or more"):
            poincare(scenario, Stroboscope(period=span), ["motion_angle[crank]"])
        with pytest.raises(AntennaPinError, match="duration must be finite and 1e-13 s or more"):
            scenario.with_overrides({"duration": span})


def test_a_period_in_which_next_to_nothing_moves_tells_nothing(oscillator):
    """Its ends are alike for any motion. At rest any period is one."""
    flow = Flow(oscillator(1.0, 1.0))
    with pytest.raises(NoOrbitError, match="1e-10 s is too short: the motion covers 1e-10 error scales"):
        periodic_orbit(flow, flow.first(np.ones(1), np.zeros(1)), 1e-10)
    assert periodic_orbit(flow, flow.first(np.zeros(1), np.zeros(1)), 0.1).residual == 0.0


def test_what_is_driven_in_all_its_freedoms_has_an_orbit_without_multipliers():
    flow, start = flow_of(load_scenario("slider_crank", case="ideal"))
    assert periodic_orbit(flow, start, 2.0 * math.pi / 500.0).multipliers.size == 0


def test_an_impact_oscillator(oscillator, turned_back):
    """Each neighbour impacts at its own instant: the jump of the tangent is in the differences, to 1e-8."""
    numbers = dict(m=1.0, k=1.0, c=0.1, force=1.0, frequency=0.4)
    exact = Impacts(**numbers, stop=0.0, restitution=0.8)
    flow = Flow(oscillator(*numbers.values()), events=(turned_back(0.0, 0.8),))
    state = flow.after(flow.first(np.array([-0.5]), np.zeros(1)), 60 * exact.period)
    orbit = periodic_orbit(flow, state, exact.period)
    # The impact of the orbit: where the flight from its start, exact, comes to the stop.
    times = orbit.start.time + np.linspace(0.0, exact.period, 4001)
    start = np.array([orbit.start.q[0], orbit.start.v[0]])
    way = np.array([exact.flight(times[0], start, t - times[0])[0] for t in times])
    k = int(np.argmax(way >= 0.0))
    speed = exact.flight(times[0], start, times[k] - times[0])[1]
    t, v = exact.orbit([times[k], -0.8 * speed])
    closed = exact.flight(times[0], start, t - times[0])
    assert closed == pytest.approx([0.0, -v / 0.8], abs=1e-9)
    found, expected = sorted_alike(orbit.multipliers, exact.multipliers(t, v))
    assert found == pytest.approx(expected, abs=1e-8)
    # The doubt is what two orders of differences disagree by, at most 1e-8 of slopes of 2 and in a basis of
    # condition 4: it bounds the error, and is no wild guess.
    assert np.abs(found - expected).max() < orbit.doubt < 2e-7


def test_a_free_oscillation_finds_its_period(oscillator):
    """Without damping all are orbits of one period, and both multipliers 1; the period is exact."""
    flow = Flow(oscillator(mass=1.0, stiffness=4.0))
    start = flow.first(np.array([0.3]), np.array([0.1]))
    orbit = periodic_orbit(flow, start, 3.0, free_period=True)
    assert orbit.period == pytest.approx(math.pi, rel=1e-10)
    assert orbit.multipliers == pytest.approx([1.0, 1.0], abs=1e-6)
    assert orbit.stable is None


def test_where_there_is_no_orbit(oscillator):
    """In resonance without damping the motion grows: nothing closes."""
    flow = Flow(oscillator(mass=1.0, stiffness=(2.0 * math.pi) ** 2, amplitude=1.0, frequency=1.0))
    with pytest.raises(NoOrbitError, match="begin nearer"):
        periodic_orbit(flow, flow.first(np.zeros(1), np.zeros(1)), 1.0, iterations=1)
