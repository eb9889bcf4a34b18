"""The figure of end stops and latches can be read, and marks what the run holds."""

import numpy as np
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


def test_marks_stand_on_the_curves_at_the_times_of_captures(array):
    (stops,) = (each for each in allowed_figures([array]) if each.figure.name == "stops")
    events = latch_events(array)
    captures = dict(zip(events["latch"].values.tolist(), events["time"].values.tolist(), strict=True))
    seen = {}
    for axes in stops.draw([array]).axes[::2]:
        (line,) = (one for one in axes.lines if len(one.get_xdata()) > 100)
        offsets = [np.asarray(one.get_offsets()) for one in axes.collections]
        marks = np.concatenate([one for one in offsets if len(one)])
        # A curve is thinned to a hundredth of a line's width, and turns sharply where a latch holds.
        on_curve = np.interp(marks[:, 0], line.get_xdata(), line.get_ydata())
        assert marks[:, 1] == pytest.approx(on_curve, abs=1e-3 * np.ptp(line.get_ydata()))
        seen[axes.get_title("left").split()[-1]] = marks[:, 0]
    for latch, time in captures.items():
        assert np.abs(seen[latch.rpartition(".")[2]] - time).min() < 1e-12
