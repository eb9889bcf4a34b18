"""Phase portraits as figures: their size, their scales, and the colour of the time."""

import numpy as np
import pytest

from antenna_pin.analysis import Quantity
from antenna_pin.analysis.phase import PhasePortrait
from antenna_pin.show.plot import figure_phase

TIME = np.linspace(0.0, 2.0, 2001)


def portrait(width, height, units=("m", "m")):
    """An ellipse, of which one turn takes a second."""
    turn = 2.0 * np.pi * TIME
    values = (width * np.cos(turn), height * np.sin(turn))
    named = zip(("x", "y"), values, units, strict=True)
    quantities = tuple(Quantity(name, TIME, one, unit, name) for name, one, unit in named)
    return PhasePortrait(run="case", quantities=quantities, start=0.0, rule="from the first sample on")


@pytest.mark.parametrize(("width", "size"), [("column", (88.0, 82.0)), ("page", (180.0, 120.0))])
@pytest.mark.parametrize("shade", ["time", "density"])
def test_it_is_as_large_as_a_column_or_a_page_takes(width, size, shade, readable):
    figure = figure_phase(portrait(3e-4, 1e-4), shade=shade, width=width)
    assert 25.4 * figure.get_size_inches() == pytest.approx(size, rel=1e-12)
    readable(figure)


def test_a_path_has_one_scale_and_one_unit_unless_it_would_be_a_sliver():
    for height, aspect in ((1e-4, 1.0), (1e-6, "auto"), (3e-4, 1.0)):
        axes = figure_phase(portrait(3e-4, height)).axes[0]
        assert axes.get_aspect() == aspect
        assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [mm]", "y [mm]")
    other = figure_phase(portrait(3e-4, 3e-4, ("m", "m/s"))).axes[0]
    assert other.get_aspect() == "auto" and other.get_ylabel().startswith("y [")


def test_the_colour_is_the_time():
    axes, bar = figure_phase(portrait(3e-4, 1e-4)).axes
    (line,) = axes.collections
    segments, times = np.array(line.get_segments()), line.get_array()
    assert bar.get_ylabel() == "time [s]" and line.get_clim() == (0.0, 2.0)
    middles = 0.5 * (segments[:, 0] + segments[:, -1])
    turn = 2.0 * np.pi * np.asarray(times)
    # A chord is nearer to the centre by an eighth of the square of its turn of 6 mrad.
    assert middles == pytest.approx(np.column_stack([0.3 * np.cos(turn), 0.1 * np.sin(turn)]), abs=1e-5)
