"""Periodic solutions of systems whose numbers events change within the period and change back."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from antenna_pin import RunSettings, System
from antenna_pin.elements import JointSpring
from antenna_pin.errors import InvalidParameterError
from antenna_pin.run.simulation import Angle, Event, Set
from antenna_pin.studies.nonlinear import Flow, periodic_orbit

OMEGA, AT, STIFFNESS, DAMPING = 2.2, 0.1, 100.0, 1.4
PERIOD = 2.0 * math.pi / OMEGA
NONE = 1e-30  # one of stiffness and damping must be above zero


def _flow(oscillator):
    """x'' + 0.04 x' + x = cos 2.2 t, and beyond 0.1 m a spring and a damper more, switched by four events."""
    plain = oscillator(damping=0.04, amplitude=1.0, frequency=1.0 / PERIOD, phase=0.5 * math.pi)
    stop = JointSpring(joint="way", stiffness=NONE, damping=0.0, rest_angle=AT)
    system = System(plain.mechanism, drives=plain.drives, springs=plain.springs | {"stop": stop})
    events = [
        Event(
            name=f"{name} {direction}",
            when=Angle("way", AT),
            direction=direction,
            action=Set(f"springs.stop.{name}", value if direction > 0 else off),
        )
        for name, value, off in (("stiffness", STIFFNESS, NONE), ("damping", DAMPING, 0.0))
        for direction in (1, -1)
    ]
    return Flow(system, RunSettings(rtol=1e-12, engine="compiled"), events=events)


def _period(z):
    """Return where a state is a period later, and the derivatives of that: by SciPy, piece by piece.

    The force jumps by -1.4 x' where the damper comes and goes: a neighbour dx off comes dt = -dx / v later.
    """
    t, whole, pressed = 0.0, np.eye(2), z[0] > AT

    def rates(t, y):
        k, c = (STIFFNESS, DAMPING) if pressed else (0.0, 0.0)
        matrix = np.array([[0.0, 1.0], [-1.0 - k, -0.04 - c]])
        force = math.cos(OMEGA * t) - 0.04 * y[1] - y[0] - k * (y[0] - AT) - c * y[1]
        return np.concatenate([[y[1], force], (matrix @ y[2:].reshape(2, 2)).ravel()])

    def passes(t, y):
        return y[0] - AT

    passes.terminal = True
    while t < PERIOD:
        passes.direction = -1.0 if pressed else 1.0
        given = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-15, "events": passes}
        found = solve_ivp(rates, (t, PERIOD), np.concatenate([z, np.eye(2).ravel()]), **given)
        t, z = found.t[-1], found.y[:2, -1]
        whole = found.y[2:, -1].reshape(2, 2) @ whole
        if found.status == 1:
            before = rates(t, found.y[:, -1])[:2]
            pressed = not pressed
            jump = rates(t, found.y[:, -1])[:2] - before
            whole += np.outer(jump, whole[0]) / before[0]
    return z, whole


def test_an_orbit_that_comes_back_to_its_numbers_is_one(oscillator):
    """What only says that an event has set a number to its own value is no change of it."""
    z = np.array([-0.7787, 0.0647])
    for _ in range(6):
        end, slopes = _period(z)
        z = z + np.linalg.solve(np.eye(2) - slopes, end - z)
    flow = _flow(oscillator)
    start = flow.after(flow.first(np.array([-0.4]), np.array([0.1])), 30.0 * PERIOD)
    orbit = periodic_orbit(flow, start, PERIOD)
    assert [orbit.start.q[0], orbit.start.v[0]] == pytest.approx(z, abs=1e-9)
    expected = np.linalg.eigvals(slopes)
    # Differences of runs know them to 1e-8.
    assert np.sort_complex(orbit.multipliers) == pytest.approx(np.sort_complex(expected), abs=1e-8)


def test_where_a_number_is_another_an_orbit_does_not_begin(oscillator):
    """Within the stop its stiffness is the event's."""
    flow = _flow(oscillator)
    start = flow.after(flow.first(np.array([0.0]), np.array([1.0])), 0.15)
    assert dict(start.adjusted)["springs.stop.stiffness"] == STIFFNESS
    said = (
        r"springs\.stop\.stiffness at another value than its own, 1e-30, .*begin at another instant, got 100"
    )
    with pytest.raises(InvalidParameterError, match=said):
        periodic_orbit(flow, start, PERIOD)
