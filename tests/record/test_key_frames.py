"""Key frames: a regular rate and every impact, within a limit."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.errors import InvalidParameterError
from antenna_pin.show.record import record
from antenna_pin.show.record.key_frames import Impacts, key_frames, rate_of_turns


def impacts(onsets, peak=1.0):
    onsets = np.array(onsets, dtype=float)
    events = np.array([onsets, onsets + 1e-4, onsets + 2e-4])
    peaks = peak * np.arange(1.0, len(onsets) + 1.0)
    return Impacts(events[1], peaks, np.zeros(len(onsets), dtype=np.int64), events)


NONE = impacts([])


def samples(events):
    """1 kHz for 1 s and the events; both sides of an event are there, at the same time."""
    return np.sort(np.concatenate([np.linspace(0.0, 1.0, 1001), events.ravel(), events.ravel()]))


def test_a_regular_rate_and_every_onset_peak_and_release():
    found = impacts([0.12345, 0.50007, 0.9])
    times = samples(found.events)
    frames = key_frames(times, found, 50.0, 0.0, 1.0)
    kept = times[frames.indices]
    assert (np.diff(kept) > 0.0).all()
    assert np.isin(found.events, kept).all()
    # The nearest sample to a regular time is at most half a sampling step away.
    regular = np.linspace(0.0, 1.0, 51)
    assert np.abs(kept[:, None] - regular).min(axis=0).max() <= 0.5e-3 + 1e-12
    assert len(kept) <= 51 + found.events.size
    assert frames.left_out == 0 and len(frames.impacts.times) == 3


def test_a_rate_above_the_samples_keeps_them_all_once():
    found = impacts([0.3])
    times = samples(found.events)
    frames = key_frames(times, found, 1e5, 0.0, 1.0)
    assert np.array_equal(times[frames.indices], np.unique(times))


def test_a_span_keeps_what_lies_in_it():
    times = samples(NONE.events)
    kept = times[key_frames(times, NONE, 1e5, 0.25, 0.5).indices]
    assert kept[0] == 0.25 and kept[-1] == 0.5


def test_a_limit_first_costs_frames_between_impacts_and_then_the_weakest():
    found = impacts(np.linspace(0.01, 0.98, 90))
    times = samples(found.events)
    all_impacts = key_frames(times, found, 1000.0, 0.0, 1.0, most=500)
    assert len(all_impacts.indices) <= 500 and all_impacts.left_out == 0 and all_impacts.rate < 1000.0
    assert np.isin(found.events, times[all_impacts.indices]).all()
    some = key_frames(times, found, 1000.0, 0.0, 1.0, most=100)
    assert len(some.indices) <= 100
    assert some.left_out == 90 - len(some.impacts.times) > 0
    assert some.impacts.peaks.min() > np.sort(found.peaks)[some.left_out - 1]  # peaks all differ
    assert np.isin(some.impacts.events, times[some.indices]).all()


def test_one_sample_is_one_frame():
    assert key_frames(np.array([0.3]), NONE, 10.0, 0.0, 1.0).indices.tolist() == [0]


def test_a_rate_must_be_positive():
    with pytest.raises(InvalidParameterError, match="fps must be positive"):
        key_frames(np.linspace(0.0, 1.0, 5), NONE, 0.0, 0.0, 1.0)


def test_bodies_that_turn_fast_get_more_key_frames(clearance_run):
    """A crank at 5000 rpm, 523.6 rad/s, 0.1 rad from one to the next; its ghost as many; others 500 Hz."""
    run = simulate(load_scenario("slider_crank", case="ideal"), duration=3e-3)
    speed = 5000.0 * 2.0 * np.pi / 60.0
    assert rate_of_turns(run.data) == pytest.approx(10.0 * speed, rel=1e-9)
    recording = record(run, run)
    assert recording.frames.rate == pytest.approx(10.0 * speed, rel=1e-9)
    times = run.data["time"].values[recording.frames.indices]
    assert np.diff(times).max() * speed < 0.1 + speed * 1e-5  # and a sample's step, 10 us
    assert len({len(actor["times"]) for actor in recording.data["actors"]}) == 1  # packed alike
    assert record(clearance_run).frames.rate == 500.0
    assert record(run, fps=100.0).frames.rate == 100.0
