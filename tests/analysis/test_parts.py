"""What is made of a long run part by part is what is made of it at once."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_poses, even
from antenna_pin.analysis.spectrum import uniform
from antenna_pin.mechanism import kinematics


@pytest.mark.parametrize("at_once", [11, 100])
@pytest.mark.parametrize("shape", [(), (3,)])
def test_a_signal_is_thinned_part_by_part(monkeypatch, at_once, shape):
    rng = np.random.default_rng(0)
    time = np.sort(np.concatenate([np.linspace(0.0, 1.0, 1000), rng.random(200)]))
    values = rng.normal(size=(time.size, *shape))
    whole = uniform(time, values).values
    monkeypatch.setattr(even, "_AT_ONCE", at_once)
    assert uniform(time, values).values == pytest.approx(whole, rel=0.0, abs=1e-13)  # round-off


def test_attitudes_do_not_jump_from_part_to_part(monkeypatch):
    run = simulate(load_scenario("bai2020", case="case1"), duration=0.05)
    whole = body_poses(run)
    monkeypatch.setattr(kinematics, "_AT_ONCE", 7)
    assert body_poses(run).identical(whole)
