"""Profiles of likelihoods against parabolas, exact ones, and those that never rise."""

import numpy as np
import pytest
import xarray as xr
from known_curves import Curve, decay, line, oscillator
from scipy.optimize import brentq

from antenna_pin.errors import AntennaPinError, InvalidParameterError
from antenna_pin.studies.fit.profile_likelihood import profile_lines, profiles
from antenna_pin.studies.fit.uncertainty import sure


def test_of_a_linear_model_the_profile_is_a_parabola(times):
    """Its signed root is a straight line, and its interval that of Student's t."""
    noise = np.random.default_rng(1).standard_normal(times.size)
    model = line(times, 2.0 + 0.5 * times + 0.1 * noise, 0.1)
    found = sure(model, model.best())
    for place, one in enumerate(profiles(model, found)):
        expected = (one.values - found.values[place]) / found.error[place]
        assert one.root == pytest.approx(expected, abs=1e-6)  # of a root of a difference of sums, sqrt(1e-12)
        assert (one.low, one.high) == pytest.approx((found.low[place], found.high[place]), rel=1e-7)
        assert one.ends == ("crossed", "crossed") and one.better is None
        assert np.all(np.diff(one.values) > 0.0)


def test_the_profile_of_a_rate_is_the_exact_one_and_lies_to_one_side(times):
    """With the amplitude eliminated: A(k) = y.e / e.e, S(k) = y.y - (y.e)^2 / e.e, e = exp(-k t)."""
    noise = np.random.default_rng(4).standard_normal(times.size)
    model = decay(times, 2.0 * np.exp(-1.3 * times) + 0.4 * noise, 0.4)
    best = model.best()
    found = sure(model, best, noise="given")
    (rate,) = profiles(model, found, ["rate"])

    def growth(k: float) -> float:
        e, y = np.exp(-k * times), model.record
        return float((y @ y - (y @ e) ** 2 / (e @ e)) / model.sd**2)

    least, limit = growth(best[1]), 1.959963984540054**2
    low = brentq(lambda k: growth(k) - least - limit, 0.05, best[1])
    high = brentq(lambda k: growth(k) - least - limit, best[1], 10.0)
    # The crossing is found to 1e-3 of the threshold, and by a secant from there.
    assert (rate.low, rate.high) == pytest.approx((low, high), rel=1e-4)
    assert rate.high - best[1] > 1.2 * (best[1] - rate.low)  # fast decays are told less well than slow ones
    assert found.high[1] < rate.high
    e = np.exp(-np.multiply.outer(rate.values, times))
    assert rate.others[:, 0] == pytest.approx(e @ model.record / (e * e).sum(axis=1), rel=1e-6)


def test_what_cannot_be_told_has_an_open_profile_along_which_the_other_goes_with_it(times):
    noise = 0.02 * np.random.default_rng(2).standard_normal(times.size)
    model = oscillator(times, np.cos(5.0 * times) + noise, 0.02)
    best = model.best()
    found = sure(model, best)
    mass, _ = profiles(model, found)
    assert mass.ends == ("bounded", "open")
    assert mass.low == 1e-3 and mass.high == np.inf
    assert np.abs(mass.root).max() < 1e-2  # flat, to what the inner fits are converged to
    assert mass.others[:, 1] / mass.values == pytest.approx(best[1] / best[0], rel=1e-6)


def test_where_a_side_ends(times):
    """At a bound, and where the model cannot be run."""
    noise = np.random.default_rng(1).standard_normal(times.size)
    record = 2.0 + 0.01 * times + 0.1 * noise
    model = line(times, record, 0.1, lower=np.array([-np.inf, 0.0]))
    found = sure(model, model.best(), noise="given")
    assert found.low[1] < 0.0 < found.values[1]
    (slope,) = profiles(model, found, ["slope"])
    assert slope.ends == ("bounded", "crossed") and slope.low == 0.0
    assert slope.high == pytest.approx(found.high[1], rel=1e-6)

    def model_of(t, x):
        if x[1] > 0.52:
            raise AntennaPinError("no run")
        return x[0] + x[1] * t

    base = line(times, 2.0 + 0.5 * times + 0.1 * np.random.default_rng(1).standard_normal(times.size), 0.1)
    model = Curve(base.names, times, model_of, base.slopes, base.record, np.array([2.0, 0.49]), 0.1)
    found = sure(model, base.best(), noise="given")
    (slope,) = profiles(model, found, ["slope"])
    assert slope.ends == ("crossed", "stopped") and slope.high <= 0.52
    assert slope.low == pytest.approx(found.low[1], rel=1e-6)
    model = line(times, 0.0 * times)
    found = sure(model, np.zeros(2))
    with pytest.raises(
        InvalidParameterError, match="noise must be given where the model meets the record exactly"
    ):
        profiles(model, found)


def test_a_better_fit_on_the_way_is_said(times):
    """Two valleys: from the worse of them the profile leads over into the better one."""
    record = np.sin(4.0 * times)
    model = Curve(
        ("frequency",),
        times,
        lambda t, x: np.sin(x[0] * t),
        lambda t, x: (t * np.cos(x[0] * t))[:, None],
        record,
        np.array([1.0]),
    )
    worse = model.best()
    assert abs(worse[0] - 4.0) > 1.0
    found = sure(model, worse)
    (one,) = profiles(model, found)
    if one.better is None:  # the hill between them is higher than the threshold: nothing was met
        assert one.ends == ("crossed", "crossed")
    wide = sure(model, worse, level=1.0 - 1e-12)
    (one,) = profiles(model, wide)
    assert one.better is not None
    assert model.residuals(one.better) @ model.residuals(one.better) < wide.chi_squared


@pytest.mark.parametrize(
    ("how", "ends", "words"),
    [
        (("crossed", "crossed"), (0.9e-3, 1.2e-3), "by its profile from 0.9 to 1.2 mm (95 %)"),
        (("crossed", "open"), (0.9e-3, np.inf), "0.9 mm or more: above the records do not bound it (95 %)"),
        (("open", "crossed"), (-np.inf, 1.2e-3), "1.2 mm or less: below the records do not bound it (95 %)"),
        (("open", "open"), (-np.inf, np.inf), "any value: the records do not bound it, as far as was looked"),
        (("bounded", "stopped"), (0.0, 1.2e-3), "from 0 mm, its bound to 1.2 mm, beyond which the model can"),
    ],
)
def test_profiles_say_how_they_end(how, ends, words):
    over = ("parameter",)
    table = xr.Dataset(
        {
            "value": (over, [1e-3, 2.0]),
            "units": (over, ["m", ""]),
            "profile_end": (("parameter", "side"), [ends, (np.nan, np.nan)]),
            "profile_how": (("parameter", "side"), [how, ("", "")]),
        },
        coords={"parameter": ["play", "held"]},
    )
    (line,) = profile_lines(table)  # the other one has no profile
    assert line.startswith("play: ") and words in line.replace("\N{NO-BREAK SPACE}", " ")
