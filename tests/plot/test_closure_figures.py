"""Figures of closed loops: what they show equals what the run holds, and all of it can be read."""

import numpy as np
import pytest
from driven_four_bar import write_driven_four_bar

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import drive_power
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot import CATALOGUE, allowed_figures, figure_closure_forces, figure_drive_efforts


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
