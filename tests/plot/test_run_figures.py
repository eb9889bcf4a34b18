"""Figures of real, short runs: what they show equals what the run holds, and all of it can be read."""

import json
import re

import numpy as np
import pytest
import xarray as xr
from matplotlib.collections import LineCollection
from scipy.spatial.transform import Rotation

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import (
    base_motion,
    between_samples,
    body_deviation,
    body_motion,
    body_poses,
    bore_load,
    clearance_shapes,
    deviation,
    joint_loads,
    journal_motion,
    pointing_error,
    scenario_shares,
    spectrum,
)
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot import (
    BASE_QUANTITIES,
    BODY_QUANTITIES,
    CATALOGUE,
    PAPERS,
    QUANTITIES,
    SIGNALS,
    against_ideal,
    allowed_figures,
    figure_base,
    figure_body,
    figure_bore_load,
    figure_contact_forces,
    figure_eccentricity,
    figure_joint_load,
    figure_joints,
    figure_orbit,
    figure_pointing,
    figure_scenarios,
    figure_spectra,
    figure_spectrogram,
    figure_steady_force,
    paper_figures,
    save_figures,
)
from antenna_pin.show.plot import journal as journal_figures
from antenna_pin.show.plot._compared import panels_sheet
from antenna_pin.show.plot._kinds import FREE_BASE, LOOPED, MOVING, PLAYLESS, POINTED, SLIDING, TOUCHING
from antenna_pin.show.plot.grammar import Axis, Panel, PlotCurve, render

from .conftest import factor_of, lines_of, note_of, title_of


@pytest.fixture(scope="module")
def runs(real_runs):
    """Ideal, planar clearance, full clearance."""
    return [(case, real_runs[case]) for case in ("case1", "case2-planar", "case3")]


@pytest.fixture(scope="module")
def rigs():
    """The impact pair with each kind of joint."""
    runs = []
    for case in ("planar", "contact", "flange", "spherical"):
        scenario = load_scenario("impact_pair", case=case, overrides=["duration=0.01"])
        run = simulate(scenario)
        runs.append((case, run.data.assign_attrs(scenario=scenario.model_dump_json())))
    return runs


# --- the journal in its bearing ---


def test_of_a_tangled_orbit_the_last_crossings_are_in_colour(real_runs, monkeypatch):
    """What was before is grey, and from when on the colours go stands below."""
    data = real_runs["case3"]
    whole = figure_orbit(("case3", data))
    assert "in colour" not in note_of(whole)
    monkeypatch.setattr(journal_figures, "_TANGLE", 0.5)
    monkeypatch.setattr(journal_figures, "_FOLLOWED", 0.2)
    figure = figure_orbit(("case3", data))
    begun = float(re.search(r"in colour: from (\S+) s on; grey: before", note_of(figure))[1])
    assert data["time"][0] < begun < data["time"][-1]
    line = next(one for one in figure.axes[0].collections if isinstance(one, LineCollection))
    middle = np.asarray(line.get_array())
    shades = line.to_rgba(middle)[:, :3]
    grey = np.ptp(shades, axis=1) < 1e-9
    assert 0 < grey.sum() < grey.size and np.array_equal(grey, middle < line.norm.vmin)


def test_orbit_stays_inside_the_clearance_circle_but_for_the_depth(real_runs):
    """Gap = C_r - e but for R_i tilt^2 / 2, 0.32 um at the largest tilt of 8 mrad."""
    data = real_runs["case3"]
    figure = figure_orbit(("case3", data))
    ends = [axes for axes in figure.axes if axes.patches]
    assert [axes.get_title("left").rpartition(" ")[2] for axes in ends] == ["+", "\N{MINUS SIGN}"]
    for axes, contact in zip(ends, ("elevation.radial+", "elevation.radial-"), strict=True):
        factor = factor_of(axes.get_xlabel(), "m")
        radius = np.hypot(*path_of(axes).T)
        clearance = np.hypot(*axes.patches[0].get_xy()[0]) / factor
        assert clearance == pytest.approx(2e-4, rel=1e-9, abs=0.0)
        depth = -data["gap"].sel(contact=contact).values
        radius = radius[sampled(data)]
        np.testing.assert_allclose(radius - clearance, depth, rtol=0.0, atol=0.33e-6)
        assert np.any(radius > clearance)


def path_of(axes):
    """Points of the orbit in a panel, (n, 2) [m]."""
    (orbit,) = (each for each in axes.collections if isinstance(each, LineCollection))
    pieces = orbit.get_segments()
    return np.array([*(piece[0] for piece in pieces), pieces[-1][1]]) / factor_of(axes.get_xlabel(), "m")


def sampled(data, joint="elevation"):
    """Where a curve between the samples of a run has the samples."""
    return np.isin(between_samples(data, joint)["time"].values, data["time"].values)


def test_runs_of_very_different_clearances_are_each_drawn_in_its_own(real_runs):
    """One of 0.2 mm beside one of 2 mm, made up: both circles have radius 1. Alike, both are in mm."""
    data = real_runs["case3"]
    about = json.loads(data.attrs["clearance_joints"])
    for radius, factor, label in ((0.0118, 5e3, "x / clearance [-]"), (0.01019, 1e3, "x [mm]")):
        about["elevation"]["dimensions"]["bearing_radius"] = radius
        other = data.assign_attrs(clearance_joints=json.dumps(about))
        panels = [axes for axes in figure_orbit([("a", data), ("b", other)]).axes if axes.patches]
        radii = [np.hypot(*axes.patches[0].get_xy()[0]) for axes in panels]
        alone = factor * (radius - 0.0098) if factor == 1e3 else 1.0
        assert radii == pytest.approx([factor * 2e-4] * 2 + [alone] * 2)
        assert {axes.get_xlabel() for axes in panels} == {label}
        (orbit,) = (each for each in panels[0].collections if isinstance(each, LineCollection))
        starts = np.array([piece[0] for piece in orbit.get_segments()])[sampled(data)[:-1]]
        expected = factor * journal_motion(data, "elevation")["offset"].values[:-1, 0, :2]
        assert starts == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.parametrize("gravity", [(0.0, 0.0, -9.81), (9.81, 0.0, 0.0), (0.0, -6.0, -8.0), (0.0, 0.0, 0.0)])
def test_orbit_and_bore_load_have_up_against_gravity(real_runs, gravity):
    """What is drawn is what was recorded, turned: the direction against gravity, worked out here, is up."""
    data = real_runs["case2-planar"]
    about = json.loads(data.attrs["mechanism"]) | {"gravity": gravity}
    data = data.assign_attrs(mechanism=json.dumps(about))
    bearing = clearance_shapes(data)["elevation"]
    turn = Rotation.from_quat(body_poses(data)["attitude"].sel(body=bearing["bearing_body"]).values).mean()
    turn *= Rotation.from_quat(bearing["bearing_placement"][3:])
    up = -turn.inv().apply(gravity)[:2]
    axes = figure_orbit(("planar", data)).axes[0]
    starts = path_of(axes)[:-1][sampled(data)[:-1]]
    offset = data["journal_position"].values[:-1, 0, :2]
    (polar,) = (each for each in figure_bore_load(("planar", data)).axes if each.name == "polar")
    if np.hypot(*up) < 0.1 * np.linalg.norm(gravity) + 1e-9:  # along the axis, or none: as it was
        assert starts == pytest.approx(offset, abs=1e-12) and polar.get_theta_offset() == 0.0
        return
    assert "up" in axes.get_ylabel() and "up" not in axes.get_xlabel()
    # The base moves by fractions of a milliradian in this time; up is its mean.
    assert starts[:, 1] == pytest.approx(offset @ up / np.hypot(*up), abs=2e-3 * np.abs(offset).max())
    assert np.hypot(*starts.T) == pytest.approx(np.hypot(*offset.T), abs=1e-12)
    surface = np.arctan2(up[1], up[0]) + polar.get_theta_offset()
    assert np.sin(surface) == pytest.approx(1.0, abs=1e-3)


def test_orbit_of_a_ball_has_three_projections(real_runs):
    labels = {
        (axes.get_xlabel()[0], axes.get_ylabel()[0])
        for axes in figure_orbit(("balls", real_runs["floating"])).axes
        if axes.patches
    }
    assert labels == {("x", "y"), ("x", "z"), ("y", "z")}


def test_the_whole_circle_is_in_view_before_the_journal_has_moved(real_runs):
    axes = figure_orbit(("case3", real_runs["case3"].isel(time=slice(0, 2)))).axes[0]
    assert axes.get_xlim()[1] > np.abs(axes.patches[0].get_xy()).max() > 0.5 * axes.get_xlim()[1]


def test_orbit_shaded_by_load_leaves_flight_grey(real_runs):
    data = real_runs["case2-planar"]
    axes = figure_orbit(("planar", data), shade="load").axes[0]
    (loaded,) = (each for each in axes.collections if isinstance(each, LineCollection))
    force = between_samples(data, "elevation")["normal_force"].values[:, 0]
    pressed = np.maximum(force[1:], force[:-1]) > 1e-4 * force.max()
    assert len(loaded.get_segments()) == pressed.sum() < force.size
    assert len(axes.lines[0].get_xdata()) == force.size
    with pytest.raises(UnknownNameError, match="shade"):
        figure_orbit(("planar", data), shade="laod")


def test_bars_around_the_bore_sum_to_the_impulse(real_runs):
    data = real_runs["case3"]
    figure = figure_bore_load(("case3", data), sectors=24)
    axes = figure.axes[0]
    contacts = ["elevation.radial+", "elevation.radial-"]
    impulse = data["normal_impulse"].sel(contact=contacts).isel(time=-1).values
    for bars, contact, expected in zip(axes.containers, contacts, impulse, strict=True):
        assert len(bars) == 24, contact
        size = factor_of("[" + axes.get_title("left").rpartition("rings in ")[2] + "]", "N s")
        assert sum(bar.get_height() for bar in bars) / size == pytest.approx(expected, rel=1e-12, abs=0.0)
    assert "per sector of 15°" in note_of(figure)


def test_load_lies_where_the_bore_was_touched(real_runs):
    """The first impact of the planar joint: its contact point's direction takes all."""
    data = real_runs["case2-planar"]
    release = float(data["release_time"].values[0])
    first = data.sel(time=slice(None, release))
    load = bore_load(first, sectors=36)["impulse"].values[0]
    at = int(np.argmax(first["normal_force"].values[:, 0]))
    x, y, _ = first["contact_point"].values[at, 0]
    assert int(np.argmax(load)) == int(np.mod(np.arctan2(y, x), 2 * np.pi) // np.radians(10))
    assert load.max() == pytest.approx(load.sum(), rel=1e-12, abs=0.0)


def test_eccentricity_is_drawn_over_the_clearance(real_runs):
    data = real_runs["case2-planar"]
    ratio, depth = figure_eccentricity(("planar", data)).axes
    centre = np.hypot(*data["journal_position"].values[:, 0, :2].T)
    np.testing.assert_allclose(lines_of(ratio)["centre"].get_ydata()[sampled(data)], centre / 2e-4, rtol=1e-9)
    peaks = lines_of(depth)["largest of each blow"]
    size = factor_of(depth.get_ylabel(), "m")
    np.testing.assert_allclose(peaks.get_ydata(), size * data["peak_depth"].values, rtol=1e-12)
    np.testing.assert_array_equal(peaks.get_xdata(), data["peak_time"].values)


def test_tilt_and_axial_place_are_of_joints_that_can_move_so(runs):
    figure = figure_eccentricity(runs)
    titles = {title_of(axes): axes for axes in figure.axes}
    tilt = titles["case3, tilt"]
    size = factor_of(tilt.get_ylabel() or "[mrad]", "rad")
    drawn, recorded = tilt.lines[0].get_ydata(), size * runs[2][1]["journal_tilt"].values[:, 0]
    np.testing.assert_allclose(drawn[sampled(runs[2][1])], recorded, atol=1e-9 * recorded.max())
    assert "case2-planar, tilt" not in titles
    assert "without a limit of the tilt: case2-planar" in note_of(figure)


def test_scenarios_fill_the_time_they_lasted(real_runs):
    data = real_runs["case3"]
    shares = scenario_shares(data).values[0]
    span = float(data["time"][-1])
    whole = figure_scenarios(("case3", data)).axes[::2]
    for axes, expected in zip(whole, (shares.sum(1), shares.sum(0)), strict=True):
        filled = []
        for bars in axes.patches[: len(expected)]:
            corners = bars.get_path().vertices.reshape(-1, 5, 2)
            filled.append(np.ptp(corners[:, :, 0], axis=1).sum() / span)
        np.testing.assert_allclose(filled, expected, atol=1e-12)


# --- loads ---


def test_force_through_a_joint_is_that_of_ideal_and_clearance_joint(runs):
    figure = figure_joint_load(runs)
    whole = figure.axes[0]
    size = factor_of(whole.get_ylabel(), "N")
    for case, data in runs:
        label = f"{case} (ideal)" if case == "case1" else case
        force = joint_loads(data)["force"].sel(moving_joint="elevation").values
        np.testing.assert_allclose(
            lines_of(whole)[label].get_ydata(), size * np.linalg.norm(force, axis=1), rtol=1e-12
        )
    # With clearance it is the contact force: its peaks are among the samples.
    contact = np.linalg.norm(runs[1][1]["joint_force"].values[:, 0], axis=1).max()
    assert lines_of(whole)["case2-planar"].get_ydata().max() == pytest.approx(size * contact, rel=1e-6)
    ratio = contact / np.linalg.norm(joint_loads(runs[0][1])["force"].values[:, 1], axis=1).max()
    assert f"case2-planar {ratio:.3g}" in note_of(figure)


def test_contact_forces_of_a_ball_are_the_whole_force(real_runs):
    data = real_runs["floating"]
    axes, _ = figure_contact_forces(("balls", data)).axes
    size = factor_of(axes.get_ylabel(), "N")
    force = np.linalg.norm(data["joint_force"].sel(clearance_joint="upper").values, axis=1)
    drawn = axes.lines[0].get_ydata()[sampled(data, "upper")]
    np.testing.assert_allclose(drawn, size * force, atol=1e-12 * size * force.max())
    peaks = next(line for line in axes.lines if line.get_marker() == ".")
    upper = data["episode_contact"].values == 0
    np.testing.assert_array_equal(peaks.get_xdata(), data["peak_time"].values[upper])


# --- base, joints, boresight ---


@pytest.mark.parametrize("quantity", BASE_QUANTITIES)
def test_base_is_drawn_with_its_deviation(runs, quantity):
    figure = figure_base(runs, quantity)
    case, data = runs[2]
    motion = base_motion(data)
    if quantity == "attitude":
        turn = Rotation.from_quat(motion["attitude"].values)
        expected = (turn[0].inv() * turn).as_euler("ZYX")[:, ::-1]
    else:
        expected = motion[quantity].values - (motion[quantity].values[0] if quantity == "position" else 0.0)
    *components, apart = figure.axes
    unit = {"position": "m", "velocity": "m/s", "acceleration": "m/s²", "attitude": "rad"}.get(
        quantity, "rad/s" if quantity == "angular_velocity" else "rad/s²"
    )
    for k, axes in enumerate(components):
        drawn = lines_of(axes)[case].get_ydata() / factor_of(axes.get_ylabel(), unit)
        np.testing.assert_allclose(drawn, expected[:, k], rtol=1e-9, atol=1e-18)
        assert lines_of(axes)["case1 (ideal)"].get_color() == "black"
    away = np.linalg.norm(deviation(data, runs[0][1]).data[f"base_{quantity}"].values, axis=1)
    drawn = lines_of(apart)[case].get_ydata() / factor_of(apart.get_ylabel(), unit)
    np.testing.assert_allclose(drawn, away, rtol=1e-9, atol=1e-24)


def test_components_that_are_round_off_are_named_and_left_out(runs):
    flat = runs[0][1].copy()
    flat["q"] = flat["q"].copy()
    for name in ("v", "a"):
        values = flat[name].values.copy()
        values[:, [2, 3, 4]] = 0.0
        flat[name] = (flat[name].dims, values)
    level = np.tile([0.0, 0.0, 0.0, 1.0], (flat.sizes["time"], 1))
    flat["base_attitude"] = (flat["base_attitude"].dims, level)
    figure = figure_base(("flat", flat), "angular_velocity")
    assert len(figure.axes) == 1
    left = "base angular velocity, x, base angular velocity, y"
    assert f"zero to round-off: {left}" in " ".join(note_of(figure).split())


@pytest.mark.parametrize("quantity", QUANTITIES)
def test_all_joints_are_drawn_beside_their_deviation(runs, quantity):
    figure = figure_joints(runs, quantity)
    assert len(figure.axes) == 4
    case, data = runs[1]
    azimuth, apart = figure.axes[:2]
    unit = {"angle": "rad", "rate": "rad/s", "acceleration": "rad/s²"}[quantity]
    away = deviation(data, runs[0][1]).data[quantity].sel(joint="azimuth").values
    drawn = lines_of(apart)[case].get_ydata() / factor_of(apart.get_ylabel(), unit)
    np.testing.assert_allclose(drawn, away, rtol=1e-9, atol=1e-24)
    expected = data[f"motion_{quantity}"].sel(joint="azimuth").values
    drawn = lines_of(azimuth)[case].get_ydata() / factor_of(azimuth.get_ylabel(), unit)
    np.testing.assert_allclose(drawn, expected, rtol=1e-9, atol=1e-24)


def test_pointing_error_is_against_the_ideal_run(runs):
    figure = figure_pointing(runs)
    cone = figure.axes[-1]
    expected = pointing_error(runs[2][1], runs[0][1])["half_cone"].values
    drawn = lines_of(cone)["case3"].get_ydata() / factor_of(cone.get_ylabel(), "rad")
    np.testing.assert_allclose(drawn, expected, rtol=1e-9, atol=1e-24)
    assert "against the ideal run" in note_of(figure)
    assert len(figure_pointing(runs[2:]).axes) == 2  # alone there is nothing to miss


# --- spectra ---


def test_spectra_are_those_of_the_analysis(runs):
    figure = figure_spectra(runs)
    letters = [axes.get_title("left").partition(" ")[0] for axes in figure.axes]
    assert letters == [rf"$\bf{{({letter})}}$" for letter, _ in zip("abc", SIGNALS, strict=True)]
    case, data = runs[1]
    values = data["motion_acceleration"].sel(joint="elevation").values
    expected = spectrum(data["time"].values, values, segment=0.5 * float(data["time"][-1]))
    line = lines_of(figure.axes[0])[case]
    np.testing.assert_allclose(line.get_ydata(), expected["density"].values[1:], rtol=1e-9)
    np.testing.assert_allclose(line.get_xdata(), expected["frequency"].values[1:])


def test_spectrogram_has_a_panel_per_run_with_contact(runs):
    figure = figure_spectrogram(runs, "force")
    titles = [axes.get_title("left") for axes in figure.axes if axes.get_title("left")]
    assert [title.rpartition("$ ")[2] for title in titles] == [
        f"{case}, force through elevation" for case in ("case2-planar", "case3")
    ]
    with pytest.raises(UnknownNameError, match="signal"):
        figure_spectrogram(runs, "jerk")


# --- bodies, and what goes on once impacts are over ---


@pytest.mark.parametrize("quantity", BODY_QUANTITIES)
def test_the_path_of_a_body_and_its_deviation_component_by_component(runs, quantity):
    """Of the one that the joint with play moves; panels alternate, the motion and its deviation."""
    figure = figure_body(runs, quantity)
    unit = {"position": "m", "velocity": "m/s", "acceleration": "m/s²"}[quantity]
    assert len(figure.axes) == 6
    motion = body_motion(runs[2][1], "shaft2")[quantity].values
    apart = body_deviation(runs[2][1], runs[0][1], "shaft2")[quantity].values
    for number, axes in enumerate(figure.axes):
        line = lines_of(axes)["case3"]
        factor = factor_of(axes.get_ylabel().split("\n" + "linear")[0].replace("\n", " "), unit)
        expected = (apart if number % 2 else motion)[:, number // 2]
        np.testing.assert_allclose(line.get_ydata() / factor, expected, rtol=1e-12, atol=1e-15)
    alone = figure_body(runs[1:], quantity)
    assert len(alone.axes) == 3  # nothing to compare with


def test_the_steady_force_is_that_of_the_second_half(runs):
    figure = figure_steady_force(runs[2:])
    whole, near = figure.axes
    data = runs[2][1]
    force = np.linalg.norm(joint_loads(data)["force"].sel(moving_joint="elevation").values, axis=1)
    time = data["time"].values
    held = time >= 0.5 * time[-1]
    line = lines_of(whole)["case3"]
    np.testing.assert_allclose(line.get_xdata(), time[held])
    factor = factor_of(whole.get_ylabel(), "N")
    np.testing.assert_allclose(line.get_ydata() / factor, force[held], rtol=1e-12)
    assert whole.get_yscale() == "linear"
    # A twenty-fifth of the run, within its second half, with the largest force of that half.
    left, right = near.get_xlim()
    assert right - left == pytest.approx(0.04 * time[-1])
    assert 0.5 * time[-1] <= left < time[held][np.argmax(force[held])] < right <= time[-1] * (1.0 + 1e-12)


# --- all of them ---

MADE_UP = ("motion_angle", "motion_rate", "motion_acceleration", "contact_forces", "energy", "momentum")
SLIDES = [name for name, figure in CATALOGUE.items() if figure.of is SLIDING]
CLOSURES = [name for name, figure in CATALOGUE.items() if figure.needs not in (None, FREE_BASE, POINTED)]
LOOPS = [*CLOSURES, *(name for name, figure in CATALOGUE.items() if figure.of is LOOPED)]
# Other files have those of made-up runs, closures, controllers, forces on links, flexible links, hysteresis,
# stops, gears and shaken bases.
FIGURES = [name for name in CATALOGUE if name not in (*MADE_UP, *SLIDES, *CLOSURES)]
STANDARD = [name for name, figure in CATALOGUE.items() if figure.standard and name not in (*SLIDES, *LOOPS)]


@pytest.mark.parametrize("width", ["column", pytest.param("page", marks=pytest.mark.slow)])
@pytest.mark.parametrize("name", FIGURES)
def test_no_two_labels_overlap_and_none_is_cut_off(runs, readable, name, width):
    short = runs[2][1].isel(time=slice(0, 1))
    figure = CATALOGUE[name].draw([*runs, ("short", short)], width=width)
    assert figure.get_figwidth() * 25.4 == pytest.approx({"column": 88.0, "page": 180.0}[width])
    assert "one sample only: short" in note_of(figure)
    readable(figure)


@pytest.mark.parametrize("name", [name for name in FIGURES if name != "pointing"])
def test_rigs_of_all_kinds_of_joints_can_be_read(rigs, readable, name):
    """Impacts of single bodies: components that are zero, steps, spectra of few decades."""
    readable(CATALOGUE[name].draw(rigs))


@pytest.mark.parametrize("width", ["column", "page"])
def test_figures_of_a_slider_and_of_its_ideal_joint_can_be_read(
    slider_run, ideal_slider_run, readable, width
):
    allowed = list(allowed_figures([("play", slider_run), ("no play", ideal_slider_run)]))
    assert {*SLIDES, *(name for name in STANDARD if CATALOGUE[name].touching)} < {
        each.figure.name for each in allowed
    }
    for each in allowed:
        if each.figure.name in (*SLIDES, "journal_orbit", "contact_forces", "joint_load", "energy"):
            readable(each.draw([("play", slider_run), ("no play", ideal_slider_run)], width=width))


def test_play_of_a_slider_is_drawn_as_its_rectangle(slider_run):
    """0.15 mm and 0.2 mm to each side, turned by 0.2 rad."""
    axes, c, s = figure_orbit(("play", slider_run)).axes[0], np.cos(0.2), np.sin(0.2)
    corners = axes.patches[0].get_xy() / factor_of(axes.get_xlabel(), "m") @ [[c, -s], [s, c]]
    assert corners[:4] == pytest.approx(np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [1.5e-4, 2e-4])


@pytest.mark.parametrize("name", [name for name in FIGURES if CATALOGUE[name].touching])
def test_runs_without_clearance_are_refused_or_named(runs, name):
    with pytest.raises(InvalidParameterError, match="at least one run with contact"):
        CATALOGUE[name].draw(runs[:1])
    note = note_of(CATALOGUE[name].draw(runs[:2]))
    assert "not drawn, no clearance in this joint: case1" in note


def test_a_figure_shows_itself_in_a_notebook(runs):
    assert figure_base(runs[:1])._repr_png_().startswith(b"\x89PNG")


def test_colours_are_told_apart_in_grey_where_they_stand_on_one_another(real_runs):
    """Bars of both ends differ by a fifth of the grey scale."""
    axes = figure_bore_load(("case3", real_runs["case3"])).axes[0]
    one, other = (np.dot(bars[0].get_facecolor()[:3], [0.299, 0.587, 0.114]) for bars in axes.containers)
    assert abs(one - other) > 0.2


@pytest.fixture(scope="module")
def plain():
    """A run with none of the elements that figures of whole runs are of."""
    return simulate(load_scenario("impact_pair"), duration=1e-3)


@pytest.mark.parametrize("name", CLOSURES)
def test_figures_of_kinds_of_runs_refuse_others(plain, name):
    assert name not in {each.figure.name for each in allowed_figures([plain])}
    with pytest.raises(InvalidParameterError, match=f"at least one run with {CATALOGUE[name].needed}"):
        CATALOGUE[name].draw([plain])


# --- files ---


def test_the_standard_set_of_real_runs(runs, tmp_path, monkeypatch):
    monkeypatch.setattr("antenna_pin.show.plot.files._as_file", lambda figure, suffix: b"")  # takes the time
    said = []
    written = save_figures(runs[::2], tmp_path, ("svg",), on_left_out=lambda *words: said.append(words))
    joints = {name: "azimuth" if figure.of is PLAYLESS else "elevation" for name, figure in CATALOGUE.items()}
    stems = [f"{name}-{joints[name]}" if CATALOGUE[name].of else name for name in STANDARD]
    assert [path.stem for path in written] == stems
    assert said == []


def test_what_samples_do_not_resolve_is_shaded_in_spectra_and_not_in_spectrograms(runs):
    """Above a fifth of the sample rate, 1 kHz here, up to half of it."""
    (patch,) = figure_spectra(runs).axes[0].patches
    low, high = patch.get_extents().transformed(patch.axes.transData.inverted()).get_points()[:, 0]
    assert high == pytest.approx(2.5 * low, rel=1e-6)
    axes = figure_spectrogram(runs[2]).axes[0]
    # The map ends with the cell of the last frequency below 200 Hz.
    assert not axes.patches and 0.9 * low < axes.get_ylim()[1] <= low * (1.0 + 1e-9)


@pytest.mark.parametrize(
    ("count", "labelled"), [(1, [0]), (2, [0, 1]), (3, [0, 1, 2]), (5, [2, 3, 4]), (6, [4, 5])]
)
def test_time_axes_that_no_other_continues_are_labelled(count, labelled):
    """The last of an odd number has a row to itself, on another scale than those above it."""
    t = np.linspace(0.0, 1.0, 5)
    panels = [Panel("p", [PlotCurve("c", t, t, smooth=True)], Axis("p", "m")) for _ in range(count)]
    axes = render(panels_sheet(panels, "page", 2)).axes
    assert [k for k, each in enumerate(axes) if each.get_xlabel()] == labelled


def test_figures_drawn_side_by_side_are_those_drawn_one_after_the_other(real_runs, tmp_path):
    """Processes know what this one knows; files, their order and what is left out are the same."""
    run = real_runs["case3"]
    faulty = run.drop_vars("motion_rate")
    names = ("motion_angle", "motion_rate", "momentum", "energy")
    alone, beside = [], []
    one = save_figures([("x", faulty)], tmp_path / "1", names=names, on_left_out=lambda *x: alone.append(x))
    two = save_figures(
        [("x", faulty)],
        tmp_path / "2",
        names=names,
        on_left_out=lambda *x: beside.append(x),
        processes=2,
    )
    assert [path.name for path in one] == [path.name for path in two] != []
    assert [path.read_bytes() for path in one] == [path.read_bytes() for path in two]
    assert alone == beside and [name for name, _ in alone] == ["motion_rate-elevation"]


def test_every_joint_with_play_has_its_files(real_runs, tmp_path, monkeypatch):
    monkeypatch.setattr("antenna_pin.show.plot.files._as_file", lambda figure, suffix: b"")
    ball = [("balls", real_runs["floating"])]
    joints = list(clearance_shapes(real_runs["floating"]))
    assert len(joints) == 2
    names = ["journal_orbit", "momentum"]
    stems = [path.stem for path in save_figures(ball, tmp_path, ("svg",), names=names)]
    assert stems == [f"journal_orbit-{joints[0]}", f"journal_orbit-{joints[1]}", "momentum"]
    alone = save_figures(ball, tmp_path, ("svg",), names=["journal_orbit"], joint=joints[1])
    assert [path.stem for path in alone] == [f"journal_orbit-{joints[1]}"]


def test_what_runs_are_about_is_drawn_of_each_joint_with_clearance(runs, rigs):
    """A ball does not turn about an axis; an ideal run is about the joint with clearance in other cases."""

    def drawn(runs, **options):
        return [(each.figure.name, each.joint) for each in allowed_figures(runs, **options)]

    names = [name for name, _ in drawn(runs)]
    assert names == STANDARD
    assert {joint for _, joint in drawn(runs)} == {"elevation", "azimuth", None}
    assert [name for name, joint in drawn(runs) if joint == "azimuth"] == ["joint_motion"]
    alone = dict(drawn(runs[:1]))
    assert alone["motion_angle"] == alone["joint_load"] == "elevation" and "contact_forces" not in alone
    assert {name for name, joint in drawn(rigs[3:]) if joint} == {
        name for name, figure in CATALOGUE.items() if figure.standard and figure.of in (TOUCHING, MOVING)
    }
    unknown = [(label, data.drop_attrs(deep=False)) for label, data in runs[:1]]  # of what may have play
    assert [joint for name, joint in drawn(unknown) if name == "joint_motion"] == ["azimuth", "elevation"]
    assert "motion_rate" not in dict(drawn(unknown))  # of a mechanism without play only where it is asked for
    assert drawn(unknown, names=["motion_rate"]) == [("motion_rate", "azimuth")]
    assert {"momentum", "pointing"} & {name for name, _ in drawn(runs)} == {"momentum", "pointing"}
    assert not {"pointing"} & {name for name, _ in drawn(rigs)}  # their scenarios do not say what looks where
    assert {joint for _, joint in drawn(runs, joint="azimuth")} == {"azimuth", None}
    assert "contact_forces" not in dict(drawn(runs, joint="azimuth"))
    assert drawn(runs, names=["joints_rate"]) == [("joints_rate", None)]
    two = ("two", rigs[0][1].assign_coords(joint=["other"], clearance_joint=["other"]))
    order = [joint for name, joint in drawn([rigs[0], two]) if name in ("motion_angle", "motion_rate")]
    assert order == ["bore", "bore", "other", "other"]  # joint by joint


def test_what_the_data_do_not_allow_is_left_out_with_the_reason(real_runs, tmp_path, monkeypatch):
    """A foreign tool has dropped a variable; the other figures are drawn all the same."""
    monkeypatch.setattr("antenna_pin.show.plot.files._as_file", lambda figure, suffix: b"")
    said = []
    data = real_runs["case2-planar"].drop_vars("journal_tilt").isel(time=slice(0, 12))
    written = save_figures([("cut", data)], tmp_path, ("svg",), on_left_out=lambda *words: said.append(words))
    reasons = dict(said)
    assert "no variable 'journal_tilt'" in reasons["eccentricity-elevation"]
    assert "16 samples" in reasons["spectra-elevation"]
    assert "contact_forces-elevation" in [path.stem for path in written]


# --- figures of papers ---


def test_numbers_are_those_of_the_papers():
    assert [figure.number for figure in paper_figures("bai2020")] == list(range(7, 14))
    assert [figure.number for figure in paper_figures("you2010")] == list(range(6, 17))
    with pytest.raises(UnknownNameError, match="bai2021.*did you mean bai2020"):
        paper_figures("bai2021")


def test_figures_of_bai_name_cases_that_exist():
    from antenna_pin.scenario import scenario_cases

    for model, figures in PAPERS.items():
        known = {case.name for case in scenario_cases(model)}
        for figure in figures:
            assert set(figure.cases) <= known
            assert figure.shows.endswith(".")


@pytest.mark.parametrize("number", [7, 8, 9, 10])
def test_figures_of_bai_are_drawn_from_their_cases(runs, number):
    figure = next(each for each in paper_figures("bai2020") if each.number == number)
    drawn = figure.draw(runs, width="column")
    text = " ".join(text.get_text() for legend in drawn.legends for text in legend.get_texts())
    text += " ".join(axes.get_title("left") for axes in drawn.axes)
    assert all(case in text for case in figure.cases)
    found = figure.describe(runs)
    assert all(case in found for case in figure.cases[1:])
    with pytest.raises(InvalidParameterError, match=f"figure {number}: runs must be with .*case3"):
        figure.draw(runs[:2])


def test_figures_of_you_are_drawn_from_their_cases(runs):
    """Bai's runs under the names of You's cases: the same figures but for the joint."""
    two = [
        (name, data.assign_attrs(case=name).assign_coords(joint=["joint1", "joint2"]))
        for name, (_, data) in zip(("ideal", "planar"), runs, strict=False)
    ]
    for figure in paper_figures("you2010"):
        if figure.number in (6, 7):  # these know the clearance joint's name
            continue
        drawn = figure.draw(two)
        assert drawn.axes
        assert "planar" in figure.describe(two)


def test_findings_are_the_analysis_own_numbers(runs):
    figure = paper_figures("bai2020")[0]
    expected = deviation(runs[2][1], runs[0][1])["elevation angle"].maximum
    assert f"case3 {1e6 * expected:.3g} µrad" in figure.describe(runs)


def test_an_azimuth_that_jumps_at_a_pole_has_a_gap_there(monkeypatch):
    """Straight over the zenith: from 0 to pi at once; a line between would be a direction it never had."""
    run = simulate(load_scenario("pointing_gear"), duration=0.05)
    turn = np.linspace(0.0, np.pi, run.data["time"].size)
    over = xr.Dataset(
        {"azimuth": ("time", np.where(turn < 0.5 * np.pi, 0.0, np.pi)), "elevation": ("time", turn)}
    )
    monkeypatch.setattr(against_ideal, "boresight", lambda data: over)
    figure = figure_pointing(run)
    values = figure.axes[0].lines[0].get_ydata()
    gap = np.flatnonzero(np.isnan(values))
    assert gap.size == 1 and values[gap[0] + 1] - values[gap[0] - 1] > 0.0
    assert "azimuth jumps" in note_of(figure)
