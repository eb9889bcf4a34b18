"""Spectra of known signals."""

import numpy as np
import pytest

from antenna_pin.analysis import dominant_frequencies, spectrogram, spectrum, uniform
from antenna_pin.errors import InvalidParameterError

RATE = 1000.0
TIME = np.arange(5000) / RATE


def sines(t):
    """1 at 7.3217 Hz, 0.1 at 43.77 Hz: neither on a bin of 0.2 Hz."""
    return np.sin(2 * np.pi * 7.3217 * t + 1.0) + 0.1 * np.sin(2 * np.pi * 43.77 * t)


def test_two_sines_to_a_thousandth_of_a_bin():
    """Hann side lobes fall as the cube: 180 bins away they are 1e-7 of the other's peak."""
    found = dominant_frequencies(TIME, sines(TIME))
    assert found.sizes["peak"] == 2
    assert found["frequency"].values == pytest.approx([7.3217, 43.77], abs=2e-4)  # bins of 0.2 Hz
    assert found["amplitude"].values == pytest.approx([1.0, 0.1], rel=1e-3)
    assert found.attrs["resolution"] == pytest.approx(0.2, rel=1e-9)


def test_two_sines_in_noise():
    """Noise of 0.05: at best an estimate errs by sqrt(6) s / (pi A T sqrt(N)) = 1e-4 Hz for A = 1."""
    noise = 0.05 * np.random.default_rng(3).standard_normal(TIME.size)
    found = dominant_frequencies(TIME, sines(TIME) + noise, units="m/s^2")
    assert found["frequency"].values[:2] == pytest.approx([7.3217, 43.77], abs=3e-3)
    assert found["frequency"].values[0] == pytest.approx(7.3217, abs=3e-4)
    assert found["amplitude"].values[:2] == pytest.approx([1.0, 0.1], abs=0.005)
    assert found["amplitude"].attrs["units"] == "m/s^2"
    assert (found["contrast"].values[:2] > 20.0).all()


def test_few_periods_are_enough_but_for_two():
    """The sine's mirror image at negative frequency is 2 f T bins away: Hann side lobes of 8, 12, 20 bins."""
    for periods, error in ((2, 0.04), (3, 1.5e-3), (5, 3e-4)):
        t = np.arange(0.0, periods, 1e-3)
        for phase in np.linspace(0.0, 6.0, 7):
            found = dominant_frequencies(t, 3.0 + np.sin(2 * np.pi * t + phase), 1)
            assert found["frequency"].item() == pytest.approx(1.0, rel=error)
    ramp = dominant_frequencies(TIME, TIME + 0.01 * sines(TIME), detrend="linear")
    assert ramp["frequency"].values[0] == pytest.approx(7.3217, abs=1e-3)


def test_noise_has_no_dominant_frequency():
    """Five medians: chance 3e-8 a bin for Rayleigh-distributed magnitudes."""
    noise = np.random.default_rng(5).standard_normal(20_000)
    assert dominant_frequencies(np.arange(20_000) / RATE, noise).sizes["peak"] == 0


def test_round_off_is_no_signal():
    """A sine of 1e-13 beside gravity, or beside another axis, is what arithmetic leaves."""
    small = 1e-13 * np.sin(2 * np.pi * 43.77 * TIME)
    for values, scale in ((9.81 + small, 0.0), (small, 5.0)):
        found = dominant_frequencies(TIME, values, scale=scale)
        assert (found.sizes["peak"], found.attrs["round_off"]) == (0, 1)
    alone = dominant_frequencies(TIME, small)
    assert (alone.sizes["peak"], alone.attrs["round_off"]) == (1, 0)
    beside = dominant_frequencies(TIME, 1e-8 * sines(TIME), scale=1.0)
    assert (beside.sizes["peak"], beside.attrs["round_off"]) == (2, 0)


def test_power_of_a_spectrum_is_the_variance():
    """Parseval; Welch's mean over segments differs from the whole by the ends' share."""
    random = np.random.default_rng(11).standard_normal((TIME.size, 2)) * [1.0, 3.0]
    found = spectrum(TIME, random, segment=0.25, units="N")
    assert np.trapezoid(found["power"], found["frequency"], axis=0) == pytest.approx(
        random.var(axis=0), rel=0.02
    )
    # White noise of variance s^2 has the density s / sqrt(half the rate).
    middle = found["density"].sel(frequency=slice(20.0, 480.0)).mean("frequency")
    assert middle.values == pytest.approx(np.array([1.0, 3.0]) / np.sqrt(500.0), rel=0.03)
    assert found["density"].attrs["units"] == "N/sqrt(Hz)"
    assert found.attrs["segments"] == 39
    assert found.attrs["resolution"] == pytest.approx(6.0)  # 1.5 / 0.25 s


def test_a_sine_stands_in_the_spectrum_with_its_power():
    """A^2 / 2 under the peak, to what the Hann window leaks beyond 4 bins, 1e-6."""
    found = spectrum(TIME, sines(TIME))
    peak = found["power"].sel(frequency=slice(5.0, 10.0))
    assert peak.sum() * 0.2 == pytest.approx(0.5, rel=1e-3)


def test_an_even_grid_keeps_even_samples_and_changes_uneven_ones_little():
    """Akima's slopes are of second order: half a percent of the faster sine's 0.1."""
    even = uniform(TIME, sines(TIME))
    assert even.rate == pytest.approx(RATE, rel=1e-12)
    assert np.array_equal(even.values, sines(TIME))
    # Akima's slopes are of second order among uneven samples: half a percent of the faster sine's 0.1.
    random = np.random.default_rng(2)
    crowded = np.sort(np.concatenate([TIME, TIME[100:120], random.uniform(0.0, TIME[-1], 900)]))
    even = uniform(crowded, sines(crowded))
    assert even.rate == pytest.approx(RATE, rel=1e-9)
    assert np.abs(even.values - sines(even.time)).max() < 5e-4
    found = dominant_frequencies(crowded, sines(crowded))
    assert found["frequency"].values == pytest.approx([7.3217, 43.77], abs=2e-4)


def test_what_is_faster_than_half_the_grid_is_not_folded_back():
    """730 Hz would show at 270 Hz on a grid of 1 kHz; the low pass stops it by 80 dB."""
    fine = np.arange(0.0, 2.0, 2e-5)
    even = uniform(fine, np.sin(2 * np.pi * 730.0 * fine), rate=RATE)
    assert np.abs(even.values[20:-20]).max() < 1e-4
    passed = uniform(fine, np.sin(2 * np.pi * 200.0 * fine), rate=RATE)
    assert np.abs(passed.values - np.sin(2 * np.pi * 200.0 * passed.time))[20:-20].max() < 0.001


def test_pulses_keep_their_integral():
    """Triangles of 0.3 ms between samples of 1 ms: their area must be that under the grid's curve."""
    onset = 0.0137 + 0.0413 * np.arange(40)
    corners = np.sort(np.concatenate([onset, onset + 1.5e-4, onset + 3e-4]))
    t = np.union1d(np.arange(2001) / RATE, corners)
    even = uniform(t, np.interp(t, corners, np.tile([0.0, 1.0, 0.0], 40)))
    # The modified Akima cubic bends the triangles' sides.
    assert even.values.sum() / even.rate == pytest.approx(40 * 1.5e-4, rel=0.03)


def test_a_sweep_moves_through_the_spectrogram():
    """50 to 150 Hz in 5 s: at each window's middle its power is at the instantaneous frequency."""
    t = np.arange(0.0, 5.0, 1e-3)
    found = spectrogram(t, np.sin(2 * np.pi * (50.0 * t + 10.0 * t**2)), segment=0.25, units="rad/s^2")
    power = found["power"]
    assert power.dims == ("frequency", "time")
    assert (found.attrs["segment"], found.attrs["resolution"]) == pytest.approx((0.25, 6.0), rel=1e-12)
    strongest = power["frequency"].values[power.values.argmax(axis=0)]
    assert strongest == pytest.approx(50.0 + 20.0 * power["time"].values, abs=4.0)  # bins of 4 Hz
    # One half, the mean square of a sine, in every window.
    assert power.sum("frequency").values * 4.0 == pytest.approx(np.full(power.sizes["time"], 0.5), rel=0.02)
    assert power["time"].values[[0, -1]] == pytest.approx([0.125, 4.875], abs=0.07)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        (lambda: uniform([0.0, 1.0], [1.0, 2.0]), "16 instants or more, got 2"),
        (lambda: uniform(TIME, np.where(TIME > 1.0, np.nan, 0.0)), "finite"),
        (lambda: uniform(TIME, TIME[1:]), "one row per time"),
        (lambda: uniform(TIME, TIME, rate=1.0), "16 points"),
        (lambda: spectrum(TIME, TIME, segment=7.0), "from 0.016 to 5 s"),
        (lambda: spectrogram(TIME, np.zeros((TIME.size, 2))), "one signal"),
        (lambda: dominant_frequencies(TIME, np.zeros((TIME.size, 2))), "one signal"),
    ],
)
def test_what_has_no_spectrum_is_refused(call, said):
    with pytest.raises(InvalidParameterError, match=said):
        call()
