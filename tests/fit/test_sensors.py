"""What sensors read: specific force, filters, encoders, force cells; and what curves are compared by."""

import numpy as np
import pytest
from scipy import signal

from antenna_pin import load_scenario
from antenna_pin.analysis import quantity
from antenna_pin.studies.fit.runs import PreparedScenario
from antenna_pin.studies.fit.sensors import (
    compared_numbers,
    comparison_target,
    filter_response,
    input_of_acceleration,
    input_of_values,
    reading,
    reading_noise,
    sample_times,
)
from antenna_pin.studies.fit.specs import ColumnSpec

TIME = np.linspace(0.01, 0.3, 59)


def seen(scenario, times, until):
    bench = PreparedScenario(scenario)
    data = bench.data(bench.run(times, until).chunk)
    return data.isel(time=np.isin(data["time"].values, times))


@pytest.fixture(scope="module")
def swing():
    """The bar of the pendulum on an ideal hinge, let go at 10 degrees."""
    return seen(load_scenario("pendulum", case="ideal"), TIME, 0.3)


def test_accelerometer_reads_the_specific_force_of_a_swing(swing):
    """Along the bar it is omega^2 r + g cos; across it alpha r + g sin: what a plumb bob's owner feels."""
    angle, rate, acceleration = (
        swing[f"motion_{name}"].sel(joint="hinge").values for name in ("angle", "rate", "acceleration")
    )
    at_tip = {"sensor": "accelerometer", "link": "bar", "point": [0, 0, "-0.4 m"], "sd": 1.0}
    along = ColumnSpec(**at_tip, direction=(0.0, 0.0, 1.0))
    across = ColumnSpec(**at_tip, direction=(1.0, 0.0, 0.0))
    data, g = swing, 9.80665
    # Round-off of numbers of the size of g.
    np.testing.assert_allclose(
        reading(data, along, "m/s^2", TIME), 0.4 * rate**2 + g * np.cos(angle), rtol=1e-12
    )
    np.testing.assert_allclose(
        reading(data, across, "m/s^2", TIME), -0.4 * acceleration - g * np.sin(angle), atol=1e-12
    )
    without = ColumnSpec(**at_tip, direction=(0.0, 0.0, 1.0), gravity=False)
    np.testing.assert_allclose(reading(data, without, "m/s^2", TIME), 0.4 * rate**2, atol=1e-13)


def test_force_cell_reads_what_holds_the_bar(swing):
    """Along the bar the hinge carries m (g cos + omega^2 l)."""
    data = swing
    angle, rate = (data[f"motion_{name}"].sel(joint="hinge").values for name in ("angle", "rate"))
    cell = ColumnSpec(sensor="force-cell", joint="hinge", link="bar", direction=(0.0, 0.0, 1.0), sd=1.0)
    expected = 1.872 * (9.80665 * np.cos(angle) + 0.2 * rate**2)
    np.testing.assert_allclose(reading(data, cell, "N", TIME), expected, rtol=1e-12)  # round-off


def test_encoder_that_rounds_down_is_half_a_step_behind(swing):
    data = swing
    encoder = {"sensor": "encoder", "of": "motion_angle[hinge]", "resolution": "1 deg", "sd": "1e-9 deg"}
    nearest, down = ColumnSpec(**encoder), ColumnSpec(**encoder, rounding="down")
    step = np.radians(1.0)
    difference = reading(data, nearest, "rad", TIME) - reading(data, down, "rad", TIME)
    np.testing.assert_allclose(difference, 0.5 * step, rtol=1e-12)
    true = np.linspace(0.0, 10.0 * step, 100001)
    assert reading_noise(nearest, "rad") == pytest.approx(
        np.std(step * np.round(true / step) - true), rel=1e-3
    )


@pytest.mark.parametrize("order", [1, 2, 4, 8])
def test_filter_is_butterworths_at_its_corner(order):
    corner, omega = 100.0, 2.0 * np.pi * 100.0
    rows = np.linspace(0.1, 0.2, 777)  # after ten periods
    poles, gain = signal.butter(order, omega, analog=True, output="zpk")[1:]
    wanted = (gain / np.prod(1j * omega - poles) * np.exp(1j * omega * rows)).imag
    values = np.linspace(0.0, 0.2, 64 * 20 + 1)
    # Straight between 64 values in a period: (2 pi / 64)^2 / 12 = 8.0e-4 of an amplitude of 1/sqrt 2.
    found = filter_response(input_of_values(values, np.sin(omega * values)), rows, corner, order)
    np.testing.assert_allclose(found, wanted, atol=6e-4)
    time = np.linspace(0.0, 0.2, 24 * 20 + 1)
    along = np.tile([0.0, 1.0, 0.0], (len(time), 1))
    motion = [
        along * one[:, None]
        for one in (-np.sin(omega * time) / omega**2, -np.cos(omega * time) / omega, np.sin(omega * time))
    ]
    given = input_of_acceleration(time, along, *motion, np.zeros(3))
    # The moments of 24 steps in a period: (2 pi / 24)^4 / 720 = 7e-6; of the first order, which passes what
    # jumps, (2 pi / 24)^3 / 24.
    found = filter_response(given, rows, corner, order)
    np.testing.assert_allclose(found, wanted, atol=8e-4 if order == 1 else 3e-5)


def test_filter_is_at_rest_under_its_first_input():
    """As the reading of an accelerometer that has felt its weight since it was switched on."""
    time = 1e-4 * np.arange(50)
    given = input_of_values(time, np.full(50, 9.81))
    np.testing.assert_allclose(filter_response(given, time, 100.0, 4), 9.81, rtol=1e-12)  # round-off


def test_filtered_accelerometer_keeps_the_impulse_of_blows():
    """What a reading comes to over time is the change of velocity, though no sample may lie in a blow."""
    scenario = load_scenario("impact_pair").with_overrides({"clearance.bore.geometry": "closed-form"})
    column = ColumnSpec(
        sensor="accelerometer", link="disc", direction=(1.0, 0.0, 0.0), gravity=False, sd=1.0,
        filter={"corner": "2 kHz", "order": 2},
    )  # fmt: skip
    rows = np.linspace(0.0, 0.003, 3001)
    grid = sample_times(column, rows)
    data = seen(scenario, grid, 0.003)
    velocity = quantity(data, "body_velocity[disc].x").values
    read = reading(data, column, "m/s^2", rows)
    assert np.ptp(velocity) > 0.01  # there was a blow
    # Of a low-pass filter at rest at both ends all comes out that goes in; the blow is 2 ms before the end,
    # 17 decay times, and the sum of rows errs by next to nothing.
    assert np.trapezoid(read, rows) == pytest.approx(velocity[-1] - velocity[0], rel=1e-3)


def test_a_filtered_accelerometer_turns_with_its_link():
    """Velocity and position along axes that turn pass as what is read without a filter does."""
    at_tip = {"sensor": "accelerometer", "link": "bar", "point": [0, 0, "-0.4 m"], "sd": 1.0}
    column = ColumnSpec(**at_tip, direction=(0.6, 0.0, 0.8), filter={"corner": "20 Hz", "order": 2})
    plain = ColumnSpec(**at_tip, direction=(0.6, 0.0, 0.8))
    grid = sample_times(column, TIME)
    data = seen(load_scenario("pendulum", case="ideal"), grid, 0.3)
    expected = filter_response(input_of_values(grid, reading(data, plain, "m/s^2", grid)), grid, 20.0, 2)
    # What is straight between samples, 2 ms apart, is off by step^2 / 12 times a second derivative, 2e-5
    # here; axes of a step's end would be off by half a step times the rate, 4e-4 of 9.8 / 3.
    late = grid > 0.15
    found = reading(data, column, "m/s^2", grid)
    np.testing.assert_allclose(found[late], expected[late], rtol=0, atol=3e-5)


# --- what curves are compared by ---


def test_band_powers_are_those_of_sines_and_share_out_the_variance():
    time = np.arange(8192) / 1024.0
    curve = 3.0 * np.sin(2.0 * np.pi * 40.0 * time) + 1.0 * np.sin(2.0 * np.pi * 200.0 * time)
    column = ColumnSpec(
        of="x", compare="spectrum", spectrum={"edges": [20.0, 100.0, 400.0], "segment": "1 s"}
    )
    # Of an amplitude a the power is a^2 / 2; both lines lie in their bands' midst.
    np.testing.assert_allclose(np.exp(compared_numbers(column, "m", time, curve)), [4.5, 0.5], rtol=1e-3)


def test_noise_of_band_powers_is_what_records_scatter():
    column = ColumnSpec(
        of="x", compare="spectrum", spectrum={"edges": [50.0, 100.0, 200.0], "segment": "0.25 s"}
    )
    noise, time = np.random.default_rng(0), np.arange(4096) / 1024.0
    found = [compared_numbers(column, "m", time, noise.standard_normal(4096)) for _ in range(400)]
    stated = comparison_target(column, "m", time, noise.standard_normal(4096), "x").sd / np.sqrt(2.0)
    # The deviation of 400 draws is known to 1 / sqrt(800) = 4 %; counting lines of Hann's window as 2 of 3 is
    # right to some 10 %.
    np.testing.assert_allclose(np.std(found, axis=0), stated, rtol=0.2)


def test_blows_are_counted_in_parts_that_move_without_jumps():
    """By size, impulse and interval."""
    column = ColumnSpec(of="x", compare="blows", blows={"level": 1.0, "edges": [1.0, 10.0, 100.0, 1000.0]})
    time = np.arange(100) / 100.0
    curve = np.zeros(100)
    curve[[10, 30, 50]] = 20.0, -200.0, 20.0
    counts = (compared_numbers(column, "N", time, curve) / 2.0) ** 2 - 0.375
    assert counts.sum() == pytest.approx(3.0)  # each blow once
    moved = compared_numbers(column, "N", time, curve * (1.0 + 1e-6))
    assert 0.0 < np.abs(moved - compared_numbers(column, "N", time, curve)).max() < 1e-5
    time = np.arange(1000) / 1000.0
    curve = np.where((time % 0.1 > 0.05) & (time % 0.1 < 0.0595), 4.0, 0.0)
    intervals = ColumnSpec(
        of="x", compare="blows", blows={"level": 1.0, "of": "intervals", "edges": [0.05, 0.08, 0.2]}
    )
    counts = (compared_numbers(intervals, "N", time, curve) / 2.0) ** 2 - 0.375
    assert counts.sum() == pytest.approx(9.0)  # ten blows, nine times between
    impulses = ColumnSpec(
        of="x", compare="blows", blows={"level": 1.0, "of": "impulses", "edges": [0.01, 0.03, 0.05]}
    )
    counts = (compared_numbers(impulses, "N", time, curve) / 2.0) ** 2 - 0.375
    assert counts.sum() == pytest.approx(10.0)  # 4 N for 9 ms each
