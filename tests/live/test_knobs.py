"""What may be turned: places that the scenario has, ranges around its numbers, text that reads back."""

import math

import pytest

from antenna_pin import list_scenarios, load_scenario
from antenna_pin.apps.live import Knob, knobs_of
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario import TouchingSpec

CASES = [
    ("bai2020", "case3", "elevation"),
    ("bai2020", "case2-contact", "elevation"),  # pressed: no axial play
    ("chen2021", None, "s2"),
    ("pointing_gear", None, "motor"),
    ("slider", None, "slide"),
    ("solar_array", None, "root"),
    ("spherical_pendulum", None, "upper"),
    ("you2010", None, "joint2"),
]


EVERY = [
    pytest.param(scenario, knob, id=f"{name}-{case}-{knob.place}")
    for name, case, joint in CASES
    for scenario in [load_scenario(name, case=case)]
    for knob in knobs_of(scenario, joint)
]


@pytest.mark.parametrize(("scenario", "knob"), EVERY)
def test_a_knob_at_its_value_is_the_scenario(scenario, knob):
    """Laid over at its own value it changes no number; shown and read again it is that value."""
    assert knob.low <= knob.value <= knob.high
    turned = scenario.with_overrides(knob.settings(knob.value))
    left = {"overrides", "materials"}  # a shipped material enters the scenario with all its numbers
    before, after = (one.model_dump(exclude=left) for one in (scenario, turned))
    flat_before, flat_after = flat(before), flat(after)
    assert flat_after.keys() == flat_before.keys()
    for place, value in flat_before.items():
        if place.endswith((".motion", ".conversion")):
            continue  # what the units of the file said, which does not bind numbers laid over it
        if not isinstance(value, float):
            assert flat_after[place] == value, place
            continue
        # A play that the radii give is a difference: round-off of them, 1e-16 of 0.02 m.
        assert flat_after[place] == pytest.approx(value, rel=1e-12, abs=0.0), place
    # Ten digits are shown.
    assert knob.read(knob.display_text(knob.value)) == pytest.approx(knob.value, rel=1e-9, abs=0.0)


def test_a_heading_names_one_of_its_table():
    groups = {knob.group for knob in knobs_of(load_scenario("solar_array"), "root")}
    assert {"Spring root", "Stop root", "Latch root", "Gear root_first"} <= groups


@pytest.mark.parametrize(("scenario", "knob"), EVERY)
def test_a_slider_goes_through_its_range_in_three_digits(scenario, knob):
    shares = [k / 20 for k in range(21)]
    values = [knob.from_slider(share) for share in shares]
    assert values == sorted(values)
    for share, value in zip(shares, values, strict=True):
        # Three digits: half a thousandth of a value, which on the log scale of a range of 1e4 is less still.
        reach = 5e-3 if knob.logarithmic else 5e-3 * max(abs(knob.low), abs(knob.high))
        shown = knob.to_slider(value)
        if knob.logarithmic:
            assert shown == pytest.approx(share, rel=0.0, abs=reach)
        else:
            assert value == pytest.approx(knob.low + share * (knob.high - knob.low), rel=0.0, abs=reach)


@pytest.mark.parametrize("unit", ["m", "s", "N", "Hz", "Pa", "rad"])
def test_a_small_number_is_shown_with_a_prefix_and_read_again(unit):
    knob = Knob(group="g", name="n", place="p", unit=unit, value=2e-4, low=1e-5, high=4e-3, logarithmic=True)
    assert knob.display_text(2.5e-4) in (f"0.25 m{unit}", f"250 \N{MICRO SIGN}{unit}")
    assert knob.read(knob.display_text(2.5e-4)) == pytest.approx(2.5e-4, rel=1e-12)


def test_a_slider_begins_at_its_middle_and_goes_as_far_either_way():
    """Of stiffnesses and moduli a hundred times, of other positive numbers twenty times; plays end before."""
    ranges = {}
    for scenario, knob in (one.values for one in EVERY):
        key = knob.place.rpartition(".")[2]
        if knob.logarithmic and "play" not in knob.name:
            assert knob.to_slider(knob.value) == pytest.approx(0.5, abs=1e-12), (scenario.name, knob.place)
            ranges.setdefault(key, set()).add(round(knob.high / knob.value, 9))
    assert {key for key, found in ranges.items() if found == {100.0}} >= {"stiffness", "young"}
    assert {key for key, found in ranges.items() if found == {20.0}} >= {"damping", "least_rate"}
    assert all(found in ({20.0}, {100.0}) for found in ranges.values())


def test_an_angle_is_shown_in_the_unit_that_it_was_written_in():
    """The scenario keeps radians; of the units of angles that one is taken which makes the fewest digits."""
    knobs = {knob.place: knob for knob in knobs_of(load_scenario("solar_array"), "root")}
    assert knobs["stops.root.upper"].display_text(math.radians(90.0)) == "90 deg"
    upper = knobs["stops.root.upper"]
    assert upper.display_text(upper.from_slider(0.3)) == "27.2 deg"  # 4.5 deg times 400 to the power of 0.3
    assert knobs["springs.root.rest_angle"].display_text(knobs["springs.root.rest_angle"].value) == "-180 deg"
    assert knobs["stops.root.least_rate"].display_text(knobs["stops.root.least_rate"].value) == "0.0001 rad/s"


def flat(table, place=""):
    if not isinstance(table, dict):
        return {place: table}
    return {key: value for name, one in table.items() for key, value in flat(one, f"{place}.{name}").items()}


def test_every_joint_with_play_of_what_ships_has_its_play_stiffness_and_restitution():
    for summary in list_scenarios():
        scenario = load_scenario(summary.name)
        for joint, spec in scenario.clearance.items():
            if not isinstance(spec, TouchingSpec):
                continue
            names = [knob.name for knob in knobs_of(scenario, joint)]
            assert any("play" in name for name in names), (summary.name, joint)
            assert any("stiffness" in name or "modulus" in name for name in names), (summary.name, joint)


def test_a_restitution_goes_from_0_to_1():
    for name, joint in (("bai2020", "elevation"), ("impact_pair", "bore")):
        found = [one for one in knobs_of(load_scenario(name), joint) if one.place.endswith("restitution")]
        assert found and {(one.low, one.high, one.logarithmic) for one in found} == {(0.0, 1.0, False)}, name


@pytest.mark.parametrize(
    ("model", "changes", "key", "play", "wider"),
    [
        ("bai2020", {"radial_clearance": None, "journal_radius": 9.8e-3}, "journal_radius", 0.2e-3, 9.5e-3),
        ("bai2020", {"axial_clearance": None, "flange_distance": 50.4e-3}, "flange_distance", 0.2e-3, 51e-3),
        ("slider", {}, "slider_width", 0.05e-3, 39.1e-3),
        ("slider", {}, "slider_height", 0.1e-3, 39.2e-3),
    ],
)
def test_play_that_two_sizes_give_is_turned_at_one_of_them(model, changes, key, play, wider):
    """Of lengths and widths it is half their difference, that of either side. Last: the size at 0.5 mm."""
    scenario = load_scenario(model, case={"bai2020": "case3", "slider": "rest"}[model])
    ((joint, own),) = scenario.clearance.items()
    given = own.model_copy(update=changes)
    changed = scenario.model_copy(update={"clearance": {joint: given}})
    (knob,) = (one for one in knobs_of(changed, joint) if one.place == f"clearance.{joint}.{key}")
    assert knob.value == pytest.approx(play, rel=1e-11, abs=0.0)  # a difference of sizes of 0.01 m and more
    assert knob.settings(0.5e-3) == {knob.place: pytest.approx(wider, rel=1e-14, abs=0.0)}


@pytest.mark.parametrize(
    ("unit", "value", "shown"),
    [
        ("N/m**1.5", 2.5e10, "2.5e+10 N/m^1.5"),
        ("kg*m**2", 0.25, "0.25 kg*m^2"),
        ("rad/s**2", 0.3, "0.3 rad/s^2"),
        ("rad/s**2", math.radians(30.0), "30 deg/s^2"),
        ("rad/s", 0.6 * math.pi, "18 rpm"),
        ("N*m/rad", 36.0 / math.pi, "0.2 N*m/deg"),
    ],
)
def test_powers_are_shown_as_they_are_typed(unit, value, shown):
    """With a circumflex; and what is shown is read again."""
    knob = Knob(group="", name="", place="here", unit=unit, value=value, low=0.0, high=1.0, logarithmic=False)
    assert knob.display_text(value) == shown
    assert knob.read(shown) == pytest.approx(value, rel=1e-14, abs=0.0)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("0.2 N", "must be a length [m], got '0.2 N' (force)"),
        ("wide", "must be a length [m]"),
        ("", "must be"),
    ],
)
def test_what_is_typed_wrong_is_refused_in_one_line(text, said):
    knob = knobs_of(load_scenario("bai2020", case="case3"), "elevation")[0]
    with pytest.raises(AntennaPinError) as refused:
        knob.read(text)
    assert said in str(refused.value) and "clearance.elevation.radial_clearance" in str(refused.value)
    assert "\n" not in str(refused.value)


def test_typed_units_and_signs_of_print_are_read():
    knob = knobs_of(load_scenario("bai2020", case="case3"), "elevation")[0]
    assert knob.read(" 150 µm ") == 150e-6
    assert knob.read("\N{MINUS SIGN}0.1\N{NO-BREAK SPACE}mm") == -0.1e-3
    assert knob.read("2e-4") == 2e-4


def test_a_fit_is_turned_by_places_in_its_zones():
    """Hole and shaft, in place of a play that the fit decides."""
    scenario = load_scenario("pendulum", overrides={"clearance.hinge.fit": "20 H7/g6"})
    knobs = {knob.place: knob for knob in knobs_of(scenario, "hinge")}
    assert "clearance.hinge.journal_radius" not in knobs
    hole = knobs["clearance.hinge.fit_hole"]
    turned = scenario.with_overrides(hole.settings(1.0)).clearance["hinge"]
    assert turned.bearing_radius == pytest.approx(10.0105e-3, rel=1e-15)


def test_names_with_dots_stand_in_quotes(tmp_path):
    """A joint's name is any text: knobs of its play, law, start and drives are laid over all the same."""
    folder = load_scenario("slider").folder
    for name in ("slider.urdf", "scenario.toml"):
        text = (folder / name).read_text(encoding="utf-8").replace('"slide"', '"slide.1"')
        text = text.replace("clearance.slide]", 'clearance."slide.1"]').replace(
            "drives.push]", 'drives."push 1"]'
        )
        (tmp_path / name).write_text(text.replace("joints.slide]", 'joints."slide.1"]'), encoding="utf-8")
    start = {'initial.joints."slide.1".velocity': "0.1 m/s"}
    scenario = load_scenario(tmp_path / "scenario.toml", overrides=start)
    knobs = knobs_of(scenario, "slide.1")
    places = {knob.place for knob in knobs}
    assert {'clearance."slide.1".slider_width', 'drives."push 1".value', *start} <= places
    assert any(place.startswith('clearance."slide.1".friction.') for place in places)
    for knob in knobs:
        scenario.with_overrides(knob.settings(knob.value))
