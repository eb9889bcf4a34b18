"""The equation beside differences of runs: what is noise of these, and what contradicts."""

from types import SimpleNamespace

import numpy as np
import pytest

from antenna_pin.studies.sensitivity import SensitivityError
from antenna_pin.studies.sensitivity.finite_differences import VariableDerivatives
from antenna_pin.studies.sensitivity.methods import _checked_by_runs

# Of three instants; the second is displaced most and in doubt by 0.6 %, the third by chance in none.
BY_RUNS = np.array([1.0, 100.0, 50.0])
DOUBTS = np.array([0.01, 0.6, 0.0])


def held(ours):
    runs, found = (
        VariableDerivatives({"onset_time": values}, {"onset_time": doubts})
        for values, doubts in ((BY_RUNS, DOUBTS), (ours, np.zeros(3)))
    )
    key, made = SimpleNamespace(key="a.play", scale=1.0), SimpleNamespace(sizes={"onset_time": 1e-3})
    (one,) = _checked_by_runs([runs], [found], made, (key,))
    return one


def test_what_runs_say_of_the_equation():
    """Behind the largest displacement its share is in doubt; what contradicts is refused by its key."""
    one = held(1.01 * BY_RUNS)
    assert (one.values["onset_time"] == 1.01 * BY_RUNS).all()
    assert (one.doubts["onset_time"] >= 0.01 * BY_RUNS * (1.0 - 1e-12)).all()  # round-off of the difference
    with pytest.raises(
        SensitivityError, match=r"over a\.play the equation and runs contradict about onset_time"
    ):
        held(1.02 * BY_RUNS)
