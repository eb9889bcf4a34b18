"""The figure of end stops and latches can be read, and marks what the run holds."""

import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import latch_events
from antenna_pin.plot import allowed_figures


@pytest.fixture(scope="module")
def array():
    """A solar array that unfolds, past its stops and latches."""
    return simulate(load_scenario("solar_array", case="ideal"), duration=9.0)


@pytest.mark.parametrize("width", ["page", "column"])
def test_stops_and_latches_of_four_hinges_can_be_read(array, readable, width):
    (stops,) = (each for each in allowed_figures([array]) if each.figure.name == "stops")
    figure = stops.draw([array], width=width)
    readable(figure)
    assert {axes.get_title("left").rpartition("$ ")[2].split()[-1] for axes in figure.axes[::2]} == {
        "root",
        "first",
        "second",
        "third",
    }
    assert latch_events(array).sizes["latch_event"] == 4  # each captured once
