"""The figure of controllers: each number from its instant to the next, in the unit that it has."""

from pathlib import Path

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import InvalidParameterError
from antenna_pin.plot import allowed_figures, figure_applied_forces, figure_control

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


def test_forces_on_links_are_drawn_place_by_place(readable):
    """5 N across the panel, turning with it; no torque: no panel of it."""
    force = {"kind": "force", "at": {"link": "panel", "point": [0.1, 0.0, 0.0]}, "force": [0.0, 0.0, "5 N"]}
    scenario = load_scenario(PANEL, case="ideal", overrides={"forces.push": force, "duration": "20 ms"})
    run = simulate(scenario)
    assert "applied_forces" in {each.figure.name for each in allowed_figures([run])}
    figure = figure_applied_forces(run)
    readable(figure)
    (axes,) = figure.axes
    np.testing.assert_allclose(axes.lines[0].get_ydata(), 5.0, rtol=1e-12)


def test_runs_without_either_are_refused(sampled):
    plain = simulate(load_scenario("impact_pair"), duration=1e-3)
    assert not {"control", "applied_forces"} & {each.figure.name for each in allowed_figures([plain])}
    with pytest.raises(InvalidParameterError, match="at least one run with a controller"):
        figure_control(plain)
    with pytest.raises(InvalidParameterError, match="at least one run with a force on a link"):
        figure_applied_forces(sampled)
