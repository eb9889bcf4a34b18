"""When impacts turn into lasting contact."""

import math

import numpy as np
import pytest
import xarray as xr

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import settling
from antenna_pin.errors import InvalidParameterError, UnknownNameError


def touches(intervals, end, speeds=None, contacts=("a.radial+", "a.radial-"), rows=None):
    """A run of a joint that touches in given intervals; None ends one that still does."""
    onset = np.array([start for start, _ in intervals], dtype=float)
    release = np.array([math.nan if stop is None else stop for _, stop in intervals], dtype=float)
    time = np.unique(np.concatenate([[0.0, end], onset, release[np.isfinite(release)]]))
    index = np.zeros(onset.size, dtype=int) if rows is None else np.array(rows)
    speeds = np.full(onset.size, 0.1) if speeds is None else np.asarray(speeds, dtype=float)
    rate = np.zeros((time.size, len(contacts)))
    rate[np.searchsorted(time, onset), index] = speeds
    one = np.ones(onset.size)
    return xr.Dataset(
        {
            "depth_rate": (("time", "contact"), rate),
            "onset_time": ("episode", onset),
            "release_time": ("episode", release),
            "approach_speed": ("episode", speeds),
            "episode_contact": ("episode", index),
            **{name: ("episode", one) for name in ("peak_force", "peak_time", "peak_depth")},
            **{name: ("episode", one) for name in ("impulse", "dissipated")},
        },
        coords={
            "time": time,
            "contact": list(contacts),
            "contact_joint": ("contact", ["a"] * len(contacts)),
            "contact_kind": ("contact", [name.partition(".")[2].rstrip("+-") for name in contacts]),
            "clearance_joint": ["a"],
        },
        attrs={"end_time": end},
    )


def test_settled_is_after_the_last_long_gap():
    """Gaps of 1, 0.5 and 0.1 s before 1, 2 and 3 s."""
    run = touches([(1.0, 1.5), (2.0, 2.9), (3.0, None)], end=10.0)
    for gap, time in ((0.0, 3.0), (0.05, 3.0), (0.1001, 2.0), (0.5001, 1.0), (1.0001, 0.0)):
        (found,) = settling(run, longest_gap=gap, least_duration=1.0)
        assert found.time == time
        assert found.note == ""
        assert found.last_gap == 3.0
    (found,) = settling(run, longest_gap=0.2, least_duration=1.0)
    assert found.share_before == pytest.approx(0.25, rel=1e-12)
    assert found.share_after == pytest.approx(7.9 / 8.0, rel=1e-12)


def test_what_counts_as_touching():
    """Either end of a bore, a short gap at the end, flanges if asked for."""
    # One end touches while the other is apart: together they never part.
    run = touches([(0.0, 2.0), (1.5, 4.0), (3.5, 6.0), (5.0, None)], end=10.0, rows=[0, 1, 0, 1])
    (found,) = settling(run, longest_gap=0.0)
    assert found.time == 0.0
    assert math.isnan(found.last_gap)
    assert found.share_after == 1.0
    (found,) = settling(touches([(1.0, 9.9995)], end=10.0))
    assert found.time == 1.0
    run = touches([(1.0, 2.0), (3.0, None)], 10.0, contacts=("a.radial", "a.axial+"), rows=[0, 1])
    assert settling(run)[0].time is None
    assert settling(run, contacts="flanges")[0].time == 3.0
    assert settling(run, contacts="any")[0].contacts == ("a.radial", "a.axial+")
    assert settling(simulate(load_scenario("pendulum", case="ideal"), duration=0.01)) == ()
    (found,) = settling(touches([], end=0.0))
    assert found.note == "one sample is no time to settle in"


@pytest.mark.parametrize(
    ("intervals", "said"),
    [
        ([], "never touches"),
        ([(1.0, 9.5)], "apart for 500 ms when the run ends"),
        ([(1.0, 2.0), (9.8, None)], "only 200 ms of 500 ms"),
    ],
)
def test_not_settled(intervals, said):
    (found,) = settling(touches(intervals, end=10.0))
    assert found.time is None
    assert said in found.note
    assert math.isnan(found.share_after)


@pytest.mark.parametrize(("gap", "least"), [(0.02, 0.5), (0.1, 1.0)])
def test_time_to_tell_is_a_twentieth_of_the_run_or_ten_gaps(gap, least):
    """Whichever is longer, to the last digit of the time."""
    for remain, settles in ((least - 1e-9, False), (least + 1e-9, True)):
        (found,) = settling(touches([(1.0, 2.0), (10.0 - remain, None)], end=10.0), longest_gap=gap)
        assert (found.time is not None) is settles


def test_decay_of_speeds_and_the_curve():
    """Speeds 0.2 exp(-3 t): the line through their logarithm is exact."""
    onset = np.arange(10) * 0.5 + 0.1
    run = touches([(t, t + 0.2) for t in onset], end=5.0, speeds=0.2 * np.exp(-3.0 * onset))
    (found,) = settling(run, windows=5)
    assert found.decay_rate == pytest.approx(3.0, rel=1e-9)
    assert found.decay_r2 == pytest.approx(1.0, rel=1e-9)
    assert found.curve["time"].values == pytest.approx([0.5, 1.5, 2.5, 3.5, 4.5])
    assert found.curve["impacts"].values.tolist() == [2] * 5
    assert found.curve["contact_share"].values == pytest.approx(np.full(5, 0.4), rel=1e-9)
    assert found.curve["largest_approach_speed"].values[0] == pytest.approx(0.2 * math.exp(-0.3))
    assert found.decays
    few = settling(touches([(1.0, 2.0)], end=5.0), windows=5)[0]
    assert math.isnan(few.decay_rate)
    assert few.decays is None
    for speeds in (0.2 * np.exp(3.0 * onset), 0.2 * np.exp(0.1 * (-1.0) ** np.arange(10) - 1e-3 * onset)):
        (other,) = settling(touches([(t, t + 0.2) for t in onset], end=5.0, speeds=speeds))
        assert other.decays is False  # they grow; a thousandth a second is lost in what they do else
    assert np.isnan(few.curve["mean_approach_speed"].values[[0, 2, 3, 4]]).all()


@pytest.mark.parametrize(
    ("rig", "case", "joints"), [("pendulum", "contact", 1), ("spherical_pendulum", "swing", 2)]
)
def test_rigs_settle_where_their_samples_say(rig, case, joints):
    """From the settled time on every sample has a contact of the bore or socket, and just before it none."""
    run = simulate(load_scenario(rig, case=case), duration=0.1)
    every = settling(run, longest_gap=0.0)
    assert len(every) == joints
    for found in every:
        assert found.time is not None
        touching = run.data["touching"].sel(contact=list(found.contacts)).values.any(axis=1)
        time = run.data["time"].values
        assert touching[time >= found.time].all()
        assert not touching[time < found.time][-1]
        # Impacts become fewer and weaker.
        speeds = found.curve["largest_approach_speed"].values
        assert np.nanmax(speeds) == np.nanmax(speeds[: speeds.size // 4])
        assert found.decay_rate > 0.0


def test_a_pendulum_settles_and_a_drop_is_known():
    """Let go, the journal falls through the play c in sqrt(2 c / g) = 4.5 ms and bounces for a while."""
    run = simulate(load_scenario("pendulum", case="planar"), duration=0.2)
    (found,) = settling(run, longest_gap=0.0)
    assert run.data["onset_time"].values[0] == pytest.approx(math.sqrt(2e-4 / 9.80665), rel=0.05)
    assert found.time is not None
    assert found.time == found.last_gap
    assert found.share_after == 1.0
    # Bounces under gravity shrink with their times alike: not exponentially, but they shrink.
    assert found.decay_rate > 0.0
    rest = simulate(load_scenario("pendulum", case="planar-rest"), duration=0.05)
    assert settling(rest, longest_gap=0.0)[0].time == 0.0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"longest_gap": -1.0}, "longest_gap must be zero or more"),
        ({"windows": 0}, "windows must be 1 or more"),
        ({"contacts": "radial"}, "'bore', 'flanges' or 'any'"),
        ({"joint": "b"}, "clearance joint 'b' is unknown"),
    ],
)
def test_what_makes_no_sense_is_refused(arguments, said):
    with pytest.raises((InvalidParameterError, UnknownNameError), match=said):
        settling(touches([], end=1.0), **arguments)
