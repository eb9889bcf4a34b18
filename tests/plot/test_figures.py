"""Figures: what they show of a run, and that they can always be read."""

import dataclasses
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from antenna_pin.base.readable import printed_unit
from antenna_pin.errors import AntennaPinError, FileFormatError, OutputError, UnknownNameError
from antenna_pin.show.plot import (
    CATALOGUE,
    QUANTITIES,
    figure_contact_forces,
    figure_energy,
    figure_momentum,
    figure_motion,
    save_figure,
    save_figures,
)
from antenna_pin.show.plot._style import prefixed


@pytest.fixture(scope="module")
def runs(made_run):
    """Ideal, planar clearance, full clearance (ends early), and one that ended at once."""
    return [
        ("case1", made_run("case1", contact=None)),
        ("case2-planar", made_run("case2-planar", contact="planar", seed=3)),
        ("case3", made_run("case3", seed=5, duration=3.2, strength=12.0)),
    ]


@pytest.fixture(scope="module")
def stillborn(made_run):
    return ("stillborn", made_run("stillborn", duration=0.0))


def line(axes, label):
    return next(entry for entry in axes.lines if entry.get_label() == label)


def titled(figure, words):
    return next(axes for axes in figure.axes if axes.get_title("left").endswith(words))


# --- motion ---


@pytest.mark.parametrize("quantity", QUANTITIES)
@pytest.mark.parametrize("width", ["column", "page"])
def test_motion_is_as_wide_as_printed_and_names_its_unit(runs, quantity, width):
    figure = figure_motion(runs, quantity, width=width)
    assert figure.get_figwidth() * 25.4 == pytest.approx({"column": 88.0, "page": 180.0}[width])
    texts = [axes.get_ylabel() for axes in figure.axes] + [figure.get_supylabel()]
    unit = {"angle": "[rad]", "rate": "[rad/s]", "acceleration": "[rad/s²]"}[quantity]
    assert any(f"elevation {quantity}" in text and unit in text for text in texts)


def test_ideal_run_lies_on_top_in_black(runs):
    for axes in figure_motion(runs, "acceleration").axes:
        ideal = line(axes, "case1 (ideal)")
        others = [entry for entry in axes.lines if entry.get_label() in ("case2-planar", "case3")]
        assert ideal.get_color() == "black"
        assert all(ideal.get_zorder() > other.get_zorder() for other in others)


def test_close_view_holds_the_largest_deviation(runs):
    """Where that is less than a twentieth of the height; a larger one is seen without it."""
    ideal, run = runs[0], runs[2]
    # Both made-up runs have a sample at every millisecond; there they are compared directly.
    one, other = (data["motion_rate"].sel(joint="elevation") for _, data in (ideal, run))
    smooth = np.interp(other["time"], one["time"], one)
    apart = other - smooth
    at = float(apart["time"][int(np.argmax(np.abs(apart.values)))])
    small = run[1].copy()
    rates = small["motion_rate"].values.copy()
    rates[:, 1] = smooth + 0.03 * np.ptp(smooth) * apart / np.abs(apart).max()
    small["motion_rate"] = small["motion_rate"].dims, rates
    whole, near, deviation = figure_motion([ideal, ("case3", small)], "rate").axes
    start, end = near.get_xlim()
    assert start - 1e-3 <= at <= end + 1e-3
    assert end - start <= 0.1 * 5.0 + 1e-9
    rates[:, 1] = smooth + 0.1 * np.ptp(smooth) * apart / np.abs(apart).max()
    small["motion_rate"] = small["motion_rate"].dims, rates
    titles = [axes.get_title("left") for axes in figure_motion([ideal, ("case3", small)], "rate").axes]
    assert len(titles) == 2 and "deviation" in titles[1]


def test_runs_that_coincide_are_less_the_first(runs):
    """Beside an ideal run 1 rad off: 0.1 mrad and 1 % of it are both within a line of their deviations."""
    ideal, run = runs[0], runs[1]
    names = ["second", "third"]
    others = [run[1].copy() for _ in names]
    for other, size in zip(others, (1e-4, 1e-6), strict=True):
        other["motion_angle"] = other["motion_angle"] + size * np.sin(other["time"])
    figure = figure_motion([ideal, ("first", run[1]), *zip(names, others, strict=True)], "angle")
    (apart,) = (axes for axes in figure.axes if axes.get_title("left").endswith("less that of first"))
    assert "[µrad]" in apart.get_ylabel()
    for name, size in zip(names, (100.0, 1.0), strict=True):
        drawn = line(apart, name)
        # A difference of two numbers of 10 rad is known to 2e-15 rad.
        np.testing.assert_allclose(drawn.get_ydata(), size * np.sin(drawn.get_xdata()), atol=1e-8)
    told = figure_motion([ideal, *runs[1:]], "angle")
    assert not any("less that of" in axes.get_title("left") for axes in told.axes)


def test_deviation_of_a_smooth_run_is_exact_between_the_samples_of_the_ideal_run(made_run):
    """The cubic through values and slopes errs by h^4/384 times the fourth derivative: 1e-13 here."""

    def smooth(times, offset, contact):
        data = made_run("smooth", contact=contact, duration=0.01)
        angle = np.stack([np.sin(times), np.sin(times) + offset], axis=1)
        rate = np.stack([np.cos(times), np.cos(times)], axis=1)
        names = ["azimuth", "elevation"]
        return xr.Dataset(
            {
                "motion_angle": (("time", "joint"), angle, {"units": "rad"}),
                "motion_rate": (("time", "joint"), rate, {"units": "rad/s"}),
            },
            coords={"time": times, "joint": names, "contact": data["contact"].values},
        )

    ideal = smooth(np.linspace(0.0, 1.0, 401), 0.0, None)
    other = smooth(np.linspace(0.0, 1.0, 777), 1e-6, "contact")
    figure = figure_motion([("ideal", ideal), ("other", other)], "angle", joint="elevation")
    apart = figure.axes[2]
    assert "[µrad]" in apart.get_ylabel()
    np.testing.assert_allclose(line(apart, "other").get_ydata(), 1.0, atol=1e-5)


def test_zoom_and_ideal_can_be_given(runs):
    figure = figure_motion(runs[1:], "angle", ideal=runs[0], zoom=(1.0, 1.5))
    assert figure.axes[1].get_xlim() == (1.0, 1.5)
    assert line(figure.axes[0], "case1 (ideal)")
    with pytest.raises(AntennaPinError, match="zoom must be a start before its end"):
        figure_motion(runs, "angle", zoom=(2.0, 1.0))


def test_without_an_ideal_run_there_is_no_deviation(runs):
    for quantity in QUANTITIES:
        figure = figure_motion(runs[1:], quantity)
        assert not any("deviation" in axes.get_ylabel() for axes in figure.axes)
    assert len(figure_motion(runs[2:], "angle").axes) == 1  # nothing to compare with: the whole span


def test_spikes_do_not_flatten_the_ideal_acceleration(runs):
    """The part of the scale up to the ideal curve's size keeps a good share of the height."""
    figure = figure_motion(runs, "acceleration")
    axes = figure.axes[0]
    assert axes.get_yscale() == "symlog"
    low, high = (
        axes.transAxes.inverted().transform(axes.transData.transform((0.0, y)))[1] for y in (-5.8, 5.8)
    )
    assert high - low > 0.2
    assert "linear between the dotted lines" in " ".join(figure.get_supxlabel().split())


def test_other_joints_can_be_drawn_and_unknown_ones_are_refused(runs):
    assert "azimuth angle" in figure_motion(runs, "angle", joint="azimuth").axes[0].get_ylabel()
    with pytest.raises(UnknownNameError, match="joint 'elevatoin' is unknown; did you mean elevation"):
        figure_motion(runs, "angle", joint="elevatoin")
    with pytest.raises(UnknownNameError, match="quantity"):
        figure_motion(runs, "jerk")
    with pytest.raises(UnknownNameError, match="width"):
        figure_motion(runs, "angle", width="poster")


def test_the_ideal_case_alone_draws_the_joint_that_has_clearance_in_other_cases(runs):
    assert "elevation angle" in figure_motion(runs[:1], "angle").axes[0].get_ylabel()


def test_repeated_labels_are_told_apart(runs):
    figure = figure_motion([runs[1], runs[1]], "angle")
    assert line(figure.axes[0], "case2-planar")
    assert line(figure.axes[0], "case2-planar (2)")


# --- short runs ---


def test_a_run_of_one_sample_is_named_below_the_panels(runs, stillborn):
    for figure in (figure_motion([*runs, stillborn], "rate"), figure_energy([*runs, stillborn])):
        assert figure.get_supxlabel().endswith("not drawn, one sample only: stillborn")


def test_nothing_but_single_samples_is_refused_with_the_reason(stillborn):
    stillborn[1].attrs["outcome"] = "STEP_TOO_SMALL"
    with pytest.raises(AntennaPinError, match=r"two samples or more.*stillborn \(STEP_TOO_SMALL\)"):
        figure_motion([stillborn], "angle")


def test_no_runs_at_all_are_refused():
    with pytest.raises(AntennaPinError, match="at least one run"):
        figure_motion([], "angle")


def test_a_foreign_dataset_is_refused_in_one_line():
    foreign = xr.Dataset({"x": ("time", [0.0, 1.0])}, coords={"time": [0.0, 1.0]})
    with pytest.raises(FileFormatError, match="antenna_pin result"):
        figure_motion([("foreign", foreign)], "angle")


# --- contact forces ---


def test_every_episode_has_its_peak_in_the_figure(runs):
    """Impacts last less than a sample; their peaks are drawn from the list of episodes."""
    figure = figure_contact_forces(runs)
    radial, axial = (titled(figure, f"case3, {kind}") for kind in ("radial", "axial"))
    data = runs[2][1]
    which = data["contact"].values[data["episode_contact"].values]
    for axes, kind in ((radial, "radial"), (axial, "axial")):
        dots = next(entry for entry in axes.lines if entry.get_marker() == ".")
        mine = np.array([f".{kind}" in name for name in which])
        np.testing.assert_array_equal(dots.get_xdata(), data["peak_time"].values[mine])
        units = "".join(one.get_ylabel() for one in figure.axes if kind in one.get_ylabel())
        factor = 1e-3 if "[kN]" in units else 1.0
        np.testing.assert_allclose(np.abs(dots.get_ydata()), factor * data["peak_force"].values[mine])
    signs = np.sign(next(entry for entry in axial.lines if entry.get_marker() == ".").get_ydata())
    ends = [1.0 if name.endswith("+") else -1.0 for name in which if ".axial" in name]
    np.testing.assert_array_equal(signs, ends)


def test_sampled_resultant_is_split_across_and_along_the_axis(runs):
    data = runs[2][1]
    figure = figure_contact_forces(runs[2:])
    force = data["joint_force"].sel(clearance_joint="elevation").values
    factors = [1e-3 if "[kN]" in axes.get_ylabel() else 1.0 for axes in figure.axes]
    radial, axial = (line(axes, "resultant on the journal").get_ydata() for axes in figure.axes[:2])
    np.testing.assert_allclose(radial, factors[0] * np.hypot(force[:, 0], force[:, 1]))
    np.testing.assert_allclose(axial, factors[1] * force[:, 2])


def test_planar_clearance_says_that_it_has_no_axial_contact(runs):
    figure = figure_contact_forces(runs)
    assert "case2-planar, axial (no such contact in this joint)" in figure.get_supxlabel()
    axial = [axes for axes in figure.axes if axes.get_title("left").endswith("axial")]
    assert [axes.get_title("left").rpartition("$ ")[2] for axes in axial] == ["case3, axial"]


def test_contact_forces_of_ideal_runs_or_unknown_joints_are_refused(runs):
    with pytest.raises(AntennaPinError, match="at least one run with contact"):
        figure_contact_forces(runs[:1])
    with pytest.raises(UnknownNameError, match="azimuth"):
        figure_contact_forces(runs, joint="azimuth")


# --- audits ---


def test_balance_error_is_relative_to_the_gross_work(runs):
    data = runs[2][1]
    error = figure_energy(runs[2:]).axes[2]
    gross = float(data["drive_gross_work"].isel(time=-1).sum())
    expected = np.maximum.accumulate(np.maximum(np.abs(data["energy_error"].values) / gross, 1e-18))
    np.testing.assert_allclose(error.lines[0].get_ydata(), expected)


def test_momentum_drift_is_relative_to_the_moving_parts(runs):
    data = runs[2][1]
    linear = figure_momentum(runs).axes[0]
    change = data["linear_momentum"] - data["linear_momentum"].isel(time=0)
    expected = np.linalg.norm(change, axis=1) / float(data["momentum_scale"].max())
    expected = np.maximum.accumulate(np.maximum(expected, 1e-18))
    np.testing.assert_allclose(line(linear, "case3").get_ydata(), expected)


def test_momentum_of_a_fixed_base_is_not_drawn(runs, made_run):
    fixed = ("bench", made_run("bench", free_base=False, duration=0.1))
    assert "bench" in figure_momentum([runs[0], fixed]).get_supxlabel()
    with pytest.raises(AntennaPinError, match="free base"):
        figure_momentum([fixed])


# --- all of them ---

#: Those that made-up runs, without a mechanism and without contact points, have; the others need real ones.
MADE_UP = ("motion_angle", "motion_rate", "motion_acceleration", "contact_forces", "energy", "momentum")


@pytest.mark.parametrize("width", ["column", pytest.param("page", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", MADE_UP)
def test_no_two_labels_overlap_and_none_is_cut_off(runs, stillborn, readable, name, width):
    figure = CATALOGUE[name].draw([*runs, stillborn], width=width)
    readable(figure)


def test_no_window_system_is_touched():
    """Neither pyplot nor a display: figures can be drawn on a bare server."""
    code = "import sys, antenna_pin.show.plot; sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


# --- files ---


def test_the_same_runs_give_the_same_files(runs, tmp_path):
    first, second = (
        save_figure(figure_energy(runs[:1]), tmp_path / name, ("pdf", "svg", "png")) for name in "ab"
    )
    for one, other in zip(first, second, strict=True):
        assert one.read_bytes() == other.read_bytes()
    assert first[2].read_bytes().startswith(b"\x89PNG") and "<svg" in first[1].read_text()


def test_runs_of_different_mechanisms_are_refused_in_one_line(runs, tmp_path):
    other = runs[2][1].assign_coords(joint=["yoke", "hinge"], clearance_joint=["hinge"])
    words = "plot: runs must be of one mechanism .*case3 with joints azimuth, .* and array with .*hinge"
    with pytest.raises(AntennaPinError, match=words):
        save_figures([runs[2], ("array", other)], tmp_path / "folder")
    assert not (tmp_path / "folder").exists()


def test_unknown_format_is_refused_before_any_work(runs, tmp_path):
    with pytest.raises(UnknownNameError, match="format 'pgn' is unknown; did you mean png"):
        save_figures(runs, tmp_path / "folder", ("pgn",))
    assert not (tmp_path / "folder").exists()


def test_a_folder_that_cannot_be_made_is_refused(runs, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot make this folder"):
        save_figures(runs, tmp_path / "file" / "folder")


def test_trajectories_are_taken_as_they_are(runs):
    @dataclasses.dataclass
    class Trajectory:
        data: xr.Dataset

    figure = figure_motion([Trajectory(data) for _, data in runs], "angle")
    assert line(figure.axes[0], "case3")


# --- units ---


@pytest.mark.parametrize(
    ("unit", "printed"),
    [
        ("rad/s**2", "rad/s²"),
        ("rad/s^2", "rad/s²"),
        ("N*m", "N m"),
        ("kg*m**2/s", "kg m²/s"),
        ("s**-1", "s⁻¹"),
    ],
)
def test_units_are_printed_as_in_a_paper(unit, printed):
    assert printed_unit(unit) == printed


@pytest.mark.parametrize(
    ("largest", "expected"),
    [(1500.0, (1.0, "N")), (2e4, (1e-3, "kN")), (0.25, (1.0, "N")), (0.05, (1e3, "mN")), (0.0, (1.0, "N"))],
)
def test_prefixes_keep_numbers_short(largest, expected):
    factor, unit = prefixed("N", largest)
    assert (factor, unit) == (pytest.approx(expected[0]), expected[1])
