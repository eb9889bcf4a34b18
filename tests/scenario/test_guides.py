"""A slider in a guide as a scenario has it: round, with a key, in a guide that ends."""

import pytest

from antenna_pin import load_scenario
from antenna_pin.errors import ScenarioError
from antenna_pin.joints.geometry import CylindricalClearance, PrismaticClearance

ROUND = {
    "model": "cylindrical", "bearing_radius": "20 mm", "radial_clearance": "0.1 mm", "slider_length": "80 mm",
    "guide_length": "50 mm", "journal_material": "steel", "bearing_material": "steel", "replace": True,
    "normal": {"law": "lankarani-nikravesh", "restitution": 0.5},
}  # fmt: skip
KEY = {"key_width": "4 mm", "keyway_width": "4.1 mm", "key_reach": "22 mm"}


def spec(**changes):
    over = {"clearance": {"slide": {**ROUND, **changes}}}
    return load_scenario("slider", case="driven", overrides=over).clearance["slide"]


def test_a_round_slider_is_read_with_its_key():
    shape = spec(**KEY).shape()
    assert shape == CylindricalClearance(
        bearing_radius=0.02, journal_radius=0.02 - 1e-4, slider_length=0.08, guide_length=0.05,
        key_width=4e-3, keyway_width=4.1e-3, key_reach=0.022,
    )  # fmt: skip
    assert len(spec().shape().contact_places) == 2


def test_a_square_guide_may_end():
    found = load_scenario("slider", case="driven", overrides=["clearance.slide.guide_length=30 mm"])
    shape = found.clearance["slide"].shape()
    assert isinstance(shape, PrismaticClearance)
    assert shape.guide_length == 0.03
    assert load_scenario("slider", case="driven").clearance["slide"].shape().guide_length == 0.0


def test_widths_leave_half_of_what_they_differ_by_to_each_side():
    slide = load_scenario("slider", case="driven").clearance["slide"]
    assert (slide.radial_clearance, slide.guide_width, slide.slider_width) == (None, 0.0401, 0.04)
    assert slide.radial_play == pytest.approx(5e-5, rel=1e-11)  # a difference of sizes of 0.04 m
    given = load_scenario("slider", case="driven", overrides=["clearance.slide.radial_clearance=0.1 mm"])
    shape = given.clearance["slide"].shape()  # which takes the place of both widths
    assert (shape.slider_width, shape.slider_height) == (0.0401 - 2e-4, 0.0402 - 2e-4)


def test_a_width_that_waits_for_a_slider_leaves_the_play_of_a_round_part():
    """A play excludes dimensions of its own shape alone; the other way about a slider's play is its own."""
    over = {"clearance.bore.slider_width": 0.03, "clearance.bore.slider_height": 0.03}
    for model in ("planar", "ideal", "contact"):
        found = load_scenario("impact_pair", overrides=over | {"clearance.bore.model": model})
        assert found.clearance["bore"].radial_clearance == 1e-4
    over = {"clearance.slide.journal_radius": 0.01, "clearance.slide.radial_clearance": "0.1 mm"}
    slide = load_scenario("slider", case="driven", overrides=over).clearance["slide"]
    assert (slide.slider_width, slide.radial_play) == (None, 1e-4)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"key_width": "4 mm"}, "keyway_width must be positive, as a key has all three, got 0 m"),
        (KEY | {"key_width": "5 mm"}, "key_width must be below keyway_width = 0.0041 m"),
        ({"guide_length": "-1 mm"}, "guide_length must be zero or more"),
        ({"load": "distributed"}, "load must be point where the joint is not one of journal"),
        ({"radial_clearance": "30 mm"}, "radial_clearance must make journal_radius positive"),
    ],
)
def test_refuses_in_one_line(changes, message):
    with pytest.raises(ScenarioError, match=message):
        spec(**changes)
