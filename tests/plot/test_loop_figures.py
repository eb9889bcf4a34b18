"""Figures of runs with closed loops: all that they allow can be read, and show what the runs hold."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import body_motion, mechanism_of, moved_body
from antenna_pin.show.plot import CATALOGUE, allowed_figures, figure_body
from antenna_pin.show.plot._kinds import LOOPED

from .conftest import note_of, title_of

LOOPS = [name for name, figure in CATALOGUE.items() if figure.of is LOOPED]


def runs_of(model, joint, duration, *cases):
    made = []
    for case in cases:
        overrides = [f"clearance.{joint}.geometry=closed-form"]
        scenario = load_scenario(model, case=case, overrides=overrides)
        run = simulate(scenario, duration=duration)
        made.append((case, run.data.assign_attrs(scenario=run.scenario.model_dump_json())))
    return made


@pytest.fixture(scope="module")
def platform_runs():
    return runs_of("chen2021", "s2", 0.15, "ideal", "friction-010")


@pytest.fixture(scope="module")
def slider_runs():
    return runs_of("slider_crank", "pin", 6e-3, "ideal", "planar", "3d")


@pytest.mark.parametrize(("which", "width"), [("platform_runs", "page"), ("slider_runs", "column")])
def test_figures_of_loops_can_be_read(request, readable, which, width):
    """Theirs, and those of all runs that name closures too."""
    runs = request.getfixturevalue(which)
    allowed = {each.figure.name: each for each in allowed_figures(runs)}
    for name in (*LOOPS, "joint_load", "contact_forces", "energy"):
        readable(allowed[name].draw(runs, width=width))


def test_figures_of_loops_are_of_the_joint_with_play(platform_runs, slider_runs):
    """The ideal run alone is about the joint that has clearance in other cases."""
    for runs, joint, body in ((platform_runs, "s2", "platform"), (slider_runs, "pin", "slider")):
        for some in (runs, runs[:1]):
            drawn = {each.figure.name: each.joint for each in allowed_figures(some)}
            assert {drawn[name] for name in LOOPS} == {joint}
        assert moved_body(runs[0][1], joint) == body
        assert mechanism_of(runs[0][1]).joint(joint).kind in ("floating", "continuous")


def test_a_slider_is_drawn_along_its_guide_only(slider_runs):
    figure = figure_body(slider_runs)
    assert [title_of(axes) for axes in figure.axes] == [
        "slider position, x",
        "deviation along x from the ideal run",
    ]
    left = [f"slider position, {k}, deviation along {k} from the ideal run" for k in "yz"]
    assert f"zero to round-off: {', '.join(left)}" in note_of(figure)
    line = next(line for line in figure.axes[0].lines if line.get_label() == "planar")
    expected = body_motion(slider_runs[1][1], "slider")["position"].values[:, 0]
    np.testing.assert_allclose(line.get_ydata(), expected, rtol=1e-12)
