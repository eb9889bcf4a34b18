"""Error indices: closed forms of a step, a sine and a drift, extremes by brute force, what is refused."""

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from antenna_pin.analysis import error_components, pointing_indices
from antenna_pin.errors import InvalidParameterError

# Step [rad] at its time [s], sine's amplitude [rad] and frequency [Hz], drift [rad/s]; span, window, spacing,
# observation period [s]. A window holds two periods of the sine, so that means do not see it.
STEP, TIME, SINE, FREQUENCY, DRIFT = 0.1, 5.0, 0.02, 4.0, 0.01
SPAN, WINDOW, SPACING, PERIOD = 10.0, 0.5, 2.0, 5.0
WINDOWS = {"window": WINDOW, "drift_spacing": SPACING, "periods": PERIOD}


def signal(step=0.0, sine=0.0, drift=0.0, rate=4000):
    """Return times and errors; the step is a jump, two samples at its time."""
    half = np.linspace(0.0, TIME, round(TIME * rate) + 1)
    t = np.concatenate([half, TIME + half])
    error = sine * np.sin(2 * math.pi * FREQUENCY * t) + drift * t
    error[half.size :] += step
    return t, error


# A polygon through samples 1/4000 s apart misses the sine by at most A (w dt)^2 / 8.
POLYGON = SINE * (2 * math.pi * FREQUENCY / 4000) ** 2 / 8


def test_extremes_of_step_sine_and_drift():
    found = pointing_indices(*signal(STEP, SINE, DRIFT), **WINDOWS).sel(component="error")
    w = 2 * math.pi * FREQUENCY
    # Highest at the last crest of sine and drift, a little after the sine's; lowest at the first trough.
    phase = math.acos(-DRIFT / (SINE * w))
    crest = (phase + 2 * math.pi * (SPAN * FREQUENCY - 1)) / w
    trough = (2 * math.pi - phase) / w
    # Just after the step, with the window before it but for a time x: as x grows the mean rises with the step
    # and the error with the sine.
    x = math.acos(STEP / (WINDOW * SINE * w)) / w
    peak = STEP * (1 - x / WINDOW) + SINE * math.sin(w * x) + DRIFT * WINDOW / 2
    means = DRIFT * WINDOW / 2, DRIFT * (SPAN - WINDOW / 2) + STEP
    expected = {
        "APE": (SINE * math.sin(w * trough) + DRIFT * trough, SINE * math.sin(phase) + DRIFT * crest + STEP),
        "MPE": means,
        "RPE": (-peak, peak),
        # Both windows in one period, and the step between the periods: the drift alone.
        "PDE": (DRIFT * SPACING, DRIFT * SPACING),
        "PRE": (-(means[1] - means[0]), means[1] - means[0]),
    }
    for kind, (low, high) in expected.items():
        row = found.sel(index=kind)
        assert row["lowest"].item() == pytest.approx(low, abs=2 * POLYGON), kind
        assert row["highest"].item() == pytest.approx(high, abs=2 * POLYGON), kind
        assert row["extreme"].item() == max(abs(row["lowest"].item()), abs(row["highest"].item()))


def test_extremes_without_the_sine_are_exact():
    """Step and drift are polygons."""
    t, error = np.array([0.0, TIME, TIME, SPAN]), np.array([0.0, DRIFT * TIME, DRIFT * TIME + STEP, 0.2])
    found = pointing_indices(t, error, window=WINDOW, drift_spacing=SPACING).sel(component="error")
    for kind, low, high in (
        ("APE", 0.0, DRIFT * SPAN + STEP),
        ("MPE", DRIFT * WINDOW / 2, DRIFT * (SPAN - WINDOW / 2) + STEP),
        ("RPE", -STEP - DRIFT * WINDOW / 2, STEP + DRIFT * WINDOW / 2),
        ("PDE", DRIFT * SPACING, DRIFT * SPACING + STEP),  # the whole run is one period
    ):
        assert found["lowest"].sel(index=kind).item() == pytest.approx(low, rel=1e-14)
        assert found["highest"].sel(index=kind).item() == pytest.approx(high, rel=1e-14)
    assert "PRE" not in found["index"].values


# --- levels ---


def levels(t, error, confidence, **windows):
    found = pointing_indices(t, error, **windows, confidence=confidence)
    return found["level"].sel(interpretation="temporal", component="error").to_series()


@pytest.mark.parametrize("confidence", [0.683, 0.997])
def test_levels_of_a_sine_are_those_of_the_arc_sine(confidence):
    """Of |A sin| a share c of the time is below A sin(pi c / 2); means over whole periods vanish."""
    found = levels(*signal(sine=SINE), confidence, **WINDOWS)
    expected = SINE * math.sin(math.pi / 2 * confidence)
    assert found["APE"] == pytest.approx(expected, rel=1e-4)  # 1e5 places
    assert found["RPE"] == pytest.approx(expected, rel=1e-3)  # 1e3 x 1e3 places
    for kind in ("MPE", "PDE", "PRE"):
        assert found[kind] < 1e-15


@pytest.mark.parametrize("confidence", [0.683, 0.997])
def test_levels_of_a_drift(confidence):
    """APE and MPE uniform, RPE uniform about zero, PDE one value, PRE the sum of two uniform ones."""
    c, places = confidence, PERIOD - WINDOW
    expected = {
        "APE": c * DRIFT * SPAN,
        "MPE": DRIFT * (WINDOW / 2 + c * (SPAN - WINDOW)),
        "RPE": c * DRIFT * WINDOW / 2,
        "PDE": DRIFT * SPACING,
        "PRE": DRIFT * (PERIOD + places * (1 - math.sqrt(2 * (1 - c)))),
    }
    found = levels(*signal(drift=DRIFT), confidence, **WINDOWS)
    for kind, level in expected.items():
        assert found[kind] == pytest.approx(level, rel=1.5e-3 if kind in ("RPE", "PRE") else 1e-4), kind


def test_levels_of_a_step():
    """The step stands for half the time; windows and pairs of windows see part of it."""
    t, error = signal(step=STEP)
    windows = {"window": WINDOW, "drift_spacing": SPACING}
    assert levels(t, error, 0.49)["APE"] == 0.0
    assert levels(t, error, 0.51)["APE"] == STEP
    places = SPAN - WINDOW
    # The mean rises over a window's length; 40 % of it lie below 0.4 STEP.
    share = (TIME - WINDOW + 0.4 * WINDOW) / places
    assert levels(t, error, share, **windows)["MPE"] == pytest.approx(0.4 * STEP, rel=1e-3)
    # The later window sees it and the earlier does not: a trapezium, SPACING - WINDOW long at the top.
    places, y = SPAN - SPACING - WINDOW, 0.625
    share = 1 - (SPACING + WINDOW * (1 - 2 * y)) / places
    assert levels(t, error, share, **windows)["PDE"] == pytest.approx(y * STEP, rel=1e-3)
    # In a window with the step at a share z of it, the error departs by z STEP after and (1 - z) STEP before.
    window_over = WINDOW / (SPAN - WINDOW)  # share of the windows that contain the step
    level = 0.7  # of both pieces' departures, uniform in z, each lasts as long as the other is large
    # Of 1000 places of the window 53 hold the step.
    above = window_over * 2 * quad(lambda z: 1 - z, level, 1)[0]
    assert levels(t, error, 1 - above, **windows)["RPE"] == pytest.approx(level * STEP, rel=1e-2)


@pytest.mark.parametrize("confidence", [0.683, 0.997])
def test_levels_of_sine_and_drift_together(confidence):
    """In the RPE the sine's phase and the drift's place in the window are independent."""
    half, c = DRIFT * WINDOW / 2, confidence

    def share(level):
        def below(x):
            return math.asin(max(-1.0, min(1.0, x / SINE))) / math.pi

        return quad(lambda v: below(level - v) - below(-level - v), -half, half, limit=200)[0] / (2 * half)

    expected = brentq(lambda level: share(level) - c, 0.0, SINE + half)
    found = levels(*signal(sine=SINE, drift=DRIFT), c, **WINDOWS)
    assert found["RPE"] == pytest.approx(expected, rel=1e-3)
    assert found["MPE"] == pytest.approx(DRIFT * (WINDOW / 2 + c * (SPAN - WINDOW)), rel=1e-4)


def test_levels_reach_the_extremes_at_certainty_and_never_pass_them():
    t, error = signal(STEP, SINE, DRIFT, rate=800)
    certain = pointing_indices(t, error, **WINDOWS, confidence=1.0)
    likely = pointing_indices(t, error, **WINDOWS, confidence=0.9)
    extreme, level = certain["extreme"].values, certain["level"].sel(interpretation="temporal").values
    assert np.all(level <= extreme * (1 + 1e-12))
    assert level == pytest.approx(extreme, rel=5e-3)  # the grid may miss a tip
    assert np.all(likely["level"] <= certain["level"])


# --- vectors ---


def test_a_vector_is_averaged_before_its_length_is_taken():
    """A boresight that circles about a steady offset: its half-cone error varies, its departure does not."""
    t = np.linspace(0.0, SPAN, 10001)
    w = 2 * math.pi * FREQUENCY
    circle = np.column_stack([3e-4 + 1e-4 * np.cos(w * t), 4e-4 + 1e-4 * np.sin(w * t)])
    found = pointing_indices(t, {"half-cone": circle}, **WINDOWS).sel(component="half-cone")
    polygon = 1e-4 * (w * t[1]) ** 2 / 8
    for kind, value in (("APE", 6e-4), ("MPE", 5e-4), ("RPE", 1e-4)):
        assert found["extreme"].sel(index=kind).item() == pytest.approx(value, abs=2 * polygon)
    level = found["level"].sel(interpretation="temporal")
    assert level.sel(index="MPE").item() == pytest.approx(5e-4, rel=1e-9)
    assert level.sel(index="RPE").item() == pytest.approx(1e-4, abs=2 * polygon)
    assert found["extreme"].sel(index="PDE").item() < 1e-15
    assert np.isnan(found["highest"]).all()


def test_a_vector_along_a_line_is_a_number():
    """All indices of (3, 4) x are five times those of x, in extremes and levels."""
    t, error = signal(STEP, SINE, DRIFT, rate=80)
    found = pointing_indices(t, {"number": error, "vector": np.outer(error, [3.0, 4.0])}, **WINDOWS)
    for name in ("extreme", "level"):
        number, vector = (found[name].sel(component=one).values for one in found["component"].values)
        np.testing.assert_allclose(vector, 5 * number, rtol=1e-12)


# --- any polygon ---


def rough(seed, size=40, jumps=3):
    """Return an uneven polygon with jumps and two columns."""
    random = np.random.default_rng(seed)
    t = np.sort(random.uniform(0.0, 1.0, size))
    t = np.sort(np.concatenate([[0.0], t, t[random.integers(0, size, jumps)], [1.0]]))
    return t, np.cumsum(random.normal(size=(t.size, 2)), axis=0)


def by_brute_force(t, x, window, spacing, periods):
    """Return the extremes over a fine grid of places."""
    fine = np.unique(np.concatenate([np.linspace(0.0, 1.0, 4001), t]))
    segment = np.clip(np.searchsorted(t, 0.5 * (fine[1:] + fine[:-1]), side="right") - 1, 0, t.size - 2)

    left, right = (
        x[segment, 0]
        + (x[segment + 1, 0] - x[segment, 0]) * (at - t[segment]) / (t[segment + 1] - t[segment])
        for at in (fine[:-1], fine[1:])
    )
    area = np.concatenate([[0.0], np.cumsum(0.5 * (left + right) * np.diff(fine))])

    def mean(s):
        return (np.interp(s + window, fine, area) - np.interp(s, fine, area)) / window

    starts = np.linspace(0.0, 1.0 - window, 1500)
    relative = []
    for s in starts:
        inside = (fine[1:] > s) & (fine[:-1] < s + window)
        relative += [max(left[inside].max(), right[inside].max()) - mean(s)]
        relative += [min(left[inside].min(), right[inside].min()) - mean(s)]
    places = np.concatenate([np.linspace(low, high - spacing - window, 1500) for low, high in periods])
    drift = mean(places + spacing) - mean(places)
    means = [mean(np.linspace(low, high - window, 1500)) for low, high in periods]
    pairs = [
        (one.min() - two.max(), one.max() - two.min()) for one in means for two in means if one is not two
    ]
    every = mean(starts)
    return {
        "APE": (x[:, 0].min(), x[:, 0].max()),
        "MPE": (every.min(), every.max()),
        "RPE": (min(relative), max(relative)),
        "PDE": (drift.min(), drift.max()),
        "PRE": (min(low for low, _ in pairs), max(high for _, high in pairs)),
    }


@pytest.mark.parametrize("seed", range(2))
def test_extremes_are_those_of_brute_force(seed):
    """A grid of places finds no more than the closed form, and nearly as much."""
    t, x = rough(seed)
    windows = {"window": 0.13, "drift_spacing": 0.17, "periods": [(0.0, 0.35), (0.4, 0.7), (0.7, 1.0)]}
    found = pointing_indices(t, x[:, 0], **windows, resolution=50).sel(component="error")
    for kind, (low, high) in by_brute_force(t, x, 0.13, 0.17, windows["periods"]).items():
        exact = found["lowest"].sel(index=kind).item(), found["highest"].sel(index=kind).item()
        # The brute force counts the grid cells at a window's ends whole: steep pieces by a cell more.
        slack = 1e-9 if kind != "RPE" else np.inf
        assert exact[0] - 1e-12 <= low + slack and high <= exact[1] + 1e-12 + slack
        assert exact == pytest.approx((low, high), abs=0.02 * np.ptp(x[:, 0]))


@pytest.mark.parametrize("seed", range(2))
def test_more_samples_on_the_same_polygon_change_nothing(seed):
    """Means are of the polygon, whatever the samples: uneven ones count for the time between them."""
    t, x = rough(seed, jumps=0)
    extra = np.sort(np.concatenate([t, np.random.default_rng(9).uniform(0.0, 1.0, 200)]))
    finer = np.column_stack([np.interp(extra, t, column) for column in x.T])
    windows = {"window": 0.13, "drift_spacing": 0.3, "periods": 0.5, "resolution": 20}
    before, after = (
        pointing_indices(*pair, **windows)
        for pair in ((t, {"a": x[:, 0], "v": x}), (extra, {"a": finer[:, 0], "v": finer}))
    )
    for name in ("extreme", "level"):
        # Of vectors the direction of the extreme is found by a search, to some 1e-8.
        np.testing.assert_allclose(after[name], before[name], rtol=1e-9)


@pytest.mark.parametrize("seed", range(2))
def test_the_longest_vector_is_found(seed):
    """Extremes of vectors by directions, against all places of a fine grid."""
    t, x = rough(seed)
    found = pointing_indices(t, {"v": x}, window=0.2, resolution=600, confidence=1.0).sel(component="v")
    grid = found["level"].sel(interpretation="temporal")
    exact = found["extreme"]
    assert exact.sel(index="APE").item() == pytest.approx(np.linalg.norm(x, axis=1).max(), rel=1e-12)
    assert np.all(grid <= exact * (1 + 1e-12))
    assert grid.values == pytest.approx(exact.values, rel=0.03)


@pytest.mark.parametrize("seed", range(8))
def test_of_two_vectors_of_nearly_one_length_the_longer_is_found(seed):
    """Wherever they point: the shorter one may be nearer to a direction that is looked along."""
    random = np.random.default_rng(seed)
    angles = random.uniform(0.0, 2 * math.pi, 2) * [1.0, 10.0 ** random.uniform(-3.0, 0.0)] + [0.3, 0.0]
    lengths = np.array([1.0, 1.0 - 10.0 ** random.uniform(-9.0, -2.0)])
    long, short = (lengths * [np.cos(angles), np.sin(angles)]).T
    errors = {"v": np.array([short, [0.0, 0.0], long, [0.0, 0.0], short])}
    found = pointing_indices(np.arange(5.0), errors, resolution=1)
    assert found["extreme"].item() == pytest.approx(1.0, rel=1e-12, abs=0.0)


# --- several runs ---


def test_interpretations_of_several_runs():
    """Ten drifts, the k-th to k: time, runs, and both together."""
    t = np.array([0.0, 1.0])
    runs = [np.array([0.0, k]) for k in range(1, 11)]
    found = pointing_indices([t] * 10, runs, confidence=0.85).sel(index="APE", component="error")
    level = found["level"]
    assert found["extreme"].item() == 10.0
    assert level.sel(interpretation="temporal").item() == pytest.approx(8.5, rel=1e-4)
    assert level.sel(interpretation="ensemble").item() == 9.0  # of ten runs nine are 90 %, eight but 80 %
    mixed = brentq(lambda x: np.mean([min(1.0, x / k) for k in range(1, 11)]) - 0.85, 0.0, 10.0)
    assert level.sel(interpretation="mixed").item() == pytest.approx(mixed, rel=1e-4)
    assert found.attrs["runs"] == 10


def test_runs_of_different_length_count_alike():
    """One run of a second at 1, one of three at 2: half of all is 1."""
    times = [np.array([0.0, 1.0]), np.array([0.0, 3.0])]
    more = {"window": 0.4, "periods": 0.5, "confidence": 0.5, "resolution": 100}
    found = pointing_indices(times, [np.ones(2), 2 * np.ones(2)], **more)
    assert found["level"].sel(interpretation="mixed", index="MPE").item() == pytest.approx(1.0, rel=1e-14)


def test_one_run_has_one_interpretation_of_time():
    found = pointing_indices(*signal(STEP, SINE, DRIFT, rate=160), **WINDOWS)
    level = found["level"]
    assert np.array_equal(level.sel(interpretation="mixed"), level.sel(interpretation="temporal"))
    assert np.array_equal(level.sel(interpretation="ensemble"), found["extreme"])


# --- borders and refusals ---


def test_a_window_or_a_sample_alone():
    """One as long as the run has one place; one sample has an absolute error."""
    t, error = np.array([0.0, 1.0]), np.array([1.0, 3.0])
    found = pointing_indices(t, error, window=1.0).sel(component="error")
    assert found["extreme"].sel(index="MPE").item() == 2.0
    assert (found["lowest"].sel(index="RPE").item(), found["highest"].sel(index="RPE").item()) == (-1.0, 1.0)
    found = pointing_indices([2.0], [-0.3])
    assert found["extreme"].item() == 0.3
    assert list(found["index"].values) == ["APE"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"window": 11.0}, r"window must be at most the run's 10 s, got 11.0"),
        ({"window": 0.0}, r"window must be positive and finite \[s\], got 0.0"),
        ({"window": None}, "window must be given with drift_spacing or periods"),
        ({"drift_spacing": -1.0}, r"drift_spacing must be positive and finite \[s\]"),
        ({"drift_spacing": 4.6}, r"drift_spacing must be at most an observation period's 5 s, got 5.1"),
        ({"drift_spacing": 9.6, "periods": None}, r"drift_spacing must be at most the run's 10 s, got 10.1"),
        ({"periods": 6.0}, r"periods must be such that two of them fit into the run's 10 s, got 6.0"),
        ({"periods": 0.4, "drift_spacing": None}, r"window must be at most an observation period's 0.4 s"),
        ({"periods": [(0.0, 4.0), (3.0, 8.0)]}, "periods must be apart from one another"),
        ({"periods": [(0.0, 4.0), (5.0, 11.0)]}, "periods must be start and end within the run"),
        ({"periods": [(0.0, 4.0)]}, "such that two of them fit"),
        ({"confidence": 0.0}, "confidence must be above 0 and at most 1, got 0.0"),
        ({"confidence": 1.5}, "confidence must be above 0 and at most 1, got 1.5"),
        ({"resolution": 0}, "resolution must be 1 or more, got 0"),
    ],
)
def test_windows_that_do_not_fit_are_refused(changes, message):
    with pytest.raises(InvalidParameterError, match=message) as refused:
        pointing_indices(*signal(rate=16), **WINDOWS | changes)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize(
    ("time", "error", "message"),
    [
        ([0.0, 2.0, 1.0], np.zeros(3), "time must be finite and not decreasing"),
        ([], [], "one sample at least"),
        ([0.0, 1.0], np.zeros(3), r"error must be of shape \(2,\) or \(2, 2\), got \(3,\)"),
        ([0.0, 1.0], {"a": np.zeros((2, 3))}, r"a must be of shape \(2,\) or \(2, 2\), got \(2, 3\)"),
        ([0.0, 1.0], [0.0, math.nan], "error must be finite, got nan"),
        ([np.zeros(2)] * 2, [np.zeros(2)], "error must be one for each of 2 runs, got 1"),
        ([np.zeros(2)] * 2, 0.5, "error must be a list, one for each of 2 runs, got 0.5"),
        ([np.zeros(2)] * 2, [{"a": np.zeros(2)}, {"b": np.zeros(2)}], r"error must be of components \['a'\]"),
    ],
)
def test_signals_that_are_none_are_refused(time, error, message):
    with pytest.raises(InvalidParameterError, match=message):
        pointing_indices(time, error)


def test_components_of_a_pointing_error(tmp_path):
    """Axes as numbers, the half cone as the vector whose length it is."""
    from antenna_pin import load_scenario, simulate
    from antenna_pin.analysis import Command, pointing_error

    run = simulate(load_scenario("bai2020", case="case1"), duration=0.05)
    errors = pointing_error(run, command=Command(direction=(1, 0.1, 0), up=(0, 0, 1)))
    found = error_components(errors)
    assert list(found) == ["boresight", "cross", "up", "half-cone"]
    assert np.linalg.norm(found["half-cone"], axis=1) == pytest.approx(errors["half_cone"].values, rel=1e-14)
    indices = pointing_indices(errors["time"].values, found)
    extreme = indices["extreme"].sel(index="APE", component="half-cone").item()
    assert extreme == pytest.approx(errors["half_cone"].values.max(), rel=1e-12)
