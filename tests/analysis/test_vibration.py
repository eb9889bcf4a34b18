"""Spectral densities, mean squares and shock spectra: closed forms, and the statistics that they claim."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from antenna_pin.analysis import band_rms, following, power_density, shock_spectrum, transfer
from antenna_pin.errors import InvalidParameterError

RATE, SPAN, LEVEL = 1000.0, 40.0, 0.3


def noise(seed):
    """White noise of a one-sided density LEVEL, up to half the rate."""
    count = round(SPAN * RATE) + 1
    time = np.arange(count) / RATE
    return time, np.random.default_rng(seed).normal(scale=math.sqrt(LEVEL * RATE / 2), size=count)


def test_the_interval_holds_the_density_as_often_as_it_says():
    """Of 40 records and 100 frequencies each 95 %, within three standard deviations of a binomial."""
    inside = total = 0
    for seed in range(40):
        found = power_density(*noise(seed), segment=1.0, confidence=0.95)
        # A line in four: windows of Hann reach into two neighbours.
        part = found.isel(frequency=slice(20, 420, 4))
        inside += int(((part["lower"] < LEVEL) & (part["upper"] > LEVEL)).sum())
        total += part.sizes["frequency"]
    assert inside / total == pytest.approx(0.95, abs=3 * math.sqrt(0.95 * 0.05 / total))
    assert found.attrs["segments"] == 79
    # 2 K / (1 + 2/36), for Hann windows that overlap by half.
    assert found.attrs["degrees_of_freedom"] == pytest.approx(2 * 79 / (1 + 2 / 36), rel=1e-3)


def test_a_band_has_its_root_mean_square_and_the_error_that_it_says():
    """Of 60 records: the mean error is one standard error, to 3/sqrt(2 n) of it."""
    exact = math.sqrt(LEVEL * 150.0)
    off = []
    for seed in range(60):
        found = band_rms(power_density(*noise(seed), segment=1.0), [(50.0, 200.0)])
        off.append((float(found["rms"][0]) - exact) / float(found["standard_error"][0]))
    assert float(np.std(off)) == pytest.approx(1.0, abs=3 / math.sqrt(2 * 60))
    assert abs(float(np.mean(off))) < 3 / math.sqrt(60)
    # sigma / 2 sqrt(1/(B T)), of a flat band.
    error = 0.5 * exact / math.sqrt(150.0 * SPAN)
    assert float(found["standard_error"][0]) == pytest.approx(error, rel=0.05)


@pytest.mark.parametrize("units", ["", "m/s^2"])
def test_a_band_is_in_the_unit_of_the_signal(units):
    found = band_rms(power_density(*noise(0), units=units))
    assert {found[name].attrs["units"] for name in ("rms", "standard_error")} == {units or "1"}


def test_the_response_of_a_filter_is_found_with_its_error():
    """y = x + half of it a step later, with noise on y that lowers the coherence to a half."""
    time, x = noise(1)
    _, other = noise(2)
    clean = x + 0.5 * np.concatenate([[0.0], x[:-1]])
    found = transfer(time, x, clean + 1.1 * other, segment=1.0)
    exact = 1 + 0.5 * np.exp(-2j * np.pi * found["frequency"].values / RATE)
    inside = slice(20, 480, 4)
    off = (np.abs(found["response"].values) / np.abs(exact) - 1)[inside]
    # One standard error, of 115 frequencies.
    spread = float(np.std(off / found["error"].values[inside]))
    assert spread == pytest.approx(1.0, abs=3 / math.sqrt(2 * 115))
    assert float(found["coherence"].mean()) == pytest.approx(0.5, abs=0.05)


def half_sine(length, rate=20000.0, span=0.1):
    t = np.arange(round(span * rate) + 1) / rate
    return t, np.where(t < length, np.sin(np.pi * t / length), 0.0)


def test_a_half_sine_has_the_spectrum_of_the_books():
    """Undamped, of length D: below 1/2D the residual counts, 2 r cos(pi f D)/(1 - r^2), r = 2 f D.

    While it lasts the response is (sin w0 t - r sin(w t))/(1 - r^2).
    """
    length = 0.01
    t, a = half_sine(length)
    frequencies = np.array([10.0, 20.0, 40.0, 80.0, 160.0])
    found = shock_spectrum(t, a, frequencies, quality=1e9)
    for k, f in enumerate(frequencies):
        ratio = 1 / (2 * f * length)  # of the pulse's frequency to the oscillator's
        during = np.linspace(0, length, 200001)
        own = np.sin(np.pi * during / length) - ratio * np.sin(2 * np.pi * f * during)
        first = np.abs(own / (1 - ratio**2)).max()
        left = abs(2 * ratio * math.cos(math.pi * f * length) / (1 - ratio**2))
        # 24 looks in a period miss up to 0.9 %, 48 after the end 0.2 %; the polygon of a sine 1e-4.
        assert float(found["residual"][k]) == pytest.approx(left, rel=2.5e-3, abs=1e-4)
        assert float(found["maximum"][k]) == pytest.approx(max(first, left), rel=9e-3)


def test_a_slow_oscillator_sees_the_area_alone():
    """Of a sawtooth of 10 ms, half a metre a second: omega times it, but for (omega 10 ms)^2."""
    found = shock_spectrum([0.0, 0.01], [0.0, 100.0], [0.1], quality=1e9)
    assert float(found["maximum"][0]) == pytest.approx(2 * math.pi * 0.1 * 0.5, rel=2.5e-3)  # 48 looks
    # It swings by the velocity over omega, a quarter of a period after the end.
    assert float(found["pseudo_velocity"][0]) == pytest.approx(0.5, rel=2.5e-3)


def test_an_acceleration_the_other_way_has_the_spectrum_with_its_senses_exchanged():
    """Of a pulse that dies out in a damped swing, whose first way after the end is the larger."""
    t = np.linspace(0.0, 0.02, 41)
    a = 100.0 * np.sin(np.pi * t / 0.02)
    one, other = (shock_spectrum(t, sign * a, [10.0, 60.0, 90.0], quality=2.0) for sign in (1.0, -1.0))
    np.testing.assert_array_equal(one["positive"], other["negative"])
    np.testing.assert_array_equal(one["negative"], other["positive"])
    assert (one["positive"] > 1.1 * one["negative"]).all()
    for name in ("maximum", "residual", "pseudo_velocity"):
        np.testing.assert_array_equal(one[name], other[name])


def test_a_polygon_of_uneven_samples_is_answered_exactly():
    """Against SciPy's DOP853 from sample to sample, of damped oscillators slow and fast for the steps."""
    t = np.unique(np.concatenate([np.linspace(0, 0.05, 51), [0.00123, 0.00777]]))
    a = np.where(t < 0.03, 100 * np.sin(np.pi * t / 0.03), 0) + np.random.default_rng(1).normal(size=t.size)
    found = shock_spectrum(t, a, [5.0, 40.0, 300.0], quality=10.0)
    for k, f in enumerate([5.0, 40.0, 300.0]):
        w, state, high = 2 * np.pi * f, np.zeros(2), 0.0
        for i in range(t.size - 1):
            rise = (a[i + 1] - a[i]) / (t[i + 1] - t[i])

            def slope(s, y, own=(t[i], a[i], rise, w)):
                begin, first, rise, w = own
                return [y[1], -0.1 * w * y[1] - w * w * y[0] - first - rise * (s - begin)]

            at = np.linspace(t[i], t[i + 1], 60)
            solved = solve_ivp(slope, (t[i], t[i + 1]), state, "DOP853", at, rtol=1e-11, atol=1e-14)
            state = solved.y[:, -1]
            high = max(high, float((-(0.1 * w * solved.y[1] + w * w * solved.y[0])).max()))
        # The slow one swings on after the end, freely.
        after = np.linspace(0.0, 1.0 / f, 500)
        damped = w * math.sqrt(1 - 0.05**2)
        swing = complex(state[0], -(state[1] + 0.05 * w * state[0]) / damped)
        free = swing * np.exp((-0.05 * w + 1j * damped) * after)
        rate = ((-0.05 * w + 1j * damped) * free).real
        high = max(high, float((-(0.1 * w * rate + w * w * free.real)).max()))
        # Peaks are missed by as much as the looks are apart, (pi/24)^2/2 of them at most.
        assert high * (1 - 9e-3) <= float(found["positive"][k]) <= high * (1 + 1e-3)


def test_what_follows_a_phase_is_told_from_what_does_not():
    """A part that grows, a third harmonic, a mean and a drift: amplitude, and what the harmonic has."""
    t = np.sort(np.random.default_rng(3).uniform(0.0, 20.0, 6000))
    phase = 2 * np.pi * (3.0 * t + 0.05 * t**2)
    y = (1.0 + 0.002 * phase) * np.cos(phase - 0.4) + 0.1 * np.cos(3 * phase) + 5.0 + 0.02 * t
    found = following(t, y, phase, 8.0)
    middle = np.interp(found["time"].values, t, phase)
    expected = (1.0 + 0.002 * middle) * np.exp(-0.4j)
    # Of 150 uneven samples in a window, harmonics alias into the fit by a hundredth of theirs.
    assert np.abs(found["part"].values - expected).max() < 0.03
    assert found["rest"].values == pytest.approx(0.1 / math.sqrt(2), rel=0.15)


REFUSED = {
    "confidence": (lambda: power_density(*noise(0), confidence=95.0), "between 0 and 1, got 95.0"),
    "bands": (lambda: band_rms(power_density(*noise(0)), [(5.0, 2.0)]), "a lower and a higher frequency"),
    "beyond": (
        lambda: band_rms(power_density(*noise(0)), [(600.0, 700.0)]),
        "below half of the rate, 500 Hz",
    ),
    "quality": (lambda: shock_spectrum([0, 1], [0, 1], [1.0], quality=0.4), "above 0.5"),
    "too fast": (lambda: shock_spectrum([0, 0.1], [0, 1], [1e3]), "at most 26.67 Hz"),
    "frequencies": (lambda: shock_spectrum([0, 1], [0, 1], [-1.0]), "positive [Hz]"),
    "periods": (lambda: following([0, 1, 2], [0, 1, 2], [0, 1, 2], 1.0), "2 or more"),
    "segment": (lambda: transfer(*noise(0), noise(1)[1], segment=100.0), "16 samples to all"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_gives_no_number_is_refused_in_one_line(name):
    made, words = REFUSED[name]
    with pytest.raises(InvalidParameterError) as error:
        made()
    assert words in str(error.value)
    assert "\n" not in str(error.value)
