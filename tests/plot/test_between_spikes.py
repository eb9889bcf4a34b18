"""The size of what is smooth, which decides how far a scale of accelerations is linear."""

import numpy as np

from antenna_pin.plot._compared import panels_sheet
from antenna_pin.plot._style import LINEAR_BETWEEN, footnote
from antenna_pin.plot._thinned import between_spikes
from antenna_pin.plot.grammar import Axis, Curve, Panel, render


def with_impacts(amplitude, spike):
    """A sine of 3 Hz over 5 s, sampled at 1 kHz, and every 50 ms an impact of 0.2 ms, sampled three times."""
    onset = np.arange(0.02, 5.0, 0.05)
    time = np.unique(np.concatenate([np.linspace(0.0, 5.0, 5001), onset, onset + 1e-4, onset + 2e-4]))
    value = amplitude * np.sin(6.0 * np.pi * time)
    value[np.isin(time, onset + 1e-4)] += spike
    return time, value


def test_a_sine_under_impacts_counts_whole():
    time, value = with_impacts(0.3, 2000.0)
    # A scale is linear to 1.2 times the size at least: the crest is on its linear part.
    assert 0.3 / 1.2 < between_spikes(time, value) <= 0.3
    assert between_spikes(time[:1], value[:1]) == abs(value[0])
    assert between_spikes(time, np.full(time.size, np.nan)) == 0.0


def test_a_scale_is_linear_as_far_as_every_run_is_smooth():
    """The ideal run does not move that way at all: what the play does is a sine, and looks like one."""
    time, value = with_impacts(0.3, 2000.0)
    still = Curve("ideal", time, 1e-6 * value, {}, smooth=True)
    assert 0.3 / 1.2 < Panel("", [Curve("play", time, value), still]).core <= 0.3


def test_what_dotted_lines_mean_stands_once_below_the_panels():
    """Beside the axes it would take the room of the label; limits stand as ticks at the lines."""
    time, value = with_impacts(0.3, 2000.0)
    y = Axis("acceleration", "m/s^2")
    panels = [Panel(name, [Curve(name, time, value)], y) for name in ("x", "y")]
    figure = render(panels_sheet(panels, "page", 2, spikes=True))
    assert figure.get_supxlabel() == LINEAR_BETWEEN
    assert all("\n" not in axes.get_ylabel() for axes in figure.axes)
    footnote(figure, "world axes")
    assert figure.get_supxlabel() == f"{LINEAR_BETWEEN}; world axes"
    assert not render(panels_sheet(panels, "page", 2)).get_supxlabel()
