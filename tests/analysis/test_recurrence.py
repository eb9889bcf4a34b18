"""Recurrence, the 0-1 test and the judge of transients, on motions whose kind is known."""

import numpy as np
import pytest

from antenna_pin.analysis import Chaos, RecurrenceKind, chaos_test, recurrence, section_lines, settled
from antenna_pin.errors import InvalidParameterError

GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)
rng = np.random.default_rng


def logistic(r, count, skipped=5000, x=0.4):
    """Points of x -> r x (1 - x), whose first doublings are at 3, 3.44949, 3.54409, 3.56441 and 3.56876."""
    found = np.empty(skipped + count)
    for k in range(found.size):
        x = r * x * (1.0 - x)
        found[k] = x
    return found[skipped:]


def henon(count):
    """Points of the map of Henon (1976) at a = 1.4, b = 0.3."""
    x, y, found = 0.1, 0.1, []
    for _ in range(count + 1000):
        x, y = 1.0 - 1.4 * x * x + y, 0.3 * x
        found.append((x, y))
    return np.array(found[1000:])


def circle_map(count, omega, coupling):
    """Points on the circle, and the rotation number: theta -> theta + omega - K / 2 pi sin 2 pi theta."""
    theta, found = 0.1, []
    for _ in range(count + 1000):
        step = omega - coupling / (2.0 * np.pi) * np.sin(2.0 * np.pi * theta)
        found.append((theta, step))
        theta = (theta + step) % 1.0
    turns, steps = np.array(found[1000:]).T
    return np.column_stack([np.cos(2.0 * np.pi * turns), np.sin(2.0 * np.pi * turns)]), steps.mean()


@pytest.mark.parametrize(
    ("r", "period"),
    [(2.9, 1), (3.3, 2), (3.5, 4), (3.55, 8), (3.566, 16), (3.569, 32), (3.83, 3), (3.845, 6), (3.739, 5)],
)
def test_periods_of_the_logistic_map(r, period):
    found = recurrence(logistic(r, 300))
    assert (found.kind, found.period) == (RecurrenceKind.PERIODIC, period)
    assert found.words == f"period {period}"
    assert found.confidence == 1.0
    # So few points tell it, too: what a bifurcation diagram has of a value.
    few = recurrence(logistic(r, 40))
    assert few.period == (period if period <= 10 else None)


@pytest.mark.parametrize("count", [200, 1000])
@pytest.mark.parametrize(("r", "bands"), [(4.0, 1), (3.9, 1), (3.7, 1), (3.6, 2), (3.58, 4)])
def test_chaos_of_the_logistic_map(r, bands, count):
    """It has two bands between 3.5926 and 3.6785, four between 3.5748 and 3.5926."""
    found = recurrence(logistic(r, count))
    assert (found.kind, found.bands) == (RecurrenceKind.CHAOTIC, bands)
    assert found.confidence > 0.8
    assert found.chaos.K > 0.9 and found.floor > 0.3


def test_maps_and_tones_of_known_kinds():
    """Henon's map, the tongue 1/2 of the circle map, one tone and two, in any units."""
    found = recurrence(henon(500))
    assert found.words == "chaotic" and found.confidence > 0.8
    # The tongue 1/2 has its middle at omega = 1/2, by symmetry.
    found = recurrence(circle_map(200, 0.5, 0.9)[0])
    assert found.words == "period 2"
    k = np.arange(400)
    one = np.cos(2.0 * np.pi * k / 5.0)
    assert recurrence(one).words == "period 5"
    assert recurrence(one + 1e-2 * np.cos(2.0 * np.pi * GOLDEN * k)).words == "quasi-periodic, 5 bands"
    # A rotation by nearly a fifth returns closely, but no less often than it does.
    assert recurrence(np.cos(2.0 * np.pi * (0.2 + 1e-5) * k)).period is None
    points = henon(300) * [1e-3, 1e5]
    assert recurrence(points).words == "chaotic"
    three = np.column_stack([logistic(3.83, 200), 1e9 + logistic(3.83, 200)])
    assert recurrence(three, scale=[1.0, 1.0]).words == "period 3"


@pytest.mark.parametrize(
    ("omega", "coupling"), [(GOLDEN, 0.0), (GOLDEN, 0.8), (0.3335, 0.8), (np.sqrt(2.0) - 1.0, 0.5)]
)
def test_a_circle_map_below_its_tongues_is_quasi_periodic(omega, coupling):
    points, rotation = circle_map(1000, omega, coupling)
    found = recurrence(points)
    assert found.words == "quasi-periodic" and found.confidence == 1.0
    assert abs(found.chaos.K) < 0.1 and found.floor < 1e-2
    away = min(rotation % 1.0, -rotation % 1.0)  # a line has no sign
    assert found.frequency[0] == pytest.approx(away, abs=0.1 / 1000)  # a tenth of a bin


@pytest.mark.parametrize("seed", range(5))
def test_noise_has_no_period(seed):
    for points in (rng(seed).normal(size=400), rng(seed).normal(size=(60, 2)), rng(seed).normal(size=20)):
        assert recurrence(points).period is None
    # Nor is a point with noise on it more than a point, where the tolerance is above the noise.
    about = 3.0 + 1e-5 * rng(seed).normal(size=400)
    assert recurrence(about).words == "period 1"
    assert recurrence(about, tolerance=1e-7).words == "chaotic"  # noise cannot be told from it


def test_too_little_is_not_judged():
    found = recurrence(logistic(4.0, 60))
    assert found.words == "too short to decide (60 points); no period up to 15"
    assert found.confidence == 0.0
    assert recurrence(np.array([1.0, 1.0, 1.0])).kind is RecurrenceKind.TOO_SHORT
    assert recurrence(np.empty(0)).kind is RecurrenceKind.TOO_SHORT
    # What still goes to its fixed point is no motion of any kind.
    for count in (200, 1000):
        assert recurrence(1.0 + 0.5 * 0.99 ** np.arange(count)).kind is RecurrenceKind.TOO_SHORT


# --- the 0-1 test ---


@pytest.mark.parametrize(("r", "K"), [(3.5, 0.0), (3.55, 0.0), (3.83, 0.0), (3.97, 1.0), (4.0, 1.0)])
def test_K_of_the_logistic_map(r, K):
    """Gottwald and Melbourne (2009), Figure 3: K near 0 in periodic windows, near 1 in chaos."""
    found = chaos_test(logistic(r, 2000))
    assert found.K == pytest.approx(K, abs=0.02)
    assert found.verdict is (Chaos.CHAOTIC if K else Chaos.REGULAR)


def test_the_mean_square_displacement_is_the_plain_sum():
    """K of one angle by the definition, loop by loop, against transforms."""
    x = logistic(3.8, 300)
    found = chaos_test(x, angles=3)
    for c, expected in zip(found.angles, found.values, strict=True):
        steps = np.arange(1, 301)
        p, q = (np.cumsum((x - x.mean()) * wave(c * steps)) for wave in (np.cos, np.sin))
        most = 30
        moved = [
            np.mean([(p[j + n] - p[j]) ** 2 + (q[j + n] - q[j]) ** 2 for j in range(300 - most)])
            for n in range(1, most + 1)
        ]
        assert expected == pytest.approx(np.corrcoef(np.arange(1, most + 1), moved)[0, 1], abs=1e-9)


def test_what_the_0_1_test_cannot_say():
    assert chaos_test(logistic(4.0, 150)).verdict is Chaos.TOO_SHORT
    constant = chaos_test(np.full(500, 0.1) + 1e-9 * rng(0).normal(size=500), noise=1e-7)
    assert constant.verdict is Chaos.REGULAR and constant.K == 0.0
    with pytest.raises(InvalidParameterError, match="chaos_test: values must be finite numbers"):
        chaos_test([0.0, np.nan])


# --- transients ---


def test_transients_and_drifts():
    """Where one has died out, and what does not settle."""
    k = np.arange(2000)
    decay = 0.99**k
    found = settled(np.cos(2.0 * np.pi * GOLDEN * k) + 3.0 * decay)
    # 3 * 0.99^k is a hundredth of the motion at 570, a thousandth at 800.
    assert 400 <= found.start <= 850
    louder = settled(np.cos(2.0 * np.pi * GOLDEN * k) * (1.0 + 3.0 * decay))  # in the second moment only
    assert 300 <= louder.start <= 850
    k = np.arange(1000)
    assert settled(1e-3 * k).start is None
    assert "not settled" in settled(np.cos(GOLDEN * k) + 1e-3 * k).words
    assert settled(np.cos(GOLDEN * k) * (1.0 + 1e-3 * k)).start is None
    assert settled(k[:20]).words == "too short to decide (20 points, 32 are needed)"
    k = np.arange(400)
    points = np.cos(2.0 * np.pi * GOLDEN * k) + 1e-4 * k
    assert settled(points, tolerance=5e-2).start == 0
    assert settled(points, tolerance=1e-3).start is None
    with pytest.raises(InvalidParameterError, match="settled: scale must be positive"):
        settled(points, scale=0.0)


def test_stationary_series_are_settled_at_once():
    """By chance one in a hundred is not: 200 series."""
    starts = [settled(rng(seed).normal(size=(400, 2))).start for seed in range(200)]
    assert starts.count(0) >= 192
    for r in (3.3, 3.5, 3.83, 3.7, 4.0):
        assert settled(logistic(r, 100)).start == 0
    assert settled(np.full((64, 2), [0.1, 5.0]) * (1.0 + 1e-15)).start == 0


@pytest.mark.parametrize("multiplier", [0.9, -0.9, 0.99, -0.99])
def test_a_fixed_point_is_not_yet_come_to(multiplier):
    """From one side, or from both in turn: of an alternating way the mean is zero, and it shows."""
    way = 1.0 + 0.3 * multiplier ** np.arange(100)
    assert settled(way, scale=1.0, tolerance=1e-4, whole=True).start is None
    assert settled(1.0 + 1e-5 * way, scale=1.0, tolerance=1e-4, whole=True).start == 0


def test_a_slow_drift_of_a_strange_attractor_shows():
    """The logistic map at 3.9 spans 0.88; its edges, which scatter least, move with it."""
    drift = np.arange(400) / 400.0
    starts = [logistic(3.9, 400 + s)[s:] for s in range(100)]
    seen = [[settled(x + d * drift, whole=True).start is None for x in starts] for d in (0.0, 0.1)]
    assert sum(seen[0]) <= 6 and sum(seen[1]) >= 95


def test_lines_of_a_section():
    k = np.arange(500)
    points = np.column_stack([2.0 * np.cos(2.0 * np.pi * 0.1234 * k), 0.5 * np.cos(2.0 * np.pi * 0.4 * k)])
    frequency, amplitude = section_lines(points)
    assert frequency[:2] == pytest.approx([0.1234, 0.4], abs=0.05 / 500)
    assert amplitude[:2] == pytest.approx([2.0, 0.5], rel=0.02)
    for count in (500, 499):
        frequency, amplitude = section_lines((-1.0) ** k[:count])
        assert frequency[0] == pytest.approx(0.5, abs=1e-3 / count)
        assert amplitude[0] == pytest.approx(1.0, rel=0.04)
