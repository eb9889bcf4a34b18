"""Figures of contact laws: what they show, and that they can always be read."""

import itertools

import matplotlib
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from antenna_pin.analysis.law_studies import LIU_2013, elastic_laws_of_joint, restitution_table
from antenna_pin.contact import MATERIALS, LiuPinJoint
from antenna_pin.errors import AntennaPinError, UnknownNameError
from antenna_pin.show.plot import (
    figure_contact_width,
    figure_experiment,
    figure_force_curves,
    figure_restitution,
    save_contact_figures,
)

LAWS = elastic_laws_of_joint(
    bearing_radius=0.01,
    journal_radius=0.0098,
    length=0.05,
    bearing=MATERIALS["steel"],
    journal=MATERIALS["steel"],
)
JOINT = LiuPinJoint(length=1e-3, journal_radius=5e-3, bearing_radius=5.067e-3, modulus=1.13e11)
LOADS = {f"law number {k}": lambda play, depth, k=k: (1.0 + 0.1 * k) * 7e7 * depth for k in range(7)}
FIGURES = {
    "curves": lambda width: figure_force_curves(LAWS, depths=(1e-7, 1e-6, 2e-5), width=width),
    "curves that end": lambda width: figure_force_curves(LAWS, depths=(1e-6, 1e-2), width=width),
    "one curve": lambda width: figure_force_curves({"johnson": LAWS["johnson"]}, depths=(1e-6,), width=width),
    "restitution": lambda width: figure_restitution(restitution_table(simulate=False), width=width),
    "experiment": lambda width: figure_experiment(LOADS, width=width),
    "width": lambda width: figure_contact_width(JOINT, width=width),
}


def line(axes, label):
    return next(entry for entry in axes.lines if entry.get_label() == label)


@pytest.mark.parametrize("width", ["column", pytest.param("page", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", FIGURES)
def test_no_two_labels_overlap_and_none_is_cut_off(name, width):
    figure = FIGURES[name](width)
    assert figure.get_figwidth() * 25.4 == pytest.approx({"column": 88.0, "page": 180.0}[width])
    FigureCanvasAgg(figure).draw()
    renderer = figure.canvas.get_renderer()
    texts = [] if figure._suptitle is None else [figure._suptitle]
    legends = list(figure.legends)
    for axes in figure.axes:
        texts += [axes._left_title, axes.xaxis.label, axes.yaxis.label, *axes.texts]
        legends += [axes.get_legend()] if axes.get_legend() else []
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            ticks = [tick for tick in axis.get_major_ticks() if low <= tick.get_loc() <= high]
            texts += [tick.label1 for tick in ticks if tick.label1.get_visible()]
    for legend in legends:
        texts += legend.get_texts()
    # Text alone: an annotation's own extent holds its line to the curve.
    extents = [
        (text.get_text(), matplotlib.text.Text.get_window_extent(text, renderer))
        for text in texts
        if text.get_text()
    ]
    page = figure.bbox.padded(1.0)
    for text, box in extents:
        assert page.x0 <= box.x0 and box.x1 <= page.x1 and page.y0 <= box.y0 and box.y1 <= page.y1, text
    for (one, a), (other, b) in itertools.combinations(extents, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        along = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert across <= 0.5 or along <= 0.5, f"{one!r} overlaps {other!r}"


def test_curves_are_the_forces_and_equal_laws_share_one():
    axes = figure_force_curves(LAWS, depths=(1e-7, 2e-5)).axes[0]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    assert {name for text in axes.texts for name in text.get_text().split(",\n")} == set(LAWS)
    curve = line(axes, "goldsmith,\ndubowsky-freudenstein")
    for depth, force in zip(curve.get_xdata()[::50], curve.get_ydata()[::50], strict=True):
        # Depths come back from micrometres: round-off.
        assert force == pytest.approx(LAWS["goldsmith"].elastic_force(1e-6 * depth), rel=1e-12)


def test_a_curve_ends_with_its_law():
    axes = figure_force_curves({"hertz-line": LAWS["hertz-line"]}, depths=(1e-6, 1e-4)).axes[0]
    ended = line(axes, "hertz-line")
    assert 1e-6 * ended.get_xdata()[-1] <= LAWS["hertz-line"].depth_limit
    assert (ended.get_marker(), ended.get_markevery()) == ("o", [-1])
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["hertz-line"]


def test_restitution_is_parted_by_how_far_it_is_off():
    rows = restitution_table(["exact-restitution", "hunt-crossley"], (0.2, 0.6, 1.0))
    far, near = figure_restitution(rows).axes
    assert np.allclose(line(far, "hunt-crossley").get_ydata()[-1], 1.0)
    assert np.allclose(line(near, "exact-restitution").get_ydata(), 0.0, atol=1e-12)
    assert "circles" in figure_restitution(rows).get_suptitle()
    closed = restitution_table(["exact-restitution"], (0.2, 1.0), simulate=False)
    assert figure_restitution(closed).get_suptitle() == ""
    assert len(figure_restitution(closed).axes) == 1


def test_every_measured_point_stands_in_the_panel_of_its_play():
    figure = figure_experiment(LOADS)
    shown = [tuple(p) for axes in figure.axes for p in line(axes, "measured").get_xydata()]
    assert np.allclose(shown, [(1e6 * point.depth, 1e-3 * point.load) for point in LIU_2013])


def test_nothing_to_draw_is_refused():
    with pytest.raises(AntennaPinError, match="at least one law"):
        figure_force_curves({})
    with pytest.raises(AntennaPinError, match="positive"):
        figure_force_curves(LAWS, depths=(0.0, 1e-6))
    with pytest.raises(AntennaPinError, match="at least one row"):
        figure_restitution([])


def test_settings_are_left_alone_and_files_are_named(tmp_path):
    before = dict(matplotlib.rcParams)
    figure = figure_contact_width(JOINT)
    assert dict(matplotlib.rcParams) == before
    assert save_contact_figures({"a": figure}, tmp_path / "new", ["svg"]) == [tmp_path / "new" / "a.svg"]
    with pytest.raises(UnknownNameError, match="png"):
        save_contact_figures({"a": figure}, tmp_path, ["gif"])
