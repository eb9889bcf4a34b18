"""The journal in its bearing: its orbit, the load around the bore, and its contact scenarios as spans."""

import re

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from antenna_pin import load_scenario, simulate
from antenna_pin.analysis import (
    bore_load,
    clearance_shapes,
    impacts,
    journal_motion,
    load_statistics,
    scenario_shares,
    scenario_spans,
    settling,
)
from antenna_pin.errors import FileFormatError, InvalidParameterError, UnknownNameError
from antenna_pin.joints.geometry import PrismaticClearance


@pytest.fixture(scope="module")
def space():
    """The joint of the antenna in space, through its first impacts."""
    changes = ["duration=0.06", "clearance.elevation.geometry=closed-form"]
    return simulate(load_scenario("bai2020", case="case3", overrides=changes))


@pytest.fixture(scope="module")
def balls():
    return simulate(load_scenario("spherical_pendulum", case="floating", overrides=["duration=0.02"]))


def test_offsets_at_the_ends_lie_on_the_journals_axis(space):
    motion = journal_motion(space)
    data = space.data
    z = Rotation.from_quat(data["journal_attitude"].values[:, 0]).apply([0.0, 0.0, 1.0])
    for place, end in (("+", 0.025), ("-", -0.025)):
        offset = motion["offset"].sel(place=place).values
        np.testing.assert_allclose(offset[:, 2], end, rtol=1e-15)
        # Round-off of lengths of 25 mm.
        apart = np.cross(offset - data["journal_position"].values[:, 0], z)
        assert np.abs(apart).max() < 1e-17
    assert motion.attrs["kind"] == "revolute"
    assert motion.attrs["axial_limit"] == pytest.approx(2e-4, rel=1e-12, abs=0.0)


def test_gap_at_an_end_is_the_clearance_less_the_eccentricity(space):
    """But for R_i (1 - cos tilt), 0.32 um at 8 mrad: the minimum over a circle that is seen as an ellipse."""
    motion = journal_motion(space)
    for place in ("+", "-"):
        gap = space.data["gap"].sel(contact=f"elevation.radial{place}").values
        apart = motion.attrs["radial_clearance"] - motion["eccentricity"].sel(place=place).values - gap
        bound = 0.01 * (1.0 - np.cos(motion["tilt"].values))
        assert np.all((apart >= -1e-12) & (apart <= bound + 1e-12))


def test_tilt_that_the_bore_allows_lets_a_centred_journal_touch_it(space):
    from antenna_pin.joints.geometry import RevoluteClearance

    dimensions = clearance_shapes(space)["elevation"]["dimensions"]
    tilt = journal_motion(space).attrs["tilt_limit"]
    axis = (np.sin(tilt), 0.0, np.cos(tilt))
    touching = RevoluteClearance(**dimensions).contacts((0.0, 0.0, 0.0), axis)
    # Round-off of radii of 10 mm.
    assert touching[0].depth == pytest.approx(0.0, abs=1e-17)


def test_a_balls_eccentricity_is_in_space(balls):
    motion = journal_motion(balls, "lower")
    expected = np.linalg.norm(balls.data["journal_position"].sel(clearance_joint="lower").values, axis=1)
    np.testing.assert_array_equal(motion["eccentricity"].values[:, 0], expected)
    gap = balls.data["gap"].sel(contact="lower.spherical").values
    np.testing.assert_allclose(motion.attrs["radial_clearance"] - expected, gap, atol=1e-17)


@pytest.mark.parametrize("sectors", [1, 7, 36])
def test_sectors_take_the_whole_impulse(space, sectors):
    load = bore_load(space, sectors=sectors)
    whole = space.data["normal_impulse"].sel(contact=load["contact"]).isel(time=-1).values
    np.testing.assert_allclose(load["impulse"].sum("sector").values, whole, rtol=1e-12)
    assert load["impulse"].values.min() >= 0.0


def test_a_load_that_turns_is_shared_evenly(space):
    """A made-up steady load that goes round once: each sector takes its share to one sample's worth."""
    data = space.data.isel(time=slice(0, 40)).copy(deep=True)
    turn = np.linspace(0.0, 2.0 * np.pi, 40)
    point = np.zeros((40, 4, 3))
    point[:, :, 0], point[:, :, 1] = np.cos(turn)[:, None], np.sin(turn)[:, None]
    data["contact_point"] = (data["contact_point"].dims, point)
    data["normal_force"] = (data["normal_force"].dims, np.ones((40, 4)))
    data["normal_impulse"] = (data["normal_impulse"].dims, np.linspace(0.0, 39.0, 40)[:, None] * np.ones(4))
    taken = bore_load(data, sectors=13)["impulse"].values
    np.testing.assert_array_equal(taken, 3.0)


def test_spans_are_the_shares_laid_out_in_time(space):
    spans = scenario_spans(space)
    shares = np.zeros((4, 4))
    length = (spans["end"] - spans["start"]).values
    np.add.at(shares, (spans["radial"].values, spans["axial"].values), length / 0.06)
    np.testing.assert_allclose(shares, scenario_shares(space).values[0], atol=1e-14)
    np.testing.assert_array_equal(spans["start"].values[1:], spans["end"].values[:-1])
    assert spans["start"].values[0] == 0.0
    pairs = list(zip(spans["radial"].values, spans["axial"].values, strict=True))
    assert all(one != other for one, other in zip(pairs[:-1], pairs[1:], strict=True))


def test_a_single_sample_has_no_span(space):
    """But a share: all of it, whatever each kind's scenario is."""
    one = space.data.isel(time=slice(0, 1)).assign(
        radial_scenario=space.data["radial_scenario"][:1] * 0 + 2,
        axial_scenario=space.data["axial_scenario"][:1] * 0 + 1,
    )
    assert scenario_spans(one).sizes["span"] == 0
    shares = scenario_shares(one).values[0]
    assert (shares[2, 1], shares.sum()) == (1.0, 1.0)


def test_what_a_run_does_not_have_is_refused(space):
    """A joint with play, a joint of the name, dimensions."""
    ideal = simulate(load_scenario("bai2020", case="case1", overrides=["duration=0.002"]))
    for function in (journal_motion, bore_load, scenario_spans):
        with pytest.raises(InvalidParameterError, match="with a clearance joint"):
            function(ideal)
    functions = journal_motion, bore_load, impacts, load_statistics, settling
    for function in functions:
        said = f"{function.__name__}: clearance joint 'elevatoin' is unknown; did you mean elevation? known: "
        with pytest.raises(UnknownNameError, match=f"^{re.escape(said)}elevation$"):
            function(space, "elevatoin")
    with pytest.raises(InvalidParameterError, match="sectors must be 1 or more"):
        bore_load(space, sectors=0)
    data = space.data.copy()
    data.attrs = {"case": "case3"}
    with pytest.raises(FileFormatError, match="dimensions"):
        journal_motion(data)


def test_axis_of_a_slider_is_stopped_by_the_rectangle_of_its_play(slider_run):
    """Where it is neither turned nor tilted; a turned or tilted one touches before by the angle's order."""
    motion = journal_motion(slider_run)
    size = clearance_shapes(slider_run)["slide"]["dimensions"]
    ratio = motion["eccentricity_ratio"].values.max(axis=1)
    gap = slider_run.data["gap"].values.min(axis=1)
    apart = ratio <= 1.0
    assert apart.any() and not apart.all()
    # A tilted slider's corner is nearer to the axis by half the square of the tilt.
    assert (gap[~apart] < 0.5 * 15e-3 * motion["tilt"].values.max() ** 2).all()
    # At the first sample it is centred: all of the play is left, 0.15 mm along the width, at a roll of 0.2.
    assert gap[0] == pytest.approx(1.5e-4, rel=1e-10)
    assert np.hypot(*motion.attrs["outline"][0]) == pytest.approx(2.5e-4, rel=1e-12)  # 0.15 and 0.2 mm
    assert np.arctan2(*motion.attrs["outline"][0][::-1]) == pytest.approx(0.2 + np.arctan2(4, 3), rel=1e-12)
    shape = PrismaticClearance(**size)
    turn = Rotation.from_rotvec([0.0, 0.0, motion.attrs["twist_limit"]]).as_matrix()
    assert min(c.gap for c in shape.contacts(np.zeros(3), turn)) == pytest.approx(0.0, abs=1e-16)
    # Both tilts at once: each is the limit of its own, exact to second order in it.
    half = Rotation.from_euler("z", 0.2).as_matrix()
    corner = [0.5 * size[f"slider_{side}"] - 5e-4 for side in ("width", "height", "length")]
    play = [0.15e-3, 0.2e-3]
    both = half @ [-play[1] / corner[2], play[0] / corner[2], 0.0]
    assert motion.attrs["tilt_limit"] == pytest.approx(np.linalg.norm(both), rel=2e-3)


def test_load_of_a_guide_lies_on_its_walls(slider_run):
    """The impulse of every wall, in four directions at right angles from the roll on."""
    load = bore_load(slider_run, sectors=36)
    total = load["impulse"].values.sum(axis=0)
    loaded = np.flatnonzero(total)
    assert load["angle"].values[loaded] == pytest.approx(0.2 + np.arange(4) * np.pi / 2, abs=np.pi / 36)
    ends = slider_run.data["contact_end"].values
    gained = slider_run.data["normal_impulse"].values[-1]
    walls = [gained[[end.startswith(wall) for end in ends]].sum() for wall in ("+x", "+y", "-x", "-y")]
    assert total[loaded] == pytest.approx(walls, rel=1e-12)


def test_slider_touches_or_does_not(slider_run):
    shares = scenario_shares(slider_run).sel(clearance_joint="slide")
    assert float(shares.sum()) == pytest.approx(1.0, rel=1e-12)
    touched = load_statistics(slider_run)["joint_contact_share"].values[0]
    # Samples are at every change but at most half an output step apart from it otherwise.
    assert float(shares.sel(radial="one_point", axial="none")) == pytest.approx(touched, abs=1e-9)
