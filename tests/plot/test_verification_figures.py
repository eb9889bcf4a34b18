"""Figures of a verification: what they draw is what they are drawn of."""

import numpy as np
import pytest

from antenna_pin.base.tolerance_chain import Dimension, ToleranceChain
from antenna_pin.errors import AntennaPinError
from antenna_pin.show.plot import figure_chain

from .conftest import note_of


def chain(*zones, **more):
    parts = [
        Dimension(name=f"d{k}", nominal=0.0, minus=-half, plus=half, distribution="uniform", **more)
        for k, half in enumerate(zones)
    ]
    return ToleranceChain(name="play", dimensions=parts)


def test_a_chain_is_drawn_with_its_zones_its_distribution_and_its_limits():
    """Two uniform zones of 20 um have a triangle for their sum: 1 / 20 um at its middle, nothing at 20 um."""
    drawn = figure_chain(chain(10e-6, 10e-6), least=-25e-6)
    parts, total = drawn.axes
    widths = [bar.get_width() for bar in parts.patches]
    assert widths == pytest.approx([20.0, 20.0, np.sqrt(2.0) * 20.0, 40.0], rel=1e-12)  # [um]
    names = [text.get_text() for text in parts.get_yticklabels()]
    assert names == ["d0, 50 %", "d1, 50 %", "root sum square", "worst case"]
    lines = {line.get_label(): line for line in total.lines}
    places, density = lines["distribution"].get_xdata(), lines["distribution"].get_ydata()
    exact = (1.0 - np.abs(places) / 20.0) / 20e-6
    assert np.abs(density - exact).max() < 1e-3 / 20e-6  # cells of a 16384th of the whole range
    at = sorted(float(line.get_xdata()[0]) for line in total.lines if line is not lines["distribution"])
    assert at == pytest.approx([-25.0, -20.0, -np.sqrt(2.0) * 10.0, np.sqrt(2.0) * 10.0, 20.0], rel=1e-12)
    assert "99.73 % lie between" in note_of(drawn)
    with pytest.raises(AntennaPinError, match="chain must be with a tolerance"):
        figure_chain(chain(0.0))
