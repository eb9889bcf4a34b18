"""Figures of controllers, stops, latches, gears and flexible links: readable, and what the runs hold."""

from pathlib import Path

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import gear_impacts, latch_events
from antenna_pin.show.plot import allowed_figures, figure_control, figure_deflection

from .conftest import note_of, title_of

PANEL = Path(__file__).parents[2] / "scripts" / "examples" / "panel" / "scenario.toml"
LOOP = {
    "kind": "pid",
    "acts_on": "motor",
    "period": "10 ms",
    "kp": 40.0,
    "kd": 6.0,
    "upper": 5.0,
    "lower": -5.0,
    "reference": "20 deg",
}
MOTOR = {"kind": "constant", "joint": "hinge", "value": 0.0}


@pytest.fixture(scope="module")
def sampled():
    """A motor whose limits hold it until 0.1 s or so."""
    overrides = {"drives.motor": MOTOR, "controllers.loop": LOOP, "duration": "0.3 s"}
    return simulate(load_scenario(PANEL, case="ideal", overrides=overrides))


@pytest.fixture(scope="module")
def followed():
    """The continuous controller of the panel's case."""
    return simulate(load_scenario("pointing_gear", case="tight"), duration=0.2)


@pytest.mark.parametrize("width", ["page", "column"])
def test_controllers_can_be_read(sampled, followed, readable, width):
    for runs in ([sampled], [followed], [sampled, followed]):
        readable(figure_control(runs, width=width))


def test_numbers_hold_from_one_instant_to_the_next(sampled):
    data = sampled.data
    seen, command = figure_control(sampled).axes
    for axes, signals in ((seen, ("measured", "reference")), (command, ("command motor",))):
        for line, signal in zip(axes.lines, signals, strict=True):
            assert line.get_drawstyle() == "steps-post"
            values = data["tick_signal"].sel(signal=f"loop.{signal}").values
            np.testing.assert_array_equal(line.get_xdata(), [*data["tick_time"].values, data["time"][-1]])
            np.testing.assert_array_equal(line.get_ydata(), [*values, values[-1]])
    assert seen.get_ylabel() == "[rad]" and command.get_ylabel() == "[N m]"


def test_the_ground_is_grey_while_limits_hold_the_command(sampled):
    """The command is at its limit from the first instant to the end of the last that is held."""
    data = sampled.data
    held = data["tick_signal"].sel(signal="loop.saturated").values > 0.0
    times = data["tick_time"].values
    assert held[0] and not held[-1]
    last = times[np.flatnonzero(held)[-1] + 1]
    command = figure_control(sampled).axes[1]
    spans = [patch.get_extents().transformed(command.transData.inverted()) for patch in command.patches]
    assert spans[0].x0 == pytest.approx(times[0], abs=1e-12)
    assert spans[-1].x1 == pytest.approx(last, rel=1e-9)


def test_a_continuous_controller_has_what_it_follows(followed):
    data = followed.data
    seen, torque = figure_control(followed).axes
    factor = 1e3 if "[mrad]" in seen.get_ylabel() else 1.0
    measured = data["control_reference"].values[:, 0] - data["control_error"].values[:, 0]
    np.testing.assert_allclose(seen.lines[0].get_ydata(), factor * measured, rtol=1e-12)
    assert torque.get_ylabel().endswith("N m]")


# --- stops and latches ---


@pytest.fixture(scope="module")
def array():
    """A solar array that unfolds, past its stops and latches."""
    return simulate(load_scenario("solar_array", case="ideal"), duration=9.0)


@pytest.mark.parametrize("width", ["page", "column"])
def test_stops_and_latches_of_four_hinges_can_be_read(array, readable, width):
    (stops,) = (each for each in allowed_figures([array]) if each.figure.name == "stops")
    figure = stops.draw([array], width=width)
    readable(figure)
    assert {title_of(axes).split()[-1] for axes in figure.axes[::2]} == {
        "root",
        "first",
        "second",
        "third",
    }
    assert latch_events(array).sizes["latch_event"] == 4  # each captured once


def test_marks_stand_on_the_curves_at_the_times_of_captures(array):
    (stops,) = (each for each in allowed_figures([array]) if each.figure.name == "stops")
    events = latch_events(array)
    captures = dict(zip(events["latch"].values.tolist(), events["time"].values.tolist(), strict=True))
    seen = {}
    for axes in stops.draw([array]).axes[::2]:
        (line,) = (one for one in axes.lines if len(one.get_xdata()) > 100)
        offsets = [np.asarray(one.get_offsets()) for one in axes.collections]
        marks = np.concatenate([one for one in offsets if len(one)])
        # A curve is thinned to a hundredth of a line's width, and turns sharply where a latch holds.
        on_curve = np.interp(marks[:, 0], line.get_xdata(), line.get_ydata())
        assert marks[:, 1] == pytest.approx(on_curve, abs=1e-3 * np.ptp(line.get_ydata()))
        seen[axes.get_title("left").split()[-1]] = marks[:, 0]
    for latch, time in captures.items():
        assert np.abs(seen[latch.rpartition(".")[2]] - time).min() < 1e-12


# --- gears ---


@pytest.fixture(scope="module")
def geared():
    """A gear with play, one without, and belts."""
    return [
        simulate(load_scenario("pointing_gear"), duration=1.0),
        simulate(load_scenario("pointing_gear", case="tight"), duration=1.0),
        simulate(load_scenario("solar_array", case="ideal"), duration=1.0),
    ]


@pytest.mark.parametrize("width", ["page", "column"])
def test_gears_and_belts_can_be_read(geared, readable, width):
    (gears,) = (each for each in allowed_figures(geared) if each.figure.name == "gears")
    figure = gears.draw(geared, width=width)
    readable(figure)
    titles = [title_of(axes) for axes in figure.axes[::2]]
    assert titles == ["train", "root first", "first second", "second third"]
    onsets = gear_impacts(geared[0]).onset.values
    marked = np.concatenate([np.asarray(one.get_offsets()) for one in figure.axes[0].collections])
    assert len(onsets) > 5
    assert np.isin(onsets, marked[:, 0]).all()


# --- flexible links ---


@pytest.fixture(scope="module")
def flexible():
    cases = ("flexible-ideal", "flexible", "petals", "case1")
    return {case: simulate(load_scenario("bai2020", case=case), duration=0.12) for case in cases}


@pytest.mark.parametrize("width", [pytest.param("page", marks=pytest.mark.slow), "column"])
def test_all_figures_of_flexible_links_can_be_read(flexible, readable, width):
    allowed = {each.figure.name: each for each in allowed_figures(flexible.values())}
    assert "deflection" in allowed
    for name in ("deflection", "energy", "spectra", "joint_load"):
        readable(allowed[name].draw(flexible.values(), width=width))
    assert "deflection" not in {each.figure.name for each in allowed_figures([flexible["case1"]])}


def test_deflections_are_those_of_the_runs(flexible):
    figure = figure_deflection([flexible["flexible-ideal"], flexible["flexible"], flexible["case1"]])
    assert [title_of(axes) for axes in figure.axes] == [
        "reflector nod",
        "its amplitude density",
        "reflector bend",
        "its amplitude density",
    ]
    line = next(one for one in figure.axes[0].lines if one.get_label() == "flexible")
    expected = flexible["flexible"].data["deflection"].sel(elastic_part="reflector_nod").values
    np.testing.assert_allclose(line.get_ydata(), 1e3 * expected, rtol=1e-12)  # in mrad
    assert "without flexible links: case1" in note_of(figure)


def test_of_many_parts_those_that_deflect_most_are_drawn(flexible):
    figure = figure_deflection([flexible["petals"]])
    peaks = flexible["petals"].data["peak_deflection"]
    largest = {
        str(name).replace("_", " ") for name in peaks["elastic_part"].values[np.argsort(-peaks.values)[:4]]
    }
    titles = {title_of(axes) for axes in figure.axes}
    assert titles == largest | {"its amplitude density"}
    assert "4 of 8 elastic parts" in note_of(figure)
