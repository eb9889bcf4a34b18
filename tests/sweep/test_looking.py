"""What is made of a study: sensitivities against closed forms, quantiles, figures, tables, a report."""

import json
import math

import numpy as np
import pytest
import xarray as xr
from matplotlib.text import Text
from typer.testing import CliRunner

from antenna_pin import open_study, run_study
from antenna_pin.errors import InvalidParameterError, UnknownNameError
from antenna_pin.show import plot
from antenna_pin.show.report import study_report
from antenna_pin.studies.sweep import TrialRun, sensitivities
from antenna_pin.studies.sweep.sensitivity import quantiles

THREE = """
[parameters.a]
key = "clearance.bore.radial_clearance"
between = [0.1, 0.2]
[parameters.b]
key = "clearance.bore.bearing_radius"
between = [1, 3]
[parameters.c]
key = "clearance.bore.normal.restitution"
between = [0, 1]
"""


@pytest.fixture
def sampled(write, tmp_path, fake, monkeypatch):
    """Return a function that makes a study whose response is a function of the unit cube."""
    monkeypatch.setattr("antenna_pin.studies.sweep.driver._check", lambda *_: None)
    monkeypatch.setattr("antenna_pin.studies.sweep.driver.trial", lambda *_: TrialRun(1.0))

    def made(method, count, function):
        study = write(THREE, f'sampling = {{ method = "{method}", count = {count} }}')
        table = run_study(study, tmp_path / f"{method}.study", executor=fake())
        table["force"].values[:] = function(*table["probability"].values.T)
        table["outcome"].values[:] = "COMPLETED"
        return table

    return made


def test_sobol_indices_of_ishigami_s_function(sampled):
    """The usual benchmark (a = 7, b = 0.1), whose indices are known in closed form."""

    def ishigami(u, v, w):
        x, y, z = (2.0 * np.pi * one - np.pi for one in (u, v, w))
        return np.sin(x) + 7.0 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)

    found = sensitivities(sampled("saltelli", 2048, ishigami), "force")
    # The sampling error of 2048 base points; the intervals say as much.
    assert np.abs(found["first"].values - [0.3139, 0.4424, 0.0]).max() < 0.04
    assert np.abs(found["total"].values - [0.5576, 0.4424, 0.2437]).max() < 0.04
    assert (np.abs(found["total"].values - [0.5576, 0.4424, 0.2437]) < 2.0 * found["total_conf"].values).all()


def test_effects_of_a_linear_response_are_its_coefficients(sampled):
    found = sensitivities(sampled("morris", 8, lambda u, v, w: 3.0 * u - 2.0 * v), "force")
    assert found["mu"].values == pytest.approx([3.0, -2.0, 0.0], abs=1e-12)
    assert found["mu_star"].values == pytest.approx([3.0, 2.0, 0.0], abs=1e-12)
    assert found["sigma"].values == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert found["mu_star"].attrs["units"] == "N"


def test_sensitivities_need_their_design_and_all_runs(sampled):
    table = sampled("random", 8, lambda u, v, w: u)
    with pytest.raises(InvalidParameterError, match="sampled with method"):
        sensitivities(table, "force")
    table = sampled("morris", 4, lambda u, v, w: u)
    table["force"].values[3] = np.nan
    with pytest.raises(InvalidParameterError, match="1 missing"):
        sensitivities(table, "force")
    table["force"].values[:] = 2.0
    with pytest.raises(InvalidParameterError, match="of different values, got 2 in all"):
        sensitivities(table, "force")
    # Values of standard deviation 1 are different ones.
    table["force"].values[:] = np.where(np.arange(table["force"].size) % 2, 1.0, -1.0)
    sensitivities(table, "force")


@pytest.mark.parametrize("count", [1, 8, 20, 101])
@pytest.mark.parametrize("confidence", [0.8, 0.95])
def test_intervals_of_quantiles_are_between_ranks(count, confidence):
    """Of runs 1 to n the narrowest two whose tails, sums of binomials, are within what is left, on each side.

    The l-th run lies above the quantile if fewer than l lie below it.
    """
    runs = np.random.default_rng(count).permutation(np.append(np.arange(1.0, count + 1), np.nan))
    shares, tail = (0.05, 0.5, 0.9), 0.5 * (1.0 - confidence)
    found = quantiles(xr.Dataset({"force": ("sample", runs)}), "force", shares, confidence)
    assert found.attrs["runs"] == count
    for k, share in enumerate(shares):
        below = np.cumsum(
            [math.comb(count, j) * share**j * (1.0 - share) ** (count - j) for j in range(count)]
        )
        low = [rank for rank in range(1, count + 1) if below[rank - 1] < tail]
        high = [rank for rank in range(1, count + 1) if below[rank - 1] >= 1.0 - tail]
        assert found["quantile"].values[k] == pytest.approx(1.0 + share * (count - 1), rel=1e-12)
        for name, rank in (("low", low[-1:]), ("high", high[:1])):
            np.testing.assert_equal(found[name].values[k], float(rank[0]) if rank else np.nan)
    with pytest.raises(UnknownNameError, match="response 'forse' is unknown; did you mean force"):
        quantiles(xr.Dataset({"force": ("sample", runs)}), "forse")


def test_a_map_has_every_value_in_its_place(write, tmp_path, fake):
    table = run_study(write(), tmp_path / "grid.study", executor=fake())
    figure = plot.study_map(table, "force", "rate", "play")
    mesh = figure.axes[0].collections[0]
    field = np.asarray(mesh.get_array()).reshape(3, 4)  # rows are play, columns rate
    assert field == pytest.approx(table["force"].values, rel=1e-14)
    assert figure.axes[0].get_xlabel() == "Rate [Hz]" and figure.axes[0].get_ylabel() == "Play [mm]"


def test_every_figure_is_drawn_and_says_what_it_leaves_out(write, tmp_path, fake, sampled):
    grid = run_study(write(), tmp_path / "grid.study", executor=fake())
    grid["force"].values[1, 2] = np.nan
    for table in (grid, sampled("latin-hypercube", 16, lambda u, v, w: u * v)):
        names = [figure.name for figure in plot.study_figures(table)]
        assert len(set(names)) == len(names) >= 4
        for figure in plot.study_figures(table):
            assert plot.rendered(figure.draw(width="column"), "png", 40.0).startswith(b"\x89PNG")
    drawn = plot.study_response(grid, "force", "play")
    assert "1 of 12 runs without a result" in drawn.get_supxlabel()
    lines = [line for line in drawn.axes[0].lines if len(line.get_xdata())]
    assert sum(len(line.get_xdata()) for line in lines) == 11


def test_numbers_of_a_figure_lie_over_nothing(write, tmp_path, fake, sampled):
    """Quantiles as near one another as may be stand above their lines; a map's contours in its bar."""
    table = sampled("random", 400, lambda u, v, w: 2000.0 + 1e-3 * u)
    axes = plot.study_distribution(table, "force").axes[0]
    title = axes.get_title("left")
    assert title.count("%:\N{NO-BREAK SPACE}2000") == 4
    assert len({one.split(":")[1] for one in title.split(";")}) == 4  # as many digits as tell them apart
    axes.figure.draw_without_rendering()
    (words,) = axes.findobj(lambda one: isinstance(one, Text) and one.get_text() == title)
    box = words.get_window_extent()
    assert box.y0 >= axes.get_window_extent().y1 and box.x1 <= axes.figure.bbox.x1
    assert not [text for panel in axes.figure.axes for text in panel.texts]

    grid = run_study(write(), tmp_path / "grid.study", executor=fake())
    axes, bar = plot.study_map(grid, "force", "rate", "play").axes
    assert not axes.texts
    (contours,) = axes.collections[1:]
    levels = [line[0][1] for line in bar.collections[-1].get_segments()]
    low, high = bar.get_ylim()
    inside = [level for level in contours.levels if low < level < high]
    assert len(inside) > 3
    assert levels[1:-1] == pytest.approx(inside, abs=1e-12)  # the bar's ends are no contours


def test_report_and_tables_tell_of_failures(write, tmp_path, fake):
    from antenna_pin.apps.cli import app

    folder = tmp_path / "trial.study"
    table = run_study(write(), folder, executor=fake())
    html = study_report(table, figures=False).html
    assert html.count("too deep</td>") == 6  # outcome and reason of runs 0, 5 and 10
    assert "12 of 12 runs made; 3 did not reach their end" in html
    assert "Runs that are not whole: 3 did not reach their end" in html
    assert "not balance" not in html  # each run has one fault
    shown = CliRunner().invoke(app, ["study", "show", str(folder), "--json"])
    rows = json.loads(shown.stdout)["runs"]
    assert [row["force"] for row in rows] == np.ravel(table["force"].values).tolist()
    assert rows[5]["play"] == 2e-4 and rows[5]["outcome"] == "TOO_DEEP"
    text = CliRunner().invoke(app, ["study", "show", str(folder)]).stdout
    assert "play = 0.0002 m, rate = 2000 Hz" in text
    assert open_study(folder).attrs["method"] == "grid"


def test_runs_that_only_lack_a_response_are_not_called_unfinished(write, tmp_path, fake):
    """Heading and table count the same runs, by the same words."""
    table = run_study(write(), tmp_path / "trial.study", executor=fake())
    table["outcome"].values[...], table["force"].values[...] = "COMPLETED", np.nan
    html = study_report(table, figures=False).html
    assert "12 of 12 runs made; 12 lack a response" in html and "not whole: 12 lack a response" in html
    assert "reach" not in html.partition("<body")[2].partition("Provenance")[0]
