"""Derivatives through contacts whose damping begins with infinite slope, and bristles under them.

A disc of mass m meets a wall at v under ``F = K d^1.5 + c d^s d'``, s = 1/2 (Kuwabara and Kono) or 1/4
(Tsuji), never pulling. With ``d = x^p``, p = 1 / s, and ``dt = x^(p-1) ds`` depth, speed and time go by
polynomials:

    dx/ds = v / p,   dv/ds = -x^(p-1) (K x^(1.5 p) + c x v) / m,   dt/ds = x^(p-1)

so that a Runge-Kutta method of order 8 with complex numbers has derivatives to round-off, past the instant at
which the force has come to zero too.
"""

import importlib
import math
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import DOP853

from antenna_pin import load_scenario
from antenna_pin.studies.sensitivity import sensitivities

ROOT = Path(__file__).parents[2]
MASS, STIFFNESS, SPEED, PLAY, END = 2.0, 1e9, 0.1, 1e-4, 3.5e-3
RIG = {
    "integrator.engine": "compiled",
    "mechanism.base": "fixed",
    "mechanism.links.disc.mass": MASS,
    "clearance.bore.geometry": "closed-form",
}
KEYS = {
    "mechanism.links.disc.mass": MASS,
    "clearance.bore.normal.stiffness": STIFFNESS,
    "clearance.bore.radial_clearance": PLAY,
}


def stepped(rates, state, h):
    """Return a state a step later by the method's own tableau."""
    slopes = np.zeros((12, 3), complex)
    for k in range(12):
        slopes[k] = rates(state + h * (DOP853.A[k, :k] @ slopes[:k]))
    return state + h * (DOP853.B @ slopes)


def left_at(power, mass, stiffness, play, damping):
    """Return place (of the wall: 0) and velocity at END, behind the contact."""

    def push(state):
        x, v, _ = state
        return stiffness * x ** (1.5 * power - 1.0) + damping * v  # over x

    def rates(state):
        x, v, _ = state
        return np.array([v / power, -(x**power) * push(state) / mass, x ** (power - 1)])

    deepest = (1.25 * MASS * SPEED**2 / STIFFNESS) ** 0.4
    h = deepest ** (1.0 / power) / SPEED / 300.0  # so short that order 8 is at round-off
    here = np.array([0.0, SPEED, play / SPEED], complex)
    while (there := stepped(rates, here, h))[1].real > 0.0 or push(there).real > 0.0:
        here = there
    last = 0.5 * h + 0j
    for _ in range(20):  # Newton's steps to where it presses no more, in complex numbers too
        off = push(stepped(rates, here, last))
        change = (push(stepped(rates, here, last + 1e-6 * h)) - off) / (1e-6 * h)
        last -= off / change
    x, v, t = stepped(rates, here, last)
    return x**power + v * (END - t), v


def alpha(restitution):
    """Return Tsuji's, of a Hertz contact."""
    log = -math.log(restitution)
    return math.sqrt(5.0) * log / math.hypot(math.pi, log)


LAWS = {
    "kuwabara-kono": ("damping = 1e6", 2, lambda mass, stiffness: 1e6),
    "tsuji": ("restitution = 0.7", 4, lambda mass, stiffness: alpha(0.7) * np.sqrt(mass * stiffness)),
}


@pytest.mark.parametrize("law", LAWS)
def test_an_impact_that_begins_with_infinite_slope(law):
    """In mass, stiffness and clearance, behind the release."""
    said, power, damping = LAWS[law]
    text = f"{{ law = '{law}', stiffness = {STIFFNESS}, {said}, replace = true }}"
    changes = [f"{key}={value}" for key, value in RIG.items()]
    scenario = load_scenario(
        "impact_pair", case="planar", overrides=[*changes, f"clearance.bore.normal={text}"]
    )
    found = sensitivities(scenario, list(KEYS), times=[END], method="equation")
    for k, (key, value) in enumerate(KEYS.items()):
        numbers = [one + 1e-30j * value * (other == key) for other, one in KEYS.items()]
        mass, stiffness, play = numbers
        _, velocity = left_at(power, mass, stiffness, play, damping(mass, stiffness))
        exact = velocity.imag / 1e-30
        ours = found.derivative("v")[0, 0, k] * value
        # Ten of the run's tolerances, beside speeds of some 0.1; over the play, the radii's round-off of
        # 2e-18 m over steps of differences of 1e-10 m: 2e-8 of a slope at each of some hundred nodes.
        least = 2e-9 if key.endswith("radial_clearance") else 1e-11
        assert ours == pytest.approx(exact, abs=least)
        assert velocity.real == pytest.approx(found.run.data["v"].values[-1, 0], abs=1e-11)
        # Momentum and energy that the contact takes; how well these are booked no step is judged by.
        given, lost = mass * (SPEED - velocity), 0.5 * mass * (SPEED**2 - velocity**2)
        for name, one in (("impulse", given), ("dissipated", lost), ("total_normal_loss", lost)):
            sign = np.sign(found.run.data[name].values[0] * one.real)
            wanted = sign * one.imag / 1e-30
            booked = found.derivative(name)[0, k] * value
            assert booked == pytest.approx(wanted, abs=1e-9 * one.real + 2.0 * MASS * least)


@pytest.mark.slow
@pytest.mark.parametrize("number", [2, 3, 4, 7, 16, 68])
def test_random_mechanisms_that_the_equation_was_off_in(number, monkeypatch):
    """What is off says so, by its own doubt or because runs move.

    The first were off by 1e-5 while a contact counted from some depth on: one has a joint of Kuwabara's and
    Kono's law under Gonthier's bristles, the others two and three joints of nine laws. In 16 a flange touches
    that is hardly tilted, in 68 velocities change 300 times as much in a distributed contact as behind it.
    """
    monkeypatch.syspath_prepend(str(ROOT / "scripts" / "check"))
    campaign = importlib.import_module("random_sensitivities")
    scenario, keys, _ = campaign.drawn(1, number)
    found = campaign.compared(scenario, keys, contacts=3, limit=1e-7)
    assert found.contacts >= 2
    assert found.word(1e-7) != "APART" and found.equation < 5e-7
