"""Laws, drives and motions that are compiled functions of a user's: as the built-in ones, in both engines."""

import dataclasses
import math
import pickle
import subprocess
import sys

import numba
import numpy as np
import pytest
from wheel import wheel_urdf

from antenna_pin import RunSettings, System, build_mechanism, load_scenario, simulate
from antenna_pin.contact import Coulomb, CustomFriction, CustomNormal, DampedContact, FloresDamping, Hertz
from antenna_pin.elements import CallableDrive, CallableMotion, SineDrive
from antenna_pin.errors import InvalidParameterError
from antenna_pin.scenario.assemble import build_system, initial_state

STIFFNESS, EXPONENT, RESTITUTION = 1e10, 1.5, 0.8
KNOWN = DampedContact(
    elastic=Hertz(stiffness=STIFFNESS, exponent=EXPONENT), dissipation=FloresDamping(restitution=RESTITUTION)
)
CHI = 8.0 * (1.0 - RESTITUTION) / (5.0 * RESTITUTION)  # of Flores et al.


@numba.njit
def whole(depth, rate, speed):
    return STIFFNESS * depth**EXPONENT * (1.0 + CHI * rate / speed)


@numba.njit
def elastic(depth):
    return STIFFNESS * depth**EXPONENT


@numba.cfunc("float64(float64)")
def energy(depth):
    return STIFFNESS * depth ** (EXPONENT + 1.0) / (EXPONENT + 1.0)


@numba.njit
def coefficient(speed):
    return 0.1 * speed / math.sqrt(speed**2 + 1e-4)


@numba.njit
def torque(t, angle, rate):
    return 0.3 * math.sin(20.0 * t)


OWN = CustomNormal(force=whole, elastic_force=elastic, elastic_energy=energy)


def pair(radial, friction):
    """A journal thrown into its bore."""
    scenario = load_scenario("impact_pair", case="planar")
    made = build_system(scenario)
    joint = dataclasses.replace(
        made.clearances[0], radial=radial, axial=None, friction=friction, backend="closed-form"
    )
    return System(made.mechanism, clearances=[joint]), initial_state(scenario, made)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_a_law_is_the_built_in_law_that_it_repeats(engine):
    settings = RunSettings(output_rate=1e4, engine=engine, rtol=1e-10)
    runs = []
    for law, friction in (
        (OWN, CustomFriction(coefficient=coefficient)),
        (KNOWN, Coulomb(coefficient_of_friction=0.1, regularisation_speed=1e-2)),
    ):
        system, (q, v) = pair(law, friction)
        v = v + np.array([*np.zeros(len(v) - 3), 0.0, 0.02, 1.0])  # askew, so that there is friction
        runs.append(simulate(system, duration=0.01, q=q, v=v, settings=settings))
    own, known = runs
    assert own.data.sizes["episode"] == known.data.sizes["episode"] > 0
    # The same arithmetic but for the order of products; impacts make a hundredfold of round-off.
    for name in ("peak_force", "impulse", "dissipated", "onset_time"):
        assert own.data[name].values == pytest.approx(known.data[name].values, rel=1e-9)
    assert abs(own.data["energy_error"]).max() < 1e-7 * own.data["kinetic_energy"][0]


def bar(**drives):
    return System(build_mechanism(wheel_urdf(inertia=1.0, joint="pivot"), "fixed"), drives=drives)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_a_drive_is_the_sine_that_it_repeats(engine):
    settings = RunSettings(engine=engine, max_step=0.01)
    own = CallableDrive(joint="pivot", torque=torque)
    known = SineDrive(joint="pivot", amplitude=0.3, frequency=20.0 / (2.0 * math.pi))
    angles = [
        simulate(bar(motor=drive), duration=1.0, settings=settings).data.motion_angle.values[:, 0]
        for drive in (own, known)
    ]
    assert np.abs(angles[0] - angles[1]).max() < 1e-8  # both errors of the tolerance


@numba.njit
def swing(t):
    return 0.5 * math.sin(3.0 * t)


@numba.njit
def swing_rate(t):
    return 1.5 * math.cos(3.0 * t)


@numba.njit
def swing_acceleration(t):
    return -4.5 * math.sin(3.0 * t)


@pytest.mark.parametrize("engine", ["pinocchio", "compiled"])
def test_a_motion_is_followed(engine):
    motion = CallableMotion(
        joint="pivot", position=swing, velocity=swing_rate, acceleration=swing_acceleration
    )
    run = simulate(bar(motor=motion), duration=1.0, v=[1.5], settings=RunSettings(engine=engine))
    times = run.data.time.values
    assert np.abs(run.data.motion_angle.values[:, 0] - 0.5 * np.sin(3.0 * times)).max() < 1e-12
    # The arm's inertia is 1 kg m^2.
    assert run.data.drive_torque.values[:, 0] == pytest.approx(-4.5 * np.sin(3.0 * times), abs=1e-9)


def test_pickled_systems_with_their_functions_and_states_go_on_in_another_process():
    """Places of functions there are others."""
    asked = load_scenario("bai2020", case="case3", overrides=["clearance.elevation.geometry=closed-form"])
    state = simulate(asked, duration=0.02).end
    sent = [(bar(motor=CallableDrive(joint="pivot", torque=torque)), None, 0.1)]
    sent.append((build_system(asked), state, 0.01))
    run = "simulate(system, start=start, duration=span, settings=RunSettings(engine='compiled')).end"
    script = (
        "import sys, pickle; from antenna_pin import RunSettings, simulate; "
        "padding = [bytearray(1 << 20) for _ in range(7)]; sent = pickle.load(sys.stdin.buffer); "
        f"pickle.dump([{run} for system, start, span in sent], sys.stdout.buffer)"
    )
    command = [sys.executable, "-c", script]
    found = subprocess.run(command, input=pickle.dumps(sent), capture_output=True, check=True)
    compiled = RunSettings(engine="compiled")
    expected = [simulate(system, start=s, duration=t, settings=compiled).end for system, s, t in sent]
    assert pickle.loads(found.stdout) == expected


@numba.njit
def of_two(a, b):
    return a + b


@numba.njit
def in_words(a):
    return "much"


@pytest.mark.parametrize(
    ("wrong", "rule"), [(of_two, "function of 1 argument"), (in_words, "compiled function of 1")]
)
def test_a_function_of_another_kind_is_refused(wrong, rule):
    with pytest.raises(InvalidParameterError, match=f"coefficient must be a {rule}"):
        pair(OWN, CustomFriction(coefficient=wrong))
