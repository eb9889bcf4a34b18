"""The compiled engine: the same runs as by Pinocchio's dynamics, and what it refuses."""

import importlib
import re
from pathlib import Path

import numpy as np
import pytest
from wheel import wheel_urdf

from antenna_pin import RunSettings, System, build_mechanism, load_scenario, simulate
from antenna_pin.dynamics import CallableDrive
from antenna_pin.errors import MechanismError

SCRIPTS = Path(__file__).parents[2] / "scripts" / "check"


def run(model, case, duration, engine="compiled", joints=(), **settings):
    overrides = [f"clearance.{joint}.geometry=closed-form" for joint in joints]
    overrides += [f"integrator.engine={engine}"]
    overrides += [f"{key.replace('__', '.')}={value}" for key, value in settings.items()]
    return simulate(load_scenario(model, case=case, overrides=overrides), duration=duration)


def at_output_times(*runs):
    """Configurations and velocities at output times; samples at peaks may coincide but for round-off."""
    times = np.arange(1, int(1e3 * float(runs[0].data.time[-1]) + 1e-9)) / 1e3
    found = [one.data.sel(time=times, method="nearest", tolerance=1e-12) for one in runs]
    return [np.hstack([one.q.values, one.v.values]) for one in found]


@pytest.mark.parametrize(
    ("model", "case", "duration"),
    [
        ("bai2020", "case1", 0.1),
        ("bai2020", "case3", 0.05),
        ("you2010", "planar", 0.02),
        ("you2010", "3d", 0.02),
        ("impact_pair", "flange", None),
        ("pendulum", "contact", 0.05),
        ("spherical_pendulum", "spatial", 0.05),
        ("slider", "driven", 0.05),
    ],
)
def test_shipped_trees_move_as_with_pinocchio(model, case, duration):
    """So shortly that impacts have not made much of round-off, 1e-10 of what moves before the first."""
    known = load_scenario(model, case=case)
    joints = [name for name in known.clearance if hasattr(known.clearance[name], "shape")]
    span = known.duration if duration is None else duration
    ours, theirs = (run(model, case, span, engine, joints) for engine in ("compiled", "pinocchio"))
    assert ours.data.sizes.get("episode") == theirs.data.sizes.get("episode")
    values, expected = at_output_times(ours, theirs)
    assert np.abs(values - expected).max() <= 1e-5 * np.abs(expected).max()
    assert np.abs(values[:1] - expected[:1]).max() <= 1e-10 * np.abs(expected[:1]).max()


@pytest.mark.parametrize("number", range(5, 13))
def test_random_mechanisms_move_as_with_pinocchio(monkeypatch, number):
    """Of all kinds of joints, laws, drives and springs, over the first of their steps."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    drawn = importlib.import_module("scenario_generator").draw_scenario(2024, number)
    changes = {f"clearance.{name}.geometry": "closed-form" for name in drawn.clearance}
    ends = []
    for engine in ("compiled", "pinocchio"):
        scenario = drawn.with_overrides({**changes, "integrator.engine": engine})
        ends.append(simulate(scenario, duration=0.1 * drawn.duration))
    ours, theirs = ends
    assert ours.outcome == theirs.outcome
    values, expected = (one.data.q.values[-1] for one in ends)
    # Errors of the default tolerance, 1e-8, are the same; what impacts make of round-off is not.
    assert np.abs(values - expected).max() <= 1e-6 * max(1.0, np.abs(expected).max())


@pytest.mark.parametrize(
    ("model", "case", "joints", "duration"),
    [
        ("slider_crank", "ideal", [], 0.012),
        ("slider_crank", "planar", ["pin"], 0.003),
        ("slider_crank", "3d-friction", ["pin"], 0.003),
        ("chen2021", "ideal", [], 0.2),
        ("chen2021", "friction-010", ["s2"], 0.02),
        ("bai2020", "case1-constraint", [], 0.05),
    ],
)
def test_loops_move_as_with_pinocchio(model, case, joints, duration):
    """Closed loops and motions: states, forces of closures and drives, what corrections put in."""
    ours, theirs = (run(model, case, duration, engine, joints) for engine in ("compiled", "pinocchio"))
    for name in ("q", "v", "closure_force", "drive_torque"):
        value, expected = (one.data[name].values[-1] for one in (ours, theirs))
        # Round-off, and what a few impacts make of it.
        assert np.abs(value - expected).max() <= 1e-6 * max(1.0, np.abs(expected).max())
    for one in (ours, theirs):
        held = one.constraints
        assert max(held["position_residual"], held["angle_residual"]) < 1e-13
        assert max(held["velocity_residual"], held["rate_residual"]) < 1e-12
    assert abs(ours.constraints["projection_energy"] - theirs.constraints["projection_energy"]) < 1e-9


def test_what_is_not_compiled_is_refused_by_name():
    compiled = RunSettings(engine="compiled")
    with pytest.raises(MechanismError, match="joint 'elevation' has its gaps measured by coal"):
        run("bai2020", "case3", 0.01)
    mechanism = build_mechanism(wheel_urdf(inertia=1.0, joint="pivot"), "fixed")
    drive = CallableDrive(joint="pivot", torque=lambda t, angle, rate: 1.0)
    message = (
        "engine 'compiled': what acts at joint 'pivot' is a function in Python; compile it with "
        "numba.njit, or take"
    )
    with pytest.raises(MechanismError, match=f"^{re.escape(message)}"):
        simulate(System(mechanism, drives={"motor": drive}), duration=0.1, settings=compiled)
    with pytest.raises(ValueError, match="engine"):
        RunSettings(engine="fortran")
