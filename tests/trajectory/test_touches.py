"""Touches of stops, read from a result, against the closed form of a wheel between two springs."""

import dataclasses
import math

import numpy as np
import pytest
from wheel import INERTIA, wheel_urdf

from antenna_pin import RunSettings, System, build_mechanism, simulate
from antenna_pin.elements import EndStop
from antenna_pin.trajectory import Touch, touches

LASTS = 0.1  # of a touch, half a period [s]
LOWER, UPPER = -0.2, 0.3


@pytest.fixture(scope="module")
def data():
    """A wheel that starts between its stops at 1 rad/s, up to the middle of the third touch."""
    stiffness = INERTIA * (math.pi / LASTS) ** 2
    stop = EndStop(joint="axle", lower=LOWER, upper=UPPER, stiffness=stiffness, exponent=1.0, law="elastic")
    system = System(build_mechanism(wheel_urdf("revolute"), "fixed"), elements={"stops": {"ends": stop}})
    settings = RunSettings(rtol=1e-12, engine="compiled")
    return simulate(system, v=np.ones(1), duration=1.55, settings=settings).data


def test_a_wheel_between_springs_touches_them_in_turn(data):
    """Each for half a period, with 2 J w of impulse, at most w sqrt(J K); the last one is not over."""
    first, second, last = touches(data)
    # The tolerance of the run.
    for one, side, onset in ((first, "upper", UPPER), (second, "lower", 0.9), (last, "upper", 1.5)):
        assert (one.stop, one.side) == ("stops.ends", side)
        assert [one.onset, one.approach_rate] == pytest.approx([onset, 1.0], abs=1e-9)
        assert one.peak_effort == pytest.approx(INERTIA * math.pi / LASTS, rel=1e-6)
    for one in (first, second):
        assert one.ended and one.release - one.onset == pytest.approx(LASTS, abs=1e-9)
        assert [one.rebound_rate, one.impulse] == pytest.approx([1.0, 2.0 * INERTIA], abs=1e-9)
        assert one.loss == pytest.approx(0.0, abs=1e-9)
    assert not last.ended and np.isnan([last.rebound_rate, last.impulse, last.loss]).all()


def test_a_release_whose_onset_is_not_in_a_result_is_no_touch(data):
    """As in a part of a run that begins while the stop is pressed."""
    _, *others = touches(data)
    assert [one.onset for one in touches(data.isel(change=slice(1, None)))] == [one.onset for one in others]


def test_a_touch_is_a_value():
    """Equal where all its numbers are, in a set once; named one by one, as nine of them would be mixed up."""

    def touch(**changes):
        numbers = dict.fromkeys(("onset", "approach_rate", "rebound_rate", "peak_effort", "impulse"), 1.0)
        return Touch(
            **{"stop": "stops.hinge", "side": "upper", "release": 2.0, "loss": 0.2} | numbers | changes
        )

    assert {touch(), touch()} == {touch()} != {touch(loss=0.3)}
    assert touch().ended and not touch(release=math.nan).ended
    with pytest.raises(TypeError):
        Touch(*dataclasses.astuple(touch()))
