"""A ball on a shaking table, whose orbits with one impact a period and their stability are closed forms.

With restitution e on a table at A sin(w t), drive G = A w^2/g: it impacts at the phase at which
G cos(phi) = s = pi (1 - e)/(1 + e), and with a = G sin(phi) the map of impacts has the multipliers' sum
1 + e^2 - (1 + e)^2 a and product e^2. Two orbits meet at G = s, and the one doubles its period where
a = 2 (1 + e^2)/(1 + e)^2. (The table's own way in the time of flight is in these; after Holmes 1982, J. Sound
and Vibration 84, 173-189, who leaves it out.)
"""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin.run.simulation import Event, Jump
from antenna_pin.studies.nonlinear import Chart, Flow, continued, flow_of, periodic_orbit

GRAVITY, PERIOD = 9.81, 0.2
W = 2.0 * math.pi / PERIOD
UNIT = GRAVITY / W**2  # of amplitudes [m]


def limits(e):
    """Return the drives between which the orbit is there and stable."""
    least = math.pi * (1.0 - e) / (1.0 + e)
    return least, math.hypot(least, 2.0 * (1.0 + e**2) / (1.0 + e) ** 2)


def place(drive, e):
    """Return height [m] and velocity [m/s] of the ball at time zero, which is before its impact."""
    phi = math.acos(limits(e)[0] / drive)
    t, flight = phi / W, 0.5 * GRAVITY * PERIOD
    return UNIT * drive * math.sin(phi) + flight * t - 0.5 * GRAVITY * t**2, -flight + GRAVITY * t


def total(drive, e):
    """Return the sum of the multipliers."""
    return 1.0 + e**2 - (1.0 + e) ** 2 * math.sqrt(drive**2 - limits(e)[0] ** 2)


def by_event(system, e):
    """A ball whose velocity an event turns back: flow and period for each drive."""

    def family(drive):
        height = UNIT * drive

        def back(now):
            return now.q, -e * now.v + (1.0 + e) * height * W * math.cos(W * now.time)

        table = Event(
            name="table",
            when=lambda now: now.q[0] - height * math.sin(W * now.time),
            direction=-1,
            action=Jump(back),
        )
        return Flow(system, events=(table,)), PERIOD

    return family


@pytest.mark.parametrize(
    ("kind", "begin", "end", "phase"),
    [
        ("flip", 1.25, 1.5, 0.5),
        pytest.param("fold", 0.82, 0.5, 0.5, marks=pytest.mark.slow),
        pytest.param("fold", 0.82, 0.5, 0.0, marks=pytest.mark.slow),
    ],
)
def test_where_a_bouncing_orbit_changes(oscillator, kind, begin, end, phase):
    """Each neighbour impacts at its own instant, on a table that moves on: what is found is exact.

    A scenario's events turn no velocity back, so that this is one of Python's; below a contact does.
    """
    e = 0.6
    family = by_event(oscillator(stiffness=0.0, pull=GRAVITY), e)
    height, velocity = place(begin, e)
    flow, period = family(begin)
    # At the fold it impacts at phase zero: an orbit that is told by its state then is told by another from
    # there on, in flight. Nothing grazes.
    start = flow.first(np.array([height]), np.array([velocity]))
    start = flow.after(start, phase * period) if phase else start
    branch = continued(family, start, (begin, end), arc=0.15, most=8, precision=1e-5)
    (change,) = branch.bifurcations
    assert change.kind == kind
    assert change.value == pytest.approx(limits(e)[kind == "flip"], abs=1.1 * change.doubt)
    assert change.doubt < 1e-5
    for point in branch.points[: change.after + 1]:
        values = point.orbit.multipliers
        assert [values.sum(), values.prod()] == pytest.approx([total(point.value, e), e**2], abs=1e-7)


HOLLOW = 0.4  # [m]: how far the ball's centre is below the hollow's where they touch


@pytest.mark.slow  # two to three minutes: kinks are looked for in every step of its contacts
def test_a_scenario_whose_contact_lasts_tends_to_the_map_of_impacts(ball_on_table):
    """Lankarani and Nikravesh's law gives a restitution of its own, the same at all speeds.

    What is left is the time that the contact takes, which goes with K^(-2/5).
    """
    scenario = ball_on_table(GRAVITY, HOLLOW, 1.0 / PERIOD)
    chi = 0.75 * (1.0 - 0.5**2)
    e = brentq(lambda c: chi * (1.0 + c) - math.log((1.0 + chi) / (1.0 - chi * c)), 0.01, 1.0)
    drive = 0.5 * sum(limits(e))
    height, velocity = place(drive, e)
    off = []
    for stiffness in (1e8, 1e10):
        numbers = {"clearance.hollow.normal.stiffness": stiffness, "drives.shaker.amplitude": UNIT * drive}
        flow, at_rest = flow_of(scenario.with_overrides(numbers))
        # In the table's axes, z of which is the hinge's: x, then y downwards.
        q, v = at_rest.q.copy(), at_rest.v.copy()
        q[2], v[2] = HOLLOW - height, drive * UNIT * W - velocity
        orbit = periodic_orbit(flow, flow.first(q, v), PERIOD)
        chart = Chart(flow.system, orbit.start)
        falls = int(
            np.argmax(np.abs(chart.coordinates(flow.first(q + [0, 0, 1e-3, 0, 0], v)))[: chart.positions])
        )
        own = orbit.tangent[np.ix_([falls, chart.positions + falls], [falls, chart.positions + falls])]
        off.append([np.trace(own) - total(drive, e), np.linalg.det(own) - e**2])
    soft, hard = np.abs(off)
    share = 100.0**-0.4
    assert hard == pytest.approx(share * soft, rel=0.05)
    assert (hard < [3e-3, 2e-4]).all()
