"""The numbers of a figure are those that were drawn, in the units of its axes, each once."""

import numpy as np
import pytest
from matplotlib.figure import Figure

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import UnknownNameError
from antenna_pin.show.plot import drawn_numbers, figure_glance, figure_motion, figure_orbit


@pytest.fixture(scope="module")
def runs(real_runs):
    return [(case, real_runs[case]) for case in ("case1", "case3")]


def test_lines_are_those_of_the_runs(runs):
    drawn = drawn_numbers(figure_motion(runs, "rate", joint="elevation"))
    whole = [one for one in drawn if one.panel == "(a) whole span"]
    named = dict(runs)
    assert len(whole) == len(named)
    for one in whole:
        data = named[one.label.removesuffix(" (ideal)")]
        assert one.names[0] == "time [s]" and one.names[1].startswith("elevation rate [")
        factor = {"rad/s": 1.0, "mrad/s": 1e3}[one.names[1].partition("[")[2].rstrip("]")]
        assert np.array_equal(one.columns[0], data["time"].values)
        assert np.array_equal(one.columns[1], factor * data["motion_rate"].sel(joint="elevation").values)


def test_a_close_view_is_no_line_of_its_own(runs):
    drawn = drawn_numbers(figure_motion(runs, "angle", joint="elevation"))
    panels = {one.panel for one in drawn}
    assert any("deviation" in panel for panel in panels)
    assert not any("close view" in panel for panel in panels)


def test_a_line_in_pieces_is_one_and_a_colour_bar_none(runs):
    """The path of the journal has the colour of its time, piece by piece."""
    drawn = drawn_numbers(figure_orbit(runs[-1:], joint="elevation"))
    assert [one.panel.partition(", ")[2] for one in drawn] == ["end +", "end \N{MINUS SIGN}"]
    for one in drawn:
        assert one.columns[0].size == one.columns[1].size > 100


def test_points_bars_fields_and_rules():
    """Rules across a panel, as of zero, are no data; of a field the middles of its cells are."""
    figure = Figure()
    axes = figure.subplots()
    axes.set_title("panel", loc="left")
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [N]")
    axes.axhline(0.0)
    axes.scatter([1.0, 2.0], [3.0, 4.0], label="points")
    axes.bar([1.0, 2.0], [5.0, 6.0], width=0.5, label="bars")
    axes.vlines([1.0, 3.0], 0.0, [7.0, 8.0], label="stems")
    axes.broken_barh([(0.0, 1.0), (2.0, 0.5)], (9.0, 1.0), label="spans")
    axes.pcolormesh([0.0, 1.0, 2.0], [0.0, 2.0], [[10.0, 11.0]])
    found = {one.label: one for one in drawn_numbers(figure)}
    assert set(found) == {"points", "bars", "stems", "spans", ""}
    for label, columns in (
        ("points", ([1.0, 2.0], [3.0, 4.0])),
        ("bars", ([1.0, 2.0], [5.0, 6.0])),
        ("stems", ([1.0, 3.0], [7.0, 8.0])),
        ("spans", ([0.0, 2.0], [1.0, 2.5], [9.0, 9.0], [10.0, 10.0])),
        ("", ([0.5, 1.5], [1.0, 1.0], [10.0, 11.0])),
    ):
        assert [column.tolist() for column in found[label].columns] == [*map(list, columns)]
        assert found[label].names[0].startswith("x [m]") and found[label].panel == "panel"


def test_a_glance_has_position_and_peaks(runs):
    figure = figure_glance(runs, joint="elevation")
    angle, force = figure.axes
    peaks = runs[-1][1]["peak_force"].values
    stems = [one for one in drawn_numbers(figure) if one.panel == force.get_title(loc="left")]
    assert angle.get_ylabel() == "angle [rad]"
    unit = force.get_ylabel().partition("[")[2].rstrip("]")
    factor = {"N": 1.0, "kN": 1e-3}[unit]
    assert max(one.columns[1].max() for one in stems) == pytest.approx(
        factor * peaks.max(), rel=1e-12, abs=0.0
    )


def test_a_glance_of_a_ball_has_its_peaks_alone():
    """It turns about no axis, so there is no angle to draw."""
    run = simulate(load_scenario("spherical_pendulum", case="swing"), duration=0.1)
    joint = max(run.summary()["blows"], key=lambda name: run.summary()["blows"][name]["blows"]).rpartition(
        "."
    )[0]
    (force,) = figure_glance([("swing", run)], joint=joint).axes
    contacts = [k for k, name in enumerate(run.data["contact"].values) if str(name).startswith(f"{joint}.")]
    peaks = run.data["peak_force"].values[np.isin(run.data["episode_contact"].values, contacts)]
    (lines,) = force.collections
    assert len(lines.get_segments()) == len(peaks) > 0
    factor = {"N": 1.0, "kN": 1e-3}[force.get_ylabel().partition("[")[2].rstrip("]")]
    assert max(one[1, 1] for one in lines.get_segments()) == pytest.approx(
        factor * peaks.max(), rel=1e-12, abs=0.0
    )


def test_a_glance_of_what_is_not_there_is_refused():
    run = simulate(load_scenario("spherical_pendulum", case="swing"), duration=1e-4)
    with pytest.raises(UnknownNameError, match="elbow"):
        figure_glance([("swing", run)], joint="elbow")
