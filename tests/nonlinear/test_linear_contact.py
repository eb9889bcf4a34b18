"""A ball in the hollow of a table that goes up and down, on a linear contact: a scenario with closed forms.

While it lies there u'' + (c/m) u' + (k/m) u = -g - z'' with the table at z = A sin(w t): multipliers are
those of a damped oscillator, exp(r T), and the ball leaves the table where the amplitude of u is what its
weight presses. Where it bounces, flights and contacts have closed forms still, and only their ends are found
by Brent's method.
"""

import dataclasses
import math
from functools import lru_cache

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq, fsolve

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


# For bounces: faster, so that it flies less far than the hollow is wide; the air damps, as a contact's damper
# would end its force before the depth, where derivatives have a kink.
FAST = 5.0  # [Hz]
AIR = 4.3  # [N s/m]
HARD = 1e6  # [N/m]
BOUNCES = {
    "drives.shaker.frequency": FAST,
    "clearance.hollow.normal.stiffness": HARD,
    "clearance.hollow.normal.damping": 0.0,
    "springs.air": {
        "first": {"link": "table", "point": [0.0, 0.0, -5.0]},
        "second": {"link": "ball", "point": [0.0, 0.0, 0.0]},
        "stiffness": 0.0,
        "damping": AIR,
        "free_length": 5.0,
    },
}


@lru_cache(maxsize=4096)
def propagator(touches, later):
    """Return what a displacement becomes a while later, in contact or in flight."""
    return expm(np.array([[0.0, 1.0], [-HARD if touches else 0.0, -AIR]]) * later)


class Bounces:
    """The map over a period of height and velocity above the table, each piece in closed form."""

    def __init__(self, amplitude):
        self.w, self.amplitude, self.period = 2.0 * math.pi * FAST, amplitude, 1.0 / FAST

    def steady(self, touches, t):
        """Return a solution, (2,), of u'' + AIR u' + k u = -g - z'' with the contact's stiffness or none."""
        k = HARD if touches else 0.0
        turn = self.amplitude * self.w**2 * np.exp(1j * self.w * t) / (k - self.w**2 + 1j * AIR * self.w)
        rest = [-GRAVITY / k, 0.0] if touches else [-GRAVITY / AIR * t, -GRAVITY / AIR]
        return np.array([turn.imag, (1j * self.w * turn).imag]) + rest

    def moved(self, touches, t, y, later):
        """Return the state a while later, in contact or in flight."""
        return self.steady(touches, t + later) + propagator(touches, later) @ (y - self.steady(touches, t))

    def __call__(self, y):
        """Return the state a period after one in flight at phase zero."""
        t, touches, step = 0.0, False, self.period / 200.0
        while t < self.period:

            def left(later, t=t, y=y, touches=touches):
                u = self.moved(touches, t, y, later)[0]
                return -u if touches else u

            later = 0.0 if left(step) > 0.0 else step
            while t + later < self.period and not (left(later + step) <= 0.0 < left(max(later, 1e-9))):
                later += step
            if t + later < self.period:
                later = brentq(left, max(later, 1e-9), later + step, xtol=1e-16)
            later = min(later, self.period - t)
            t, y, touches = t + later, self.moved(touches, t, y, later), not touches
        return y

    def orbit(self, guess):
        return fsolve(lambda y: self(y) - y, guess, xtol=1e-13)

    def doubling(self, guess):
        """Return the product of 1 + multiplier of the orbit near a guess, and the orbit."""
        y, h = self.orbit(guess), 1e-6
        # Differences of fourth order: a micrometre is small beside depths of a millimetre.
        weights = {1: 8.0, 2: -1.0}
        ways = [
            sum(weight * (self(y + n * h * way) - self(y - n * h * way)) for n, weight in weights.items())
            for way in np.eye(2)
        ]
        matrix = np.column_stack(ways) / (12.0 * h)
        return 1.0 + np.trace(matrix) + np.linalg.det(matrix), y


@pytest.mark.slow  # two to three minutes: kinks are looked for in every step of its contacts
def test_a_scenario_doubles_its_period(table):
    """The ball bounces once a period of the table, until it does so high and low by turns."""
    unit = GRAVITY / (2.0 * math.pi * FAST) ** 2
    first, last = 1.1 * unit, 1.4 * unit
    scenario = table.with_overrides(BOUNCES | {"drives.shaker.amplitude": first})
    flow, start = flow_of(scenario)
    # Of the impact without a duration: the phase at which it lands, at g T / 2.
    e, period = 0.6, 1.0 / FAST
    t = math.acos(math.pi * (1.0 - e) / (1.0 + e) / 1.1) / (2.0 * math.pi * FAST)
    height = first * math.sin(2.0 * math.pi * FAST * t) + 0.5 * GRAVITY * t * (period - t)
    speed = GRAVITY * (t - 0.5 * period) - first * 2.0 * math.pi * FAST
    _, here = Bounces(first).doubling([height, speed])
    q, v = start.q.copy(), start.v.copy()
    q[2], v[2] = HOLLOW - here[0], -here[1]
    branch = continued(
        family_of(scenario, "drives.shaker.amplitude"), flow.first(q, v), (first, last), arc=0.3, most=12
    )
    (flip,) = branch.bifurcations
    guess = [here]

    def product(amplitude):
        value, guess[0] = Bounces(amplitude).doubling(guess[0])
        return value

    exact = brentq(product, first, last, xtol=1e-12 * unit)
    assert flip.kind == "flip" and branch.points[flip.after].orbit.onsets == (1, 0)
    # Branches are located to 1e-7 of their range, multipliers known to 1e-8.
    assert flip.value == pytest.approx(exact, abs=3e-7 * (last - first))
