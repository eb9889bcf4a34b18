"""The figure of coupled joints: torques on followers."""

import numpy as np
import pytest
from coupled_fingers import write_coupled_fingers

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot import figure_coupling_torques


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return simulate(load_scenario(write_coupled_fingers(tmp_path_factory.mktemp("fingers"))))


def test_lines_are_torques_and_forces_on_followers(run, readable):
    figure = figure_coupling_torques([run])
    panels = {axes.get_title("left").rpartition("$ ")[2]: axes for axes in figure.axes}
    assert set(panels) == {"finger, torque on finger", "rack, force on rack"}
    for name, title in (("finger", "finger, torque on finger"), ("rack", "rack, force on rack")):
        (line,) = (line for line in panels[title].lines if len(line.get_ydata()) > 2)
        unit = panels[title].get_ylabel().partition("[")[2].partition("]")[0]
        factor = {"m": 1e3}.get(unit[0], 1.0)
        values = run.data.coupling_torque.sel(coupling=name).values
        np.testing.assert_allclose(line.get_ydata(), factor * values, rtol=1e-14)
    readable(figure)


def test_a_run_without_couplings_has_no_such_figure(tmp_path):
    path = write_coupled_fingers(tmp_path / "fingers")
    text = path.read_text() + "[mechanism.joints.finger]\nmimic = false\n"
    path.write_text(text.replace('[couplings.rack]\nleader = "thumb"\nmultiplier = "10 mm/rad"\n', ""))
    with pytest.raises(InvalidParameterError, match="at least one run with a coupling of joints"):
        figure_coupling_torques([simulate(load_scenario(path))])
