"""Between the samples of a run: what is made of some of its samples against those left out."""

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import between_samples, journal_motion
from antenna_pin.trajectory import contacts_of

RATE = 20_000.0


@pytest.fixture(
    scope="module",
    params=[
        ("bai2020", "case3", 20),
        ("spherical_pendulum", "floating", 20),
        ("slider_crank", "bearing-on-rod", 4),  # 5000 rpm
    ],
    ids=lambda one: one[1],
)
def runs(request):
    """A run with samples at 20 kHz, the same with few of them and those of contacts only."""
    scenario = load_scenario(request.param[0], case=request.param[1]).with_overrides({"output.rate": RATE})
    fine = simulate(scenario, duration=0.05).data
    steps = fine["time"].values * RATE
    left_out = (np.abs(steps - np.round(steps)) < 1e-6) & (np.round(steps) % request.param[2] != 0)
    return fine, fine.isel(time=~left_out), str(fine["clearance_joint"].values[0])


def off(data, fine, joint):
    """How far the journal is from where it is, over the clearance: rms over the fine samples."""
    ours, exact = (journal_motion(one, joint) for one in (data, fine))
    at = ours["offset"].interp(time=fine["time"]).values
    return np.sqrt(np.mean((at - exact["offset"].values) ** 2)) / exact.attrs["radial_clearance"]


def test_the_journal_is_nearer_to_where_it_is_than_chords_are(runs):
    fine, coarse, joint = runs
    curve = between_samples(coarse, joint, within=1e-4)
    kept = np.isin(curve["time"].values, coarse["time"].values)
    for name in ("journal_position", "journal_attitude", "journal_tilt"):
        ours, theirs = curve[name].values[kept, 0], coarse[name].sel(clearance_joint=joint).values
        sign = np.sign((ours * theirs).sum(axis=1))[:, None] if name == "journal_attitude" else 1.0
        assert sign * ours == pytest.approx(theirs, rel=1e-12, abs=2e-15 if "position" in name else 1e-9)
    chords, curves = off(coarse, fine, joint), off(curve, fine, joint)
    assert curves < 0.3 * chords
    assert curve.sizes["time"] <= 16 * coarse.sizes["time"]


def test_peaks_stay_peaks_and_flights_stay_free(runs):
    _, coarse, joint = runs
    curve = between_samples(coarse, joint)
    for name in contacts_of(coarse, joint):
        ours, theirs = (one["normal_force"].sel(contact=name).values for one in (curve, coarse))
        assert ours.max() == theirs.max() and ours.min() >= 0.0
        begin = np.searchsorted(coarse["time"].values, curve["time"].values, side="right") - 1
        free = (theirs[begin] == 0.0) & (theirs[np.minimum(begin + 1, len(theirs) - 1)] == 0.0)
        assert not ours[free].any()


def test_a_run_without_its_mechanism_is_as_it_was(runs):
    _, coarse, joint = runs
    bare = coarse.copy()
    del bare.attrs["urdf"]
    assert between_samples(bare, joint) is bare
    single = coarse.isel(time=[0])
    assert between_samples(single, joint) is single
