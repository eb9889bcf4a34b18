"""A bang-bang controller that turns a satellite by thrusters, against exact motion between its instants."""

import math

import numpy as np
import pytest

from antenna_pin import RunSettings, System, Urdf, build_mechanism, simulate
from antenna_pin.elements import Thruster
from antenna_pin.elements.control import BangBang

# No angle or rate at an instant is on an edge of the controller's line.
INERTIA, ARM, THRUST, START = 1.5, 0.4, 0.2537, 0.3123
BODY = f"""<robot name="body"><link name="body"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1.2" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""


def satellite():
    """A body with a couple of thrusters each way about its z axis."""
    couples = {"up": 1.0, "down": -1.0}
    forces = {
        f"{name}{side}": Thruster(
            at=("body", (side * ARM, 0.0, 0.0)), direction=(0.0, side * sign, 0.0), thrust=THRUST
        )
        for name, sign in couples.items()
        for side in (1, -1)
    }
    return System(build_mechanism(Urdf.from_text(BODY, "body.urdf"), "free"), elements={"forces": forces})


def controller(**more):
    """One that brings the satellite back to zero, with a dead band."""
    given = {
        "positive": ("up1", "up-1"),
        "negative": ("down1", "down-1"),
        "period": 0.02,
        "measures": "base-rotation z",
        "measures_rate": "base-rate z",
        "slope": 1.5,
        "dead_band": 0.02,
        "hysteresis": 0.01,
    }
    return BangBang(**given | more)


def by_hand(angle, rate, own, instants, least=0):
    """Angles at the instants, and for how long it was on each way: (angle, on) of the double integrator."""
    acceleration = 2.0 * ARM * THRUST / INERTIA
    way, since, angles, on = 0, 0, [], {1: 0, -1: 0}
    for _ in range(instants):
        angles.append(angle)
        line = -angle - own.slope * rate
        before, size = way, abs(line)
        toward = int(math.copysign(1, line))
        held = before and line * before > own.dead_band - own.hysteresis
        wanted = before if held else toward if size > own.dead_band else 0
        if before not in (0, wanted) and since < least:
            wanted = before
        since = since + 1 if wanted == before else 1
        way = wanted
        if way:
            on[way] += 1
        h = own.period
        angle += rate * h + 0.5 * way * acceleration * h * h
        rate += way * acceleration * h
    return np.array(angles), on


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
@pytest.mark.parametrize("minimum_on", [0.0, 0.1])
def test_it_is_the_double_integrator_with_the_pulses_that_it_commands(engine, minimum_on):
    """About one axis of inertia the motion is exact for any tolerance; impulses are thrust times time on."""
    own = controller(minimum_on=minimum_on)
    settings = RunSettings(engine=engine, rtol=1e-3, output_rate=50.0)
    q = [0.0, 0.0, 0.0, 0.0, 0.0, math.sin(0.5 * START), math.cos(0.5 * START)]
    run = simulate(satellite(), duration=20.0, q=q, controllers={"axis": own}, settings=settings)
    assert run.completed
    least = math.ceil(minimum_on / own.period - 1e-9)
    expected, on = by_hand(START, 0.0, own, 1000, least)
    data = run.data
    column = list(data["signal"].values).index("axis.measured")
    seen = data["tick_signal"].values[:1000, column]
    # Sums of a thousand instants; the motion between two is a polynomial of second degree.
    assert seen == pytest.approx(expected, abs=1e-11)
    assert on[1] > 0 and on[-1] > 0  # it speeds up and brakes
    assert np.abs(expected[-200:]).max() < 1.5 * own.dead_band
    # A couple of thrusters brings in no impulse, but their own: along y of the body each its thrust times on.
    turn = float(data["angular_momentum"].values[-1, 2])
    assert turn == pytest.approx(2.0 * ARM * THRUST * own.period * (on[1] - on[-1]), abs=1e-9)


def test_two_halves_are_one_in_the_middle_of_a_pulse():
    q = [0.0, 0.0, 0.0, 0.0, 0.0, math.sin(0.5 * START), math.cos(0.5 * START)]
    given = {"controllers": {"axis": controller()}, "settings": RunSettings(rtol=1e-6)}
    whole = simulate(satellite(), duration=1.0, q=q, **given)
    half = simulate(satellite(), duration=0.371, q=q, **given)
    rest = simulate(satellite(), duration=0.629, start=half.end, **given)
    assert rest.end.q.tobytes() == whole.end.q.tobytes() and rest.end.v.tobytes() == whole.end.v.tobytes()
