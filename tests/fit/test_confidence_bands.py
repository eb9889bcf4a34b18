"""Bands of curves, against closed forms and the share of truths that they hold."""

import numpy as np
import pytest
from known_curves import decay, line, oscillator

from antenna_pin.errors import InvalidParameterError
from antenna_pin.studies.fit.confidence_bands import draws, linear_bands, sampled_bands
from antenna_pin.studies.fit.uncertainty import sure


def _line(times):
    return line(times, 2.0 + 0.5 * times + 0.1 * np.random.default_rng(1).standard_normal(times.size), 0.1)


def test_the_band_of_a_line_is_the_textbooks(times):
    """t s sqrt(1/m + (x - mean)^2 / Sxx), and with 1 under the root for a new measurement."""
    model = _line(times)
    found = sure(model, model.best())
    bands = linear_bands(model, found)
    apart = times - times.mean()
    share = 1.0 / times.size + apart**2 / (apart @ apart)
    s = np.sqrt(found.factor)
    assert 0.5 * (bands.high - bands.low) == pytest.approx(2.0452296421 * s * np.sqrt(share), rel=1e-9)
    assert 0.5 * (bands.new_high - bands.new_low) == pytest.approx(
        2.0452296421 * s * np.sqrt(1.0 + share), rel=1e-9
    )


@pytest.mark.parametrize("noise", ["given", "estimated"])
def test_drawn_bands_of_a_line_are_the_same(times, noise):
    """Of 4000 draws a quantile of 2.5 % spreads by 2 to 3 % of the width."""
    model = _line(times)
    found = sure(model, model.best(), noise=noise)
    drawn, exact = sampled_bands(model, found, 4000, 3), linear_bands(model, found)
    assert (drawn.high - drawn.low) / (exact.high - exact.low) == pytest.approx(np.ones(times.size), abs=0.08)
    assert drawn.effective > 3000 and drawn.drawn == 4000 and drawn.failed == 0
    assert drawn.seed == 3
    again = sampled_bands(model, found, 4000, 3)
    assert np.array_equal(drawn.low, again.low) and np.array_equal(drawn.new_high, again.new_high)


def test_draws_that_count_by_how_well_they_do_are_spread_as_the_likelihood(times):
    """Of a rate that is told badly it lies to one side, and no normal distribution does.

    With the amplitude integrated out it is exp(-S(k) / 2) / sqrt(e.e), with S(k) = y.y - (y.e)^2 / e.e and
    e = exp(-k t).
    """
    noise = np.random.default_rng(4).standard_normal(times.size)
    model = decay(times, 2.0 * np.exp(-1.3 * times) + 0.4 * noise, 0.4)
    found = sure(model, model.best(), noise="given")
    values, logs = draws(model, found, 6000, 5)
    growth = np.array([np.sum(model.residuals(one) ** 2) for one in values])
    weights = np.exp(-0.5 * (growth - growth.min()) - (logs - logs.min()))
    order = np.argsort(values[:, 1])
    share = np.cumsum(weights[order]) / weights.sum()
    drawn = np.interp([0.025, 0.975], share, values[order, 1])
    k = np.linspace(0.3, 8.0, 4001)
    e, y = np.exp(-np.multiply.outer(k, times)), model.record
    square = (e * e).sum(axis=1)
    log = 0.5 * (e @ y) ** 2 / square / model.sd**2 - 0.5 * np.log(square)
    below = np.cumsum(np.exp(log - log.max()))
    exact = np.interp([0.025, 0.975], below / below[-1], k)
    # Of 6000 draws with a quantile's share of 2.5 % the spread is 4 % of a half width, here allowed twice.
    half = 0.5 * (exact[1] - exact[0])
    assert drawn == pytest.approx(exact, abs=0.08 * half)
    rate = found.values[1]
    assert exact[1] - rate > 1.5 * (rate - exact[0])  # what a normal distribution would get wrong


def test_bands_hold_the_true_curve_as_often_as_they_say():
    """200 records of a decay: at three instants misses of 95 % are binomial; 3 to 19 is 99.8 % of them."""
    times = np.linspace(0.0, 3.0, 31)
    missed = np.zeros(3)
    for seed in range(200):
        truth = 2.0 * np.exp(-1.3 * times)
        model = decay(times, truth + 0.05 * np.random.default_rng(seed).standard_normal(times.size))
        bands = linear_bands(model, sure(model, model.best()))
        real = truth - model.record  # what the true curve is as a residual
        missed += ((real < bands.low) | (real > bands.high))[[0, 10, 25]]
    assert np.all((missed >= 3) & (missed <= 19)), missed


def test_bounds_are_kept_by_drawing_again(times):
    """Numbers of draws below 2 are refused."""
    model = line(times, _line(times).record, 0.1, lower=np.array([-np.inf, 0.47]))
    found = sure(model, model.best(), noise="given")
    values, _ = draws(model, found, 500, 1)
    assert values[:, 1].min() >= 0.47
    assert np.mean(values[:, 1] < 0.475) < 0.2  # none heaped up at the bound
    model = _line(times)
    with pytest.raises(InvalidParameterError, match="draws must be 2 or more"):
        sampled_bands(model, sure(model, model.best()), 1)


def test_curves_of_what_is_told_together_have_bands_and_draws_have_none(times):
    """Of m and k the motion is known, neither of them: a band to first order, and nothing to draw from."""
    noise = 0.02 * np.random.default_rng(2).standard_normal(times.size)
    model = oscillator(times, np.cos(5.0 * times) + noise, 0.02)
    found = sure(model, model.best(), noise="given")
    bands = linear_bands(model, found)
    # The frequency alone, fitted: its slope over its length, in standard deviations.
    slope = times * np.sin(np.sqrt(found.values[1] / found.values[0]) * times) / 0.02
    expected = 1.959963984540054 * np.abs(slope) / np.linalg.norm(slope)
    assert 0.5 * (bands.high - bands.low) == pytest.approx(expected, abs=1e-6)
    with pytest.raises(InvalidParameterError, match="got mass, stiffness"):
        sampled_bands(model, found)
