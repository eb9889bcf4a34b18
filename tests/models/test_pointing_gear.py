"""The pointing drive under models/: its limit cycle beside what its describing function predicts."""

import tomllib
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import fsolve

from antenna_pin import load_scenario, models_path, simulate
from antenna_pin.analysis import gear_contacts, gear_impacts
from antenna_pin.elements import kernels, kind_of
from antenna_pin.scenario.assemble import build_system

ROTOR, DISH, RATIO = 2e-5, 0.5, 100.0
CASES = list(tomllib.loads((models_path() / "pointing_gear" / "scenario.toml").read_text())["cases"])


def predicted(scenario):
    """Return amplitude of the dish [rad] and frequency [Hz] of the cycle that describing functions foresee.

    Of a deflection A sin(w t) the first harmonic of the teeth's torque is N(A) times it. With it for the
    stiffness the loop stands on the limit of stability: its characteristic polynomial has the root i w.
    """
    system = build_system(scenario)
    gear, controller = system.families["gears"]["train"], system.drives["controller"]
    motor, bearing = system.springs["back_emf"].damping, system.springs["bearing"].damping
    number, words = kind_of(type(gear)), gear.words_of_kernel()
    phase = (np.arange(2000) + 0.5) * np.pi / 1000

    def stiffness(amplitude, omega):
        x, rate = amplitude * np.sin(phase), amplitude * omega * np.cos(phase)
        torque = [-kernels.effort(number, words, 0, 0.0, *one) for one in zip(x, rate, strict=True)]
        return complex(2j * np.mean(torque * np.exp(-1j * phase)) / amplitude)

    def sides(omega, k):
        """The dish for one of the deflection; the polynomial."""
        s = 1j * omega
        dish = DISH * s**2 + bearing * s
        rotor = RATIO**2 * (ROTOR * s**2 + motor * s)
        control = RATIO * (controller.kp + controller.kd * s)
        return k / dish, (rotor + k) * (dish + k) - k * (k - control)

    def lack(unknown):
        amplitude, omega = np.exp(unknown)
        found = sides(omega, stiffness(amplitude, omega))[1] / (ROTOR * RATIO**2 * DISH * omega**4)
        return found.real, found.imag

    amplitude, omega = np.exp(fsolve(lack, np.log([0.8e-3, 30.0]), xtol=1e-10))
    return amplitude * abs(sides(omega, stiffness(amplitude, omega))[0]), omega / (2 * np.pi)


def seen(run):
    """Return amplitude of the dish [rad] and frequency [Hz] over the last four seconds."""
    late = run.data.time.values >= run.data.time.values[-1] - 4.0
    time, angle = run.data.time.values[late], run.data.motion_angle.sel(joint="dish").values[late]
    middle = 0.5 * (angle.max() + angle.min())
    up = np.flatnonzero((angle[:-1] < middle) & (angle[1:] >= middle))
    at = time[up] + (middle - angle[up]) / (angle[up + 1] - angle[up]) * (time[up + 1] - time[up])
    return 0.5 * (angle.max() - angle.min()), (len(at) - 1) / (at[-1] - at[0])


def told(case):
    """Return the README's row of numbers: amplitude foreseen and found [mrad], frequency likewise [Hz]."""
    lines = (models_path() / "pointing_gear" / "README.md").read_text().splitlines()
    rows = [line for line in lines if line.startswith(f"| `{case}` |") and line.count("|") == 6]
    return [float(number) for number in rows[0].split("|")[2:-1]]


@pytest.mark.parametrize(
    ("case", "amplitude", "frequency"),
    [("slower", 0.09, 0.25), ("play", 0.06, 0.09), ("faster", 0.025, 0.02), ("damped", 0.1, 0.2)],
)
def test_the_cycle_is_near_what_the_describing_function_foresees(case, amplitude, frequency):
    """The nearer to the limit of the loop without play, the more its motion is one harmonic.

    The tolerances are what higher harmonics are left out for: the method has no bound of its own.
    """
    scenario = load_scenario("pointing_gear", case=case)
    run = simulate(scenario)
    assert run.completed, run.message
    foreseen, found = predicted(scenario), seen(run)
    assert found[0] == pytest.approx(foreseen[0], rel=amplitude)
    assert found[1] == pytest.approx(foreseen[1], rel=frequency)
    # Rounded as they stand there.
    numbers = 1e3 * foreseen[0], 1e3 * found[0], foreseen[1], found[1]
    assert told(case) == [round(one, 3 if k < 2 else 2) for k, one in enumerate(numbers)]
    # It does not come to rest: either flank is met once in every period, by turns.
    late = gear_impacts(run).onset.values >= 6.0
    sides = gear_impacts(run).side.values[late].astype(str).tolist()
    assert all(one != other for one, other in pairwise(sides))
    assert len(sides) == pytest.approx(2 * 4.0 * found[1], abs=2)


@pytest.mark.parametrize("case", ["tight", "motor-side"])
def test_without_play_or_measured_at_the_motor_it_comes_to_rest(case):
    """The loop of the tight drive is stable; the motor's own loop takes energy only."""
    run = simulate(load_scenario("pointing_gear", case=case))
    rate = run.data.motion_rate.sel(joint="dish").values
    assert np.abs(rate[-200:]).max() < 1e-4 * np.abs(rate).max()
    left = run.data.motion_angle.sel(joint="dish").values[-1]
    # Seen at the motor the dish rests anywhere in the play.
    assert abs(left) < (1e-7 if case == "tight" else 0.5001e-3)


def test_spans_of_contact_fill_the_run():
    """Each begins where the one before ends; apart they are as long as the summary says."""
    run = simulate(load_scenario("pointing_gear"), duration=2.0)
    spans = gear_contacts(run, "gears.train")
    assert np.array_equal(spans.begin.values[1:], spans.end.values[:-1])
    assert (spans.begin.values[0], spans.end.values[-1]) == (0.0, 2.0)
    apart = (spans.end - spans.begin).values[spans.sides.values == "apart"].sum()
    assert run.summary()["gears"]["train"]["time_apart"] == pytest.approx(apart, rel=1e-14)
