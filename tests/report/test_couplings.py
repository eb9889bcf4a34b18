"""What a report says of coupled joints."""

import numpy as np
import pytest
from coupled_fingers import write_coupled_fingers

from antenna_pin import load_scenario, simulate
from antenna_pin.show.report import report


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return simulate(load_scenario(write_coupled_fingers(tmp_path_factory.mktemp("fingers"))))


def test_words_counts_and_loads_of_couplings(run, shown):
    page = shown(report([run], figures=False, recordings=False).html)
    assert page.said("loops")["counted at the start"] == "2 equations of couplings, 2 independent; mobility 1"
    said = page.said("what-couplings")
    assert said["finger"] == "finger = −1 · thumb + 0.1 rad"
    assert said["rack"] == "rack = 10 mm/rad · thumb"
    torque = np.abs(run.data.coupling_torque).max("time")
    place = "couplings", "finger: finger follows thumb: peak torque"
    assert page.numbers(*place) == [float(torque.sel(coupling="finger"))]
    row = page.rows("couplings")["rack: rack follows thumb: peak force"]
    assert (row[0][1], row[0][2]) == (float(torque.sel(coupling="rack")), "N")
