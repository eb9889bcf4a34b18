"""Largest efforts of prescribed motions between samples: closed forms at output rates that miss them."""

import math

import numpy as np
import pytest

from antenna_pin import RunSettings, load_scenario, simulate
from antenna_pin.analysis import drive_loads
from antenna_pin.dynamics import System
from antenna_pin.elements import PrescribedMotion, Sine, Sum
from antenna_pin.engine import CompiledStepper
from antenna_pin.mechanism import Urdf, build_mechanism

MASS, LENGTH, INERTIA, GRAVITY = 2.0, 0.5, 0.1, 9.81
PENDULUM = f"""<robot name="pendulum"><link name="wall"/>
<joint name="hinge" type="continuous"><parent link="wall"/><child link="rod"/><axis xyz="0 1 0"/></joint>
<link name="rod"><inertial><origin xyz="0 0 {-LENGTH}"/><mass value="{MASS}"/>
<inertia ixx="{INERTIA}" iyy="{INERTIA}" izz="{INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""
WAVES = ((0.7, 1.0), (0.2, 2.6))  # amplitude [rad], frequency [Hz]: no two tops are alike


def torque(t):
    """Return what swings the pendulum as prescribed [N m]."""
    ways = [(a, 2.0 * math.pi * f) for a, f in WAVES]
    angle = sum(a * np.sin(w * t) for a, w in ways)
    acceleration = sum(-a * w**2 * np.sin(w * t) for a, w in ways)
    return (INERTIA + MASS * LENGTH**2) * acceleration + MASS * GRAVITY * LENGTH * np.sin(angle)


@pytest.fixture(scope="module")
def driven():
    """Return a function: a run of the pendulum at an output rate [Hz]."""
    motion = PrescribedMotion(
        joint="hinge", follows=Sum(parts=tuple(Sine(amplitude=a, frequency=f) for a, f in WAVES))
    )
    mechanism = build_mechanism(Urdf.from_text(PENDULUM, "pendulum.urdf"), "fixed", (0.0, 0.0, -GRAVITY))
    system = System(mechanism, drives={"swing": motion})
    rate = sum(2.0 * math.pi * a * f for a, f in WAVES)

    def run(output_rate, **options):
        settings = RunSettings(rtol=1e-10, output_rate=output_rate)
        return simulate(
            system, q=system.neutral(), v=np.array([rate]), duration=2.35, settings=settings, **options
        )

    return run


@pytest.mark.parametrize("output_rate", [7.0, 9.0, 17.0, 1000.0])
def test_the_largest_torque_is_that_of_the_closed_form(driven, output_rate):
    run = driven(output_rate)
    times = np.linspace(0.0, 2.35, 2_000_001)
    sizes = np.abs(torque(times))
    found = drive_loads(run).sel(drive="swing")
    # The grid's step is 1.2 us: (w h)^2 / 8 of the top is 1e-11; the run's tolerance is 1e-10, of a state.
    assert float(found["peak_effort"]) == pytest.approx(sizes.max(), rel=1e-8)
    # A top to 1e-8 is known in time to the root of that.
    assert float(found["time_of_peak_effort"]) == pytest.approx(times[sizes.argmax()], abs=1e-5)
    (motion,) = run.summary()["motions"].values()
    assert motion["peak_torque"] == float(found["peak_effort"])
    if output_rate < 20.0:  # samples alone miss it
        assert np.abs(run.data["drive_torque"]).max() < 0.99 * sizes.max()


def test_steps_that_come_to_nothing_leave_what_samples_say(driven, monkeypatch):
    within = CompiledStepper.attempt
    monkeypatch.setattr(CompiledStepper, "attempt", lambda stepper, h: within(stepper, h) * math.nan)
    run = driven(17.0)
    assert run.data["peak_effort"].values[0] == np.abs(run.data["drive_torque"].values).max()


def test_a_lean_result_has_the_same():
    scenario = load_scenario("slider_crank", overrides={"duration": "5 ms"})
    full, lean = (simulate(scenario.with_overrides({"output.form": form})) for form in ("full", "lean"))
    assert full.data["peak_effort"].values == lean.data["peak_effort"].values
    assert full.data["time_of_peak_effort"].values == lean.data["time_of_peak_effort"].values
    assert full.data["peak_effort"].values[0] >= np.abs(full.data["drive_torque"].values).max()
