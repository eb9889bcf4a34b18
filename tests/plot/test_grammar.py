"""Grammar of figures: what is smooth beside spikes, and how sheets are laid out, scaled and labelled."""

import numpy as np
import pytest

from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.plot import _style
from antenna_pin.show.plot._compared import panels_sheet
from antenna_pin.show.plot._style import LINEAR_BETWEEN, footnote
from antenna_pin.show.plot._thinned import between_spikes
from antenna_pin.show.plot.grammar import (
    Axis,
    Ground,
    Panel,
    PlotCurve,
    Points,
    Rule,
    Sheet,
    figure,
    in_blocks,
    in_rows,
    render,
)


def with_impacts(amplitude, spike):
    """A sine of 3 Hz over 5 s, sampled at 1 kHz, and every 50 ms an impact of 0.2 ms, sampled three times."""
    onset = np.arange(0.02, 5.0, 0.05)
    time = np.unique(np.concatenate([np.linspace(0.0, 5.0, 5001), onset, onset + 1e-4, onset + 2e-4]))
    value = amplitude * np.sin(6.0 * np.pi * time)
    value[np.isin(time, onset + 1e-4)] += spike
    return time, value


def test_a_sine_under_impacts_counts_whole():
    time, value = with_impacts(0.3, 2000.0)
    # A scale is linear to 1.2 times the size at least: the crest is on its linear part.
    assert 0.3 / 1.2 < between_spikes(time, value) <= 0.3
    assert between_spikes(time[:1], value[:1]) == abs(value[0])
    assert between_spikes(time, np.full(time.size, np.nan)) == 0.0


def test_a_scale_is_linear_as_far_as_every_run_is_smooth():
    """The ideal run does not move that way at all: what the play does is a sine, and looks like one."""
    time, value = with_impacts(0.3, 2000.0)
    still = PlotCurve("ideal", time, 1e-6 * value, {}, smooth=True)
    assert 0.3 / 1.2 < Panel("", [PlotCurve("play", time, value), still]).core <= 0.3


def test_what_dotted_lines_mean_stands_once_below_the_panels():
    """Beside the axes it would take the room of the label; limits stand as ticks at the lines."""
    time, value = with_impacts(0.3, 2000.0)
    y = Axis("acceleration", "m/s^2")
    panels = [Panel(name, [PlotCurve(name, time, value)], y) for name in ("x", "y")]
    figure = render(panels_sheet(panels, "page", 2, spikes=True))
    assert figure.get_supxlabel() == LINEAR_BETWEEN
    assert all("\n" not in axes.get_ylabel() for axes in figure.axes)
    footnote(figure, "world axes")
    assert figure.get_supxlabel() == f"{LINEAR_BETWEEN}; world axes"
    assert not render(panels_sheet(panels, "page", 2)).get_supxlabel()


# --- sheets ---

TIME = np.linspace(0.0, 1.0, 5)


def panel(title="p", size=1.0, **axis):
    return Panel(title, [PlotCurve(title, TIME, size * TIME)], Axis("force", "N", **axis))


def test_numbers_of_all_marks_are_scaled_by_the_prefix_of_the_largest_curve():
    marks = [
        PlotCurve("line", TIME, 2e-3 * TIME),
        Points(np.array([[0.5, 1e-3]])),
        Rule(3e-3),
        Ground(0.0, 1e-3, along="y"),
    ]
    (axes,) = render(Sheet([[Panel("", marks, Axis("force", "N"))]], "page", 60.0)).axes
    assert axes.get_ylabel() == "force [mN]" and axes.get_xlabel() == "time [s]"
    line, rule = axes.lines
    assert np.array_equal(line.get_ydata(), 1e3 * (2e-3 * TIME)) and rule.get_ydata()[0] == 3.0
    assert axes.collections[0].get_offsets()[0].tolist() == [0.5, 1.0]
    assert axes.patches[0].get_height() == 1.0


def test_a_panel_alone_in_its_row_takes_all_of_it_and_others_keep_their_places():
    figure = render(Sheet(in_rows([panel(name) for name in "abc"], 2), "page", 90.0))
    spans = [axes.get_subplotspec().colspan for axes in figure.axes]
    assert [list(one) for one in spans] == [[0], [1], [0, 1]]
    alike = render(Sheet(in_rows([panel(name) for name in "abc"], 2, alone=False), "page", 90.0))
    assert list(alike.axes[-1].get_subplotspec().colspan) == [0]
    assert [axes.get_title("left") for axes in alike.axes] == [rf"$\bf{{({x})}}$ {x}" for x in "abc"]
    (one,) = render(Sheet([[panel("alone")]], "page", 60.0)).axes
    assert one.get_title("left") == "alone"


def test_of_shared_axes_the_first_of_a_row_and_the_lowest_of_a_column_are_labelled():
    kinds = [
        [panel("a", shared="y"), panel("b", 2.0, shared="y")],
        [None, panel("c", shared="z")],
        [panel("d"), panel("e")],
    ]
    figure = render(Sheet(in_blocks(kinds, "page"), "page", 120.0))
    a, b, c, d, e = figure.axes
    assert a.get_ylim() == b.get_ylim() and not b.get_ylabel() and c.get_ylabel()
    assert [bool(axes.get_xlabel()) for axes in (a, b, c, d, e)] == [True, False, False, True, True]
    assert [len(row) for row in in_blocks([[panel("x")] * 5], "page")] == [3, 3]
    assert [len(row) for row in in_blocks([[panel("x")] * 2], "column")] == [1, 1]


def test_a_function_of_a_figure_says_what_its_arguments_are_and_checks_them():
    @figure(size="Of the line.")
    def figure_line(size: float = 1.0, *, width: str = "page") -> Sheet:
        """Return a line.

        Raises:
            ValueError: Never.
        """
        return Sheet([[panel(size=size)]], width, 60.0)

    assert figure_line.__doc__ == (
        "Return a line.\n\nArgs:\n    size: Of the line.\n"
        '    width: "column" (88 mm) or "page" (180 mm).\n\nRaises:\n    ValueError: Never.'
    )
    assert len(figure_line(2.0).axes) == 1
    with pytest.raises(InvalidParameterError, match="size"):
        figure_line("long")


def test_a_title_is_above_the_factor_of_an_axis():
    """Saved as drawn: titles are fixed on their panels only where nothing stands above these."""
    figure = _style.new_figure("column", 40.0)
    plain, large = figure.subplots(1, 2)
    for axes, size in ((plain, 1.0), (large, 1e9)):
        axes.plot([0.0, 1.0], [0.0, size])
        axes.set_title("title", loc="left")
    assert (_style._has_text_above(plain), _style._has_text_above(large)) == (False, True)
