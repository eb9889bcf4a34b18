"""Motions of a shaken base: exact derivatives, phases, mean squares, and what is refused."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from antenna_pin.elements import (
    RandomShake,
    SineShake,
    SweepShake,
    TableShake,
    band_power,
    density_at,
    sines_of,
)
from antenna_pin.errors import InvalidParameterError

ALONG = {"joint": "x", "direction": (1.0, 0.0, 0.0)}
SWEEP = {"start_frequency": 5.0, "end_frequency": 80.0, "octaves_per_minute": 60.0}


def sweep(**more):
    return SweepShake(**ALONG, **SWEEP | more)


def random(**more):
    given = {"frequency": (20.0, 80.0, 200.0), "density": (1.0, 4.0, 1.0), "period": 2.0, "seed": 3}
    return RandomShake(**ALONG, **given | more)


MOTIONS = {
    "sine": SineShake(**ALONG, frequency=9.0, velocity=0.5, phase=0.7),
    "octaves": sweep(displacement=1e-3, velocity=0.1, acceleration=20.0, back=True, dwell=0.3, fade_in=0.2),
    "linear": SweepShake(
        **ALONG, start_frequency=80.0, end_frequency=10.0, hertz_per_second=20.0, velocity=0.1, fade_in=0.5
    ),
    "random": random(fade_in=0.3),
    "table": TableShake(**ALONG, of="acceleration", time=(0.0, 0.7, 2.0), course=(1.0, -4.0, 2.0)),
}


GAUSS = np.polynomial.legendre.leggauss(1000)


@pytest.mark.parametrize("name", MOTIONS)
def test_rate_and_acceleration_are_the_exact_derivatives(name):
    """By Gauss's rule over spans without an instant: the changes of position and rate, to round-off."""
    motion = MOTIONS[name]
    last = 3.4 if name == "octaves" else 1.6  # of the former past both changes of amplitude
    marks = sorted({0.05, last, *(t for t in motion.instants if 0.05 < t < last)})
    for a, b in zip(marks[:-1], marks[1:], strict=True):
        nodes, weights = GAUSS
        t = 0.5 * (b - a) * nodes + 0.5 * (a + b)
        values = np.array([motion.at(float(one)) for one in t])
        scale = np.abs(values).max(axis=0)
        begin, end = (np.array(motion.at(one)) for one in (a, np.nextafter(b, a)))
        gained = 0.5 * (b - a) * (weights @ values)
        # 1000 points are enough for 310 periods; round-off of sums beside that.
        assert abs(gained[1] - (end - begin)[0]) < 1e-12 * scale[1]
        assert abs(gained[2] - (end - begin)[1]) < 1e-11 * scale[2]


def test_a_sine_has_the_amplitude_that_is_given():
    """Of displacement, velocity or acceleration; the least counts where several are."""
    omega = 2 * math.pi * 9.0
    for given, size in (
        ({"displacement": 2e-3}, 2e-3),
        ({"velocity": 0.5}, 0.5 / omega),
        ({"acceleration": 14.7}, 14.7 / omega**2),
        ({"displacement": 1.0, "acceleration": 14.7}, 14.7 / omega**2),
    ):
        motion = SineShake(**ALONG, frequency=9.0, **given)
        quarter = motion.at(0.25 / 9.0)
        assert quarter[0] == pytest.approx(size, rel=1e-14)  # round-off
        assert quarter[2] == pytest.approx(-size * omega**2, rel=1e-14)


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize("law", ["octaves_per_minute", "hertz_per_second"])
def test_velocity_does_not_jump_between_pieces(law, back):
    """There the displacement is zero: each piece takes a whole number of half periods."""
    motion = SweepShake(
        **ALONG,
        start_frequency=5.0,
        end_frequency=80.0,
        **{law: 30.0},
        displacement=1e-3,
        velocity=0.1,
        acceleration=20.0,
        back=back,
        dwell=0.25 if back else 0.0,
    )
    pieces = motion.pieces()
    # Three amplitudes one after another each way; in between, and at last, it stays.
    assert len(pieces) == (8 if back else 4)
    for before, after in zip(pieces[:-1], pieces[1:], strict=True):
        turned = (sines_of([before], [after.start])[1][0] - after.phase) / (2 * math.pi)
        assert turned == pytest.approx(round(turned), abs=1e-10)  # round-off of a thousand turns
        left, right = (motion.at(t) for t in (np.nextafter(after.start, 0.0), after.start))
        assert right[1] == pytest.approx(left[1], rel=1e-9)
        assert abs(right[0]) < 1e-12
    frequency, _ = sines_of(pieces, [0.0, motion.length])
    assert frequency == pytest.approx([5.0, 5.0 if back else 80.0], rel=1e-13)


def test_a_slow_sweep_keeps_its_rate_and_its_profile():
    """Rates are rounded by half a period in the piece, 2e-3 of the shortest; sizes are those asked for."""
    motion = sweep(displacement=1e-3, acceleration=20.0, octaves_per_minute=2.0)
    assert motion.length == pytest.approx(120.0, rel=2e-3)
    time = np.linspace(0.0, motion.length, 200)
    frequency, _ = sines_of(motion.pieces(), time)
    # Octaves in equal times, but for the rounding.
    assert np.abs(np.log2(frequency / 5.0) - 2.0 * time / 60.0).max() < 4.0 * 2e-3
    for f in (6.0, 15.0, 40.0, 70.0):
        at = float(np.interp(f, frequency, time))
        t = at + np.linspace(0.0, 1.0 / f, 400)
        values = np.array([motion.at(one) for one in t])
        omega = 2 * math.pi * f
        least = min(1e-3 * omega**2, 20.0)
        # The amplitude of a sample's grid, and the frequency's change in one period.
        assert np.abs(values[:, 2]).max() == pytest.approx(least, rel=1e-2)


def test_a_random_base_has_the_mean_square_of_its_density():
    """Over its period, by the lines, and as the integral of straight pieces in double logarithmic axes."""
    motion = random()
    exact = sum(
        quad(lambda f: float(density_at([f], motion.frequency, motion.density)[0]), a, b)[0]
        for a, b in ((20.0, 80.0), (80.0, 200.0))
    )
    assert motion.rms**2 == pytest.approx(exact, rel=1e-9)  # of the quadrature
    frequency, amplitude, phase = motion.lines()
    assert 0.5 * float(amplitude @ amplitude) == pytest.approx(exact, rel=1e-9)
    assert np.diff(frequency) == pytest.approx(0.5)
    omega = 2 * math.pi * frequency
    for t in (0.0, 0.317, 1.9):
        turned = omega * t + phase
        expected = (
            -(amplitude / omega**2) @ np.cos(turned),
            (amplitude / omega) @ np.sin(turned),
            amplitude @ np.cos(turned),
        )
        assert motion.at(t) == pytest.approx(expected, rel=1e-11, abs=1e-11)  # round-off of 361 sines
        assert motion.at(t + 2.0) == pytest.approx(expected, rel=1e-9, abs=1e-9)  # the period


def test_a_base_turns_at_random_as_another_slides():
    """A density of angular acceleration, (rad/s^2)^2/Hz, makes the lines that one of acceleration makes."""
    given = {"frequency": (20.0, 80.0, 200.0), "period": 2.0, "seed": 3, "fade_in": 0.1}
    spectrum = ("1 (rad/s^2)^2/Hz", "4 rad^2/s^3", f"{(180 / math.pi) ** 2} (deg/s^2)^2/Hz")
    turning = RandomShake(joint="x", axis=(0.0, 1.0, 0.0), point=(0, 0, 1), angular_density=spectrum, **given)
    sliding = random(fade_in=0.1)
    assert turning.angular_density == pytest.approx((1.0, 4.0, 1.0), rel=1e-15)  # of pi, twice
    for t in (0.03, 0.317, 1.9):
        assert turning.at(t) == pytest.approx(sliding.at(t), rel=1e-13)
    assert "rad/s² rms" in turning.words(False) and turning.rms == pytest.approx(sliding.rms, rel=1e-14)
    with pytest.raises(InvalidParameterError, match="a spectral density of angular acceleration"):
        RandomShake(joint="x", axis=(0, 0, 1), angular_density=("1 g^2/Hz",) * 3, **given)


def test_a_table_fades_in():
    """From rest at zero, by the factor that sines have; past that it is the table, to the last bit."""
    given = {"of": "displacement", "time": (0.0, 0.5, 1.0, 1.5), "course": (1.0, 2.0, 0.0, 1.0)}
    plain, faded = TableShake(**ALONG, **given), TableShake(**ALONG, **given, fade_in=0.4)
    assert faded.at(0.0) == (0.0, 0.0, 0.0)
    assert faded.at(0.2)[0] == pytest.approx(0.5 * plain.at(0.2)[0], rel=1e-14)  # half way, a half
    assert faded.at(0.4) == plain.at(0.4) and faded.at(1.1) == plain.at(1.1)
    assert 0.4 in faded.instants and faded.words(True).endswith("fades in within 0.4\N{NO-BREAK SPACE}s")


def test_a_density_falls_as_one_over_f():
    """Where the exponent is -1 the integral is a logarithm; beside it, close to that."""
    assert band_power(1.0, 8.0, (1.0, 8.0), (1.0, 0.125)) == pytest.approx(math.log(8.0), rel=1e-14)
    near = band_power(1.0, 8.0, (1.0, 8.0), (1.0, 0.125 * (1 + 1e-9)))
    assert near == pytest.approx(math.log(8.0), rel=1e-8)
    assert band_power(2.0, 4.0, (1.0, 8.0), (3.0, 3.0)) == pytest.approx(6.0, rel=1e-14)


def test_the_same_seed_gives_the_same_motion_and_another_another():
    assert random().at(0.4) == random().at(0.4)
    assert random().at(0.4) != random(seed=4).at(0.4)


def test_a_table_of_acceleration_is_integrated_from_its_start():
    """a = 2 + 3 t: v = 0.5 + 2 t + 3/2 t^2, x = -1 + 0.5 t + t^2 + t^3/2."""
    motion = TableShake(
        **ALONG,
        of="acceleration",
        time=(0.0, 1.0, 2.0),
        course=(1.0, 2.5, 4.0),
        scale=2.0,
        start_displacement=-1.0,
        start_velocity=0.5,
    )
    for t in (0.0, 0.5, 1.3, 2.0):
        expected = (-1 + 0.5 * t + t**2 + t**3 / 2, 0.5 + 2 * t + 1.5 * t**2, 2 + 3 * t)
        assert motion.at(t) == pytest.approx(expected, rel=1e-13, abs=1e-13)
    assert "ends at 8 m and 10.5 m/s" in motion.words(True).replace("\N{NO-BREAK SPACE}", " ")


REFUSED = {
    "no way": (lambda: SineShake(joint="x", frequency=1.0, displacement=1.0), "direction must be given"),
    "two ways": (
        lambda: SineShake(**ALONG, axis=(0, 0, 1), frequency=1.0, displacement=1.0),
        "direction must be given, or an axis to turn about, got both",
    ),
    "a point": (
        lambda: SineShake(**ALONG, point=(0, 0, 1), frequency=1.0, displacement=1.0),
        "point must be left out",
    ),
    "no amplitude": (lambda: SineShake(**ALONG, frequency=1.0), "acceleration must be given, or"),
    "no rate": (lambda: sweep(velocity=1.0, octaves_per_minute=None), "octaves_per_minute must be given"),
    "two rates": (lambda: sweep(velocity=1.0, hertz_per_second=1.0), "got both"),
    "too fast": (lambda: sweep(velocity=1.0, octaves_per_minute=2000.0), "10 periods or more (it has"),
    "a dwell at the end": (lambda: sweep(velocity=1.0, dwell=1.0), "dwell must be left out where"),
    "one frequency": (lambda: sweep(velocity=1.0, end_frequency=5.0), "another than start_frequency"),
    "a random turn": (
        lambda: RandomShake(
            joint="x", axis=(0, 0, 1), frequency=(1.0, 2.0), density=(1.0, 1.0), period=9.0, seed=1
        ),
        "density must be left out of what is shaken about an axis; give angular_density",
    ),
    "a turn without a density": (
        lambda: RandomShake(joint="x", axis=(0, 0, 1), frequency=(1.0, 2.0), period=9.0, seed=1),
        "angular_density must be given of what is shaken about an axis",
    ),
    "a density of two kinds": (
        lambda: random(angular_density=(1.0, 1.0, 1.0)),
        "angular_density must be left",
    ),
    "a density without an end": (lambda: random(density=(1.0, 2.0)), "as many numbers as frequency, 3"),
    "a band that falls": (lambda: random(frequency=(20.0, 20.0, 30.0)), "must be above the one before, 20.0"),
    "a period too short": (lambda: random(frequency=(0.1, 1.0, 2.0)), "at least 5 s"),
    "too many lines": (lambda: random(period=1e4), "100000 lines 1/period apart or fewer"),
    "a start twice": (
        lambda: TableShake(**ALONG, of="velocity", time=(0.0, 1.0), course=(0.0, 1.0), start_velocity=1.0),
        "start_velocity must be left out",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_makes_no_motion_is_refused_in_one_line(name):
    made, words = REFUSED[name]
    with pytest.raises(InvalidParameterError) as error:
        made()
    assert words in str(error.value)
    assert "\n" not in str(error.value)


def test_a_run_beyond_the_period_is_refused():
    with pytest.raises(InvalidParameterError, match="as long as the run, 3 s, or it repeats itself"):
        random().check_span("shake 'x'", 0.0, 3.0)
    random().check_span("shake 'x'", 0.0, 2.0)
