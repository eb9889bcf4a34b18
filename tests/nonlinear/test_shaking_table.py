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

from antenna_pin.run.simulation import Event, Jump
from antenna_pin.studies.nonlinear import Flow, continued

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
