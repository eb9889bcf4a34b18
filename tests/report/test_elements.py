"""A section for every kind of element: drives, controllers, springs, frictions, forces, bearings."""

from __future__ import annotations

import numpy as np
import pytest

from antenna_pin import load_scenario, simulate
from antenna_pin.show.report import report

TOML = """
duration = 0.2
[mechanism]
urdf = "craft.urdf"
base = "free"
[initial.joints.hinge]
rate = 0.5
[integrator]
engine = "compiled"
[drives.motor]
kind = "constant"
joint = "hinge"
value = 0.0
[controllers.loop]
kind = "pid"
acts_on = "motor"
period = "10 ms"
kp = 40.0
kd = 6.0
upper = 0.5
lower = -0.5
reference = "20 deg"
[springs.harness]
kind = "bouc-wen"
joint = "hinge"
alpha = 0.5
stiffness = 20.0
yield_angle = 0.005
[frictions.hinge]
coulomb = 0.05
[forces.drag]
kind = "force"
at = {link = "arm", point = ["40 cm", 0, 0]}
force = ["-20 mN", 0, 0]
axes = "world"
"""
URDF = """<robot name="craft">
  <link name="hull"><inertial><mass value="4"/>
    <inertia ixx="0.5" iyy="0.6" izz="0.7" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="revolute"><parent link="hull"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="1" velocity="1"/></joint>
  <link name="arm"><inertial><origin xyz="0.4 0 0"/><mass value="1.5"/>
    <inertia ixx="0.01" iyy="0.2" izz="0.21" ixy="0" ixz="0" iyz="0"/></inertial></link>
</robot>"""


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("craft")
    (folder / "craft.urdf").write_text(URDF, encoding="utf-8")
    (folder / "craft.toml").write_text(TOML, encoding="utf-8")
    return simulate(load_scenario(folder / "craft.toml"))


@pytest.fixture(scope="module")
def told(run, shown):
    return shown(report(run, figures=False, recordings=False).html)


def test_a_drive_and_the_controller_that_commands_it(run, told):
    torque = np.abs(run.data["drive_torque"].sel(drive="motor")).max().item()
    assert told.numbers("drives", "drive motor: peak torque") == [torque]
    assert told.numbers("drives", "drive motor: work") == [run.data["total_work"].sel(drive="motor").item()]
    assert told.numbers("key-results", "peak torque of drive motor") == [torque]
    (asked,), (held,) = run.data["ticks"].values, run.data["saturated_ticks"].values
    assert told.numbers("controllers", "loop: instants") == [asked] and asked == 21
    assert told.numbers("controllers", "loop: instants at limits") == [held] and held > 0
    # It is told in words too what the controller is.
    assert "every 0.01 s" in told.said("what-controllers")["loop"]


def test_springs_and_frictions(run, told):
    torque = np.abs(run.data["spring_torque"].sel(traced_spring="harness")).max().item()
    assert told.numbers("springs", "spring harness: peak torque") == [torque]
    lost = run.data["total_damper_loss"].sel(spring="harness").item()
    assert told.numbers("springs", "spring harness: energy lost") == [lost]
    held = run.data["element_effort"].sel(element="frictions.hinge")
    assert told.numbers("springs", "friction hinge: peak torque") == [np.abs(held).max().item()]
    lost = run.data["total_element_loss"].sel(element="frictions.hinge").item()
    assert told.numbers("springs", "friction hinge: energy lost") == [lost]


def test_forces(run, told):
    impulse = np.linalg.norm(run.data["total_impulse"].sel(force="drag"))
    # 20 mN for 0.2 s, exactly held in world axes.
    assert told.numbers("forces", "drag: impulse") == [pytest.approx(impulse, rel=1e-14, abs=0.0)]
    assert impulse == pytest.approx(0.02 * 0.2, rel=1e-12, abs=0.0)
    assert told.numbers("forces", "drag: work") == [run.data["total_force_work"].sel(force="drag").item()]


def test_figures_of_controllers_and_forces_are_in_their_sections(run):
    made = report(run, recordings=False)
    pictures = {section.key: [one.caption for one in section.pictures] for section in made.sections}
    assert pictures["controllers"] == ["What controllers measure and command"]
    assert pictures["forces"] == ["Forces on links"]
    assert "figures" not in pictures  # nothing is left that has no section of its own


def test_why_a_figure_is_missing_stands_where_it_would_be():
    """Nothing goes through the dish's hinge: its mass centre is on the axis, and nothing pulls."""
    gear = simulate(load_scenario("pointing_gear", case="tight"), duration=0.5)
    (joints,) = (one for one in report(gear, recordings=False).sections if one.key == "joints")
    (note,) = joints.notes
    assert note.startswith("Force through dish: ") and note.endswith(
        " a force goes through dish, got 0 N in all of them."
    )


def test_bearings(shown):
    run = simulate(load_scenario("reaction_wheel", case="bearings"), duration=2e-3)
    page = shown(report(run, figures=False, recordings=False).html)
    for what in ("force", "moment"):
        peak = run.data[f"peak_bearing_{what}"].sel(bearing="shaft").item()
        assert page.numbers("springs", f"bearing shaft: peak {what}") == [peak]


def test_many_alike_things_have_a_line_each(shown):
    """A table of four stops and two runs has eight lines; of what is zero in all only the first is told."""
    cases = ("ideal", "uncoupled")
    runs = [
        simulate(load_scenario("solar_array", case=case, overrides=["clearance={}"]), duration=0.2)
        for case in cases
    ]
    page = shown(report(runs, figures=False, recordings=False).html)
    found = page.lines("stops") if page.tree.xpath("//figure[@id='table-stops']") else {}
    names = [f"{joint}, {case}" for joint in ("root", "first", "second", "third") for case in cases]
    assert list(found) == names
    assert all(line["touches"] == 0.0 and "fastest rebound" not in line for line in found.values())


@pytest.mark.parametrize("model", ["prismatic", "ideal"])
def test_a_bare_number_at_a_sliding_joint_is_a_force(model):
    over = {"drives.push.value": 4.0, "clearance.slide.model": model, "duration": "1 ms"}
    run = simulate(load_scenario("slider", case="driven", overrides=over))
    html = report(run, figures=False, recordings=False).html
    assert "constant 4\N{NO-BREAK SPACE}N, at slide" in html
