"""Figures of what closures, couplings, motions and forces on links exert: they show what the runs hold."""

from pathlib import Path

import numpy as np
import pytest
from coupled_fingers import write_coupled_fingers
from driven_four_bar import write_driven_four_bar

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import drive_power
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot import (
    CATALOGUE,
    allowed_figures,
    figure_applied_forces,
    figure_closure_forces,
    figure_coupling_torques,
    figure_drive_efforts,
)

PANEL = Path(__file__).parents[2] / "scripts" / "examples" / "panel" / "scenario.toml"


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """A driven four-bar without play, with play in a pin, and with that pin held by constraint."""
    path = write_driven_four_bar(tmp_path_factory.mktemp("driven"))
    return [(case, simulate(load_scenario(path, case=case))) for case in ("play", "ideal", "held")]


def panels_of(figure):
    """Panels by their titles, each with its lines by their labels."""
    return {
        axes.get_title("left").rpartition("$ ")[2]: {line.get_label(): line for line in axes.lines}
        for axes in figure.axes
    }


def factor_of(figure, title):
    """What SI values were multiplied with in a panel, from the prefix that its axis names."""
    (axes,) = (axes for axes in figure.axes if axes.get_title("left").endswith(title))
    unit = axes.get_ylabel().partition("[")[2].partition("]")[0]
    return {"m": 1e3, "k": 1e-3, "µ": 1e6}.get(unit[0], 1.0) if unit not in ("N", "N m", "W") else 1.0


def test_lines_are_the_sizes_of_forces_and_moments(runs):
    figure = figure_closure_forces(runs)
    panels = panels_of(figure)
    pins = ("rocker_pin", "crank_pin")
    assert set(panels) == {f"{name} (revolute), {what}" for name in pins for what in ("force", "moment")}
    for label, run in runs:
        for what in ("force", "moment"):
            title = f"rocker_pin (revolute), {what}"
            line = next(line for name, line in panels[title].items() if name.startswith(label))
            size = np.linalg.norm(run.data[f"closure_{what}"].sel(closure="rocker_pin").values, axis=1)
            np.testing.assert_allclose(line.get_ydata(), factor_of(figure, title) * size, rtol=1e-14)
    held = [name for name in panels["crank_pin (revolute), force"] if not name.startswith("_")]
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
        for title, values in (
            ("motion crank, torque", run.data["drive_torque"].sel(drive="crank").values),
            ("motion crank, power", drive_power(run, "crank")),
        ):
            line = next(line for name, line in panels[title].items() if name.startswith(label))
            np.testing.assert_allclose(line.get_ydata(), factor_of(figure, title) * values, rtol=1e-14)


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
    panels = {axes.get_title("left").rpartition("$ ")[2]: axes for axes in figure.axes}
    assert set(panels) == {"finger, torque on finger", "rack, force on rack"}
    for name, title in (("finger", "finger, torque on finger"), ("rack", "rack, force on rack")):
        (line,) = (line for line in panels[title].lines if len(line.get_ydata()) > 2)
        unit = panels[title].get_ylabel().partition("[")[2].partition("]")[0]
        factor = {"m": 1e3}.get(unit[0], 1.0)
        values = fingers.data.coupling_torque.sel(coupling=name).values
        np.testing.assert_allclose(line.get_ydata(), factor * values, rtol=1e-14)
    readable(figure)


def test_a_run_without_couplings_has_no_such_figure(tmp_path):
    path = write_coupled_fingers(tmp_path / "fingers")
    text = path.read_text() + "[mechanism.joints.finger]\nmimic = false\n"
    path.write_text(text.replace('[couplings.rack]\nleader = "thumb"\nmultiplier = "10 mm/rad"\n', ""))
    with pytest.raises(InvalidParameterError, match="at least one run with a coupling of joints"):
        figure_coupling_torques([simulate(load_scenario(path))])


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
