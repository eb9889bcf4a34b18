"""A session of a system with sampled controllers is one run of it, however finely it is told."""

import numpy as np
import pytest
from controlled_wheel import PLAIN, rig

import antenna_pin
from antenna_pin import simulate


@pytest.mark.parametrize("step", [0.0037, 0.01, 0.025])
def test_a_session_is_one_run_with_the_same_instants(step):
    """Steps that end between instants, at each, and behind several: nothing is asked twice or late."""
    session = antenna_pin.run.session.start(rig(), controllers={"loop": PLAIN})
    while session.time + step < 0.3:
        session.step(step)
    session.run_until(0.3)
    whole = simulate(rig(), duration=0.3, controllers={"loop": PLAIN})
    run = session.trajectory()
    for name in ("q", "v", "tick_time", "tick_signal"):
        assert np.array_equal(run.data[name].values, whole.data[name].values, equal_nan=True), name
