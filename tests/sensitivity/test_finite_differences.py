"""Next to a graze the equation is right to its own doubt, or refuses: it is never silent and wrong.

A mass is thrown up to a ceiling with a speed that just reaches it, or just does not. It arrives there with
``w = sqrt(v^2 - 2 g h)``. Behind a blow of restitution e it is ``(1 + e) w`` slower than without; behind a
ceiling that gives way it comes out as fast as it went in, and later.

A disc in a fixed bore is thrown up alike, from the middle to where its play ends. There it is pressed by
``K d + D d'``, never pulled: a damped oscillator under gravity up to where that is zero.
"""

import cmath
import math

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import load_scenario
from antenna_pin.studies.sensitivity import GrazeError, sensitivities
from tests.sensitivity.test_closed_forms import MASS, PLACE, PULL, mass

CEILING, BACK = 1.5, 0.8
SPRING = 2e3  # [N/m]
JUST = math.sqrt(2.0 * PULL * (CEILING - PLACE))
END = 0.9
KEY = "initial.joints.way.velocity"
# Rebound at any speed: by itself a stop gives none below a rate at which a joint comes to rest.
RIGID = f'kind = "rigid"\nrestitution = {BACK}\nrest_rate = "1e-12 m/s"'
SOFT = f'stiffness = "{SPRING} N/m"\nexponent = 1.0\nlaw = "elastic"'


def thrown(folder, ceiling, speed):
    """A mass thrown up to a ceiling."""
    stop = f'\n[stops.ceiling]\njoint = "way"\nlower = "-9 m"\nupper = "{CEILING} m"\n{ceiling}\n'
    return mass(folder, stop, **{KEY: speed})


def slope(ceiling, speed):
    """Return by how much the velocity at the end changes with that at the start."""
    if speed <= JUST:
        return 1.0
    arrives = math.sqrt(speed**2 - JUST**2)
    if ceiling == RIGID:
        return 1.0 - (1.0 + BACK) * speed / arrives
    # In the ceiling it stays 2 atan(omega w / g) / omega.
    stiff = (math.sqrt(SPRING / MASS) * arrives / PULL) ** 2
    return 1.0 - 2.0 * speed / arrives * stiff / (1.0 + stiff)


@pytest.mark.parametrize("ceiling", [RIGID, SOFT], ids=["rigid", "giving way"])
@pytest.mark.parametrize("side", [1.0, -1.0], ids=["just made", "just missed"])
def test_none_is_silent(tmp_path, ceiling, side):
    """From a tenth to 1e-12 beside the speed that just reaches the ceiling."""
    answered = 0
    for power in (1, 7, 8, 9, 12):
        speed = JUST * (1.0 + side * 10.0**-power)
        try:
            found = sensitivities(thrown(tmp_path, ceiling, speed), [KEY], [END], method="equation")
        except GrazeError as error:
            assert abs(error.time - speed / PULL) < 1e-3  # up there: w / g beside the top, of w = 6e-4 m/s
            continue
        answered += 1
        ours, doubt = (one("v")[0, 0, 0] for one in (found.derivative, found.doubt))
        assert abs(ours - slope(ceiling, speed)) <= doubt
    assert answered >= 2  # all but those so near that runs beside them meet it, or do not


DISC, BORE, PLAY, STIFF, DAMPER = 2.0, 0.01, 1e-3, 1e6, 300.0
UP = math.sqrt(2.0 * PULL * PLAY)
SPAN = 25e-3  # [s], of some 29 up to the top and down to the bottom of the bore
THROWN = "initial.joints.bore.journal_velocity[0]"


def disc(damping, speed):
    """A disc thrown up in a bore, frictionless."""
    law = f"law = 'kelvin-voigt', stiffness = {STIFF}, exponent = 1.0, damping = {damping}, replace = true"
    changes = {
        "integrator.engine": "compiled",
        "mechanism.base": "fixed",
        "mechanism.gravity": [-PULL, 0.0, 0.0],
        "mechanism.links.disc.mass": DISC,
        "clearance.bore.geometry": "closed-form",
        "clearance.bore.bearing_radius": BORE,
        "clearance.bore.radial_clearance": PLAY,
        "clearance.bore.normal": f"{{ {law} }}",
        "initial.joints.bore.journal_velocity": [speed, 0.0, 0.0],
    }
    return load_scenario(
        "impact_pair", case="planar", overrides=[f"{key}={value}" for key, value in changes.items()]
    )


def falls_at(damping, speed):
    """Return the disc's velocity at SPAN, analytic in the speed, by the closed form."""
    if speed.real <= UP:
        return speed - PULL * SPAN
    arrives = cmath.sqrt(speed**2 - UP**2)
    rest, half = -DISC * PULL / STIFF, 0.5 * damping / DISC
    omega = math.sqrt(STIFF / DISC - half**2)
    a, b = -rest, (arrives - half * rest) / omega

    def inside(t):
        """Depth and its rate, from the onset on."""
        wave, turned = cmath.cos(omega * t), cmath.sin(omega * t)
        depth, slope = a * wave + b * turned, omega * (b * wave - a * turned)
        return rest + cmath.exp(-half * t) * depth, cmath.exp(-half * t) * (slope - half * depth)

    def push(t):
        depth, rate = inside(t)
        return STIFF * depth + damping * rate

    grid = np.linspace(0.0, 1.0, 2000) ** 3 * 2.0 * math.pi / omega
    last = next(k for k in range(1, len(grid)) if push(grid[k]).real < 0.0)
    ends = complex(brentq(lambda t: push(t).real, max(grid[last - 1], 1e-14), grid[last], xtol=1e-18))
    ends -= 1j * push(ends).imag / (STIFF * inside(ends)[1].real - damping * PULL)  # by m d'' = - m g there
    return inside(ends)[1] - PULL * (SPAN - (speed - arrives) / PULL - ends)


@pytest.mark.parametrize(("damping", "side"), [(0.0, 1.0), (DAMPER, 1.0), (DAMPER, -1.0)])
def test_none_is_silent_in_a_play(damping, side):
    """Likewise from a tenth to 1e-12 beside the speed that just carries a disc through its play."""
    answered = 0
    for power in (1, 7, 8, 9, 12):
        speed = UP * (1.0 + side * 10.0**-power)
        try:
            found = sensitivities(disc(damping, speed), [THROWN], [SPAN], method="equation")
        except GrazeError as error:
            assert abs(error.time - speed / PULL) < 1e-4
            continue
        answered += 1
        exact = falls_at(damping, complex(speed, 1e-30)).imag / 1e-30
        ours, doubt = (one("v")[0, 0, 0] for one in (found.derivative, found.doubt))
        assert abs(ours - exact) <= doubt
    assert answered >= 2
