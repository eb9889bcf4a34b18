"""The panel on a shaker under models/: what its README promises."""

import math
import tomllib

import numpy as np
import pytest
from scipy.optimize import brentq

from antenna_pin import load_scenario, models_path, simulate
from antenna_pin.analysis import (
    band_rms,
    base_loads,
    power_density,
    quantity,
    swept_response,
    transfer,
)
from antenna_pin.studies.linear import frequency_response, modes

CASES = tomllib.loads((models_path() / "shaker" / "scenario.toml").read_text())["cases"]
ABOUT, LEVER, LATCH, HARNESS, DAMPING = 0.073, 0.24, 400.0, 2.0, 0.25
HALF, BASE = 2e-3, 0.2 * 9.80665
TIP = "body_acceleration[tip].y"


def tip_response(frequency, stiffness):
    """Acceleration of the tip over the base's, of small motions without play."""
    s = 2j * np.pi * np.asarray(frequency)
    return 1.0 - 0.4 * LEVER * s**2 / (ABOUT * s**2 + DAMPING * s + stiffness)


def test_modes_of_the_tight_latch_are_the_closed_form():
    found = modes(load_scenario("shaker", case="tight"))
    assert found.frequency == pytest.approx([math.sqrt(402.0 / ABOUT) / (2 * math.pi)], rel=1e-9)
    grid = np.array([5.0, 11.0, 11.8, 20.0])
    answer = frequency_response(found, "shake.y", TIP, grid).response.values[:, 0]
    assert np.abs(answer / tip_response(grid, 402.0) - 1).max() < 1e-8  # of differences of forces


def test_a_second_of_the_pin_closes_its_ledger():
    """Impacts in the pin, and the latch about it: loads at the base are those of its bodies."""
    run = simulate(load_scenario("shaker", case="pin"), duration=0.3)
    assert run.completed, run.message
    assert run.data.sizes["episode"] > 5
    assert float(np.abs(run.data.energy_error).max()) < 1e-6 * float(run.data.kinetic_energy.max())
    force = base_loads(run).force.values[:, 1]
    base = quantity(run, "body_acceleration[fixture].y").values
    panel, turn, rate = (
        quantity(run, f"body_{what}[panel].{axis}").values
        for what, axis in (("acceleration", "y"), ("angular_acceleration", "z"), ("angular_velocity", "z"))
    )
    # The panel's mass centre is 0.2 m from its frame, along its x, which points ahead to 1e-3.
    attitude = np.unwrap(quantity(run, "motion_angle[hinge]").values)
    centre = panel + 0.2 * (turn * np.cos(attitude) - rate**2 * np.sin(attitude))
    needed = 4.0 * base + 1.2 * centre
    # Its tilt in the play, 1e-4, leaves the second order of that, and what turns it across.
    assert np.abs(force - needed).max() < 1e-3 * np.abs(needed).max()


@pytest.mark.slow
def test_the_tight_panel_follows_its_small_motions():
    """Swept at 2 octaves a minute; at the peak it lags, as it must, beside it by a hundredth."""
    run = simulate(load_scenario("shaker", case="tight"))
    found = swept_response(run, TIP)
    frequency = found["frequency"].values
    exact = np.abs(tip_response(frequency, 402.0))
    off = np.abs(found["gain"].values / exact - 1)
    beside = ((frequency < 10.0) | (frequency > 14.0)) & (found["time"].values > 3.0)
    assert beside.sum() > 60
    assert off[beside].max() < 0.02
    # Peaks are a fiftieth to a twentieth lower, and shifted with the way by some tenths of a hertz.
    for way in (1, -1):
        one = found.isel(window=np.flatnonzero(found["way"].values == way))
        at = int(np.argmax(one["gain"].values))
        assert float(one["gain"][at]) == pytest.approx(exact.max(), rel=0.15)
        assert 0.0 < way * (float(one["frequency"][at]) - 11.81) < 0.4


@pytest.mark.slow
def test_play_makes_the_answer_jump():
    """Up at the end of the upper branch, down at that of the lower one, by harmonic balance.

    The balance leaves out harmonics (a hundredth of the frequency); the windows are 0.9 s long, in which the
    sweep goes 0.25 Hz.
    """
    found = swept_response(simulate(load_scenario("shaker", case="play")), "motion_angle[hinge]")

    def squared(size):
        ratio = min(HALF / size, 1.0)
        share = 1 - 2 / math.pi * (math.asin(ratio) + ratio * math.sqrt(1 - ratio**2))
        return (HARNESS + LATCH * share) / ABOUT

    top = brentq(lambda a: a * DAMPING * math.sqrt(squared(a)) - LEVER * BASE, 1.01 * HALF, 0.1)
    up, down = (found.isel(window=np.flatnonzero(found["way"].values == way)) for way in (1, -1))
    at = int(np.argmax(up["amplitude"].values))
    assert float(up["amplitude"][at]) == pytest.approx(top, rel=0.07)
    assert float(up["frequency"][at]) == pytest.approx(math.sqrt(squared(top)) / (2 * math.pi), abs=0.3)
    # The upper frequency of each amplitude; its least is where the lower branch ends.
    sizes = np.linspace(1.001 * HALF, 2 * HALF, 2000)
    ends = []
    for size in sizes:
        b = (DAMPING / ABOUT) ** 2 - 2 * squared(size)
        rest = b * b - 4 * (squared(size) ** 2 - (LEVER * BASE / (ABOUT * size)) ** 2)
        ends.append(math.sqrt((-b + math.sqrt(rest)) / 2) / (2 * math.pi))
    jump = down["frequency"].values[np.flatnonzero(down["amplitude"].values > 2 * HALF)[0]]
    assert jump == pytest.approx(min(ends), abs=0.3)
    inside = (down["frequency"].values > 9.5) & (down["frequency"].values < 11.0)
    assert down["amplitude"].values[inside].max() < HALF  # it rattles in the play, where up it swings


@pytest.mark.slow
def test_play_broadens_the_random_answer():
    """Without play the mean square is the integral of the response; with play it stays, elsewhere."""
    runs = {case: simulate(load_scenario("shaker", case=case)) for case in ("tight-random", "random")}
    found, coherence = {}, {}
    for case, run in runs.items():
        one = quantity(run, TIP)
        density = power_density(one.time, one.values, units=one.units, segment=4.0)
        found[case] = band_rms(density, [(3.0, 100.0), (3.0, 9.0)])
        cause = quantity(run, "body_acceleration[fixture].y").values
        both = transfer(one.time, cause, one.values, segment=4.0)
        near = (both["frequency"] > 8.0) & (both["frequency"] < 14.0)
        coherence[case] = float(both["coherence"].values[near.values].mean())
    shake = load_scenario("shaker", case="random").shake["y"].build()
    from antenna_pin.elements import density_at

    f = np.linspace(3.0, 100.0, 400001)
    square = np.abs(tip_response(f, 402.0)) ** 2 * density_at(f, shake.frequency, shake.density)
    for k, high in enumerate((100.0, 9.0)):
        exact = math.sqrt(np.trapezoid(square[f <= high], f[f <= high]))
        error = 3 * float(found["tight-random"]["standard_error"][k])
        assert float(found["tight-random"]["rms"][k]) == pytest.approx(exact, abs=error)
    low = [float(found[case]["rms"][1]) for case in ("tight-random", "random")]
    errors = [float(found[case]["standard_error"][1]) for case in ("tight-random", "random")]
    assert low[1] - low[0] > 3 * math.hypot(*errors)
    assert coherence["random"] < 0.85 < 0.93 < coherence["tight-random"]
