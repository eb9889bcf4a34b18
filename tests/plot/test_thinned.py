"""What a long run is drawn with shows all that there is."""

import numpy as np
import pytest
import xarray as xr

from antenna_pin.show.plot import _thinned, contacts
from antenna_pin.show.plot._runs import labelled
from antenna_pin.show.plot._style import new_figure
from antenna_pin.show.plot._thinned import between_spikes, closer, telling, thinned, turning

COUNT = 60_000
PARTS = 300


@pytest.fixture
def run(monkeypatch):
    """A long run: noise with a spike, a gap of NaN, and two samples at one instant."""
    monkeypatch.setattr(_thinned, "LONG", 10_000)
    monkeypatch.setattr(_thinned, "_PARTS", PARTS)
    rng = np.random.default_rng(5)
    time = np.sort(rng.uniform(0.0, 10.0, COUNT))
    time[31_001] = time[31_000]
    value = rng.standard_normal(COUNT)
    value[12_345] = 1e3
    value[40_000:40_777] = np.nan
    data = xr.Dataset({"x": ("time", value), "y": ("time", 50.0 * time)}, coords={"time": time})
    return labelled([("noise", data)])[0]


def columns(part):
    return [part.values("x")]


def test_every_part_keeps_its_extremes_and_ends(run):
    """Exactly: samples are kept or not, none is changed."""
    fewer = thinned(run, columns)
    assert fewer.time.size < 2 + 4 * PARTS + 4 * 2050 + 10
    assert fewer.many and fewer.whole is run
    np.testing.assert_array_equal(run.values("x")[fewer.kept], fewer.values("x"))
    edges = np.linspace(run.time[0], run.time[-1], PARTS + 1)[1:-1]
    lost = 0
    for whole, kept in zip(
        np.split(run.values("x"), np.searchsorted(run.time, edges)),
        np.split(fewer.values("x"), np.searchsorted(fewer.time, edges)),
        strict=True,
    ):
        known, seen = whole[np.isfinite(whole)], kept[np.isfinite(kept)]
        assert known.size == 0 or (seen.min(), seen.max()) == (known.min(), known.max())
        lost += known.size - seen.size
        # A line is broken where it was broken.
        assert np.isnan(whole).any() == np.isnan(kept).any()
    assert lost > COUNT // 2
    edge = np.flatnonzero(np.diff(np.isnan(run.values("x"))))
    assert np.isin(np.concatenate([edge, edge + 1]), fewer.kept).all()


def test_size_between_spikes_is_that_of_all_samples(run):
    """It is told at even instants, whose neighbours are kept: the same bits."""
    fewer = thinned(run, columns)
    assert between_spikes(fewer.time, fewer.values("y")) == between_spikes(run.time, run.values("y"))


def test_a_close_view_has_every_sample(run):
    """And the one beyond either edge, to which lines go; thinned runs have one by chance in two of ten."""
    fewer = thinned(run, columns)
    for start in np.random.default_rng(2).uniform(0.5, 9.0, 30):
        near = closer(fewer, (start, start + 0.3), columns)
        first, last = np.searchsorted(run.time, (start, start + 0.3))
        assert np.isin(np.arange(first - 1, last + 1), near.kept).all()
        beyond = np.setdiff1d(near.kept, np.arange(first - 1, last + 1))
        np.testing.assert_array_equal(beyond, np.setdiff1d(fewer.kept, np.arange(first - 1, last + 1)))


def test_an_angle_goes_on_as_with_all_samples(run):
    """500 rad in 300 parts: ends of parts alone would be off by whole turns."""
    whole = np.unwrap(run.values("y") % (2.0 * np.pi))

    def angle(part):
        wrapped = part.values("y") % (2.0 * np.pi)
        return [turning(wrapped)]

    fewer = thinned(run, angle)
    # The sum of turns is to round-off of 500.
    np.testing.assert_allclose(np.unwrap(fewer.values("y") % (2.0 * np.pi)), whole[fewer.kept], atol=1e-10)


def test_a_short_run_is_left_as_it_is(run, monkeypatch):
    monkeypatch.setattr(_thinned, "LONG", COUNT)
    assert thinned(run, columns) is run
    assert closer(run, (1.0, 2.0), columns) is run


def test_telling_points_of_a_spectrum():
    place, value = np.log(np.arange(1, 100_001)), np.random.default_rng(1).uniform(size=100_000)
    kept = telling(place, value)
    assert kept.size < 4 * 4096
    assert {0, 99_999, int(np.argmax(value)), int(np.argmin(value))} <= set(kept.tolist())


def test_a_hundred_thousand_bars_are_as_many_as_are_seen():
    """Contacts of a long run: gaps far below a pixel are closed, and nothing else; shares are exact."""
    rng = np.random.default_rng(7)
    edges = np.cumsum(rng.uniform(0.0, 1e-3, 200_000))
    spans = xr.Dataset(
        {
            "start": ("span", edges[:-1]),
            "end": ("span", edges[1:]),
            "radial": ("span", np.arange(edges.size - 1) % 2, {"flag_values": np.arange(2)}),
        }
    )
    axes = new_figure("page", 60.0).add_subplot()
    window = (0.0, float(edges[-1]))
    (bars,) = contacts._time_line(spans, "radial", window, ["apart", "pressed"], 4).marks
    bars.draw(axes, 1.0, 1.0)
    shares = contacts._shares(spans, "radial", window)
    assert shares.sum() == pytest.approx(1.0 - edges[0] / edges[-1], rel=1e-12)
    for k, patch in enumerate(axes.patches):
        corners = patch.get_path().vertices.reshape(-1, 5, 2)[:, :, 0]
        start, end = corners[:, 0], corners[:, 2]
        assert 0 < start.size <= contacts._FINEST
        mine = spans["radial"].values == k
        assert np.isin(start, edges[:-1][mine]).all() and np.isin(end, edges[1:][mine]).all()
        own = np.searchsorted(start, edges[:-1][mine], side="right") - 1
        assert (edges[1:][mine] <= end[own]).all()
        assert (start[1:] - end[:-1] > edges[-1] / contacts._FINEST).all()
