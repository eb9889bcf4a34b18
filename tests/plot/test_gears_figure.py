"""The figure of gears can be read, and marks the touches that the run has."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import gear_impacts
from antenna_pin.plot import allowed_figures


@pytest.fixture(scope="module")
def runs():
    """A gear with play, one without, and belts."""
    return [
        simulate(load_scenario("pointing_gear"), duration=1.0),
        simulate(load_scenario("pointing_gear", case="tight"), duration=1.0),
        simulate(load_scenario("solar_array", case="ideal"), duration=1.0),
    ]


@pytest.mark.parametrize("width", ["page", "column"])
def test_gears_and_belts_can_be_read(runs, readable, width):
    (gears,) = (each for each in allowed_figures(runs) if each.figure.name == "gears")
    figure = gears.draw(runs, width=width)
    readable(figure)
    titles = [axes.get_title("left").rpartition("$ ")[2] for axes in figure.axes[::2]]
    assert titles == ["train", "root first", "first second", "second third"]
    onsets = gear_impacts(runs[0]).onset.values
    marked = np.concatenate([np.asarray(one.get_offsets()) for one in figure.axes[0].collections])
    assert len(onsets) > 5
    assert np.isin(onsets, marked[:, 0]).all()


def test_runs_without_gears_have_none(readable):
    run = simulate(load_scenario("impact_pair"), duration=1e-3)
    assert "gears" not in {each.figure.name for each in allowed_figures([run])}
