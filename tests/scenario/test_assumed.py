"""A joint with play in four lines: what is assumed is what the keys would say, and every run says it."""

from pathlib import Path

import pytest

from antenna_pin import build_system, load_scenario, simulate
from antenna_pin.scenario.clearance import said_of_assumed

SHORT = {
    "model": "contact",
    "bearing_radius": "10 mm",
    "bearing_length": "40 mm",
    "radial_clearance": "50 um",
}
LONG = SHORT | {
    "axial_clearance": "50 um",
    "bearing_outer_radius": "15 mm",
    "flange_radius": "15 mm",
    "journal_material": "steel",
    "bearing_material": "steel",
    "normal": {"law": "lankarani-nikravesh", "restitution": 0.9},
}
SAID = (
    "hinge: assumed law lankarani-nikravesh with restitution 0.9, steel on steel, "
    "axial play 50 um as the radial, "
    "outer radius 15 mm, flanges of radius 15 mm; set keys of [clearance.hinge] to change this"
)
PANEL = Path(__file__).parents[2] / "scripts" / "examples" / "panel"


def panel(table):
    changes = {"clearance.hinge": table | {"replace": True}}
    return load_scenario(PANEL, case="play").with_overrides(changes)


def plain(text):
    return text.replace("\N{NO-BREAK SPACE}", " ").replace("\N{MICRO SIGN}", "u").replace("μ", "u")


def test_four_lines_are_the_joint_that_the_keys_would_say():
    short, long = panel(SHORT), panel(LONG)
    one, other = (build_system(scenario).clearances[0] for scenario in (short, long))
    assert repr(one) == repr(other)
    assert [plain(said) for said in said_of_assumed(short.clearance)] == [SAID] and not [
        *said_of_assumed(long.clearance)
    ]


@pytest.mark.parametrize(
    ("more", "lost"),
    [
        ({"axial_clearance": "0.1 mm"}, "axial play 50 um as the radial, "),
        ({"flange_distance": "40.2 mm"}, "axial play 50 um as the radial, "),
        ({"flange_radius": "15 mm"}, ", flanges of radius 15 mm"),
        ({"journal_material": "steel", "bearing_material": "steel"}, "steel on steel, "),
        ({"normal": LONG["normal"] | {"stiffness": "1e10 N/m**1.5"}},
         "law lankarani-nikravesh with restitution 0.9, steel on steel, "),
    ],
)  # fmt: skip
def test_what_is_given_is_not_assumed(folder, more, lost):
    scenario = folder.load({"clearance.hinge": SHORT | more, "cases": {}})
    assert [plain(said) for said in said_of_assumed(scenario.clearance)] == [SAID.replace(lost, "")]


def test_the_play_at_the_flanges_follows_that_of_the_bore(folder):
    scenario = folder.load({"clearance.hinge": SHORT, "cases": {}})
    wider = scenario.with_overrides({"clearance.hinge.radial_clearance": "0.2 mm"})
    assert wider.clearance["hinge"].axial_play == wider.clearance["hinge"].radial_play == 2e-4


def test_a_law_that_is_named_wants_its_materials_named(folder):
    table = SHORT | {"normal": LONG["normal"]}
    wanted = "clearance.hinge.journal_material is missing; it decides the stiffness, or give normal.stiffness"
    assert folder.refusal({"clearance.hinge": table, "cases": {}}) == wanted


def test_an_assumed_joint_is_the_same_from_the_file_of_its_run(tmp_path):
    """Of the scenario in a result the run can be made again."""
    scenario = panel(SHORT)
    run = simulate(scenario, duration=1e-3, out=tmp_path / "run.nc")
    assert run.scenario.clearance["hinge"] == scenario.clearance["hinge"]


def test_a_scenario_without_a_title_goes_by_its_name():
    """And is not taken for a system built in Python."""
    run = simulate(load_scenario(PANEL / "first.toml"), duration=1e-3)
    assert run.data.attrs["title"] == "first"
