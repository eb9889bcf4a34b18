"""How a run behaves: sampling, progress, stopping, drives and springs against closed forms."""

import math
import os
import signal

import numpy as np
import pytest
from wheel import INERTIA, wheel_urdf

from antenna_pin import (
    AntennaPinError,
    ErrorScales,
    Outcome,
    RunSettings,
    System,
    build_mechanism,
    load_scenario,
    simulate,
)
from antenna_pin.dynamics import CallableDrive, JointSpring, SineDrive, TableDrive
from antenna_pin.scenario.assemble import build_system


def wheel(kind="continuous", **elements):
    return System(build_mechanism(wheel_urdf(kind), base="fixed"), **elements)


TIGHT = RunSettings(rtol=1e-12, output_rate=200.0)


@pytest.mark.parametrize("kind", ["continuous", "revolute"])
def test_a_spring_and_damper_give_the_damped_oscillator(kind):
    stiffness, damping, rest = 8.0, 0.2, 0.3
    system = wheel(
        kind, springs={"s": JointSpring(joint="axle", stiffness=stiffness, damping=damping, rest_angle=rest)}
    )
    run = simulate(system, duration=3.0, settings=TIGHT)
    t = run.data["time"].values
    decay = damping / (2 * INERTIA)
    omega = math.sqrt(stiffness / INERTIA - decay**2)
    exact = rest - rest * np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    assert run.data["motion_angle"].sel(joint="axle").values == pytest.approx(exact, abs=1e-11)
    lost = run.data["dissipation_damper"].sel(spring="s").values[-1]
    stored = run.data["kinetic_energy"].values[-1] + run.data["spring_energy"].values[-1]
    assert lost + stored == pytest.approx(0.5 * stiffness * rest**2, rel=1e-11, abs=0.0)
    # Some hundred steps at 1e-12, of what was stored at the start.
    assert run.summary()["conservation"]["energy_error"] < 1e-10 * 0.5 * stiffness * rest**2


def test_sine_table_and_callable_drive_the_same_motion():
    amplitude, frequency = 2.0, 1.5
    sine = SineDrive(joint="axle", amplitude=amplitude, frequency=frequency)
    times = np.linspace(0.0, 1.0, 2001)
    values = amplitude * np.sin(2 * np.pi * frequency * times)
    drives = {
        "sine": sine,
        "callable": CallableDrive(
            joint="axle", torque=lambda t, angle, rate: amplitude * math.sin(2 * math.pi * frequency * t)
        ),
        "linear": TableDrive(joint="axle", time=tuple(times), torque=tuple(values)),
        "cubic": TableDrive(joint="axle", time=tuple(times), torque=tuple(values), interpolation="cubic"),
    }
    w = 2 * np.pi * frequency
    final = {
        name: simulate(wheel(drives={"d": drive}), duration=1.0, settings=TIGHT).data
        for name, drive in drives.items()
    }
    exact = amplitude / (INERTIA * w) * (1.0 - math.sin(w) / w)
    for name, bound in (
        ("sine", 1e-11),
        ("callable", 1e-11),
        ("linear", 1e-5),  # chords of an arc: (w dt)^2 / 12 = 2e-6 of the torque
        ("cubic", 1e-5),  # monotone slopes are of second order at the extrema
    ):
        angle = final[name]["motion_angle"].values[-1, 0]
        assert angle == pytest.approx(exact, rel=bound, abs=0.0), name
    work = final["sine"]["drive_work"].values[-1, 0]
    assert work == pytest.approx(final["sine"]["kinetic_energy"].values[-1], rel=1e-10, abs=0.0)
    assert final["sine"]["drive_gross_work"].values[-1, 0] >= abs(work)


def test_a_linear_table_is_integrated_exactly_in_a_few_long_steps():
    """Between its points angle and work are polynomials: a step across a point loses what shows at once."""
    times, values = (0.0, 0.13, 0.41, 0.77, 1.0), (0.5, 2.0, 0.3, 1.7, 0.2)
    drive = TableDrive(joint="axle", time=times, torque=values)
    loose = ErrorScales(**dict.fromkeys(("angle", "velocity", "angular_velocity"), 1e12))
    coarse = RunSettings(rtol=0.5, scales=loose, first_step=1.0, max_step=1.0, output_rate=1.0)
    run = simulate(wheel(drives={"d": drive}), duration=1.0, settings=coarse)
    assert run.counts.accepted <= 2 * (len(times) - 1)
    rate = angle = 0.0
    for h, a, b in zip(np.diff(times), values[:-1], values[1:], strict=True):
        angle += rate * h + (a / 3.0 + b / 6.0) * h**2 / INERTIA
        rate += 0.5 * (a + b) * h / INERTIA
    # Round-off of eight steps of a method that is exact for these polynomials.
    assert run.data["motion_rate"].values[-1, 0] == pytest.approx(rate, rel=1e-13, abs=0.0)
    assert run.data["motion_angle"].values[-1, 0] == pytest.approx(angle, rel=1e-13, abs=0.0)
    work = run.data["drive_work"].values[-1, 0]
    assert work == pytest.approx(0.5 * INERTIA * rate**2, rel=1e-13, abs=0.0)


def test_samples_are_at_the_rate_and_at_all_events_and_peaks():
    run = simulate(load_scenario("bai2020", case="case3"), duration=0.05)
    times = run.data["time"].values
    assert (np.diff(times) > 0.0).all()
    for moment in np.arange(51) / 1000.0:
        assert abs(times - moment).min() < 1e-15
    for name in ("onset_time", "release_time", "peak_time"):
        events = run.data[name].values
        for moment in events[np.isfinite(events)]:
            assert abs(times - moment).min() < 1e-15
    # So the largest sampled force of a contact is the largest of its episodes.
    for number, name in enumerate(run.data["contact"].values):
        mine = run.data["peak_force"].values[run.data["episode_contact"].values == number]
        sampled = run.data["normal_force"].sel(contact=name).values.max()
        assert sampled == pytest.approx(mine.max(initial=0.0), rel=1e-9, abs=0.0)


def test_ctrl_c_ends_cleanly_and_keeps_what_was_computed():
    pressed = []

    def press(progress):
        if not pressed and progress.steps > 20:
            pressed.append(progress.time)
            os.kill(os.getpid(), signal.SIGINT)

    before = signal.getsignal(signal.SIGINT)
    run = simulate(load_scenario("bai2020", case="case3"), duration=1000.0, progress=press)
    assert run.outcome is Outcome.INTERRUPTED
    assert 0.0 < run.data["time"].values[-1] < 1000.0
    assert run.summary()["conservation"]["linear_momentum_drift_relative"] < 1e-8
    assert signal.getsignal(signal.SIGINT) is before


def test_a_state_that_stops_being_finite_ends_the_run_and_says_where():
    drive = CallableDrive(joint="axle", torque=lambda t, angle, rate: 1.0 if t < 0.5 else math.nan)
    run = simulate(wheel(drives={"d": drive}), duration=1.0, settings=TIGHT)
    assert run.outcome is Outcome.FUNCTION_FAILED
    assert "at t = 0.5" in run.message or "at t = 0.49" in run.message
    assert np.isfinite(run.data["q"].values).all()


def test_a_step_that_collapses_ends_the_run_and_says_what_to_try():
    system = wheel(drives={"d": SineDrive(joint="axle", amplitude=1e3, frequency=1e3)})
    run = simulate(system, duration=1.0, settings=RunSettings(rtol=1e-12, min_step=1e-3, first_step=1e-2))
    assert run.outcome is Outcome.STEP_TOO_SMALL
    assert "integrator.min_step" in run.message


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("rtol", 0.0),
        ("max_step", math.inf),
        ("output_rate", -1.0),
        ("min_step", math.nan),
        ("method", "euler"),
    ],
)
def test_settings_are_checked(key, value):
    with pytest.raises(AntennaPinError, match=key):
        RunSettings(**{key: value})


def test_a_system_needs_a_duration_and_a_finite_state():
    system = build_system(load_scenario("bai2020", case="case1"))
    with pytest.raises(AntennaPinError, match="duration"):
        simulate(system)
    with pytest.raises(AntennaPinError, match="14 finite numbers|9 finite numbers"):
        simulate(system, duration=1.0, q=np.full(system.model.nq, np.nan))
    with pytest.raises(AntennaPinError, match="duration"):
        simulate(system, duration=-1.0)


def test_what_is_given_beside_a_scenario_enters_the_result():
    """The scenario of a result repeats the run, whatever came from Python."""
    scenario = load_scenario("bai2020", case="case1")
    settings = RunSettings(rtol=1e-6, output_rate=500.0, scales=ErrorScales(angle=2e-3))
    run = simulate(scenario, duration=0.02, settings=settings)
    told = run.scenario
    assert (told.duration, told.integrator.rtol, told.output.rate) == (0.02, 1e-6, 500.0)
    assert told.integrator.scales.angle == 2e-3
    assert told.overrides == (
        "duration=0.02",
        "integrator.rtol=1e-06",
        "output.rate=500.0",
        "integrator.scales.angle=0.002",
    )
    again = simulate(told)
    assert np.array_equal(again.data["q"], run.data["q"])
    assert simulate(told).scenario == told
    assert "start" not in run.data.attrs


def test_a_start_given_beside_a_scenario_is_said():
    scenario = load_scenario("bai2020", case="case1")
    start = build_system(scenario).neutral()
    run = simulate(scenario, duration=0.002, q=start)
    assert run.data.attrs["start"] == "given in Python: the first sample"


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_a_run_is_looked_at_however_much_it_samples(monkeypatch, engine):
    """Steps of ten samples pause within, where the buffer is full: they are ended, and it is looked at."""
    monkeypatch.setattr("antenna_pin.run.simulation.loop._INTERVAL", 0.0)
    scenario = load_scenario("bai2020", case="case1", overrides=[f"integrator.engine={engine}"])
    seen = [0]
    run = simulate(scenario, duration=40.0, progress=lambda now: seen.append(now.steps))
    assert max(np.diff(seen)) <= 64 < run.counts.accepted  # where 256 samples are full, and a step more
