"""Figures of flexible links: readable, and what they show is what the runs hold."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import AntennaPinError, load_scenario, simulate
from antenna_pin.plot import allowed_figures, figure_deflection


@pytest.fixture(scope="module")
def runs():
    cases = ("flexible-ideal", "flexible", "petals", "case1")
    return {case: simulate(load_scenario("bai2020", case=case), duration=0.12) for case in cases}


@pytest.mark.parametrize("width", [pytest.param("page", marks=pytest.mark.slow), "column"])
def test_all_figures_of_flexible_links_can_be_read(runs, readable, width):
    allowed = {each.figure.name: each for each in allowed_figures(runs.values())}
    assert "deflection" in allowed
    for name in ("deflection", "energy", "spectra", "joint_load"):
        readable(allowed[name].draw(runs.values(), width=width))
    assert "deflection" not in {each.figure.name for each in allowed_figures([runs["case1"]])}


def test_deflections_are_those_of_the_runs(runs):
    figure = figure_deflection([runs["flexible-ideal"], runs["flexible"], runs["case1"]])
    assert [axes.get_title("left").rpartition("$ ")[2] for axes in figure.axes] == [
        "reflector nod",
        "its amplitude density",
        "reflector bend",
        "its amplitude density",
    ]
    line = next(one for one in figure.axes[0].lines if one.get_label() == "flexible")
    expected = runs["flexible"].data["deflection"].sel(elastic_part="reflector_nod").values
    np.testing.assert_allclose(line.get_ydata(), 1e3 * expected, rtol=1e-12)  # in mrad
    assert "without flexible links: case1" in " ".join(figure.get_supxlabel().split())


def test_of_many_parts_those_that_deflect_most_are_drawn(runs):
    figure = figure_deflection([runs["petals"]])
    peaks = runs["petals"].data["peak_deflection"]
    largest = {
        str(name).replace("_", " ") for name in peaks["elastic_part"].values[np.argsort(-peaks.values)[:4]]
    }
    titles = {axes.get_title("left").rpartition("$ ")[2] for axes in figure.axes}
    assert titles == largest | {"its amplitude density"}
    assert "4 of 8 elastic parts" in " ".join(figure.get_supxlabel().split())


def test_a_rigid_run_has_no_deflection(runs):
    with pytest.raises(AntennaPinError, match="at least one run with flexible links"):
        figure_deflection([runs["case1"]])
