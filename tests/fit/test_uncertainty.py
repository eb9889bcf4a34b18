"""How sure fitted values are, against closed forms of linear models."""

import numpy as np
import pytest
from known_curves import Curve, decay, line, oscillator

from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.fit.uncertainty import LOSSES, autocorrelation, cost, curvature, influence, sure


def _noisy_line(times, seed, sd=0.1):
    noise = np.random.default_rng(seed).standard_normal(times.size)
    return line(times, 2.0 + 0.5 * times + sd * noise, sd)


def test_a_straight_line_has_the_covariance_of_the_textbook(times):
    """Var(slope) = s^2 / Sxx, var(intercept) = s^2 (1/m + mean^2 / Sxx), cov = -mean s^2 / Sxx."""
    model = _noisy_line(times, 1)
    found = sure(model, model.best(), noise="given")
    apart = times - times.mean()
    sxx = float(apart @ apart)
    m, sd = times.size, model.sd
    expected = sd**2 * np.array(
        [[1.0 / m + times.mean() ** 2 / sxx, -times.mean() / sxx], [-times.mean() / sxx, 1.0 / sxx]]
    )
    # Round-off of a matrix whose condition is below 100.
    assert found.covariance == pytest.approx(expected, rel=1e-12, abs=0.0)
    assert found.quantile == pytest.approx(1.959963984540054, rel=1e-14, abs=0.0)
    assert found.freedom == m - 2
    estimated = sure(model, model.best(), noise="estimated")
    s2 = found.chi_squared / (m - 2)
    assert estimated.covariance == pytest.approx(s2 * expected, rel=1e-12, abs=0.0)
    # scipy's own value of Student's t with 29 degrees of freedom, as tables have it: 2.045.
    assert estimated.quantile == pytest.approx(2.0452, abs=5e-5)


def test_scales_of_parameters_change_nothing(times):
    """A parameter in other units has the same covariance in them."""
    one = _noisy_line(times, 2)
    other = line(times, one.record, one.sd, scale=np.array([1e-4, 1e4]))
    first, second = sure(one, one.best()), sure(other, one.best())
    assert second.covariance == pytest.approx(
        first.covariance, rel=1e-9, abs=0.0
    )  # columns 1e8 apart, of which squares lose nothing


def test_intervals_hold_the_truth_as_often_as_they_say():
    """200 records of a decay: of intervals of 95 % those that miss are binomial, 10 expected, 3.1 spread.

    From 3 to 19 is what 99.8 % of such counts lie within.
    """
    times = np.linspace(0.0, 3.0, 31)
    truth = np.array([2.0, 1.3])
    missed = np.zeros(2)
    for seed in range(200):
        noise = 0.05 * np.random.default_rng(seed).standard_normal(times.size)
        model = decay(times, truth[0] * np.exp(-truth[1] * times) + noise)
        found = sure(model, model.best())
        missed += (truth < found.low) | (truth > found.high)
    assert np.all((missed >= 3) & (missed <= 19)), missed


def test_of_two_that_only_their_ratio_tells_neither_is_known(times):
    model = oscillator(times, np.cos(5.0 * times), 0.02)
    found = sure(model, model.start, noise="given")
    assert np.isinf(found.error).all() and np.isnan(found.correlation).all()
    assert (found.low == -np.inf).all() and (found.high == np.inf).all()
    assert found.freedom == times.size - 1  # one combination is known


def test_a_value_at_its_bound_is_held_and_said_so(times):
    """With the slope held, the intercept is as sure as the mean of the record."""
    model = line(times, 2.0 - 0.5 * times, 0.1, lower=np.array([-np.inf, 0.0]))
    found = sure(model, model.best(), noise="given")
    assert found.held.tolist() == [False, True]
    assert found.error[1] == 0.0
    # scipy's trust region ends within 1e-10 of a bound, and the covariance does not hang on where.
    assert found.error[0] == pytest.approx(0.1 / np.sqrt(times.size), rel=1e-12, abs=0.0)


@pytest.mark.parametrize("noise", ["given", "estimated", "correlated"])
def test_values_that_are_all_at_their_bounds_are_held(times, noise):
    """Nothing is left to be told: errors are zero, and all residuals are free."""
    model = line(times, -2.0 - 0.5 * times, 0.1, lower=np.zeros(2))
    found = sure(model, np.zeros(2), noise=noise)
    assert found.held.all() and not found.error.any() and found.freedom == times.size


@pytest.mark.parametrize("loss", LOSSES)
def test_slopes_of_losses_are_those_of_their_costs(loss):
    """By central differences: the error of h = 1e-5 is h^2 / 6 times a third derivative below 10."""
    residuals, h = np.array([-4.0, -1.2, -0.3, 0.4, 0.9, 3.0]), 1e-5
    for k in range(residuals.size):
        step = np.zeros(residuals.size)
        step[k] = h
        slope = 0.5 * (cost(residuals + step, loss, 0.7) - cost(residuals - step, loss, 0.7)) / (2.0 * h)
        assert influence(residuals, loss, 0.7)[k] == pytest.approx(slope, abs=1e-8)
        bend = (influence(residuals + step, loss, 0.7) - influence(residuals - step, loss, 0.7))[k] / (
            2.0 * h
        )
        assert curvature(residuals, loss, 0.7)[k] == pytest.approx(bend, abs=1e-8)


def test_a_robust_loss_of_clean_noise_costs_what_theory_says():
    """Huber's loss at 1.345 standard deviations has 95 % of the efficiency of least squares (1981, 4.3).

    Of 20 000 residuals the sandwich's share of its expectation spreads by about 1 %.
    """
    rng = np.random.default_rng(5)
    times = np.linspace(0.0, 1.0, 20_000)
    model = line(times, 1.0 + rng.standard_normal(times.size))
    plain = sure(model, model.best(), noise="given")
    robust = sure(model, model.best("huber", 1.345), noise="given", loss="huber", loss_scale=1.345)
    assert (plain.error / robust.error) ** 2 == pytest.approx(0.95, abs=0.04)


def test_outliers_widen_no_interval_of_a_robust_loss(times):
    """A tenth of the record 20 standard deviations off: least squares knows a fifth of what it knew."""
    clean = _noisy_line(times, 3)
    record = clean.record.copy()
    record[::10] += 2.0
    spoilt = line(times, record, clean.sd)
    before = sure(clean, clean.best())
    plain = sure(spoilt, spoilt.best())
    robust = sure(spoilt, spoilt.best("soft_l1"), loss="soft_l1")
    assert np.all(plain.error > 4.0 * before.error)
    assert np.all(robust.error < 0.5 * plain.error)


def test_what_has_no_covariance_is_refused(times):
    """A loss that is no valley, fewer residuals than parameters."""
    model = line(times, np.where(np.arange(times.size) % 2 == 0, 50.0, -50.0))
    with pytest.raises(InvalidParameterError, match="take soft_l1, or a larger loss_scale, got 'cauchy'"):
        sure(model, np.zeros(2), loss="cauchy")
    model = line(np.array([0.0, 1.0]), np.array([1.0, 2.0]))
    with pytest.raises(
        InvalidParameterError, match="residuals must be more than the identifiable parameters, 2, got 2"
    ):
        sure(model, np.ones(2))


def test_residuals_that_hang_together_count_for_less():
    """Of the mean of an AR(1) process with rho the variance is (1 + rho) / (1 - rho) that of noise.

    Bartlett's weights lose part of it, and 4000 residuals are some 400 independent ones: within a third.
    """
    rng = np.random.default_rng(7)
    rho, count = 0.8, 4000
    noise = np.zeros(count)
    for k in range(1, count):
        noise[k] = rho * noise[k - 1] + np.sqrt(1.0 - rho**2) * rng.standard_normal()
    times = np.linspace(0.0, 1.0, count)
    mean = Curve(
        ("mean",), times, lambda t, x: x[0] + 0.0 * t, lambda t, x: np.ones((t.size, 1)), noise, np.ones(1)
    )
    assert autocorrelation(noise) == pytest.approx(
        rho, abs=0.03
    )  # three standard errors, sqrt((1 - rho^2) / m)
    plain, kept = (sure(mean, mean.best(), noise=one) for one in ("estimated", "correlated"))
    assert (kept.error / plain.error) ** 2 == pytest.approx((1.0 + rho) / (1.0 - rho), rel=0.33)
    # Curves of one sample each know no next one.
    apart = sure(mean, mean.best(), noise="correlated", curves=np.arange(count))
    assert apart.error == pytest.approx(plain.error, rel=0.01)
