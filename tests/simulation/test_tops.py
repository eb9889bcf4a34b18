"""Largest efforts of drives, stops and gears between samples: closed forms at output rates that miss them."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from wheel import INERTIA as WHEEL
from wheel import wheel_urdf

from antenna_pin import RunSettings, load_scenario, simulate
from antenna_pin.analysis import drive_loads
from antenna_pin.dynamics import System
from antenna_pin.elements import ConstantDrive, EndStop, Gear, PDController, PrescribedMotion, Sine, Sum
from antenna_pin.elements.control import Controller
from antenna_pin.mechanism import Urdf, build_mechanism
from antenna_pin.run.engine import CompiledStepper
from antenna_pin.trajectory import touches

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


@pytest.mark.parametrize("place", [0.2, 0.45, 0.95, 1.05, 7.7, 8.3, 14.95, 15.05, 15.45, 15.8])
def test_a_top_between_fine_samples_is_found_wherever_it_is(place):
    """In the first interval and in the last one too, beyond which there is no sample to say more.

    A wheel held to a sine, over 0.16 of a period: its one top is J A w^2, which a hundred samples in a period
    miss by up to 5e-4.
    """
    amplitude, omega, interval = 0.2, 2.0 * math.pi, 0.01
    top = place * interval
    phase = 0.5 * math.pi - omega * top
    motion = PrescribedMotion(joint="axle", amplitude=amplitude, frequency=1.0, phase=phase)
    system = System(build_mechanism(wheel_urdf("revolute"), "fixed"), drives={"swing": motion})
    run = simulate(
        system,
        q=np.array([amplitude * math.sin(phase)]),
        v=np.array([amplitude * omega * math.cos(phase)]),
        duration=16.0 * interval,
        settings=RunSettings(rtol=1e-10, output_rate=1.0 / interval),
    )
    largest = WHEEL * amplitude * omega**2
    off = omega * interval * (place - round(place))
    assert np.abs(run.data["drive_torque"]).max() < (1.0 - 0.4 * off**2) * largest  # of the cosine
    assert run.data["peak_effort"].values[0] == pytest.approx(largest, rel=1e-9)
    assert run.data["time_of_peak_effort"].values[0] == pytest.approx(top, abs=1e-5)


def test_of_fine_samples_only_the_highest_top_is_integrated_again(driven, monkeypatch):
    """Others are lower by more than a parabola is above its samples: the run's time is not spent on them."""
    times, within = [], CompiledStepper.attempt
    monkeypatch.setattr(
        CompiledStepper, "attempt", lambda stepper, h: (times.append(stepper.t), within(stepper, h))[1]
    )
    run = driven(990.0)
    assert times  # a run's own steps are made in compiled batches
    assert np.abs(np.array(times) - run.data["time_of_peak_effort"].values[0]).max() < 2.0 / 990.0


# --- elements in touch and other drives ---------------------------------------------------------------------


def wheel_system(**parts):
    """Return a wheel on a fixed axle, with elements."""
    return System(build_mechanism(wheel_urdf("revolute"), "fixed"), **parts)


def damped(stiffness, damping, rate, inertia):
    """Return largest torque of a damped spring that stops an inertia, and its time after the onset [s]."""
    decay, natural = 0.5 * damping / inertia, math.sqrt(stiffness / inertia)
    omega = math.sqrt(natural**2 - decay**2)
    times = np.linspace(0.0, 1.5 / omega, 2_000_001)
    sine, cosine, fades = np.sin(omega * times), np.cos(omega * times), np.exp(-decay * times)
    depth = rate / omega * fades * sine
    speed = rate * fades * (cosine - decay / omega * sine)
    torque = stiffness * depth + damping * speed
    return torque.max(), times[torque.argmax()]


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
@pytest.mark.parametrize("form", ["full", "lean"])
def test_a_damped_stop_presses_hardest_before_the_joint_turns_back(engine, form):
    """At few samples; the next touch begins anew, and one that lasts at the end counts."""
    stiffness, damping, rate = 400.0, 3.0, 1.3
    stop = EndStop(
        joint="axle", lower=-0.1, upper=0.1, stiffness=stiffness, law="kelvin-voigt", damping=damping
    )
    settings = RunSettings(rtol=1e-12, output_rate=11.0, engine=engine, output_form=form)
    run = simulate(
        wheel_system(elements={"stops": {"ends": stop}}), v=[rate], duration=0.9, settings=settings
    )
    first, second, *_ = touches(run.data)
    for touch in (first, second):
        largest, after = damped(stiffness, damping, touch.approach_rate, WHEEL)
        assert touch.peak_effort == pytest.approx(largest, rel=1e-8)
    changes = [str(name) for name in run.data["change"].values]
    at = run.data["change_peak_time"].values[changes.index("stop ends: upper: off")]
    assert at - first.onset == pytest.approx(damped(stiffness, damping, rate, WHEEL)[1], abs=1e-5)
    cut = simulate(
        wheel_system(elements={"stops": {"ends": stop}}), v=[rate], duration=at + 1e-4, settings=settings
    )
    (lasting,) = touches(cut.data)
    assert not lasting.ended and lasting.peak_effort == pytest.approx(first.peak_effort, rel=1e-8)


@pytest.mark.parametrize("engine", ["compiled", "pinocchio"])
def test_flanks_with_dampers_press_hardest_before_they_turn_back(engine):
    """Two wheels that mesh, with damping: the largest torque of each touch beside a run of many samples."""
    one, other = 0.02, 0.05
    gear = Gear(input="a", output="b", stiffness=50.0, damping=0.05, play=0.02)
    mechanism = build_mechanism(Urdf.from_text(pair_text(one, other), "pair.urdf"), "fixed", (0.0, 0.0, 0.0))
    system = System(mechanism, elements={"gears": {"g": gear}})

    def run(output_rate):
        settings = RunSettings(rtol=1e-12, output_rate=output_rate, engine=engine)
        return simulate(system, v=[0.3, 0.0], duration=0.6, settings=settings)

    coarse, fine = run(7.0), run(2e5)
    efforts = np.abs(fine.data["element_effort"].values[:, 0])
    found = touches(coarse.data, "gears")
    assert len(found) > 3
    for touch in found[:-1]:
        inside = (fine.data["time"].values >= touch.onset) & (fine.data["time"].values <= touch.release)
        # (w h)^2 / 8 of the top between samples.
        assert touch.peak_effort == pytest.approx(efforts[inside].max(), rel=1e-7)


def pair_text(one, other):
    """Return the URDF of two wheels on a base, with these inertias."""
    link = '<link name="{0}"><inertial><mass value="1"/><inertia ixx="{1}" iyy="{1}" izz="{1}"'
    link += ' ixy="0" ixz="0" iyz="0"/></inertial></link>'
    joint = '<joint name="{0}" type="continuous"><parent link="base"/><child link="{0}_link"/>'
    joint += '<axis xyz="0 0 1"/></joint>'
    links = link.format("base", 1.0) + link.format("a_link", one) + link.format("b_link", other)
    return f'<robot name="pair">{links}{joint.format("a")}{joint.format("b")}</robot>'


def test_a_controller_without_samples_at_its_top():
    """A PD controller that pulls a wheel back: k A, between samples."""
    kp, rate = 30.0, 0.8
    drive = PDController(joint="axle", kp=kp, kd=0.0)
    run = simulate(
        wheel_system(drives={"hold": drive}),
        v=[rate],
        duration=1.0,
        settings=RunSettings(rtol=1e-11, output_rate=3.0),
    )
    found = drive_loads(run).sel(drive="hold")
    omega = math.sqrt(kp / WHEEL)
    assert float(found["peak_effort"]) == pytest.approx(kp * rate / omega, rel=1e-8)
    assert np.abs(run.data["drive_torque"]).max() < 0.999 * kp * rate / omega


@dataclass(frozen=True)
class Kick(Controller):
    """Torque of a hundredth of a second, between samples."""

    period: float = 0.01
    commands: tuple[str, ...] = ("push",)

    def update(self, now):
        return {"push": 5.0 if abs(now.time - 0.04) < 1e-9 else 0.1}


def test_a_command_between_samples_counts():
    """Twenty samples a second, a hundred commands: the largest stands for one of them."""
    settings = RunSettings(rtol=1e-9, output_rate=20.0)
    system = wheel_system(drives={"push": ConstantDrive(joint="axle", value=0.0)})
    kick = Kick()
    run = simulate(system, duration=0.2, settings=settings, controllers={"kick": kick})
    found = drive_loads(run).sel(drive="push")
    assert float(found["peak_effort"]) == 5.0 and float(found["time_of_peak_effort"]) == pytest.approx(0.04)
    assert np.abs(run.data["drive_torque"]).max() < 1.0
