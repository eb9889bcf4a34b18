"""A compliant stop where a run begins, and where its numbers or its joint's place are others."""

import dataclasses

import pytest

from antenna_pin.contact.onset import NO_APPROACH
from antenna_pin.elements import EndStop
from antenna_pin.elements.limits import FREE, LOWER, UPPER
from antenna_pin.elements.modal import Met

STOP = EndStop(joint="hinge", lower=-0.2, upper=0.5, stiffness=100.0, restitution=0.8)


@pytest.mark.parametrize(
    ("angle", "rate", "side", "approach"),
    [
        (0.1, 3.0, FREE, 0.0),
        (0.5, -2.0, FREE, 0.0),  # at the limit and on its way off
        (-0.2, 2.0, FREE, 0.0),
        (0.5, 2.0, UPPER, 2.0),  # at the limit the touch begins, with the rate of the start
        (-0.2, -2.0, LOWER, 2.0),
        (0.6, 1.0, UPPER, NO_APPROACH),  # beyond it began before all that is known
        (0.6, -1.0, UPPER, NO_APPROACH),
        (-0.3, -1.0, LOWER, NO_APPROACH),
    ],
)
def test_a_start_beyond_a_limit_or_at_it_is_a_touch(angle, rate, side, approach):
    """It has turned back if it moves out of the stop; what goes on in the mode it is in is no change."""
    met = Met(0.0, angle, rate, 0.0)
    for mode in (FREE, LOWER, UPPER):
        stop = dataclasses.replace(STOP, mode=mode)
        found = stop.initial_change(met) if side != FREE else stop.in_another(met)
        if mode == side:
            assert found is None
            continue
        assert found.mode == side
        assert found.memory["approach"] == approach
        if side == FREE:
            assert found.what == "" and found.memory["turned"] == 0.0
        else:
            assert found.what == f"{('lower', 'upper')[side - 1]}: on"
            into = rate if side == UPPER else -rate
            assert found.memory["turned"] == float(into <= 0.0)
