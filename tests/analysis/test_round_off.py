"""What is zero to round-off by a run's own scales is told as that everywhere, and a small signal is not."""

import re

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import deviation_measures, is_round_off, round_off_scales
from antenna_pin.show.plot import (
    figure_base,
    figure_closure_forces,
    figure_contact_forces,
    figure_joints,
    figure_motion,
)
from antenna_pin.show.report import report
from antenna_pin.trajectory import Trajectory


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    """The antenna with its hinge as a joint of the tree and as a constraint; a crank with play, in space."""
    folder = tmp_path_factory.mktemp("runs")
    made = {
        "tree": simulate(load_scenario("bai2020", case="case1"), duration=0.2),
        "held": simulate(load_scenario("bai2020", case="case1-constraint"), duration=0.2),
        "crank": simulate(load_scenario("slider_crank", case="3d"), duration=0.003),
    }
    return {name: Trajectory.load(run.save(folder / f"{name}.nc")) for name, run in made.items()} | {
        "folder": folder
    }


def test_deviations_of_one_motion_computed_in_two_ways_are_zero(runs):
    scales = round_off_scales(runs["held"], runs["tree"])
    measures = deviation_measures(runs["held"], runs["tree"])
    assert len(measures) > 10
    for one in measures:
        assert 0.0 <= one.maximum < 1e-11
        assert one.maximum == 0.0 or is_round_off(one.maximum, one.units, scales), one.of
    # A millionth of the motion itself is none of round-off.
    for name, units in (("motion_angle", "rad"), ("motion_rate", "rad/s")):
        assert not is_round_off(1e-6 * float(np.abs(runs["tree"].data[name]).max()), units, scales)


def test_a_planar_motion_in_space_has_no_axial_force(runs):
    """Radial forces of 59 kN leave 1e-22 N along the axis, and moments of 1e-9 N m in the guide."""
    data, scales = runs["crank"].data, round_off_scales(runs["crank"])
    axial = float(np.abs(data["joint_force"].values[..., 2]).max())
    moment = float(np.linalg.norm(data["closure_moment"].values, axis=-1).max())
    force = float(np.abs(data["joint_force"].values[..., 0]).max())
    assert axial > 0.0 and is_round_off(axial, "N", scales)
    assert moment > 0.0 and is_round_off(moment, "N m", scales)
    assert not is_round_off(1e-6 * force, "N", scales)
    before = data.copy(deep=True)
    notes = [text.get_text() for text in figure_contact_forces(runs["crank"]).texts]
    assert any("zero to round-off" in note and "axial" in note for note in notes)
    assert any("zero to round-off" in t.get_text() for t in figure_closure_forces(runs["crank"]).texts)
    assert before.identical(data)


def test_figures_of_two_equal_motions_show_no_deviation(runs):
    pair = [("held", runs["held"].data), ("tree", runs["tree"].data)]
    for draw in (figure_joints, figure_base, figure_motion):
        figure = draw(pair, ideal=pair[1])
        titles = [axes.get_title("left") for axes in figure.axes]
        assert titles and not any("deviation" in title for title in titles)
        assert any(
            re.search("zero to round-off: .*deviation|deviation.*: zero to", text.get_text())
            for text in figure.texts
        )


def test_tables_and_reports_tell_zero(cli, runs):
    folder = runs["folder"]
    said = cli("analyse", folder / "held.nc", "--ideal", folder / "tree.nc").out
    assert "deviation that is zero to round-off: azimuth angle, azimuth rate" in said
    assert not re.search(r"e-1[3-9]", said.split("forces of closures")[0])
    info = cli("info", "--all", folder / "crank.nc").out
    row = next(line for line in info.splitlines() if line.startswith(" guide "))
    assert row.split()[-2:] == ["≈", "0"] and "≈ 0: zero to round-off" in info
    made = report([("held", runs["held"]), ("tree", runs["tree"])], recordings=False, figures=False)
    table = next(section for section in made.sections if section.key == "deviation").items[0]
    assert {row.cells[0].text for row in table.rows} == {"≈ 0"}
    assert {row.cells[-1].text for row in table.rows} == {"zero to round-off"}
    # What was kept, and how well, stands there whatever it is.
    kept = next(section for section in made.sections if section.key == "conservation").items[0].tables[0]
    assert "≈ 0" not in {cell.text for row in kept.rows for cell in row.cells}
