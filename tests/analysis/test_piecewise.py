"""Long runs part by part are the runs as a whole."""

import dataclasses
import importlib

import h5py
import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import (
    blocks,
    body_poses,
    bore_load,
    deviation,
    deviation_measures,
    even,
    growth_of,
    load_statistics,
    resampled,
    samples_around,
    scenario_shares,
    scenario_spans,
    time_mean,
    time_percentiles,
    time_rms,
)
from antenna_pin.analysis.deviation import growths_of
from antenna_pin.analysis.even import EvenSignal, long_amplitudes, long_spectrum, uniform
from antenna_pin.mechanism import kinematics
from antenna_pin.trajectory import on_disk
from antenna_pin.trajectory.file import open_hdf5

MODULES = ("_run", "even", "sampled", "spectrum")


@pytest.fixture
def in_parts(monkeypatch):
    """Make any run of more than so many samples a long one, looked at so many samples at a time."""

    def apply(long, rows):
        for name in MODULES:
            module = importlib.import_module(f"antenna_pin.analysis.{name}")
            for constant, value in (("LONG", long), ("ROWS", rows)):
                if hasattr(module, constant):
                    monkeypatch.setattr(module, constant, value)

    return apply


def walk(count=3000, seed=4):
    """A random series over uneven times, some of them double."""
    rng = np.random.default_rng(seed)
    time = np.sort(rng.uniform(0.0, 3.0, count))
    time[100:110] = time[100]
    return time, rng.standard_normal(count).cumsum()


@pytest.mark.parametrize("rows", [1, 7, 1000])
def test_statistics_over_time_do_not_know_their_parts(in_parts, rows):
    """Sums in another order differ by round-off: 600 terms, each to 1e-16."""
    time, values = walk(600)
    of = (time_mean, time_rms, lambda t, x: time_percentiles(t, x, [0.0, 3.0, 50.0, 99.9, 100.0]))
    whole = [function(time, values) for function in of]
    in_parts(10, rows)
    for expected, function in zip(whole, of, strict=True):
        np.testing.assert_allclose(function(time, values), expected, rtol=1e-12)


@pytest.mark.parametrize("rows", [1, 7, 1000])
@pytest.mark.parametrize("seed", range(2))
def test_growth_does_not_know_its_parts(rows, seed):
    """What is fitted are largest values so far, which no order of work changes: the same bits."""
    time, values = walk(seed=seed)
    values = values * np.exp(1.5 * time)
    parts = [values[k : k + rows, None] for k in range(0, values.size, rows)]
    whole = growth_of(time, values)
    assert growths_of(time, lambda: parts)[0] == whole
    # And it is that of the envelope, written out.
    envelope = np.maximum.accumulate(np.abs(values))
    assert whole.end == time[np.argmax(envelope >= envelope[-1])]


@pytest.mark.parametrize("rows", [130, 700])
def test_a_spline_is_that_of_the_samples_around(in_parts, rows):
    """What a knot does to its 64th neighbour is 1e-37 of it; left is round-off of values up to 1."""
    time = np.linspace(0.0, 3.0, 4001)
    data = xr.Dataset({"x": ("time", np.sin(9.0 * time))}, coords={"time": time})
    at = np.sort(np.random.default_rng(1).uniform(-0.1, 3.1, 5000))
    whole = resampled(time, data["x"].values, at)
    in_parts(10, rows)
    found = np.empty_like(at)
    count = 0
    for some, near in samples_around(data, at):
        found[some] = resampled(near["time"].values, near["x"].values, at[some])
        count += 1
    assert count > 4
    np.testing.assert_allclose(found, whole, rtol=0.0, atol=1e-14)


def test_an_even_grid_part_by_part(in_parts):
    """The cubic is local, and the filter reaches ten points; its sums over a run lose 1e-16 of their size."""
    time, values = walk()
    time = np.linspace(0.0, 3.0, time.size) + 1e-5 * np.sin(np.arange(time.size))
    whole = uniform(time, values)
    signal = EvenSignal(time, lambda a, b: values[a:b])
    assert (signal.size, signal.rate) == (whole.time.size, whole.rate)
    in_parts(10, 97)
    scale = np.abs(whole.values).max()
    np.testing.assert_allclose(signal.values(0, signal.size), whole.values, rtol=0.0, atol=1e-11 * scale)
    np.testing.assert_allclose(signal.values(812, 1999), whole.values[812:1999], rtol=0.0, atol=1e-11 * scale)


def test_mean_spectrum_of_a_long_signal_is_welchs():
    """Three windows of half the signal: the same mean as of all at once, to the round-off of the grid."""
    from antenna_pin.analysis import spectrum

    time = np.arange(4000) / 1e3
    values = np.random.default_rng(2).standard_normal((time.size, 2))
    whole = spectrum(time, values, segment=0.5 * (time[-1] - time[0]))
    found = long_spectrum(time, lambda a, b: values[a:b])
    assert found.attrs["segments"] == whole.attrs["segments"] == 3
    np.testing.assert_allclose(found["power"].values, whole["power"].values, rtol=1e-9)


@pytest.mark.parametrize("trend", ["constant", "linear"])
def test_transform_of_a_long_signal(trend):
    """Of a length that is a product of small primes it is that of all samples, written out."""
    from scipy import signal

    time = np.arange(4000) / 1e3
    values = np.random.default_rng(2).standard_normal(time.size) + 3.0 * time
    found, count, largest, extent = long_amplitudes(EvenSignal(time, lambda a, b: values[a:b]), trend)
    window = signal.get_window("hann", time.size)
    expected = np.abs(np.fft.rfft(signal.detrend(values, type=trend) * window)) / window.sum()
    assert count == time.size
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-13 * np.abs(values).max())
    assert (largest, extent) == (np.abs(values).max(), np.ptp(values))


@pytest.fixture(scope="module")
def runs():
    """The antenna with an ideal elevation joint, and with play in it."""
    return [simulate(load_scenario("bai2020", case=case), duration=0.05) for case in ("case1", "case3")]


def test_a_run_part_by_part(in_parts, runs):
    """Deviations, loads and the load around the bore; sums in another order differ by round-off."""
    case1, case3 = runs
    whole = deviation(case3, case1).measures, load_statistics(case3), bore_load(case3)
    spans, shares = scenario_spans(case3), scenario_shares(case3)
    in_parts(20, 13)
    assert sum(1 for _ in blocks(case3.data)) > 3
    for found, expected in zip(deviation_measures(case3, case1), whole[0], strict=True):
        a, b = (dataclasses.asdict(one) for one in (found, expected))
        assert a.pop("growth")["kind"] == b.pop("growth")["kind"]
        assert [a.pop(key) for key in ("of", "units")] == [b.pop(key) for key in ("of", "units")]
        scale = 1e-9 * max(b["maximum"], 1e-6)  # spline ends: round-off of positions of metres
        assert list(a.values()) == pytest.approx(list(b.values()), rel=1e-9, abs=scale)
    for name, expected in whole[1].data_vars.items():
        np.testing.assert_allclose(load_statistics(case3)[name].values, expected.values, rtol=1e-12)
    np.testing.assert_array_equal(bore_load(case3)["impulse"].values, whole[2]["impulse"].values)
    assert spans.sizes["span"] > 5
    xr.testing.assert_identical(scenario_spans(case3), spans)
    np.testing.assert_allclose(scenario_shares(case3).values, shares.values, rtol=1e-12)


def test_single_samples_of_a_file_are_read_part_by_part(tmp_path, monkeypatch):
    """Whatever is asked for, it is what NumPy gives of the whole."""
    monkeypatch.setattr(on_disk, "_ROWS", 7)
    whole = np.random.default_rng(3).standard_normal((50, 4, 3))
    with h5py.File(tmp_path / "file.h5", "w") as file:
        file["x"] = whole
    lazy = on_disk.Stored(on_disk.StoredFile(tmp_path / "file.h5", open_hdf5), "x").variable(
        ("time", "a", "b"), {}
    )
    rows = np.array([0, 1, 6, 7, 20, 48, 49])
    for key in (
        {"time": rows},
        {"time": rows[::-1], "a": 2},
        {"time": rows, "a": [3, 1], "b": slice(0, 2)},
        {"time": slice(3, 40, 4), "b": [2]},
        {"time": 5, "a": [0, 2]},
        {"time": np.zeros(0, dtype=int), "b": 1},
    ):
        eager = xr.Variable(lazy.dims, whole).isel(key)
        np.testing.assert_array_equal(lazy.isel(key).values, eager.values)
        twice = lazy.isel(time=slice(2, None)).isel(time=[0, 9])
        np.testing.assert_array_equal(twice.values, whole[[2, 11]])


@pytest.mark.parametrize("at_once", [11, 100])
@pytest.mark.parametrize("shape", [(), (3,)])
def test_a_signal_is_thinned_part_by_part(monkeypatch, at_once, shape):
    rng = np.random.default_rng(0)
    time = np.sort(np.concatenate([np.linspace(0.0, 1.0, 1000), rng.random(200)]))
    values = rng.normal(size=(time.size, *shape))
    whole = uniform(time, values).values
    monkeypatch.setattr(even, "_AT_ONCE", at_once)
    assert uniform(time, values).values == pytest.approx(whole, rel=0.0, abs=1e-13)  # round-off


def test_attitudes_do_not_jump_from_part_to_part(monkeypatch, runs):
    whole = body_poses(runs[0])
    monkeypatch.setattr(kinematics, "_AT_ONCE", 7)
    assert body_poses(runs[0]).identical(whole)
