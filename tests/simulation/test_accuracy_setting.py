"""``integrator.accuracy``: which method and tolerance it chooses, what it excludes, and that it is kept."""

import re

import numpy as np
import pytest

from antenna_pin import RunSettings, load_scenario, simulate
from antenna_pin.errors import InvalidParameterError, ScenarioError
from antenna_pin.trajectory import Trajectory


def chosen(scenario):
    spec = scenario.integrator
    return spec.method, spec.rtol, spec.accuracy


def test_an_accuracy_chooses_method_and_tolerance():
    """A thousandth of small accuracies; of large ones more, without a jump, and never a coarse tolerance."""
    for accuracy, method, rtol in (
        (1e-1, "dormand-prince-54", 1e-3),
        (1e-2, "dormand-prince-54", 2e-4),
        (1e-4, "dormand-prince-54", 2e-7),
        (1e-6, "dormand-prince-54", 1e-9),
        (1e-7, "dormand-prince-853", 1e-10),
    ):
        expected = (method, pytest.approx(rtol, rel=1e-15), accuracy)
        scenario = load_scenario("bai2020", overrides={"integrator.accuracy": accuracy})
        assert chosen(scenario) == expected
        settings = RunSettings(accuracy=accuracy)
        assert (settings.method, settings.rtol, settings.accuracy) == expected
    assert chosen(load_scenario("bai2020", overrides=["integrator.accuracy=0.1 %"]))[0] == "dormand-prince-54"


def test_what_is_laid_over_takes_the_place_of_what_it_excludes():
    """The pendulum's file gives a tolerance; an accuracy set over it counts, and the other way round."""
    given = load_scenario("pendulum")
    rough = given.with_overrides(["integrator.accuracy=1e-3"])
    assert given.integrator.accuracy is None
    assert chosen(rough) == ("dormand-prince-54", 0.2 * 1e-3**1.5, 1e-3)
    fine = rough.with_overrides(["integrator.accuracy=1e-8"])
    assert chosen(fine) == ("dormand-prince-853", 1e-8 / 1000, 1e-8)
    assert chosen(rough.with_overrides(["integrator.rtol=1e-9"])) == ("dormand-prince-54", 1e-9, None)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (
            ["integrator.accuracy=1e-3", "integrator.rtol=1e-9"],
            "integrator.rtol must be left out with accuracy = 0.001, which chooses it, got 1e-09; "
            "leave out one of them",
        ),
        (
            ["integrator.accuracy=1e-3", "integrator.method=rk4"],
            "integrator.method must be left out with accuracy = 0.001, which chooses it, got 'rk4'; "
            "leave out one of them",
        ),
        (["integrator.accuracy=2"], "integrator.accuracy must be between 0 and 1, got 2"),
        (
            ["integrator.accuracy=1e-12"],
            "integrator.accuracy must be from 1e-10 to 0.1; for what lies beyond set method and rtol, "
            "got 1e-12",
        ),
    ],
)
def test_refusals(overrides, message):
    with pytest.raises(ScenarioError, match=f"^{re.escape('bai2020/scenario.toml: ' + message)} \\(set by"):
        load_scenario("bai2020", overrides=overrides)


def test_settings_in_python_refuse_both():
    with pytest.raises(InvalidParameterError, match="rtol must be left out with accuracy = 0.001"):
        RunSettings(accuracy=1e-3, rtol=1e-9)


def test_a_result_keeps_the_accuracy(tmp_path):
    """Given in the scenario or beside it."""
    scenario = load_scenario("bai2020", case="case1")
    run = simulate(scenario, duration=1e-3, settings=RunSettings(accuracy=1e-3))
    run.save(tmp_path / "run.nc")
    kept = Trajectory.load(tmp_path / "run.nc").scenario
    assert kept is not None and chosen(kept) == ("dormand-prince-54", 0.2 * 1e-3**1.5, 1e-3)


def test_the_command_line_takes_it(cli, tmp_path):
    out = tmp_path / "run.nc"
    short = ("--duration", "1 ms", "--no-progress", "--quiet", "--out", str(out))
    assert cli("run", "bai2020", "--case", "case1", "--accuracy", "1e-3", *short).code == 0
    assert chosen(Trajectory.load(out).scenario) == ("dormand-prince-54", 0.2 * 1e-3**1.5, 1e-3)
    said = cli("run", "bai2020", "--accuracy", "3", *short)
    assert said.code == 2 and len(said.err.splitlines()) == 1
    assert "integrator.accuracy must be between 0 and 1, got 3" in said.err


def made(model, case, joint, duration, **settings):
    changes = {f"clearance.{joint}.geometry": "closed-form", "integrator.engine": "compiled"}
    changes |= {f"integrator.{key}": value for key, value in settings.items()}
    return simulate(load_scenario(model, case=case, overrides=changes), duration=duration).data


def errors(ours, theirs, joint, duration):
    """Of the angle, of the contacts' impulse and of the largest force, relative."""
    times = np.arange(1, round(1e3 * duration) + 1) / 1e3
    angles = [
        one.motion_angle.sel(joint=joint).sel(time=times, method="nearest").values for one in (ours, theirs)
    ]
    impulses = [float(one.normal_impulse.values[-1].sum()) for one in (ours, theirs)]
    peaks = [float(one.peak_force.values.max()) for one in (ours, theirs)]
    return (
        np.abs(angles[0] - angles[1]).max() / np.abs(angles[1]).max(),
        abs(impulses[0] / impulses[1] - 1.0),
        abs(peaks[0] / peaks[1] - 1.0),
    )


def check(model, case, joint, duration, accuracies):
    exact = made(model, case, joint, duration, method="dormand-prince-853", rtol=1e-12)
    for accuracy in accuracies:
        found = errors(made(model, case, joint, duration, accuracy=accuracy), exact, joint, duration)
        assert max(found) <= accuracy, (model, accuracy, found)


def test_the_accuracy_is_reached_over_thirty_impacts():
    check("bai2020", "case3", "elevation", 0.2, (1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("model", "case", "joint", "duration"),
    [
        ("bai2020", "case2-planar", "elevation", 0.2),
        ("pendulum", "contact", "hinge", 0.05),
        ("pendulum", "planar", "hinge", 0.2),
        ("slider_crank", "planar", "pin", 0.005),
    ],
)
def test_the_accuracy_is_reached(model, case, joint, duration):
    """So shortly that impacts have not made more of a difference than it was."""
    check(model, case, joint, duration, (1e-1, 1e-2, 1e-3, 1e-4, 1e-5))
