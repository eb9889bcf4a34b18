"""Figures of what closures, couplings, motions and forces on links exert: they show what the runs hold."""

from pathlib import Path

import numpy as np
import pytest
from coupled_fingers import write_coupled_fingers
from driven_four_bar import write_driven_four_bar

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import drive_power
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot import (
    CATALOGUE,
    allowed_figures,
    figure_applied_forces,
    figure_closure_forces,
    figure_coupling_torques,
    figure_drive_efforts,
)

from .conftest import factor_of, lines_of, panels_of

PANEL = Path(__file__).parents[2] / "scripts" / "examples" / "panel" / "scenario.toml"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A driven four-bar without play, with play in a pin, and with that pin held by constraint."""
    path = write_driven_four_bar(tmp_path_factory.mktemp("driven"))
    return [(case, simulate(load_scenario(path, case=case))) for case in ("play", "ideal", "held")]


def check_line(axes, label, values, unit):
    """Assert that a panel has the values of a run."""
    line = next(line for name, line in lines_of(axes).items() if name.startswith(label))
    np.testing.assert_allclose(line.get_ydata(), factor_of(axes.get_ylabel(), unit) * values, rtol=1e-14)


def test_lines_are_the_sizes_of_forces_and_moments(runs):
    figure = figure_closure_forces(runs)
    panels = panels_of(figure)
    pins = ("rocker_pin", "crank_pin")
    assert set(panels) == {f"{name} (revolute), {what}" for name in pins for what in ("force", "moment")}
    for label, run in runs:
        for what in ("force", "moment"):
            title = f"rocker_pin (revolute), {what}"
            size = np.linalg.norm(run.data[f"closure_{what}"].sel(closure="rocker_pin").values, axis=1)
            check_line(panels[title], label, size, {"force": "N", "moment": "N m"}[what])
    held = [name for name in lines_of(panels["crank_pin (revolute), force"]) if not name.startswith("_")]
    assert held == ["held (ideal)"]
    assert figure.get_supxlabel() == "of redundant equations, the least loads that hold the loops"


def test_a_moment_that_nobody_needs_has_no_panel(runs):
    """In the plane loop without play nothing makes a moment across the pin."""
    (axes,) = figure_closure_forces(runs[1:2]).axes
    assert axes.get_title("left") == "rocker_pin (revolute), force"


def test_lines_of_a_motion_are_torque_and_power(runs):
    figure = figure_drive_efforts(runs)
    panels = panels_of(figure)
    assert set(panels) == {"motion crank, torque", "motion crank, power"}
    for label, run in runs:
        torque = run.data["drive_torque"].sel(drive="crank").values
        check_line(panels["motion crank, torque"], label, torque, "N m")
        check_line(panels["motion crank, power"], label, drive_power(run, "crank"), "W")


@pytest.mark.parametrize("width", ["column", "page"])
def test_all_figures_of_loops_can_be_read(runs, readable, width):
    allowed = list(allowed_figures(runs))
    names = [each.figure.name for each in allowed]
    assert {"closure_forces", "drive_efforts", "steady_force", "joint_load", "energy"} <= set(names)
    for each in allowed:
        if each.figure.name in ("closure_forces", "drive_efforts", "joint_load", "energy"):
            readable(each.draw(runs, width=width))


def test_runs_of_trees_are_refused_or_named(runs, made_run, readable):
    tree = ("tree", made_run())
    for name, words in (("closure_forces", "a closure of a loop"), ("drive_efforts", "a prescribed motion")):
        with pytest.raises(InvalidParameterError, match=f"at least one run with {words}"):
            CATALOGUE[name].draw([tree])
        figure = CATALOGUE[name].draw([*runs[:1], tree])
        assert ": tree" in " ".join(figure.get_supxlabel().split())
        readable(figure)
        assert name not in [each.figure.name for each in allowed_figures([tree])]


# --- couplings ---


@pytest.fixture(scope="module")
def fingers(tmp_path_factory):
    return simulate(load_scenario(write_coupled_fingers(tmp_path_factory.mktemp("fingers"))))


def test_lines_are_torques_and_forces_on_followers(fingers, readable):
    figure = figure_coupling_torques([fingers])
    panels = panels_of(figure)
    assert set(panels) == {"finger, torque on finger", "rack, force on rack"}
    for name, title, unit in (
        ("finger", "finger, torque on finger", "N m"),
        ("rack", "rack, force on rack", "N"),
    ):
        check_line(panels[title], "run", fingers.data.coupling_torque.sel(coupling=name).values, unit)
    readable(figure)


# --- forces on links ---


def test_forces_on_links_are_drawn_place_by_place(readable):
    """5 N across the panel, turning with it; no torque: no panel of it."""
    force = {"kind": "force", "at": {"link": "panel", "point": [0.1, 0.0, 0.0]}, "force": [0.0, 0.0, "5 N"]}
    scenario = load_scenario(PANEL, case="ideal", overrides={"forces.push": force, "duration": "20 ms"})
    run = simulate(scenario)
    assert "applied_forces" in {each.figure.name for each in allowed_figures([run])}
    figure = figure_applied_forces(run)
    readable(figure)
    (axes,) = figure.axes
    np.testing.assert_allclose(axes.lines[0].get_ydata(), 5.0, rtol=1e-12)
