"""State feedback, with and without states of its own, against the exact discrete solution."""

import dataclasses

import numpy as np
import pytest
from controlled_wheel import PERIOD, ROUND_OFF, WHEEL, rig

from antenna_pin import RunSettings, simulate
from antenna_pin.elements.control import Sensor, StateFeedback
from antenna_pin.errors import AntennaPinError

# The wheel over a period, exactly.
F = np.array([[1.0, PERIOD], [0.0, 1.0]])
G = np.array([0.5 * PERIOD**2, PERIOD]) / WHEEL
PLAIN = StateFeedback(
    acts_on=("motor",),
    measures=("angle joint", "rate joint"),
    period=PERIOD,
    gain=((40.0, 8.0),),
    reference=(0.3, 0.0),
)


def run_of(controller, count=50):
    settings = RunSettings(output_rate=1.0 / PERIOD)
    return simulate(rig(), duration=count * PERIOD, controllers={"loop": controller}, settings=settings)


def test_gain_is_the_discrete_loop():
    run = run_of(PLAIN)
    state, angles = np.zeros(2), []
    for _ in range(50):
        angles.append(state[0])
        state = F @ state - G * (PLAIN.gain[0] @ (state - np.array([0.3, 0.0])))
    assert run.data.motion_angle.values[:50, 0] == pytest.approx(angles, abs=ROUND_OFF)


def test_an_observer_sees_the_rate():
    """It measures the angle alone; its error dies out at the poles 0.5 of F - L C, so in three instants by 8.

    u = -K (x^ - r), and x^ goes on by F x^ + G u + L (y - C x^): in shifted coordinates with r = (0.3, 0).
    """
    gain = np.array([[40.0, 8.0]])
    # (F - L C) has both eigenvalues at 0.5: its trace is 1, its determinant 1/4.
    lead = np.array([1.0, 0.25 / PERIOD])
    a = F - np.outer(lead, [1.0, 0.0])
    observer = dataclasses.replace(
        PLAIN,
        measures=("angle joint",),
        gain=None,
        reference=(0.3,),
        a=tuple(map(tuple, a.tolist())),
        b=tuple((one,) for one in lead.tolist()),
        c=tuple(map(tuple, (-gain).tolist())),
        g=tuple((one,) for one in G.tolist()),
        upper=(3.0,),
    )
    run = run_of(observer)
    state, guess, angles = np.zeros(2), np.zeros(2), []
    for _ in range(50):
        angles.append(state[0])
        off = state[0] - 0.3
        torque = min(float(-gain[0] @ guess), 3.0)
        guess = a @ guess + lead * off + G * torque
        state = F @ state + G * torque
    assert run.data.motion_angle.values[:50, 0] == pytest.approx(angles, abs=10.0 * ROUND_OFF)
    # It is told what was commanded in truth, so that limits do not deceive it.
    assert guess == pytest.approx(state - [0.3, 0.0], abs=1e-9)


def test_sensors_are_one_for_each_measure():
    seen = run_of(dataclasses.replace(PLAIN, sensors=(Sensor(resolution=0.05), Sensor(noise=0.1, seed=1))))
    angle = seen.data.tick_signal.sel(signal="loop.angle joint").values
    assert np.round(angle / 0.05) * 0.05 == pytest.approx(angle, abs=1e-15)
    rate = seen.data.tick_signal.sel(signal="loop.rate joint").values
    assert 0.05 < np.std(rate - seen.data.motion_rate.values[:51, 0]) < 0.2


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"gain": ((1.0,),)}, "StateFeedback: gain must be 1 rows of 2 finite numbers"),
        ({"gain": None}, "StateFeedback: gain must be given, or a, b and c"),
        ({"a": ((1.0,),)}, "StateFeedback: b must be given beside a"),
        ({"upper": (1.0, 2.0)}, "StateFeedback: upper must be 1 numbers"),
        ({"lower": (1.0,), "upper": (0.0,)}, "upper[0] must be above lower = 1, got 0.0"),
        ({"measures": ("angle joint", "speed joint")}, "got 'speed joint'"),
        ({"g": ((1.0,),)}, "StateFeedback: g must be left out without a"),
        ({"sensors": (Sensor(),) * 3}, "sensors must be one for each of 2 measures, or one"),
    ],
    ids=str,
)
def test_refusals(changes, said):
    with pytest.raises(AntennaPinError) as error:
        dataclasses.replace(PLAIN, **changes)
    assert said in str(error.value)
    assert "\n" not in str(error.value)
