"""What reports and ``analyse`` say of flexible links."""

from __future__ import annotations

import json

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import elastic_motion
from antenna_pin.show.report import report


@pytest.fixture(scope="module")
def runs():
    cases = {"flexible-ideal": 2.0, "petals-ideal": 0.1}
    return {
        case: simulate(load_scenario("bai2020", case=case), duration=span) for case, span in cases.items()
    }


def test_a_report_says_what_bends_and_how_far(runs, shown):
    page = shown(report(list(runs.values()), figures=False, recordings=False).html)
    lines = page.lines("elastic")
    found = elastic_motion(runs["flexible-ideal"])
    for row, key in (
        ("peak deflection", "peak_deflection"),
        ("peak energy", "peak_energy"),
        ("energy lost", "lost"),
        ("spin over frequency", "spin_ratio"),
    ):
        for part in ("reflector_nod", "reflector_bend"):
            assert lines[f"{part}, flexible-ideal"][row] == float(found[key].sel(elastic_part=part))
    said = page.said("what-flexible-links")["reflector"]
    assert "reflector_nod: 0.1707 kg m² that turns against a spring, 15 Hz with the hub held" in said
    assert "reflector_petal1 to reflector_petal8, 8 in all: each" in said
    assert "reflector_nod" not in page.said("what-joints")


def test_spectra_show_a_mode_at_its_coupled_frequency(runs, tmp_path, cli):
    """The nod swings against shaft and hub about the elevation axis, which its motor leaves free.

    omega sqrt(I / (I - J)) with I of all that turns about that axis; at a resolution of 0.75 Hz the
    frequency of a line is found between the bins. The base, 500 times as heavy, adds a thousandth.
    """
    path = runs["flexible-ideal"].save(tmp_path / "run.nc")
    found = json.loads(cli("analyse", path, "--json").out)
    (nod,) = [one for one in found["frequencies"] if one["of"] == "reflector_nod deflection"]
    whole, part = 0.00589 + 0.68297, 0.1707
    expected = 15.0 * np.sqrt(whole / (whole - part))
    assert min(abs(np.array(nod["frequency"]) - expected)) < 0.1
    assert [one["of"] for one in found["elastic"]] == ["reflector_nod", "reflector_bend"]
    assert [one["units"] for one in found["elastic"]] == ["rad", "m"]
    assert "deflections of flexible links" in cli("analyse", path).out
