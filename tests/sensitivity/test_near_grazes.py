"""Next to a graze the equation is right to its own doubt, or refuses: it is never silent and wrong.

A mass is thrown up to a ceiling with a speed that just reaches it, or just does not. It arrives there with
``w = sqrt(v^2 - 2 g h)``. Behind a blow of restitution e it is ``(1 + e) w`` slower than without; behind a
ceiling that gives way it comes out as fast as it went in, and later.
"""

import math

import pytest

from antenna_pin import load_scenario
from antenna_pin.sensitivity import GrazeError, sensitivities
from tests.sensitivity.test_closed_forms import BASE, MASS, PLACE, PULL, URDF

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
    (folder / "mass.urdf").write_text(URDF)
    stop = f'\n[stops.ceiling]\njoint = "way"\nlower = "-9 m"\nupper = "{CEILING} m"\n{ceiling}\n'
    (folder / "mass.toml").write_text(BASE + stop)
    return load_scenario(str(folder / "mass.toml"), overrides={"integrator.engine": "compiled", KEY: speed})


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
    for power in (1, 4, 7, 8, 9, 10, 12):
        speed = JUST * (1.0 + side * 10.0**-power)
        try:
            found = sensitivities(thrown(tmp_path, ceiling, speed), [KEY], [END], method="equation")
        except GrazeError as error:
            assert abs(error.time - speed / PULL) < 1e-3  # up there: w / g beside the top, of w = 6e-4 m/s
            continue
        answered += 1
        ours, doubt = (one("v")[0, 0, 0] for one in (found.derivative, found.doubt))
        assert abs(ours - slope(ceiling, speed)) <= doubt
    assert answered >= 4  # all but those so near that runs beside them meet it, or do not
