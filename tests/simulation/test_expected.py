"""A run that takes long says so in time, how long and why; the clock changes nothing in it."""

import itertools
import re
import types
import warnings

import numpy as np
import pytest

from antenna_pin import Outcome, RunSettings, System, Urdf, build_mechanism, load_scenario, simulate
from antenna_pin.elements import CallableDrive, ConstantDrive
from antenna_pin.errors import LongRunWarning
from antenna_pin.run.simulation import loop, monitor, steps
from antenna_pin.run.simulation.steps import StepCounts

WHEEL = """<robot name="wheel"><link name="hub"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="axle" type="continuous"><parent link="hub"/><child link="rim"/><axis xyz="0 0 1"/></joint>
<link name="rim"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>"""
FIXED = {"method": "rk4", "step": 1e-3, "output_rate": 100.0}


def wheel(**drives):
    return System(build_mechanism(Urdf.from_text(WHEEL, "wheel.urdf")), drives=drives)


@pytest.fixture
def slow_clock(monkeypatch):
    """A clock of which each look takes a second: a run seems to take one for each step."""
    ticks = itertools.count()
    monkeypatch.setattr(steps, "_BUDGET", 1)
    monkeypatch.setattr(loop, "time", types.SimpleNamespace(perf_counter=lambda: float(next(ticks))))


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_a_long_run_is_told_of_once_and_is_the_same_run(monkeypatch, engine):
    """500 steps, and a minute from one look at the clock to the next."""
    monkeypatch.setattr(steps, "_BUDGET", 16)
    system, settings = (
        wheel(motor=ConstantDrive(joint="axle", value=0.1)),
        RunSettings(engine=engine, **FIXED),
    )
    with warnings.catch_warnings(record=True) as quick:
        warnings.simplefilter("always")
        before = simulate(system, duration=0.5, settings=settings)
    ticks = itertools.count(0, 60)
    monkeypatch.setattr(loop, "time", types.SimpleNamespace(perf_counter=lambda: float(next(ticks))))
    with pytest.warns(LongRunWarning) as told:
        run = simulate(system, duration=0.5, settings=settings)
    assert not quick and len(told) <= 2 and run.completed
    assert "of 0.5 s, after " in str(told[0].message) and "max_wall_time" in str(told[0].message)
    assert re.search(r"will take another [\d.]+ (min|h)", str(told[0].message))
    np.testing.assert_array_equal(run.data["q"].values, before.data["q"].values)


def test_an_estimate_is_told_again_if_it_is_another():
    """Steps of 1 ms a second, of 50 s; then a hundred times as slow, then as before."""
    watch, told, wall = monitor.TimeEstimate(50.0), [], 7.0
    watch.begin(0.0, StepCounts(0, 0, 0, 0, wall))
    for k in range(1, 8193):
        wall += 100.0 if 1024 < k <= 1100 else 1.0
        if watch.update(1e-3 * k, StepCounts(k, 0, 0, 0, wall)):
            told.append((k, watch.text(1e-3 * k)))
    assert 15 <= [k for k, _ in told][0] <= 24 and 2 <= len(told) <= 4
    assert "s, the run will take another 14 h at its present pace, with steps of 0.001 s" in told[0][1]
    # Slow for a while only: 13 h remain, as the pace before says, and not the 6 days of the last look alone.
    assert told[1][0] > 1024
    assert re.search(r"another 14 h to \d+ days, as its pace changes", told[1][1]), told[1]
    assert not monitor.TimeEstimate(1.0).update(
        0.5, StepCounts(9, 0, 0, 0, 1e9)
    )  # nothing before the beginning


def test_a_burst_is_not_told_of():
    """Fast up to 90 %, then for 4 s hardly any way, then fast again; it is told of where it stays slow."""
    for slow in (4, 40):
        watch, told, t = monitor.TimeEstimate(100.0), [], 0.0
        watch.begin(t, StepCounts(0, 0, 0, 0, 0.0))
        for k in range(1, 401):
            t += 1e-4 if 25 < k <= 25 + 10 * slow else 3.6
            if t < 100.0 and watch.update(t, StepCounts(k, 0, 0, 0, 0.1 * k)):
                told.append(0.1 * k)
        assert len(told) == (slow == 40) and all(when <= 10.1 for when in told)


def test_first_steps_that_load_what_they_call_are_no_pace():
    """28 steps in 7 s, as kernels are loaded; then a thousand a second, and the whole is done in 10 s."""
    watch, told, wall = monitor.TimeEstimate(1.0), [], 0.0
    watch.begin(0.0, StepCounts(0, 0, 0, 0, wall))
    for k in range(1, 3000):
        wall += 0.25 if k <= 28 else 1e-3
        told += [watch.text(k / 3e3)] * watch.update(k / 3e3, StepCounts(k, 0, 0, 0, wall))
    assert not told


def jumps(t, angle, rate):
    return 1.0 if rate < 0.0 else -1.0


@pytest.mark.parametrize(
    ("what", "drive", "v", "why"),
    [
        (
            "a base too fast",
            lambda t, a, r: 0.1,
            1e10,
            "the velocity base.vx = 1×10¹⁰: start slower",
        ),
        ("noise", lambda t, a, r: np.sin(1e21 * r), 0.0, "by their last digits"),
        ("a fast wheel", lambda t, a, r: 0.0, 0.0, "joint 'axle' turns at 10000 rad/s, and steps follow"),
        ("a force that jumps", jumps, 0.0, "% of its steps are rejected, as by a force that jumps"),
    ],
)
def test_what_makes_a_run_slow_is_told(slow_clock, what, drive, v, why):
    system = wheel(motor=CallableDrive(joint="axle", torque=drive))
    settings = RunSettings(max_steps=60, rtol=1e-12)
    start = [v, 0.0, 0.0, 0.0, 0.0, 0.01, 1e4 if what == "a fast wheel" else 1e-4]
    with pytest.warns(LongRunWarning, match=why.replace(".", r"\.")) as told:
        run = simulate(system, duration=1e4, v=start, settings=settings)
    assert len(told) <= 3 and run.outcome is Outcome.STEP_LIMIT and why.split(" = ")[0] in run.message


def test_a_run_out_of_its_time_goes_on_to_the_run_in_one(tmp_path, slow_clock):
    """Each time it is given the time of a few steps more; its limit may be another."""
    panel = load_scenario("impact_pair", overrides=["output.rate=1 kHz"])
    whole = simulate(panel)
    limited = panel.with_overrides({"integrator.max_wall_time": 40.0})
    out = tmp_path / "run.nc"
    parts = [simulate(limited, out=out)]
    while parts[-1].outcome is Outcome.TIME_LIMIT and len(parts) < 100:
        limit = 50.0 if len(parts) % 2 else 30.0
        again = panel.with_overrides({"integrator.max_wall_time": limit})
        parts.append(simulate(again, out=out, resume=True))
    assert 3 <= len(parts) < 100 and parts[-1].outcome is whole.outcome
    for name in ("time", "q", "v", "onset_time"):
        np.testing.assert_array_equal(parts[-1].data[name].values, whole.data[name].values)
    assert not out.with_name("run.nc.parts").exists()
