"""Bearings of a scenario: what becomes of their joints, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.elements import BallBearing
from antenna_pin.errors import AntennaPinError
from antenna_pin.scenario.assemble import build_system
from antenna_pin.show.report._runs import ReportedRun
from antenna_pin.show.report.words import scenario_sections

LINK = (
    '<link name="{}"><inertial><mass value="2"/>'
    '<inertia ixx="0.006" iyy="0.006" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
URDF = (
    f'<robot name="rotor">{LINK.format("hull")}{LINK.format("disc")}{LINK.format("cart")}'
    '<joint name="axle" type="continuous"><parent link="hull"/><child link="disc"/><axis xyz="0 0 1"/>'
    '<dynamics damping="0.002"/></joint>'
    '<joint name="rail" type="prismatic"><parent link="hull"/><child link="cart"/><axis xyz="1 0 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>'
)
TOML = """format = 1
duration = "1 ms"
[mechanism]
urdf = "rotor.urdf"
base = "free"
[bearings.axle]
kind = "balls"
count = 12
ball_diameter = "6 mm"
pitch_diameter = "40 mm"
contact_angle = "15 deg"
preload = "50 N"
arrangement = "back-to-back"
spread = "20 mm"
[initial.joints.axle]
rate = "3000 rpm"
journal_position = ["0.5 um", "0 um", "0 um"]
"""
PLAY = """[clearance.axle]
model = "{}"
bearing_radius = "10 mm"
radial_clearance = "0.1 mm"
bearing_length = "20 mm"
axial_clearance = "0.2 mm"
bearing_outer_radius = "15 mm"
flange_radius = "14 mm"
normal = {{law = "hertz", stiffness = 1e8, exponent = 1.0, dissipation = "none"}}
"""


@pytest.fixture
def load(tmp_path):
    """A function that loads the scenario with some text behind it, and some of it replaced."""

    def scenario(more="", **changes):
        text = TOML + more
        for old, new in changes.values():
            assert old in text
            text = text.replace(old, new)
        (tmp_path / "rotor.urdf").write_text(URDF, encoding="utf-8")
        (tmp_path / "rotor.toml").write_text(text, encoding="utf-8")
        return load_scenario(tmp_path / "rotor.toml")

    return scenario


def test_the_joint_is_free_and_carried(load):
    """By the bearing of the table's name, with the friction of its URDF about its axis."""
    system = build_system(load())
    assert system.mechanism.joint("axle").kind == "floating"
    assert system.on_bearings == ("axle",)
    bearing = system.families["bearings"]["axle"]
    assert isinstance(bearing, BallBearing)
    assert bearing.contact_angle == pytest.approx(np.radians(15.0), rel=1e-15)
    assert system.springs["axle.dynamics"].damping == 0.002


def test_it_is_seen_in_a_result(load):
    """Columns, and words of what it is and what it carried."""
    run = simulate(load())
    assert run.data.bearing.values.tolist() == ["axle"]
    stiffness = build_system(load()).families["bearings"]["axle"].stiffness
    force = run.data.bearing_force.values[0, 0]
    assert force == pytest.approx([-stiffness[0, 0] * 5e-7, 0.0, 0.0], abs=1e-9)
    sections = scenario_sections([ReportedRun("run", run, None)])
    said = {(part.title, one.label): one.texts[0][1] for part in sections for one in part.statements}
    assert "back-to-back pair" in said["Drives and springs", "bearing axle"]
    assert "at most" in said["Drives and springs", "load of bearing axle"]
    assert "on bearing axle" in said["Joints", "axle"]


def test_a_bearing_beside_play(load):
    """An ideal joint may wait with a table of play; a preload leaves the joint what it is."""
    # What waits for another case.
    assert build_system(load(PLAY.format("ideal"))).on_bearings == ("axle",)
    # Beside play.
    text = '[bearings.push]\nkind = "preload"\njoint = "axle"\nforce = "50 N"\nstiffness = "1e5 N/m"\n'
    system = build_system(load(PLAY.format("contact") + text))
    assert system.on_bearings == ()
    assert system.families["bearings"]["push"].position == pytest.approx(2e-4, rel=1e-12)


@pytest.mark.parametrize(
    ("more", "changes", "said"),
    [
        (PLAY.format("constraint"), {}, "clearance.axle.model must leave the joint all its freedoms"),
        ("", {"joint": ("count = 12", 'count = 12\njoint = "rail"')}, "must be revolute or continuous"),
        ("", {"joint": ("count = 12", 'count = 12\njoint = "axel"')}, "axel"),
        ('[mechanism.joints.axle]\nkind = "locked"\n', {}, "must be left out, for bearing 'axle' decides it"),
        ("", {"few": ("count = 12", "count = 2")}, "count must be 3 or more"),
        ("", {"kind": ('"balls"', '"rollers"')}, "must be one of stiffness, balls, preload"),
    ],
)
def test_what_cannot_be(load, more, changes, said):
    """One line that says where and what to do."""
    with pytest.raises(AntennaPinError, match=said) as refused:
        build_system(load(more, **changes))
    assert "\n" not in str(refused.value)
