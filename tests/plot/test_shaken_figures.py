"""Figures of a shaken base can be read, and show what the analysis has."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import power_density, quantity, shaken_target, swept_response
from antenna_pin.show.plot import CATALOGUE, allowed_figures, figure_density, figure_swept
from antenna_pin.studies.linear import frequency_response, modes

RANDOM = {
    "kind": "random",
    "direction": [0, 1, 0],
    "frequency": [5.0, 50.0],
    "density": [1.0, 1.0],
    "period": 4.0,
    "seed": 2,
    "replace": True,
}


@pytest.fixture(scope="module")
def swept():
    """The tight panel, swept so fast that it goes up and down in a few seconds."""
    changes = {"shake.y.octaves_per_minute": 20, "output.rate": 200.0}
    return simulate(load_scenario("shaker", case="tight", overrides=changes), duration=10.0)


@pytest.fixture(scope="module")
def random():
    return simulate(load_scenario("shaker", case="tight", overrides={"shake.y": RANDOM}), duration=4.0)


@pytest.mark.parametrize("width", ["page", "column"])
@pytest.mark.parametrize("name", ["swept_response", "random_density", "shock_spectrum"])
def test_it_can_be_read(swept, random, readable, name, width):
    run = random if name == "random_density" else swept
    readable(CATALOGUE[name].draw([run], width=width))


def test_each_run_has_the_figures_of_its_kind(swept, random):
    for run, own, other in (
        (swept, "swept_response", "random_density"),
        (random, "random_density", "swept_response"),
    ):
        names = {each.figure.name for each in allowed_figures([run])}
        assert own in names
        assert other not in names


def test_ways_up_and_down_are_lines_of_their_own(swept):
    """With the numbers that the analysis gives, and small motions beside them."""
    found = swept_response(swept, shaken_target(swept))
    system = modes(load_scenario("shaker", case="tight"))
    linear = frequency_response(system, "shake.y", shaken_target(swept), np.linspace(6.0, 18.0, 50))
    gain, distortion = figure_swept(swept, linear=linear).axes
    up, down, small = gain.lines
    assert (up.get_linestyle(), down.get_linestyle()) == ("-", "--")
    for line, way in ((up, 1), (down, -1)):
        here = np.sort(found["frequency"].values[found["way"].values == way])
        assert line.get_xdata() == pytest.approx(here)
    assert small.get_ydata() == pytest.approx(np.abs(linear["response"].values[:, 0]))
    assert len(distortion.lines) == 2


def test_a_density_stands_in_its_interval(random):
    one = quantity(random, shaken_target(random))
    found = power_density(one.time, one.values, units=one.units)
    line, asked = figure_density(random).axes[0].lines
    assert line.get_ydata() == pytest.approx(found["power"].values[1:])
    assert asked.get_ydata() == pytest.approx(1.0)  # (m/s^2)^2/Hz
