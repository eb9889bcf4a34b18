"""A blow shorter than any sample, behind a filter: closed forms of readings, of slopes, of bands."""

import numpy as np
import pytest
from falling_ball import HEIGHT, NOISE, RESTITUTION, TIME, reading, write
from scipy.stats import chi2

from antenna_pin.studies.fit import Problem, load_fit, run_fit
from antenna_pin.studies.fit.sensors import filter_response, input_of_acceleration

# Seven heights, for which the blow is anywhere between two samples of the input.
HEIGHTS = HEIGHT + 1e-3 * np.arange(7)


@pytest.mark.parametrize("order", [2, 4])
def test_a_rigid_blow_behind_a_filter_is_read_as_its_closed_form_has_it(tmp_path, order):
    problem = Problem(load_fit(write(tmp_path, reading(1.0, 0.5, order)[0], order=order)))
    for height in HEIGHTS:
        expected = reading(height, RESTITUTION, order)[0] / 0.5
        found = problem.predictions([height, RESTITUTION])["model"].values / 0.5
        # The fall's end is found to 1e-12 s, speeds of 4.4 m/s to round-off; at the corner's rate of change.
        np.testing.assert_allclose(found, expected, atol=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("jacobian", ["differences", "equation"])
def test_slopes_follow_the_time_of_a_blow(tmp_path, jacobian):
    """A number that moves the blow within a step of the input moves the reading, smoothly."""
    path = write(tmp_path, reading(1.0, 0.5, 4)[0], more=f'jacobian = "{jacobian}"')
    problem = Problem(load_fit(path))
    for height in HEIGHTS[::3]:
        expected = reading(height, RESTITUTION, 4)[1] / 0.5
        found = problem.jacobian([height, RESTITUTION])
        # Central differences of 1e-4 of the height: (314 1/s x 22 us)^2 / 6 = 8e-6 of the slope.
        for k in range(2):
            np.testing.assert_allclose(found[:, k], expected[:, k], atol=1e-4 * np.abs(expected[:, k]).max())


def test_a_record_without_noise_is_met_and_its_bands_are_those_of_the_closed_form(tmp_path):
    fit = run_fit(load_fit(write(tmp_path, reading(HEIGHT, RESTITUTION, 4)[0])))
    assert fit.bands.chi2 < 1e-9
    np.testing.assert_allclose(fit.values, [HEIGHT, RESTITUTION], rtol=1e-9)
    slopes = reading(HEIGHT, RESTITUTION, 4)[1] / 0.5
    expected = np.sqrt(np.diag(np.linalg.inv(slopes.T @ slopes)))
    np.testing.assert_allclose(fit.bands.sd, expected, rtol=1e-4)
    assert fit.notes == ()  # 150 rows of next to nothing before the blow are no chaos


@pytest.mark.slow
def test_bands_of_noisy_records_hold_the_true_numbers(tmp_path):
    """Errors over what is stated have the chi2 of their number; bench/fit_coverage.py counts bands."""
    total = 0.0
    for seed in range(6):
        noise = NOISE * np.random.default_rng(seed).standard_normal(len(TIME))
        fit = run_fit(load_fit(write(tmp_path, reading(HEIGHT, RESTITUTION, 4)[0] + noise, start=1.003)))
        error = fit.values - [HEIGHT, RESTITUTION]
        total += float(error @ np.linalg.solve(fit.bands.covariance, error))
    # Of 12 degrees of freedom; one of ten thousand is beyond on either side.
    assert chi2.ppf(1e-4, 12) < total < chi2.ppf(1.0 - 1e-4, 12)


# --- of the filter alone ---


def _pulse(time, begin, length):
    """Return position, velocity and acceleration of a half sine of impulse 1 from ``begin`` on."""
    omega, since = np.pi / length, np.clip(time - begin, 0.0, length)
    acceleration = np.where((time >= begin) & (time < begin + length), np.sin(omega * since), 0.0)
    velocity = (1.0 - np.cos(omega * since)) / omega
    after = np.maximum(time - begin - length, 0.0) * 2.0 / omega
    position = since / omega - np.sin(omega * since) / omega**2 + after
    return [0.5 * omega * one for one in (position, velocity, acceleration)]


def _read(time, rows, *motions, order=4):
    """Return the output behind 100 Hz for the sum of some motions along z."""
    along = np.tile([0.0, 0.0, 1.0], (len(time), 1))
    total = [along * sum(one)[:, None] for one in zip(*motions, strict=True)]
    given = input_of_acceleration(time, along, *total, np.zeros(3))
    return filter_response(given, rows, 100.0, order)


@pytest.mark.parametrize("length", [0.1, 0.5, 1.0, 4.0])
def test_pulses_of_any_length_pass_as_on_a_fine_grid(length):
    step, rows = 1.0 / 2400.0, np.linspace(0.0, 0.05, 400)
    coarse, fine = np.arange(0.0, 0.0501, step), np.linspace(0.0, 0.0501, 40001)
    for begin in 0.01 + step * np.array([0.0, 0.3, 0.55, 0.9]):
        found = _read(coarse, rows, _pulse(coarse, begin, length * step))
        expected = _read(fine, rows, _pulse(fine, begin, length * step))
        # What impulse and time leave out is the second moment, of at most (0.26)^2 / 24 = 3e-3.
        np.testing.assert_allclose(found, expected, atol=3e-3 * np.abs(expected).max())


def test_impulse_and_time_of_two_blows_in_one_step_are_kept():
    """They are read as one blow, or at the step's ends, with the impulses' sum and first moment."""
    step, rows = 1.0 / 2400.0, np.linspace(0.0, 0.05, 400)
    coarse, fine = np.arange(0.0, 0.0501, step), np.linspace(0.0, 0.0501, 40001)
    for sign in (1.0, -0.9):
        blows = [(0.0101, 1.0), (0.0103, sign)]
        each = [
            [[size * one for one in _pulse(time, begin, 1e-5)] for begin, size in blows]
            for time in (coarse, fine)
        ]
        found, expected = _read(coarse, rows, *each[0]), _read(fine, rows, *each[1])
        single = _read(fine, rows, _pulse(fine, 0.0101, 1e-5))
        np.testing.assert_allclose(found, expected, atol=5e-3 * np.abs(single).max())


def test_gravity_is_read_from_the_start_on():
    time = np.arange(101) / 2400.0
    along, still = np.tile([0.6, 0.0, 0.8], (101, 1)), np.zeros((101, 3))
    given = input_of_acceleration(time, along, still, still, still, np.array([0.0, 0.0, -9.81]))
    # Three nodes of Gauss integrate exp over 0.26 to 1e-9.
    np.testing.assert_allclose(filter_response(given, time, 100.0, 4), 0.8 * 9.81, rtol=1e-9)
