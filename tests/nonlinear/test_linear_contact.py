"""A ball in the hollow of a table that goes up and down, on a linear contact: a scenario with closed forms.

While it lies there u'' + (c/m) u' + (k/m) u = -g - z'' with the table at z = A sin(w t): multipliers are
those of a damped oscillator, exp(r T), and the ball leaves the table where the amplitude of u is what its
weight presses. Where it bounces, flights and contacts have closed forms still, and only their ends are found
by Brent's method.
"""

import dataclasses
import math

import numpy as np
import pytest

from antenna_pin.studies.nonlinear import continued, family_of, flow_of, periodic_orbit

GRAVITY, PERIOD, HOLLOW = 9.81, 2.0, 0.4
W = 2.0 * math.pi / PERIOD
# So stiff and so little damped that the force ends, at c w / k = 0.001, where the depth does, to 5e-7 of it.
STIFFNESS, DAMPING = 100.0 * W**2, 0.1 * W
RESPONSE = W**2 / (STIFFNESS - W**2 + 1j * DAMPING * W)  # of u to the table's way
LEAVES = GRAVITY / STIFFNESS / abs(RESPONSE)  # [m]

LINEAR = {
    "clearance.hollow.maximum_depth": 0.05,
    "clearance.hollow.normal": {
        "law": "kelvin-voigt", "stiffness": STIFFNESS, "damping": DAMPING, "replace": True,
    },
    "closures.upright": {
        "kind": "prismatic",
        "first": {"link": "table", "point": [0, 0, 0], "axis": [0, 0, 1], "across": [1, 0, 0]},
        "second": {"link": "ball", "point": [0, 0, 0], "axis": [0, 0, 1], "across": [1, 0, 0]},
    },
    "drives.shaker.amplitude": 0.5 * LEAVES,
}  # fmt: skip
LANKARANI = {
    "clearance.hollow.normal": {
        "law": "lankarani-nikravesh", "restitution": 0.9, "stiffness": 3e4, "replace": True,
    }
}  # fmt: skip


@pytest.fixture
def table(ball_on_table):
    return ball_on_table(GRAVITY, HOLLOW, 1.0 / PERIOD).with_overrides(LINEAR)


def lying(scenario, depth):
    """Return the flow and a state in which the ball touches so deep."""
    flow, start = flow_of(scenario)
    q, v = start.q.copy(), start.v.copy()
    q[2] = HOLLOW + depth  # in the table's axes z is the hinge's: x, then y downwards
    return flow, flow.first(q, v)


def with_speed(state, speed):
    """Return a state whose contact remembers another approach speed [m/s]."""
    memory = state.memory.copy()
    memory[0, 1] = speed
    contacts = tuple(dataclasses.replace(one, approach_speed=speed) for one in state.contacts)
    return dataclasses.replace(state, memory=memory, contacts=contacts)


@pytest.mark.slow
def test_a_branch_up_to_where_the_ball_leaves(table):
    """What the contact remembers is one more coordinate, which is left out of what is said of neighbours."""
    flow, state = lying(table, GRAVITY / STIFFNESS)
    key = "drives.shaker.amplitude"
    branch = continued(
        family_of(table, key, rtol=1e-10),
        flow.after(state, 5 * PERIOD),
        (0.8 * LEAVES, 1.1 * LEAVES),
        arc=0.5,
        precision=1e-6,
    )
    root = 0.5 * (-DAMPING + np.emath.sqrt(DAMPING**2 - 4.0 * STIFFNESS))
    exact = np.exp(root * PERIOD)
    for point in branch.points:
        orbit = point.orbit
        assert orbit.stable and orbit.neutral == 1 and orbit.onsets == (0, 0)
        assert orbit.names[-1].endswith("approach speed")
        found = orbit.multipliers[np.argmax(orbit.multipliers.imag)]
        # Runs at 1e-10, in units of 0.4 m beside depths of a few mm.
        assert found == pytest.approx(complex(exact.real, abs(exact.imag)), abs=1e-7)
        steady = point.value * RESPONSE * np.exp(1j * W * orbit.start.time)
        depth = GRAVITY / STIFFNESS - steady.imag
        assert orbit.start.q[2] == pytest.approx(HOLLOW + depth, abs=1e-7)
    (graze,) = branch.bifurcations
    assert graze.kind == "grazing" and branch.message.startswith("it ends in a graze")
    assert graze.value == pytest.approx(LEAVES, rel=2e-6)


@pytest.mark.slow
def test_what_is_remembered_stays(table):
    """Of the family of orbits that one with the start's speed is found, to the last bit."""
    scenario = table.with_overrides(LANKARANI)
    flow, state = lying(scenario, 5e-3)
    begun = with_speed(flow.after(state, PERIOD), 0.3)
    family = family_of(scenario, "drives.shaker.amplitude", rtol=1e-9)
    branch = continued(family, begun, (0.5 * LEAVES, 0.6 * LEAVES), arc=1.0)
    for point in branch.points:
        assert point.orbit.start.memory[0, 1] == 0.3 and point.orbit.neutral == 1 and point.orbit.stable
    # One with another speed is another orbit: what is remembered damps.
    other = periodic_orbit(family(0.5 * LEAVES)[0], with_speed(begun, 0.6), PERIOD)
    sizes = [np.abs(orbit.multipliers).max() for orbit in (branch.points[0].orbit, other)]
    assert sizes[0] < 0.9 * sizes[1] < 0.9
