"""Blows in figures: the strongest from near, marks of blows and none of smooth maxima."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.show.plot import figure_bore_load, figure_contact_forces, figure_eccentricity


@pytest.fixture(scope="module")
def run(real_runs):
    return real_runs["case3"]


def blow_of(figure):
    return next(axes for axes in figure.axes if "strongest blow" in axes.get_title("left"))


def hardest_of(axes):
    lines = (one for one in axes.lines if one.get_marker() != ".")
    return max(lines, key=lambda one: float(np.max(one.get_ydata())))


def unit_of(axes):
    """What the printed unit of force is multiplied by [1/N]."""
    return {"normal force [N]": 1.0, "normal force [kN]": 1e-3}[axes.get_ylabel()]


def strongest(data):
    return int(np.nanargmax(data["peak_force"].values))


def test_the_close_view_is_of_the_strongest_blow_and_passes_through_its_peak(run):
    k = strongest(run)
    peak, at = (float(run[name].values[k]) for name in ("peak_force", "peak_time"))
    axes = blow_of(figure_contact_forces(("case3", run)))
    factor = unit_of(axes)
    start, end = axes.get_xlim()
    unit = {"ms": 1e3, "µs": 1e6}[axes.get_xlabel().rpartition("[")[2].rstrip("]")]
    assert start < unit * (float(run["onset_time"].values[k]) - at) < 0.0 < end
    forces = [np.asarray(line.get_ydata()) for line in axes.lines if line.get_marker() != "."]
    # The peak is a sample; the factor costs a rounding.
    assert max(force.max() for force in forces) == pytest.approx(factor * peak, rel=1e-12)
    hardest = hardest_of(axes)
    assert abs(hardest.get_xdata()[np.argmax(hardest.get_ydata())]) < 1e-9 * unit


def test_the_area_under_a_blow_is_its_impulse(run):
    """Between onset, peak and release a monotone cubic lies under a Hertzian pulse's flanks: by 7 % here."""
    k = strongest(run)
    assert np.isfinite(run["release_time"].values[k])
    figure = figure_contact_forces(("case3", run))
    axes = blow_of(figure)
    factor = unit_of(axes)
    unit = {"ms": 1e3, "µs": 1e6}[axes.get_xlabel().rpartition("[")[2].rstrip("]")]
    line = max((one for one in axes.lines if one.get_marker() != "."), key=lambda one: one.get_ydata().max())
    span = [
        unit * float(run[name].values[k] - run["peak_time"].values[k])
        for name in ("onset_time", "release_time")
    ]
    inside = (line.get_xdata() >= span[0] - 1e-9) & (line.get_xdata() <= span[1] + 1e-9)
    area = np.trapezoid(line.get_ydata()[inside], line.get_xdata()[inside]) / (factor * unit)
    assert area == pytest.approx(float(run["impulse"].values[k]), rel=0.1)


def test_a_lasting_contact_has_no_mark_and_no_close_view():
    """A journal laid into the bore sinks to its depth at rest: a maximum as wide as the run."""
    run = simulate(load_scenario("pendulum", case="planar-rest"), duration=0.02).data
    assert run.sizes["episode"] == 1
    figure = figure_contact_forces(("rest", run))
    assert not any("strongest blow" in axes.get_title("left") for axes in figure.axes)
    dots = [line for axes in figure.axes for line in axes.lines if line.get_marker() == "."]
    assert not any(np.asarray(line.get_xdata()).size for line in dots)


def test_where_the_bore_was_pressed_stands_over_time(run):
    """Beside the load of a single run; of several each has a panel of the load."""
    load, when = figure_bore_load(("case3", run)).axes
    k = strongest(run)
    at = np.searchsorted(run["time"].values, run["peak_time"].values[k])
    contact = int(run["episode_contact"].values[k])
    x, y, _ = run["contact_point"].values[at, contact]
    rings = np.concatenate([np.asarray(one.get_offsets()) for one in when.collections])
    near = np.abs(rings - [run["peak_time"].values[k], np.degrees(np.arctan2(y, x))]).max(axis=1)
    assert near.min() < 1e-9
    assert load.name == "polar" and when.get_xlim() == (0.0, pytest.approx(float(run["time"][-1])))
    assert {axes.name for axes in figure_bore_load([("a", run), ("b", run)]).axes} == {"polar"}


@pytest.mark.parametrize("figure", [figure_contact_forces, figure_eccentricity])
def test_a_result_without_its_table_of_contacts_has_no_blows(run, figure):
    """As another tool may leave it: the curves are drawn all the same."""
    whole, bare = figure(("case3", run)), figure(("case3", run.drop_dims("episode")))
    dots = [
        sum(np.size(line.get_xdata()) for axes in one.axes for line in axes.lines if line.get_marker() == ".")
        for one in (whole, bare)
    ]
    assert dots[0] > 0 and dots[1] == 0
    assert not any("strongest blow" in axes.get_title("left") for axes in bare.axes)
