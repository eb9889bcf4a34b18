"""Gross works, the integral of |P|, and their derivatives where the power P changes its sign.

One drive or force alone acts on a mass: its work is what the mass has by moving, m v^2 / 2, and its gross
work how far that has gone, up and down. Where it turns back its rate is zero, so that this instant's own
displacement is of no matter.
"""

import functools

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import RunSettings, simulate
from antenna_pin.studies.sensitivity import sensitivities
from tests.sensitivity.test_closed_forms import BASE, MASS, PLACE, SPEED, mass, oscillation, stepped_numbers

PUSH, KP, KD, SWING, FREQUENCY = -0.9, 60.0, 1.5, 0.2, 1.3
TIMES = np.array([0.2, 0.7, 1.4])
M, X, V = "mechanism.links.mass.mass", "initial.joints.way.position", "initial.joints.way.velocity"


def pushed(t, push, mass, speed):
    """A constant force, which brakes first: once the mass turns back."""
    return speed + push * t / mass


def held(t, stiffness, damping, mass, place):
    """Proportional and derivative gain: a spring with a damper, of which each has a sign of its own."""
    return oscillation(t, stiffness, damping, mass, place, 0.0)[1]


def swung(t, swing, frequency, mass):
    """A given motion."""
    return swing * 2.0 * np.pi * frequency * np.cos(2.0 * np.pi * frequency * t)


DRIVES = {
    "constant": (
        f'[drives.own]\nkind = "constant"\njoint = "way"\nvalue = "{PUSH} N"',
        pushed,
        {"drives.own.value": PUSH, M: MASS, V: SPEED},
    ),
    "pd": (
        f'[drives.own]\nkind = "pd"\njoint = "way"\nkp = "{KP} N/m"\nkd = "{KD} N*s/m"',
        held,
        {"drives.own.kp": KP, "drives.own.kd": KD, M: MASS, X: PLACE},
    ),
    "motion": (
        f'[drives.own]\nkind = "motion"\njoint = "way"\namplitude = {SWING}\nfrequency = {FREQUENCY}',
        swung,
        {"drives.own.amplitude": SWING, "drives.own.frequency": FREQUENCY, M: MASS},
    ),
    "force": (
        '[forces.own]\nkind = "force"\nat = {link = "mass", point = [0, 0, 0]}\naxes = "world"\n'
        f'force = ["1 N", "0 N", "0 N"]\nvalue = {PUSH}',
        pushed,
        {"forces.own.value": PUSH, M: MASS, V: SPEED},
    ),
}


def energy(kind, t, numbers):
    """Return what the mass has by moving, its work so far."""
    _, velocity, keys = DRIVES[kind]
    return 0.5 * numbers[list(keys).index(M)] * velocity(t, *numbers) ** 2


@functools.cache
def turns(kind):
    """Return when the work turns back."""
    numbers = list(DRIVES[kind][2].values())

    def power(t):
        return energy(kind, t + 1e-30j, numbers).imag

    grid = 1.5 * np.linspace(0.0, 1.0, 400) ** 1.01  # on none of which the power is zero by chance
    values = np.array([power(t) for t in grid])
    changes = np.flatnonzero(values[1:] * values[:-1] < 0.0)
    return [brentq(power, grid[k], grid[k + 1], xtol=1e-15) for k in changes]


def gross(kind, time, numbers):
    """Return the gross work up to a time, analytic in the numbers, of which turning back does not matter."""
    instants = [0.0, *(t for t in turns(kind) if t < time), time]
    there = [energy(kind, t, numbers) for t in instants]
    ways = [b - a for a, b in zip(there[:-1], there[1:], strict=True)]
    return sum(way if complex(way).real > 0.0 else -way for way in ways)


def scenario(folder, kind):
    """A mass without gravity, and what drives it."""
    head, _, initial = BASE.partition("[initial")
    initial = "[initial" + initial
    if kind == "motion":  # that of the start is its own
        initial = "[output]" + initial.partition("[output]")[2]
    changes = {"mechanism.gravity": [0.0, 0.0, 0.0]}
    return mass(folder, DRIVES[kind][0] + "\n", head + initial, **changes)


@pytest.mark.parametrize("kind", DRIVES)
def test_a_gross_work_is_how_far_the_work_has_gone(tmp_path, kind):
    """At samples, some of which lie in steps in which it turns back, whatever the tolerance is."""
    case, numbers = scenario(tmp_path, kind), list(DRIVES[kind][2].values())
    settings = RunSettings(rtol=1e-10, engine="compiled", output_rate=1e3, max_step=1e-2)  # ten in a step
    data = simulate(case, duration=1.5, settings=settings).data
    ours = data["force_gross_work" if kind == "force" else "drive_gross_work"].values[:, 0]
    exact = np.array([gross(kind, t, numbers) for t in data["time"].values])
    # As well as the work itself is known: ten of the tolerances.
    assert np.abs(ours - exact).max() < 1e-9 * exact[-1]


@pytest.mark.parametrize("method", ["runs", "equation"])
@pytest.mark.parametrize("kind", DRIVES)
def test_derivatives_of_gross_works(tmp_path, kind, method):
    """In all numbers, at times and in total, behind turns of the work."""
    keys = DRIVES[kind][2]
    found = sensitivities(scenario(tmp_path, kind), list(keys), TIMES, method=method)
    family = "force" if kind == "force" else "drive"
    total = "total_force_gross_work" if kind == "force" else "total_gross_work"
    values = list(keys.values())
    for k, value, stepped in stepped_numbers(keys):
        exact = np.array([complex(gross(kind, t, stepped)).imag for t in TIMES]) / 1e-30
        size = max(gross(kind, TIMES[-1], values), np.abs(exact * value).max())
        # Runs: their tolerance of 1e-12 over a step of 1e-3; the equation: of a number of a run's own error.
        least = (3e-8 if method == "runs" else 1e-9) * size
        for name, wanted in ((f"{family}_gross_work", exact), (total, exact[-1])):
            ours = np.atleast_1d(found.derivative(name)[..., 0, k])
            assert np.abs(ours - wanted).max() * abs(value) < least
            assert (np.abs(ours - wanted) <= np.atleast_1d(found.doubt(name)[..., 0, k]) + 1e-15).all()
