"""Interpolation and statistics of unevenly sampled signals, against closed forms."""

import numpy as np
import pytest

from antenna_pin.analysis import growth_of, resampled, time_mean, time_percentiles, time_rms
from antenna_pin.errors import InvalidParameterError


@pytest.fixture
def uneven():
    """Times over two periods of one second, crowded at random places, some of them twice."""
    random = np.random.default_rng(7)
    crowded = np.concatenate([np.linspace(0.0, 2.0, 2001), random.uniform(0.0, 2.0, 700)])
    return np.sort(np.concatenate([crowded, random.choice(crowded, 50)]))


def test_moments_of_a_sine(uneven):
    """The trapezoidal rule errs by (omega h)^2 / 12 = 3e-6 of the square, crowded or not."""
    sine = 3.0 * np.sin(2.0 * np.pi * uneven)
    assert time_rms(uneven, sine) == pytest.approx(3.0 / np.sqrt(2.0), rel=1e-5)
    assert float(time_mean(uneven, 1.0 + sine)) == pytest.approx(1.0, rel=1e-5)


def test_percentiles_of_a_sine(uneven):
    """Below A sin(pi (p - 1/2)) for the share p; the polygon's sagitta is A (omega h)^2 / 8 = 5e-6 A."""
    sine = 3.0 * np.sin(2.0 * np.pi * uneven)
    percent = np.array([0.0, 5.0, 25.0, 50.0, 90.0, 99.0, 100.0])
    expected = 3.0 * np.sin(np.pi * (percent / 100.0 - 0.5))
    assert time_percentiles(uneven, sine, percent) == pytest.approx(expected, abs=3e-5)


def test_percentiles_of_a_signal_that_rests():
    """At zero for two thirds of the time, then a ramp to one: straight lines all along."""
    found = time_percentiles([0.0, 1.0, 2.0, 3.0], [0.0, 0.0, 0.0, 1.0], [0, 50, 66, 70, 85, 100])
    assert found == pytest.approx([0.0, 0.0, 0.0, 0.1, 0.55, 1.0], abs=1e-12)
    pulse = time_percentiles([0.0, 1.0, 1.0, 2.0, 2.0, 4.0], [0.0, 0.0, 5.0, 5.0, 0.0, 0.0], [74, 76, 100])
    assert pulse == pytest.approx([0.0, 5.0, 5.0], abs=1e-12)


def test_one_instant_is_its_own_mean():
    assert float(time_mean([2.0], [7.0])) == 7.0
    assert float(time_rms([2.0, 2.0], [7.0, 7.0])) == 7.0
    assert time_percentiles([2.0], [7.0], [10.0, 90.0]).tolist() == [7.0, 7.0]


def test_what_is_no_signal_is_refused():
    with pytest.raises(InvalidParameterError, match="one per time"):
        time_mean([0.0, 1.0], [1.0])
    with pytest.raises(InvalidParameterError, match="not decreasing"):
        time_mean([1.0, 0.0], [1.0, 1.0])
    with pytest.raises(InvalidParameterError, match="from 0 to 100"):
        time_percentiles([0.0, 1.0], [1.0, 1.0], [101.0])


def test_interpolation_is_of_fourth_order():
    """Halving the spacing divides the error by 16, with the derivative and without."""
    at = np.linspace(0.05, 0.95, 333)
    for slope in (True, False):
        errors = []
        for n in (41, 81):
            t = np.linspace(0.0, 1.0, n)
            derivative = 10.0 * np.cos(10.0 * t) if slope else None
            found = resampled(t, np.sin(10.0 * t), at, derivative)
            errors.append(np.abs(found - np.sin(10.0 * at)).max())
        assert 13.0 < errors[0] / errors[1] < 20.0


def test_interpolation_takes_doubled_instants_and_ends_with_the_signal():
    t = np.array([0.0, 0.5, 0.5, 1.0])
    found = resampled(t, t**2, [-0.1, 0.0, 0.3, 1.0, 1.1], 2.0 * t)
    assert np.isnan(found[[0, -1]]).all()
    assert found[1:-1] == pytest.approx([0.0, 0.09, 1.0], abs=1e-15)  # a parabola is met exactly
    assert np.isnan(resampled([1.0], [4.0], [0.5])).all()
    # A run whose last state was not finite is known up to there.
    ended = resampled([*t, 1.5], [*t**2, np.nan], [0.3, 1.2], [*2.0 * t, np.nan])
    assert ended[0] == pytest.approx(0.09, abs=1e-15)
    assert np.isnan(ended[1])


def test_growth_of_known_laws(uneven):
    """A power and an exponential, alone and times a wave, whose steps in the envelope blur the slope."""
    for law, kind in (
        (lambda t: 1e-4 * t**2.5, "power"),
        (lambda t: 1e-9 * np.expm1(6.0 * t), "exponential"),
    ):
        smooth = growth_of(uneven, law(uneven))
        assert smooth.kind == kind
        waves = growth_of(uneven, law(uneven) * np.sin(40.0 * np.pi * uneven))
        assert waves.kind == kind
        for found, rel in ((smooth, 0.06), (waves, 0.1)):
            value = found.exponent if kind == "power" else found.rate
            assert value == pytest.approx(2.5 if kind == "power" else 6.0, rel=rel)
            assert max(found.power_r2, found.exponential_r2) > 0.95


def test_growth_says_when_it_means_nothing():
    t = np.linspace(0.0, 1.0, 500)
    assert growth_of(t, np.zeros(500)).note == "it does not deviate"
    assert growth_of(t, np.where(t > 0.5, 1.0, 0.0)).note == "it rises in a few jumps only"
    assert growth_of(t, 1.0 + 0.5 * t).note == "it is level"
    assert growth_of(t, np.where(t < 0.05, t, 0.0)).note == "it grows for less than a fifth of the run"
    steps = np.where(t < 0.5, 1.0 + 1e-3 * t, 1e3 + t)
    assert growth_of(t, np.where(t > 0.01, steps, 0.0)).kind == "none"
    assert growth_of(t[:1], [1.0]).kind == "none"
