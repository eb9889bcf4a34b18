"""What sensors read: specific force, filters, encoders, force cells; and what curves are compared by."""

import numpy as np
import pytest
from scipy import signal

from antenna_pin import load_scenario
from antenna_pin.analysis import quantity
from antenna_pin.fit.bench import Bench, at_times
from antenna_pin.fit.columns import ColumnSpec
from antenna_pin.fit.filters import PER_PERIOD, filtered_means, filtered_points
from antenna_pin.fit.sensors import instants, noise_of, reading
from antenna_pin.fit.statistics import compared, target_of

TIME = np.linspace(0.01, 0.3, 59)


def seen(scenario, times, until):
    bench = Bench(scenario)
    return bench.data(at_times(bench.run(times, until).chunk, times))


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
    assert noise_of(nearest, "rad") == pytest.approx(np.std(step * np.round(true / step) - true), rel=1e-3)


@pytest.mark.parametrize("order", [1, 2, 4, 8])
def test_filter_is_butterworths_at_its_corner(order):
    corner = 100.0
    step = 1.0 / (PER_PERIOD * corner)
    time = step * np.arange(20 * PER_PERIOD)
    zeros, poles, gain = signal.butter(order, 2.0 * np.pi * corner, analog=True, output="zpk")
    at_corner = gain / np.prod(2j * np.pi * corner - poles)
    wanted = (at_corner * np.exp(2j * np.pi * corner * time)).imag
    velocity = -np.cos(2.0 * np.pi * corner * time) / (2.0 * np.pi * corner)
    settled = slice(10 * PER_PERIOD, None)
    for found in (
        filtered_points(np.sin(2.0 * np.pi * corner * time), step, corner, order),
        filtered_means(np.diff(velocity) / step, step, corner, order),
    ):
        # Straight, or constant, between instants: (2 pi / 64)^2 / 12 = 8.0e-4 of an amplitude of 1/sqrt 2,
        # and what of the start is left after ten periods.
        np.testing.assert_allclose(found[settled], wanted[settled], atol=6e-4)


def test_filter_is_at_rest_under_its_first_input():
    """As the reading of an accelerometer that has felt its weight since it was switched on."""
    np.testing.assert_allclose(
        filtered_points(np.full(50, 9.81), 1e-4, 100.0, 4), 9.81, rtol=1e-12
    )  # round-off


def test_filtered_accelerometer_keeps_the_impulse_of_blows():
    """What a reading comes to over time is the change of velocity, though no sample may lie in a blow."""
    scenario = load_scenario("impact_pair").with_overrides({"clearance.bore.geometry": "closed-form"})
    column = ColumnSpec(
        sensor="accelerometer", link="disc", direction=(1.0, 0.0, 0.0), gravity=False, sd=1.0,
        filter={"corner": "2 kHz", "order": 2},
    )  # fmt: skip
    rows = np.linspace(0.0, 0.003, 3001)
    grid = instants(column, rows)
    data = seen(scenario, grid, 0.003)
    velocity = quantity(data, "body_velocity[disc].x").values
    read = reading(data, column, "m/s^2", rows)
    assert np.ptp(velocity) > 0.01  # there was a blow
    # Of a low-pass filter at rest at both ends all comes out that goes in; the blow is 2 ms before the end,
    # 17 decay times, and the sum of rows errs by next to nothing.
    assert np.trapezoid(read, rows) == pytest.approx(velocity[-1] - velocity[0], rel=1e-3)


def test_a_filtered_accelerometer_turns_with_its_link():
    """Means of the change of velocity, along the mean axes, are those of what it reads without a filter."""
    at_tip = {"sensor": "accelerometer", "link": "bar", "point": [0, 0, "-0.4 m"], "sd": 1.0}
    column = ColumnSpec(**at_tip, direction=(0.6, 0.0, 0.8), filter={"corner": "20 Hz", "order": 2})
    plain = ColumnSpec(**at_tip, direction=(0.6, 0.0, 0.8))
    grid = instants(column, TIME)
    data = seen(load_scenario("pendulum", case="ideal"), grid, 0.3)
    step = 1.0 / (PER_PERIOD * 20.0)
    expected = filtered_points(reading(data, plain, "m/s^2", grid), step, 20.0, 2)
    # After 0.15 s, 13 decay times, what the two begin with is 2e-6 of 7e-3. Means and averages of both ends
    # are step^2 / 12 times a second derivative apart, up to 1e-5 and 4e-7 here; axes of a step's end would be
    # off by half a step times the rate, 4e-4 of 9.8 / 3.
    late = grid > 0.15
    found = reading(data, column, "m/s^2", grid)
    np.testing.assert_allclose(found[late], expected[late], rtol=0, atol=1e-5)


# --- what curves are compared by ---


def test_band_powers_are_those_of_sines_and_share_out_the_variance():
    time = np.arange(8192) / 1024.0
    curve = 3.0 * np.sin(2.0 * np.pi * 40.0 * time) + 1.0 * np.sin(2.0 * np.pi * 200.0 * time)
    column = ColumnSpec(
        of="x", compare="spectrum", spectrum={"edges": [20.0, 100.0, 400.0], "segment": "1 s"}
    )
    # Of an amplitude a the power is a^2 / 2; both lines lie in their bands' midst.
    np.testing.assert_allclose(np.exp(compared(column, "m", time, curve)), [4.5, 0.5], rtol=1e-3)


def test_noise_of_band_powers_is_what_records_scatter():
    column = ColumnSpec(
        of="x", compare="spectrum", spectrum={"edges": [50.0, 100.0, 200.0], "segment": "0.25 s"}
    )
    noise, time = np.random.default_rng(0), np.arange(4096) / 1024.0
    found = [compared(column, "m", time, noise.standard_normal(4096)) for _ in range(400)]
    stated = target_of(column, "m", time, noise.standard_normal(4096), "x").sd / np.sqrt(2.0)
    # The deviation of 400 draws is known to 1 / sqrt(800) = 4 %; counting lines of Hann's window as 2 of 3 is
    # right to some 10 %.
    np.testing.assert_allclose(np.std(found, axis=0), stated, rtol=0.2)


def test_blows_are_counted_in_parts_that_move_without_jumps():
    column = ColumnSpec(of="x", compare="blows", blows={"level": 1.0, "edges": [1.0, 10.0, 100.0, 1000.0]})
    time = np.arange(100) / 100.0
    curve = np.zeros(100)
    curve[[10, 30, 50]] = 20.0, -200.0, 20.0
    counts = (compared(column, "N", time, curve) / 2.0) ** 2 - 0.375
    assert counts.sum() == pytest.approx(3.0)  # each blow once
    moved = compared(column, "N", time, curve * (1.0 + 1e-6))
    assert 0.0 < np.abs(moved - compared(column, "N", time, curve)).max() < 1e-5


def test_impulses_and_intervals_of_blows():
    time = np.arange(1000) / 1000.0
    curve = np.where((time % 0.1 > 0.05) & (time % 0.1 < 0.0595), 4.0, 0.0)
    intervals = ColumnSpec(
        of="x", compare="blows", blows={"level": 1.0, "of": "intervals", "edges": [0.05, 0.08, 0.2]}
    )
    counts = (compared(intervals, "N", time, curve) / 2.0) ** 2 - 0.375
    assert counts.sum() == pytest.approx(9.0)  # ten blows, nine times between
    impulses = ColumnSpec(
        of="x", compare="blows", blows={"level": 1.0, "of": "impulses", "edges": [0.01, 0.03, 0.05]}
    )
    counts = (compared(impulses, "N", time, curve) / 2.0) ** 2 - 0.375
    assert counts.sum() == pytest.approx(10.0)  # 4 N for 9 ms each
