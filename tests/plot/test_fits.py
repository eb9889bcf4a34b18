"""Figures of fits and of what tests tell show the numbers of the datasets."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show.plot import (
    correlations,
    curves_of_fit,
    figure_correlation,
    figure_experiments,
    figure_fit,
    figure_identifiability,
    figure_profiles,
    table_figures,
)

TIMES = np.linspace(0.0, 1.0, 11)


def fit(columns=("tip",), profile=True, covariance=((4.0, 1.98), (1.98, 1.0))):
    """Return a fit of two parameters to curves of eleven rows each, off by one standard deviation."""
    count = len(columns) * TIMES.size
    model = np.tile(2e-4 * np.cos(TIMES), len(columns))
    rows = {
        "model": model,
        "data": model - 1e-5,
        "noise": np.full(count, 1e-5),
        "at": np.tile(TIMES, len(columns)),
    }
    ends = {
        "band_low": model - 5e-6,
        "band_high": model + 5e-6,
        "new_low": model - 3e-5,
        "new_high": model + 3e-5,
    }
    words = {"record": ["swing"] * count, "measure": ["reading"] * count, "unit": ["m"] * count}
    words["column"] = list(np.repeat(columns, TIMES.size))
    found = xr.Dataset(
        {
            **{name: ("row", one) for name, one in (rows | ends | words).items()},
            "value": ("parameter", [10.0, 3.0]),
            "sd": ("parameter", np.sqrt(np.diag(np.array(covariance)))),
            "covariance": (("parameter", "other"), np.array(covariance)),
            "title": ("parameter", ["play", "stiffness"]),
            "units": ("parameter", ["m", "N/m"]),
        },
        coords={"parameter": ["play", "k"], "other": ["play", "k"]},
        attrs={"format": "antenna_pin fit 1"},
    )
    if not profile:
        return found
    values = np.array([[6.0, 8.0, 10.0, 14.0, 18.0], [3.0, 5.0, np.nan, np.nan, np.nan]])
    roots = np.array([[-2.0, -1.0, 0.0, 1.0, 2.0], [0.0, 0.5, np.nan, np.nan, np.nan]])
    return found.assign(
        profile_value=(("parameter", "step"), values),
        profile_root=(("parameter", "step"), roots),
        profile_end=(("parameter", "side"), np.array([[6.1, 17.7], [3.0, np.inf]])),
        profile_how=(
            ("parameter", "side"),
            np.array([["crossed", "crossed"], ["bounded", "open"]], dtype=object),
        ),
        profile_reach=((), 1.96),
    )


def _said(figure):
    return figure._supxlabel.get_text().replace("\n", " ")


def test_a_record_stands_against_the_model_and_its_residuals_in_standard_deviations():
    figure = figure_fit(fit())
    above, below = figure.axes
    assert above.get_ylabel() == "reading [mm]" and above.get_title(loc="left") == "$\\bf{(a)}$ swing: tip"
    drawn = {line.get_label(): line.get_ydata() for line in above.get_lines()}
    assert drawn["fitted model"] == pytest.approx(0.2 * np.cos(TIMES), rel=1e-12)
    assert drawn["measured"] == pytest.approx(0.2 * np.cos(TIMES) - 0.01, rel=1e-12)
    (residuals,) = (line.get_ydata() for line in below.get_lines() if len(line.get_ydata()) == TIMES.size)
    assert residuals == pytest.approx(np.ones(TIMES.size), rel=1e-9)
    assert above.get_title(loc="right") == "residuals' rms 1 sd"
    assert len(above.collections) == 2 and "95 %" in _said(figure)
    assert not figure_fit(fit(), bands=False).axes[0].collections


def test_many_curves_are_drawn_in_several_figures():
    found = fit(["a", "b", "c", "d", "e"])
    assert curves_of_fit(found)[-1] == "swing: e"
    assert len(figure_fit(found).axes) == 8 and "1 more curve not drawn" in _said(figure_fit(found))
    assert [one.name for one in table_figures(found)] == ["fit-1", "fit-2", "correlation", "profiles"]
    with pytest.raises(UnknownNameError, match="swing: e"):
        figure_fit(found, ["swing: f"])


def test_correlations_are_those_of_the_covariance_and_strong_ones_bold():
    assert correlations(fit())[0, 1] == pytest.approx(0.99, rel=1e-12)
    figure = figure_correlation(fit())
    texts = {text.get_text(): text.get_weight() for text in figure.axes[0].texts}
    assert texts == {"1.00": "normal", "0.99": "bold"}
    assert "hardly distinguishable" in _said(figure)


def test_what_is_not_told_has_no_correlation():
    lost = fit(covariance=((4.0, np.nan), (np.nan, np.inf)))
    found = correlations(lost)
    assert found[0, 0] == 1.0 and np.isnan(found[0, 1]) and np.isnan(found[1, 1])
    assert "1 at a bound, or not identifiable" in _said(figure_correlation(lost))


def test_profiles_show_growth_ends_and_the_parabola():
    figure = figure_profiles(fit())
    one, other = figure.axes[:2]
    dots = next(line for line in one.get_lines() if line.get_marker() == "o")
    assert list(dots.get_ydata()) == [4.0, 1.0, 0.0, 1.0, 4.0]
    parabola = next(line for line in one.get_lines() if line.get_label() == "by the standard error")
    x, y = parabola.get_xdata(), parabola.get_ydata()
    assert y == pytest.approx(((np.array(x) - 10.0) / 2.0) ** 2, rel=1e-12)
    assert one.get_xlabel() == "play [m]" and other.get_xlabel() == "k [N/m]"
    assert "no end found on a side" in _said(figure) and "ends at the parameter's bound" in _said(figure)
    with pytest.raises(InvalidParameterError, match="one with profiles"):
        figure_profiles(fit(profile=False))


def test_of_a_logarithm_the_parabola_and_a_wide_axis_are_its():
    """A profile that is exactly a parabola of the logarithm lies on that of the standard error."""
    values = 10.0 * np.exp([-2.0, -1.0, 0.0, 1.0, 2.0])
    found = xr.Dataset(
        {
            "value": ("parameter", [10.0]),
            "sd": ("parameter", [10.0 * 1.0]),  # of the logarithm 1
            "units": ("parameter", ["N/m"]),
            "title": ("parameter", ["k"]),
            "logarithmic": ("parameter", [1.0]),
            "profile_value": (("parameter", "step"), [values]),
            "profile_root": (("parameter", "step"), [[-2.0, -1.0, 0.0, 1.0, 2.0]]),
            "profile_end": (("parameter", "side"), [[10.0 * np.exp(-1.96), 10.0 * np.exp(1.96)]]),
            "profile_how": (("parameter", "side"), [["crossed", "crossed"]]),
            "profile_reach": 1.96,
        },
        coords={"parameter": ["k"]},
    )
    (axes,) = figure_profiles(found).axes
    assert axes.get_xscale() == "log" and axes.get_xlim()[0] > 0.0
    drawn = {line.get_label(): line for line in axes.get_lines()}
    for name in ("profile", "by the standard error"):
        x, y = (np.asarray(one) for one in drawn[name].get_data())
        assert y == pytest.approx(np.log(x / 10.0) ** 2, abs=1e-12)  # round-off of an interpolation


def test_what_a_test_tells_is_drawn_over_sizes_and_lost_parameters_as_arrows():
    found = xr.Dataset(
        {
            "title": ("parameter", ["play", "k"]),
            "scale": ("parameter", [2.0, 4.0]),
            "half": ("parameter", [0.2, np.inf]),
            "alone": ("parameter", [0.05, 1.0]),
            "part": (("direction", "parameter"), np.eye(2)),
            "singular": ("direction", [20.0, 0.0]),
        },
        attrs={"level": 0.95, "quantile": 2.0},
    )
    left, right = figure_identifiability(found).axes
    told, lost = (line.get_xdata() for line in left.get_lines() if len(line.get_xdata()) == 2)
    assert told == pytest.approx([5.0, 10.0]) and lost[0] == pytest.approx(50.0)
    assert [label.get_text() for label in right.get_yticklabels()] == ["0.05", "∞"]
    assert {text.get_text() for text in right.texts} == {"+1.00"}


def test_experiments_stand_in_order_with_what_is_known_before():
    found = xr.Dataset(
        {
            "half": (("experiment", "parameter"), np.array([[0.2, 3.0], [0.4, np.inf]])),
            "before": ("parameter", [0.8, np.inf]),
            "scale": ("parameter", [2.0, 4.0]),
            "title": ("parameter", ["play", "k"]),
        },
        coords={"experiment": ["far", "near"], "parameter": ["play", "k"]},
        attrs={"level": 0.95, "criterion": "c", "wanted": "play"},
    )
    figure = figure_experiments(found)
    one, other = figure.axes
    assert [label.get_text() for label in one.get_yticklabels()] == ["far", "near"]
    dots = [
        line.get_xdata()[0] for line in one.get_lines() if line.get_marker() == "o" and len(line.get_xdata())
    ]
    assert dots == pytest.approx([10.0, 20.0])
    assert one.get_title(loc="left") == "play (wanted)"
    assert any(list(line.get_xdata()) == [40.0, 40.0] for line in one.get_lines())
    assert [line.get_marker() for line in other.get_lines()].count(">") == 1
    assert "in order of c of play" in _said(figure)


def test_a_dataset_of_another_kind_has_no_figures():
    with pytest.raises(InvalidParameterError, match="a fit to measured records"):
        list(table_figures(xr.Dataset(attrs={"format": "other"})))
