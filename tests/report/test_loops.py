"""What a report says of closed loops and prescribed motions."""

import numpy as np
import pytest
from driven_four_bar import write_driven_four_bar

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import drive_loads
from antenna_pin.show.report import report


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    path = write_driven_four_bar(tmp_path_factory.mktemp("driven"))
    return {case: simulate(load_scenario(path, case=case)) for case in ("play", "ideal", "held")}


@pytest.fixture(scope="module")
def page(runs, shown):
    return shown(report(list(runs.values()), figures=False, recordings=False).html)


def test_counts_residuals_and_corrections(runs, page):
    rows = page.rows("loops")
    for row, key in (
        ("counts: equations of closures", "closure_equations"),
        ("counts: independent equations of closures", "closure_rank"),
        ("counts: freedoms that closures and motions leave", "freedoms_left"),
        ("residuals: largest position residual of closures and motions", "position_residual"),
        ("residuals: largest rate residual of closures and motions", "rate_residual"),
        ("corrections after each step: energy that corrections put in", "projection_energy"),
    ):
        numbers = [number for _, number, _ in rows[row]]
        assert numbers == [run.constraints[key] for run in runs.values()]
    said = page.said("loops")["counted at the start"]
    assert (
        "play 5 equations of closures, 5 independent; 1 motion; mobility 3, of which the motion leaves 2"
        in said
    )
    assert "ideal 5 equations of closures, 2 independent (3 redundant, rocker_pin: " in said


def test_loads_of_closures_and_what_the_motion_takes(runs, page):
    largest = [
        np.linalg.norm(run.data["closure_force"].sel(closure="rocker_pin"), axis=1).max()
        for run in runs.values()
    ]
    assert page.numbers("closures", "rocker_pin, revolute: coupler - rocker: peak force") == largest
    held = page.numbers("closures", "crank_pin, revolute: crank - coupler: peak force")
    assert held[:2] == [None, None] and held[2] > 0.0
    works = [drive_loads(run)["work"].item() for run in runs.values()]
    assert page.numbers("drives", "drive crank, motion of drive_pin: work") == works
    assert page.rows("drives")["drive crank, motion of drive_pin: peak torque"][0][2] == "N m"


def test_words_of_joints_closures_and_motions(page):
    joint = page.said("what-joints")["crank_pin"]
    for words in (
        "turns about the axis (0, −1, 0); without play, held by constraint",
        "turns without end about the axis (0, −1, 0); without play",
        "held by contact alone",
    ):
        assert words in joint
    closure = page.said("what-closures")["rocker_pin"]
    assert closure.startswith("revolute, 5 equations: coupler at (0.3 m, 0 m, 0 m), axis (0, −1, 0); rocker")
    assert page.said("what-drives-and-springs")["drive crank"] == "motion 12 rad/s · t, at drive_pin"


def test_figures_of_loops_are_in_the_report(runs, shown):
    page = shown(report([runs["ideal"]], recordings=False).html)
    assert "Forces of the closures" in page.text("//section[@id='loops']//figure[@class='picture']")
    assert "What the drives exert" in page.text("//section[@id='drives']//figure[@class='picture']")


def test_a_tree_has_no_section_of_loops(fixed, shown):
    page = shown(report([fixed], figures=False, recordings=False).html)
    assert not page.tree.xpath("//section[@id='loops']")
