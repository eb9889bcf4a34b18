"""Facts of a scenario: where hinges are in a start that was found."""

import math

import pytest

from antenna_pin import load_scenario
from antenna_pin.scenario.assemble import scenario_facts

CRANK, ROD = 0.05, 0.12  # [m]


@pytest.mark.parametrize("angle", [0.3, 2.5, -2.0])
def test_a_found_start_has_the_angles_of_crank_rod_and_slider(angle):
    """The rod's end stays on the line of the slider, which does not turn."""
    scenario = load_scenario("slider_crank", case="ideal").with_overrides({"drives.crank.position": angle})
    start = scenario_facts(scenario)["start"]
    assert set(start) == {"crank", "crank_pin", "pin"}
    crank, rod, slider = (start[name] for name in ("crank", "crank_pin", "pin"))
    slope = math.asin(CRANK / ROD * math.sin(angle))
    expected = angle, -angle - slope, slope
    # Loops are closed to 1e-10 of the mechanism's length.
    assert (crank, rod, slider) == pytest.approx(expected, abs=1e-9)
