"""What a run of a flexible link swings with is what the linearised equations say."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import dominant_frequencies
from antenna_pin.studies.linear import modes

STILL = {"drives.azimuth.amplitude": 0.0, "drives.elevation.amplitude": 0.0}


@pytest.mark.parametrize(
    ("part", "start"), [("reflector_nod", {"angle": 1e-5}), ("reflector_bend", {"position": 1e-6})]
)
def test_a_mode_let_go_rings_at_its_coupled_frequency(part: str, start: dict[str, float]):
    scenario = load_scenario(
        "bai2020",
        case="flexible-ideal",
        overrides={**STILL, f"initial.joints.{part}": start, "integrator.rtol": 1e-11},
    )
    found = modes(scenario)
    swings = np.array([found.frequency[k - 1] for k in found.elastic])
    run = simulate(scenario, duration=4.0)
    values = run.data["deflection"].sel(elastic_part=part).values
    peaks = dominant_frequencies(run.data["time"].values, values, 1)
    nearest = swings[np.argmin(np.abs(swings - float(peaks["frequency"][0])))]
    # A window of 4 s resolves 0.375 Hz; between its bins a line that decays is found to a 30th of that.
    assert float(peaks["frequency"][0]) == pytest.approx(nearest, abs=0.0125)
    held = run.data.attrs["elastic_parts"]
    assert f'"frequency": {nearest:.3g}' not in held  # another one than with the hub held


def test_of_eight_petals_five_swings_move_no_hub():
    """Two waves around the rim or more (2, 2, 3, 3 and 4) are in balance: they stay at a petal's 15 Hz.

    The others, none and one around the rim, push or rock the hub, which gives way: they are faster.
    """
    found = modes(load_scenario("bai2020", case="petals-ideal"))
    swings = np.sort([found.frequency[k - 1] for k in found.elastic])
    assert len(swings) == 8
    assert swings[:5] == pytest.approx(15.0, rel=1e-8, abs=0.0)
    assert swings[5] > 15.03
